"""The monitored quantities of all beams of a run, each with the error it implies."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from derive.runtime.integrators.watch import Watched
from derive.simulation.observables.motion import SceneMotion
from derive.simulation.validity.definiteness import lost_inertia
from derive.simulation.validity.implied_errors import ImpliedErrors
from derive.simulation.validity.monitors import Cause, Monitor
from derive.simulation.validity.watched_beam import SceneWatch, WatchedBeam, scene_watch
from derive.spec.model.body import DisplacementOrder


def validity(motion: SceneMotion, seen: Watched | None = None) -> tuple[Monitor, ...]:
    """The monitors of all beams of a motion, whose scene was compiled with the outputs of `with_monitors`.

    seen: what was seen after each step; without it the rows of the motion are looked at.
    """
    scene = scene_watch(motion.scene, motion.native, motion.k, float(motion.t[0]), motion.q[0])
    if not scene.beams:
        return ()
    if seen is None:
        seen = scene.of_rows(motion.t, motion.q, motion.v, motion.outputs)
    return tuple(monitor for beam in scene.beams for monitor in _of_beam(scene, beam, seen))


def _of_beam(scene: SceneWatch, watched: WatchedBeam, seen: Watched) -> Iterator[Monitor]:
    beam, errors = watched.beam, ImpliedErrors(watched, seen)

    def monitor(cause: Cause, value: float, error: float, t: float) -> Monitor:
        return Monitor(beam.name, beam.pieces, cause, beam.beam.order, float(value), error, float(t))

    if not errors.straight:
        value, t = errors.peak / watched.length, seen.times[watched.deflection]
        yield monitor(Cause.DEFLECTION, value, errors.of_deflection, t)
    yield monitor(Cause.AXIAL_FORCE, seen.largest[watched.axial], errors.of_axial_force, seen.times[watched.axial])
    if errors.ought_to_bend:
        missed, kept = np.sqrt([seen.mean_squares[i] for i in (watched.missed_moment, watched.moment)])
        value, t = (1.0, seen.times[watched.missed]) if errors.straight else (missed / kept, seen.times[watched.moment])
        yield monitor(Cause.BENDING_MOMENT, value, errors.of_shapes, t)
    if beam.beam.order is DisplacementOrder.TRUNCATED:
        t, lost = lost_inertia(scene, watched, seen)
        yield monitor(Cause.MASS_MATRIX, lost, errors.of_lost_inertia(lost), t)
