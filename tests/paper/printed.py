"""The printed equations of Koppens, Sauren, Veldpaus and van Campen (1988) that the results are compared with.

(21) to (41) are the lines of the audit, evaluated: they are typed there and nowhere else. (4) to (6) and (9) are
transcribed by hand. Nothing here is derived.
The available text of the paper has lost most of its dots; they are restored, and
`test_printed_against_brute_force` shows that with them the equations are right.
Numbers in names are the paper's equation numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import sympy

from .audit_lines import left, lines, right, sides, zero
from .formula_value import Meaning, Names, Value, scalar, tensor

ROWS = ("c1", "c2", "phi", "alpha1", "alpha2")
"""The virtual displacements whose coefficients are printed in (33) and (41), in the paper's order."""

m, l, EI = sympy.symbols("m l EI")  # noqa: E741 - the paper's letters
c1, c2, phi, alpha1, alpha2 = sympy.symbols("c1 c2 phi alpha1 alpha2")
c1dot, c2dot, phidot, alpha1dot, alpha2dot = sympy.symbols("c1dot c2dot phidot alpha1dot alpha2dot")
c1ddot, c2ddot, phiddot, alpha1ddot, alpha2ddot = sympy.symbols("c1ddot c2ddot phiddot alpha1ddot alpha2ddot")
xi = sympy.Symbol("xi")
a0, a1, a2, a3 = sympy.symbols("a0 a1 a2 a3")

DOTS = {"": "", "'": "dot", "''": "ddot"}
SYMBOLS = {"m": m, "l": l, "EI": EI, "xi": xi, "a_0": a0, "a_1": a1, "a_2": a2, "a_3": a3}
SYMBOLS |= {f"phi{dots}": sympy.Symbol(f"phi{rate}") for dots, rate in DOTS.items()}
SYMBOLS |= {
    f"{q}{dots}_{i}": sympy.Symbol(f"{q}{i}{rate}")
    for q in ("c", "alpha")
    for i in (1, 2)
    for dots, rate in DOTS.items()
}
NAMES: Names = {name: scalar(symbol) for name, symbol in SYMBOLS.items()} | {
    f"e_{k + 1}": tensor(sympy.eye(3)[:, k]) for k in range(3)
}
"""The meaning of the names in (21) to (41)."""


def meaning(**others: sympy.Expr) -> Meaning:
    """The meaning of the lines of the beam where further names have these values; v is a polynomial in xi."""
    names = {**NAMES, **{name: scalar(value) for name, value in others.items()}}
    if "v" in others:
        names["second derivative"] = scalar(sympy.diff(others["v"], xi, 2))

    def along_the_beam(integrand: Callable[[Names], Value]) -> Value:
        return scalar(sympy.integrate(sympy.expand(integrand(names).data.item()), (xi, -1, 1)))

    return Meaning(names, along_the_beam)


def expression(number: str, **others: sympy.Expr) -> sympy.Expr:
    """The right side of a line."""
    return right(number, meaning(**others)).data.item()


def matrix(number: str, **others: sympy.Expr) -> Any:
    """The right side of a line, a vector 3 x 1 or a tensor 3 x 3."""
    return sympy.Matrix(right(number, meaning(**others)).data.tolist())


def vanishing(number: str, **others: sympy.Expr) -> sympy.Expr:
    """The left side of a line that sets it to zero."""
    assert zero(right(number, meaning(**others)).data)
    return left(number, meaning(**others)).data.item()


@dataclass(frozen=True)
class PrintedTerm:
    """One term of one row, so that a test can leave out, or turn the sign of, each term by itself."""

    row: str
    expr: sympy.Expr


def row_sum(terms: Iterable[PrintedTerm], row: str) -> sympy.Expr:
    """The coefficient of one virtual displacement: the sum of its terms."""
    return sympy.Add(*(term.expr for term in terms if term.row == row))


def printed_terms(number: str) -> tuple[PrintedTerm, ...]:
    """The terms of the rows of (33) or (41); common factors are multiplied into the terms that they stand before."""
    result = []
    for row, line in zip(ROWS, lines(number), strict=True):
        assert line.split(":")[0].removeprefix("delta ").replace("_", "") == row
        total = meaning().value(sides(number, line)[1]).data.item()
        result += [PrintedTerm(row, term) for term in sympy.Add.make_args(sympy.expand(total))]
    return tuple(result)


