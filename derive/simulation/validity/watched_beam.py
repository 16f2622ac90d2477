"""The quantities that a run watches of its beams, as linear forms of its state and its outputs, and their products."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np

from derive.runtime.integrators.watch import Watch, Watched
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.validity.beam_forms import BeamForms
from derive.simulation.validity.beam_line import places
from derive.simulation.validity.beam_vibrations import Vibration, vibrations_of
from derive.simulation.validity.bending_planes import bending_planes
from derive.simulation.validity.held_beam import StaticResponse, held_modes
from derive.simulation.validity.missed_moment import ENDS, SECTIONS, sections
from derive.simulation.validity.monitoring_outputs import is_monitored
from derive.simulation.validity.piece_frames import PieceFrames
from derive.simulation.validity.piece_shapes import PieceShapes
from derive.simulation.validity.surroundings import surroundings
from derive.simulation.validity.watched_forms import WatchedForms
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.specification import AnyScene


@dataclass(frozen=True, eq=False)
class WatchedVibration:
    """A vibration of a beam: its rate, as the deflection where that is largest, m/s, and the rate times the time, m.

    frequency: that of its strain energy alone, rad/s. missed: the strain energy that the shapes miss, relative to it.
    axial: the stiffness that the axial force adds, relative to that of the strain energy; axial_missed: the same of
    what is missed. turns: the square of each is the part of that stiffness which a spin takes away. motion (nq,): of
    all coordinates, with a kinetic energy of 1/2 J for its velocities.
    """

    rate: int
    late: int
    axial: int
    axial_missed: int
    turns: tuple[int, ...]
    frequency: float
    missed: float
    motion: Vector


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

    def outputs_of(self, t: Vector, q: Matrix, v: Matrix, outputs: Matrix | None = None) -> Matrix:
        """(n, nout): the outputs in these states."""
        native, k = self.native, self.k
        if outputs is None:
            outputs = np.empty((len(t), len(native.outputs)))
            for row, time, at, rates in zip(outputs, t, q, v, strict=True):
                row[:] = native.evaluate_outputs(float(time), at, rates, *native.solve(float(time), at, rates, k), k)
        return outputs

    def _rows(self, t: Vector, q: Matrix, v: Matrix, outputs: Matrix | None) -> Matrix:
        return np.hstack([q, v, self.outputs_of(t, q, v, outputs)])


def scene_watch(scene: AnyScene, native: NativeScene, k: Vector, t: float, q: Vector, v: Vector) -> SceneWatch:
    """The watch of a scene compiled with the outputs of `with_monitors`; q (nq,), v (nv,): its state at t (s)."""
    forms = WatchedForms(native)
    beams = list[WatchedBeam]()
    spinning, frames = StaticResponse(native, k, t, q, v), PieceFrames(native, k, t, q)
    still, start = replace(spinning, v=np.zeros_like(v)), spinning.start()
    for _, of_beam in groupby(bending_planes(scene) if is_monitored(scene) else (), lambda shapes: shapes.beam.name):
        planes, own = list[BeamForms](), [*of_beam]
        response = still if own[0].beam.beam.order is DisplacementOrder.FIRST_ORDER else spinning
        for shapes in own:
            modes = held_modes((shapes,), native, k, t, q)
            planes.append(BeamForms(surroundings(scene, shapes), forms, shapes, modes, response, frames))
        if len(planes) > 1:
            modes = held_modes([plane.shapes for plane in planes], native, k, t, q)
        vibrations = vibrations_of(modes, planes, response, start)
        watched = [_changes(forms, of) for of in vibrations]
        beams += [_watched_beam(plane, [*zip(vibrations, watched, strict=True)]) for plane in planes]
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


def _watched_beam(of: BeamForms, vibrations: Sequence[tuple[Vibration, _WatchedChanges]]) -> WatchedBeam:
    """The quantities of a beam in a plane; vibrations: those in all planes, with what changes their stiffness."""
    forms, shapes, columns, rates = of.forms, of.shapes, of.columns, of.rates
    bent = of.along(shapes.values(places()), shapes.slopes(ENDS))
    deflection, rate = forms.add(columns, bent), forms.add(rates, bent)
    squared = forms.add(columns, bent, deflection)
    place = int(np.abs(bent @ of.lowest.ravel()).argmax())
    every_section = np.kron(np.eye(len(of.pieces)), shapes.moments(sections()).T).astype(np.float64)
    parts = np.linalg.cholesky(shapes.stiffness).T / np.sqrt(2)
    xi = np.linspace(-1, 1, 2 * SECTIONS)
    axial = of.axial()
    relative = forms.add(*axial)
    return WatchedBeam(
        shapes=shapes,
        deflection=deflection,
        rate=rate,
        late=_times_time(forms, rate),
        cubed=forms.add(columns, bent, squared),
        middle=forms.add(columns, bent[place, None]),
        middle_rate=forms.add(rates, bent[place, None]),
        axial=relative,
        axial_product=forms.add(*axial, deflection),
        whole_axial=forms.add(*of.whole_axial()),
        moment=forms.add(columns, every_section),
        missed_moment=forms.add(range(forms.size), of.missed.moments),
        missed=forms.add(range(forms.size), of.missed.deflections),
        axial_missed=forms.add(*of.axial_missed()),
        vibrations=tuple(_watched_vibration(of, *each, bent) for each in vibrations),
        energies=tuple(tuple(forms.add(own, part[None]) for part in parts) for own in of.amplitudes),
        piece_deflections=tuple(forms.add(own, shapes.values(xi).T / shapes.length) for own in of.amplitudes),
        frequency=of.frequency,
        hardening=of.hardening(bent),
        rotations_act=of.rotations_act,
    )


def _watched_vibration(of: BeamForms, vibration: Vibration, changes: _WatchedChanges, bent: Matrix) -> WatchedVibration:
    """The quantities of a vibration, whose size is that of the deflection in this plane."""
    size = float(np.abs(bent @ vibration.motion[of.amplitudes].ravel()).max())
    rate = of.forms.add(vibration.columns, size * vibration.part)
    return WatchedVibration(
        rate,
        _times_time(of.forms, rate),
        changes.axial,
        changes.axial_missed,
        changes.turns,
        vibration.frequency,
        vibration.missed,
        vibration.motion,
    )


def _times_time(forms: WatchedForms, quantity: int) -> int:
    """The number of a quantity times the time."""
    return forms.add([forms.size - 1], np.eye(1), quantity)
