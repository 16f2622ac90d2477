"""Sums over the shapes, once for a generic index: what loops are made of, and what is written out for each shape.

A name is that of a moment with its indices: `S_i_11` is the entry 11 of S_i. The indices i and j run over the shapes;
`C5_i_j_11` is a table, and so is `c7_i_j_1`, which is odd in i and j.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp

PARITY = {"C5": 1, "c7": -1, "c8": 1, "K": 1, "B": 1}
"""What an exchange of i and j does to a table; its entries have names for i <= j alone."""

ALPHA, ALPHADOT, ALPHADDOT = "alpha", "alphadot", "alphaddot"


@dataclass(frozen=True)
class Series:
    """name = base + sum over j of factor_j entry_j; the factors are alpha, alphadot or alphaddot."""

    name: str
    base: str | None
    sums: tuple[tuple[str, str], ...]
    doc: str

    @property
    def section(self) -> str:
        """The moment without its indices."""
        return family(self.name)

    @property
    def indexed(self) -> bool:
        """Whether there is one for each shape i."""
        return "i" in self.name.split("_")


def swapped(entry: str) -> str:
    """A table's entry with i and j exchanged."""
    return "_".join({"i": "j", "j": "i"}.get(part, part) for part in entry.split("_"))


def canonical(entry: str) -> str:
    """A table's entry with its indices in the order i, j."""
    parts = entry.split("_")
    return entry if parts.index("i") < parts.index("j") else swapped(entry)


def family(name: str) -> str:
    """The moment or table that a name is an entry of."""
    return name.split("_", maxsplit=1)[0]


def at(name: str, i: int, j: int = 0) -> sp.Expr:
    """A generic name for shapes i and j."""
    parts = name.split("_")
    if not {"i", "j"} <= set(parts):
        index = {"i": str(i), "j": str(j)}
        return sp.Symbol("_".join(index.get(p, p) for p in parts))
    parity = PARITY[parts[0]]
    first, second = (i, j) if parts.index("i") < parts.index("j") else (j, i)
    if first == second and parity < 0:
        return sp.S.Zero
    low, high = sorted((first, second))
    rest = [p for p in parts[1:] if p not in ("i", "j")]
    sign = parity if first > second else 1
    return sign * sp.Symbol("_".join([parts[0], str(low), str(high), *rest]))


def written_out(series: Series, i: int, vectors: dict[str, Sequence[sp.Symbol]]) -> sp.Expr:
    """The sum for shape i, entry by entry."""
    total = at(series.base, i) if series.base else sp.S.Zero
    for factor, entry in series.sums:
        total += sp.Add(*(a * at(entry, i, j) for j, a in enumerate(vectors[factor], 1)))
    return total
