"""Interfaces to other programs, which make from a model the files that a host accepts."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from derive.artifacts import MARK, BinaryFile, File, sha256
from derive.backends.c.source import ABI
from derive.errors import Problem, SpecError
from derive.export.host_model import HostModel
from derive.version import VERSION

HostFile = File | BinaryFile


@dataclass(frozen=True)
class Interface:
    """An interface to other programs; one is added by an entry in `derive.export.registry.INTERFACES`.

    doc: the hosts in words. files: the files of a model, with paths relative to a folder of their own; a file without
    comments, such as an archive, names RECORD as its record. next_step: what the user does with them, a line of text
    in which {folder} and {name} stand for the folder of the files and the name of the model. sensitivities: whether
    the model has the functions for derivatives with respect to parameters and inputs, see `derive.lower`. notes: lines
    of text for the user on what the hosts cannot do with a model.
    """

    doc: str
    files: Callable[[HostModel], Sequence[HostFile]]
    next_step: str
    sensitivities: bool = False
    notes: Callable[[HostModel], tuple[str, ...]] = lambda _: ()


RECORD = "export.json"
"""The record of an export: by which version it was made, and the hashes of its files."""


def export_folder(model: HostModel, kind: str) -> str:
    """The folder of the files of an interface, below the output folder."""
    return f"{model.name}-{kind}"


def exported_files(model: HostModel, kind: str, interface: Interface) -> tuple[HostFile, ...]:
    """The files of an interface in a folder of their own, and their record.

    Raises SpecError where the name of the model is that of another file, also where upper and lower case are the same.
    """
    folder = export_folder(model, kind)
    made = interface.files(model)
    paths = [file.path.lower() for file in made]
    if any(paths.count(path) > 1 for path in paths):
        taken = f'"{model.name}" is the name of a file that this interface adds; choose another name'
        raise SpecError((Problem("name", taken),), None)
    content = {
        "generator": f"{MARK}. Do not edit.",
        "interface": kind,
        "name": model.name,
        "version": VERSION,
        "abi": ABI,
        "files": {file.path: sha256(file.data) for file in made},
    }
    return *(_below(folder, file) for file in made), File(f"{folder}/{RECORD}", json.dumps(content, indent=2) + "\n")


def _below(folder: str, file: HostFile) -> HostFile:
    record = file.record and f"{folder}/{file.record}"
    if isinstance(file, BinaryFile):
        return BinaryFile(f"{folder}/{file.path}", file.data, record=record)
    return File(f"{folder}/{file.path}", file.text, record=record)
