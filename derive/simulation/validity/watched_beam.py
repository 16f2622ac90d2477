"""The quantities that a run watches of its beams, as linear forms of its state and its outputs, and their products.

What a model leaves out is compared with the stiffness of the beam in the shape of its lowest mode, as the joints hold
it. First order leaves out what an axial force N(xi) adds: the integral of N v'^2 along the beam. All models leave out
what a large deflection adds: in an inextensible beam the curvature is v''/sqrt(1 - v'^2), and the strain energy has a
further part, the integral of 1/2 EI v''^2 v'^2.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby

import numpy as np

from derive.runtime.integrators.watch import Watch, Watched
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.observables.beams import piece_names
from derive.simulation.validity.beam_line import PLACES, deflections_along, places, twists_along
from derive.simulation.validity.beam_vibrations import Vibration, vibrations_of
from derive.simulation.validity.bending_planes import bending_planes
from derive.simulation.validity.held_beam import HeldMode, StaticResponse, held_modes
from derive.simulation.validity.known_gaps import known_gaps
from derive.simulation.validity.missed_moment import ENDS, SECTIONS, missed_fields, sections
from derive.simulation.validity.monitoring_outputs import is_monitored
from derive.simulation.validity.piece_shapes import PieceShapes, gauss_points
from derive.simulation.validity.surroundings import Surroundings, surroundings
from derive.simulation.validity.watched_forms import WatchedForms
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.specification import AnyScene

SLOPE = 1e-9
"""Shapes with smaller slopes at an end, per amplitude over the length, do not rotate it."""


@dataclass(frozen=True)
class WatchedVibration:
    """A vibration of a beam: its rate, as the deflection where that is largest, m/s, and the rate times the time, m.

    frequency: that of its strain energy alone, rad/s. missed: the strain energy that the shapes miss, relative to it.
    axial: the stiffness that the axial force adds, relative to that of the strain energy.
    """

    rate: int
    late: int
    axial: int
    frequency: float
    missed: float


@dataclass(frozen=True, eq=False)
class WatchedBeam:
    """The numbers of the quantities of a beam in the watch of its scene.

    deflection, rate: of the beam, m and m/s; late: the rate times the time; cubed: the third power of the deflection.
    middle, middle_rate: the deflection, m, and its rate where that of the lowest mode is largest. axial: the stiffness
    that the axial force adds and first order leaves out, relative to that of the lowest mode; axial_product: times the
    deflection; whole_axial: all that it adds, also by the rotations of pieces, relative to the same. moment: the
    bending moment, N m; missed_moment, missed: what the shapes miss of it, and of the deflection, m; vibrations: those
    of the beam as its joints hold it. energies: square roots of the strain energy, one for each shape of each piece.
    piece_deflections: of each piece, over its length. frequency: that of the lowest mode, rad/s; hardening: the
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
    whole_axial: int
    moment: int
    missed_moment: int
    missed: int
    vibrations: tuple[WatchedVibration, ...]
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
        """The length of the whole beam, m."""
        return self.shapes.length * self.beam.pieces


@dataclass(frozen=True, eq=False)
class SceneWatch:
    """A compiled scene with its constants k (nk,), and what is watched of its beams."""

    native: NativeScene
    k: Vector
    beams: tuple[WatchedBeam, ...]
    watch: Watch

    def of_rows(self, t: Vector, q: Matrix, v: Matrix, outputs: Matrix | None = None) -> Watched:
        """The watched quantities in the states q (n, nq), v (n, nv) at t (n,), s; outputs (n, nout) may be known."""
        return self.watch.of_rows(t, self._rows(t, q, v, outputs), self.native.nq)

    def values(self, t: Vector, q: Matrix, v: Matrix, outputs: Matrix | None = None) -> Matrix:
        """The values (quantities, n) in these states."""
        return self.watch.values(t, self._rows(t, q, v, outputs))

    def _rows(self, t: Vector, q: Matrix, v: Matrix, outputs: Matrix | None) -> Matrix:
        native, k = self.native, self.k
        if outputs is None:
            outputs = np.empty((len(t), len(native.outputs)))
            for row, time, at, rates in zip(outputs, t, q, v, strict=True):
                row[:] = native.evaluate_outputs(float(time), at, rates, *native.solve(float(time), at, rates, k), k)
        return np.hstack([q, v, outputs])


