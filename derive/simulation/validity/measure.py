"""The monitored quantities of all beams of a run, each with the error it implies.

First order leaves out of the stiffness what second order adds: the integral of N v'^2 along the beam, with the axial
force

    N(x) = N(0) + m/l (A1 x - w^2 x^2/2),

from its value in the middle, with the acceleration A1 of the floating frame along its e1, less that of free fall, and
the angular velocity w: the inertia of a slender beam; distributed loads along it are left out. Compared with the strain
energy of the lowest mode of the beam as its joints hold it, this is the part of its stiffness that is missing. Of more
pieces each is taken as pinned at its ends.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from derive.runtime.native_call import Vector
from derive.simulation.observables.beams import amplitudes, beam_bodies, deflections, piece_names
from derive.simulation.observables.motion import SceneMotion, si_value
from derive.simulation.validity.axial_load import AxialLoads, axial_loads
from derive.simulation.validity.definiteness import lost_inertia
from derive.simulation.validity.end_moments import moment_mismatch
from derive.simulation.validity.held_beam import LowestMode, lowest_mode
from derive.simulation.validity.monitors import Cause, Monitor
from derive.simulation.validity.piece_shapes import PieceShapes
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.scene import BeamBody

STRAIGHT = 1e-6
"""Of the length: shapes of smaller deflections do not matter."""


def validity(motion: SceneMotion) -> tuple[Monitor, ...]:
    """The monitors of all beams of a motion, whose scene was compiled with the outputs of `with_monitors`."""
    beams = beam_bodies(motion.scene)
    if not beams:
        return ()
    loads = axial_loads(motion)
    return tuple(monitor for beam in beams for monitor in _of_beam(motion, beam, loads))


def _of_beam(motion: SceneMotion, beam: BeamBody, loads: AxialLoads) -> Iterator[Monitor]:
    shapes, pieces = PieceShapes(beam), piece_names(beam)

    def monitor(cause: Cause, value: float, error: float, row: int) -> Monitor:
        return Monitor(beam.name, beam.pieces, cause, beam.beam.order, value, error, float(motion.t[row]), beam.name)

    mode = lowest_mode(shapes, motion) if beam.pieces == 1 else None
    frequency = mode.frequency if mode else shapes.pinned_frequency
    bent = deflection_monitor(motion, beam)
    yield bent
    spins = [np.abs(motion.v[:, shapes.rotation_in(motion.native, p)]) / frequency for p in pieces]
    yield _largest(beam, Cause.SPIN, motion.t, pieces, spins, lambda ratio: ratio**2)
    watched = [p for p in pieces if p in loads.forces]
    missing = [_missing_stiffness(motion, shapes, mode, p, loads) for p in watched]
    yield _largest(beam, Cause.AXIAL_FORCE, motion.t, watched, missing, lambda ratio: ratio / 2)
    if bent.value > STRAIGHT:
        yield _highest_shape(motion, shapes, pieces)
        row, mismatch = moment_mismatch(motion, shapes)
        yield monitor(Cause.END_MOMENT, mismatch, mismatch / 5, row)
    if beam.beam.order is DisplacementOrder.TRUNCATED:
        row, lost = lost_inertia(motion, shapes)
        yield monitor(Cause.MASS_MATRIX, lost, lost, row)


def deflection_monitor(motion: SceneMotion, beam: BeamBody) -> Monitor:
    """The largest deflection of a piece from its axis, divided by its length l.

    A half sine of the height v has slopes of up to pi v/l, whose squares the linear theory leaves out.
    """
    shapes, xi = PieceShapes(beam), np.linspace(-1, 1, 21)
    pieces = piece_names(beam)
    bent = [np.abs(deflections(motion, beam, p, xi)).max(axis=1) / shapes.length for p in pieces]
    return _largest(beam, Cause.DEFLECTION, motion.t, pieces, bent, lambda ratio: (np.pi * ratio) ** 2)


def _missing_stiffness(
    motion: SceneMotion, shapes: PieceShapes, mode: LowestMode | None, piece: str, loads: AxialLoads
) -> Vector:
    """(n,): the part of the stiffness of the lowest mode of a piece that its axial force makes up."""
    middle = loads.forces[piece]
    if mode is None:
        return np.abs(middle) / shapes.euler_load
    native, a = motion.native, mode.amplitudes
    spin = motion.v[:, shapes.rotation_in(native, piece)]
    phi = motion.pose(piece)[:, 2]
    free_fall = [si_value(g) for g in motion.scene.gravity or ()] or [0.0, 0.0]
    along = (loads.accelerations[:, shapes.origin_in(native, piece)] - free_fall) * np.stack(
        [np.cos(phi), np.sin(phi)], 1
    )
    forces = (middle, shapes.mass / 2 * along.sum(axis=1), -shapes.mass * shapes.length / 8 * spin**2)
    stiffness = sum(force * (a @ shapes.geometric_stiffness(n) @ a) for n, force in enumerate(forces))
    missing: Vector = np.abs(stiffness) / (a @ shapes.stiffness @ a)
    return missing


def _highest_shape(motion: SceneMotion, shapes: PieceShapes, pieces: Sequence[str]) -> Monitor:
    """The share of the highest shape in the strain energy of the beam, on the average over the run."""
    beam = shapes.beam
    energies = np.array([shapes.strain_energies(amplitudes(motion, beam, p)) for p in pieces])  # pieces, 2, n
    total, highest = energies.sum(axis=(0, 2))
    piece, row = np.unravel_index(np.argmax(energies[:, 1]), energies[:, 1].shape)
    share = float(highest / total)
    return Monitor(
        beam.name,
        beam.pieces,
        Cause.HIGHEST_SHAPE,
        beam.beam.order,
        share,
        share,
        float(motion.t[row]),
        pieces[int(piece)],
    )


def _largest(
    beam: BeamBody,
    cause: Cause,
    t: Vector,
    pieces: Sequence[str],
    values: list[Vector],
    error: Callable[[float], float],
) -> Monitor:
    """The monitor of the largest value (n,) of all pieces."""
    every = np.array(values)
    piece, row = np.unravel_index(np.argmax(every), every.shape)
    value = float(every[piece, row])
    return Monitor(
        beam.name, beam.pieces, cause, beam.beam.order, value, float(error(value)), float(t[row]), pieces[int(piece)]
    )