EQUATION_33 = printed_terms("33")
"""Conditions on a selected material point, shapes (31) and (32)."""

EQUATION_41 = printed_terms("41")
"""Conditions on mean displacements, shapes (39) and (40)."""


# The beam: ansatz, conditions, shapes, strain energy, rotation.

DISPLACEMENT_21 = expression("21")

# A condition is given as the expression that it sets to zero.
CONDITION_28 = vanishing("28")
CONDITION_29 = vanishing("29")
CONDITION_35 = vanishing("35")
CONDITION_37 = vanishing("37")

SHAPE_31 = expression("31")
SHAPE_32 = expression("32")
SHAPE_39 = expression("39")
SHAPE_40 = expression("40")

POINT_SHAPES = (SHAPE_31, SHAPE_32)
MEAN_SHAPES = (SHAPE_39, SHAPE_40)

ROTATION_26 = matrix("26")
TRANSLATION_23 = matrix("23")
POSITION_24 = matrix("24")


def displacement_30(shape1: sympy.Expr, shape2: sympy.Expr) -> sympy.Expr:
    """(30): the displacement free of rigid motion."""
    return expression("30", **{"ϕ_1": shape1, "ϕ_2": shape2})


def displacement_38(shape1: sympy.Expr, shape2: sympy.Expr) -> sympy.Expr:
    """(38): the same line as (30)."""
    return expression("38", **{"ϕ_1": shape1, "ϕ_2": shape2})


def displacement_25(v: sympy.Expr) -> sympy.Matrix:
    """(25): u for a lateral displacement v."""
    return matrix("25", v=v)


def axial_27(rate: sympy.Expr) -> sympy.Matrix:
    """(27): omega for the rate of phi, delta pi for its variation."""
    at = meaning(**{"phi'": rate, "δ phi": rate})
    omega, variation = (at.value(sides("27", line)[1]).data.tolist() for line in lines("27"))
    assert omega == variation
    return sympy.Matrix(omega)


def strain_energy_22(v: sympy.Expr) -> sympy.Expr:
    """(22): the strain energy of the beam for a lateral displacement v, a polynomial in xi."""
    return expression("22", v=v)


def mean_displacement_34(v: sympy.Expr) -> sympy.Expr:
    """(34): what has to vanish for the center of mass not to be displaced."""
    return vanishing("34", v=v)


def mean_rotation_36(v: sympy.Expr) -> sympy.Expr:
    """(36): what has to vanish for u and X to be on a mean parallel."""
    return vanishing("36", v=v)


# The body in three dimensions. Vectors are 3 x 1, tensors 3 x 3; r stands for X + u.


def deformation_4(Q: sympy.Matrix, gradient: sympy.Matrix) -> sympy.Matrix:
    """(4): F from the rotation and from nabla u, whose entry (i, j) is the derivative of u_j by X_i."""
    return Q * (sympy.eye(3) + gradient.T)


def acceleration_5(
    cddot: sympy.Matrix,
    Q: sympy.Matrix,
    omega: sympy.Matrix,
    omegadot: sympy.Matrix,
    r: sympy.Matrix,
    udot: sympy.Matrix,
    uddot: sympy.Matrix,
) -> sympy.Matrix:
    """(5): the acceleration of a material point; omega and omegadot in the body base."""
    return cddot + Q * (omega.cross(omega.cross(r)) + omegadot.cross(r) + 2 * omega.cross(udot) + uddot)


def virtual_displacement_6(
    delta_c: sympy.Matrix, Q: sympy.Matrix, delta_pi: sympy.Matrix, r: sympy.Matrix, delta_u: sympy.Matrix
) -> sympy.Matrix:
    """(6): the virtual displacement of a material point (the printed text puts two dots too many on it)."""
    return delta_c + Q * (delta_pi.cross(r) + delta_u)


def green_lagrange_9(F: sympy.Matrix) -> sympy.Matrix:
    """(9): the Green-Lagrange strain."""
    return (F.T * F - sympy.eye(3)) / 2
