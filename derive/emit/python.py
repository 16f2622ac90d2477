"""A model as a Python module: the same functions and patterns as the C, over leading batch axes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from derive.emit.document import LICENCE, description, kernel_text, model_text, pattern_texts, section_text
from derive.emit.expression import python_number, statement, text
from derive.emit.files import MARK, File
from derive.emit.template import WIDTH, render, wrapped
from derive.kernel.ir import Kernel, Let, Output, Ref, Statement, Store
from derive.kernel.model import Model


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
    }
    return File(f"{model.name}/{model.name}.py", render("python/model.py.jinja", values))


def _function(kernel: Kernel) -> Function:
    names = ", ".join(a.name for a in kernel.arguments)
    sizes = ", ".join(f"{a.name}={None if a.scalar else len(a.elements)}" for a in kernel.arguments)
    own = _tuple([a.name for a in kernel.arguments])
    lines = [f"    xp, batch, {own} = _arrays(dict({sizes}), {names})"]
    used = kernel.used
    for argument in kernel.arguments:
        read = [(k, n) for k, n in enumerate(argument.elements) if n in used]
        lines += [f"    {name} = {argument.name}[..., {k}]" for k, name in read]
    required: list[str] = []
    for section in kernel.sections:
        body = [line for item in section.body for line in _statement(item, kernel.name == "setup", required)]
        lines += ["", *wrapped([section_text(section)], "    # "), *body] if body else []
    doc = "\n".join(wrapped(kernel_text(kernel), "    ")).strip()
    return Function(kernel.name, names, doc, "\n".join([*lines, "", *_results(kernel.outputs, required)]))


def _statement(item: Statement, raises: bool, required: list[str]) -> list[str]:
    value = text(item.expr, python_number, "xp.")
    if isinstance(item, Let):
        return _assignment(item.name, value)
    if isinstance(item, Store):
        return _assignment(f"{item.output}_{item.index}", value)
    operand = value if isinstance(item.expr, Ref) else f"({value})"
    holds = f"{operand} > 0" if item.kind == "positive" else f"xp.isfinite({value})"
    if raises:
        return [f'    _require(xp.all({holds}), "{item.text}")']
    if item.kind == "finite":  # the value itself says so
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
        elements = _tuple([f"{output.name}_{k}" for k in range(len(output.elements))])
        lines += wrapped([f"{output.name} = _stack(xp, batch, {elements})"], "    ")
    if required:
        valid = " & ".join(required)
        lines += [f"    return _where(xp, {valid}, {outputs[0].name})"]
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
        table("COORDINATES", (v.name for v in model.coordinates)),
        table("RATES", (v.name for v in model.rates)),
        table("PARAMETERS", (v.name for v in model.parameters)),
        table("UNITS", (v.unit for v in model.parameters)),
        table("DEFAULTS", (v.default for v in model.parameters)),
        table("CONSTANTS", (v.name for v in model.constants)),
        table("MARKERS", (v.name for v in model.markers)),
    ]


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
