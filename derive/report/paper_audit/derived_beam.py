"""The derived equations of the paper's beam: its kinematics, the conditions of both frames, (33) and (41)."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction as Exact
from functools import cache
from typing import assert_never

import sympy as sp

from derive.derivation import derive
from derive.mechanics.bodies.beam import beam_point
from derive.mechanics.bodies.beam_functions import BeamFunction, polynomial, rational
from derive.mechanics.bodies.reference_conditions import (
    Condition,
    MeanCondition,
    PointCondition,
    assumed_shapes,
    conditions,
)
from derive.mechanics.equations import Equations
from derive.mechanics.motion.kinematics import ONE
from derive.mechanics.motion.planar import planar_motion
from derive.report.document.formula import Equation, Formula, FormulaRow, Matrix, Name, NumberToken, Part
from derive.report.notation.beam_functions import beam_function
from derive.report.notation.expressions import Notation, notation
from derive.report.notation.formula_reader import equation, formula
from derive.report.sections.frame import polynomials
from derive.spec.construction import planar_beam
from derive.spec.model.body import Frame, Marker, PlanarBeam

FRAMES = {"point": Frame("point", Exact(0)), "mean": Frame("mean")}
AMPLITUDES = sp.symbols("a0 a1 a2 a3")
MOTION = planar_motion(2)
PLAIN = Notation()


@cache
def beam(frame: str) -> PlanarBeam:
    """The free beam of the paper: nothing is specified but its frame and three markers."""
    return planar_beam("audit", frame=FRAMES[frame], markers={"left": -1, "inside": "1/3", "right": 1})


@cache
def equations(frame: str) -> Equations:
    """The equations of motion of the paper's beam."""
    result = derive(beam(frame)).expanded()
    assert isinstance(result, Equations)
    return result


def rows(frame: str) -> tuple[Equation, ...]:
    """Each equation of motion, with its virtual displacement before it."""
    result = equations(frame)
    how = notation(result)
    return tuple(
        Equation(
            FormulaRow((formula("delta"), how.formula(coordinate.q))),
            how.parts(result.row(str(coordinate.q))),
            relation=":",
        )
        for coordinate in result.coordinates
    )


def ansatz() -> tuple[Equation, ...]:
    """The deflection v of (21), from the default ansatz of a beam."""
    pairs = zip(AMPLITUDES, polynomials(beam("mean")), strict=True)
    terms = sp.Add(*(a * rational(c) * sp.Symbol("xi") ** n for a, p in pairs for n, c in enumerate(p)))
    parts = [Part("+", PLAIN.formula(terms.coeff(a) * a)) for a in AMPLITUDES]
    return (Equation(formula("v", scalars=True), tuple(parts)),)


def strain_energy() -> tuple[Equation, ...]:
    """The strain energy U in both frames."""
    return tuple(
        Equation(Name("U", below=(frame,)), notation(equations(frame)).parts(_expanded(frame))) for frame in FRAMES
    )


def _expanded(frame: str) -> sp.Expr:
    result = equations(frame)
    return result.substituted(result.strain_energy)


def translation() -> tuple[Equation, ...]:
    """The position c of the origin in its components."""
    return (Equation(formula("c"), _components(MOTION.position[ONE])),)


def points() -> tuple[Equation, ...]:
    """The undeformed positions X of three markers."""
    result = []
    for marker in beam("mean").markers:
        point = beam_point(marker, beam("mean"))
        values = {c.symbol: c.value for c in point.coefficients}
        result.append(Equation(_at("X", marker), _components(point.position.xreplace(values))))
    return tuple(result)


def displacements() -> tuple[Equation, ...]:
    """The displacements u of three markers of the beam in the mean frame."""
    result = []
    for marker in beam("mean").markers:
        shapes = beam_point(marker, beam("mean")).shapes
        total = sum((shape * alpha for shape, alpha in zip(shapes, MOTION.alpha, strict=True)), sp.zeros(2, 1))
        result.append(Equation(_at("u", marker), _components(total)))
    return tuple(result)


def _at(letter: str, marker: Marker) -> Formula:
    return FormulaRow((Name(letter, style="vector"), formula(f"({marker.at})", scalars=True)))


