"""What is watched of the beams of a scene in motion, as linear forms of its state and its outputs, and their products.

What a model leaves out is compared with the stiffness of the beam in the shape of its lowest mode, as the joints hold
it. First order leaves out what an axial force N(xi) adds: the integral of N v'^2 along the beam. All models leave out
what a large deflection adds: in an inextensible beam the curvature is v''/sqrt(1 - v'^2), and the strain energy has a
further part, the integral of 1/2 EI v''^2 v'^2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

import numpy as np

from derive.mechanics.multibody.bodies.beam import piece_of, place_in_piece
from derive.runtime.integrators.watch import Watch, Watched, WatchedQuantity
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.observables.beams import beam_bodies, piece_names
from derive.simulation.validity.beam_line import PLACES, deflections_along, places
from derive.simulation.validity.end_moments import SECTIONS, free_ends, held_ends
from derive.simulation.validity.held_beam import LowestMode, lowest_mode
from derive.simulation.validity.missed_moment import ENDS, missed_deflections
from derive.simulation.validity.monitoring_outputs import MOMENT_GAP, SHEAR_GAP, monitored_pieces, monitored_sections
from derive.simulation.validity.piece_shapes import PieceShapes, gauss_points
from derive.spec.model.scene import BeamBody, Scene

SLOPE = 1e-9
"""Shapes with smaller slopes at an end, per amplitude over the length, do not rotate it."""


@dataclass(frozen=True, eq=False)
class WatchedBeam:
    """The numbers of the quantities of a beam in the watch of its scene.

    deflection, rate: of the beam, m and m/s; late: the rate times the time; cubed: the third power of the deflection.
    middle, middle_rate: the deflection, m, and its rate where that of the lowest mode is largest. axial: the stiffness
    that the axial force adds, relative to that of the lowest mode; axial_product: times the deflection. moment: the
    bending moment, N m; gaps: what the shapes miss of it, at the ends of the beam and between pieces. missed: the
    deflection that they miss, m. energies: square roots of the parts of the strain energy, one for each shape of each
    piece. piece_deflections: of each piece, over its length. frequency: that of the lowest mode, rad/s; hardening: the
    stiffness that a large deflection adds, relative to that of the lowest mode, over the square of the deflection,
    1/m^2. rotations_act: whether a joint acts on the rotation of an end of a piece that can rotate.
    """

    shapes: PieceShapes
    deflection: int
    rate: int
    late: int
    cubed: int
    middle: int
    middle_rate: int
    axial: int
    axial_product: int
    moment: int
    gaps: tuple[int, ...]
    missed: int
    energies: tuple[tuple[int, ...], ...]
    piece_deflections: tuple[int, ...]
    frequency: float
    hardening: float
    rotations_act: bool

    @property
    def beam(self) -> BeamBody:
        """The beam."""
        return self.shapes.beam

    @property
    def length(self) -> float:
        """Of the whole beam, m."""
        return self.shapes.length * self.beam.pieces


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
    beams = []
    for beam in beam_bodies(scene):
        shapes = PieceShapes(beam)
        mode = lowest_mode(shapes, native, k, t, q)
        if mode is None:  # nothing deforms it alone: its first shape stands for that of the loads
            mode = LowestMode(np.inf, np.tile(np.eye(len(shapes.stiffness))[0], (beam.pieces, 1)))
        beams.append(_BeamForms(scene, forms, shapes, mode).watched())
    return SceneWatch(native, k, tuple(beams), Watch(tuple(forms.quantities)))


class _Forms:
    """The quantities of a watch, in the order in which they are added, as forms of z = [q; v; outputs; t]."""

    def __init__(self, native: NativeScene) -> None:
        self.native, self.quantities = native, list[WatchedQuantity]()
        self.size = native.nq + native.nv + len(native.outputs) + 1

    def add(self, columns: Sequence[int], factors: Matrix, factor: int | None = None) -> int:
        """The number of a new quantity whose forms have these factors (forms, columns) of some elements of z."""
        matrix = np.zeros((len(factors), self.size))
        matrix[:, columns] = factors
        self.quantities.append(WatchedQuantity(matrix, factor))
        return len(self.quantities) - 1

    def output(self, name: str) -> int:
        """The number of an output in z."""
        return int(self.native.nq + self.native.nv + self.native.outputs.index(name))

    def of_output(self, name: str) -> Vector:
        """An output as a form (z,)."""
        form = np.zeros(self.size)
        form[self.output(name)] = 1
        return form


class _BeamForms:
    """The forms of a beam with its lowest mode."""

    def __init__(self, scene: Scene, forms: _Forms, shapes: PieceShapes, mode: LowestMode) -> None:
        self.scene, self.forms, self.shapes, self.mode = scene, forms, shapes, mode
        beam, native = shapes.beam, forms.native
        self.pieces = piece_names(beam)
        self.amplitudes = [shapes.amplitudes_in(native, piece) for piece in self.pieces]
        self.columns = [column for columns in self.amplitudes for column in columns]
        ends = [int(marker.at) for marker in held_ends(scene, beam)]
        self.held = ends[0] if len(ends) == 1 else None
        self.rotations_act = len(self.pieces) > 1 or any(
            np.abs(shapes.slopes(np.array([float(end)])) * shapes.length).max() > SLOPE for end in ends
        )

    def watched(self) -> WatchedBeam:
        """The numbers of the quantities."""
        forms, shapes, columns = self.forms, self.shapes, self.columns
        rates = [forms.native.nq + column for column in columns]
        bent = self.along(shapes.values(places()), shapes.slopes(ENDS))
        deflection, rate = forms.add(columns, bent), forms.add(rates, bent)
        squared = forms.add(columns, bent, deflection)
        place = int(np.abs(bent @ self.mode.amplitudes.ravel()).argmax())
        moment, gaps = self.moments()
        parts = np.linalg.cholesky(shapes.stiffness).T / np.sqrt(2)
        xi = np.linspace(-1, 1, 2 * SECTIONS)
        axial_columns, axial_factors = self.axial()
        axial = forms.add(axial_columns, axial_factors)
        return WatchedBeam(
            shapes,
            deflection,
            rate,
            forms.add([forms.size - 1], np.eye(1), rate),
            forms.add(columns, bent, squared),
            forms.add(columns, bent[place, None]),
            forms.add(rates, bent[place, None]),
            axial,
            forms.add(axial_columns, axial_factors, deflection),
            moment,
            self.monitored_gaps(gaps),
            forms.add(range(forms.size), self.missed(gaps)),
            tuple(tuple(forms.add(own, part[None]) for part in parts) for own in self.amplitudes),
            tuple(forms.add(own, shapes.values(xi).T / shapes.length) for own in self.amplitudes),
            self.mode.frequency,
            self.hardening(bent),
            self.rotations_act,
        )

    def along(self, values: Matrix, slopes: Matrix) -> Matrix:
        """The deflection of the beam per unit of fields of its pieces."""
        return deflections_along(values, slopes, self.shapes.length, len(self.pieces), self.held)

    def missed(self, gaps: Matrix) -> Matrix:
        """The deflection of the beam that its shapes miss (places, z), of the moments that they miss (pieces, 2, z)."""
        within, shear = self.missed_within(), self.missed_shear()
        result = np.zeros((PLACES, self.forms.size))
        for i, (left, right) in enumerate(gaps):
            known = [(-1.0, 0, left), (1.0, 0, right), *within[i], *shear[i]]
            values, slopes = missed_deflections(self.shapes, [(xi, order) for xi, order, _ in known])
            own = self.along(values, slopes).reshape(PLACES, -1, len(known))[:, i]
            result += own @ np.array([form for _, _, form in known])
        return result

    def missed_within(self) -> list[list[tuple[float, int, Vector]]]:
        """What each piece misses of the moment where something acts within it: xi, 0, and its form (z,)."""
        result: list[list[tuple[float, int, Vector]]] = [[] for _ in self.pieces]
        for (beam, at, kind), output in monitored_sections(self.scene).items():
            xi = place_in_piece(at, len(self.pieces))
            if beam == self.shapes.beam.name and kind == MOMENT_GAP and abs(xi) < 1:
                result[piece_of(at, len(self.pieces))].append((float(xi), 0, self.forms.of_output(output.name)))
        return result

    def missed_shear(self) -> list[list[tuple[float, int, Vector]]]:
        """What each piece misses of the derivative of the moment at ends of the beam where it is known, likewise."""
        forms, shapes = self.forms, self.shapes
        result: list[list[tuple[float, int, Vector]]] = [[] for _ in self.pieces]
        outputs, free = monitored_sections(self.scene), free_ends(self.scene, shapes.beam)
        for i, (piece, end) in enumerate(((0, -1), (-1, 1))):
            output = outputs.get((shapes.beam.name, Fraction(end), SHEAR_GAP))
            if output is not None:
                result[piece].append((float(end), 1, forms.of_output(output.name)))
            elif free[i]:
                form = np.zeros(forms.size)
                form[self.amplitudes[piece]] = -shapes.shear_forces(ENDS)[:, i]
                result[piece].append((float(end), 1, form))
        return result

    @property
    def strain(self) -> float:
        """Twice the strain energy of the mode."""
        a = self.mode.amplitudes
        return float(np.sum(a * (a @ self.shapes.stiffness)))

    def hardening(self, bent: Matrix) -> float:
        """The stiffness that a large deflection adds, relative to that of the mode, over its square, 1/m^2."""
        xi, weights = gauss_points()
        a, shapes = self.mode.amplitudes, self.shapes
        squares = (a @ shapes.moments(xi)) ** 2 * weights
        added = 2 * float(np.sum(squares * (a @ shapes.slopes(xi)) ** 2) / np.sum(squares))
        return added / float(np.abs(bent @ a.ravel()).max()) ** 2

    def axial(self) -> tuple[list[int], Matrix]:
        """The relative stiffness that the axial force adds; pieces that are not monitored have that of the nearest."""
        monitored = [piece for piece in monitored_pieces(self.scene) if piece.beam == self.shapes.beam.name]
        where = np.array([self.pieces.index(piece.piece) for piece in monitored])
        nearest = [int(np.abs(where - i).argmin()) for i in range(len(self.pieces))]
        columns, factors = list[int](), list[float]()
        for number, piece in enumerate(monitored):
            a = self.mode.amplitudes[[i for i, near in enumerate(nearest) if near == number]]
            for power, output in enumerate(piece.outputs):
                columns.append(self.forms.output(output.name))
                factors.append(float(np.sum(a * (a @ self.shapes.geometric_stiffness(power)))) / self.strain)
        return columns, np.array([factors])

    def moments(self) -> tuple[int, Matrix]:
        """The bending moment in sections of all pieces; and what is missed at both ends of each (pieces, 2, z)."""
        forms, shapes = self.forms, self.shapes
        of_shapes = shapes.moments(np.linspace(-1, 1, SECTIONS)).T  # sections, shapes
        every_section = np.kron(np.eye(len(self.pieces)), of_shapes).astype(np.float64)
        at_ends = np.zeros((len(self.pieces), 2, forms.size))
        for i, own in enumerate(self.amplitudes):
            at_ends[i][:, own] = of_shapes[[0, -1]]
        gaps = -at_ends
        for left, right in pairwise(range(len(self.pieces))):  # the moment between them is the mean of theirs
            jump = (at_ends[right, 0] - at_ends[left, 1]) / 2
            gaps[left, 1], gaps[right, 0] = jump, -jump
        for (beam, at, kind), output in monitored_sections(self.scene).items():
            if beam == shapes.beam.name and kind == MOMENT_GAP and abs(at) == 1:
                gaps[0 if at == -1 else -1, 0 if at == -1 else 1] = forms.of_output(output.name)
        return forms.add(self.columns, every_section), gaps

    def monitored_gaps(self, gaps: Matrix) -> tuple[int, ...]:
        """What is missed at both ends of the beam, and the jumps between pieces."""
        forms = self.forms
        rows = [gaps[0, 0], *(2 * gap[1] for gap in gaps[:-1]), gaps[-1, 1]]
        return tuple(forms.add(range(forms.size), row[None]) for row in rows)
