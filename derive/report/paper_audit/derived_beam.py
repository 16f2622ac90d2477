"""The derived equations of the paper's beam: its kinematics, the conditions of both frames, (33) and (41)."""

from __future__ import annotations

from fractions import Fraction as Exact
from functools import cache

from derive.algebra import sp
from derive.derivation import derive
from derive.mechanics.bodies.beam import beam_point
from derive.mechanics.bodies.reference_conditions import assumed_shapes, conditions
from derive.mechanics.equations import Equations
from derive.mechanics.motion.kinematics import ONE
from derive.mechanics.motion.planar import planar_motion
from derive.report.document.formula import Equation, Fenced, Formula, FormulaRow, Name, Part
from derive.report.notation.beam_functions import shape_name
from derive.report.notation.expressions import Notation, notation, number
from derive.report.notation.formula_reader import formula
from derive.report.sections.frame import ansatz_equation, condition_equation, on_ansatz, shape_equations
from derive.spec.construction.bodies import planar_beam
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import Frame, Marker

FRAMES = {"point": Frame("point", Exact(0)), "mean": Frame("mean")}
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
    return tuple(Equation(how.variation(name), how.parts(result.row(name)), relation=":") for name in how.rows)


def ansatz() -> tuple[Equation, ...]:
    """The deflection v of (21), from the default ansatz of a beam."""
    return (ansatz_equation(beam("mean")),)


def strain_energy() -> tuple[Equation, ...]:
    """The strain energy U in both frames."""
    return tuple(_energy(frame, equations(frame)) for frame in FRAMES)


def _energy(frame: str, of: Equations) -> Equation:
    return Equation(Name("U", below=(frame,)), notation(of).parts(of.substituted(of.strain_energy)))


def translation() -> tuple[Equation, ...]:
    """The position c of the origin in its components."""
    return (Equation(formula("c"), PLAIN.vector(MOTION.position[ONE])),)


def points() -> tuple[Equation, ...]:
    """The undeformed positions X of three markers."""
    result = []
    for marker in beam("mean").markers:
        point = beam_point(marker, beam("mean"))
        values = {c.symbol: c.value for c in point.coefficients}
        result.append(Equation(_at("X", marker), PLAIN.vector(point.position.xreplace(values))))
    return tuple(result)


def displacements() -> tuple[Equation, ...]:
    """The displacements u of three markers of the beam in the mean frame."""
    result = []
    for marker in beam("mean").markers:
        shapes = beam_point(marker, beam("mean")).shapes
        total = sum((shape * alpha for shape, alpha in zip(shapes, MOTION.alpha, strict=True)), sp.zeros(2, 1))
        result.append(Equation(_at("u", marker), PLAIN.vector(total)))
    return tuple(result)


def _at(letter: str, marker: Marker) -> Formula:
    return FormulaRow((Name(letter, style="vector"), Fenced(number(sp.Rational(marker.at)))))


def rotation() -> tuple[Equation, ...]:
    """The rotation tensor Q in the plane."""
    return (Equation(formula("Q"), (Part("+", PLAIN.matrix(MOTION.rotation)),)),)


def spin() -> tuple[Equation, ...]:
    """The tensor whose axial vector is omega, by differentiation of Q; delta pi in the same way."""
    generator = PLAIN.matrix(MOTION.frame.angular_velocity_tensor / MOTION.frame.omega[0])
    return (
        Equation(formula("Q^c . Q'"), (Part("+", FormulaRow((formula("phi'"), generator))),)),
        Equation(formula("Q^c . delta Q"), (Part("+", FormulaRow((formula("delta phi"), generator))),)),
    )


def condition(frame: Frame, k: int) -> tuple[Equation, ...]:
    """A condition of a frame on v, as the derivation uses it."""
    return (condition_equation(conditions(frame)[k]),)


def on_the_cubic(frame: str, k: int) -> tuple[Equation, ...]:
    """A condition as an equation for a0 .. a3."""
    return (on_ansatz(beam(frame))[k].equation,)


def expansion(frame: str) -> tuple[Equation, ...]:
    """The deflection v as a sum over the shapes of a frame."""
    alphas = zip(MOTION.alpha, assumed_shapes(beam(frame).deflection), strict=True)
    terms = (FormulaRow((PLAIN.formula(alpha), shape_name(str(k)))) for k, (alpha, _) in enumerate(alphas, 1))
    return (Equation(Name("v"), tuple(Part("+", term) for term in terms)),)


def shape(frame: str, k: int) -> tuple[Equation, ...]:
    """A shape of a frame: a combination of the ansatz that satisfies the conditions."""
    return (shape_equations(beam(frame))[k - 1],)
