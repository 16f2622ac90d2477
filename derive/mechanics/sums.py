"""Sums over the shapes that equations of motion keep: what loops compute."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from derive.mechanics.symbols import Symbol


@dataclass(frozen=True)
class Contraction:
    """symbol_i = base + sum over j of factor_j table_i_j; `sums` are pairs (factor, table entry)."""

    symbol: Symbol
    base: sp.Expr
    sums: tuple[tuple[Symbol, Symbol], ...]
    doc: str


@dataclass(frozen=True)
class Total:
    """symbol = base + sum over i of term, which is an expression of index i."""

    symbol: Symbol
    base: sp.Expr
    term: sp.Expr
    doc: str
