"""The constraints of trees: joints that close loops, drives of coordinates, and gears, as functions of marker frames.

They are those of straight-line code for frames whose motion has symbols of its own: what a unit multiplier exerts on a
frame is its factor of six virtual motions of this frame.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

from derive.algebra import sp
from derive.lowering.trees.links import BodyPlace, Tree, marker_place
from derive.mechanics.multibody.joints.joint_type import PrescribedMotion
from derive.mechanics.multibody.space.frame_motion import FrameMotion, VirtualMotion
from derive.mechanics.multibody.space.joints import SpatialEliminatedJoint, SpatialJointInstance
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from derive.mechanics.symbols import local
from derive.mechanics.terms import Constraint, EquationOfMotion, Intermediate
from derive.spec.model.instances import identifier
from derive.spec.model.markers import MarkerRef

Joint = TypeVar("Joint", SpatialJointInstance, SpatialEliminatedJoint)
VECTORS = ("position", "velocity", "acceleration", "angular_velocity", "angular_acceleration")
"""The vectors of the motion of a frame."""


@dataclass(frozen=True)
class FrameOnLink:
    """A marker frame with a place on a link; motion: its motion in symbols of its own."""

    place: BodyPlace
    motion: FrameMotion
    rows: tuple[EquationOfMotion, ...]


@dataclass(frozen=True)
class FrameFactor:
    """The force and the torque, inertial, that a unit multiplier of constraint `condition` exerts on frame `frame`."""

    condition: int
    frame: int
    values: tuple[sp.Expr, ...]


@dataclass(frozen=True)
class RowFactor:
    """The factor of a row in the rate of constraint `condition`."""

    condition: int
    row: int
    value: sp.Expr


@dataclass(frozen=True)
class Conditions:
    """The constraints of a tree; definitions: of the prescribed motions, which are functions of the time."""

    every: tuple[Constraint, ...]
    frames: tuple[FrameOnLink, ...]
    rows: tuple[str, ...]
    definitions: tuple[Intermediate, ...]

    @cached_property
    def of_frames(self) -> tuple[FrameFactor, ...]:
        """The loads of all constraints on frames."""
        result = []
        for number, condition in enumerate(self.every):
            factors = dict(condition.jacobian)
            for frame, of in enumerate(self.frames):
                values = tuple(factors.get(row.name, sp.S.Zero) for row in of.rows)
                if any(values):
                    result.append(FrameFactor(number, frame, values))
        return tuple(result)

    @cached_property
    def of_rows(self) -> tuple[RowFactor, ...]:
        """The factors of rows of the tree."""
        rows = {name: number for number, name in enumerate(self.rows)}
        return tuple(
            RowFactor(number, rows[name], value)
            for number, condition in enumerate(self.every)
            for name, value in condition.jacobian
            if name in rows
        )


def conditions_of(mechanism: SpatialMechanism, tree: Tree) -> Conditions:
    """The constraints of a mechanism."""
    frames: dict[MarkerRef, FrameOnLink] = {}
    still = {c.symbol: c.value for c in mechanism.constants}
    definitions: list[Intermediate] = []

    def at(marker: MarkerRef) -> FrameMotion:
        if marker not in frames:
            place = marker_place(mechanism, tree.bodies, marker)
            if place.link < 0:
                return _fixed(place)
            frames[marker] = FrameOnLink(place, *moving_frame(len(frames)))
        return frames[marker].motion

    def driven(joint: Joint) -> Joint:
        if joint.drive is None:
            return joint
        first, second, third = (
            _symbol(joint.drive.name, k, value, definitions) for k, value in enumerate(joint.drive.motion)
        )
        return replace(joint, drive=PrescribedMotion(joint.drive.name, (first, second, third)))

    of = replace(
        mechanism,
        joints=tuple(map(driven, mechanism.joints)),
        eliminated_joints=tuple(map(driven, mechanism.eliminated_joints)),
    )
    for joint in of.joints:
        at(joint.joint.first), at(joint.joint.second)
    for gear in of.gears:
        for name in gear.gear.joints:
            at(of.joints_by_name[name].joint.first), at(of.joints_by_name[name].joint.second)
    every_frame = tuple(frames.values())
    rows = (*mechanism.rows, *(row for frame in every_frame for row in frame.rows))
    every = tuple(
        replace(
            c,
            frames=None,
            **{part: sp.sympify(getattr(c, part)).xreplace(still) for part in ("position", "rate", "bias")},
            jacobian=tuple((name, sp.sympify(value).xreplace(still)) for name, value in c.jacobian),
        )
        for c in of.conditions(at, rows)
    )
    return Conditions(every, every_frame, tuple(row.name for row in mechanism.rows), tuple(definitions))


def _symbol(drive: str, k: int, value: sp.Expr, definitions: list[Intermediate]) -> sp.Expr:
    """A derivative of a prescribed motion: a number, or a symbol with a definition."""
    value = sp.sympify(value)
    if value.is_Rational:
        return value
    symbol = local(identifier("driven", f"{drive}_{k}"))
    definitions.append(Intermediate(symbol, value, drive, "(1)", f"derivative {k} of the motion of {drive}"))
    return symbol


def moving_frame(number: int) -> tuple[FrameMotion, tuple[EquationOfMotion, ...]]:
    """A frame with symbols for all that moves, and six rows that move it."""

    def vector(what: str) -> sp.ImmutableMatrix:
        return sp.ImmutableMatrix([frame_symbol(number, what, k) for k in range(3)])

    rows, virtual = [], []
    for what in ("translation", "rotation"):
        for k in range(3):
            name = f"{what} {k} of frame {number}"
            v, a = (local(f"frame_{number}_{what}_{k}_{dots}") for dots in ("v", "a"))
            rows.append(EquationOfMotion(name, v, a, name, "", ""))
            unit = sp.ImmutableMatrix([sp.S.One if i == k else sp.S.Zero for i in range(3)])
            virtual.append(VirtualMotion(name, **{what: unit}))
    axes = sp.ImmutableMatrix(3, 3, lambda i, j: frame_symbol(number, "axes", 3 * i + j))
    vectors = {what: vector(what) for what in VECTORS}
    return FrameMotion((), axes=axes, virtual=tuple(virtual), **vectors), tuple(rows)


def frame_symbol(frame: int, what: str, k: int) -> sp.Symbol:
    """The symbol of a component of the motion of a frame."""
    return local(f"frame_{frame}_{what}_{k}")


def _fixed(place: BodyPlace) -> FrameMotion:
    """A frame of the ground."""
    none = sp.ImmutableMatrix([0, 0, 0])
    axes = sp.ImmutableMatrix([[sp.sympify(x) for x in row] for row in place.attitude])
    position = sp.ImmutableMatrix([sp.sympify(x) for x in place.origin])
    return FrameMotion((), position, none, none, axes, none, none)
