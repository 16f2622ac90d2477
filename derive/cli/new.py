"""`tisserand new`: write a commented specification that runs, and beside it the schema for editors."""

from __future__ import annotations

import argparse
import shlex
from pathlib import Path

from derive.artifacts import File, ForeignFile, write
from derive.errors import Problem, SpecError
from derive.rendering import templates_folder
from derive.spec.parsing.names import name_problem
from derive.spec.tables.json_schema import json_schema
from derive.spec.toml.read import parse

SCHEMA = "tisserand.schema.json"
"""The schema that the first line of a new specification names, `#:schema tisserand.schema.json`."""


def run(options: argparse.Namespace) -> int:
    """Write the specification, which must not exist yet, and the schema, which is replaced if it is one of ours."""
    name: str = options.name
    if problem := _name_problem(name):
        raise SpecError((Problem("", problem),))
    target = options.out / f"{name}.toml"
    if target.exists() or target.is_symlink():
        raise ForeignFile(f"{target}: this file exists and is left alone; choose another name or another --out")
    text = new_specification(name, options.kind)
    parse(text, str(target))  # the name may be that of a body, a joint or a marker
    write([File(target.name, text), File(SCHEMA, json_schema())], options.out)
    print(f"wrote {target}\nwrote {options.out / SCHEMA}")
    print(f"next: {shlex.join(['tisserand', 'run', str(target), '--open'])}")
    return 0


def new_specification(name: str, kind: str) -> str:
    """The specification of a kind in templates/new, where the model is called `new_` and the kind, under this name."""
    text = (templates_folder() / "new" / f"{kind}.toml").read_text(encoding="utf-8")
    return text.replace(f"new_{kind}", name)


def _name_problem(name: str) -> str | None:
    """The reason why this is no name of a model, with an alternative; None if it is one."""
    path = Path(name)
    if path.suffix == ".toml" and not name_problem(path.stem):
        folder = f" --out {path.parent}" if path.parent != Path() else ""
        return f"{name}: write the name alone, without folder and ending: tisserand new {path.stem}{folder}"
    return name_problem(name)
