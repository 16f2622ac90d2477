"""The errors that the monitors of runs imply, compared with converged models.

python bench/monitors.py FILE [NAME...]            (about an hour; NAME: some scenes of `bench/monitor_scenes.py`)
python bench/monitors.py FILE --seeds 0:100        (scenes of the random corpus that have beams, about a minute each)

Every scene is run with many models of its beams; a line of FILE in JSON has the error and the monitors of a beam in a
run. What FILE has already is not run again. The truth is a model of full second order in four beams; that in three says
how well it has converged, and errors that are not three times larger, or below .2 %, are left out of the table, and so
are beams that bend by less than a millionth of their length. The error of a beam is the root mean square over the run
of the difference of its deflections, where it is largest along the beam, over the largest deflection of the truth: from
the chord, or from the tangent at the end that is held against rotation, if there is one. Errors and estimates above
100 % count as 100 %.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from monitor_scenes import scenes
from resumed_rows import resumed

import derive
from derive.errors import TisserandError, first_line
from derive.percentages import percent
from derive.simulation.observables.beams import axis_points, beam_bodies, piece_names
from derive.simulation.trajectory import Trajectory
from derive.simulation.validity.loaded_sections import held_ends
from derive.simulation.validity.monitors import ERROR_LIMIT, Cause
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.scene import Scene
from derive.study.accuracy.ladder_model import ORDERS, LadderModel, Shapes
from derive.study.accuracy.measurement import compiled, motion

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
LEAST = 0.002
"""Errors below it do not count."""


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


Row = dict[str, Any]


def rows(scene: Scene) -> Iterator[Row]:
    """The errors of all models of a scene, and what their monitors imply."""
    truth, other = (run(scene, model, False).deflections for model in REFERENCES)
    own = {name: error(other[name], truth[name])[0] for name in truth}
    for model in MODELS:
        try:
            result = run(scene, model, True)
        except TisserandError as stopped:
            yield {"scene": scene.name, "model": model.label, "stopped": first_line(stopped)}
            continue
        for beam, bent in result.deflections.items():
            rms, most = error(bent, truth[beam])
            monitors = [m for m in result.monitors if m["beam"] == beam]
            row = {"scene": scene.name, "model": model.label, "beam": beam, "rms": rms, "largest": most}
            yield {**row, "reference": own[beam], "monitors": monitors}


def implied(row: Row) -> tuple[float, str]:
    """The largest implied error, and what it is of."""
    return max((float(m["error"]), str(m["quantity"])) for m in row["monitors"])


def reliable(row: Row) -> bool:
    """Whether a beam bends, its error is large enough, and that of the truth small against it."""
    bends = any(m["quantity"] == Cause.DEFLECTION.value for m in row["monitors"]) or implied(row)[0] > ERROR_LIMIT
    return bool(bends and row["rms"] > LEAST and row["reference"] < row["rms"] / 3)


def table(known: Sequence[Row]) -> str:
    """Ratios of estimates to errors: by the quantity with the largest error, by kinds of scenes, and of all."""
    ratios: dict[str, list[float]] = {"all": []}
    measured = [row for row in known if "rms" in row]
    for row in filter(reliable, measured):
        estimate, quantity = implied(row)
        ratio = min(estimate, 1.0) / min(row["rms"], 1.0)
        for key in ("all", quantity, f"scenes {row['scene'].split('_')[0]}"):
            ratios.setdefault(key, []).append(ratio)
    lines = [
        "| estimates by | runs | 5 % | median | 95 % | within 2 | within 4 |",
        "|---|---:|---:|---:|---:|---:|---:|",
    ]
    for key, values in sorted(ratios.items()):
        low, middle, high = np.quantile(values, [0.05, 0.5, 0.95])
        off = np.exp(np.abs(np.log(np.maximum(values, 1e-12))))
        within = (percent(float(np.mean(off <= limit))) for limit in (2, 4))
        lines.append(f"| {key} | {len(values)} | {low:.2f} | {middle:.2f} | {high:.2f} | {' | '.join(within)} |")
    beams = {(row["scene"], row["model"], row["beam"]): [row] for row in measured}
    runs: dict[Any, list[Row]] = {}
    for row in measured:
        runs.setdefault((row["scene"], row["model"]), []).append(row)
    return "\n".join(
        [*lines, "", verdicts("beams", beams.values()), verdicts("runs, with all their beams", runs.values())]
    )


def verdicts(of: str, groups: Iterable[Sequence[Row]]) -> str:
    """How many groups of beams warn, of those in which an error is above the limit, and of the others."""
    counts = {(wrong, warned): 0 for wrong in (True, False) for warned in (True, False)}
    for rows in groups:
        if all(reliable(row) or row["rms"] < ERROR_LIMIT for row in rows):
            wrong = any(row["rms"] > ERROR_LIMIT for row in rows)
            counts[wrong, any(implied(row)[0] > ERROR_LIMIT for row in rows)] += 1
    return (
        f"{of}: error above {percent(ERROR_LIMIT)}: {counts[True, True]} warn, {counts[True, False]} do not; "
        f"below: {counts[False, True]} warn, {counts[False, False]} do not"
    )


def corpus(seeds: range) -> Iterator[Scene]:
    """The scenes of the random corpus with flexible beams, without outputs, which their models may not have."""
    sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
    from corpus.generator import corpus_scene

    for seed in seeds:
        with tempfile.TemporaryDirectory() as folder:
            spec = derive.read(corpus_scene(seed).write(Path(folder) / "scene"))
        if isinstance(spec, Scene) and spec.simulation is not None and any(beam_bodies(spec)):
            yield replace(spec, outputs=(), plots=(), simulation=replace(spec.simulation, until=None))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--seeds", type=lambda text: range(*map(int, text.split(":"))))
    options = parser.parse_args()
    every = corpus(options.seeds) if options.seeds else scenes()
    named = ((scene.name, partial(rows, scene)) for scene in every if scene.name in (options.names or [scene.name]))
    print(table(resumed(options.file, named)))


if __name__ == "__main__":
    main()
