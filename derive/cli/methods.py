"""`tisserand study methods`: the stability of integrators, forms and shapes on one scene and on small ones."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from derive.artifacts import MARK, File, check_folder, sha256, write
from derive.cli.result_files import planned_files
from derive.spec.model.scene import Scene
from derive.study.methods.method_study import MethodStudy, method_study
from derive.study.methods.methods_chart import methods_svg
from derive.study.methods.methods_page import methods_html
from derive.study.methods.methods_table import methods_csv, methods_data, methods_text
from derive.study.methods.scene_methods import Method
from derive.terminal import show_progress
from derive.version import VERSION

NAME = "methods"
EXPECTED_SIZE = 1_000_000
"""The approximate size of the files of a study, in bytes."""


def run(scene: Scene, options: argparse.Namespace) -> int:
    """Run the study and write its picture, page, table and data."""
    folder = options.out or Path("results") / scene.name
    check_folder(planned_files(NAME, scene.name, folder), folder, EXPECTED_SIZE)
    chosen = [Method(name) for name in options.integrators]
    study = method_study(scene, chosen, options.steps, options.states, show_progress)
    show_progress()
    data = methods_data(study)
    files = _files(study, data)
    write(files, folder)
    written = [str(folder / file.path) for file in files]
    if options.json:
        print(json.dumps({**data, "files": written}, indent=2))
    else:
        print("\n".join([methods_text(study), "", *(f"wrote {name}" for name in written)]))
    return 0


def _files(study: MethodStudy, data: dict[str, object]) -> tuple[File, ...]:
    """Picture, page and table, and the record with all numbers, which vouches for the table."""
    table = methods_csv(study)
    record = {"generator": f"{MARK} {VERSION}. Do not edit.", **data, "files": {f"{NAME}.csv": sha256(table.encode())}}
    return (
        File(f"{NAME}.svg", methods_svg(study)),
        File(f"{NAME}.html", methods_html(study)),
        File(f"{NAME}.csv", table, record=f"{NAME}.json"),
        File(f"{NAME}.json", json.dumps(record, indent=2) + "\n"),
    )
