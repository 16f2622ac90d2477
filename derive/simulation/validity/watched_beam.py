"""What is watched of the beams of a scene in motion, as linear forms of its state and its outputs.

First order leaves out of the stiffness what second order adds: the integral of N v'^2 along the beam, with its axial
force N(xi). Compared with the strain energy of the lowest mode of the beam as its joints hold it, this is the part of
its stiffness that is missing. Of more pieces each is taken as pinned at its ends.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from derive.runtime.integrators.watch import Watch, Watched
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.observables.beams import beam_bodies, function_values, piece_names, shape_functions
from derive.simulation.validity.end_moments import SECTIONS
from derive.simulation.validity.held_beam import LowestMode, lowest_mode
from derive.simulation.validity.monitoring_outputs import MonitoredPiece, monitored_ends, monitored_pieces
from derive.simulation.validity.piece_shapes import PieceShapes
from derive.spec.model.scene import BeamBody, Scene

POINTS = 21
"""Points of a piece at which its deflection is looked at."""


@dataclass(frozen=True, eq=False)
class WatchedBeam:
    """The numbers of the quantities of a beam in the watch of its scene.

    deflections, spins: one for each piece. axial_forces: by the names of pieces. energies: square roots of the parts of
    the strain energy, one for each shape of each piece. moment: the bending moment; ends: its jumps between pieces, and
    at the ends of the beam what it misses of the exact one.
    """

    shapes: PieceShapes
    deflections: tuple[int, ...]
    spins: tuple[int, ...]
    axial_forces: dict[str, int]
    energies: tuple[tuple[int, ...], ...]
    moment: int
    ends: tuple[int, ...]

    @property
    def beam(self) -> BeamBody:
        """The beam."""
        return self.shapes.beam


@dataclass(frozen=True, eq=False)
class SceneWatch:
    """A compiled scene with its constants k (nk,), and what is watched of its beams."""

    native: NativeScene
    k: Vector
    beams: tuple[WatchedBeam, ...]
    watch: Watch

    def of_rows(self, t: Vector, q: Matrix, v: Matrix, outputs: Matrix | None = None) -> Watched:
        """What is seen in the states q (n, nq), v (n, nv) at t (n,), s, whose outputs (n, nout) may be known."""
        native, k = self.native, self.k
        if outputs is None:
            outputs = np.empty((len(t), len(native.outputs)))
            for row, time, at, rates in zip(outputs, t, q, v, strict=True):
                row[:] = native.evaluate_outputs(float(time), at, rates, *native.solve(float(time), at, rates, k), k)
        return self.watch.of_rows(t, np.hstack([q, v, outputs]), native.nq)


def scene_watch(scene: Scene, native: NativeScene, k: Vector, t: float, q: Vector) -> SceneWatch:
    """What is watched of a scene that was compiled with the outputs of `with_monitors`; q (nq,): a state at t (s)."""
    forms = _Forms(native)
    pieces = monitored_pieces(scene)
    beams = []
    for beam in beam_bodies(scene):
        shapes = PieceShapes(beam)
        mode = lowest_mode(shapes, native, k, t, q) if beam.pieces == 1 else None
        own = [p for p in pieces if p.beam == beam.name]
        beams.append(_watched_beam(scene, forms, shapes, mode, own))
    return SceneWatch(native, k, tuple(beams), Watch(tuple(forms.matrices)))


class _Forms:
    """The quantities of a watch, in the order in which they are added."""

    def __init__(self, native: NativeScene) -> None:
        self.native, self.matrices = native, list[Matrix]()

    def add(self, columns: Sequence[int], factors: Matrix) -> int:
        """The number of a new quantity whose forms have these factors (forms, columns) of some elements of z."""
        native = self.native
        matrix = np.zeros((len(factors), native.nq + native.nv + len(native.outputs)))
        matrix[:, columns] = factors
        self.matrices.append(matrix)
        return len(self.matrices) - 1

    def output(self, name: str) -> int:
        """The number of an output in z."""
        return int(self.native.nq + self.native.nv + self.native.outputs.index(name))


def _watched_beam(
    scene: Scene, forms: _Forms, shapes: PieceShapes, mode: LowestMode | None, monitored: Sequence[MonitoredPiece]
) -> WatchedBeam:
    native, names = forms.native, piece_names(shapes.beam)
    amplitudes = {p: shapes.amplitudes_in(native, p) for p in names}
    xi = np.linspace(-1, 1, POINTS)
    shape_values = np.array([function_values(f, xi) for f in shape_functions(shapes.beam)]).T / shapes.length
    frequency = mode.frequency if mode else shapes.pinned_frequency
    parts = np.linalg.cholesky(shapes.stiffness).T / np.sqrt(2)
    turns = [native.nq + shapes.rotation_in(native, p) for p in names]
    return WatchedBeam(
        shapes,
        tuple(forms.add(amplitudes[p], shape_values) for p in names),
        tuple(forms.add([turn], np.array([[1 / frequency]])) for turn in turns),
        {p.piece: _axial_force(forms, shapes, mode, p) for p in monitored},
        tuple(tuple(forms.add(amplitudes[p], part[None]) for part in parts) for p in names),
        *_moments(scene, forms, shapes, list(amplitudes.values())),
    )


def _axial_force(forms: _Forms, shapes: PieceShapes, mode: LowestMode | None, piece: MonitoredPiece) -> int:
    """The part of the stiffness of the lowest mode of a piece that its axial force makes up."""
    columns = [forms.output(output.name) for output in piece.outputs]
    if mode is None:
        return forms.add(columns[:1], np.array([[1 / shapes.euler_load]]))
    a = mode.amplitudes
    factors = [a @ shapes.geometric_stiffness(power) @ a for power in range(len(columns))]
    return forms.add(columns, np.array([factors]) / (a @ shapes.stiffness @ a))


def _moments(
    scene: Scene, forms: _Forms, shapes: PieceShapes, amplitudes: list[list[int]]
) -> tuple[int, tuple[int, ...]]:
    """The bending moment in sections of all pieces; and its jumps between them, and what it misses at the ends."""
    of_shapes = shapes.moments(np.linspace(-1, 1, SECTIONS)).T  # sections, shapes
    every = [column for columns in amplitudes for column in columns]
    first, last = of_shapes[0], of_shapes[-1]
    every_section = np.kron(np.eye(len(amplitudes)), of_shapes).astype(np.float64)
    moment = forms.add(every, every_section)
    ends = [forms.add([*left, *right], np.concatenate([last, -first])[None]) for left, right in pairwise(amplitudes)]
    held = monitored_ends(scene)
    for end, columns, at_end in ((-1, amplitudes[0], first), (1, amplitudes[-1], last)):
        gap = held.get((shapes.beam.name, end))
        ends.append(forms.add([forms.output(gap.name)], np.eye(1)) if gap else forms.add(columns, at_end[None]))
    return moment, tuple(ends)
