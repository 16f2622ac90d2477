"""`tisserand simulate` of a single body in space: trajectory, plots of coordinates, and a three-dimensional player."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from derive.artifacts import File, check_folder, write
from derive.errors import SpecError
from derive.roles import Role
from derive.simulation.body_trajectory import BodyTrajectory
from derive.simulation.earlier_run import read_run
from derive.simulation.observables.csv_writer import NUMBER_WIDTH
from derive.simulation.observables.plots import column_curves, column_text
from derive.simulation.observables.spatial_player_data import spatial_player_data
from derive.simulation.output_times import output_times
from derive.simulation.run_record import run_files
from derive.simulation.simulate import simulate
from derive.spec.model.body import NodalBody
from derive.spec.model.scene import ColumnCurves, Plot
from derive.spec.set_values import SetValue
from derive.spec.toml.read import with_lines
from derive.terminal import SimulationProgress, table
from derive.visual.line_chart import svg
from derive.visual.player import spatial_player_page
from derive.visual.plot_chart import plot_chart

PLOTS = ("position", "rotation", "angular_velocity", "amplitudes", "energy")
"""The names of the plots of a body; there is none of amplitudes if it has no modes."""
MAX_AMPLITUDES = 6
"""The amplitudes that are plotted: as many as a picture has styles."""


def simulated_body(body: NodalBody, changes: Sequence[SetValue], options: argparse.Namespace) -> dict[str, Any]:
    """Simulate the body, write all files, and return the summary. That they can be written is checked before."""
    assert body.simulation is not None
    name, rows = body.name, len(output_times(body.simulation))
    record = f"{name}/{name}.json"
    paths = [record, f"{name}/{name}.html", *(f"{name}/{plot}.svg" for plot in PLOTS)]
    planned = [File(f"{name}/{name}.csv", "", record=record), *(File(path, "") for path in paths)]
    columns = 16 + 2 * (body.modes or 0)
    check_folder(planned, options.out, NUMBER_WIDTH * columns * rows + 1_000_000)
    earlier = read_run(options.out, body) if options.resume else None
    progress = SimulationProgress(name, body.simulation.duration)
    try:
        trajectory = simulate(
            body, integrator=options.integrator, step=options.step, earlier=earlier, progress=progress
        )
    except SpecError as error:
        raise with_lines(error, options.spec) from None
    finally:
        progress.end()
    plots = body_plots(trajectory)
    files = [
        *run_files(trajectory),
        *(File(f"{name}/{plot.name}.svg", _picture(trajectory, plot, curves)) for plot, curves in plots),
        File(f"{name}/{name}.html", spatial_player_page(spatial_player_data(trajectory))),
    ]
    write(files, options.out)
    return _summary(trajectory, changes, [str(options.out / file.path) for file in files])


def body_plots(trajectory: BodyTrajectory) -> list[tuple[Plot, ColumnCurves]]:
    """The plots of a body: what describes its motion, over the time."""
    variables = trajectory.model.coordinates
    names = {role: [x.name for x in variables if x.role is role] for role in Role}
    energies = [column.name for column in trajectory.table[-trajectory.energies.shape[1] :]]
    quantities = (
        names[Role.TRANSLATION],
        names[Role.QUATERNION],
        [x.name for x in trajectory.model.velocities[3:6]],
        names[Role.AMPLITUDE][:MAX_AMPLITUDES],
        energies,
    )
    curves = [(name, ColumnCurves(tuple(columns))) for name, columns in zip(PLOTS, quantities, strict=True) if columns]
    return [(Plot(name, quantity), quantity) for name, quantity in curves]


def _picture(trajectory: BodyTrajectory, plot: Plot, quantity: ColumnCurves) -> str:
    curves = column_curves(plot, quantity, trajectory, "")
    return svg(plot_chart(trajectory.name, plot, column_text(quantity, trajectory.units), curves))


def _summary(trajectory: BodyTrajectory, changes: Sequence[SetValue], files: list[str]) -> dict[str, Any]:
    """Return the summary as plain data: times in s, energies in J."""
    total = trajectory.energies.sum(axis=1)
    cost = trajectory.solution.cost
    return {
        "name": trajectory.name,
        "duration": trajectory.settings.simulation.duration,
        "set": [asdict(change) for change in changes],
        "coordinates": trajectory.native.nq,
        "steps": cost.steps,
        "evaluations": cost.evaluations,
        "cpu_seconds": cost.seconds,
        "energy": total[0],
        "energy_change": total[-1] - total[0],
        "notes": trajectory.solution.notes,
        "files": files,
    }


def body_text(summary: dict[str, Any]) -> str:
    """The summary as text."""
    counts = [str(summary[key]) for key in ("coordinates", "steps", "evaluations")]
    energies = [f"{summary['energy']:.9g}", f"{summary['energy_change']:.1e}"]
    head = ["coordinates", "steps", "evaluations", "CPU s", "energy, J", "its change"]
    lines = [f"set {SetValue(**change)}" for change in summary["set"]]
    lines += [f"{summary['name']}: {summary['duration']:g} s"]
    lines += table([head, [*counts, f"{summary['cpu_seconds']:.2f}", *energies]], left=0)
    lines += [f"  note: {note}" for note in summary["notes"]]
    return "\n".join([*lines, "", *(f"wrote {file}" for file in summary["files"])])
