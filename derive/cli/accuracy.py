"""`tisserand study accuracy`: chart the cost of accuracy over a ladder of models of one scene."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from derive.artifacts import BinaryFile, File, check_folder, write
from derive.cli.arguments.keywords import keywords
from derive.cli.result_files import drawing, planned_files, print_result, study_files
from derive.cli.specifications import read_beside
from derive.spec.model.specification import AnyScene
from derive.spec.set_values import SetValue
from derive.study.accuracy.chart import accuracy_svg
from derive.study.accuracy.ladder_chart import LadderChart
from derive.study.accuracy.study import study_accuracy
from derive.study.accuracy.table import accuracy_data, accuracy_html, accuracy_text, run_table

NAME = "accuracy"
EXPECTED_SIZE = 1_000_000
"""The approximate size of the files of a study, in bytes."""
INTERRUPTED = 130
"""The exit code after Ctrl-C."""


def run(scene: AnyScene, changes: Sequence[SetValue], options: argparse.Namespace) -> int:
    """Run the study and write its chart, page, table and data; Ctrl-C leaves those of the finished part.

    The notes of these begin with the changes of the scene.
    """
    folder = options.out or Path("results") / scene.name
    check_folder(planned_files(NAME, scene.name, folder), folder, EXPECTED_SIZE)
    also = [read_beside(path, options.set, scene) for path in options.also]
    replaced = [*map(str, changes), *(text for _, texts in also for text in texts)]
    given = {**keywords(study_accuracy, options), "also": [other for other, _ in also]}
    parts: list[LadderChart] = []

    def noted(part: LadderChart) -> LadderChart:
        return replace(part, notes=(*replaced, *_unchanged(part, scene, changes), *part.notes))

    def data_of(part: LadderChart) -> dict[str, Any]:
        return {**accuracy_data(part), "set": replaced}

    def record(part: LadderChart) -> None:
        parts.append(noted(part))
        write(_files(parts[-1], data_of(parts[-1])), folder)

    interrupted = False
    try:
        chart = noted(study_accuracy(scene, **given, progress=True, record=record))
    except KeyboardInterrupt:
        if not parts:
            raise
        chart, interrupted = parts[-1], True
    data = data_of(chart)
    with drawing(scene.name):
        files = _files(chart, data)
        write(files, folder)
    print_result(accuracy_text(chart), data, [str(folder / file.path) for file in files], options.json)
    return INTERRUPTED if interrupted else 0


def _unchanged(chart: LadderChart, scene: AnyScene, changes: Sequence[SetValue]) -> list[str]:
    """The note on a reference that is a file, which changes of the scene leave as it is."""
    files = {plot.reference.file for plot in scene.plots if plot.reference is not None}
    if not changes or chart.reference.source not in files:
        return []
    return [
        f"the curve of {chart.reference.source} is that of the scene before these changes; --own-reference compares "
        "with models of the changed scene"
    ]


def _files(chart: LadderChart, data: dict[str, Any]) -> list[File | BinaryFile]:
    """Chart, page and table, and the record with all numbers."""
    texts = {"svg": accuracy_svg(chart), "html": accuracy_html(chart), "csv": run_table(chart).csv}
    return study_files(NAME, data, texts)
