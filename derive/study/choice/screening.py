"""Screening of the flexible bodies of a scene by two cheap runs: the loads on them relative to their resistance.

The bodies are taken as rigid. Their accelerations a across the axis, less those of free fall, are the inertia loads
that would bend them; a body whose lowest frequency w is high against those of its loads bends by about 4/pi a/w^2, as
half a sine wave does. The axis is that of a beam, or the line through the markers of a finite-element body that are
farthest apart. The frequency is that of the body with its joints. The axial force, in the shape of that vibration, is
the one that the monitors of a run with three polynomials report; in space it is not known.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

from derive.errors import TisserandError
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.mechanics.prescribed_motion import drive_speed
from derive.mechanics.symbols import amplitude_of
from derive.percentages import percent
from derive.runtime.compiler import UNOPTIMISED
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.observables.beams import beam_bodies
from derive.simulation.observables.default_plots import output_columns
from derive.simulation.observables.motion import si_value
from derive.simulation.space.marker_frames import modal_frames_of
from derive.simulation.validity.held_beam import HeldMode, admitted_modes, held_modes
from derive.simulation.validity.monitors import Cause
from derive.simulation.validity.piece_shapes import PieceShapes
from derive.spec.model.instances import identifier
from derive.spec.model.markers import MarkerRef
from derive.spec.model.plots import ColumnCurves, Plot
from derive.spec.model.ports import SceneOutput
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene
from derive.spec.model.time_function import value_at
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.measurement import ModelVariant, motion, opened, prepared
from derive.study.accuracy.modelled_bodies import flexible_members
from derive.study.choice.model_runs import ModelRuns
from derive.study.choice.trusted_reference import expect_first

TOLERANCE = 1e-6
"""The tolerance of the runs."""
SPEEDS = 1001
"""The number of times of a simulation at which the speeds of drives are evaluated."""
MODAL = 4 / np.pi
"""The part of a uniform load that bends a beam into half a sine wave, as an amplitude."""


NEGLIGIBLE = 1e-6
"""The part of the frequency below which a speed is rounding: a shaft that spins about its axis does not turn that."""

SMALL = 1e-6
"""The amplitudes that show the stiffness of a body in space, m."""


class End(NamedTuple):
    """A marker of a flexible body, and where it is along its axis, from -1 to 1."""

    name: str
    at: float


@dataclass(frozen=True)
class Screening:
    """The loads on a flexible body; None where a number is not known.

    frequency: the lowest of the beam with its joints, rad/s. driving, spin: the largest speed of a drive that
    rotates and the largest rate at which the axis of the beam turns, rad/s. deflection: about, over the length, by
    the inertia of the beam alone, without what other bodies exert on it.
    axial: the largest axial force over the load under which the beam buckles.
    """

    beam: str
    frequency: float | None
    driving: float | None
    spin: float | None
    deflection: float | None
    axial: float | None = None

    @property
    def text(self) -> str:
        """The line of text with the numbers."""
        if self.frequency is None:
            return f"{self.beam}: no natural frequency is known"
        parts = [f"lowest natural frequency {self.frequency:.4g} rad/s as its joints hold it"]
        for what, value in (("driven at", self.driving), ("its axis turns at up to", self.spin)):
            if value is not None and value > NEGLIGIBLE * self.frequency:
                parts.append(f"{what} {value:.4g} rad/s ({percent(value / self.frequency)} of it)")
        if self.axial is not None:
            parts.append(f"axial force up to {percent(self.axial)} of its buckling load")
        if self.deflection is not None:
            parts.append(f"its own inertia bends it by about {percent(self.deflection)} of its length")
        return f"{self.beam}: {'; '.join(parts)}"


def screening(runs: ModelRuns) -> tuple[Screening, ...]:
    """The screening of each flexible body of a scene."""
    scene = runs.scene
    bodies = flexible_members(scene)
    expect_first(runs)
    accelerations = _accelerations(scene)
    frequencies, axial = _flexible(runs)
    driving = _driving(scene)
    result = []
    for body in bodies:
        frequency, spin, across, length = frequencies.get(body.name), None, None, None
        if body.name in accelerations:
            spin, across, length = accelerations[body.name]
        bent = MODAL * across / frequency**2 / length if frequency and across is not None and length else None
        result.append(Screening(body.name, frequency, driving, spin, bent, axial.get(body.name)))
    return tuple(result)


def _flexible(runs: ModelRuns) -> tuple[dict[str, float], dict[str, float]]:
    """The lowest frequencies, rad/s, and the axial forces over the buckling loads, in the flexible model that is
    examined first, by the names of bodies; without those that cannot be computed."""
    try:
        flexible = runs.compiled(runs.models.flexible)
    except TisserandError:
        return {}, {}
    start = flexible.native, flexible.k, 0.0, flexible.start.q
    if isinstance(flexible.scene, SpatialScene):
        names = [body.name for body in flexible_members(flexible.scene)]
        modes = ((name, modes_in_space(name, *start)) for name in names)
        return {name: of_body[0].frequency for name, of_body in modes if of_body}, {}
    try:
        seen = motion(flexible, TOLERANCE, monitored=True).validity
    except TisserandError:
        seen = ()
    held = ((beam.name, held_modes((PieceShapes(beam),), *start)) for beam in beam_bodies(flexible.scene))
    axial = {monitor.beam: monitor.value for monitor in seen if monitor.cause is Cause.AXIAL_FORCE}
    return {name: of_beam[0].frequency for name, of_beam in held if of_beam}, axial


def _driving(scene: AnyScene) -> float | None:
    """The largest speed of a drive that rotates, of those whose speed is given, rad/s."""
    known: Any = SPATIAL_JOINTS if isinstance(scene, SpatialScene) else JOINTS
    rotating = {j.name for j in scene.joints if (driven := known[j.kind].driven) and driven.unit == "rad"}
    times = np.linspace(0.0, scene.simulation.duration if scene.simulation else 0.0, SPEEDS)
    speeds = (speed for drive in scene.drives if drive.joint in rotating and (speed := drive_speed(drive)))
    return max((abs(value_at(speed, t)) for speed in speeds for t in times.tolist()), default=None)


def _watched(kind: str, beam: str, end: int) -> str:
    """The name of an output that watches one of the two outermost markers of a beam."""
    return identifier("screened", kind, beam, str(end))


def _ends(scene: AnyScene) -> dict[str, tuple[End, End]]:
    """The markers of flexible bodies that are farthest apart, and where they are between -1 and 1, by the body."""
    result = {}
    for body in flexible_members(scene):
        places = list[End]()
        if isinstance(body, FlexibleBody):
            points = {name: frame.point.position for name, frame in modal_frames_of(body).items()}
            pairs = [(float(np.linalg.norm(points[a] - points[b])), a, b) for a, b in combinations(points, 2)]
            if pairs:
                _, left, right = max(pairs)
                places = [End(left, -1.0), End(right, 1.0)]
        else:
            markers: Any = body.markers
            places = sorted((End(m.name, float(m.at)) for m in markers), key=lambda end: end.at)
        if len(places) > 1 and places[0].at < places[-1].at:
            result[body.name] = places[0], places[-1]
    return result


def _accelerations(scene: AnyScene) -> dict[str, tuple[float, float, float]]:
    """The largest rate of rotation across the axis (rad/s), the largest acceleration across it less that of free fall
    (m/s^2, root mean square over the length), and the length (m), in a run with rigid bodies, by the names of bodies
    with two markers."""
    pairs, in_space = _ends(scene), isinstance(scene, SpatialScene)
    watched, plots = list[SceneOutput](), list[Plot]()
    for name, places in pairs.items():
        own = [
            SceneOutput(_watched(kind, name, n), kind, {"marker": MarkerRef(name, marker.name)})
            for n, marker in enumerate(places)
            for kind in ("position", "acceleration")
        ]
        columns = tuple(column for output in own for column in output_columns(output, in_space))
        plots.append(Plot(identifier("screened", name), ColumnCurves(columns)))
        watched += own
    watching: Any = replace(scene, outputs=tuple(watched), plots=tuple(plots))
    rigid = ModelVariant(LadderModel(Shapes.RIGID), monitored=False, flags=UNOPTIMISED)
    try:
        moved = motion(opened(prepared(watching, rigid)), TOLERANCE)
    except TisserandError:
        return {}
    axes = (1, 2, 3) if in_space else (1, 2)
    fall = np.array([si_value(g) for g in scene.gravity or ()] or [0.0] * len(axes))

    def vector(kind: str, name: str, n: int) -> Matrix:
        return np.stack([moved[f"{_watched(kind, name, n)}_{axis}"] for axis in axes], axis=1)

    result = {}
    for name, (left, right) in pairs.items():
        apart = vector("position", name, 1) - vector("position", name, 0)
        distance = np.linalg.norm(apart, axis=1, keepdims=True)
        along = apart / distance
        ends = [vector("acceleration", name, n) - fall for n in (0, 1)]
        spin = np.sqrt(np.abs(((ends[0] - ends[1]) * along).sum(axis=1)) / distance[:, 0])
        across = [a - (a * along).sum(axis=1, keepdims=True) * along for a in ends]
        slope = (across[1] - across[0]) / (right.at - left.at)  # by xi: it is linear along a rigid body
        middle = across[0] - slope * left.at
        mean_square = (middle**2 + slope**2 / 3).sum(axis=1)
        length = 2 * float(distance[0, 0]) / (right.at - left.at)
        result[name] = float(spin.max()), float(np.sqrt(mean_square.max())), length
    return result


def modes_in_space(body: str, native: NativeScene, k: Vector, t: float, q: Vector) -> tuple[HeldMode, ...]:
    """The vibrations of a flexible body in space as the joints hold it in a state q (nq,) at rest, as `held_modes`.

    The stiffness is that of its amplitudes alone, from small ones: elastic forces are linear in these.
    """
    indices = [i for i in range(1, native.nq + 1) if amplitude_of(body, i).shown in native.coordinates]
    places = [native.coordinates.index(amplitude_of(body, i).shown) for i in indices]
    own = [native.velocities.index(amplitude_of(body, i, 1).name) for i in indices]
    K, at_rest = np.zeros((native.nv, native.nv)), np.zeros(native.nv)
    for place, column in zip(places, own, strict=True):
        step = np.zeros(native.nq)
        step[place] = SMALL
        ahead, behind = (native.force(t, q + sign * step, at_rest, k) for sign in (1, -1))
        K[own, column] = (ahead - behind)[own] / (2 * SMALL)
    return admitted_modes((K + K.T) / 2, native, k, t, q, own)
