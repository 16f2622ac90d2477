"""`tisserand simulate`: simulate a scene; write its trajectory (CSV), its plots (SVG) and an animation (HTML)."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from derive.artifacts import File, check_folder, write
from derive.cli.simulate_body import body_text, simulated_body
from derive.cli.specifications import read_changed, simulated
from derive.errors import SpecError
from derive.lowering.conditioning import condition_warnings
from derive.simulation.earlier_run import EarlierRun, read_run
from derive.simulation.observables.beams import LINEAR_LIMIT, beam_bodies, relative_deflection
from derive.simulation.observables.csv_writer import NUMBER_WIDTH, Column
from derive.simulation.observables.default_plots import default_plot_names, default_plots
from derive.simulation.observables.player_data import player_data
from derive.simulation.observables.plots import PlotCurve, percent, plot_curves, plot_text, with_unit
from derive.simulation.output_times import output_times
from derive.simulation.run_record import run_files
from derive.simulation.simulate import simulate
from derive.simulation.trajectory import Trajectory
from derive.spec.model.scene import BeamBody, Deflection, Plot, Scene
from derive.spec.set_values import SetValue
from derive.spec.toml.read import warnings, with_lines
from derive.terminal import SimulationProgress, beam_count, table
from derive.visual.line_chart import svg
from derive.visual.player import player_page
from derive.visual.plot_chart import plot_chart

PlotCurves = tuple[Plot, tuple[PlotCurve, ...]]
"""A plot and its curves."""


def run(options: argparse.Namespace) -> int:
    """Simulate a scene or a single body; then write all files. That they can be written is checked before."""
    given, changes = read_changed(options.spec, options.set)
    spec = simulated(given, options.spec, options.duration, options.output, options.tolerance, options.until)
    summary = _scene(spec, changes, options) if isinstance(spec, Scene) else simulated_body(spec, changes, options)
    if options.json:
        print(json.dumps(summary, indent=2))
    else:
        print(_text(summary) if isinstance(spec, Scene) else body_text(summary))
    return 0


def _scene(scene: Scene, changes: Sequence[SetValue], options: argparse.Namespace) -> dict[str, Any]:
    """Simulate the scene as specified and with each number of pieces that a plot requests; return the summary."""
    check_folder(_planned_files(scene), options.out, _expected_size(scene))
    earlier = read_run(options.out, scene) if options.resume else None
    simulations = Simulations(options.spec, scene, options.integrator, options.step, earlier)
    main = simulations.trajectory(None, 0)
    shown: list[PlotCurves] = []
    for plot in (*scene.plots, *default_plots(main)):
        variants = [(_label(plot, n), simulations.trajectory(plot.cut, n)) for n in plot.pieces or (0,)]
        shown.append((plot, tuple(curve for label, each in variants for curve in plot_curves(plot, each, label))))
    files = _files(main, shown)
    write(files, options.out)
    return _summary(simulations, main, changes, shown, [str(options.out / file.path) for file in files])


@dataclass
class Simulations:
    """The simulations of one scene, each run once: as specified, and with other numbers of pieces of a beam.

    earlier: the run that the first one continues; the others, of which there are no rows, begin at t = 0.
    """

    path: Path
    scene: Scene
    integrator: str
    step: float | None
    earlier: EarlierRun | None
    done: dict[tuple[tuple[str, int], ...], Trajectory] = field(default_factory=dict)

    def trajectory(self, cut: str | None, pieces: int) -> Trajectory:
        """Return the simulation with `pieces` pieces of the beam `cut`, or of the scene as specified if it is None."""
        bodies = tuple(
            replace(b, pieces=pieces) if isinstance(b, BeamBody) and b.name == cut else b for b in self.scene.bodies
        )
        key = tuple((b.name, b.pieces) for b in bodies if isinstance(b, BeamBody))
        if key not in self.done:
            assert self.scene.simulation is not None
            title = ", ".join([self.scene.name, *(f"{name} in {beam_count(n)}" for name, n in key)])
            progress = SimulationProgress(title, self.scene.simulation.duration)
            try:
                scene = replace(self.scene, bodies=bodies)
                earlier = self.earlier if scene == self.scene else None
                self.done[key] = simulate(
                    scene, integrator=self.integrator, step=self.step, earlier=earlier, progress=progress
                )
            except SpecError as error:
                raise with_lines(error, self.path) from None
            finally:
                progress.end()
        return self.done[key]


def _planned_files(scene: Scene) -> list[File]:
    """The files of a simulation, still without their texts."""
    name = scene.name
    plots = (*(plot.name for plot in scene.plots), *default_plot_names(scene))
    pictures = [f"{name}/{plot}.svg" for plot in plots]
    record = f"{name}/{name}.json"
    return [
        File(f"{name}/{name}.csv", "", record=record),
        *(File(path, "") for path in (record, f"{name}/{name}.html", *pictures)),
    ]


def _expected_size(scene: Scene) -> int:
    """About the size of all files, in bytes: that of the CSV, with two columns for each coordinate, and 1 MB."""
    assert scene.simulation is not None
    coordinates = sum((3 + len(b.beam.ansatz)) * b.pieces if isinstance(b, BeamBody) else 3 for b in scene.bodies)
    columns = 1 + 2 * coordinates + len(scene.drives) + 3 * len(scene.joints)
    return NUMBER_WIDTH * columns * len(output_times(scene.simulation)) + 1_000_000


def _files(main: Trajectory, shown: Sequence[PlotCurves]) -> list[File]:
    scene = main.scene
    columns = [
        Column(
            curve.label or plot_text(plot, main.scene, main.units).doc,
            plot_text(plot, main.scene, main.units).y_unit,
            curve.y,
        )
        for plot, _ in shown
        for curve in plot_curves(plot, main, "")
    ]
    return [
        *run_files(main),
        *(
            File(f"{scene.name}/{p.name}.svg", svg(plot_chart(scene.name, p, plot_text(p, scene, main.units), curves)))
            for p, curves in shown
        ),
        File(f"{scene.name}/{scene.name}.html", player_page(player_data(main.motion, columns))),
    ]


def _label(plot: Plot, pieces: int) -> str:
    if pieces:
        return beam_count(pieces)
    return str(plot.quantity.marker) if isinstance(plot.quantity, Deflection) else ""


def _summary(
    simulations: Simulations,
    main: Trajectory,
    changes: Sequence[SetValue],
    shown: Sequence[PlotCurves],
    files: list[str],
) -> dict[str, Any]:
    """Return the summary as plain data: times in s, drift in m, rad, m/s and rad/s, errors relative to the peak."""
    assert simulations.scene.simulation is not None
    return {
        "name": simulations.scene.name,
        "warnings": [
            *warnings(simulations.path, [change.key for change in changes]),
            *condition_warnings(simulations.scene),
        ],
        "duration": simulations.scene.simulation.duration,
        "set": [asdict(change) for change in changes],
        "runs": [
            {
                "pieces": dict(key),
                "coordinates": done.motion.native.nq,
                "constraints": done.motion.native.nlambda,
                "steps": done.solution.cost.steps,
                "evaluations": done.solution.cost.evaluations,
                "cpu_seconds": done.solution.cost.seconds,
                "notes": (*done.initial.notes, *done.solution.notes),
                "initial_values": [asdict(value) for value in done.initial.values],
                "drift": done.solution.drift[:, 0].max(),
                "drift_of_rates": done.solution.drift[:, 1].max(),
                "deformed_start": done.initial.deformed or done.initial.deforming,
                "bending": {b.name: relative_deflection(done.motion, b) for b in beam_bodies(done.scene)},
            }
            for key, done in sorted(simulations.done.items())
        ],
        "plots": [
            {
                "name": plot.name,
                "quantity": (text := plot_text(plot, main.scene, main.units)).doc,
                "over": with_unit(text.x_label, text.x_unit),
                "reference": plot.reference.file if plot.reference else None,
                "curves": [
                    {
                        "label": each.label,
                        "least": dict(zip(("value", "at"), each.least, strict=True)),
                        "largest": dict(zip(("value", "at"), each.largest, strict=True)),
                        "error": dict(zip(("rms", "max"), each.error, strict=True)) if each.error else None,
                    }
                    for each in curves
                ],
            }
            for plot, curves in shown
        ],
        "files": files,
    }


def _text(summary: dict[str, Any]) -> str:
    rows = [["", "coordinates", "constraints", "steps", "evaluations", "CPU s", "drift", "of velocities"]]
    for each in summary["runs"]:
        name = ", ".join(f"{name} in {beam_count(n)}" for name, n in each["pieces"].items()) or "all rigid"
        counts = (str(each[key]) for key in ("coordinates", "constraints", "steps", "evaluations"))
        drifts = (f"{each[key]:.1e}" for key in ("drift", "drift_of_rates"))
        rows.append([name, *counts, f"{each['cpu_seconds']:.2f}", *drifts])
    lines = [f"set {SetValue(**change)}" for change in summary["set"]]
    lines += [f"{summary['name']}: {summary['duration']:g} s", *table(rows)]
    lines += ["  drift: the largest violation of the constraints (m, rad) and of their time derivatives (m/s, rad/s)"]
    lines += _warnings(summary)
    for plot in summary["plots"]:
        rows = [["", "minimum", "at", "maximum", "at", *(["rms error", "max error"] if plot["reference"] else [])]]
        for each in plot["curves"]:
            values = (f"{each[end][key]:.6g}" for end in ("least", "largest") for key in ("value", "at"))
            errors = [f"{percent(each['error'][key])} %" for key in ("rms", "max")] if each["error"] else []
            rows.append([each["label"], *values, *errors])
        lines += ["", f"{plot['name']}: {plot['quantity']}; over {plot['over']}", *table(rows)]
        if any(each["error"] for each in plot["curves"]):
            lines.append(f"  errors: deviations from {plot['reference']}, relative to its peak")
        elif plot["reference"]:
            lines.append(f"  no errors: the curves and {plot['reference']} do not overlap")
    return "\n".join([*lines, "", *(f"wrote {file}" for file in summary["files"])])


def _warnings(summary: dict[str, Any]) -> list[str]:
    """Warn of what the specification leaves unnoticed, of beams that bend further than their equations hold, and of
    initial states with deformed bodies.
    """
    lines = [f"  warning: {text}" for text in summary["warnings"]]
    for each in summary["runs"]:
        lines += [f"  note: {note}" for note in each["notes"]]
        for name, most in each["bending"].items():
            if most > LINEAR_LIMIT:
                beam = f"{name} in {beam_count(each['pieces'][name])}"
                lines.append(
                    f"  warning: {beam} bends by {most:.2g} of the length of a beam; first-order equations hold up to "
                    f"about {LINEAR_LIMIT:g}"
                )
        if each["deformed_start"]:
            lines.append("  warning: no undeformed state satisfies the constraints; some bodies are deformed at t = 0")
    return list(dict.fromkeys(lines))
