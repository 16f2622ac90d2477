"""Kernels as Python functions without branches, for arrays that are traced and for symbols.

A template gives what they call: `_space`, the namespace of functions; `_elements`, of an array; `_stack`, which makes
an array of elements; `_valid`, which makes a NaN of it where a requirement does not hold.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import assert_never

from derive.backends.description import kernel_text, section_text
from derive.backends.expression_text import PYTHON, text
from derive.backends.python.loops import assignment
from derive.backends.wrapping import WIDTH, BreakableText, broken, join, prefixed
from derive.errors import Problem, SpecError
from derive.ir.expressions import Number
from derive.ir.model import Kernel, Model
from derive.ir.statements import Let, Require, Requirement, Store

LOOPS = '{}; an export for arrays or symbols has straight-line code: lowering = "flat"'


def array_functions(model: Model, names: tuple[str, ...] | None = None, check: bool = True) -> str:
    """The functions of the kernels of these names, or of all.

    check: with the requirements of the kernels. Raises SpecError for a model with loops.
    """
    if model.lowering != "flat":
        raise SpecError((Problem("body.lowering", LOOPS.format(model.choice)),))
    kernels = [kernel for kernel in model.kernels if names is None or kernel.name in names]
    return "\n\n\n".join("\n".join(_function(kernel, check)) for kernel in kernels)


def _function(kernel: Kernel, check: bool) -> list[str]:
    arguments = ", ".join(a.name for a in kernel.arguments)
    first, *doc = broken(kernel_text(kernel), WIDTH - len("    "))
    lines = [
        f"def {kernel.name}({arguments}):",
        f'    """{first}',
        *(f"    {line}" if line else "" for line in doc),
        '    """',
        f"    xp = _space({arguments})",
    ]
    for a in kernel.arguments:
        if not a.scalar:
            lines.append(f'    {a.name}_ = _elements(xp, "{a.name}", {a.name}, {a.size})')
            lines += [f"    {name} = {a.name}_[{k}]" for k, name in a.named_elements if name in kernel.used]
    required = 0
    for section in kernel.sections:
        body: list[str] = []
        for statement in section.body:
            match statement:
                case Let():
                    body += assignment(statement.name, text(statement.expr, PYTHON))
                case Store():
                    body += assignment(f"{statement.output}_{statement.index}", text(statement.expr, PYTHON))
                case Require():
                    if check and not isinstance(statement.expr, Number):
                        required += 1
                        body += assignment(f"valid_{required}", _requirement(statement))
                case _:
                    raise AssertionError(f"{kernel.name} has loops")
        lines += ["", *prefixed([section_text(section)], "    # "), *body] if body else []
    valid = " & ".join(f"valid_{k + 1}" for k in range(required))
    results = []
    for output in kernel.outputs:
        elements = ", ".join(f"{output.name}_{k}" for k in range(output.size))
        lines += prefixed([f"{output.name} = _stack(xp, [{elements}], {arguments})"], "    ")
        results.append(f"_valid(xp, {valid}, {output.name})" if valid else output.name)
    return [*lines, f"    return {', '.join(results)}"]


def _requirement(statement: Require) -> BreakableText:
    value = join("(", text(statement.expr, PYTHON), ")")
    match statement.kind:
        case Requirement.POSITIVE:
            return join(value, " > 0")
        case Requirement.FINITE:
            return join("xp.isfinite", value)
        case _:
            assert_never(statement.kind)


def wrapped(values: Iterable[object]) -> str:
    """The items of a tuple of literals, in lines of a function."""
    return "\n".join(prefixed(["".join(f"{value!r}, " for value in values)], "        "))
