"""Conditions that keep rigid motion out of the assumed displacement fields: (16)-(19), (28)-(40).

A frame is a set of linear conditions on v(xi), to which come those that shapes fulfil at the ends of the beam, if they
are asked for. They are solved exactly on the span of the ansatz; what is left are the assumed shapes phi_i of (30) and
(38).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import assert_never

import sympy as sp

from derive.errors import TisserandError
from derive.spec.model.body import AssumedDeflection, Ends, Frame, Polynomial

xi = sp.Symbol("xi")
NOTHING = sp.Poly(0, xi, domain="QQ")


class ConditionError(TisserandError):
    """An ansatz and a frame that do not define a set of assumed modes; `problems` lists a text for each fault."""

    def __init__(self, problems: Iterable[str]) -> None:
        self.problems = tuple(problems)
        super().__init__("; ".join(self.problems))


@dataclass(frozen=True)
class MeanCondition:
    """The mean of xi^power v over the beam vanishes; `equation` is its number in the paper."""

    power: int
    equation: str

    @property
    def text(self) -> str:
        """The condition as an equation."""
        return f"int {'xi ' * self.power}v dxi = 0"

    def on(self, polynomial: sp.Poly) -> sp.Rational:
        """The left-hand side of the condition for v = polynomial."""
        return integral(polynomial * sp.Poly(xi**self.power, xi, domain="QQ"))


@dataclass(frozen=True)
class PointCondition:
    """v, or its derivative of some order, vanishes at a point."""

    order: int
    at: sp.Rational
    equation: str

    @property
    def text(self) -> str:
        """The condition as an equation."""
        return f"v{chr(39) * self.order}({self.at}) = 0"

    def on(self, polynomial: sp.Poly) -> sp.Rational:
        """The left-hand side of the condition for v = polynomial."""
        return (polynomial.diff((xi, self.order)) if self.order else polynomial).eval(self.at)


Condition = MeanCondition | PointCondition
"""A linear condition on v(xi)."""


def integral(polynomial: sp.Poly) -> sp.Rational:
    """The exact integral of a polynomial over the beam, -1 <= xi <= 1."""
    return sum((2 * c / (n + 1) for (n,), c in polynomial.terms() if n % 2 == 0), sp.S.Zero)


def conditions(frame: Frame) -> tuple[Condition, ...]:
    """The conditions of a frame: mean (34), (36); point and tangent v = v' = 0 (28), (29); chord v = 0 twice."""
    at = sp.Rational(frame.at) if frame.at is not None else sp.S.Zero
    if frame.kind == "mean":
        return MeanCondition(0, "(17), (34)"), MeanCondition(1, "(19), (36)")
    if frame.kind in ("point", "tangent"):
        return PointCondition(0, at, "(16), (28)"), PointCondition(1, at, "(29)")
    if frame.kind == "chord":
        return PointCondition(0, sp.S.NegativeOne, "(16)"), PointCondition(0, sp.S.One, "(16)")
    return ()


def end_conditions(ends: Ends | None) -> tuple[Condition, ...]:
    """What shapes fulfil at both ends: v'' = 0 where they are pinned, v'' = v''' = 0 where they are free.

    A pinned end has no bending moment, and a free one no shear force either.
    """
    match ends:
        case None:
            orders: tuple[int, ...] = ()
        case "pinned":
            orders = (2,)
        case "free":
            orders = (2, 3)
        case _ as never:
            assert_never(never)
    return tuple(PointCondition(order, at, "") for order in orders for at in (sp.S.NegativeOne, sp.S.One))


def assumed_shapes(deflection: AssumedDeflection) -> tuple[Polynomial, ...]:
    """The shapes phi_i(xi) that an ansatz leaves in a frame, exactly; coefficients of 1, xi, xi^2, ...

    The conditions remove the lowest ansatz terms, as (28)-(32) and (34)-(40) do. `orthogonal` then makes each shape
    orthogonal to those before it in the mass metric. A shape is scaled so that it is one at xi = 1, or, where it
    vanishes there, so that the first derivative which does not is one: (31), (32), (39), (40).

    Raises ConditionError when the ansatz is linearly dependent, when nothing is left, or when a combination of the
    shapes is a rigid motion.
    """
    polynomials = [exact_polynomial(p) for p in deflection.ansatz]
    dependent = _dependencies(polynomials, [_text(p) for p in polynomials])
    if dependent:
        raise ConditionError(f"the ansatz is linearly dependent: {d} = 0; leave one of these out" for d in dependent)
    left = _solve(polynomials, (*conditions(deflection.frame), *end_conditions(deflection.ends)))
    if not left:
        raise ConditionError([_nothing_left(deflection)])
    if deflection.orthogonal:
        left = _orthogonal(left)
    rigid = _rigid_motions(left)
    if rigid:
        raise ConditionError(rigid)
    shapes = [_normalised(p) for p in left]
    return tuple(tuple(Fraction(int(c.p), int(c.q)) for c in reversed(p.all_coeffs())) for p in shapes)


def exact_polynomial(coefficients: Polynomial) -> sp.Poly:
    """The polynomial in xi over the rational numbers with these coefficients of 1, xi, xi^2, ...; none give zero."""
    return sp.Poly([sp.Rational(c) for c in reversed(coefficients)] or [0], xi, domain="QQ")


