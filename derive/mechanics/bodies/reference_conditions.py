"""Conditions that keep rigid motion out of the assumed displacement fields: (16)-(19), (28)-(40).

A frame is a set of linear conditions on v(xi), to which come those that shapes fulfil at the ends of the beam, if they
are asked for. They are solved exactly on the span of an ansatz of polynomials; what is left are the assumed shapes
phi_i of (30) and (38). The shapes of a family are known, and have to fulfil the conditions.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from math import lcm
from typing import assert_never

from derive.enumerations import enumeration
from derive.errors import TisserandError, quoted
from derive.mechanics.bodies.beam_functions import (
    LEFT,
    NOTHING,
    ONE,
    RIGHT,
    XI,
    BeamFunction,
    Real,
    fraction,
    polynomial,
)
from derive.mechanics.bodies.shape_families import family_shapes
from derive.mechanics.exact_nullspace import nullspace
from derive.spec.model.beam_parts import FAMILY_FRAMES, AssumedDeflection, Ends, Frame, Polynomial, ShapeFamily


class ConditionError(TisserandError):
    """An ansatz and a frame do not define a set of assumed modes; `problems` lists a text for each fault."""

    def __init__(self, problems: Iterable[str]) -> None:
        self.problems = tuple(problems)
        super().__init__("; ".join(self.problems))


@dataclass(frozen=True)
class MeanCondition:
    """The condition that the mean of xi^power v over the beam vanishes; `equation` is its number in the paper."""

    power: int
    equation: str

    @property
    def text(self) -> str:
        """The condition as an equation."""
        return f"int {'xi ' * self.power}v dxi = 0"

    def on(self, v: BeamFunction) -> Real:
        """The left-hand side of the condition."""
        return (v * XI if self.power else v).integral()


@dataclass(frozen=True)
class PointCondition:
    """The condition that v, or its derivative of some order, vanishes at a point."""

    order: int
    at: Fraction
    equation: str

    @property
    def text(self) -> str:
        """The condition as an equation."""
        return f"v{chr(39) * self.order}({self.at}) = 0"

    def on(self, v: BeamFunction) -> Real:
        """The left-hand side of the condition."""
        return v.derivative(self.order).at(self.at)


Condition = MeanCondition | PointCondition
"""A linear condition on v(xi)."""


def conditions(frame: Frame) -> tuple[Condition, ...]:
    """The conditions of a frame: mean (34), (36); point and tangent v = v' = 0 (28), (29); chord v = 0 twice."""
    at = frame.at if frame.at is not None else Fraction(0)
    if frame.kind == "mean":
        return MeanCondition(0, "(17), (34)"), MeanCondition(1, "(19), (36)")
    if frame.kind in ("point", "tangent"):
        return PointCondition(0, at, "(16), (28)"), PointCondition(1, at, "(29)")
    if frame.kind == "chord":
        return PointCondition(0, LEFT, "(16)"), PointCondition(0, RIGHT, "(16)")
    return ()


