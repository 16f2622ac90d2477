"""`tisserand study accuracy`: chart what accuracy costs, over a ladder of models of one scene."""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path

from derive.artifacts import MARK, File, check_folder, sha256, write
from derive.spec.model.scene import Scene
from derive.study.accuracy.chart import LadderChart, accuracy_svg
from derive.study.accuracy.fixed_steps import fixed_step_lines
from derive.study.accuracy.measurement import Line, compile_all, measure
from derive.study.accuracy.models import LadderModel, LadderRange, ladder
from derive.study.accuracy.page import accuracy_html
from derive.study.accuracy.peers import read_peers
from derive.study.accuracy.plotted_beams import plotted_beams
from derive.study.accuracy.reference import compared_plot, reference
from derive.study.accuracy.table import accuracy_csv, accuracy_data, accuracy_text
from derive.study.timing import machine_description
from derive.terminal import show_progress
from derive.version import VERSION

NAME = "accuracy"
EXPECTED_SIZE = 1_000_000
"""About what the files of a study need, in bytes."""


def run(scene: Scene, options: argparse.Namespace) -> int:
    """Run the study and write its chart, page, table and data."""
    folder = options.out or Path("results") / scene.name
    record = f"{NAME}.json"
    planned = [File(f"{NAME}.{kind}", "") for kind in ("svg", "html")]
    check_folder([*planned, File(f"{NAME}.csv", "", record=record), File(record, "")], folder, EXPECTED_SIZE)
    chart = study(scene, options)
    show_progress()
    data = accuracy_data(chart)
    files = _files(chart, data)
    write(files, folder)
    written = [str(folder / file.path) for file in files]
    if options.json:
        print(json.dumps({**data, "files": written}, indent=2))
    else:
        print("\n".join([accuracy_text(chart), "", *(f"wrote {name}" for name in written)]))
    return 0


def _files(chart: LadderChart, data: dict[str, object]) -> tuple[File, ...]:
    """Chart, page and table, and the record with all numbers, which vouches for the table."""
    table = accuracy_csv(chart)
    record = {"generator": f"{MARK} {VERSION}. Do not edit.", **data, "files": {f"{NAME}.csv": sha256(table.encode())}}
    return (
        File(f"{NAME}.svg", accuracy_svg(chart)),
        File(f"{NAME}.html", accuracy_html(chart)),
        File(f"{NAME}.csv", table, record=f"{NAME}.json"),
        File(f"{NAME}.json", json.dumps(record, indent=2) + "\n"),
    )


def study(scene: Scene, options: argparse.Namespace) -> LadderChart:
    """The ladder that the options ask for. Raises SpecError, SimulationError, CompilerError."""
    plot = compared_plot(scene, options.plot)
    peers = read_peers(options.peers) if options.peers else ()
    known = reference(scene, plot, options.reference_error, options.own_reference, show_progress)
    limits = LadderRange(options.orders, options.frames, options.shapes, options.pieces, options.sines, options.modes)
    models = ladder(limits)
    ready, failed = compile_all(scene, models, show_progress)
    measured = {
        line.model: line for line in measure(ready, known.plots, options.tolerances, options.runs, show_progress)
    }
    lines = [measured.get(model) or _failed(model, failed[model]) for model in models]
    others = fixed_step_lines(ready, options.integrators, known.plots, options.runs, show_progress)
    lines += [replace(line, warning=measured[line.model].warning) for line in others]
    shown = plotted_beams(plot, scene)
    return LadderChart(scene.name, tuple(lines), known, options.error, _machine(), peers, shown)


def _failed(model: LadderModel, reason: str) -> Line:
    return Line(model, 0, (), failure=reason)


def _machine() -> str:
    """The processor, the compiler and its flags in a line."""
    known = machine_description()
    return f"{known['machine']}; {known['compiler']}, {known['flags']}"
