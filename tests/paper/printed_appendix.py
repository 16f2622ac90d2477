"""The lines of the appendix, transcribed by hand: integrals as sums over point masses, and what is made of them.

C3, C4 and C5 are tensors, c1, c2, c6 and c7 vectors; J is written with the correction of its last two terms.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp
from sympy import Expr, Matrix


@dataclass(frozen=True)
class Cloud:
    """Point masses: X of each, and the values there of each shape, `shapes[i][p]`."""

    masses: tuple[Expr, ...]
    X: tuple[Matrix, ...]
    shapes: tuple[tuple[Matrix, ...], ...]

    def over(self, values: Sequence[Expr | Matrix], zero: Expr | Matrix) -> Expr | Matrix:
        """int rho f, f given at each point."""
        return sum((m * value for m, value in zip(self.masses, values, strict=True)), zero)


VECTOR, TENSOR = sp.zeros(3, 1), sp.zeros(3, 3)


def _tensor(f: Matrix, g: Matrix) -> Matrix:
    """(f . g) I - f g."""
    return f.dot(g) * sp.eye(3) - f * g.T


def appendix_c1(of: Cloud) -> Matrix:
    return of.over(of.X, VECTOR)


def appendix_c2(of: Cloud, i: int) -> Matrix:
    return of.over(of.shapes[i], VECTOR)


def appendix_C3(of: Cloud) -> Matrix:
    return of.over([_tensor(x, x) for x in of.X], TENSOR)


def appendix_C4(of: Cloud, i: int) -> Matrix:
    return of.over([_tensor(f, x) for f, x in zip(of.shapes[i], of.X, strict=True)], TENSOR)


def appendix_C5(of: Cloud, i: int, j: int) -> Matrix:
    return of.over([_tensor(f, g) for f, g in zip(of.shapes[i], of.shapes[j], strict=True)], TENSOR)


def appendix_c6(of: Cloud, i: int) -> Matrix:
    return of.over([x.cross(f) for x, f in zip(of.X, of.shapes[i], strict=True)], VECTOR)


def appendix_c7(of: Cloud, i: int, j: int) -> Matrix:
    return of.over([f.cross(g) for f, g in zip(of.shapes[i], of.shapes[j], strict=True)], VECTOR)


def appendix_c8(of: Cloud, i: int, j: int) -> Expr:
    return of.over([f.dot(g) for f, g in zip(of.shapes[i], of.shapes[j], strict=True)], sp.S.Zero)


Column = Sequence[Matrix]
Table = Sequence[Sequence[Matrix]]


def appendix_J(C3: Matrix, C4: Column, C5: Table, alpha: Sequence[Expr]) -> Matrix:
    """C3 + alpha^T (C4 + C4^c) + alpha^T C5 alpha; the text shows C5 and C8 for C4^c and C5."""
    total = C3
    for i, a in enumerate(alpha):
        total += a * (C4[i] + C4[i].T)
        for j, b in enumerate(alpha):
            total += a * b * C5[i][j]
    return total


def appendix_d1(c1: Matrix, c2: Column, alpha: Sequence[Expr]) -> Matrix:
    return sum((a * c for a, c in zip(alpha, c2, strict=True)), c1)


def appendix_D2(C4: Matrix, C5: Column, alpha: Sequence[Expr]) -> Matrix:
    """One entry of the column, from its row of C5."""
    return sum((a * c for a, c in zip(alpha, C5, strict=True)), C4)


def appendix_d3(c6: Matrix, c7: Column, alpha: Sequence[Expr]) -> Matrix:
    """One entry of the column, from its row of c7."""
    return sum((-a * c for a, c in zip(alpha, c7, strict=True)), c6)
