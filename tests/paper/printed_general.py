"""(15) and (20) for any body in space, transcribed by hand with the corrections of the dots, term by term.

The appendix is used with the full tensors C4_i and C5_ij and the vectors c6_i and c7_ij. A cloud of free second
moments makes them what they are: C4_i = int rho {(Phi_i . X) I - Phi_i X} and so on are read from G_pq = int rho f_p
f_q^T of the fields X, Phi_1 .. Phi_N, with all entries free symbols.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import sympy as sp

from .printed_appendix import appendix_d1, appendix_D2, appendix_d3, appendix_J

Matrix = Any


def gram(p: int, q: int) -> Matrix:
    """int rho f_p f_q^T, free but for G_qp = G_pq^T; index 0 is X."""
    if p > q:
        return gram(q, p).T
    return sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"g{p}{q}{min(i, j)}{max(i, j)}" if p == q else f"g{p}{q}{i}{j}"))


def first(p: int) -> Matrix:
    """int rho f_p."""
    return sp.Matrix(3, 1, lambda i, j: sp.Symbol(f"f{p}{i}"))


def tensor(p: int, q: int) -> Matrix:
    """int rho {(f_p . f_q) I - f_p f_q}: C3, C4_i (p = i, q = 0), C5_ij."""
    g = gram(p, q)
    return sp.eye(3) * g.trace() - g


def axial(p: int, q: int) -> Matrix:
    """int rho f_p x f_q: c6_i (p = 0, q = i), c7_ij."""
    g = gram(p, q)
    return sp.Matrix([g[1, 2] - g[2, 1], g[2, 0] - g[0, 2], g[0, 1] - g[1, 0]])


@dataclass(frozen=True)
class General:
    """A body with n shapes as (15) has it: motion and d1, D2, d3, J of the appendix."""

    n: int

    @property
    def mass(self) -> sp.Symbol:
        return sp.Symbol("m")

    @property
    def shapes(self) -> range:
        return range(1, self.n + 1)

    def column(self, name: str) -> list[sp.Symbol]:
        return [sp.Symbol(f"alpha{i}{name}") for i in range(1, self.n + 1)]

    @property
    def d1(self) -> Matrix:
        return appendix_d1(first(0), [first(i) for i in self.shapes], self.column(""))

    def D2(self, i: int) -> Matrix:
        return appendix_D2(tensor(i, 0), [tensor(i, j) for j in self.shapes], self.column(""))

    def d3(self, i: int) -> Matrix:
        return appendix_d3(axial(0, i), [axial(i, j) for j in self.shapes], self.column(""))

    @property
    def J(self) -> Matrix:
        C5 = [[tensor(i, j) for j in self.shapes] for i in self.shapes]
        return appendix_J(tensor(0, 0), [tensor(i, 0) for i in self.shapes], C5, self.column(""))


@dataclass(frozen=True)
class PrintedVector:
    """One printed term of a row, a vector for delta c and delta pi."""

    row: str
    text: str
    expr: Matrix


def over(factors: list[sp.Symbol], term: Any) -> Matrix:
    """A row of factors times a column of vectors."""
    return sum((f * term(i) for i, f in enumerate(factors, 1)), sp.zeros(3, 1))


def accelerations() -> tuple[Matrix, Matrix, Matrix]:
    """cddot, omega and omegadot."""
    names = ("c1ddot c2ddot c3ddot", "omega1:4", "omega1dot omega2dot omega3dot")
    return tuple(sp.Matrix(sp.symbols(name)) for name in names)


def equation_15(body: General, q: Matrix) -> tuple[PrintedVector, ...]:
    """The terms of (15), without delta U; q is the rotation tensor."""
    cddot, w, wdot = accelerations()
    alphadot, alphaddot = body.column("dot"), body.column("ddot")
    terms = [
        PrintedVector("c", "m cddot", body.mass * cddot),
        PrintedVector("c", "Q . [w x (w x d1)]", q * w.cross(w.cross(body.d1))),
        PrintedVector("c", "Q . [wdot x d1]", q * wdot.cross(body.d1)),
        PrintedVector("c", "Q . [2 w x (alphadot^T c2)]", q * (2 * w.cross(over(alphadot, first)))),
        PrintedVector("c", "Q . [alphaddot^T c2]", q * over(alphaddot, first)),
        PrintedVector("pi", "d1 x (Q^c . cddot)", body.d1.cross(q.T * cddot)),
        PrintedVector("pi", "w x (J . w)", w.cross(body.J * w)),
        PrintedVector("pi", "J . wdot", body.J * wdot),
        PrintedVector("pi", "2 (alphadot^T D2) . w", over(alphadot, lambda i: 2 * body.D2(i) * w)),
        PrintedVector("pi", "alphaddot^T d3", over(alphaddot, body.d3)),
    ]
    for i in body.shapes:
        c7_alphadot = over(alphadot, lambda j, i=i: axial(i, j))
        c8_alphaddot = sum((a * gram(i, j).trace() for j, a in enumerate(alphaddot, 1)), sp.S.Zero)
        row = f"alpha{i}"
        terms += [
            PrintedVector(row, "cddot . (Q . c2)", sp.Matrix([cddot.dot(q * first(i))])),
            PrintedVector(row, "- w . (D2 . w)", sp.Matrix([-w.dot(body.D2(i) * w)])),
            PrintedVector(row, "wdot . d3", sp.Matrix([wdot.dot(body.d3(i))])),
            PrintedVector(row, "- 2 w . (c7 alphadot)", sp.Matrix([-2 * w.dot(c7_alphadot)])),
            PrintedVector(row, "c8 alphaddot", sp.Matrix([c8_alphaddot])),
        ]
    return tuple(terms)


def equation_20(body: General) -> tuple[PrintedVector, ...]:
    """The terms of (20), without delta U."""
    cddot, w, wdot = accelerations()
    alpha, alphadot, alphaddot = (body.column(dots) for dots in ("", "dot", "ddot"))
    terms = [
        PrintedVector("c", "m cddot", body.mass * cddot),
        PrintedVector("pi", "w x (J . w)", w.cross(body.J * w)),
        PrintedVector("pi", "J . wdot", body.J * wdot),
        PrintedVector("pi", "2 (alphadot^T D2) . w", over(alphadot, lambda i: 2 * body.D2(i) * w)),
        PrintedVector("pi", "alphaddot^T d3", over(alphaddot, body.d3)),
    ]
    for i in body.shapes:
        c7_alpha, c7_alphadot = (over(column, lambda j, i=i: axial(i, j)) for column in (alpha, alphadot))
        c8_alphaddot = sum((a * gram(i, j).trace() for j, a in enumerate(alphaddot, 1)), sp.S.Zero)
        row = f"alpha{i}"
        terms += [
            PrintedVector(row, "- w . (D2 . w)", sp.Matrix([-w.dot(body.D2(i) * w)])),
            PrintedVector(row, "- wdot . (c7 alpha)", sp.Matrix([-wdot.dot(c7_alpha)])),
            PrintedVector(row, "- 2 w . (c7 alphadot)", sp.Matrix([-2 * w.dot(c7_alphadot)])),
            PrintedVector(row, "c8 alphaddot", sp.Matrix([c8_alphaddot])),
        ]
    return tuple(terms)
