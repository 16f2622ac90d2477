"""`tisserand study accuracy`: chart the cost of accuracy over a ladder of models of one scene."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from derive.artifacts import BinaryFile, File, check_folder, write
from derive.cli.result_files import planned_files, print_result, study_files
from derive.spec.model.scene import Scene
from derive.study.accuracy.chart import LadderChart, accuracy_svg
from derive.study.accuracy.fixed_steps import fixed_step_lines
from derive.study.accuracy.ladder_run import LadderRun
from derive.study.accuracy.measurement import LADDER_FLAGS, Line, Preparation, preparation, retimed
from derive.study.accuracy.models import LadderRange, ladder
from derive.study.accuracy.peers import read_peers
from derive.study.accuracy.reference import compared_plot, plotted_beams, reference
from derive.study.accuracy.table import accuracy_data, accuracy_html, accuracy_text, run_table
from derive.study.computed_ahead import available_workers
from derive.study.timing import machine_description
from derive.terminal import show_progress, show_result

NAME = "accuracy"
EXPECTED_SIZE = 1_000_000
"""The approximate size of the files of a study, in bytes."""
BETWEEN = 60.0
"""The time (s) between two writings of the part of the ladder that is finished: charts take a second to draw."""
INTERRUPTED = 130
"""The exit code after Ctrl-C."""


def run(scene: Scene, options: argparse.Namespace) -> int:
    """Run the study and write its chart, page, table and data."""
    folder = options.out or Path("results") / scene.name
    check_folder(planned_files(NAME, scene.name, folder), folder, EXPECTED_SIZE)
    chart, interrupted = study(scene, options, lambda part: write(_files(part, accuracy_data(part)), folder))
    show_progress()
    data = accuracy_data(chart)
    files = _files(chart, data)
    write(files, folder)
    print_result(accuracy_text(chart), data, [str(folder / file.path) for file in files], options.json)
    return INTERRUPTED if interrupted else 0


def _files(chart: LadderChart, data: dict[str, Any]) -> list[File | BinaryFile]:
    """Chart, page and table, and the record with all numbers."""
    texts = {"svg": accuracy_svg(chart), "html": accuracy_html(chart), "csv": run_table(chart).csv}
    return study_files(NAME, data, texts)


def study(scene: Scene, options: argparse.Namespace, record: Callable[[LadderChart], None]) -> tuple[LadderChart, bool]:
    """The ladder that the options ask for, and whether Ctrl-C has ended it before the last model.

    record: called now and then with the finished part of the ladder. Raises SpecError, SimulationError, CompilerError.
    """
    plot = compared_plot(scene, options.plot)
    compared = replace(scene, plots=(plot,))
    with preparation(compared, available_workers()) as ahead:
        return _study(compared, options, record, ahead)


def _study(
    scene: Scene, options: argparse.Namespace, record: Callable[[LadderChart], None], ahead: Preparation
) -> tuple[LadderChart, bool]:
    """The study of a scene with the compared plot alone, whose models are prepared ahead."""
    (plot,) = scene.plots
    peers = read_peers(options.peers) if options.peers else ()
    error, own = options.reference_error, options.own_reference
    known = reference(scene, plot, error, own, show_progress, show_result, ahead)
    limits = LadderRange(options.orders, options.frames, options.shapes, options.pieces, options.sines, options.modes)
    models = ladder(limits)
    shown = plotted_beams(plot, scene)
    runs = LadderRun(scene, known, options.tolerances, explicit=not options.integrators, ahead=ahead)
    machine, last = _machine(), time.monotonic()

    def chart(lines: Sequence[Line], *notes: str) -> LadderChart:
        return LadderChart(scene.name, tuple(lines), known, options.error, machine, peers, shown, (*runs.notes, *notes))

    def recorded() -> None:
        nonlocal last
        if time.monotonic() - last > BETWEEN:
            record(chart(runs.lines, "unfinished: more models are being run"))
            last = time.monotonic()

    try:
        runs.run(models, show_progress, show_result, recorded)
        ahead.close()
        lines = retimed(runs.lines, runs.ready, options.runs, show_progress)
        others = fixed_step_lines(
            list(runs.ready.values()), options.integrators, known.plots, options.runs, show_progress
        )
    except KeyboardInterrupt:
        if not any(line.points for line in runs.lines):
            raise
        missing = len(models) - runs.count
        return chart(runs.lines, f"interrupted: {missing} models were not run" if missing > 0 else "interrupted"), True
    warnings = {line.model: line.warning for line in lines}
    return chart([*lines, *(replace(line, warning=warnings[line.model]) for line in others)]), False


def _machine() -> str:
    """The processor, the compiler and its flags in a line."""
    known = machine_description(LADDER_FLAGS)
    return f"{known['machine']}; {known['compiler']}, {known['flags']}"
