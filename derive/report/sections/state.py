"""The coordinates, generalised velocities, parameters and constants of a model."""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp

from derive.ir.model import Model, Variable
from derive.report.document.formula import Formula
from derive.report.document.page import Block, Code, Details, Heading, Paragraph
from derive.report.document.tables import Said, folded, table
from derive.report.notation.doc_formulas import doc, unit
from derive.report.notation.expressions import Notation
from derive.report.notation.names import constant, known
from derive.roles import Role

HEAD = ("", "in the code", "unit", "what it is")


def state_blocks(model: Model, notation: Notation) -> tuple[Block, ...]:
    """How many of each there are, and what they are."""
    text = f"{size(model.coordinates)} coordinates q, {size(model.rates)} generalised velocities v"
    count = size(model.parameters)
    end = f", and {count} parameter{'' if count == 1 else 's'}." if count else "; every number is folded into the code."
    coordinates = table("Coordinates q", HEAD, [_variable(v, _variable_formula(v)) for v in model.coordinates])
    velocities = table("Generalised velocities v", HEAD, [_variable(v, _variable_formula(v)) for v in model.rates])
    derivatives = "The generalised velocities are the time derivatives of the coordinates, in the same order."
    found: list[Block] = [
        Heading("Coordinates and parameters", "coordinates"),
        Paragraph((text + end,)),
        folded(coordinates, "Coordinates"),
        folded(velocities, "Generalised velocities") if _is_spatial(model) else Paragraph((derivatives,)),
    ]
    if model.parameters:
        given = [[*_variable(p, _parameter(p, notation)), _default(p)] for p in model.parameters]
        found.append(folded(table("Parameters", (*HEAD, "default"), given, "llllr"), "Parameters"))
    if model.choice:
        found.append(Paragraph((f"The functions are {model.choice}.",)))
    if model.constants:
        made: list[list[Said]] = [[Code(c.name), unit(c.unit), c.doc, c.size] for c in model.constants]
        whole = table("", ("in the code", "unit", "what it is", "values"), made, "lllr")
        summary = f"Constants k, made of the parameters by setup: {len(made)}"
        found.append(Details(summary, (folded(whole, "Constants"),)))
    return tuple(found)


def _is_spatial(model: Model) -> bool:
    """Whether the generalised velocities are not the time derivatives of the coordinates."""
    return any(q.role is Role.QUATERNION for q in model.coordinates)


def _variable(variable: Variable, formula: Formula) -> list[Said]:
    values = f" ({variable.size} values)" if variable.size > 1 else ""
    return [formula, Code(variable.name), unit(variable.unit), (*doc(variable.doc), values)]


def _variable_formula(variable: Variable) -> Formula:
    """A coordinate or velocity, of an array its element i."""
    entry = known(f"{variable.name}_i" if variable.name in ("alpha", "alphadot") else variable.name)
    return entry.formula if entry else constant(variable.name)


def _parameter(variable: Variable, notation: Notation) -> Formula:
    symbol = next((s for s in notation.constants if s.name == variable.name), sp.Symbol(variable.name))
    return notation.formula(symbol)


def _default(variable: Variable) -> str:
    return "" if variable.size > 1 else f"{variable.default:g}"


def size(variables: Iterable[Variable]) -> int:
    """How many values some variables are."""
    return sum(v.size for v in variables)
