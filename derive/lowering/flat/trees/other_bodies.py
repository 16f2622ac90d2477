"""The bodies beside trees: the factors of their block of M, and which of them hang on one body of a tree alone.

Their accelerations are eliminated first. The amplitudes of a flexible body in the mean frame come before its rotation,
each with a constant pivot, so that what is left of a joint are few rows: its compliance G M^-1 G^T.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from derive.ir.patterns import pattern
from derive.lowering.flat.casadi_symbols import Symbols, multiplied, subtracted
from derive.lowering.flat.context import Context
from derive.lowering.flat.trees.spatial_vectors import ZERO
from derive.lowering.ldlt import Factorisation, factorise
from derive.mechanics.symbols import Family, identity
from derive.mechanics.terms import Constraint

Column = Mapping[int, ca.SX]
"""The entries of a vector that differ from zero, by row."""


@dataclass(frozen=True)
class OtherBodies:
    """The rows of bodies beside trees, and the factors L D L^T of their block of M, whose indices are places in `rows`."""

    rows: Sequence[int]
    factors: Factorisation

    @cached_property
    def inverses(self) -> dict[int, ca.SX]:
        """The inverse pivots by row."""
        return {self.rows[j]: of for j, of in zip(self.factors.order, self.factors.inverses, strict=True)}

    def forward(self, right: Column) -> dict[int, ca.SX]:
        """L^-1 right."""
        x = dict(right)
        for j in self.factors.order:
            known = x.get(self.rows[j])
            for i, entry in self.factors.lower[j] if known is not None else ():
                x[self.rows[i]] = subtracted(x.get(self.rows[i], ZERO), multiplied(entry, known))
        return x

    def backward(self, rests: Column) -> dict[int, ca.SX]:
        """L^-T D^-1 rests: the accelerations."""
        x = {row: multiplied(rests[row], self.inverses[row]) for row in self.rows}
        for j in reversed(self.factors.order):
            for i, entry in reversed(self.factors.lower[j]):
                x[self.rows[j]] = subtracted(x[self.rows[j]], multiplied(entry, x[self.rows[i]]))
        return x


def other_bodies(context: Context, symbols: Symbols, rows: Sequence[int]) -> OtherBodies:
    """The bodies with these rows."""
    place = {row: k for k, row in enumerate(rows)}
    entries = {
        (place[i], place[j]): symbols(context.equations.mass[i, j])
        for i, j in context.mass_pattern().entries
        if i in place
    }
    return OtherBodies(rows, factorise(pattern(len(rows), len(rows), set(entries), symmetric=True), entries))


@dataclass(frozen=True)
class Leaf:
    """Bodies that hang on one body of a tree, `carrier`, and on nothing else, with their rows and constraints."""

    carrier: str
    rows: frozenset[int]
    constraints: tuple[int, ...]


def leaves(context: Context, rows: Sequence[int]) -> list[Leaf]:
    """The bodies with these rows that hang on one body of a tree alone.

    They keep all motions of a free body. Multipliers that no combination of their rows opposes would then exert no force
    on that body either, so that their compliance is regular wherever the constraints of the scene are independent.
    """
    result = []
    for component in _components(context, rows):
        own = {context.rows[row] for row in component}
        conditions = [
            (n, c) for n, c in enumerate(context.equations.constraints) if any(r in own for r, _ in c.jacobian)
        ]
        carriers = {of for _, c in conditions for of in _carriers(c, own)}
        if len(carriers) == 1 and None not in carriers and _are_free(context, component):
            (carrier,) = carriers
            result.append(Leaf(str(carrier), frozenset(component), tuple(n for n, _ in conditions)))
    return result


def _carriers(c: Constraint, own: set[str]) -> set[str | None]:
    """The bodies of trees that a constraint joins to bodies with the rows `own`; None for anything else."""
    if c.frames is None:
        return {None}
    frames = [f for f in (c.frames.first, c.frames.second) if not (f.work and {row for row, _ in f.work} <= own)]
    return {frame.carrier or None for frame in frames}


def _are_free(context: Context, component: Sequence[int]) -> bool:
    """Whether bodies keep all coordinates of free bodies."""
    counts: dict[str, list[Family]] = {}
    for row in component:
        of = identity(context.equations.rows[row].v)
        counts.setdefault(of.owner, []).append(of.family)
    rigid = (Family.TRANSLATION, Family.ANGULAR_VELOCITY)
    return all(families.count(of) == 3 for families in counts.values() for of in rigid)


def _components(context: Context, rows: Sequence[int]) -> list[list[int]]:
    """The sets of rows that M or constraints connect."""
    number = {name: n for n, name in enumerate(context.rows)}
    groups = [{i, j} for i, j in context.mass_pattern().entries]
    groups += [{number[row] for row, _ in c.jacobian} for c in context.equations.constraints]
    parts = [{row} for row in rows]
    for group in groups:
        touched = [part for part in parts if part & group]
        if len(touched) > 1:
            parts = [part for part in parts if part not in touched] + [set().union(*touched)]
    return [sorted(part) for part in parts]
