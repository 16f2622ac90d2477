"""The poses of the undeformed bodies of a scene at t = 0, with joints and drives closed, for drawings."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from derive.algebra import sp
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.multibody.point_motion import PointMotion, RelativeMotion, fixed_point
from derive.simulation.inputs import with_functions
from derive.simulation.observables.motion import body_coordinates, drive_values, si_value, transformed
from derive.spec.model.joints import CustomJoint, Joint
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.quantity import Parameter
from derive.spec.model.scene import Scene, SceneInput
from derive.spec.model.time_function import TimeFunction

Array = NDArray[np.float64]
Poses = Mapping[str, Array]

ZERO = TimeFunction("number", value=Fraction(0))
STEPS, CLOSED, DIFFERENCE = 80, 1e-10, 1e-7
"""Newton steps, the residual at which the loops are closed, and the step of differences (m, rad)."""


def initial_poses(scene: Scene) -> dict[str, Array]:
    """(x, y, angle) of each undeformed body at t = 0, in m and rad.

    Newton's method starts from the initial guesses of the specification and closes the joints and drives. Where it
    finds no closed configuration, the poses are those of the guesses. Run-time inputs without a function are zero.
    """
    scene = with_functions(replace(scene, inputs=inputs_or_zero(scene.inputs)), {})
    names = [body.name for body in scene.bodies]
    starts = (body.start for body in scene.bodies)
    guess: Array = np.array([[*(s.position or (0.0, 0.0)), s.angle or 0.0] for s in starts], dtype=float).ravel()

    def residual(values: Array) -> Array:
        poses = _by_name(names, values)
        return np.array([r for joint in scene.joints for r in _residuals(scene, joint, poses)])

    return _by_name(names, closed(residual, guess, np.ones(len(guess))))


def inputs_or_zero(inputs: Iterable[SceneInput]) -> tuple[SceneInput, ...]:
    """Run-time inputs, which are zero where they have no function."""
    return tuple(replace(value, function=value.function or ZERO) for value in inputs)


def closed(residual: Callable[[Array], Array], start: Array, mobility: Array) -> Array:
    """The values next to the start at which a residual vanishes, by Newton's method; the start if it finds none.

    mobility: the weights of the changes of values, which are the least.
    """
    values = start.copy()
    for _ in range(STEPS):
        error = residual(values)
        if not error.size or np.abs(error).max() < CLOSED:
            return values
        columns = [(residual(values + unit) - error) / DIFFERENCE for unit in DIFFERENCE * np.eye(len(values))]
        values = values - mobility * np.linalg.lstsq(np.array(columns).T * mobility, error, rcond=1e-6)[0]
    return values if np.abs(residual(values)).max() < 1e3 * CLOSED else start


def _by_name(names: list[str], values: Array) -> dict[str, Array]:
    poses = {name: values[3 * k : 3 * k + 3] for k, name in enumerate(names)}
    return {GROUND: np.zeros(3), **poses}


def position(scene: Scene, marker: MarkerRef, poses: Poses) -> Array:
    """The position (2,) of a marker in the inertial frame, with rods undeformed, in m."""
    body = next((b for b in scene.bodies if b.name == marker.body), None)
    if isinstance(body, BeamBody):
        at = next(m.at for m in body.beam.markers if m.name == marker.marker)
        point = np.array([float(at) * si_value(body.beam.length) / 2, 0.0])
    else:
        point = body_coordinates(scene, marker)
    return transformed_point(poses[marker.body], point)


def transformed_point(pose: Array, point: Array) -> Array:
    """The position (2,) in the inertial frame of a point of a body, from the pose (x, y, angle) of the body."""
    moved: Array = transformed(pose[None, :], point)[0]
    return moved


def _residuals(scene: Scene, joint: Joint, poses: Poses) -> Iterator[float]:
    """The constraints of a joint and its drive, or its initial coordinate, from the equations of its type."""
    joint_type = JOINTS[joint.kind]
    relative = RelativeMotion(
        *(_still(position(scene, end, poses), poses[end.body][2]) for end in (joint.first, joint.second))
    )
    if isinstance(joint, CustomJoint):
        joint = replace(
            joint, values={k: si_value(v) if isinstance(v, Parameter) else v for k, v in joint.values.items()}
        )
    equations = joint_type.equations(joint, relative)
    known = {definition.symbol: definition.expr for definition in equations.definitions}
    for row, (residual, _, _) in zip(joint_type.removes, equations.residuals, strict=True):
        value = float(sp.sympify(residual).xreplace(known))
        yield _angle(value) if row.unit == "rad" else value
    drive = next((d for d in scene.drives if d.joint == joint.name), None)
    prescribed = float(drive_values(drive, np.zeros(1))[0]) if drive else joint.start.coordinate
    if prescribed is not None and joint_type.driven and equations.driven:
        value = float(sp.sympify(equations.driven[0]).xreplace(known)) - prescribed
        yield _angle(value) if joint_type.driven.unit == "rad" else value


def _still(at: Array, rotation: float) -> PointMotion:
    """The motion of a marker at rest."""
    return replace(fixed_point(sp.Matrix(at)), rotation=sp.Float(rotation))


def _angle(value: float) -> float:
    """The angle between -pi and pi that is equal to an angle modulo 2 pi."""
    return math.remainder(float(value), 2 * math.pi)
