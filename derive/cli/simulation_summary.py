"""The summary that `tisserand simulate` prints of its runs: as plain data, and as text."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from derive.notes.conditioning import condition_warnings
from derive.percentages import percent
from derive.simulation.observables.plots import PlotCurve, plot_text, with_unit
from derive.simulation.trajectory import Trajectory
from derive.spec.model.plots import Plot
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.set_values import SetValue
from derive.spec.toml.read import warnings
from derive.terminal import beam_count, table

Pieces = tuple[tuple[str, int], ...]
"""The names of the beams of a scene, each with the number of pieces into which it is divided."""

NAMED_BEAMS = 8
"""The largest number of beams that are named in the line of a run."""

PlotCurves = tuple[Plot, tuple[PlotCurve, ...]]
"""A plot and its curves."""

Plain = dict[str, Any]


@dataclass(frozen=True, eq=False)
class SimulationResult:
    """The simulation of a specification (main), all simulations that were run, the plots, and the values set."""

    main: Trajectory
    runs: Mapping[Pieces, Trajectory]
    plots: tuple[PlotCurves, ...]
    changes: tuple[SetValue, ...]


def summary_data(path: Path, result: SimulationResult, files: Sequence[str]) -> Plain:
    """The summary as plain data: times in s, energies in J, drift in m, rad, m/s, rad/s; errors relative to the peak.

    path: the specification. files: the names of those that are written.
    """
    main = result.main
    return {
        "name": main.name,
        "warnings": [*warnings(path, [change.key for change in result.changes]), *condition_warnings(main.spec)],
        "duration": main.settings.simulation.duration,
        "set": [asdict(change) for change in result.changes],
        "runs": [_run(pieces, result.runs[pieces]) for pieces in sorted(result.runs)],
        "plots": [_plot(main, plot, curves) for plot, curves in result.plots],
        "files": [*files],
    }


def _run(pieces: Pieces, trajectory: Trajectory) -> Plain:
    solution = trajectory.solution
    return {
        "pieces": dict(pieces),
        "finite_elements": [] if trajectory.body else _flexible_in_space(trajectory),
        "coordinates": len(trajectory.model.coordinates),
        "constraints": len(trajectory.model.multipliers),
        "steps": solution.cost.steps,
        "evaluations": solution.cost.evaluations,
        "cpu_seconds": solution.cost.seconds,
        "notes": trajectory.notes,
        **(_of_body(trajectory) if trajectory.body else _of_scene(trajectory)),
    }


def _flexible_in_space(trajectory: Trajectory) -> list[str]:
    """The names of the finite-element bodies of a scene in space."""
    return [body.name for body in trajectory.scene.bodies if isinstance(body, FlexibleBody)]


def _of_body(trajectory: Trajectory) -> Plain:
    energy = trajectory.energies.sum(axis=1)
    return {"energy": energy[0], "energy_change": energy[-1] - energy[0]}


def _of_scene(trajectory: Trajectory) -> Plain:
    initial, solution = trajectory.initial, trajectory.solution
    return {
        "initial_values": [asdict(value) for value in initial.values],
        "drift": solution.drift[:, 0].max(),
        "drift_of_rates": solution.drift[:, 1].max(),
        "deformed_start": initial.deformed or initial.deforming,
        "validity": [monitor.data for monitor in trajectory.validity],
        "warnings": trajectory.warnings,
    }


def _plot(main: Trajectory, plot: Plot, curves: Sequence[PlotCurve]) -> Plain:
    text = plot_text(plot, main.scene, main.units)
    return {
        "name": plot.name,
        "quantity": text.doc,
        "over": with_unit(text.x_label, text.x_unit),
        "reference": plot.reference.file if plot.reference else None,
        "curves": [
            {
                "label": curve.label,
                "unit": curve.unit,
                "least": dict(zip(("value", "at"), curve.least, strict=True)),
                "largest": dict(zip(("value", "at"), curve.largest, strict=True)),
                "error": dict(zip(("rms", "max"), curve.error, strict=True)) if curve.error else None,
            }
            for curve in curves
        ],
    }


def summary_text(summary: Plain) -> str:
    """The summary as text."""
    lines = [f"set {SetValue(**change)}" for change in summary["set"]]
    lines += [f"{summary['name']}: {summary['duration']:g} s", *_runs(summary["runs"])]
    lines += dict.fromkeys([f"  warning: {text}" for text in summary["warnings"]] + [*_notes(summary["runs"])])
    for plot in summary["plots"]:
        lines += ["", f"{plot['name']}: {plot['quantity']}; over {plot['over']}", *_extremes(plot)]
    return "\n".join([*lines, "", *(f"wrote {file}" for file in summary["files"])])


def _runs(runs: Sequence[Plain]) -> list[str]:
    """The table of the runs, each with its cost, and with its drift or, of a body in space, its energy."""
    body = "energy" in runs[0]
    head = ["energy, J", "change, J"] if body else ["drift", "velocity drift"]
    rows = [["", "coordinates", "constraints", "steps", "evaluations", "CPU s", *head]]
    for run in runs:
        name = ", ".join([*pieces_text(tuple(run["pieces"].items())), *finite_elements_text(run["finite_elements"])])
        counts = (str(run[key]) for key in ("coordinates", "constraints", "steps", "evaluations"))
        if body:
            quality = [f"{run['energy']:.9g}", f"{run['energy_change']:.1e}"]
        else:
            quality = [f"{run[key]:.1e}" for key in ("drift", "drift_of_rates")]
        rows.append([name or ("" if body else "all rigid"), *counts, f"{run['cpu_seconds']:.2f}", *quality])
    drift = (
        "  drift: largest violation of the constraints (m, rad); velocity drift: of their time derivatives (m/s, rad/s)"
    )
    return [*table(rows), *([] if body else [drift])]


def finite_elements_text(names: Sequence[str]) -> list[str]:
    """The finite-element bodies of a run; of many, how many there are."""
    return [f"{name} flexible" for name in names] if len(names) <= NAMED_BEAMS else [f"{len(names)} flexible bodies"]


def pieces_text(pieces: Pieces) -> list[str]:
    """The beams with the numbers of their pieces; of many beams, how many there are of each number."""
    if len(pieces) <= NAMED_BEAMS:
        return [f"{name} in {beam_count(n)}" for name, n in pieces]
    return [f"{bodies} bodies of {beam_count(n)} each" for n, bodies in Counter(n for _, n in pieces).items()]


def _extremes(plot: Plain) -> Iterator[str]:
    """The table of the curves of a plot, with their errors if there is a reference."""
    rows = [["", "minimum", "at", "maximum", "at", *(["rms error", "max error"] if plot["reference"] else [])]]
    for curve in plot["curves"]:
        values = (f"{curve[end][key]:.6g}" for end in ("least", "largest") for key in ("value", "at"))
        errors = [percent(curve["error"][key]) for key in ("rms", "max")] if curve["error"] else []
        rows.append([with_unit(curve["label"], curve["unit"]), *values, *errors])
    yield from table(rows)
    if any(curve["error"] for curve in plot["curves"]):
        yield f"  errors: deviations from {plot['reference']}, relative to its peak"
    elif plot["reference"]:
        yield f"  no errors: the curves and {plot['reference']} do not overlap"


def _notes(runs: Sequence[Plain]) -> Iterator[str]:
    """The notes of the runs; warnings of models that are not valid, and of initial states with deformed bodies."""
    for run in runs:
        yield from (f"  note: {note}" for note in run["notes"])
        yield from (f"  warning: {text}" for text in run.get("warnings", ()))
        if run.get("deformed_start"):
            yield "  warning: no undeformed state satisfies the constraints; some bodies are deformed at t = 0"
