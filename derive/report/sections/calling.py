"""How to call the generated C and Python: short programs that run as they are printed."""

from __future__ import annotations

from derive.ir.model import Model
from derive.report.document.page import Block, CodeLine, CodeSpan, Heading, Listing, Paragraph
from derive.report.sections.state import size
from derive.roles import Role

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


def calling_blocks(model: Model) -> tuple[Block, ...]:
    """A program in C and one in Python that give the accelerations of a body that spins."""
    name = model.name
    return (
        Heading("How to call it", "calling"),
        Paragraph(("Both programs print the accelerations of the body while it spins, parameters at their defaults.",)),
        listing("c", f"main.c: cc main.c {name}.c -lm", c_program(model)),
        listing("python", f"beside {name}.py, which needs NumPy alone", python_program(model)),
        Paragraph(
            (
                "Matrices are values of compressed columns; ",
                CodeSpan(f"{name}_model()"),
                " in C is a descriptor of patterns, names, units and functions. ",
                CodeSpan("derive.load"),
                " compiles the C and calls it from Python.",
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
