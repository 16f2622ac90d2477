"""The files of the commands in the folder of a model: their names, which nothing else in this folder has.

`simulate` names files after the model and its plots, `modes` and `report` after the model with a word behind a dot,
which no name of a plot has; studies and sweeps name them after themselves.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from derive.artifacts import MARK, BinaryFile, File, sha256
from derive.errors import Problem, SpecError, quoted
from derive.progress_line import show_progress
from derive.spec.model.plots import Plot
from derive.version import VERSION

STUDY_FILES = {
    "accuracy": ("svg", "html", "csv", "json"),
    "frames": ("svg",),
    "methods": ("svg", "html", "csv", "json"),
    "stability": ("svg", "csv", "json"),
    "sweep": ("svg", "csv", "npz", "json"),
}
"""The studies, with the endings of the files that each writes under its own name."""
MODEL_FILES = ("csv", "json", "html")
"""The endings of the files of `simulate` that are named after the model."""
RECORDED = ("csv", "npz")
"""The endings of formats without comments, for which a record vouches, the file of the same name with `json`."""


def motion_page_path(model: str) -> str:
    """The page with the animation and the curves of a simulation, below the output folder."""
    return f"{model}/{model}.html"


def planned_files(study: str, model: str, folder: Path) -> list[File]:
    """The files of a study of a model in a folder, still without their texts.

    Raises SpecError if simulations of this model write files with these names there.
    """
    endings = STUDY_FILES[study]
    if model.lower() == folder.name.lower() == study and set(endings) & set(MODEL_FILES):
        both = ", ".join(f"{study}.{ending}" for ending in endings if ending in MODEL_FILES)
        text = f"simulations of a model called {quoted(model)} write {both} to {folder}, and so does {study}"
        raise SpecError((Problem("name", f"{text}; choose another name"),))
    return [File(f"{study}.{ending}", "", record=f"{study}.json" if ending in RECORDED else None) for ending in endings]


def study_files(study: str, data: Mapping[str, Any], content: Mapping[str, str | bytes]) -> list[File | BinaryFile]:
    """The files of a study from their texts or bytes by their endings, and the record with all numbers.

    The record vouches for the tables among the files.
    """
    record = f"{study}.json"
    files: list[File | BinaryFile] = []
    for ending, text in content.items():
        content_bytes = text.encode() if isinstance(text, str) else text
        files.append(BinaryFile(f"{study}.{ending}", content_bytes, record=record if ending in RECORDED else None))
    hashes = {file.path: sha256(file.data) for file in files if file.record}
    everything = {"generator": f"{MARK} {VERSION}. Do not edit.", **data, "files": hashes}
    return [*files, File(record, json.dumps(everything, indent=2) + "\n")]


@contextmanager
def drawing(name: str) -> Iterator[None]:
    """Meanwhile the results of a model are drawn and written, as the line of progress says."""
    show_progress(f"{name}: drawing and writing the results ...")
    try:
        yield
    finally:
        show_progress()


def print_result(text: str, data: Mapping[str, Any], written: Sequence[str], as_json: bool) -> None:
    """Print the result of a command as text or as JSON, with the names of the files that it has written."""
    if as_json:
        print(json.dumps({**data, "files": written}, indent=2))
    else:
        print("\n".join([text, "", *(f"wrote {name}" for name in written)]))


def picture_names(plots: Sequence[Plot]) -> dict[str, str]:
    """The names of the pictures of plots, by the names of the plots.

    A plot with the name of a study has "_plot" behind it, so that neither overwrites the picture of the other. Names
    differ in more than case, as some file systems require.
    """
    taken = {*STUDY_FILES, *(plot.name.lower() for plot in plots)}
    result = {}
    for plot in plots:
        name = plot.name
        while name.lower() in taken and (name != plot.name or name.lower() in STUDY_FILES):
            name += "_plot"
        taken.add(name.lower())
        result[plot.name] = f"{name}.svg"
    return result
