"""Expressions of the derivation in plain SymPy symbols, as the paper and a derivation of one's own write them."""

from __future__ import annotations

from typing import Any

import sympy as sp

from derive.mechanics.typed_symbol import Symbol


def plain(of: Any) -> Any:
    """An expression, a matrix or a tuple of them, with a plain symbol of the same name for each typed one.

    Plain symbols have no assumptions. Two different symbols with one name would become one and hide a confusion of
    the derivation: that is an AssertionError.
    """
    if isinstance(of, tuple | list):
        return type(of)(plain(entry) for entry in of)
    symbols = of.free_symbols
    names = {symbol.name for symbol in symbols}
    assert len(names) == len(symbols), f"two symbols with one name: {sorted(symbols, key=str)}"
    return of.xreplace({symbol: sp.Symbol(symbol.name) for symbol in symbols if isinstance(symbol, Symbol)})


def vector(name: str) -> sp.Matrix:
    """A vector in space of plain symbols: name_1, name_2, name_3."""
    return sp.Matrix([sp.Symbol(f"{name}_{k}") for k in (1, 2, 3)])
