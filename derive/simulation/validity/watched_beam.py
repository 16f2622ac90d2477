"""The quantities that a run watches of its beams, as linear forms of its state and its outputs, and their products.

What a model leaves out is compared with the stiffness of the beam in the shape of its lowest mode, as the joints hold
it. First order leaves out what an axial force N(xi) adds: the integral of N v'^2 along the beam. All models leave out
what a large deflection adds: in an inextensible beam the curvature is v''/sqrt(1 - v'^2), and the strain energy has a
further part, the integral of 1/2 EI v''^2 v'^2.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import groupby

import numpy as np

from derive.runtime.integrators.watch import Watch, Watched
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.observables.beams import piece_names
from derive.simulation.validity.beam_line import PLACES, deflections_along, places, twists_along
from derive.simulation.validity.beam_vibrations import MissedForms, Vibration, vibrations_of
from derive.simulation.validity.bending_planes import bending_planes
from derive.simulation.validity.held_beam import HeldMode, StaticResponse, held_modes
from derive.simulation.validity.known_gaps import known_gaps
from derive.simulation.validity.missed_moment import ENDS, SECTIONS, missed_fields, sections
from derive.simulation.validity.monitoring_outputs import is_monitored
from derive.simulation.validity.piece_frames import PieceFrames
from derive.simulation.validity.piece_shapes import PieceShapes, gauss_points
from derive.simulation.validity.surroundings import Surroundings, surroundings
from derive.simulation.validity.turned_stiffness import TurnedStiffness
from derive.simulation.validity.watched_forms import WatchedForms
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.specification import AnyScene

SLOPE = 1e-9
"""Shapes with smaller slopes at an end, per amplitude over the length, do not rotate it."""


@dataclass(frozen=True, eq=False)
class WatchedVibration:
    """A vibration of a beam: its rate, as the deflection where that is largest, m/s, and the rate times the time, m.

    frequency: that of its strain energy alone, rad/s. missed: the strain energy that the shapes miss, relative to it.
    axial: the stiffness that the axial force adds, relative to that of the strain energy; axial_missed: the same of
    what is missed. turns: the square of each is the part of that stiffness which a spin takes away. motion (nq,): of
    all coordinates, with a kinetic energy of 1/2 J for its velocities.
    """

    motion: Vector
    rate: int
    late: int
    axial: int
    axial_missed: int
    turns: tuple[int, ...]
    frequency: float
    missed: float


@dataclass(frozen=True, eq=False)
class WatchedBeam:
    """The numbers of the quantities of a beam in the watch of its scene.

    deflection, rate: of the beam, m and m/s; late: the rate times the time; cubed: the third power of the deflection.
    middle, middle_rate: the deflection, m, and its rate where that of the lowest mode is largest. axial: the stiffness
    that the axial force adds and first order leaves out, relative to that of the lowest mode; axial_product: times the
    deflection; whole_axial: all that it adds, also by the rotations of pieces, relative to the same. moment: the
    bending moment, N m; missed_moment, missed: what the shapes miss of it, and of the deflection, m; axial_missed: the
    stiffness that the axial force adds to what is missed of the lowest mode, relative to that in bending; vibrations:
    those of the beam as its joints hold it. energies: square roots of the strain energy, one for each shape of each
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
    whole_axial: int
    moment: int
    missed_moment: int
    missed: int
    axial_missed: int
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
    spinning, frames = StaticResponse(native, k, t, q, v), PieceFrames(native, k, t, q)
    still, start = replace(spinning, v=np.zeros_like(v)), spinning.start()
    for _, of_beam in groupby(bending_planes(scene) if is_monitored(scene) else (), lambda shapes: shapes.beam.name):
        planes, own = list[_BeamForms](), [*of_beam]
        response = still if own[0].beam.beam.order is DisplacementOrder.FIRST_ORDER else spinning
        for shapes in own:
            modes = held_modes((shapes,), native, k, t, q)
            planes.append(_BeamForms(surroundings(scene, shapes), forms, shapes, modes, response, frames))
        if len(planes) > 1:
            modes = held_modes([plane.shapes for plane in planes], native, k, t, q)
        vibrations = vibrations_of(modes, planes, response, start)
        watched = [_changes(forms, of) for of in vibrations]
        beams += [plane.watched([*zip(vibrations, watched, strict=True)]) for plane in planes]
    return SceneWatch(native, k, tuple(beams), Watch(tuple(forms.quantities)))


