"""The files of a model: its specification, programs that call the generated code, and the manifest."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass

from derive.artifacts import File
from derive.ir.model import Model
from derive.report.document.page import Block, CodeLine, CodeSpan, Content, Details, Heading, Listing, Paragraph, table
from derive.report.notation.formula_reader import marked_text
from derive.report.sections.state import size
from derive.roles import Role

LONG = 60
"""Lines of a specification that are shown at once."""

C = """\
#include "{name}.h"

#include <stdio.h>

int main(void)
{{
    double p[{macro}_NP + 1], k[{macro}_NK + 1], q[{macro}_NQ] = {{0}}, v[{macro}_NV] = {{0}}, vdot[{macro}_NV];

    {name}_defaults(p);
    if ({name}_setup(p, k)) return 1;
{start}
    if ({name}_accel(0.0, q, v, k, vdot)) return 1;
    for (int i = 0; i < {macro}_NV; i++) printf("%g\\n", vdot[i]);
    return 0;
}}
"""

PYTHON = """\
import {name} as model

k = model.setup(model.DEFAULTS)
q = [0.0] * {coordinates}
v = [0.0] * {rates}
{start}
print(model.accel(0.0, q, v, k))
"""


@dataclass(frozen=True)
class SpecificationText:
    """The specification as it was written: the name of its file, and its lines."""

    name: str
    text: str


def specification_blocks(given: SpecificationText) -> tuple[Block, ...]:
    """The specification, folded if it is long."""
    shown = listing("toml", given.name, given.text.strip("\n"))
    count = len(shown.lines)
    block: Block = shown if count <= LONG else Details(f"{given.name}, {count} lines", (shown,))
    return (Heading("Specification", "specification"), block)


def manifest_blocks(files: Sequence[File]) -> tuple[Block, ...]:
    """The manifest as a table."""
    given = json.loads(next(file.text for file in files if file.path.endswith("manifest.json")))
    tools = ", ".join(f"{name} {version}" for name, version in given["tools"].items())
    hashes: list[list[Content]] = [["specification", CodeSpan(given["specification_sha256"])]]
    hashes += [[path.rpartition("/")[2], CodeSpan(digest)] for path, digest in given["files"].items()]
    return (
        Heading("Manifest", "manifest"),
        Paragraph((f"Made by {tools}; interface number {given['abi']}. The same specification gives the same bytes.",)),
        table("SHA-256", ("what", "hash"), hashes, wide=True),
    )


def calling_blocks(model: Model) -> tuple[Block, ...]:
    """A program in C and one in Python that give the accelerations of a body that spins."""
    name = model.name
    return (
        Heading("How to call it", "calling"),
        Paragraph(("Both programs print the accelerations of the spinning body with the default parameters.",)),
        listing("c", f"main.c: cc main.c {name}.c -lm", c_program(model)),
        listing("python", f"beside {name}.py, which needs only NumPy", python_program(model)),
        Paragraph(
            marked_text(
                f"Matrices are stored as the values of compressed columns. In C, `{name}_model()` returns a descriptor "
                "with the patterns, names, units and functions of the model. In Python, `derive.load` compiles the C "
                "and calls it."
            )
        ),
    )


def c_program(model: Model) -> str:
    """A main program in C."""
    start = "\n".join(f"    {line};" for line in _start(model))
    return C.format(name=model.name, macro=model.name.upper(), start=start)


def python_program(model: Model) -> str:
    """A script in Python."""
    sizes = {"coordinates": size(model.coordinates), "rates": size(model.velocities)}
    return PYTHON.format(name=model.name, start="\n".join(_start(model)), **sizes)


def _start(model: Model) -> list[str]:
    """A bent body that spins, in assignments that both languages understand."""
    if any(q.role is Role.QUATERNION for q in model.coordinates):
        lines, first = ["q[3] = 1.0", "v[5] = 3.0"], 7
    else:
        lines, first = ["v[2] = 3.0"], 3
    return [*lines, *([f"q[{first}] = 0.01"] if size(model.coordinates) > first else [])]


def listing(language: str, caption: str, text: str) -> Listing:
    """Text as a listing."""
    return Listing(language, caption, tuple(CodeLine(k, line) for k, line in enumerate(text.splitlines(), 1)))