def end_conditions(ends: Ends | None) -> tuple[Condition, ...]:
    """The conditions of shapes at both ends: v'' = 0 where they are pinned, v'' = v''' = 0 where they are free.

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
    return tuple(PointCondition(order, at, "") for order in orders for at in (LEFT, RIGHT))


@cache
def assumed_shapes(deflection: AssumedDeflection) -> tuple[BeamFunction, ...]:
    """The shapes phi_i(xi) that an ansatz leaves in a frame, exactly, or those of a family.

    The conditions remove the lowest ansatz terms, as (28)-(32) and (34)-(40) do. `orthogonal` then makes each shape
    orthogonal to those before it in the mass metric. A shape is scaled so that it is one at xi = 1, or, where it
    vanishes there, so that the first derivative which does not is one: (31), (32), (39), (40).

    Raises ConditionError when the ansatz is linearly dependent, when nothing is left, when a combination of the shapes
    is a rigid motion, or when a family does not fulfil the conditions.
    """
    if isinstance(deflection.ansatz, ShapeFamily):
        return _family(deflection.ansatz, deflection.frame)
    polynomials = [polynomial(p) for p in deflection.ansatz]
    dependent = dependencies(polynomials)
    if dependent:
        raise ConditionError(f"the ansatz is linearly dependent: {d} = 0; leave one of these out" for d in dependent)
    left = _solve(polynomials, (*conditions(deflection.frame), *end_conditions(deflection.ends)))
    if not left:
        raise ConditionError([_nothing_left(deflection, polynomials)])
    if deflection.orthogonal:
        left = orthogonalised(left)
    rigid = _rigid_motions(left)
    if rigid:
        raise ConditionError(rigid)
    return tuple(map(normalised, left))


def _family(family: ShapeFamily, frame: Frame) -> tuple[BeamFunction, ...]:
    """The shapes of a family, if all of them fulfil the conditions of a frame."""
    shapes, suitable = family_shapes(family), FAMILY_FRAMES[family.kind]
    failed = [c.text for c in conditions(frame) if any(c.on(shape) for shape in shapes)]
    if failed:
        at = f" at the end {suitable.at}" if suitable.at is not None else ""
        text = f"{family.kind} shapes do not fulfil {' and '.join(failed)} of the {frame.kind} frame; they are for the "
        raise ConditionError([f"{text}frame {suitable.kind}{at}, which they have if `frame` is left out"])
    return shapes


LINE, CONSTANT = (ONE, XI), (ONE,)
"""The rigid motions in a deflection, and in a twist."""


@dataclass(frozen=True)
class PieceDeflection:
    """A deflection of a beam as one of its pieces has it: offset + slope xi + sum amplitudes_i phi_i, xi of the piece.

    offset and slope, in the unit of the deflection, are its rigid-body part; amplitudes (shapes,) its deformation. A
    twist has no slope.
    """

    offset: Fraction
    slope: Fraction
    amplitudes: tuple[Fraction, ...]


def piece_deflection(
    deflection: Polynomial,
    shapes: tuple[BeamFunction, ...],
    pieces: int,
    k: int,
    rigid: tuple[BeamFunction, ...] = LINE,
) -> PieceDeflection | None:
    """The part of a deflection on piece k, from 0, of `pieces` of equal length; None if the shapes cannot describe it.

    deflection: a polynomial in xi of the whole beam; shapes: the shapes of a piece, which contain no rigid motion;
    rigid: LINE, or CONSTANT of a twist.
    """
    local = on_piece(deflection, pieces, k)
    exact = [shape for shape in shapes if shape.is_exact]  # a polynomial holds nothing of the others
    weights = next((w for w in _null_vectors([*rigid, *exact, local]) if w[-1]), None)
    if weights is None:
        return None
    parts = [-w / weights[-1] for w in weights[:-1]]
    offset, slope = (*parts[: len(rigid)], Fraction(0))[:2]
    amplitudes = tuple(parts[len(rigid) :]) if exact else (Fraction(0),) * len(shapes)
    return PieceDeflection(offset, slope, amplitudes)


def on_piece(of_beam: Polynomial, pieces: int, k: int) -> BeamFunction:
    """A polynomial in xi of a beam as one in xi of its piece k, from 0, of `pieces` of equal length."""
    along = polynomial([Fraction(2 * k + 1 - pieces, pieces), Fraction(1, pieces)])
    result = NOTHING
    for c in reversed(of_beam):
        result = result * along + polynomial([c])
    return result


def _solve(ansatz: list[BeamFunction], imposed: tuple[Condition, ...]) -> list[BeamFunction]:
    """A basis of the part of span(ansatz) on which all conditions hold; the leading ansatz terms are eliminated."""
    if not imposed:
        return ansatz
    values = [[fraction(condition.on(p)) for p in ansatz] for condition in imposed]
    return [_combination(ansatz, vector) for vector in nullspace(values, len(ansatz))]


def _combination(functions: list[BeamFunction], weights: Iterable[Fraction]) -> BeamFunction:
    return sum((f.scaled(w) for f, w in zip(functions, weights, strict=True)), NOTHING)


def orthogonalised(polynomials: list[BeamFunction]) -> list[BeamFunction]:
    """Orthogonalise shapes by Gram-Schmidt in the mass metric of a uniform beam, in the order of the ansatz."""
    result: list[BeamFunction] = []
    for p in polynomials:
        known = (other.scaled((p * other).integral() / (other * other).integral()) for other in result)
        result.append(p - sum(known, NOTHING))
    return result


def normalised(shape: BeamFunction) -> BeamFunction:
    """The shape scaled so that it is one at xi = 1, or where it vanishes there its first derivative that does not."""
    derivative = shape
    while derivative.at(RIGHT) == 0:
        derivative = derivative.derivative()
    return shape.scaled(1 / derivative.at(RIGHT))


def _nothing_left(deflection: AssumedDeflection, ansatz: Sequence[BeamFunction]) -> str:
    frame, ends = deflection.frame, deflection.ends
    asked = " and ".join(c.text for c in conditions(frame)) or "no condition"
    empty = f"the ansatz is empty after the conditions of the {frame.kind} frame ({asked})"
    if ends is not None:
        empty += f" and of {ends} ends ({' and '.join(c.text for c in end_conditions(ends))})"
    missing = [quoted(p.text) for p in (ONE, XI) if p not in ansatz]
    advice = f"{enumeration(missing)}, which the conditions use up" if missing else "polynomials of higher degree"
    return f"{empty}; add {advice}"


def _rigid_motions(shapes: list[BeamFunction]) -> list[str]:
    """A message for each rigid motion (a + b xi, the linear part of (18)) that a combination of shapes makes."""
    names = [f"({p.text})" for p in shapes]
    messages = []
    for a, b, *weights in _null_vectors([ONE, XI, *shapes]):
        sign = 1 if (b or a) < 0 else -1
        motion = polynomial([-sign * a, -sign * b])
        kind = "translation" if not b else "rotation" if not a else "rigid motion"
        combination = _sum_text([sign * w for w in weights], names)
        messages.append(
            f"rigid motion is left in the shapes: {combination} = {motion.text}, a {kind}; "
            "the mass matrix would be singular: choose the frame mean, point, chord or tangent, or take it out"
        )
    return messages


def dependencies(polynomials: list[BeamFunction]) -> list[str]:
    """The combinations of polynomials that vanish identically, as texts."""
    return [_sum_text(weights, [f"({p.text})" for p in polynomials]) for weights in _null_vectors(polynomials)]


def _null_vectors(polynomials: list[BeamFunction]) -> list[list[Fraction]]:
    """The integer weights of all independent combinations that vanish identically (exact rank)."""
    height = max(1, *(len(p.coefficients) for p in polynomials))
    columns = [[*p.coefficients, *[Fraction(0)] * (height - len(p.coefficients))] for p in polynomials]
    vectors = nullspace([*zip(*columns, strict=True)], len(polynomials))
    return [[w * lcm(*(x.denominator for x in vector)) for w in vector] for vector in vectors]


def _sum_text(weights: Iterable[Fraction], names: list[str]) -> str:
    parts = [f"{'' if w == 1 else '-' if w == -1 else f'{w}*'}{n}" for w, n in zip(weights, names, strict=True) if w]
    return " + ".join(parts).replace("+ -", "- ")
