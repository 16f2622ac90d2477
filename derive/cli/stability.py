"""`tisserand study stability`: where the models of a ladder lose their stability, and which verdicts are wrong."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from derive.artifacts import check_folder, write
from derive.cli.arguments.keywords import keywords
from derive.cli.result_files import drawing, planned_files, print_result, study_files
from derive.spec.model.specification import AnyScene
from derive.spec.set_values import SetValue
from derive.study.stability.chart import stability_svg
from derive.study.stability.ladder_stability import study_stability
from derive.study.stability.table import mode_table, stability_data, stability_text

NAME = "stability"
EXPECTED_SIZE = 5_000_000
"""The approximate size of the files of a study, in bytes."""


def run(scene: AnyScene, changes: Sequence[SetValue], options: argparse.Namespace) -> int:
    """Run the study and write its chart, table and data."""
    folder = options.out or Path("results") / scene.name
    check_folder(planned_files(NAME, scene.name, folder), folder, EXPECTED_SIZE)
    result = study_stability(scene, options.parameter, **keywords(study_stability, options), progress=True)
    data = {**stability_data(result), "set": list(map(str, changes))}
    with drawing(scene.name):
        files = study_files(NAME, data, {"svg": stability_svg(result), "csv": mode_table(result).csv})
        write(files, folder)
    text = "\n".join([*(f"{scene.name}: {change}" for change in changes), stability_text(result)])
    print_result(text, data, [str(folder / file.path) for file in files], options.json)
    return 0
