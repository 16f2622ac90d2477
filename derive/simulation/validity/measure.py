"""The monitored quantities of all beams of a run, each with the error it implies."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from derive.runtime.integrators.watch import Watched
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.observables.motion import SceneMotion
from derive.simulation.validity.buckling_error import BUCKLED, buckling_error
from derive.simulation.validity.implied_errors import ImpliedErrors
from derive.simulation.validity.lateral_buckling import lateral_monitors
from derive.simulation.validity.lost_inertia import LostInertia, lost_inertia
from derive.simulation.validity.monitors import Cause, Monitor
from derive.simulation.validity.truncated_energy import truncated_energy_error
from derive.simulation.validity.twist_coupling import twist_coupling_errors
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
    of_beams = (monitor for of in errors for monitor in _of_beam(scene, motion, of))
    laterally = lateral_monitors(motion.scene, motion.native, motion.k, motion.t, motion.q)
    return (*of_beams, *(own for of in laterally for own in _with_coupling(scene, motion, of)))


def _with_coupling(scene: SceneWatch, motion: SceneMotion, of: Monitor) -> Iterator[Monitor]:
    """The monitor of lateral buckling with the error that its couplings cause, if it is known, in both planes."""
    errors = twist_coupling_errors(scene, motion, of.beam) if of.value < 1 else {}
    for axis in errors or (of.axis,):
        yield replace(of, axis=axis, error=errors.get(axis, of.error))


def _buckles(beam: WatchedBeam, seen: Watched) -> bool:
    """Whether the axial force of a beam of first order may take away all of its stiffness at some time."""
    first = beam.beam.beam.order is DisplacementOrder.FIRST_ORDER and not beam.shapes.twists
    return first and seen.largest[beam.whole_axial] > -BUCKLED


def _buckling_error(beam: WatchedBeam, t: Vector, rows: Matrix) -> float:
    """The error by such a force in the rows (quantities, n) at t (n,), which are empty if there is none."""
    if not rows.size or beam.beam.beam.order is not DisplacementOrder.FIRST_ORDER or beam.shapes.twists:
        return 0.0
    return buckling_error(t, rows[beam.whole_axial], rows[beam.axial], rows[beam.middle], beam.frequency)


def _of_beam(scene: SceneWatch, motion: SceneMotion, errors: ImpliedErrors) -> Iterator[Monitor]:
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
        lost = lost_inertia(scene, watched, seen)
        yield monitor(Cause.MASS_MATRIX, lost.largest, _truncated_error(scene, motion, errors, lost), lost.t)


def _truncated_error(scene: SceneWatch, motion: SceneMotion, errors: ImpliedErrors, lost: LostInertia) -> float:
    """The error by truncated terms: from what they leave out if rows are close enough, else from lost inertia."""
    if errors.straight or not lost.largest < 1 or not errors.frequencies.size or not errors.seen_in(motion.t):
        return errors.of_lost_inertia(lost)
    difference = truncated_energy_error(scene, errors.watched, motion, errors.frequencies, errors.hardens)
    return errors.of_truncated_energy(difference)
