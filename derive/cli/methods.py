"""`tisserand study methods`: the stability of integrators and formulations on a scene."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from derive.artifacts import check_folder, write
from derive.cli.arguments.keywords import keywords
from derive.cli.result_files import drawing, planned_files, print_result, study_files
from derive.spec.model.specification import AnyScene
from derive.spec.set_values import SetValue
from derive.study.methods.failures import failure_table, failures
from derive.study.methods.method_study import study_methods
from derive.study.methods.methods_chart import methods_svg
from derive.study.methods.methods_table import methods_data, methods_html, methods_text

NAME = "methods"
EXPECTED_SIZE = 1_000_000
"""The approximate size of the files of a study, in bytes."""


def run(scene: AnyScene, changes: Sequence[SetValue], options: argparse.Namespace) -> int:
    """Run the study and write its picture, page, table and data; their notes begin with the changes of the scene."""
    folder = options.out or Path("results") / scene.name
    check_folder(planned_files(NAME, scene.name, folder), folder, EXPECTED_SIZE)
    study = study_methods(scene, **keywords(study_methods, options), progress=True)
    study = replace(study, notes=(*map(str, changes), *study.notes))
    data, table = {**methods_data(study), "set": list(map(str, changes))}, failure_table(failures(study))
    with drawing(scene.name):
        files = study_files(NAME, data, {"svg": methods_svg(study), "html": methods_html(study), "csv": table.csv})
        write(files, folder)
    print_result(methods_text(study), data, [str(folder / file.path) for file in files], options.json)
    return 0
