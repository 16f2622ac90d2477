"""The constraints g = 0 of a joint in space and of its drive, with their Jacobian and bias."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import reduce
from typing import TYPE_CHECKING

from derive.algebra import sp, zero
from derive.mechanics.multibody.space.rows import (
    RelativeFunction,
    derived,
    row_variables,
)
from derive.mechanics.quantity import rounded
from derive.mechanics.terms import Constraint, EquationOfMotion, FramePair
from derive.spec.model.instances import identifier, joined
from derive.spec.model.spatial_scene import SpatialJoint

if TYPE_CHECKING:
    from derive.mechanics.multibody.joints.joint_type import PrescribedMotion
    from derive.mechanics.multibody.space.frame_motion import FrameMotion


def spatial_constraints(
    joint: SpatialJoint,
    relative: tuple[RelativeFunction, ...],
    first: FrameMotion,
    second: FrameMotion,
    drive: PrescribedMotion | None,
    rows: tuple[EquationOfMotion, ...],
) -> tuple[Constraint, ...]:
    """The constraints of a joint and of its drive; `rows` are those of the whole mechanism.

    relative: the functions of its frames that vanish, that of the drive behind the others if there is one.
    """
    texts = {"markers": f"{joint.first} and {joint.second}", "second": joint.second.body, "joint": joint.name}
    result = []
    for row in relative[:-1] if drive else relative:
        doc = row.doc.format(**texts)
        result.append(_constraint(joint, joined(joint.name, row.label), doc, row, first, second, None, rows))
    if drive:
        doc = relative[-1].doc.format(drive=drive.name, **texts)
        result.append(_constraint(joint, drive.name, doc, relative[-1], first, second, drive, rows))
    return tuple(result)


def row_values(
    joint: SpatialJoint, first: FrameMotion, second: FrameMotion, drive: PrescribedMotion | None
) -> dict[sp.Symbol, sp.Expr]:
    """The values of the variables of rows for the frames of a joint."""
    of = row_variables()
    values = of.first.values(first) | of.second.values(second)
    if joint.distance is not None:
        values[of.length] = sp.Rational(joint.distance)
    if joint.pitch is not None:
        values[of.lead] = lead(joint)
    if drive:
        motion = drive.motion
        values |= dict(zip(of.motion, motion, strict=True))
        values |= {of.cos: rounded(sp.cos(motion[0])), of.sin: rounded(sp.sin(motion[0]))}
    return values


def lead(joint: SpatialJoint) -> sp.Expr:
    """The displacement of a screw joint for a rotation of 1 rad, m/rad; zero of other joints."""
    return sp.S.Zero if joint.pitch is None else sp.sympify(joint.pitch) * rounded(1 / (2 * sp.pi))


@dataclass(frozen=True)
class RowMotion:
    """A function of two frames as a function of coordinates: its value, its rate, and the factors of the velocities.

    bias: its second derivative without accelerations. loads: what a unit multiplier exerts on the frames, a force and a
    torque on the first, then on the second, in inertial components.
    """

    value: sp.Expr
    rate: sp.Expr
    bias: sp.Expr
    factors: Mapping[str, sp.Expr]
    loads: tuple[sp.Matrix, ...] = ()
    frames_bias: sp.Expr = field(default_factory=zero)


def row_motion(
    joint: SpatialJoint,
    row: RelativeFunction,
    first: FrameMotion,
    second: FrameMotion,
    drive: PrescribedMotion | None,
    rows: tuple[EquationOfMotion, ...],
) -> RowMotion:
    """A row of a joint, or of its drive, as a function of coordinates."""
    values, of = row_values(joint, first, second, drive), derived(row)
    still = {r.a: sp.S.Zero for r in rows}
    f1, m1, f2, m2 = (vector.xreplace(values) for vector in (of.f1, of.m1, of.f2, of.m2))
    bias = frames_bias = of.bias.xreplace(values)
    for frame, force, torque in ((first, f1, m1), (second, f2, m2)):
        pairs = ((force, frame.acceleration), (torque, frame.angular_acceleration))
        for factors, acceleration in pairs:
            bias += sp.Add(*(f * a.xreplace(still) for f, a in zip(factors, acceleration, strict=True) if f))
    works = (dict(first.work(f1, m1)), dict(second.work(f2, m2)))
    return RowMotion(
        row.g.xreplace(values), of.rate.xreplace(values), bias, reduce(_sum, works), (f1, m1, f2, m2), frames_bias
    )


def _constraint(
    joint: SpatialJoint,
    shown: str,
    doc: str,
    row: RelativeFunction,
    first: FrameMotion,
    second: FrameMotion,
    drive: PrescribedMotion | None,
    rows: tuple[EquationOfMotion, ...],
) -> Constraint:
    motion = row_motion(joint, row, first, second, drive, rows)
    f1, m1, f2, m2 = motion.loads
    return Constraint(
        name=identifier(shown),
        shown=shown,
        of=joint.name,
        doc=doc,
        unit=row.unit,
        force_unit=row.force_unit,
        position=motion.value,
        rate=motion.rate,
        bias=motion.bias,
        jacobian=tuple((r.name, motion.factors[r.name]) for r in rows if motion.factors.get(r.name, 0) != 0),
        frames=FramePair(
            first.constrained(f1, m1),
            second.constrained(f2, m2),
            sp.ImmutableMatrix(m2) if derived(row).turns else None,
            motion.frames_bias,
            (*derived(row).m2, derived(row).bias),
            _prescribed(joint, first, second, drive),
        ),
    )


def _prescribed(
    joint: SpatialJoint, first: FrameMotion, second: FrameMotion, drive: PrescribedMotion | None
) -> tuple[tuple[sp.Symbol, sp.Expr], ...]:
    """The values of the variables of rows besides those of the frames."""
    of, values = row_variables(), row_values(joint, first, second, drive)
    frames = of.first.values(first) | of.second.values(second)
    return tuple((symbol, value) for symbol, value in values.items() if symbol not in frames)


def _sum(a: Mapping[str, sp.Expr], b: Mapping[str, sp.Expr]) -> dict[str, sp.Expr]:
    return {name: a.get(name, sp.S.Zero) + b.get(name, sp.S.Zero) for name in {**a, **b}}
