"""`tisserand simulate`: simulate a scene; write its trajectory (CSV), its plots (SVG) and an animation (HTML)."""

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
"""A plot and its curves."""


def run(options: argparse.Namespace) -> int:
    """Simulate the scene as specified and with each number of pieces that a plot requests; then write all files."""
    scene = scene_of(options.spec, options.duration)
    runs = Runs(options.spec, scene)
    main = runs.of(None, 0)
    shown: list[Shown] = []
    for plot in scene.plots:
        variants = [(_label(plot, n), runs.of(plot.cut, n)) for n in plot.pieces or (0,)]
        shown.append((plot, tuple(figures.line(plot, each.motion, label) for label, each in variants)))
    files = _files(main, shown)
    write(files, options.out)
    summary = _summary(runs, shown, [str(options.out / file.path) for file in files])
    print(json.dumps(summary, indent=2) if options.json else _text(summary))
    return 0


def scene_of(path: Path, duration: float | None) -> Scene:
    """Read the scene of a file, with another `duration` (s) if given. Raises SpecError if it cannot be simulated."""
    scene = read(path)
    if not isinstance(scene, Scene):
        message = "a scene is needed, and this is a single body; put it into [bodies], see scenes/spinning_beam.toml"
        raise SpecError((Problem("", message),), str(path))
    if scene.simulation is None:
        message = "this table is missing; add it, with `duration` (s) and `output`, the time between rows (s)"
        raise SpecError((Problem("simulation", message),), str(path))
    if duration is None:
        return scene
    if duration > MAX_STEPS * scene.simulation.output:
        message = f"--duration {duration:g} would give more than {MAX_STEPS} rows; make `output` longer"
        raise SpecError((Problem("simulation.output", message),), str(path))
    return replace(scene, simulation=replace(scene.simulation, duration=duration))


@dataclass
class Runs:
    """The simulations of one scene, each run once: as specified, and with other numbers of pieces of a rod."""

    path: Path
    scene: Scene
    done: dict[tuple[tuple[str, int], ...], Run] = field(default_factory=dict)

    def of(self, cut: str | None, pieces: int) -> Run:
        """Return the simulation with `pieces` pieces of the rod `cut`, or of the scene as specified if that is None."""
        bodies = tuple(
            replace(b, pieces=pieces) if isinstance(b, BeamBody) and b.name == cut else b for b in self.scene.bodies
        )
        key = tuple((b.name, b.pieces) for b in bodies if isinstance(b, BeamBody))
        if key not in self.done:
            assert self.scene.simulation is not None
            title = ", ".join([self.scene.name, *(f"{name} in {beams(n)}" for name, n in key)])
            progress = Progress(title, self.scene.simulation.duration)
            try:
                self.done[key] = simulate(replace(self.scene, bodies=bodies), progress)
            except SpecError as error:
                raise with_lines(error, self.path) from None
            finally:
                progress.end()
        return self.done[key]


class Progress:
    """A line on the terminal with the time that a simulation has reached; it stays silent if stderr is no terminal."""

    def __init__(self, title: str, duration: float) -> None:
        self._title, self._duration, self._next = title, duration, 0.0
        self._show("deriving and compiling ...")

    def __call__(self, reached: float) -> None:
        """Show the time (s) that the simulation has reached, at most ten times a second."""
        if time.monotonic() >= self._next:
            self._next = time.monotonic() + 0.1
            self._show(f"{min(reached, self._duration):.4g} of {self._duration:g} s")

    def end(self) -> None:
        """Remove the line."""
        show()

    def _show(self, text: str) -> None:
        show(f"simulating {self._title}: {text}")


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
    """Return the summary as plain data: times in s, drift in m, rad, m/s and rad/s, errors relative to the peak."""
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
    rows = [["", "coordinates", "constraints", "steps", "evaluations", "CPU s", "drift", "of velocities"]]
    for each in summary["runs"]:
        name = ", ".join(f"{name} in {beams(n)}" for name, n in each["pieces"].items()) or "all rigid"
        counts = (str(each[key]) for key in ("coordinates", "constraints", "steps", "evaluations"))
        drifts = (f"{each[key]:.1e}" for key in ("drift", "drift_of_rates"))
        rows.append([name, *counts, f"{each['cpu_seconds']:.2f}", *drifts])
    lines = [f"{summary['name']}: {summary['duration']:g} s", *table(rows)]
    lines += ["  drift: the largest violation of the constraints (m, rad) and of their time derivatives (m/s, rad/s)"]
    lines += _warnings(summary)
    for plot in summary["plots"]:
        rows = [["", "minimum", "at", "maximum", "at", *(["rms error", "max error"] if plot["reference"] else [])]]
        for each in plot["curves"]:
            values = (f"{each[end][key]:.6g}" for end in ("least", "largest") for key in ("value", "at"))
            errors = [f"{figures.percent(each['error'][key])} %" for key in ("rms", "max")] if each["error"] else []
            rows.append([each["label"], *values, *errors])
        lines += ["", f"{plot['name']}: {plot['quantity']}; over {plot['over']}", *table(rows)]
        if any(each["error"] for each in plot["curves"]):
            lines.append(f"  errors: deviations from {plot['reference']}, relative to its peak")
        elif plot["reference"]:
            lines.append(f"  no errors: the curves and {plot['reference']} do not overlap")
    return "\n".join([*lines, "", *(f"wrote {file}" for file in summary["files"])])


def _warnings(summary: dict[str, Any]) -> list[str]:
    """Warn of beams that bend further than their equations hold, and of initial states with deformed bodies."""
    warnings: list[str] = []
    for each in summary["runs"]:
        for name, most in each["bending"].items():
            if most > rods.TRUSTED:
                beam = f"{name} in {beams(each['pieces'][name])}"
                warnings.append(
                    f"  warning: {beam} bends by {most:.2g} of the length of a beam; first-order equations hold up to "
                    f"about {rods.TRUSTED:g}"
                )
        if each["deformed_start"]:
            warnings.append(
                "  warning: no undeformed state satisfies the constraints; some bodies are deformed at t = 0"
            )
    return list(dict.fromkeys(warnings))
