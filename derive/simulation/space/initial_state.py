"""The initial state of a scene in space: its initial values made consistent with its joints."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from derive.errors import Problem, SpecError
from derive.mechanics.prescribed_motion import drive_motion
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import max_norm
from derive.simulation.configurations import normalised
from derive.simulation.constraints.closest_state import CONSISTENT, RATES_CONSISTENT, unmet_constraints
from derive.simulation.constraints.redundancy import check_accelerations, check_constraints
from derive.simulation.drive_jumps import check_start
from derive.simulation.equilibrium import equilibrium
from derive.simulation.errors import InconsistentInitialState
from derive.simulation.initial.initial_state import InitialState, check_rest
from derive.simulation.initial.targets import Strength
from derive.simulation.linear.steady_rotation import steady_rotation
from derive.simulation.observables.motion import si_value
from derive.simulation.space.assembly import SpatialAssembler, assembled
from derive.simulation.space.attitudes import check_attitudes, misalignment, open_joints
from derive.simulation.space.bent_beams import check_deflections, initial_remainders
from derive.simulation.space.guess import guessed_configuration
from derive.simulation.space.marker_frames import own_frame
from derive.simulation.space.rotating_axes import rotating_axes_of
from derive.simulation.space.targets import SpatialTarget, spatial_targets
from derive.simulation.space.velocities import spatial_velocities
from derive.spec.model.scene import EQUILIBRIUM, STEADY
from derive.spec.model.spatial_bodies import SpatialRigidBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.time_function import value_at

KEPT = 1e-8
"""Given values that are missed by more than this (rad; parts of the size of the scene or of the velocities) contradict
the joints or each other."""


def spatial_scene_state(
    scene: SpatialScene, native: NativeScene, k: Vector | None = None, near: Vector | None = None
) -> InitialState:
    """The initial state of a scene in space at t = 0: it meets joints and drives and keeps the values that are given.

    Positions that are not given come as near as possible to guesses; velocities that are not given have the least
    kinetic energy. With `start = "equilibrium"` or `"steady"` the positions are those of an equilibrium or of a steady
    rotation next to these. native: the compiled scene. k: the constants (nk,) of `native.setup`. near: the
    configuration (nq,) from which a steady rotation is sought, if not from the initial state.

    Raises SpecError with given values that contradict the joints or each other, with the joints that cannot be met, and
    with joints that are met the wrong way round; InconsistentInitialState where it is velocities that cannot be met;
    ExcessiveDeformation where joints bend a beam too far.
    """
    check_start(scene)
    constants = native.setup() if k is None else k
    assembler = SpatialAssembler(native, constants, 0.0, spatial_scene_size(scene))
    targets = spatial_targets(scene, native)
    positions = [target for target in targets if not target.rate]
    guess = guessed_configuration(scene, native, constants, assembler.size)
    assembly = assembled(assembler, guess, positions)
    state = assembly.state
    if not state.converged:
        if problems := open_joints(scene, assembler.poses(state.q), state.g):
            raise SpecError(problems)
        raise InconsistentInitialState("positions", unmet_constraints(native, state.g, CONSISTENT), 0.0)
    q = normalised(native, state.q)
    check_attitudes(scene, assembler.poses(q))
    check_deflections(scene, native, q)
    balance, motion = None, None
    if scene.start == EQUILIBRIUM:
        check_rest(scene, native, constants)
        balance = equilibrium(native, constants, q)
        q = normalised(native, balance.q)
    elif scene.start is None:
        given = positions if assembly.kept else _contradicting(assembler, guess, positions)
        _refuse_missed(scene, assembler, given, q, None)
    rates = [target for target in targets if target.rate]
    v = spatial_velocities(assembler, q, rates, _momentum(scene, assembler, q))
    if scene.start == STEADY:
        axes = rotating_axes_of(scene, assembler.poses(q), rates, v)
        motion = steady_rotation(native, constants, q if near is None else near, axes, assembler.size)
        q, v = motion.q, motion.v
    error = max_norm(native.constraint_rates(0.0, q, v, constants))
    if error > RATES_CONSISTENT * max(1.0, max_norm(v)):
        check_constraints(native, constants, 0.0, q)
        unmet = unmet_constraints(native, native.constraint_rates(0.0, q, v, constants))
        raise InconsistentInitialState("velocities", unmet, 0.0)
    if motion is None:
        _refuse_missed(scene, assembler, rates, q, v)
    check_constraints(native, constants, 0.0, q)
    check_accelerations(native, constants, 0.0, q, v)
    met = max_norm(native.constraints(0.0, q, constants))
    remainders = initial_remainders(scene)
    return InitialState(
        0.0, q, v, met, error, assembly.deformed, False, equilibrium=balance, remainders=remainders, steady=motion
    )


def spatial_scene_size(scene: SpatialScene) -> float:
    """The diagonal (m) of the box around all markers, with bodies where they start; 1 of a point."""
    points = [np.array([si_value(x) for x in m.position]) for m in scene.ground]
    for body in scene.bodies:
        at = np.array(body.start.position or (0.0, 0.0, 0.0))
        points.append(at)
        points += [at + own_frame(m, body).position for m in body.markers]
    return float(np.linalg.norm(np.ptp(np.array(points), axis=0))) or 1.0


def _contradicting(
    assembler: SpatialAssembler, guess: Vector, targets: Sequence[SpatialTarget]
) -> Sequence[SpatialTarget]:
    """The given values without any one of which the others can be met; all of them where there is none like that."""
    given = [target for target in targets if target.strength is Strength.GIVEN]
    alone = [
        target
        for target in given
        if assembled(assembler, guess, [other for other in targets if other is not target]).kept
    ]
    return alone or given


def _refuse_missed(
    scene: SpatialScene, assembler: SpatialAssembler, targets: Sequence[SpatialTarget], q: Vector, v: Vector | None
) -> None:
    """Raise SpecError with the given values that a state misses."""
    problems = []
    scale = 1.0 if v is None else max(1.0, max_norm(v))
    poses = assembler.poses(q)
    for target in targets:
        if target.strength is not Strength.GIVEN:
            continue
        r, J, _ = target.linearised(poses)
        missed = r if v is None else r + J @ v
        unit = 1.0 if target.angular else assembler.size
        if max_norm(missed) > KEPT * unit * scale:
            axes = misalignment(scene, poses, target.body, target.rotation()) if target.body else ""
            drive = "" if target.rate else _driven_to(scene, target)
            text = (
                f"this contradicts the joints, the drives or other given values: the nearest state misses it by "
                f"{max_norm(missed):.6g} {target.unit}{'; ' if axes else ''}{axes}{drive}. Correct or leave out one of "
                "them"
            )
            if target.guessable:
                text += f", or write guess = true in [{target.table}] to make it a first guess"
            problems.append(Problem(target.path, text))
    if problems:
        raise SpecError(tuple(problems))


def _driven_to(scene: SpatialScene, target: SpatialTarget) -> str:
    """The end of a sentence: what a drive prescribes at t = 0 for the joint that has this initial value."""
    for drive in scene.drives:
        if target.table in (f"drives.{drive.name}.start", f"joints.{drive.joint}.start"):
            try:
                value = value_at(drive_motion(drive), 0.0)
            except (ArithmeticError, ValueError):  # a run-time input
                return ""
            other = "" if drive.motion is not None else "; its key offset adds to it"
            return f"; drive {drive.name} prescribes {value:g} {target.unit} at t = 0{other}"
    return ""


def _momentum(scene: SpatialScene, assembler: SpatialAssembler, q: Vector) -> Vector:
    """The generalised momentum (nv,) of rigid bodies that drives carry along, at v = 0."""
    result = np.zeros(assembler.native.nv)
    if not scene.drives:
        return result
    poses = assembler.poses(q)
    for body in scene.bodies:
        if not isinstance(body, SpatialRigidBody) or body.mass is None or body.inertia is None:
            continue
        twist, drift = poses.twist(body.name)
        Q, centre = poses.rotation(body.name), np.array([si_value(x) for x in body.centre])
        lever = np.cross(np.eye(3), centre).T  # lever w = w x centre
        velocity = twist[:3] + Q @ lever @ twist[3:]
        carried = drift[:3] + Q @ lever @ drift[3:]
        xx, yy, zz, xy, xz, yz = (si_value(x) for x in body.inertia)
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        result += si_value(body.mass) * velocity.T @ carried + twist[3:].T @ inertia @ drift[3:]
    return result
