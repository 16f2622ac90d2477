"""The initial values of a scene as targets: scalars of the configuration, and the values that they should have."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from enum import Enum
from fractions import Fraction

import numpy as np
import sympy as sp

from derive.mechanics.bodies.deflection_projection import projection
from derive.mechanics.bodies.reference_conditions import PieceDeflection
from derive.mechanics.multibody.bodies.beam import piece_name, piece_of, place_in_piece
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.multibody.point_motion import RelativeMotion, fixed_point
from derive.mechanics.symbols import amplitude, owned
from derive.runtime.native_scene import NativeScene
from derive.simulation.initial.kinematics import Kinematics, Linear
from derive.simulation.observables.beams import fields_of, half_length, shape_functions
from derive.simulation.observables.motion import body_coordinates, si_value
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.quantity import Parameter
from derive.spec.model.scene import BeamBody, CustomJoint, Joint, JointInitialValues, Scene, SceneBody

Function = Callable[[Kinematics], Linear]


class Strength(Enum):
    """How an initial state treats a target."""

    GIVEN = "kept"
    GUESS = "approached, as far as what is given allows"
    DEFAULT = "not specified: approached with what freedom is left"


@dataclass(frozen=True, eq=False)
class Target:
    """A scalar of the configuration and its value, or with `rate` the value of its time derivative, in SI units.

    path: the key of the specification, such as bodies.rod.start.angle; label: what it is of, where the key holds
    several; angular: whether it is an angle (rad), not a length (m); amplitude: the number of the coordinate, if the
    target is a modal amplitude.
    """

    path: str
    label: str
    value: float
    strength: Strength
    angular: bool
    rate: bool
    function: Function
    amplitude: int | None = None

    @property
    def unit(self) -> str:
        """The unit of the value."""
        return ("rad" if self.angular else "m") + ("/s" if self.rate else "")

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
        yield Target(f"{path}.position", f"component {i + 1}", value, strength, False, False, _origin(pieces, i))
    strength = Strength.DEFAULT if start.angle is None else given
    yield Target(f"{path}.angle", "", start.angle or 0.0, strength, True, False, _rotation(pieces))
    for i, component in enumerate(start.velocity or ()):
        yield Target(f"{path}.velocity", f"component {i + 1}", component, given, False, True, _origin(pieces, i))
    if start.spin is not None:
        yield Target(f"{path}.spin", "", start.spin, given, True, True, _rotation(pieces))
    if isinstance(body, BeamBody):
        for rate, key, curve in (
            (False, "deflection", start.deflection),
            (True, "deflection_rate", start.deflection_rate),
        ):
            strength = Strength.DEFAULT if curve is None else given
            for name, value in _amplitudes(body, curve):
                j = native.coordinates.index(name)
                if curve is not None or not rate:
                    yield Target(f"{path}.{key}", name, value, strength, False, rate, _coordinate(j), j)


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
            yield owned(amplitude(i), piece_name(beam, k)).name, float(value)


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
    function = _relative(scene, joint, native)
    angular = driven.unit == "rad"
    if start.coordinate is not None:
        key = "angle" if start.angle is not None else "displacement"
        yield Target(f"{path}.start.{key}", "", start.coordinate, strength, angular, False, function)
    if start.speed is not None:
        yield Target(f"{path}.start.speed", "", start.speed, strength, angular, True, function)


def _relative(scene: Scene, joint: Joint, native: NativeScene) -> Function:
    """The relative coordinate of a joint, from the equations of its type in the motions of its markers."""
    symbols = sp.symbols("x1 y1 phi1 x2 y2 phi2")
    ends = [replace(fixed_point(sp.Matrix(symbols[3 * n : 3 * n + 2])), rotation=symbols[3 * n + 2]) for n in range(2)]
    if isinstance(joint, CustomJoint):
        values = {key: si_value(x) if isinstance(x, Parameter) else x for key, x in joint.values.items()}
        joint = replace(joint, values=values)
    equations = JOINTS[joint.kind].equations(joint, RelativeMotion(*ends))
    assert equations.driven is not None, "a type with a driven coordinate has its equation"
    known = {definition.symbol: definition.expr for definition in equations.definitions}
    expression = sp.sympify(equations.driven[0]).xreplace(known)
    evaluate = sp.lambdify([symbols], [expression, *(expression.diff(symbol) for symbol in symbols)], "math")
    markers = [_marker(scene, marker, native) for marker in (joint.first, joint.second)]

    def function(kinematics: Kinematics) -> Linear:
        parts = [part for marker in markers for part in marker(kinematics)]
        value, *factors = evaluate([part.value for part in parts])
        rates = [part.scaled(float(factor)) for part, factor in zip(parts, factors, strict=True)]
        total = sum(rates, start=kinematics.constant(0.0))
        return Linear(float(value), total.gradient, total.drift)

    return function


def _marker(scene: Scene, marker: MarkerRef, native: NativeScene) -> Callable[[Kinematics], tuple[Linear, ...]]:
    """Position (m) and rotation (rad) of the section at a marker."""
    body = next((b for b in scene.bodies if b.name == marker.body), None)
    if isinstance(body, BeamBody):
        return _on_beam(body, marker.marker, native)
    point = body_coordinates(scene, marker)

    def function(kinematics: Kinematics) -> tuple[Linear, ...]:
        if marker.body == GROUND:
            return tuple(map(kinematics.constant, (*point, 0.0)))
        frame = [kinematics.component(marker.body, i) for i in range(3)]
        cos, sin = math.cos(frame[2].value), math.sin(frame[2].value)
        x, y = map(float, point)
        rotated = (cos * x - sin * y, sin * x + cos * y)
        arms = [
            Linear(arm, rate * frame[2].gradient, rate * frame[2].drift)
            for arm, rate in zip(rotated, (-rotated[1], rotated[0]), strict=True)
        ]
        return (*(frame[i] + arms[i] for i in range(2)), frame[2])

    return function


def _on_beam(beam: BeamBody, marker: str, native: NativeScene) -> Callable[[Kinematics], tuple[Linear, ...]]:
    """Position and rotation of the section at a marker of a beam.

    The position is that of the generated code, which includes the shortening of a beam of second order. A beam keeps
    all of its coordinates, so that its markers do not depend on the time.
    """
    at = next(m.at for m in beam.beam.markers if m.name == marker)
    piece, place, fields = piece_name(beam, piece_of(at, beam.pieces)), place_in_piece(at, beam.pieces), fields_of(beam)
    columns = [native.coordinates.index(owned(amplitude(i), piece).name) for i in range(1, len(fields) + 1)]
    gradients = np.zeros((2, native.nq))  # of du/dx and dv/dx
    for field, column in zip(fields, columns, strict=True):
        gradients[field.axis - 1, column] = float(field.of.derivative().at(place)) / half_length(beam)
    name, at_rest = f"{beam.name}_{marker}", np.zeros(native.nv)
    second_order = beam.beam.order is not DisplacementOrder.FIRST_ORDER

    def function(kinematics: Kinematics) -> tuple[Linear, ...]:
        x, _, values = native.marker(name, kinematics.q, at_rest, kinematics.k)
        jacobian = native.marker_pattern(name).dense(values)
        strain, slope = (Linear(float(gradient @ kinematics.q), gradient, 0.0) for gradient in gradients)
        if second_order:  # a section turns by dv/dx - dv/dx du/dx
            change = (1.0 - strain.value) * slope.gradient - slope.value * strain.gradient
            slope = Linear((1.0 - strain.value) * slope.value, change, 0.0)
        return (*(Linear(float(x[i]), jacobian[i], 0.0) for i in range(2)), kinematics.component(piece, 2) + slope)

    return function
