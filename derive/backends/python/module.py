"""The backend of Python: the same functions and patterns as the C, over leading batch axes."""

from __future__ import annotations

from enum import Enum
from typing import assert_never

from derive.artifacts import MARK, File
from derive.backends.description import (
    LICENCE,
    MODEL_HASH,
    description,
    kernel_text,
    model_text,
    pattern_texts,
    section_text,
)
from derive.backends.expression_text import PYTHON, text
from derive.backends.python.constants import constant_array, defaults, marker_class, splines, tables, tuple_text
from derive.backends.python.instances import instance_lines
from derive.backends.python.loops import HELPERS, PythonLoops, assignment
from derive.backends.source_map import SourceBuilder, SourceLine, defining, plain, storing
from derive.backends.wrapping import WIDTH, broken, join, prefixed
from derive.ir.analysis import expressions
from derive.ir.expressions import Number, Operation, Operator, ScalarRef, walk
from derive.ir.kernel import Argument, Kernel, Output
from derive.ir.model import Model
from derive.ir.statements import (
    Clear,
    Entry,
    ForEach,
    Let,
    Require,
    Requirement,
    Statement,
    Store,
    StoreElement,
    Work,
)
from derive.rendering import render

UNDEFINED = frozenset({Operator.SIN, Operator.COS, Operator.SQRT, Operator.EXP, Operator.LOG})
"""The functions that numbers of Python do not have everywhere: of inf, of negative numbers, or where they overflow."""


class Failure(Enum):
    """The consequence of a requirement of a kernel that is not met: an error, NaN as the results, or none."""

    ERROR = "error"
    NAN = "nan"
    IGNORED = "ignored"


class PythonBackend:
    """A Python module that needs NumPy alone; arrays of any array-API namespace will do."""

    name = "python"

    def file_names(self, model: str) -> tuple[str, ...]:
        """The path of the module of a model below the output folder."""
        return (f"{model}/{model}.py",)

    def files(self, model: Model, fingerprint: str) -> tuple[File, ...]:
        """`NAME.py` with its source map; `fingerprint` is that of the specification."""
        values = {
            "mark": f"# {MARK} from a specification with SHA-256\n# {fingerprint}. Do not edit.\n# {LICENCE}",
            "hash": MODEL_HASH,
            "model": model,
            "description": "\n".join(prefixed(description(model_text(model)), "")),
            "patterns": pattern_texts(model, "        "),
            "tables": tables(model),
            "helpers": f"\n{HELPERS.rstrip()}" if model.lowering == "loops" else splines(model),
            "grouped": any(text.groups for text in pattern_texts(model, "        ")),
            "constant_arrays": list(map(constant_array, model.constant_arrays)),
            "defaults": defaults(model),
            "elements": model.lowering != "loops",
            "marker_classes": list(map(marker_class, model.marker_classes)),
        }
        builder = SourceBuilder(model)
        builder.text(render("python/prologue.py.jinja", values))
        for kernel in model.kernels:
            numbers = model.lowering != "loops" and kernel.name != "setup"
            builder.text("\n@_in_numbers\n" if numbers and _may_raise(kernel) else "\n")
            builder.function(kernel, python_function(kernel, model.lowering != "loops", numbers))
            builder.text("\n")
        builder.text(render("python/epilogue.py.jinja", values))
        (path,) = self.file_names(model.name)
        return (builder.file(self.name, path),)


def python_function(
    kernel: Kernel, elements: bool, numbers: bool, failure: Failure = Failure.ERROR
) -> list[SourceLine]:
    """The function of a kernel, whose arguments are arrays, or their elements along the last axis.

    numbers: whether it takes those of a single state as numbers of Python. Its module has the functions that it calls:
    `_arrays`, which returns the namespace, the batch and the arguments; `_stack`; `_require` for errors; `_where` for
    errors and NaN.
    """
    names = ", ".join(a.name for a in kernel.arguments)
    given = tuple(a for a in kernel.arguments if not a.integer)
    sizes = ", ".join(f"{a.name}={None if a.scalar else a.size}" for a in given)
    own = tuple_text([a.name for a in given])
    first, *doc = broken(kernel_text(kernel), WIDTH - len("    "))
    converted = f"xp, batch, {own} = _arrays(dict({sizes}), {', '.join(a.name for a in given)})"
    lines = [
        f"def {kernel.name}({names}):",
        f'    """{first}',
        *(f"    {line}" if line else "" for line in doc),
        '    """',
        *([*_single_state(given), "    else:", f"        {converted}"] if numbers else [f"    {converted}"]),
    ]
    used = kernel.used
    for argument in kernel.arguments:
        index = "" if elements else "..., "
        lines += [f"    {name} = {argument.name}[{index}{k}]" for k, name in argument.named_elements if name in used]
        lines += [
            f"    {v.name} = {argument.name}[..., {v.offset}:{v.offset + v.size}]"
            for v in argument.parts
            if v.name in used
        ]
    listed = _is_listed(kernel)
    if listed:
        lines += [f"    {o.name} = [0.0] * {o.size}" for o in kernel.outputs]
    else:
        lines += [f"    {o.name} = _empty(xp, batch, {o.size})" for o in kernel.outputs if o.count is not None]
    printer = _Statements(kernel, failure)
    body: list[SourceLine] = []
    for k, section in enumerate(kernel.sections):
        printed = [line.of(k, n) for n, item in enumerate(section.body) for line in printer.lines(item)]
        body += [*plain("", *prefixed([section_text(section)], "    # ")), *printed] if printed else []
    lines += [f"    {name} = True" for name in printer.initial]
    return [*plain(*lines), *body, *plain("", *_results(kernel.outputs, printer.required, listed))]


