"""The coordinates, generalised velocities, parameters and constants of a model."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from derive.algebra import sp
from derive.ir.model import Model, Variable
from derive.ir.series import variable_series
from derive.mechanics.equations import Equations
from derive.mechanics.symbols import I, Identity, amplitude, identity, owned
from derive.report.document.formula import Formula
from derive.report.document.page import Block, CodeSpan, Content, Details, Heading, Paragraph, folded, table
from derive.report.notation.expressions import Notation
from derive.report.notation.families import written
from derive.report.notation.integral_formulas import unit
from derive.report.notation.typeset_names import chosen
from derive.roles import Role
from derive.spec.model.instances import identifier, instance_name, instance_parts

HEAD = ("", "in the code", "unit", "meaning")


def state_blocks(model: Model, equations: Equations, notation: Notation) -> tuple[Block, ...]:
    """The numbers and the tables of the coordinates, generalised velocities, parameters and constants of a model."""
    text = f"{size(model.coordinates)} coordinates q, {size(model.velocities)} generalised velocities v"
    count = size(model.parameters)
    end = f", and {count} parameter{'' if count == 1 else 's'}." if count else ". Every number is folded into the code."
    coordinates = table(
        "Coordinates q", HEAD, _rows(model, model.coordinates, (c.q for c in equations.coordinates), amplitude(I))
    )
    velocities = table(
        "Generalised velocities v", HEAD, _rows(model, model.velocities, (r.v for r in equations.rows), amplitude(I, 1))
    )
    derivatives = "The generalised velocities are the time derivatives of the coordinates, in the same order."
    result: list[Block] = [
        Heading("Coordinates and parameters", "coordinates"),
        Paragraph((text + end,)),
        folded(coordinates, "Coordinates"),
        folded(velocities, "Generalised velocities") if _is_spatial(model) else Paragraph((derivatives,)),
    ]
    if model.parameters:
        given = [[*_row(p, _parameter(p, notation)), _default(p)] for p in model.parameters]
        result.append(folded(table("Parameters", (*HEAD, "default"), given, "llllr"), "Parameters"))
    for title, ports in (("Inputs u", model.inputs), ("Outputs", model.outputs)):
        if ports:
            listed: list[list[Content]] = [[CodeSpan(code), unit(v.unit), v.doc] for v, code, _ in _once(model, ports)]
            result.append(folded(table(title, HEAD[1:], listed), title))
    if model.choice:
        result.append(Paragraph((f"The functions are {model.choice}.",)))
    if model.constants:
        made: list[list[Content]] = [[CodeSpan(c.name), unit(c.unit), c.doc, c.size] for c in model.constants]
        whole = table("", ("in the code", "unit", "meaning", "values"), made, "lllr")
        summary = f"The {len(made)} constants k that setup computes from the parameters"
        result.append(Details(summary, (folded(whole, "Constants"),)))
    return tuple(result)


def _is_spatial(model: Model) -> bool:
    """Whether the generalised velocities are not the time derivatives of the coordinates."""
    return any(q.role is Role.QUATERNION for q in model.coordinates)


def _rows(
    model: Model, variables: Sequence[Variable], symbols: Iterable[sp.Symbol], whole: sp.Symbol
) -> list[list[Content]]:
    """The rows of a table of coordinates or velocities; `whole` is the symbol of the array over all modes."""
    by_name = {symbol.name: symbol for symbol in symbols}
    rows = []
    for variable, code, first in _once(model, variables):
        symbol = by_name.get(first.name, whole)
        if variable is not first:
            symbol = owned(symbol, instance_name(instance_parts(identity(symbol).owner).table, "i"))
        rows.append(_row(variable, written(symbol).formula, code))
    return rows


def _once(model: Model, variables: Sequence[Variable]) -> Iterator[tuple[Variable, str, Variable]]:
    """Variables, those of instances of a table with their index i once; their names in the code; the first of each."""
    number = 0
    for series in variable_series(variables):
        own = variables[number : number + len(series.labels)]
        number += series.size
        for label, first in zip(series.labels, own, strict=True):
            if not series.table:
                yield first, first.name, first
                continue
            looped = f"{identifier(series.table, label.name)}(i)"
            code = looped if model.lowering == "instances" else identifier(instance_name(series.table, "i"), label.name)
            last = series.first + series.count - 1
            yield replace(label, doc=f"{label.doc}; i = {series.first} to {last}"), code, first


def _row(variable: Variable, formula: Formula, code: str = "") -> list[Content]:
    values = f" ({variable.size} values)" if variable.size > 1 else ""
    return [formula, CodeSpan(code or variable.name), unit(variable.unit), (variable.doc, values)]


def _parameter(variable: Variable, notation: Notation) -> Formula:
    """A parameter: an integral that is given at run time, or a name that the specification chose."""
    by_name = {_without_mark(s).name: s for s in notation.constants}
    symbol = by_name.get(variable.name)
    return notation.formula(symbol) if symbol is not None else chosen(variable.name)


def _without_mark(symbol: sp.Symbol) -> Identity:
    """A parameter under the name that it has in the interface."""
    return replace(identity(symbol), parameter=False)


def _default(variable: Variable) -> str:
    return "" if variable.size > 1 else f"{variable.default:g}"


def size(variables: Iterable[Variable]) -> int:
    """The number of values of some variables."""
    return sum(v.size for v in variables)
