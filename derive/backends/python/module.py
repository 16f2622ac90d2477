"""A model as a Python module: the same functions and patterns as the C, over leading batch axes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from derive.artifacts import MARK, File
from derive.backends.description import LICENCE, description, kernel_text, model_text, pattern_texts, section_text
from derive.backends.expression_text import python_number, statement, text
from derive.backends.python.loops import HELPERS, Loops
from derive.ir.expressions import ScalarRef
from derive.ir.model import Kernel, Model, Output, Variable
from derive.ir.statements import Let, Require, Requirement, Store
from derive.rendering import WIDTH, render, wrapped


@dataclass(frozen=True)
class Function:
    """One Python function as text."""

    name: str
    arguments: str
    doc: str
    body: str


def python_file(model: Model, fingerprint: str) -> File:
    """`NAME.py`, which needs NumPy alone; arrays of any array-API namespace will do."""
    values = {
        "mark": f"# {MARK} from a specification with SHA-256\n# {fingerprint}. Do not edit.\n# {LICENCE}",
        "model": model,
        "description": "\n".join(wrapped(description(model_text(model)), "")),
        "functions": [_function(kernel) for kernel in model.kernels],
        "patterns": pattern_texts(model, "        "),
        "tables": _tables(model),
        "helpers": f"\n{HELPERS.rstrip()}" if model.lowering == "table" else "",
        "defaults": _defaults(model),
    }
    return File(f"{model.name}/{model.name}.py", render("python/model.py.jinja", values))


def _function(kernel: Kernel) -> Function:
    names = ", ".join(a.name for a in kernel.arguments)
    sizes = ", ".join(f"{a.name}={None if a.scalar else a.size}" for a in kernel.arguments)
    own = _tuple([a.name for a in kernel.arguments])
    lines = [f"    xp, batch, {own} = _arrays(dict({sizes}), {names})"]
    used = kernel.used
    for argument in kernel.arguments:
        lines += [f"    {name} = {argument.name}[..., {k}]" for k, name in argument.named_elements if name in used]
        lines += [
            f"    {v.name} = {argument.name}[..., {v.offset}:{v.offset + v.size}]"
            for v in argument.arrays
            if v.name in used
        ]
    looped = any(output.count is not None for output in kernel.outputs)
    if looped:
        lines += [f"    {o.name} = _empty(xp, batch, {o.size})" for o in kernel.outputs if o.count is not None]
    loops = Loops(kernel.arguments)
    whole = {o.name for o in kernel.outputs if o.count is not None}
    required: list[str] = []
    for section in kernel.sections:
        body = []
        for item in section.body:
            if isinstance(item, Let | Store | Require):
                body += _statement(item, kernel.name == "setup", required, whole)
            else:
                body += [part for line in loops.lines(item) for part in _long(line)]
        lines += ["", *wrapped([section_text(section)], "    # "), *body] if body else []
    doc = "\n".join(wrapped(kernel_text(kernel), "    ")).strip()
    return Function(kernel.name, names, doc, "\n".join([*lines, "", *_results(kernel.outputs, required)]))


def _long(line: str) -> list[str]:
    """A line of a loop, broken if it is an assignment that is too long."""
    head, sign, value = line.partition(" = ")
    if len(line) + 4 <= WIDTH or not sign or line.startswith(" "):
        return [f"    {line}"]
    return _assignment(head, value)


def _statement(item: Let | Store | Require, raises: bool, required: list[str], whole: set[str]) -> list[str]:
    value = text(item.expr, python_number, "xp.")
    if isinstance(item, Let):
        return _assignment(item.name, value)
    if isinstance(item, Store):
        place = f"{item.output}[..., {item.index}]" if item.output in whole else f"{item.output}_{item.index}"
        return _assignment(place, value)
    operand = value if isinstance(item.expr, ScalarRef) else f"({value})"
    holds = f"{operand} > 0" if item.kind is Requirement.POSITIVE else f"xp.isfinite({value})"
    if raises:
        return [f'    _require(xp.all({holds}), "{item.text}")']
    if item.kind is Requirement.FINITE:  # the value itself says so
        return []
    required.append(f"valid_{len(required) + 1}")
    return _assignment(required[-1], holds)


def _assignment(name: str, value: str) -> list[str]:
    lines = statement("    ", f"{name} = ", value, "")
    if len(lines) == 1:
        return lines
    return [f"    {name} = (", *statement("        ", "", value, ""), "    )"]


def _results(outputs: tuple[Output, ...], required: list[str]) -> list[str]:
    lines = []
    for output in outputs:
        if output.count is not None:
            continue
        elements = _tuple([f"{output.name}_{k}" for k in range(len(output.elements))])
        lines += wrapped([f"{output.name} = _stack(xp, batch, {elements})"], "    ")
    if required:
        valid = " & ".join(required)
        lines += [f"    return {', '.join(f'_where(xp, {valid}, {o.name})' for o in outputs)}"]
    else:
        lines += [f"    return {', '.join(o.name for o in outputs)}"]
    return lines


@dataclass(frozen=True)
class Table:
    """A tuple of the generated module."""

    name: str
    items: str


def _tables(model: Model) -> list[Table]:
    """Names, units and defaults, as tuples of literals."""

    def table(name: str, items: Iterable[object]) -> Table:
        literals = [f'"{item}"' if isinstance(item, str) else repr(item) for item in items]
        return Table(name, _lines(literals))

    return [
        table("COORDINATES", _each_name(model.coordinates)),
        table("VELOCITIES", _each_name(model.rates)),
        table("PARAMETERS", (v.name for v in model.parameters)),
        table("SIZES", (v.size for v in model.parameters)),
        table("UNITS", (v.unit for v in model.parameters)),
        table("CONSTANTS", (v.name for v in model.constants)),
        table("MARKERS", (v.name for v in model.markers)),
        *(
            (table("MULTIPLIERS", (v.name for v in model.multipliers)), table("BODIES", model.bodies))
            if model.bodies
            else ()
        ),
    ]


def _each_name(variables: tuple[Variable, ...]) -> list[str]:
    """Names; the elements of an array are numbered from 1."""
    return [f"{v.name}{k}" if v.size > 1 else v.name for v in variables for k in range(1, v.size + 1)]


def _defaults(model: Model) -> str:
    """The defaults of p: all of them, or, where most are zero, a dict of those that are not."""
    values = model.defaults
    kept = [(k, x) for k, x in enumerate(values) if x]
    if 2 * len(kept) > len(values) or len(kept) < 9:
        return f"DEFAULTS = {_lines([repr(x) for x in values])}"
    entries = "\n".join(wrapped([", ".join(f"{k}: {x!r}" for k, x in kept)], "    "))
    return f"_VALUES = {{\n{entries},\n}}\nDEFAULTS = tuple(_VALUES.get(k, 0.0) for k in range({len(values)}))"


def _lines(literals: list[str]) -> str:
    """A tuple, on several lines if it is long; literals are not broken."""
    if len(_tuple(literals)) < WIDTH - 20:
        return _tuple(literals)
    lines = [""]
    for literal in literals:
        if len(lines[-1]) + len(literal) > WIDTH - 8:
            lines.append("")
        lines[-1] += f" {literal},"
    return "\n".join(["(", *(f"   {line}" for line in lines), ")"])


def _tuple(items: list[str]) -> str:
    return f"({items[0]},)" if len(items) == 1 else f"({', '.join(items)})"