def _is_listed(kernel: Kernel) -> bool:
    """Whether the elements of outputs are written to lists: by loops over instances and beside them, or not at all."""
    if not kernel.statements:
        return any(o.count is not None for o in kernel.outputs)
    return any(isinstance(s, ForEach | StoreElement) for s in kernel.statements)


def _single_state(arguments: tuple[Argument, ...]) -> list[str]:
    """The test whether the arguments are vectors of doubles of a single state, and their conversion to numbers."""
    vectors = [a for a in arguments if not a.scalar]
    by_size: dict[int, list[str]] = {}
    for a in vectors:
        by_size.setdefault(a.size, []).append(a.name)
    conditions = [
        f"{' is '.join(f'type({a.name})' for a in vectors)} is _ARRAY",
        f"{' is '.join(f'{a.name}.dtype' for a in vectors)} is _DOUBLE",
        *(f"{' == '.join(f'{name}.shape' for name in names)} == ({size},)" for size, names in by_size.items()),
        *(f"isinstance({a.name}, float)" for a in arguments if a.scalar),
    ]
    names, lists = (", ".join(form.format(a.name) for a in vectors) for form in ("{}", "{}.tolist()"))
    test = f"if ({' and '.join(conditions)}):"
    return [*prefixed([test], "    "), f"        xp, batch, {names} = _NUMBERS, _SINGLE, {lists}"]


def _may_raise(kernel: Kernel) -> bool:
    """Whether an operation of a kernel is one for which numbers of Python raise errors where arrays have inf or NaN."""
    parts = (p for s in kernel.sections for item in s.body for expr in expressions(item) for p in walk(expr))
    operations = [p for p in parts if isinstance(p, Operation)]
    divides = any(p.kind is Operator.DIV and not isinstance(p.args[1], Number) for p in operations)
    return divides or any(p.kind in UNDEFINED for p in operations)


class _Statements:
    """The statements of one function; `required` are the names of the conditions that their results need."""

    def __init__(self, kernel: Kernel, failure: Failure) -> None:
        self.failure = failure
        self.single = kernel.name == "setup"
        self.loops = PythonLoops(kernel.arguments)
        self.whole = {o.name for o in kernel.outputs if o.count is not None}
        self.listed = _is_listed(kernel)
        self.required: list[str] = []
        self.initial: list[str] = []

    def lines(self, item: Statement) -> list[SourceLine]:
        """The lines of a statement."""
        match item:
            case Let():
                return defining(assignment(item.name, text(item.expr, PYTHON)), item.name)
            case Clear() if self.listed:
                return []  # lists begin with zeros
            case Work() | Entry() | StoreElement() | ForEach():
                return instance_lines(item, self._require)
            case Store():
                whole = item.output in self.whole
                target = f"{item.output}[..., {item.index}]" if whole else f"{item.output}_{item.index}"
                return storing(assignment(target, text(item.expr, PYTHON)), item.output, item.index)
            case Require():
                return plain(*self._require(item))
            case _:
                return self.loops.lines(item)

    def _require(self, item: Require) -> list[str]:
        if self.failure is Failure.IGNORED:
            return []
        value = text(item.expr, PYTHON)
        match item.kind:
            case Requirement.POSITIVE:
                operand = value if isinstance(item.expr, ScalarRef) else join("(", value, ")")
                holds = join(operand, " > 0")
            case Requirement.FINITE:
                holds = join("xp.isfinite(", value, ")")
            case _:
                assert_never(item.kind)
        if self.single and self.failure is Failure.ERROR:
            return [f'    _require(xp.all({holds}), {item.code}, "{item.text}")']
        self.required.append(f"valid_{len(self.required) + 1}")
        name = self.required[-1]
        if self.listed:
            self.initial.append(name)
            holds = join(f"{name} & (", holds, ")")
        error = f'    _require(batch[0] or {name}, {item.code}, "{item.text}")'
        return [*assignment(name, holds), *([error] if self.failure is Failure.ERROR else [])]


def _results(outputs: tuple[Output, ...], required: list[str], listed: bool) -> list[str]:
    lines = []
    for output in outputs:
        if output.count is not None and not listed:
            continue
        elements = output.name if listed else tuple_text([f"{output.name}_{k}" for k in range(len(output.elements))])
        lines += prefixed([f"{output.name} = _stack(xp, batch, {elements})"], "    ")
    if required:
        valid = " & ".join(required)
        lines += [f"    return {', '.join(f'_where(xp, {valid}, {o.name})' for o in outputs)}"]
    else:
        lines += [f"    return {', '.join(o.name for o in outputs)}"]
    return lines
