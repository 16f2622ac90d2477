"""The compliance W^T D^-1 W of constraints in M = L D L^T, from the columns W = L^-1 G^T."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, reduce

import casadi as ca

from derive.ir.patterns import pattern
from derive.lowering.flat.casadi_symbols import added, multiplied, subtracted
from derive.lowering.flat.trees.other_bodies import Column
from derive.lowering.ldlt import Entries, Factorisation, factorise
from derive.lowering.vectors import ZERO


@dataclass(frozen=True)
class Compliance:
    """Columns W of constraints, and the inverse pivots of M by row."""

    columns: Sequence[Column]
    inverses: Column

    @cached_property
    def _scaled(self) -> list[Column]:
        return [
            {row: multiplied(x, self.inverses[row]) for row, x in of.items() if not x.is_zero()} for of in self.columns
        ]

    @cached_property
    def factors(self) -> Factorisation:
        """The factors of the compliance."""
        columns, scaled = self.columns, self._scaled
        entries: Entries = {
            (i, j): _product(scaled[i], columns[j])
            for i in range(len(columns))
            for j in range(i + 1)
            if i == j or any(not columns[j].get(row, ZERO).is_zero() for row in scaled[i])
        }
        return factorise(pattern(len(columns), len(columns), set(entries), symmetric=True), entries)

    def lacking(self, bias: Sequence[ca.SX], rests: Column) -> list[ca.SX]:
        """gamma - W^T D^-1 rests: what accelerations without multipliers lack. bias: gamma; rests: L^-1 (-h)."""
        return [subtracted(gamma, _product(of, rests)) for gamma, of in zip(bias, self._scaled, strict=True)]


def with_reactions(rests: Column, columns: Sequence[Column], multipliers: Sequence[ca.SX]) -> dict[int, ca.SX]:
    """rests + W lambda."""
    result = dict(rests)
    for column, force in zip(columns, multipliers, strict=True):
        for row, x in column.items():
            result[row] = added(result[row], multiplied(x, force))
    return result


def _product(a: Column, b: Column) -> ca.SX:
    return reduce(added, (multiplied(x, b[row]) for row, x in a.items() if row in b), ZERO)
