"""`tisserand simulate`: a scene in motion, as numbers (CSV), as pictures (SVG), and as a page that plays it (HTML)."""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from derive.artifacts import File, write
from derive.errors import Problem, SpecError
from derive.simulation.observables import csv_writer as record
from derive.simulation.observables import plots as figures
from derive.simulation.observables import rods
from derive.simulation.observables.plots import Line
from derive.simulation.run import Run, columns
from derive.simulation.run import run as simulate
from derive.spec.model.scene import BeamBody, Plot, Scene
from derive.spec.tables.scene import MAX_STEPS
from derive.spec.toml.read import read, with_lines
from derive.study.text_table import beams, table
from derive.terminal import show
from derive.visual import line_chart as chart
from derive.visual import player

Shown = tuple[Plot, tuple[Line, ...]]


def run(options: argparse.Namespace) -> int:
    """Simulate the scene, and again with every number of pieces that a plot asks for; then write all files."""
    scene = scene_of(options.spec, options.duration)
    runs = Runs(options.spec, scene)
    main = runs.of(None, 0)
    shown: list[Shown] = []
    for plot in scene.plots:
        found = [(_label(plot, n), runs.of(plot.cut, n)) for n in plot.pieces or (0,)]
        shown.append((plot, tuple(figures.line(plot, each.motion, label) for label, each in found)))
    files = _files(main, shown)
    write(files, options.out)
    summary = _summary(runs, shown, [str(options.out / file.path) for file in files])
    print(json.dumps(summary, indent=2) if options.json else _text(summary))
    return 0


def scene_of(path: Path, duration: float | None) -> Scene:
    """The scene of a file, with another duration (s) if one is given. SpecError if nothing can be simulated."""
    scene = read(path)
    if not isinstance(scene, Scene):
        said = (
            "this is a body alone, and there is no motion in it to simulate; see scenes/crank_slider_3.toml for a scene"
        )
        raise SpecError((Problem("", said),), str(path))
    if scene.simulation is None:
        said = "there is no such table; add it, with `duration` (s) and `output`, the time between rows (s)"
        raise SpecError((Problem("simulation", said),), str(path))
    if duration is None:
        return scene
    if duration > MAX_STEPS * scene.simulation.output:
        said = f"with --duration {duration:g} there would be more than {MAX_STEPS} rows; write `output` less often"
        raise SpecError((Problem("simulation.output", said),), str(path))
    return replace(scene, simulation=replace(scene.simulation, duration=duration))


@dataclass
class Runs:
    """The simulations of one scene, each done once: as it is, and with a rod cut into other numbers of pieces."""

    path: Path
    scene: Scene
    done: dict[tuple[tuple[str, int], ...], Run] = field(default_factory=dict)

    def of(self, cut: str | None, pieces: int) -> Run:
        """The simulation with the rod `cut` in so many pieces, or of the scene as it is."""
        bodies = tuple(
            replace(b, pieces=pieces) if isinstance(b, BeamBody) and b.name == cut else b for b in self.scene.bodies
        )
        key = tuple((b.name, b.pieces) for b in bodies if isinstance(b, BeamBody))
        if key not in self.done:
            assert self.scene.simulation is not None
            said = ", ".join([self.scene.name, *(f"{name} in {beams(n)}" for name, n in key)])
            progress = Progress(said, self.scene.simulation.duration)
            try:
                self.done[key] = simulate(replace(self.scene, bodies=bodies), progress)
            except SpecError as error:
                raise with_lines(error, self.path) from None
            finally:
                progress.end()
        return self.done[key]


class Progress:
    """A line on the terminal that tells how far a simulation is; nothing where stderr is no terminal."""

    def __init__(self, said: str, duration: float) -> None:
        self._said, self._duration, self._next = said, duration, 0.0
        self._show("building ...")

    def __call__(self, reached: float) -> None:
        """The simulation is at this time (s). Told ten times a second."""
        if time.monotonic() >= self._next:
            self._next = time.monotonic() + 0.1
            self._show(f"{min(reached, self._duration):.4g} of {self._duration:g} s")

    def end(self) -> None:
        """Leave no trace."""
        show()

    def _show(self, what: str) -> None:
        show(f"simulating {self._said}: {what}")


