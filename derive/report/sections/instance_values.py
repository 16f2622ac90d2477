"""The values of constants in which bodies differ whose equations are shown once: a table of these bodies."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from derive.algebra import sp
from derive.mechanics.symbols import identity, owned
from derive.report.document.page import Block, Content, Math, Paragraph, folded, table
from derive.report.notation.expressions import Notation
from derive.report.notation.integral_formulas import unit
from derive.report.sections.alike_bodies import EquationsShownOnce
from derive.report.sections.instance_rows import enumeration_of_instances

FEW = 6
"""The most bodies whose values are columns; those of more bodies are rows."""


def value_blocks(once: EquationsShownOnce, notation: Notation) -> tuple[Block, ...]:
    """A table for each group of bodies that are alike, and which of them have the values that are shown."""
    members: dict[str, list[str]] = {}
    for owner, shown in once.owners.items():
        members.setdefault(shown, [])
        if owner != shown:
            members[shown].append(owner)
    return tuple(block for shown, others in members.items() if others for block in _of(shown, others, once, notation))


def _of(shown: str, others: Sequence[str], once: EquationsShownOnce, notation: Notation) -> Iterator[Block]:
    symbols = [symbol for symbol in once.values if identity(symbol).owner == shown]
    differing = [owner for owner in others if any(owner in once.values[symbol] for symbol in symbols)]
    same = [owner for owner in others if owner not in differing]
    if same:
        yield Paragraph((f"The values of {enumeration_of_instances(same)} are those of {shown}.",))
    if not differing:
        return
    owners = [shown, *differing]
    constants = {c.symbol: c for c in once.equations.coefficients}
    values = [
        [notation.formula(_value(symbol, owner, once, constants[symbol].value)) for owner in owners]
        for symbol in symbols
    ]
    names = [Math(notation.formula(owned(symbol, ""))) for symbol in symbols]
    units = [unit(constants[symbol].unit) for symbol in symbols]
    caption = f"Values of {enumeration_of_instances(owners)}, which differ"
    rows: list[list[Content]]
    if len(owners) <= FEW:
        rows = [[name, *each, of] for name, each, of in zip(names, values, units, strict=True)]
        yield folded(table(caption, ("integral", *owners, "unit"), rows, wide=True), caption)
    else:
        head = [
            (name, f", {of}") if isinstance(of, str) and of else (name,) for name, of in zip(names, units, strict=True)
        ]
        rows = [[owner, *(each[k] for each in values)] for k, owner in enumerate(owners)]
        yield folded(table(caption, ("body", *head), rows, wide=True), caption)


def _value(symbol: sp.Symbol, owner: str, once: EquationsShownOnce, shown: sp.Expr) -> sp.Expr:
    other = once.values[symbol].get(owner)
    return shown if other is None else other.value
