"""The constraints of joints, and the relative coordinates that drives prescribe, as scalars of the configuration."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import astuple, replace

import numpy as np

from derive.algebra import sp
from derive.lowering.kept_function import Expressions, kept_function
from derive.mechanics.multibody.bodies.beam import piece_name
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.symbols import amplitude_of
from derive.runtime.native_scene import NativeScene
from derive.simulation.initial.kinematics import Kinematics, Linear
from derive.simulation.observables.beams import fields_of, half_length
from derive.simulation.observables.motion import body_coordinates, si_value
from derive.spec.model.beam_pieces import piece_of, place_in_piece
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.instances import joined
from derive.spec.model.joints import CustomJoint, Joint, JointInitialValues
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.quantity import Parameter
from derive.spec.model.scene import Scene

Function = Callable[[Kinematics], Linear]

COMPONENTS = 6
"""The number of positions and rotations of the two markers of a joint."""
NOWHERE = MarkerRef(GROUND, "")
"""A marker on which the rows of a joint do not depend."""


def residuals(scene: Scene, joint: Joint, native: NativeScene) -> tuple[Function, ...]:
    """The residuals that a joint makes zero, in the order of its multipliers."""
    rows = range(len(JOINTS[joint.kind].removes))
    return _functions(scene, joint, native, rows)


def driven_coordinate(scene: Scene, joint: Joint, native: NativeScene) -> Function:
    """The relative coordinate that a drive of the joint prescribes; its type has one."""
    (function,) = _functions(scene, joint, native, (len(JOINTS[joint.kind].removes),))
    return function


def _functions(scene: Scene, joint: Joint, native: NativeScene, rows: Iterable[int]) -> tuple[Function, ...]:
    """Rows of a joint as functions of the configuration: those that it removes, then that of a drive, by number."""
    markers = [_marker(scene, marker, native) for marker in (joint.first, joint.second)]
    if isinstance(joint, CustomJoint):
        values = {key: si_value(x) if isinstance(x, Parameter) else x for key, x in joint.values.items()}
        joint = replace(joint, values=values)
    alike = replace(joint, name="joint", first=NOWHERE, second=NOWHERE, start=JointInitialValues())
    evaluate = kept_function("joint", repr(astuple(alike)), lambda: _rows_with_gradients(alike), not JOINTS.extended)

    def function(row: int) -> Function:
        first = row * (1 + COMPONENTS)

        def linear(kinematics: Kinematics) -> Linear:
            parts = [part for marker in markers for part in marker(kinematics)]
            value, *factors = evaluate([part.value for part in parts])[first : first + 1 + COMPONENTS]
            rates = [part.scaled(factor) for part, factor in zip(parts, factors, strict=True)]
            total = sum(rates, start=kinematics.constant(0.0))
            return Linear(value, total.gradient, total.drift)

        return linear

    return tuple(map(function, rows))


def _rows_with_gradients(joint: Joint) -> Expressions:
    """Positions and rotations of two markers, and each row of a joint of them with its derivatives by these."""
    from derive.mechanics.multibody.point_motion import RelativeMotion, fixed_point

    symbols = sp.symbols("x1 y1 phi1 x2 y2 phi2")
    ends = [replace(fixed_point(sp.Matrix(symbols[n : n + 2])), rotation=symbols[n + 2]) for n in (0, 3)]
    equations = JOINTS[joint.kind].equations(joint, RelativeMotion(*ends))
    known = {definition.symbol: definition.expr for definition in equations.definitions}
    driven = () if equations.driven is None else (equations.driven,)
    rows = [sp.sympify(of).xreplace(known) for of, *_ in (*equations.residuals, *driven)]
    return symbols, [expr for row in rows for expr in (row, *(row.diff(symbol) for symbol in symbols))]


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
    columns = [native.coordinates.index(amplitude_of(piece, i).shown) for i in range(1, len(fields) + 1)]
    gradients = np.zeros((2, native.nq))  # of du/dx and dv/dx
    for field, column in zip(fields, columns, strict=True):
        gradients[field.axis - 1, column] = float(field.of.derivative().at(place)) / half_length(beam)
    name, at_rest = joined(beam.name, marker), np.zeros(native.nv)
    second_order = beam.beam.order is not DisplacementOrder.FIRST_ORDER

    def function(kinematics: Kinematics) -> tuple[Linear, ...]:
        x, _, values = native.marker(name, kinematics.q, at_rest, kinematics.k)
        jacobian = native.marker_pattern(name).dense(values)
        strain, slope = (Linear(float(gradient @ kinematics.q), gradient, 0.0) for gradient in gradients)
        if second_order:  # a section turns by dv/dx - dv/dx du/dx
            change = (1.0 - strain.value) * slope.gradient - slope.value * strain.gradient
            slope = Linear((1.0 - strain.value) * slope.value, change, 0.0)
        turned = Linear(slope.value, kinematics.chained(slope.gradient), 0.0)
        position = (Linear(float(x[i]), kinematics.chained(jacobian[i]), 0.0) for i in range(2))
        return (*position, kinematics.component(piece, 2) + turned)

    return function
