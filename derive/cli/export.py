"""`tisserand export`: write a model as another program takes it."""

from __future__ import annotations

import argparse
import json
import shlex
from dataclasses import asdict
from pathlib import Path

from derive.artifacts import write
from derive.cli.specifications import read_changed
from derive.errors import SpecError
from derive.export.host_model import HostModel, HostVariable, host_model
from derive.export.interface import HostFile, Interface, export_folder, exported_files
from derive.export.registry import INTERFACES
from derive.progress_line import show_progress
from derive.spec.toml.read import warnings, with_lines


def run(options: argparse.Namespace) -> int:
    """Make all files of the interface, then write them; an error prevents all writing."""
    interface = INTERFACES[options.to]
    spec, changes = read_changed(options.spec, options.set)
    show_progress(f"{spec.name}: deriving the equations and computing the initial state ...")
    try:
        model = host_model(spec, interface.sensitivities)
        show_progress(f"{spec.name}: making the files for {options.to} ...")
        files = exported_files(model, options.to, interface)
    except SpecError as error:
        raise with_lines(error, options.spec) from None
    finally:
        show_progress()
    write(files, options.out)
    notes = [
        *map(str, changes),
        *model.notes,
        *interface.notes(model),
        *(f"warning: {text}" for text in warnings(options.spec)),
    ]
    if options.json:
        print(json.dumps(_plain(model, options, notes, files), indent=2))
    else:
        print(_text(model, options, interface, notes, files))
    return 0


KINDS = ("states", "inputs", "outputs", "parameters")


def _text(
    model: HostModel, options: argparse.Namespace, interface: Interface, notes: list[str], files: tuple[HostFile, ...]
) -> str:
    folder = options.out / export_folder(model, options.to)
    lines = [f"{model.name}: {model.model.doc}", *(f"  {note}" for note in notes)]
    for kind in KINDS:
        variables: tuple[HostVariable, ...] = getattr(model, kind)
        names = ", ".join(f"{x.name} ({x.unit})" if x.unit else x.name for x in variables)
        noun = kind.removesuffix("s") if len(variables) == 1 else kind
        lines.append(f"  {len(variables)} {noun}{': ' if names else ''}{names}")
    lines += [f"  wrote {options.out / file.path}" for file in files]
    lines.append(f"  next: {interface.next_step.format(folder=shlex.quote(str(folder)), name=model.name)}")
    return "\n".join(lines)


def _plain(
    model: HostModel, options: argparse.Namespace, notes: list[str], files: tuple[HostFile, ...]
) -> dict[str, object]:
    return {
        "name": model.name,
        "interface": options.to,
        "notes": notes,
        **{kind: [asdict(variable) for variable in getattr(model, kind)] for kind in KINDS},
        "folder": str(Path(options.out) / export_folder(model, options.to)),
        "files": [str(options.out / file.path) for file in files],
    }
