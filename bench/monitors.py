"""What the monitors of runs imply, against converged models.

python bench/monitors.py [NAME...]        (about an hour)

Every scene of `bench/monitor_scenes.py` is run with many models of its beams. The truth is a model of full second order
in several beams; another such model says how well it has converged, and errors that are not five times larger are left
out. The error of a beam is the root mean square over the run of the difference of its deflections, where it is largest
along the beam, over the largest deflection of the truth: from the chord, or from the tangent at the end that is held
against rotation, if there is one.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from monitor_scenes import scenes

from derive.errors import TisserandError
from derive.simulation.observables.beams import axis_points, beam_bodies, piece_names
from derive.simulation.trajectory import Trajectory
from derive.simulation.validity.end_moments import held_ends
from derive.spec.model.scene import BeamBody, Scene
from derive.study.accuracy.measurement import compiled, motion
from derive.study.accuracy.models import ORDERS, LadderModel, Shapes

FIRST, TRUNCATED, FULL = ORDERS["first"], ORDERS["truncated"], ORDERS["full"]
POLYNOMIALS = Shapes.POLYNOMIALS
REFERENCES = tuple(LadderModel(POLYNOMIALS, 3, FULL, "mean", pieces) for pieces in (4, 3))
"""The truth, and what it is compared with."""
MODELS = (
    *(LadderModel(POLYNOMIALS, count, FIRST) for count in (2, 3)),
    *(LadderModel(POLYNOMIALS, 2, FIRST, "mean", pieces) for pieces in (2, 3)),
    LadderModel(POLYNOMIALS, 2, FIRST, "tangent"),
    *(LadderModel(POLYNOMIALS, count, FULL) for count in (2, 3)),
    *(LadderModel(POLYNOMIALS, count, FULL, "tangent") for count in (2, 3)),
    *(LadderModel(POLYNOMIALS, 3, TRUNCATED, frame) for frame in ("mean", "chord")),
    LadderModel(POLYNOMIALS, 2, TRUNCATED, "mean", 2),
    LadderModel(Shapes.SINES, 1, FULL, "chord"),
    LadderModel(Shapes.SINES, 2, FIRST, "chord"),
)
PLACES = np.linspace(-1, 1, 9)
"""Along the whole beam, from -1 to 1."""
TOLERANCE = 1e-8


def deflections(moved: Trajectory, beam: BeamBody, held: float | None) -> np.ndarray:
    """(n, places): the distances of points from the chord, or from the tangent at an end, m."""
    modelled = next(b for b in beam_bodies(moved.scene) if b.name == beam.name)
    names, pieces = piece_names(modelled), modelled.pieces

    def point(s: float) -> np.ndarray:
        piece = min(int((s + 1) / 2 * pieces), pieces - 1)
        xi = float((s + 1) * pieces - 2 * piece - 1)
        return axis_points(moved.motion, modelled, names[piece], np.array([xi]))[:, 0]

    start, end = (point(-1), point(1)) if held is None else (point(held), point(held * (1 - 1e-4)))
    along = end - start
    along /= np.linalg.norm(along, axis=1)[:, None]
    away = np.stack([point(s) for s in PLACES], axis=1) - start[:, None]
    return along[:, None, 0] * away[:, :, 1] - along[:, None, 1] * away[:, :, 0]


@dataclass(frozen=True, eq=False)
class Run:
    """A model in motion: the deflections of its beams, and its monitors as plain data."""

    deflections: dict[str, np.ndarray]
    monitors: list[dict[str, object]]


def run(scene: Scene, model: LadderModel, monitored: bool) -> Run:
    """Raises TisserandError."""
    moved = motion(compiled(scene, model, monitored), TOLERANCE, monitored)
    bent = {}
    for beam in beam_bodies(scene):
        held = [float(marker.at) for marker in held_ends(scene, beam)]
        bent[beam.name] = deflections(moved, beam, held[0] if len(held) == 1 else None)
    return Run(bent, [monitor.data for monitor in moved.validity])


def error(of: np.ndarray, truth: np.ndarray) -> tuple[float, float]:
    """The root mean square over the time and the largest difference, over the peak of the truth."""
    difference, peak = of - truth, float(np.abs(truth).max())
    return float(np.sqrt((difference**2).mean(axis=0)).max()) / peak, float(np.abs(difference).max()) / peak


def rows(scene: Scene) -> Iterator[dict[str, object]]:
    """The errors of all models of a scene, and what their monitors imply."""
    truth, other = (run(scene, model, False).deflections for model in REFERENCES)
    own = {name: error(other[name], truth[name])[0] for name in truth}
    for model in MODELS:
        try:
            result = run(scene, model, True)
        except TisserandError as stopped:
            yield {"scene": scene.name, "model": model.label, "stopped": str(stopped).splitlines()[0]}
            continue
        for beam, bent in result.deflections.items():
            rms, most = error(bent, truth[beam])
            monitors = [m for m in result.monitors if m["beam"] == beam]
            yield {
                "scene": scene.name,
                "model": model.label,
                "beam": beam,
                "rms": rms,
                "largest": most,
                "reference": own[beam],
                "monitors": monitors,
            }


def main() -> None:
    names = sys.argv[2:]
    with Path(sys.argv[1]).open("w") as file:
        for scene in scenes():
            if names and scene.name not in names:
                continue
            try:
                for row in rows(scene):
                    file.write(json.dumps(row) + "\n")
            except TisserandError as stopped:
                file.write(json.dumps({"scene": scene.name, "stopped": str(stopped)}) + "\n")
            file.flush()
            print(scene.name, flush=True)


if __name__ == "__main__":
    main()
