"""The text of Python: the same functions and patterns as the C, over leading batch axes."""

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
from derive.backends.repeated import repeated
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


def module(model: Model, fingerprint: str, path: str) -> File:
    """The module of a model, with its source map; `fingerprint` is that of the specification."""
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
    again = repeated(model, lambda kernel, other: len(kernel.outputs) == len(other.outputs))
    for kernel in model.kernels:
        numbers = model.lowering != "loops" and kernel.name != "setup"
        builder.text("\n")
        if other := again.get(kernel.name):
            builder.function(kernel, _calling(kernel, other, numbers))
        else:
            builder.function(kernel, python_function(kernel, model.lowering != "loops", numbers))
        builder.text("\n")
    values["of_numbers"] = [kernel.name for kernel in model.kernels if kernel.name != "setup"]
    builder.text(render("python/epilogue.py.jinja", values))
    return builder.file("python", path)


def _calling(kernel: Kernel, other: Kernel, numbers: bool) -> list[SourceLine]:
    """The function of a kernel that calls another one with the same text."""
    names = ", ".join(a.name for a in kernel.arguments)
    own = ["", "", f"_{kernel.name} = _{other.name}"] if numbers else []
    return plain(*_head(kernel, names), f"    return {other.name}({names})", *own)


def _head(kernel: Kernel, names: str) -> list[str]:
    """The first lines of a function."""
    first, *doc = broken(kernel_text(kernel), WIDTH - len("    "))
    described = (f"    {line}" if line else "" for line in doc)
    return [f"def {kernel.name}({names}):", f'    """{first}', *described, '    """']


def python_function(
    kernel: Kernel, elements: bool, numbers: bool, failure: Failure = Failure.ERROR
) -> list[SourceLine]:
    """The function of a kernel, whose arguments are arrays, or their elements along the last axis.

    numbers: whether its statements are a function of their own, `_NAME`, which takes a single state as sequences of
    numbers also and returns numbers for it. Their module has the functions that they call: `_arrays`, which returns the
    namespace, the batch and the arguments; `_stack`; `_require` for errors; `_where` for errors and NaN.
    """
    names = ", ".join(a.name for a in kernel.arguments)
    given = tuple(a for a in kernel.arguments if not a.integer)
    sizes = ", ".join(f"{a.name}={None if a.scalar else a.size}" for a in given)
    own = tuple_text([a.name for a in given])
    lines = [
        *_head(kernel, names),
        *(_single_state(kernel, given) if numbers else []),
        f"    xp, batch, {own} = _arrays(dict({sizes}), {', '.join(a.name for a in given)})",
        *([f"    return _{kernel.name}({names}, xp, batch)", "", ""] if numbers else []),
        *([f"def _{kernel.name}({names}, xp=_NUMBERS, batch=_SINGLE):"] if numbers else []),
    ]
    used = kernel.used
    for argument in kernel.arguments:
        lines += _element_lines(argument, used, elements, numbers)
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
    return [*plain(*lines), *body, *plain("", *_results(kernel.outputs, printer.required, listed, numbers))]


def _element_lines(argument: Argument, used: frozenset[str], elements: bool, numbers: bool) -> list[str]:
    """The lines that name the elements of an argument; if half are used, in one assignment, which is faster."""
    names = {k: name for k, name in argument.named_elements if name in used}
    if numbers and 1 < argument.size <= 2 * len(names):
        targets = ", ".join(names.get(k, "_") for k in range(argument.size))
        end = f" = {argument.name}"
        *others, last = broken([f"({targets})"], WIDTH - len(f"    {end}"))
        return [f"    {line}" for line in (*others, f"{last}{end}")]
    index = "" if elements else "..., "
    return [f"    {name} = {argument.name}[{index}{k}]" for k, name in names.items()]


def _is_listed(kernel: Kernel) -> bool:
    """Whether the elements of outputs are written to lists: by loops over instances and beside them, or not at all."""
    if not kernel.statements:
        return any(o.count is not None for o in kernel.outputs)
    return any(isinstance(s, ForEach | StoreElement) for s in kernel.statements)


def _single_state(kernel: Kernel, arguments: tuple[Argument, ...]) -> list[str]:
    """The test whether the arguments are vectors of doubles of a single state, and its results by numbers."""
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
    values = ", ".join(f"{a.name}.tolist()" if a in vectors else a.name for a in kernel.arguments)
    call = f"_{kernel.name}({values})"
    if len(kernel.outputs) == 1:
        results = [f"return _vector({call}, _DOUBLE)"]
    else:
        outputs = [o.name for o in kernel.outputs]
        arrays = ", ".join(f"_vector({name}, _DOUBLE)" for name in outputs)
        results = [f"{', '.join(outputs)} = {call}", f"return {arrays}"]
    if _may_raise(kernel):
        results = [
            "try:",
            *(f"    {line}" for line in results),
            "except ModelError:",
            "    raise",
            "except (ArithmeticError, ValueError):",
            "    pass  # arrays have inf and NaN where numbers raise errors",
        ]
    return [
        *prefixed([f"if ({' and '.join(conditions)}):"], "    "),
        *(f"        {line}" for line in results),
    ]


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


def _results(outputs: tuple[Output, ...], required: list[str], listed: bool, numbers: bool) -> list[str]:
    def elements(output: Output) -> str:
        return output.name if listed else tuple_text([f"{output.name}_{k}" for k in range(len(output.elements))])

    lines = []
    if numbers:
        values = [elements(output) for output in outputs]
        lines += ["    if xp is _NUMBERS:"]
        lines += prefixed([f"return {values[0] if len(values) == 1 else tuple_text(values)}"], "        ")
    for output in outputs:
        if output.count is None or listed:
            lines += prefixed([f"{output.name} = _stack(xp, batch, {elements(output)})"], "    ")
    if required:
        valid = " & ".join(required)
        lines += [f"    return {', '.join(f'_where(xp, {valid}, {o.name})' for o in outputs)}"]
    else:
        lines += [f"    return {', '.join(o.name for o in outputs)}"]
    return lines