def scene_watch(scene: AnyScene, native: NativeScene, k: Vector, t: float, q: Vector, v: Vector) -> SceneWatch:
    """The watch of a scene compiled with the outputs of `with_monitors`; q (nq,), v (nv,): its state at t (s)."""
    forms = WatchedForms(native)
    beams = list[WatchedBeam]()
    response = StaticResponse(native, k, t, q)
    start = response.start(v)
    for _, of_beam in groupby(bending_planes(scene) if is_monitored(scene) else (), lambda shapes: shapes.beam.name):
        planes = list[_BeamForms]()
        for shapes in of_beam:
            modes = held_modes((shapes,), native, k, t, q)
            planes.append(_BeamForms(surroundings(scene, shapes), forms, shapes, modes))
        if len(planes) > 1:
            modes = held_modes([plane.shapes for plane in planes], native, k, t, q)
        vibrations = vibrations_of(modes, planes, response, start)
        axial = [forms.add([*of.axial], np.array([[*of.axial.values()]])) for of in vibrations]
        beams += [plane.watched([*zip(vibrations, axial, strict=True)]) for plane in planes]
    return SceneWatch(native, k, tuple(beams), Watch(tuple(forms.quantities)))


class _BeamForms:
    """The forms of a beam in a plane; modes: its vibrations there alone."""

    def __init__(
        self, around: Surroundings, forms: WatchedForms, shapes: PieceShapes, modes: Sequence[HeldMode]
    ) -> None:
        self.around, self.forms, self.shapes = around, forms, shapes
        beam, native = shapes.beam, forms.native
        self.pieces = piece_names(beam)
        self.amplitudes = [shapes.amplitudes_in(native, piece) for piece in self.pieces]
        self.columns = [column for columns in self.amplitudes for column in columns]
        self.rates = [native.nq + column for piece in self.pieces for column in shapes.rates_in(native, piece)]
        if modes:
            self.frequency, self.lowest = modes[0].frequency, modes[0].motion[self.amplitudes]
            self.velocities: Vector | None = modes[0].velocities
        else:  # nothing deforms it alone: its first shape stands for that of the loads
            self.velocities = None
            self.frequency, self.lowest = np.inf, np.tile(np.eye(len(shapes.stiffness))[0], (beam.pieces, 1))
        ends = around.held
        self.clamped = ends[0] if len(ends) == 1 else None
        self.rotations_act = len(self.pieces) > 1 or any(
            np.abs(shapes.slopes(np.array([float(end)])) * shapes.length).max() > SLOPE for end in ends
        )

    def watched(self, vibrations: Sequence[tuple[Vibration, int]]) -> WatchedBeam:
        """The numbers of the quantities; vibrations: those of the beam in all planes, with what axial forces add."""
        forms, shapes, columns = self.forms, self.shapes, self.columns
        rates = self.rates
        bent = self.along(shapes.values(places()), shapes.slopes(ENDS))
        deflection, rate = forms.add(columns, bent), forms.add(rates, bent)
        squared = forms.add(columns, bent, deflection)
        place = int(np.abs(bent @ self.lowest.ravel()).argmax())
        moments, deflections, _ = self.missed
        every_section = np.kron(np.eye(len(self.pieces)), shapes.moments(sections()).T).astype(np.float64)
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
            self.whole_axial(),
            forms.add(columns, every_section),
            forms.add(range(forms.size), moments),
            forms.add(range(forms.size), deflections),
            tuple(self.vibration(of, axial, bent) for of, axial in vibrations),
            tuple(tuple(forms.add(own, part[None]) for part in parts) for own in self.amplitudes),
            tuple(forms.add(own, shapes.values(xi).T / shapes.length) for own in self.amplitudes),
            self.frequency,
            self.hardening(bent),
            self.rotations_act,
        )

    def vibration(self, of: Vibration, axial: int, bent: Matrix) -> WatchedVibration:
        """The quantities of a vibration, whose size is that of the deflection in this plane."""
        size = float(np.abs(bent @ of.motion[self.amplitudes].ravel()).max())
        rate = self.forms.add(of.columns, size * of.part)
        late = self.forms.add([self.forms.size - 1], np.eye(1), rate)
        return WatchedVibration(rate, late, axial, of.frequency, of.missed)

    def along(self, values: Matrix, slopes: Matrix) -> Matrix:
        """The deflection of the beam per unit of fields of its pieces; of torsion see `twists_along`."""
        if self.shapes.twists:
            return twists_along(values, len(self.pieces), self.clamped)
        return deflections_along(values, slopes, self.shapes.length, len(self.pieces), self.clamped)

    @cached_property
    def missed(self) -> tuple[Matrix, Matrix, Matrix]:
        """The forms that the shapes miss: moments in sections of all pieces, the deflection, and energies (., z)."""
        moments, deflections, energies = list[Matrix](), np.zeros((PLACES, self.forms.size)), list[Matrix]()
        for i, known in enumerate(known_gaps(self.around, self.forms, self.shapes, self.amplitudes)):
            form = np.array([gap.form for gap in known])
            missed = missed_fields(self.shapes, [(gap.xi, gap.order) for gap in known])
            moments.append(missed.moments.T @ form)
            energies.append(missed.energies @ form)
            deflections += self.along(missed.values, missed.slopes).reshape(PLACES, -1, len(known))[:, i] @ form
        return np.vstack(moments), deflections, np.vstack(energies)

    @property
    def strain(self) -> float:
        """Twice the strain energy of the mode."""
        a = self.lowest
        return float(np.sum(a * (a @ self.shapes.stiffness)))

    def hardening(self, bent: Matrix) -> float:
        """The stiffness that a large deflection adds, relative to that of the mode, over its square, 1/m^2."""
        if self.shapes.twists:
            return 0.0
        xi, weights = gauss_points()
        a, shapes = self.lowest, self.shapes
        squares = (a @ shapes.moments(xi)) ** 2 * weights
        added = 2 * float(np.sum(squares * (a @ shapes.slopes(xi)) ** 2) / np.sum(squares))
        return added / float(np.abs(bent @ a.ravel()).max()) ** 2

    def axial(self) -> tuple[list[int], Matrix]:
        """The relative stiffness that the axial force adds to the lowest mode."""
        columns, factors = list[int](), list[float]()
        for column, power, near in self.axial_forces():
            a = self.lowest[near]
            columns.append(column)
            factors.append(float(np.sum(a * (a @ self.shapes.geometric_stiffness(power)))) / self.strain)
        return columns, np.array([factors])

    def stiffened(self, velocities: Matrix) -> Iterator[tuple[int, Matrix]]:
        """The numbers in z of axial forces, and what each unit of them adds to the stiffness for motions (n, nv).

        It is that of second order, which a model of first order does not have.
        """
        if self.shapes.beam.beam.order is not DisplacementOrder.FIRST_ORDER:
            yield from self._added_stiffness(velocities)

    def whole_axial(self) -> int:
        """The stiffness that the axial force adds to the lowest mode with the rotations of pieces, relative to it."""
        forces = [*self._added_stiffness(self.velocities[None])] if self.velocities is not None else []
        factors = np.array([[float(added[0, 0]) / self.strain for _, added in forces]])
        return self.forms.add([column for column, _ in forces], factors)

    def _added_stiffness(self, velocities: Matrix) -> Iterator[tuple[int, Matrix]]:
        """The numbers in z of axial forces, and the stiffness that each adds, see `stiffened`."""
        xi, weights = gauss_points()
        for column, power, near in self.axial_forces():
            slopes = [self.shapes.total_slopes(self.forms.native, self.pieces[i], velocities, xi) for i in near]
            weighted = np.tile(self.shapes.length / 2 * weights * xi**power, len(near))
            along = np.hstack(slopes)
            yield column, (along * weighted) @ along.T

    def axial_forces(self) -> Iterator[tuple[int, int, list[int]]]:
        """The factors of xi^power in axial forces: their numbers in z, the powers, and the pieces that have them.

        Pieces that are not monitored have the force of the nearest.
        """
        if not self.around.axial:
            return
        where = np.array([self.pieces.index(piece) for piece in self.around.axial])
        nearest = [int(np.abs(where - i).argmin()) for i in range(len(self.pieces))]
        for number, outputs in enumerate(self.around.axial.values()):
            near = [i for i, of in enumerate(nearest) if of == number]
            for power, output in enumerate(outputs):
                yield self.forms.output(output), power, near
