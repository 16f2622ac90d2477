"""Joints and the motions of markers that stand for others in loops over instances, in the plane or in space."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, TypeAlias

from derive.algebra import sp
from derive.mechanics.axes import AXES
from derive.mechanics.multibody.kinds import JointInstance
from derive.mechanics.multibody.point_motion import PointMotion, fixed_point
from derive.mechanics.multibody.space.frame_motion import FrameMotion, fixed_axes, fixed_frame, still
from derive.mechanics.multibody.space.joints import SpatialEliminatedJoint, SpatialJointInstance
from derive.mechanics.multibody.space.mechanism import AnyMechanism, SpatialMechanism
from derive.mechanics.symbols import local
from derive.spec.model.markers import GROUND, MarkerRef

AnyJoint: TypeAlias = "JointInstance | SpatialJointInstance"
"""A joint of a mechanism in the plane or in space."""


@dataclass(frozen=True)
class Dimension:
    """The plane or space.

    still: the motion of a marker at rest in 0; other: any motion of a marker, without acceleration, in `symbols`.
    """

    still: Any
    other: Any
    symbols: tuple[sp.Symbol, ...]


@cache
def plane() -> Dimension:
    """The plane, in which markers are points with a rotation angle."""
    symbols = tuple(local(f"other_{what}") for what in ("x1", "x2", "v1", "v2", "angle", "speed"))
    here = fixed_point(sp.Matrix([0, 0]))
    other = PointMotion(
        definitions=(),
        position=sp.ImmutableMatrix(symbols[0:2]),
        velocity=sp.ImmutableMatrix(symbols[2:4]),
        acceleration=here.acceleration,
        rotation=symbols[4],
        angular_velocity=symbols[5],
        angular_acceleration=sp.S.Zero,
    )
    return Dimension(here, other, symbols)


@cache
def space() -> Dimension:
    """Space, in which markers are frames."""

    def vector(name: str) -> sp.ImmutableMatrix:
        return sp.ImmutableMatrix([local(f"other_{name}{k}") for k in AXES])

    position, velocity, spin = vector("x"), vector("v"), vector("w")
    axes = sp.ImmutableMatrix(3, 3, lambda i, j: local(f"other_axis{j + 1}_{i + 1}"))
    other = FrameMotion((), position, velocity, still(), axes, spin, still())
    symbols = (*position, *velocity, *axes, *spin)
    here = fixed_frame(sp.zeros(3, 1), fixed_axes())
    return Dimension(here, other, symbols)


def dimension_of(mechanism: AnyMechanism) -> Dimension:
    """The dimension of a mechanism."""
    return space() if isinstance(mechanism, SpatialMechanism) else plane()


def of_joint(joint: AnyJoint) -> Dimension:
    """The dimension of the mechanism of a joint."""
    return space() if isinstance(joint, SpatialJointInstance) else plane()


def plain_joint(joint: AnyJoint | SpatialEliminatedJoint) -> Hashable:
    """A joint without its name and the bodies that it connects."""
    nowhere, of = MarkerRef(GROUND, ""), joint.joint
    start: Any = type(of.start)()
    return replace(of, name="", first=nowhere, second=nowhere, start=start)
