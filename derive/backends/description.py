"""The description of a model in its generated files, the same text in every language."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import assert_never

from derive.backends.wrapping import Item, Prose, prefixed
from derive.function_names import OF_MODELS
from derive.ir.kernel import Argument, Kernel, Output, OutputKind, Section
from derive.ir.model import JACOBIAN, PARAMETER_JACOBIAN, Model, Variable, Zero
from derive.ir.patterns import Pattern, RowSetKind
from derive.ir.repeated_columns import repeated_columns
from derive.ir.series import variable_series
from derive.roles import Source
from derive.spec.model.instances import instance_name, joined

MOST_ROWS = 40
"""Rows of a mass matrix that are drawn with letters."""

LICENCE = "SPDX-License-Identifier: 0BSD"

MODEL_HASH = "hash_of_this_build"
"""The placeholder in the files of a backend for the hash of the model, which depends on all of them."""


@dataclass(frozen=True)
class PatternText:
    """A sparsity pattern as a language writes it: its name, and its integers as lines.

    A pattern with groups of columns has no integers, but `fill`, the loops of C that write them, and `groups`, the
    groups as nested tuples of Python. One of loops over instances has `repeated`, the integers of columns that repeat.
    """

    name: str
    pattern: Pattern
    colptr: str = ""
    rowidx: str = ""
    fill: str = ""
    groups: str = ""
    repeated: str = ""


def pattern_texts(model: Model, indent: str) -> list[PatternText]:
    """The patterns of a model: mass, jacobian, marker_NAME, in a scene also those of constraints and outputs."""
    matrices = [("mass", "M"), (JACOBIAN, "jac"), *((f"marker_{m.name}", "jacobian") for m in model.markers)]
    matrices += [("constraint_jacobian", "G"), (f"{JACOBIAN}_ggl", "jac"), (f"{JACOBIAN}_index1", "jac")]
    matrices += [("outputs_jacobian", "jac"), (PARAMETER_JACOBIAN, "jac")]
    matrices += [(f"marker_{of.name}", "jacobian") for of in model.marker_classes]
    matrices += [("centre_of_mass", "jacobian"), ("centroidal_momentum", "A")]
    matrices += [(f"{name}_jacobian", "jac") for name in OF_MODELS]
    matrices += [(f"rotation_{m.name}", "jacobian") for m in model.markers]
    matrices += [(f"jacobian_of_rotation_{m.name}", "jac") for m in model.markers]
    present = {kernel.name for kernel in model.kernels}
    patterns = [(kernel, model.pattern(kernel, output)) for kernel, output in matrices if kernel in present]

    def text(name: str, p: Pattern) -> PatternText:
        if p.groups:
            return PatternText(name, p, fill=_fill(p), groups=_groups(p, indent))
        if model.lowering == "instances" and p.cols:  # there are none without parameters and inputs
            numbers = tuple(number for columns in repeated_columns(p) for number in columns.numbers)
            return PatternText(name, p, repeated=integer_lines(numbers, indent))
        return PatternText(name, p, integer_lines(p.colptr, indent), integer_lines(p.rowidx, indent))

    return [text(name, p) for name, p in patterns]


def integer_lines(values: Iterable[int], indent: str) -> str:
    """Integers, separated by commas, on indented lines."""
    return "\n".join(prefixed([", ".join(map(str, values))], indent))


def _fill(pattern: Pattern) -> str:
    """Loops that write the compressed columns of groups, in C."""
    lines = ["    int n = 0;", "    *colptr++ = 0;"]
    for group in pattern.groups:
        lines.append(f"    for (int j = 0; j < {group.count}; j++) {{")
        for piece in group.pieces:
            rows = f"i < {piece.count}; i++) rowidx[n++] = {piece.first} + i;"
            match piece.kind:
                case RowSetKind.ROW:
                    lines.append(f"        rowidx[n++] = {piece.first};")
                case RowSetKind.DIAGONAL:
                    lines.append(f"        rowidx[n++] = {piece.first} + j;")
                case RowSetKind.RANGE:
                    lines.append(f"        for (int i = 0; {rows}")
                case RowSetKind.TRIANGLE:
                    lines.append(f"        for (int i = j; {rows}")
                case _:
                    assert_never(piece.kind)
        lines += ["        *colptr++ = n;", "    }"]
    return "\n".join(lines)


def _groups(pattern: Pattern, indent: str) -> str:
    """The groups of columns as nested tuples, in Python."""
    lines = []
    for group in pattern.groups:
        pieces = "".join(f'("{p.kind.value}", {p.first}, {p.count}), ' for p in group.pieces)
        lines.append(f"{indent}({group.count}, ({pieces.rstrip()})),")
    return "\n".join(lines)


@dataclass(frozen=True)
class ModelText:
    """Lines that describe a model: state, parameters, constants, the mass matrix and its zeros."""

    title: str
    frame_doc: str
    choice: str
    state: tuple[str, ...]
    velocities: tuple[str, ...]
    parameters: tuple[str, ...]
    constants: tuple[str, ...]
    picture: tuple[str, ...]
    zeros: tuple[str, ...]
    vanished: tuple[str, ...]
    bodies: tuple[str, ...]
    multipliers: tuple[str, ...]
    eliminated: tuple[str, ...]


def model_text(model: Model) -> ModelText:
    """The description of a model."""
    names = [row.name for row in model.equations]
    coordinates, velocities, equations = (
        _listed(of, model.lowering == "instances") for of in (model.coordinates, model.velocities, model.equations)
    )
    width = max(len(q.name) for q in coordinates)
    mass = model.pattern("mass", "M")
    return ModelText(
        title=f"{model.name}: {model.doc}",
        frame_doc=model.frame_doc,
        choice=f"Kernels are {model.choice}." if model.choice else "",
        state=tuple(f"{q.where}  {q.name:<{width}}  [{q.unit}]  {q.doc}{q.range}" for q in coordinates),
        velocities=tuple(
            f"{v.where}  {v.name}  [{v.unit}]  {v.doc}; equation {row.name} [{row.unit}]{v.range}"
            for v, row in zip(velocities, equations, strict=True)
        ),
        parameters=tuple(
            f"{p.name}  [{p.unit}]  {p.doc}, {f'{p.size} values' if p.size > 1 else f'default {p.default!r}'}"
            for p in model.parameters
        )
        or ("none: every number of the specification is folded into the code",),
        constants=tuple(
            f"{c.name}{f'  [{c.unit}]' if c.unit else ''}  {c.doc}{f', {c.size} values' if c.size > 1 else ''}"
            for c in model.constants
        )
        or ("none",),
        picture=_picture(mass, names),
        zeros=_by_reason(model.zeros),
        vanished=_by_reason(model.vanished),
        bodies=model.bodies,
        multipliers=tuple(
            f"{m.where}  {m.name}  [{m.unit}]  {m.doc}{m.range}"
            for m in _listed(model.multipliers, model.lowering == "instances")
        ),
        eliminated=tuple(f"{out.what}: {out.reason}" for out in model.eliminated),
    )


@dataclass(frozen=True)
class ListedVariable:
    """A line about a variable: its index, or that for instance i of a series, which `range` names."""

    where: str
    name: str
    unit: str
    doc: str
    range: str = ""


def _listed(variables: tuple[Variable, ...], by_series: bool) -> list[ListedVariable]:
    """The lines about variables; `by_series`: one for all instances of a table."""
    if not by_series:
        return list(_each(0, variables))
    lines: list[ListedVariable] = []
    first = 0
    for series in variable_series(variables):
        if series.table:
            step = len(series.labels)
            instances = f"i = {series.first} .. {series.first + series.count - 1}"
            for k, label in enumerate(series.labels, first - series.first * step):
                name = joined(instance_name(series.table, "i"), label.name)
                lines.append(ListedVariable(affine(k, step), name, label.unit, label.doc, f"; {instances}"))
        else:
            lines += _each(first, series.labels)
        first += series.size
    return lines


def affine(first: int, step: int, variable: str = "i") -> str:
    """first + step * variable as text."""
    product = variable if step == 1 else f"{step} * {variable}"
    return f"{product} + {first}" if first > 0 else product if first == 0 else f"{product} - {-first}"


def _each(first: int, variables: tuple[Variable, ...]) -> Iterator[ListedVariable]:
    """Variables with their indices: 3, or 7 .. 14 for an array."""
    for v in variables:
        where = str(first) if v.size == 1 else f"{first} .. {first + v.size - 1}"
        yield ListedVariable(where, v.name, v.unit, v.doc)
        first += v.size


def description(text: ModelText) -> tuple[Prose, ...]:
    """The lines at the head of a generated file."""

    def block(title: str, lines: tuple[str, ...]) -> tuple[Prose, ...]:
        return ("", title, *map(Item, lines))

    law = (
        (
            "Equations of motion M(q) vdot + h(t, q, v) = G^T lambda with constraints g(t, q) = 0, G = dg/dq,",
            "G vdot = gamma, from x = c + Q (X + u) and d'Alembert's virtual",
        )
        if text.bodies
        else ("Equations of motion M(q) vdot + h(t, q, v) = 0, from x = c + Q (X + u) and d'Alembert's virtual",)
    )
    return (
        text.title,
        "",
        *law,
        "work: (15) of Koppens, Sauren, Veldpaus & van Campen, J. Appl. Mech. 55 (1988) 676-680, whose",
        "equation numbers these are. Units are SI where the parameters are; any consistent set will do.",
        "",
        "The floating frame has its origin at c and the rotation Q. r = X + u, the shape functions Phi_i,",
        "and their moments c1 .. c8, d1, D2, d3, J are resolved in the floating frame; c, momenta and",
        "markers are resolved in the inertial frame.",
        *(text.frame_doc.splitlines()),
        *((text.choice,) if text.choice else ()),
        *block("Generalised coordinates q:", text.state),
        *block("Generalised velocities v, and the equations of motion with their units:", text.velocities),
        *(
            block("Multipliers lambda, the constraint reactions on body 2 of each joint:", text.multipliers)
            if text.multipliers
            else ()
        ),
        *(
            block("Eliminated coordinates and constraints, with the reasons:", text.eliminated)
            if text.eliminated
            else ()
        ),
        *block("Parameters p:", text.parameters),
        *block("Constants k, computed from the parameters by setup:", text.constants),
        *block("Mass matrix (x: structural non-zero, .: structural zero):", text.picture),
        *block("Reasons for its structural zeros:", text.zeros),
        *block("Terms of (15) that vanish:", text.vanished),
    )


def section_text(section: Section) -> str:
    """The line above a section of a function."""
    source = section.equation
    text = f"({source})" if isinstance(source, Source) else source
    return f"{section.name} {text}: {section.doc}" if text else f"{section.name}: {section.doc}"


def _by_reason(zeros: tuple[Zero, ...]) -> tuple[str, ...]:
    """The structural zeros as lines of text, one for each reason."""
    gathered: dict[str, list[str]] = {}
    for zero in zeros:
        gathered.setdefault(zero.reason, []).append(zero.what)
    return tuple(f"{', '.join(whats)}: {reason}" for reason, whats in gathered.items()) or ("none",)


def _picture(pattern: Pattern, names: list[str]) -> tuple[str, ...]:
    """The pattern of a symmetric matrix with named rows; of many shapes the first and the last."""
    if len(names) < pattern.rows:
        return _blocks(pattern, names)
    if len(names) > MOST_ROWS:
        names = []
    present = {*pattern.entries, *((j, i) for i, j in pattern.entries)} if names else set()
    width = max(map(len, names), default=0)
    rows = (
        f"{name:<{width}}  " + " ".join("x" if (i, j) in present else "." for j in range(pattern.cols))
        for i, name in enumerate(names)
    )
    count = f"{pattern.full_nnz} of {pattern.rows * pattern.cols} entries are structural non-zeros"
    return (*rows, f"{count}; the {len(pattern.rowidx)} of the lower triangle are stored")


def _blocks(pattern: Pattern, names: list[str]) -> tuple[str, ...]:
    """The pattern where the last name stands for the rows of all shapes, of which the first and the last are shown."""
    rigid = len(names) - 1
    kept = [*range(rigid), *([rigid, pattern.rows - 1] if pattern.rows - rigid > 1 else [rigid])]
    present = set(pattern.entries) | {(j, i) for i, j in pattern.entries}
    labels = [*names[:rigid], f"{names[-1]}1", f"{names[-1]}{pattern.rows - rigid}"][: len(kept)]
    width = max(map(len, labels))
    rows = (
        f"{label:<{width}}  " + " ".join("x" if (i, j) in present else "." for j in kept)
        for label, i in zip(labels, kept, strict=True)
    )
    count = f"{pattern.full_nnz} of {pattern.rows * pattern.cols} entries are structural non-zeros"
    return (
        *rows,
        "(the first and the last mode are shown)",
        f"{count}; the {len(pattern.rowidx)} of the lower triangle",
    )


def kernel_text(kernel: Kernel) -> tuple[str, ...]:
    """The documentation of a function: purpose, arguments, outputs, equations, and operations."""
    lines = [kernel.doc, ""]
    lines += [f"{a.name}: {_argument(a)}" for a in kernel.arguments]
    for output in kernel.outputs:
        lines += [f"{output.name}: {_output(output)}"]
    sources = dict.fromkeys(s.equation for s in kernel.sections if s.equation)
    lines += ["", f"From {', '.join(sources)}." if sources else "", f"{kernel.operations} operations."]
    return tuple(line for k, line in enumerate(lines) if line or (k and lines[k - 1]))


def _argument(argument: Argument) -> str:
    if argument.scalar:
        return argument.doc
    return f"{argument.doc} ({argument.size})"


def _output(output: Output) -> str:
    match output.kind:
        case OutputKind.NAMED | OutputKind.COUNTED:
            return f"{output.doc} ({output.size}): {', '.join(output.elements)}"
        case OutputKind.MATRIX:
            pattern = output.pattern
            assert pattern is not None
            symmetric = f", {pattern.full_nnz} in both triangles" if pattern.symmetric else ""
            return f"{output.doc}, {pattern.rows} x {pattern.cols}, {output.size} values{symmetric}"
        case _:
            assert_never(output.kind)
