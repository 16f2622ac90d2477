"""The damping of a rod in several components, from the entries of its matrix."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

from derive.mechanics.multibody.bodies.body_type import ComponentDamping
from derive.mechanics.symbols import owned
from derive.mechanics.terms import ModelConstant

if TYPE_CHECKING:
    from derive.algebra import sp


def shared_damping(rod: str, components: tuple[str, ...], entries: Iterable[ModelConstant]) -> ComponentDamping:
    """The damping of a rod in several components by the entries of its matrix; equal entries share a constant."""
    symbols: dict[tuple[int, int], sp.Symbol] = {}
    constants: dict[sp.Expr, ModelConstant] = {}
    for c in (c for c in entries if not c.zero):
        i, j = c.symbol.identity.shapes
        doc = f"damping of amplitudes {i} and {j} of {rod}, counted through its pieces; also of equal entries"
        entry = replace(c, symbol=owned(c.symbol, rod), doc=doc)
        symbols[i, j] = constants.setdefault(c.value, entry).symbol
    return ComponentDamping(components, symbols, tuple(constants.values()))
