"""The errors that the monitors of beams in space imply, compared with finer models.

python bench/spatial_monitors.py FILE 2000:2100    (scenes of the random corpus that have beams in space)

Every scene is run as it is, and with its beams in two pieces of second order with three polynomials each, the truth;
about three minutes each. A line of FILE in JSON has the error of a beam along e2 or e3 and what its monitors imply.
What FILE has already is not run again. The deflection is that of `bench/monitors.py`, along the axes of the section at
the left end, or at the end that is held against rotation if there is one.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

import derive
from derive.errors import TisserandError, first_line
from derive.simulation.observables.motion import si_value
from derive.simulation.validity.monitors import ERROR_LIMIT
from derive.simulation.validity.spatial_sections import held_in_plane
from derive.spec.model.beam_parts import Frame
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.markers import MarkerRef
from derive.spec.model.ports import SceneOutput
from derive.spec.model.spatial_beam import SpatialBeam, SpatialBody
from derive.spec.model.spatial_beam_parts import SectionFrame
from derive.spec.model.spatial_scene import SpatialScene

PLACES = [Fraction(n, 2) for n in range(-2, 3)]
POLYNOMIALS = tuple(tuple(Fraction(int(i == n)) for i in range(n + 1)) for n in range(5))
LEAST = 0.002
STRAIGHT = 1e-6
Row = dict[str, Any]


def watched(scene: SpatialScene, pieces: int | None) -> SpatialScene:
    """The scene with its own beams, or with finer ones, and outputs of the places of points along them."""
    bodies, outputs = list[SpatialBody](), list[SceneOutput]()
    for body in scene.bodies:
        if not isinstance(body, SpatialBeam):
            bodies.append(body)
            continue
        markers = (*body.markers, *(SectionFrame(f"seen{i}", at) for i, at in enumerate(PLACES)))
        bodies.append(_finer(replace(body, markers=markers), pieces))
        for axis in (2, 3):
            base = f"seen{_base(scene, body.name, axis)}"
            for i in range(len(PLACES)):
                values = {"marker": MarkerRef(body.name, f"seen{i}"), "frame": MarkerRef(body.name, base)}
                outputs.append(SceneOutput(f"{body.name}_{axis}_{i}", "position", values))
    assert scene.simulation is not None
    settings = replace(scene.simulation, until=None)
    return replace(scene, bodies=tuple(bodies), outputs=tuple(outputs), plots=(), simulation=settings)


def _finer(body: SpatialBeam, pieces: int | None) -> SpatialBeam:
    if pieces is None:
        return body
    lateral = replace(body.lateral, ansatz=None) if body.lateral else None
    cut = replace(body, order=DisplacementOrder.TRUNCATED, pieces=pieces, lateral=lateral)
    return replace(cut, ansatz=POLYNOMIALS, ends=None, frame=Frame("mean"))


def _base(scene: SpatialScene, beam: str, axis: int) -> int:
    return len(PLACES) - 1 if held_in_plane(scene, beam, axis) == (Fraction(1),) else 0


def deflections(run: derive.Trajectory, scene: SpatialScene) -> dict[tuple[str, int], np.ndarray]:
    """(n, places) of each beam along each axis."""
    result = {}
    for body in (body for body in scene.bodies if isinstance(body, SpatialBeam)):
        for axis in (2, 3):
            x = np.stack([run[f"{body.name}_{axis}_{i}_{axis}"] for i in range(len(PLACES))], axis=1)
            if len(held_in_plane(scene, body.name, axis)) != 1:
                x = x - np.outer(x[:, -1], (np.array(PLACES, float) + 1) / 2)
            result[body.name, axis] = x
    return result


def rows(scene: SpatialScene) -> Iterator[Row]:
    """The errors of the beams of a scene, and what their monitors imply."""
    runs = [derive.simulate(watched(scene, pieces)) for pieces in (None, 2)]
    own, truth = (deflections(run, scene) for run in runs)
    lengths = {b.name: b.length for b in scene.bodies if isinstance(b, SpatialBeam)}
    for key, of in truth.items():
        peak = float(np.abs(of).max())
        monitors = [m.data for m in runs[0].validity if (m.beam, m.axis) == key]

        def error(of: np.ndarray, peak: float = peak, truth: np.ndarray = of) -> float:
            return float(np.sqrt(((of - truth) ** 2).mean(axis=0)).max()) / peak if peak else 0.0

        size = peak / si_value(lengths[key[0]])
        yield {
            "scene": scene.name,
            "beam": key[0],
            "axis": key[1],
            "size": size,
            "rms": error(own[key]),
            "monitors": monitors,
        }


def corpus(seeds: range) -> Iterator[SpatialScene]:
    """The scenes of the random corpus with beams in space."""
    sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
    from corpus.generator import corpus_scene

    for seed in seeds:
        with tempfile.TemporaryDirectory() as folder:
            spec = derive.read(corpus_scene(seed).write(Path(folder) / "scene"))
        if not isinstance(spec, SpatialScene) or spec.simulation is None or spec.lowering == "instances":
            continue
        if sum(isinstance(body, SpatialBeam) for body in spec.bodies) in (1, 2):
            yield spec


def verdicts(known: list[Row]) -> str:
    """How many beams warn, of those in which an error is above the limit, and of the others."""
    counts = {(wrong, warned): 0 for wrong in (True, False) for warned in (True, False)}
    ratios = []
    for row in known:
        if "rms" not in row or row["size"] < STRAIGHT:
            continue
        estimate = max((m["error"] for m in row["monitors"]), default=0.0)
        counts[row["rms"] > ERROR_LIMIT, estimate > ERROR_LIMIT] += 1
        if row["rms"] > LEAST:
            ratios.append(min(estimate, 1.0) / min(row["rms"], 1.0))
    within = [np.mean([1 / f <= r <= f for r in ratios]) if ratios else np.nan for f in (2, 4)]
    return (
        f"error above the limit: {counts[True, True]} warn, {counts[True, False]} do not; below: "
        f"{counts[False, True]} warn, {counts[False, False]} do not; of {len(ratios)} estimates {within[0]:.0%} are "
        f"within a factor of 2, {within[1]:.0%} of 4, median {np.median(ratios) if ratios else np.nan:.2f}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path)
    parser.add_argument("seeds", type=lambda text: range(*map(int, text.split(":"))))
    options = parser.parse_args()
    path = options.file
    known = [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []
    finished = {row["scene"] for row in known}
    for scene in corpus(options.seeds):
        if scene.name in finished:
            continue
        try:
            new = list(rows(scene))
        except TisserandError as stopped:
            new = [{"scene": scene.name, "stopped": first_line(stopped)}]
        known += new
        with path.open("a") as file:
            file.writelines(json.dumps(row) + "\n" for row in new)
        print(scene.name, file=sys.stderr, flush=True)
    print(verdicts(known))


if __name__ == "__main__":
    main()