@dataclass(frozen=True)
class _WatchedChanges:
    """The numbers of quantities that change the stiffness of a vibration, see `WatchedVibration`."""

    axial: int
    axial_missed: int
    turns: tuple[int, ...]


def _changes(forms: WatchedForms, of: Vibration) -> _WatchedChanges:
    axial, missed = (forms.add([*factors], np.array([[*factors.values()]])) for factors in (of.axial, of.axial_missed))
    return _WatchedChanges(axial, missed, tuple(forms.add(range(forms.size), turn[None]) for turn in of.turns))


class _BeamForms:
    """The forms of a beam in a plane; modes: its vibrations there alone; response: to such motions."""

    def __init__(
        self,
        around: Surroundings,
        forms: WatchedForms,
        shapes: PieceShapes,
        modes: Sequence[HeldMode],
        response: StaticResponse,
        frames: PieceFrames,
    ) -> None:
        self.around, self.forms, self.shapes = around, forms, shapes
        beam, native = shapes.beam, forms.native
        self.pieces = piece_names(beam)
        self.amplitudes = [shapes.amplitudes_in(native, piece) for piece in self.pieces]
        self.columns = [column for columns in self.amplitudes for column in columns]
        self.rates = [native.nq + column for piece in self.pieces for column in shapes.rates_in(native, piece)]
        self.turned = TurnedStiffness(around, forms, shapes, frames, self.pieces, self.amplitudes)
        if modes:
            self.frequency, self.lowest = modes[0].frequency, modes[0].motion[self.amplitudes]
            self.motion: Vector | None = modes[0].motion
            self.change = response(modes[0].motion)[:, None]
        else:  # nothing deforms it alone: its first shape stands for that of the loads
            self.motion, self.change = None, np.zeros((forms.size, 0))
            self.frequency, self.lowest = np.inf, np.tile(np.eye(len(shapes.stiffness))[0], (beam.pieces, 1))
        ends = around.held
        self.clamped = ends[0] if len(ends) == 1 else None
        self.rotations_act = len(self.pieces) > 1 or any(
            np.abs(shapes.slopes(np.array([float(end)])) * shapes.length).max() > SLOPE for end in ends
        )

    def watched(self, vibrations: Sequence[tuple[Vibration, _WatchedChanges]]) -> WatchedBeam:
        """The numbers of the quantities; vibrations: those in all planes, with what changes their stiffness."""
        forms, shapes, columns = self.forms, self.shapes, self.columns
        rates = self.rates
        bent = self.along(shapes.values(places()), shapes.slopes(ENDS))
        deflection, rate = forms.add(columns, bent), forms.add(rates, bent)
        squared = forms.add(columns, bent, deflection)
        place = int(np.abs(bent @ self.lowest.ravel()).argmax())
        missed = self.missed
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
            forms.add(range(forms.size), missed.moments),
            forms.add(range(forms.size), missed.deflections),
            self.axial_missed(),
            tuple(self.vibration(*of, bent) for of in vibrations),
            tuple(tuple(forms.add(own, part[None]) for part in parts) for own in self.amplitudes),
            tuple(forms.add(own, shapes.values(xi).T / shapes.length) for own in self.amplitudes),
            self.frequency,
            self.hardening(bent),
            self.rotations_act,
        )

    def vibration(self, of: Vibration, changes: _WatchedChanges, bent: Matrix) -> WatchedVibration:
        """The quantities of a vibration, whose size is that of the deflection in this plane."""
        size = float(np.abs(bent @ of.motion[self.amplitudes].ravel()).max())
        rate = self.forms.add(of.columns, size * of.part)
        late = self.forms.add([self.forms.size - 1], np.eye(1), rate)
        return WatchedVibration(
            of.motion, rate, late, changes.axial, changes.axial_missed, changes.turns, of.frequency, of.missed
        )

    def along(self, values: Matrix, slopes: Matrix) -> Matrix:
        """The deflection of the beam per unit of fields of its pieces; of torsion see `twists_along`."""
        if self.shapes.twists:
            return twists_along(values, len(self.pieces), self.clamped)
        return deflections_along(values, slopes, self.shapes.length, len(self.pieces), self.clamped)

    @cached_property
    def missed(self) -> MissedForms:
        """The fields that the shapes miss: in sections of all pieces, along the beam, and in energies."""
        moments, deflections, energies = list[Matrix](), np.zeros((PLACES, self.forms.size)), list[Matrix]()
        slopes, turned = list[Matrix](), np.zeros(self.forms.size)
        for i, known in enumerate(known_gaps(self.around, self.forms, self.shapes, self.amplitudes)):
            form = np.array([gap.form for gap in known])
            missed = missed_fields(self.shapes, [(gap.xi, gap.order) for gap in known])
            moments.append(missed.moments.T @ form)
            energies.append(missed.energies @ form)
            deflections += self.along(missed.values, missed.slopes).reshape(PLACES, -1, len(known))[:, i] @ form
            slopes.append((missed.along - missed.slopes[:, :1]).T @ form + turned)
            turned = turned + (missed.slopes[:, 1] - missed.slopes[:, 0]) @ form
        along = np.array(slopes)
        if self.clamped is None:  # slopes from the chord
            along -= np.mean(gauss_points()[1] @ along, axis=0) / 2
        elif self.clamped == 1:
            along -= turned
        return MissedForms(np.vstack(moments), deflections, np.vstack(energies), along)

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
        for column, power, near in self.turned.axial_forces():
            a = self.lowest[near]
            columns.append(column)
            factors.append(float(np.sum(a * (a @ self.shapes.geometric_stiffness(power)))) / self.strain)
        return columns, np.array([factors])

    @property
    def second_order(self) -> bool:
        """Whether the model knows what axial forces and spins add to its stiffness in bending."""
        return not self.shapes.twists and self.shapes.beam.beam.order is not DisplacementOrder.FIRST_ORDER

    def stiffened(self, motions: Matrix) -> Iterator[tuple[int, Matrix]]:
        """The numbers in z of axial forces, and what each unit of them adds to the stiffness for motions (n, nq).

        It is that of second order, which a model of first order does not have.
        """
        return self.turned.added(motions) if self.second_order else iter(())

    def stiffened_fields(self, changes: Matrix) -> Iterator[tuple[int, Matrix]]:
        """The same for what the shapes miss in changes of z, columns of `changes` (z, n)."""
        slopes = self.missed.slopes
        return self.turned.of_slopes(lambda piece: (slopes[piece] @ changes).T) if self.second_order else iter(())

    def softened(self, motions: Matrix) -> tuple[Vector, Matrix]:
        """The spin in this plane as a form (z,), and what the square of a unit of it takes away of the stiffness."""
        if self.second_order:
            return self.turned.taken(motions)
        return np.zeros(self.forms.size), np.zeros((len(motions),) * 2)

    def axial_missed(self) -> int:
        """The stiffness that the axial force adds to what the shapes miss of the lowest mode, relative to that."""
        fields = self.missed.energies @ self.change
        forces = [*self.stiffened_fields(self.change)] if np.any(fields) else []
        factors = np.array([[float(added[0, 0]) / float(2 * np.sum(fields**2)) for _, added in forces]])
        return self.forms.add([column for column, _ in forces], factors)

    def whole_axial(self) -> int:
        """The stiffness that the axial force adds to the lowest mode with the rotations of pieces, relative to it."""
        forces = [*self.turned.added(self.motion[None])] if self.motion is not None else []
        factors = np.array([[float(added[0, 0]) / self.strain for _, added in forces]])
        return self.forms.add([column for column, _ in forces], factors)