def _files(main: Run, shown: Sequence[Shown]) -> list[File]:
    scene = main.scene
    curves = [
        record.Column(figures.said(plot), figures.unit(plot), figures.line(plot, main.motion, "").y)
        for plot, _ in shown
    ]
    return [
        File(f"{scene.name}/{scene.name}.csv", record.csv(f"The motion of {scene.name}.", columns(main))),
        *(File(f"{scene.name}/{p.name}.svg", chart.svg(figures.chart(scene, p, lines))) for p, lines in shown),
        File(f"{scene.name}/{scene.name}.html", player.page(main.motion, curves)),
    ]


def _label(plot: Plot, pieces: int) -> str:
    return beams(pieces) if pieces else f"{plot.quantity.marker.body}.{plot.quantity.marker.marker}"


def _summary(runs: Runs, shown: Sequence[Shown], files: list[str]) -> dict[str, Any]:
    """What is printed, as plain data; times in s, drift in m or rad and their rates, errors over the peak."""
    assert runs.scene.simulation is not None
    return {
        "name": runs.scene.name,
        "duration": runs.scene.simulation.duration,
        "runs": [
            {
                "pieces": dict(key),
                "coordinates": done.motion.native.nq,
                "constraints": done.motion.native.nlambda,
                "steps": done.trajectory.cost.steps,
                "evaluations": done.trajectory.cost.evaluations,
                "cpu_seconds": done.trajectory.cost.seconds,
                "drift": done.trajectory.drift[:, 0].max(),
                "drift_of_rates": done.trajectory.drift[:, 1].max(),
                "deformed_start": done.start.deformed or done.start.deforming,
                "bending": {b.name: rods.bending(done.motion, b) for b in done.scene.bodies if isinstance(b, BeamBody)},
            }
            for key, done in sorted(runs.done.items())
        ],
        "plots": [
            {
                "name": plot.name,
                "quantity": figures.said(plot),
                "over": figures.over(runs.scene, plot),
                "reference": plot.reference.file if plot.reference else None,
                "curves": [
                    {
                        "label": each.label,
                        "least": dict(zip(("value", "at"), each.least, strict=True)),
                        "largest": dict(zip(("value", "at"), each.largest, strict=True)),
                        "error": dict(zip(("rms", "max"), each.error, strict=True)) if each.error else None,
                    }
                    for each in lines
                ],
            }
            for plot, lines in shown
        ],
        "files": files,
    }


def _text(summary: dict[str, Any]) -> str:
    rows = [["", "coordinates", "constraints", "steps", "evaluations", "CPU s", "drift", "of rates"]]
    for each in summary["runs"]:
        name = ", ".join(f"{name} in {beams(n)}" for name, n in each["pieces"].items()) or "all rigid"
        counts = (str(each[key]) for key in ("coordinates", "constraints", "steps", "evaluations"))
        drifts = (f"{each[key]:.1e}" for key in ("drift", "drift_of_rates"))
        rows.append([name, *counts, f"{each['cpu_seconds']:.2f}", *drifts])
    lines = [f"{summary['name']}: {summary['duration']:g} s", *table(rows)]
    lines += ["  drift: the largest violation of a constraint (m or rad), and of its rate (1/s)"]
    lines += _warnings(summary)
    for plot in summary["plots"]:
        rows = [["", "least", "at", "largest", "at", *(["rms error", "max error"] if plot["reference"] else [])]]
        for each in plot["curves"]:
            values = (f"{each[end][key]:.6g}" for end in ("least", "largest") for key in ("value", "at"))
            errors = [f"{figures.percent(each['error'][key])} %" for key in ("rms", "max")] if each["error"] else []
            rows.append([each["label"], *values, *errors])
        lines += ["", f"{plot['name']}: {plot['quantity']}; over {plot['over']}", *table(rows)]
        if any(each["error"] for each in plot["curves"]):
            lines.append(f"  errors: against {plot['reference']}, of its peak")
        elif plot["reference"]:
            lines.append(f"  not compared with {plot['reference']}: they have no part in common")
    return "\n".join([*lines, "", *(f"wrote {file}" for file in summary["files"])])


def _warnings(summary: dict[str, Any]) -> list[str]:
    """Beams that bend further than their equations hold, and starts that are not those of rigid bodies."""
    found = []
    for each in summary["runs"]:
        for name, most in each["bending"].items():
            said = f"  warning: {name} in {beams(each['pieces'][name])} bends by {most:.2g} of the length of a beam;"
            found += [f"{said} the equations hold up to about {rods.TRUSTED:g}"] if most > rods.TRUSTED else []
        if each["deformed_start"]:
            found.append("  warning: no rigid bodies can start so; some are deformed, or deforming, at t = 0")
    return list(dict.fromkeys(found))
