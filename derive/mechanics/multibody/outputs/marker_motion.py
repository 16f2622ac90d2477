"""Position, velocity, acceleration and rotation of a marker, in the inertial frame or in that of another marker."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from derive.algebra import sp
from derive.mechanics.multibody.outputs.output_type import NamedElements, OutputComponent, OutputComponents, OutputType
from derive.spec.model.keys import Key, KeyType
from derive.spec.model.markers import MarkerRef

if TYPE_CHECKING:
    from derive.mechanics.multibody.point_motion import PointMotion
    from derive.mechanics.multibody.scene_mechanics import SceneMechanics

MARKER = Key("marker", KeyType.MARKER, "", 'The marker, such as "rod.right".', required=True)
FRAME = Key(
    "frame",
    KeyType.MARKER,
    "",
    "Marker whose section is the frame of reference, an observer who moves and turns with it; by default the inertial "
    "frame.",
)

_ORDERS = ("", "time derivative of the ", "second time derivative of the ")


class ObservedMotion(OutputType):
    """A quantity of the motion of a marker that a frame observes, or one of its time derivatives."""

    keys = (MARKER, FRAME)

    def __init__(self, doc: str, order: int, unit: str) -> None:
        self.doc, self.order, self.unit = doc, order, unit


class MarkerVector(ObservedMotion):
    """Two components of the position of a marker, or of one of its time derivatives as the frame observes them."""

    labels = ("1", "2")

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return the components along e1 and e2 of the frame."""
        vector = observed(scene, values["marker"], values.get("frame"))[self.order]
        return OutputComponents(tuple(OutputComponent(str(k), self.unit, vector[k - 1]) for k in (1, 2)))

    def descriptions(self, values: Mapping[str, Any], mechanism: NamedElements) -> tuple[str, ...]:
        """Return the marker, the order of the derivative, the axis and the frame of each component."""
        motion = f"{_ORDERS[self.order]}position of {values['marker']}"
        frame = values.get("frame") or "the inertial frame"
        return f"{motion} along e1 of {frame}", f"{motion} along e2 of {frame}"


class MarkerRotation(ObservedMotion):
    """The rotation of the section at a marker, or one of its time derivatives, relative to the frame."""

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return one component, the rotation about e3 or its time derivative."""
        frame = values.get("frame")
        rotation = scene.point(values["marker"]).rotation_derivatives[self.order]
        if frame is not None:
            rotation -= scene.point(frame).rotation_derivatives[self.order]
        return OutputComponents((OutputComponent("", self.unit, sp.expand(rotation)),))

    def descriptions(self, values: Mapping[str, Any], mechanism: NamedElements) -> tuple[str, ...]:
        """Return the marker, the order of the derivative and the frame."""
        against = values.get("frame") or "the inertial frame"
        return (f"{_ORDERS[self.order]}rotation of the section at {values['marker']} against {against}",)


class Distance(OutputType):
    """The distance of two markers."""

    doc = "the distance of two markers"
    keys = (Key("between", KeyType.MARKER_PAIR, "", 'Two markers, such as ["ground.o", "rod.right"].', required=True),)

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return one component, the distance."""
        from derive.mechanics.motion.vectors import length_of
        from derive.mechanics.multibody.point_motion import RelativeMotion

        first, second = values["between"]
        displacement, _, _ = RelativeMotion(scene.point(first), scene.point(second)).displacement
        return OutputComponents((OutputComponent("", "m", length_of(displacement)),))

    def descriptions(self, values: Mapping[str, Any], mechanism: NamedElements) -> tuple[str, ...]:
        """Return both markers."""
        first, second = values["between"]
        return (f"distance from {first} to {second}",)


class Inclination(OutputType):
    """The angle of the line from one marker to another, counted from e1 of the frame, between -pi and pi."""

    doc = "the angle of the line from one marker to another, between -pi and pi"
    keys = (*Distance.keys, FRAME)

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return one component, the angle."""
        from derive.mechanics.time_functions import Atan2

        frame = values.get("frame")
        ends = (observed(scene, marker, frame)[0] for marker in values["between"])
        first, second = map(sp.Matrix, ends)
        along = second - first
        return OutputComponents((OutputComponent("", "rad", Atan2(along[1], along[0])),))

    def descriptions(self, values: Mapping[str, Any], mechanism: NamedElements) -> tuple[str, ...]:
        """Return both markers and the frame."""
        first, second = values["between"]
        return (
            f"angle of the line from {first} to {second}, from e1 of {values.get('frame') or 'the inertial frame'}",
        )


def observed(scene: SceneMechanics, marker: MarkerRef, frame: MarkerRef | None) -> tuple[sp.Matrix, ...]:
    """Position, velocity and acceleration (columns of 2) of a marker as an observer in a frame measures them.

    With r the vector from the origin of the frame, Q its rotation and w its angular velocity, the components in the
    frame are s = Q^T r, sdot = Q^T rdot - w e3 x s, sddot = Q^T rddot - 2 w e3 x sdot - wdot e3 x s + w^2 s.
    """
    from derive.mechanics.multibody.point_motion import RelativeMotion

    at = scene.point(marker)
    if frame is None:
        return at.position, at.velocity, at.acceleration
    origin = scene.point(frame)
    position, velocity, acceleration = RelativeMotion(origin, at).displacement
    transposed = rotation_matrix(origin).T
    _, omega, omegadot = origin.rotation_derivatives
    s = transposed * position
    sdot = transposed * velocity - omega * across(s)
    sddot = transposed * acceleration - 2 * omega * across(sdot) - omegadot * across(s) + omega**2 * s
    return s, sdot, sddot


def rotation_matrix(at: PointMotion) -> sp.Matrix:
    """The rotation of the section at a point."""
    cosine, sine = sp.cos(at.rotation), sp.sin(at.rotation)
    return sp.Matrix([[cosine, -sine], [sine, cosine]])


def across(vector: sp.Matrix) -> sp.Matrix:
    """The vector product e3 x vector."""
    return sp.Matrix([-vector[1], vector[0]])