def _components(vector: sp.Matrix) -> tuple[Part, ...]:
    parts = []
    for k, entry in enumerate(vector, 1):
        if entry != 0:
            negative = entry.could_extract_minus_sign()
            base = Name("e", below=(str(k),), style="vector")
            parts.append(
                Part("-" if negative else "+", FormulaRow((PLAIN.factor(-entry if negative else entry), base)))
            )
    return tuple(parts)


def rotation() -> tuple[Equation, ...]:
    """The rotation tensor Q in the plane."""
    return (Equation(formula("Q"), (Part("+", _matrix(MOTION.rotation)),)),)


def spin() -> tuple[Equation, ...]:
    """The tensor whose axial vector is omega, by differentiation of Q; delta pi in the same way."""
    varied = MOTION.frame.angular_velocity_tensor.xreplace({MOTION.frame.omega[0]: sp.Symbol("delta_phi")})
    variation = Matrix(tuple(tuple(None if e == 0 else _varied(e) for e in varied.row(k)) for k in range(varied.rows)))
    return (
        Equation(formula("Q^c . Q'"), (Part("+", _matrix(MOTION.frame.angular_velocity_tensor)),)),
        Equation(formula("Q^c . delta Q"), (Part("+", variation),)),
    )


def _varied(entry: sp.Expr) -> Formula:
    return formula("- delta phi" if entry.could_extract_minus_sign() else "delta phi", scalars=True)


def _matrix(matrix: sp.Matrix) -> Matrix:
    return Matrix(tuple(tuple(None if e == 0 else PLAIN.formula(e) for e in matrix.row(k)) for k in range(matrix.rows)))


def condition(frame: str, k: int, at: Exact | None = None) -> tuple[Equation, ...]:
    """A condition of a frame on v, as the derivation uses it."""
    return (_written(_condition(frame, k, at)),)


def _written(condition: Condition) -> Equation:
    """A condition in the notation of the paper, whose slopes are written as dv/dxi."""
    match condition:
        case MeanCondition(power):
            factors = "xi " * power
            return equation(f"int {factors}v dxi = 0", scalars=True)
        case PointCondition(order, at):
            return equation(f"{'(dv/dxi)' if order else 'v'}({at}) = 0", scalars=True)
        case _:
            assert_never(condition)


def condition_on_the_cubic(frame: str, k: int) -> tuple[Equation, ...]:
    """A condition as an equation for a0 .. a3, from its value on each power of xi."""
    value = _condition(frame, k).on
    total = sum((a * rational(value(polynomial([0] * n + [1]))) for n, a in enumerate(AMPLITUDES)), sp.S.Zero)
    return (Equation(_sum(a * total.coeff(a) for a in AMPLITUDES), (Part("+", NumberToken("0")),)),)


def _condition(frame: str, k: int, at: Exact | None = None) -> Condition:
    given = Frame("mean") if frame == "mean" else Frame("point", Exact(0) if at is None else at)
    return conditions(given)[k]


def _sum(terms: Iterable[sp.Expr]) -> Formula:
    return PLAIN.formula(sp.Add(*terms))


def expansion(frame: str) -> tuple[Equation, ...]:
    """The deflection v as a sum over the shapes of a frame."""
    shapes = _shapes(frame)
    parts = []
    for k, alpha in zip(range(1, len(shapes) + 1), MOTION.alpha, strict=True):
        parts.append(Part("+", FormulaRow((PLAIN.formula(alpha), Name("phi", below=(str(k),)), formula("(xi)")))))
    return (Equation(formula("v", scalars=True), tuple(parts)),)


def shape(frame: str, k: int) -> tuple[Equation, ...]:
    """A shape of a frame: a combination of the ansatz that satisfies the conditions."""
    left = FormulaRow((Name("phi", below=(str(k),)), formula("(xi)")))
    return (Equation(left, beam_function(_shapes(frame)[k - 1])),)


def _shapes(frame: str) -> tuple[BeamFunction, ...]:
    result = beam(frame)
    return assumed_shapes(result.deflection)