@dataclass(frozen=True)
class PieceDeflection:
    """A deflection of a beam as one of its pieces has it: offset + slope xi + sum amplitudes_i phi_i, xi of the piece.

    offset and slope, in the unit of the deflection, are its rigid-body part; amplitudes (shapes,) its deformation.
    """

    offset: Fraction
    slope: Fraction
    amplitudes: tuple[Fraction, ...]


def piece_deflection(
    deflection: Polynomial, shapes: tuple[Polynomial, ...], pieces: int, k: int
) -> PieceDeflection | None:
    """The part of a deflection on piece k, from 0, of `pieces` of equal length; None if the shapes cannot describe it.

    deflection: a polynomial in xi of the whole beam; shapes: those of a piece, which hold no rigid motion.
    """
    local = exact_polynomial(deflection).compose(sp.Poly((2 * k + 1 - pieces + xi) / sp.Integer(pieces), xi))
    fields = [sp.Poly(1, xi, domain="QQ"), sp.Poly(xi, xi, domain="QQ"), *map(exact_polynomial, shapes)]
    weights = next((w for w in _null_vectors([*fields, local]) if w[-1]), None)
    if weights is None:
        return None
    offset, slope, *amplitudes = (Fraction(int(x.p), int(x.q)) for x in (-w / weights[-1] for w in weights[:-1]))
    return PieceDeflection(offset, slope, tuple(amplitudes))


def _text(polynomial: sp.Poly) -> str:
    """A polynomial as the specification writes it."""
    return str(polynomial.as_expr()).replace("**", "^")


def _solve(ansatz: list[sp.Poly], imposed: tuple[Condition, ...]) -> list[sp.Poly]:
    """A basis of the part of span(ansatz) on which all conditions hold; the leading ansatz terms are eliminated."""
    if not imposed:
        return ansatz
    values = sp.Matrix([[condition.on(p) for p in ansatz] for condition in imposed])
    return [_combination(ansatz, vector) for vector in values.nullspace()]


def _combination(polynomials: list[sp.Poly], weights: Iterable[sp.Rational]) -> sp.Poly:
    return sum((p * w for p, w in zip(polynomials, weights, strict=True)), NOTHING)


def _orthogonal(polynomials: list[sp.Poly]) -> list[sp.Poly]:
    """Gram-Schmidt in the mass metric of a uniform beam, in the order of the ansatz."""
    result: list[sp.Poly] = []
    for p in polynomials:
        known = (other * (integral(p * other) / integral(other * other)) for other in result)
        result.append(p - sum(known, NOTHING))
    return result


def _normalised(polynomial: sp.Poly) -> sp.Poly:
    derivative = polynomial
    while derivative.eval(1) == 0:
        derivative = derivative.diff(xi)
    return polynomial * (1 / derivative.eval(1))


def _nothing_left(deflection: AssumedDeflection) -> str:
    frame, ends = deflection.frame, deflection.ends
    asked = " and ".join(c.text for c in conditions(frame)) or "no condition"
    empty = f"the ansatz is empty after the conditions of the {frame.kind} frame ({asked})"
    if ends is not None:
        empty += f" and of {ends} ends ({' and '.join(c.text for c in end_conditions(ends))})"
    return f"{empty}; add polynomials of higher degree"


def _rigid_motions(shapes: list[sp.Poly]) -> list[str]:
    """A message for each rigid motion (a + b xi, the linear part of (18)) that a combination of shapes makes."""
    names = [f"({_text(p)})" for p in shapes]
    rigid = [sp.Poly(1, xi, domain="QQ"), sp.Poly(xi, xi, domain="QQ")]
    messages = []
    for weights in _null_vectors([*rigid, *shapes]):
        motion = _combination(rigid, [-w for w in weights[:2]])
        sign = -1 if motion.LC() < 0 else 1
        kind = "translation" if motion.degree() == 0 else "rotation" if motion.eval(0) == 0 else "rigid motion"
        combination = _sum_text([sign * w for w in weights[2:]], names)
        messages.append(
            f"rigid motion is left in the shapes: {combination} = {_text(sign * motion)}, a {kind}; "
            "the mass matrix would be singular: choose the frame mean, point, chord or tangent, or take it out"
        )
    return messages


def _dependencies(polynomials: list[sp.Poly], names: list[str]) -> list[str]:
    return [_sum_text(weights, [f"({n})" for n in names]) for weights in _null_vectors(polynomials)]


def _null_vectors(polynomials: list[sp.Poly]) -> list[list[sp.Rational]]:
    """Weights, whole numbers, of all independent combinations that vanish identically (exact rank)."""
    height = max(p.degree() for p in polynomials if not p.is_zero) + 1 if any(polynomials) else 1
    columns = [[p.coeff_monomial(xi**n) for n in range(height)] for p in polynomials]
    vectors = (list(vector) for vector in sp.Matrix(columns).T.nullspace())
    return [[w * sp.ilcm(1, *(x.q for x in vector)) for w in vector] for vector in vectors]


def _sum_text(weights: Iterable[sp.Rational], names: list[str]) -> str:
    parts = [f"{'' if w == 1 else '-' if w == -1 else f'{w}*'}{n}" for w, n in zip(weights, names, strict=True) if w]
    return " + ".join(parts).replace("+ -", "- ")
