"""`tisserand simulate`: simulate a scene or a body; write its trajectory (CSV), plots (SVG), an animation (HTML)."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from derive.artifacts import File, check_folder, write
from derive.cli.field_files import SERIES, expected_field_size, field_files, planned_fields
from derive.cli.result_files import drawing, motion_page_path, picture_names
from derive.cli.simulation_summary import (
    Pieces,
    Plain,
    PlotCurves,
    SimulationResult,
    pieces_text,
    summary_data,
    summary_text,
)
from derive.cli.specifications import in_file_order, read_changed, simulation_of
from derive.errors import SpecError
from derive.progress_line import show_progress
from derive.simulation.earlier_run import EarlierRun, read_run
from derive.simulation.observables.csv_writer import NUMBER_WIDTH, Column
from derive.simulation.observables.fields import field_bodies
from derive.simulation.observables.plots import plot_curves, plot_text
from derive.simulation.output_times import output_times
from derive.simulation.prepared_run import PreparedRun
from derive.simulation.run_record import DRIFT_COLUMNS, run_files
from derive.simulation.trajectory import Trajectory
from derive.spec.model.body import NodalBody
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.plots import Deflection
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.specification import AnyScene
from derive.spec.set_values import SetValue
from derive.spec.toml.read import with_lines
from derive.terminal import SimulationProgress, beam_count
from derive.visual.line_chart import svg
from derive.visual.motion_page import motion_page
from derive.visual.plot_chart import plot_chart


def run(options: argparse.Namespace) -> int:
    """Simulate a scene or a single body, write all files and print the summary."""
    summary = simulated_files(options)
    print(json.dumps(summary, indent=2) if options.json else summary_text(summary))
    return 0


def simulated_files(options: argparse.Namespace) -> Plain:
    """Simulate a scene or a single body, then write all files; the summary.

    Errors in the specification, its plots and its files are reported before the first run.
    """
    given, changes = read_changed(options.spec, options.set)
    spec = simulation_of(given, options.spec, options.duration, options.output, options.tolerance, options.until)
    simulations = Simulations(spec, options)
    check_folder(simulations.planned_files(), options.out, simulations.expected_size())
    earlier = read_run(options.out, simulations.main.spec) if options.resume else None
    result = simulations.result(earlier, changes)
    with drawing(spec.name):
        files = _files(result.main, result.plots)
        fields = field_files(result.main, simulations.field_bodies, options.instants)
        write([*files, *fields], options.out)
    shown = [*files, *(file for file in fields if file.path.endswith(SERIES))]
    return summary_data(options.spec, result, [str(options.out / file.path) for file in shown])


@dataclass(frozen=True)
class TitledRun:
    """A simulation of the specification in the file `path`, with a title for its progress."""

    path: Path
    title: str
    run: PreparedRun

    def trajectory(self, earlier: EarlierRun | None) -> Trajectory:
        """Run the simulation with a line of progress, and return its motion."""
        progress = SimulationProgress(self.title, self.run.settings.simulation.duration)
        try:
            with lines_of(self.path):
                return self.run.trajectory(earlier, progress, self._announce)
        finally:
            progress.end()

    def _announce(self, text: str) -> None:
        """Print a prediction about the run, which may take long or stop early, before it begins."""
        show_progress()
        print(f"{self.title}: note: {text}", file=sys.stderr)


@contextmanager
def lines_of(path: Path) -> Iterator[None]:
    """Add the lines of the file to the faults of a SpecError that is raised in this context."""
    try:
        yield
    except SpecError as error:
        raise with_lines(error, path) from None


class Simulations:
    """The simulations of one specification: as it stands, and with the numbers of pieces of a beam that plots request.

    All are prepared before the first one runs. Raises SpecError.
    """

    def __init__(self, spec: AnyScene | NodalBody, options: argparse.Namespace) -> None:
        self._spec, self._options = spec, options
        with lines_of(options.spec):
            self.field_bodies = field_bodies(spec, options.fields or ())
        self._variants = {_pieces(spec): self._prepared(spec)}
        self.main = self._variants[_pieces(spec)].run
        self.plots = in_file_order(self.main.plots, options.spec)
        for plot in self.plots:
            for pieces in plot.pieces:
                scene = _divided(spec, plot.cut, pieces)
                if _pieces(scene) not in self._variants:
                    self._variants[_pieces(scene)] = self._prepared(scene)

    def _prepared(self, spec: AnyScene | NodalBody) -> TitledRun:
        title = ", ".join([spec.name, *pieces_text(_pieces(spec))])
        show_progress(f"{title}: deriving the equations ...")
        try:
            with lines_of(self._options.spec):
                run = PreparedRun(spec, self._options.integrator, self._options.step, complete=False)
        finally:
            show_progress()
        return TitledRun(self._options.spec, title, run)

    def planned_files(self) -> list[File]:
        """The files of the simulations, still without their texts."""
        name = self._spec.name
        record, pictures = f"{name}/{name}.json", picture_names(self.plots).values()
        others = (record, motion_page_path(name), *(f"{name}/{picture}" for picture in pictures))
        fields = planned_fields(name, self.field_bodies, self._rows, self._options.instants)
        return [File(f"{name}/{name}.csv", "", record=record), *(File(path, "") for path in (*others, *fields))]

    @property
    def _rows(self) -> int:
        return len(output_times(self.main.settings.simulation))

    def expected_size(self) -> int:
        """The approximate size of all files, in bytes: the CSV, with the drift in the record, fields, and 1 MB."""
        columns = len(self.main.units) + DRIFT_COLUMNS
        fields = expected_field_size(self.field_bodies, self._rows, self._options.instants)
        return NUMBER_WIDTH * columns * self._rows + fields + 1_000_000

    def result(self, earlier: EarlierRun | None, changes: Sequence[SetValue]) -> SimulationResult:
        """Run all simulations, each once; the first one continues an earlier run, if there is one.

        changes: the values that have been set.
        """
        done = {
            pieces: variant.trajectory(earlier if variant.run is self.main else None)
            for pieces, variant in self._variants.items()
        }
        main = done[_pieces(self._spec)]
        shown: list[PlotCurves] = []
        for plot in self.plots:
            if plot.pieces:
                variants = [(beam_count(n), done[_pieces(_divided(self._spec, plot.cut, n))]) for n in plot.pieces]
            else:
                label = str(plot.quantity.marker) if isinstance(plot.quantity, Deflection) else ""
                variants = [(label, main)]
            shown.append((plot, tuple(curve for label, each in variants for curve in plot_curves(plot, each, label))))
        return SimulationResult(main, done, tuple(shown), tuple(changes))


def _pieces(spec: AnyScene | NodalBody) -> Pieces:
    bodies = getattr(spec, "bodies", ())  # none of a body alone
    return tuple((b.name, b.pieces) for b in bodies if isinstance(b, (BeamBody, SpatialBeam)))


def _divided(spec: AnyScene | NodalBody, cut: str | None, pieces: int) -> AnyScene:
    """The scene with the beam `cut` divided into `pieces` pieces."""
    changed: Any = spec
    bodies: Any = (replace(b, pieces=pieces) if b.name == cut else b for b in changed.bodies)
    result: AnyScene = replace(changed, bodies=tuple(bodies))
    return result


def _files(main: Trajectory, shown: Sequence[PlotCurves]) -> list[File]:
    texts = [(plot, plot_text(plot, main.scene, main.units), curves) for plot, curves in shown]
    columns = [
        Column(curve.label or text.doc, curve.unit, curve.y)
        for plot, text, _ in texts
        for curve in plot_curves(plot, main, "")
    ]
    pictures = picture_names([plot for plot, _ in shown])
    return [
        *run_files(main),
        *(
            File(f"{main.name}/{pictures[plot.name]}", svg(plot_chart(main.name, plot, text, curves)))
            for plot, text, curves in texts
        ),
        File(motion_page_path(main.name), motion_page(main, columns, main.warnings).text),
    ]
