"""The initial values of a scene as targets: scalars of the configuration, and the values that they should have."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction

from derive.mechanics.bodies.deflection_projection import projection
from derive.mechanics.bodies.reference_conditions import PieceDeflection
from derive.mechanics.multibody.bodies.beam import piece_name
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.symbols import amplitude_of
from derive.runtime.native_scene import NativeScene
from derive.simulation.initial.joint_functions import Function, driven_coordinate
from derive.simulation.initial.kinematics import Kinematics, Linear
from derive.simulation.observables.beams import half_length, shape_functions
from derive.spec.model.joints import Joint, JointInitialValues
from derive.spec.model.planar_bodies import BeamBody, SceneBody
from derive.spec.model.scene import Scene


class Strength(Enum):
    """The strength of a target: how an initial state treats it."""

    GIVEN = "kept"
    GUESS = "approached, as far as what is given allows"
    DEFAULT = "not specified: approached with what freedom is left"


class KeyOfTarget:
    """The key of a specification that gives a target its value."""

    table: str
    key: str
    angular: bool
    rate: bool

    @property
    def path(self) -> str:
        """The key with its table, such as bodies.rod.start.angle."""
        return f"{self.table}.{self.key}"

    @property
    def unit(self) -> str:
        """The unit of the value."""
        return ("rad" if self.angular else "m") + ("/s" if self.rate else "")


@dataclass(frozen=True, eq=False)
class Target(KeyOfTarget):
    """A scalar of the configuration and its value, or with `rate` the value of its time derivative, in SI units.

    table, key: its table and key in the specification, such as bodies.rod.start and angle; label: the object that it
    belongs to, where the key has several; angular: whether it is an angle (rad), not a length (m); amplitude: the
    number of the coordinate, if the target is a modal amplitude.
    """

    table: str
    key: str
    label: str
    value: float
    strength: Strength
    angular: bool
    rate: bool
    function: Function
    amplitude: int | None = None

    @property
    def name(self) -> str:
        """The key with its label."""
        return f"{self.path} ({self.label})" if self.label else self.path


def targets(scene: Scene, native: NativeScene) -> tuple[Target, ...]:
    """All targets of a scene: what it gives or guesses of bodies, joints and drives, and defaults of the positions."""
    result = [target for body in scene.bodies for target in _of_body(body, native)]
    joints = {joint.name: joint for joint in scene.joints}
    for joint in scene.joints:
        result += _of_joint(scene, joint, joint.start, f"joints.{joint.name}", native)
    for drive in scene.drives:
        result += _of_joint(scene, joints[drive.joint], drive.start, f"drives.{drive.name}", native)
    return tuple(result)


# ---- bodies ----


@dataclass(frozen=True)
class _Piece:
    """A piece of a body, whose straight axis is displaced by `offset` (m) and rotated by `slope` (rad) against that of
    the whole; offset_rate and slope_rate are their rates (m/s, rad/s)."""

    name: str
    offset: float = 0.0
    slope: float = 0.0
    offset_rate: float = 0.0
    slope_rate: float = 0.0


def _of_body(body: SceneBody, native: NativeScene) -> Iterator[Target]:
    start, path = body.start, f"bodies.{body.name}.start"
    given = Strength.GUESS if start.guess else Strength.GIVEN
    pieces = _pieces(body)
    for i in range(2):
        at = start.position
        strength = Strength.DEFAULT if at is None else given
        value = 0.0 if at is None else at[i]
        yield Target(path, "position", f"component {i + 1}", value, strength, False, False, _origin(pieces, i))
    strength = Strength.DEFAULT if start.angle is None else given
    yield Target(path, "angle", "", start.angle or 0.0, strength, True, False, _rotation(pieces))
    for i, component in enumerate(start.velocity or ()):
        yield Target(path, "velocity", f"component {i + 1}", component, given, False, True, _origin(pieces, i))
    if start.spin is not None:
        yield Target(path, "spin", "", start.spin, given, True, True, _rotation(pieces))
    if isinstance(body, BeamBody):
        for rate, key, curve in (
            (False, "deflection", start.deflection),
            (True, "deflection_rate", start.deflection_rate),
        ):
            strength = Strength.DEFAULT if curve is None else given
            for name, value in _amplitudes(body, curve):
                j = native.coordinates.index(name)
                if curve is not None or not rate:
                    yield Target(path, key, name, value, strength, False, rate, _coordinate(j), j)


def _pieces(body: SceneBody) -> tuple[_Piece, ...]:
    if not isinstance(body, BeamBody):
        return (_Piece(body.name),)
    bent, bending = (piece_deflections(body, curve) for curve in (body.start.deflection, body.start.deflection_rate))
    per_length = 1.0 / half_length(body)
    return tuple(
        _Piece(
            piece_name(body, k),
            float(bent[k].offset),
            float(bent[k].slope) * per_length,
            float(bending[k].offset),
            float(bending[k].slope) * per_length,
        )
        for k in range(body.pieces)
    )


def piece_deflections(beam: BeamBody, curve: tuple[Fraction, ...] | None) -> tuple[PieceDeflection, ...]:
    """A deflection (None for a straight beam) on each piece of a beam: the nearest that its shapes have."""
    shapes = shape_functions(beam)
    if not curve:
        return (PieceDeflection(Fraction(0), Fraction(0), (Fraction(0),) * len(shapes)),) * beam.pieces
    return projection(curve, shapes, beam.pieces).parts


def _amplitudes(beam: BeamBody, curve: tuple[Fraction, ...] | None) -> Iterator[tuple[str, float]]:
    """The names of the modal amplitudes of all pieces, and their values."""
    for k, part in enumerate(piece_deflections(beam, curve)):
        for i, value in enumerate(part.amplitudes, 1):
            yield amplitude_of(piece_name(beam, k), i).shown, float(value)


def _origin(pieces: tuple[_Piece, ...], i: int) -> Function:
    """Component i of the mean position of the straight axes of the pieces, c - offset n with their normals n."""

    def function(kinematics: Kinematics) -> Linear:
        total = kinematics.constant(0.0)
        for piece in pieces:
            phi = kinematics.component(piece.name, 2)
            angle = phi.value - piece.slope
            normal = (-math.sin(angle), math.cos(angle))[i]
            tangent = (math.cos(angle), math.sin(angle))[i]  # minus the derivative of the normal by the angle
            drift = piece.offset * tangent * (phi.drift - piece.slope_rate) - piece.offset_rate * normal
            shift = Linear(-piece.offset * normal, piece.offset * tangent * phi.gradient, drift)
            total = total + kinematics.component(piece.name, i) + shift
        return total.scaled(1.0 / len(pieces))

    return function


def _rotation(pieces: tuple[_Piece, ...]) -> Function:
    """The mean rotation of the straight axes of the pieces."""

    def function(kinematics: Kinematics) -> Linear:
        total = kinematics.constant(0.0)
        for piece in pieces:
            phi = kinematics.component(piece.name, 2)
            total = total + Linear(phi.value - piece.slope, phi.gradient, phi.drift - piece.slope_rate)
        return total.scaled(1.0 / len(pieces))

    return function


def _coordinate(j: int) -> Function:
    return lambda kinematics: kinematics.coordinate(j)


# ---- joints and drives ----


def _of_joint(
    scene: Scene, joint: Joint, start: JointInitialValues, path: str, native: NativeScene
) -> Iterator[Target]:
    if start.coordinate is None and start.speed is None:
        return
    strength = Strength.GUESS if start.guess else Strength.GIVEN
    driven = JOINTS[joint.kind].driven
    assert driven is not None, "the specification refuses initial values of other joints"
    function = driven_coordinate(scene, joint, native)
    angular = driven.unit == "rad"
    if start.coordinate is not None:
        key = "angle" if start.angle is not None else "displacement"
        yield Target(f"{path}.start", key, "", start.coordinate, strength, angular, False, function)
    if start.speed is not None:
        yield Target(f"{path}.start", "speed", "", start.speed, strength, angular, True, function)
