"""The monitored quantities of all beams of a run, each with the error it implies."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from derive.runtime.integrators.watch import Watched
from derive.simulation.observables.beams import piece_names
from derive.simulation.observables.motion import SceneMotion
from derive.simulation.validity.definiteness import lost_inertia
from derive.simulation.validity.monitors import Cause, Monitor
from derive.simulation.validity.watched_beam import SceneWatch, WatchedBeam, scene_watch
from derive.spec.model.body import DisplacementOrder

Error = Callable[[float], float]
"""The error that a value implies."""

STRAIGHT = 1e-6
"""Of the length: shapes of smaller deflections do not matter."""


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
    beam = watched.beam

    def largest(cause: Cause, pieces: Sequence[str], numbers: Sequence[int], error: Error) -> Monitor:
        """The monitor of the largest of some quantities, which are those of these pieces."""
        piece = int(np.argmax(seen.largest[list(numbers)]))
        value, t = float(seen.largest[numbers[piece]]), float(seen.times[numbers[piece]])
        return Monitor(beam.name, beam.pieces, cause, beam.beam.order, value, float(error(value)), t, pieces[piece])

    def monitor(cause: Cause, value: float, error: float, t: float, piece: str = beam.name) -> Monitor:
        return Monitor(beam.name, beam.pieces, cause, beam.beam.order, value, error, t, piece)

    pieces = piece_names(beam)
    # a half sine of the height v has slopes of up to pi v/l, whose squares the linear theory leaves out
    bent = largest(Cause.DEFLECTION, pieces, watched.deflections, lambda ratio: (np.pi * ratio) ** 2)
    yield bent
    yield largest(Cause.SPIN, pieces, watched.spins, lambda ratio: ratio**2)
    loads = watched.axial_forces
    yield largest(Cause.AXIAL_FORCE, list(loads), list(loads.values()), lambda ratio: ratio / 2)
    if bent.value > STRAIGHT:
        highest = [own[-1] for own in watched.energies]
        total = sum(float(seen.mean_squares[list(own)].sum()) for own in watched.energies)
        share = float(seen.mean_squares[highest].sum()) / total
        most = int(np.argmax(seen.largest[highest]))
        yield monitor(Cause.HIGHEST_SHAPE, share, share, float(seen.times[highest[most]]), pieces[most])
        size = seen.mean_squares[watched.moment]
        mismatch = max(float(np.sqrt(seen.mean_squares[end] / size)) for end in watched.ends)
        yield monitor(Cause.END_MOMENT, mismatch, mismatch / 5, float(seen.times[watched.moment]))
    if beam.beam.order is DisplacementOrder.TRUNCATED:
        t, lost = lost_inertia(scene, watched, seen)
        yield monitor(Cause.MASS_MATRIX, lost, lost, t)
