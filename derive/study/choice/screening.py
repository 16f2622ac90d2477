"""Screening of the beams of a scene by two cheap runs: the loads on beams relative to their resistance.

The beams are taken as rigid. Their accelerations a across the axis, less those of free fall, are the inertia loads that
would bend them; a beam whose lowest frequency w is high against those of its loads bends by about 4/pi a/w^2, as half a
sine wave does. The frequency is that of the beam with its joints. The axial force, in the shape of that vibration, is
the one that the monitors of a run with three polynomials report.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from derive.errors import TisserandError
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.prescribed_motion import drive_speed
from derive.percentages import percent
from derive.runtime.compiler import UNOPTIMISED
from derive.simulation.observables.default_plots import output_columns
from derive.simulation.observables.motion import si_value
from derive.simulation.validity.held_beam import held_modes
from derive.simulation.validity.monitors import Cause
from derive.simulation.validity.piece_shapes import PieceShapes
from derive.spec.model.instances import identifier
from derive.spec.model.markers import MarkerRef
from derive.spec.model.plots import ColumnCurves, Plot
from derive.spec.model.ports import SceneOutput
from derive.spec.model.scene import BeamBody, Scene
from derive.spec.model.time_function import value_at
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.measurement import ModelVariant, motion, opened, prepared
from derive.study.choice.model_runs import FLEXIBLE, ModelRuns
from derive.study.choice.trusted_reference import expect_first

TOLERANCE = 1e-6
"""The tolerance of the runs."""
SPEEDS = 1001
"""The number of times of a simulation at which the speeds of drives are evaluated."""
MODAL = 4 / np.pi
"""The part of a uniform load that bends a beam into half a sine wave, as an amplitude."""


@dataclass(frozen=True)
class Screening:
    """The loads on a beam; None where a number is not known.

    frequency: the lowest of the beam with its joints, rad/s. driving, spin: the largest speed of a drive that
    rotates and the largest rate of rotation of the beam, rad/s. deflection: about, over the length. axial: the largest
    axial force over the load under which the beam buckles.
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
        for what, value in (("driven at", self.driving), ("rotates at up to", self.spin)):
            if value:
                parts.append(f"{what} {value:.4g} rad/s ({percent(value / self.frequency)} of it)")
        if self.axial is not None:
            parts.append(f"axial force up to {percent(self.axial)} of its buckling load")
        if self.deflection is not None:
            parts.append(f"expected deflection about {percent(self.deflection)} of the length")
        return f"{self.beam}: {'; '.join(parts)}"


def screening(runs: ModelRuns) -> tuple[Screening, ...]:
    """The screening of each beam of a scene."""
    scene = runs.scene
    beams = [body for body in scene.bodies if isinstance(body, BeamBody)]
    expect_first(runs)
    accelerations = _accelerations(scene, beams)
    frequencies, axial = _flexible(runs, beams)
    driving = _driving(scene)
    result = []
    for beam in beams:
        frequency, spin, across = frequencies.get(beam.name), None, None
        if beam.name in accelerations:
            spin, across = accelerations[beam.name]
        bent = None
        if frequency and across is not None:
            bent = MODAL * across / frequency**2 / si_value(beam.beam.length)
        result.append(Screening(beam.name, frequency, driving, spin, bent, axial.get(beam.name)))
    return tuple(result)


def _flexible(runs: ModelRuns, beams: list[BeamBody]) -> tuple[dict[str, float], dict[str, float]]:
    """The lowest frequencies, rad/s, and the axial forces over the buckling loads, with three polynomials, by the names
    of beams; without those that cannot be computed."""
    try:
        flexible = runs.compiled(FLEXIBLE)
    except TisserandError:
        return {}, {}
    try:
        seen = motion(flexible, TOLERANCE, monitored=True).validity
    except TisserandError:
        seen = ()
    modelled = {body.name: body for body in flexible.scene.bodies if isinstance(body, BeamBody)}
    start = flexible.native, flexible.k, 0.0, flexible.start.q
    modes = ((beam.name, held_modes(PieceShapes(modelled[beam.name]), *start)) for beam in beams)
    axial = {monitor.beam: monitor.value for monitor in seen if monitor.cause is Cause.AXIAL_FORCE}
    return {name: of_beam[0].frequency for name, of_beam in modes if of_beam}, axial


def _driving(scene: Scene) -> float | None:
    """The largest speed of a drive that rotates, of those whose speed is given, rad/s."""
    rotating = {j.name for j in scene.joints if (driven := JOINTS[j.kind].driven) and driven.unit == "rad"}
    times = np.linspace(0.0, scene.simulation.duration if scene.simulation else 0.0, SPEEDS)
    speeds = (speed for drive in scene.drives if drive.joint in rotating and (speed := drive_speed(drive)))
    return max((abs(value_at(speed, t)) for speed in speeds for t in times.tolist()), default=None)


def _watched(kind: str, beam: str, end: int) -> str:
    """The name of an output that watches one of the two outermost markers of a beam."""
    return identifier("screened", kind, beam, str(end))


def _accelerations(scene: Scene, beams: list[BeamBody]) -> dict[str, tuple[float, float]]:
    """The largest rate of rotation (rad/s), and the largest acceleration across the axis less that of free fall (m/s^2,
    root mean square over the length), in a run with rigid beams, by the names of beams with two markers."""
    pairs = {}
    for beam in beams:
        places = sorted(beam.markers, key=lambda m: m.at)
        if len(places) > 1 and places[0].at < places[-1].at:
            pairs[beam.name] = (places[0], places[-1])
    watched = tuple(
        SceneOutput(_watched(kind, name, n), kind, {"marker": MarkerRef(name, marker.name)})
        for name, ends in pairs.items()
        for n, marker in enumerate(ends)
        for kind in ("position", "acceleration")
    )
    columns = tuple(column for output in watched for column in output_columns(output))
    watching = replace(scene, outputs=watched, plots=(Plot("screened", ColumnCurves(columns)),))
    rigid = ModelVariant(LadderModel(Shapes.RIGID), monitored=False, flags=UNOPTIMISED)
    try:
        moved = motion(opened(prepared(watching, rigid)), TOLERANCE)
    except TisserandError:
        return {}
    fall = np.array([si_value(g) for g in scene.gravity or ()] or [0.0, 0.0])

    def vector(kind: str, name: str, n: int) -> np.ndarray:
        return np.stack([moved[f"{_watched(kind, name, n)}_{axis}"] for axis in (1, 2)], axis=1)

    result = {}
    for name, (left, right) in pairs.items():
        apart = vector("position", name, 1) - vector("position", name, 0)
        distance = np.linalg.norm(apart, axis=1)
        along = apart / distance[:, None]
        normal = np.stack([-along[:, 1], along[:, 0]], axis=1)
        ends = [vector("acceleration", name, n) - fall for n in (0, 1)]
        spin = np.sqrt(np.abs(((ends[0] - ends[1]) * along).sum(axis=1)) / distance)
        across = [(a * normal).sum(axis=1) for a in ends]
        slope = (across[1] - across[0]) / float(right.at - left.at)  # by xi: it is linear along a rigid beam
        middle = across[0] - slope * float(left.at)
        result[name] = float(spin.max()), float(np.sqrt(middle**2 + slope**2 / 3).max())
    return result
