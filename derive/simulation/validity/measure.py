"""The monitored quantities of all beams of a run, each with the error it implies."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.linalg import eigh, null_space

from derive.roles import Role
from derive.runtime.integrators.watch import Watched
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.compiled_scene import ConstrainedSystem, constraint_matrix, coordinates_with, mass_matrix
from derive.simulation.observables.beams import piece_names
from derive.simulation.observables.motion import SceneMotion
from derive.simulation.validity.buckling_error import BUCKLED, buckling_error
from derive.simulation.validity.implied_errors import ImpliedErrors
from derive.simulation.validity.lateral_buckling import lateral_monitors
from derive.simulation.validity.monitors import Cause, Monitor
from derive.simulation.validity.watched_beam import SceneWatch, WatchedBeam, scene_watch
from derive.spec.model.body import DisplacementOrder


def validity(motion: SceneMotion, seen: Watched | None = None) -> tuple[Monitor, ...]:
    """The monitors of all beams of a motion, whose scene was compiled with the outputs of `with_monitors`.

    seen: what was seen after each step; without it the rows of the motion are looked at.
    """
    scene = scene_watch(motion.scene, motion.native, motion.k, float(motion.t[0]), motion.q[0], motion.v[0])
    if not scene.beams:
        return ()
    if seen is None:
        seen = scene.of_rows(motion.t, motion.q, motion.v, motion.outputs)
    buckled = [beam for beam in scene.beams if _buckles(beam, seen)]
    rows = scene.values(motion.t, motion.q, motion.v, motion.outputs) if buckled else np.zeros((0, 0))
    errors = (ImpliedErrors(beam, seen, _buckling_error(beam, motion.t, rows)) for beam in scene.beams)
    of_beams = (monitor for of in errors for monitor in _of_beam(scene, of))
    return (*of_beams, *lateral_monitors(motion.scene, motion.native, motion.k, motion.t, motion.q))


def _buckles(beam: WatchedBeam, seen: Watched) -> bool:
    """Whether the axial force of a beam of first order may take away all of its stiffness at some time."""
    first = beam.beam.beam.order is DisplacementOrder.FIRST_ORDER and not beam.shapes.twists
    return first and seen.largest[beam.whole_axial] > -BUCKLED


def _buckling_error(beam: WatchedBeam, t: Vector, rows: Matrix) -> float:
    """The error by such a force in the rows (quantities, n) at t (n,), which are empty if there is none."""
    if not rows.size or beam.beam.beam.order is not DisplacementOrder.FIRST_ORDER or beam.shapes.twists:
        return 0.0
    return buckling_error(t, rows[beam.whole_axial], rows[beam.axial], rows[beam.middle], beam.frequency)


def _of_beam(scene: SceneWatch, errors: ImpliedErrors) -> Iterator[Monitor]:
    watched, seen = errors.watched, errors.seen
    beam, twists = watched.beam, watched.shapes.twists

    def monitor(cause: Cause, value: float, error: float, t: float) -> Monitor:
        return Monitor(
            beam.name, beam.pieces, cause, beam.beam.order, float(value), error, float(t), watched.shapes.axis
        )

    if not errors.straight and not twists:
        value, t = errors.peak / watched.length, seen.times[watched.deflection]
        yield monitor(Cause.DEFLECTION, value, errors.of_deflection, t)
    if not twists:
        yield monitor(Cause.AXIAL_FORCE, seen.largest[watched.axial], errors.of_axial_force, seen.times[watched.axial])
    if errors.ought_to_bend:
        missed, kept = np.sqrt([seen.mean_squares[i] for i in (watched.missed_moment, watched.moment)])
        value, t = (1.0, seen.times[watched.missed]) if errors.straight else (missed / kept, seen.times[watched.moment])
        yield monitor(Cause.TWISTING_MOMENT if twists else Cause.BENDING_MOMENT, value, errors.of_shapes, t)
    if beam.beam.order is DisplacementOrder.TRUNCATED and not twists:
        t, lost = _lost_inertia(scene, watched, seen)
        yield monitor(Cause.MASS_MATRIX, lost, errors.of_lost_inertia(lost), t)


def _lost_inertia(scene: SceneWatch, watched: WatchedBeam, seen: Watched) -> tuple[float, float]:
    """The largest part of the kinetic energy of a velocity that the deflections of a beam take away, and its time, s.

    Of the velocities that the constraints admit; other beams are straight. Above 1 the mass matrix is indefinite. In
    space they are those in the plane of the deflections: a slender beam has so little inertia about its own axis that
    small terms take it away, which hardly matters for its deflections.
    Looked at are the states with the largest deflection of each piece, and the largest part of each of its strain
    energies.
    """
    native, k, shapes = scene.native, scene.k, watched.shapes
    own = [i for p in piece_names(shapes.beam) for i in shapes.amplitudes_in(native, p)]
    held = [i for p in piece_names(shapes.beam) for i in shapes.beside_in(native, p)]
    deformations = coordinates_with(native, Role.AMPLITUDE)
    quantities = [*watched.piece_deflections, *(part for parts in watched.energies for part in parts)]
    states = {float(seen.times[i]): seen.states[i] for i in quantities}
    time, lost = next(iter(states)), 0.0
    for t, q in states.items():
        straight = np.where(deformations, 0.0, q)
        bent = straight.copy()
        bent[own] = q[own]
        value = _lost(native, k, t, straight, bent, held)
        if value > lost:
            time, lost = t, value
    return time, lost


def _lost(native: ConstrainedSystem, k: Vector, t: float, straight: Vector, bent: Vector, held: Sequence[int]) -> float:
    """1 less the smallest ratio of kinetic energies in two states (nq,); 0 where a velocity has no inertia at all.

    held: the numbers of velocities that vanish.
    """
    before, after = mass_matrix(native, straight, k), mass_matrix(native, bent, k)
    size = np.sqrt(np.abs(np.diag(before)))
    scale = np.where(size > 0, size, 1.0)
    conditions = np.eye(len(scale))[list(held)]
    if native.nlambda:
        conditions = np.vstack([constraint_matrix(native, t, bent, k) / scale, conditions])
    admitted = null_space(conditions) if len(conditions) else np.eye(len(scale))
    if not admitted.size:
        return 0.0

    def reduced(M: Matrix) -> Matrix:
        result: Matrix = admitted.T @ (M / np.outer(scale, scale)) @ admitted
        return result

    try:
        return float(1.0 - eigh(reduced(after), reduced(before), eigvals_only=True)[0])
    except np.linalg.LinAlgError:
        return 0.0
