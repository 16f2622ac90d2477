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
from derive.lowering.flat.trees.spatial_vectors import times, transposed
from derive.lowering.ldlt import Factorisation, factorise
from derive.lowering.vectors import ZERO, Matrix
from derive.mechanics.terms import Constraint, OwnAxes

Column = Mapping[int, ca.SX]
"""The entries of a vector that differ from zero, by row."""


Triple = tuple[int, int, int]


@dataclass(frozen=True)
class OtherBodies:
    """The rows of bodies beside trees, and the factors of their block of M with places in `rows` as indices.

    turned: the rotation tensors of bodies in the mean frame, by the rows of their translations. These couple to no
    other rows, so that they may be along any axes: they are taken along those of the body.
    """

    rows: Sequence[int]
    factors: Factorisation
    turned: Mapping[Triple, Matrix]

    @cached_property
    def inverses(self) -> dict[int, ca.SX]:
        """The inverse pivots by row."""
        return {self.rows[j]: of for j, of in zip(self.factors.order, self.factors.inverses, strict=True)}

    def along_own_axes(self, right: Column) -> dict[int, ca.SX]:
        """A right-hand side with translations along the axes of bodies."""
        return self._changed(right, {rows: transposed(Q) for rows, Q in self.turned.items()})

    def _changed(self, values: Column, by: Mapping[Triple, Matrix]) -> dict[int, ca.SX]:
        result = dict(values)
        for rows, matrix in by.items():
            result |= dict(zip(rows, times(matrix, [values[row] for row in rows]), strict=True))
        return result

    def forward(self, right: Column) -> dict[int, ca.SX]:
        """L^-1 right."""
        x = dict(right)
        for j in self.factors.order:
            if (row := self.rows[j]) in x:
                for i, entry in self.factors.lower[j]:
                    x[self.rows[i]] = subtracted(x.get(self.rows[i], ZERO), multiplied(entry, x[row]))
        return x

    def backward(self, rests: Column) -> dict[int, ca.SX]:
        """The accelerations L^-T D^-1 rests, with inertial translations."""
        x = {row: multiplied(rests[row], self.inverses[row]) for row in self.rows}
        for j in reversed(self.factors.order):
            for i, entry in reversed(self.factors.lower[j]):
                x[self.rows[j]] = subtracted(x[self.rows[j]], multiplied(entry, x[self.rows[i]]))
        return self._changed(x, self.turned)


def other_bodies(context: Context, symbols: Symbols, rows: Sequence[int]) -> OtherBodies:
    """The bodies with these rows."""
    place = {row: k for k, row in enumerate(rows)}
    shape = [(i, j) for i, j in context.mass_pattern().entries if i in place]
    entries = {(place[i], place[j]): symbols(context.equations.mass[i, j]) for i, j in shape}
    coupled = {row for i, j in shape if i != j for row in (i, j)}
    turned = {}
    for c in context.equations.constraints:
        for frame in (c.frames.first, c.frames.second) if c.frames else ():
            if frame.own is not None and not coupled & {*(translations := rigid_rows(context, frame.own))}:
                turned[translations] = tensor(symbols, frame.own)
    factors = factorise(pattern(len(rows), len(rows), set(entries), symmetric=True), entries)
    return OtherBodies(rows, factors, turned)


def rigid_rows(context: Context, of: OwnAxes) -> Triple:
    """The rows of the translations of a body that keeps all coordinates."""
    numbers = {name: n for n, name in enumerate(context.rows)}
    a, b, c = (numbers[row] for row, _ in of.work[:3])
    return a, b, c


def tensor(symbols: Symbols, of: OwnAxes) -> Matrix:
    """The rotation tensor of a body that keeps all coordinates."""
    return [[symbols(of.Q[i, j]) for j in range(3)] for i in range(3)]


@dataclass(frozen=True)
class TreeLeaf:
    """Bodies that hang on one body of a tree, `carrier`, and on nothing else, with their rows and constraints."""

    carrier: str
    rows: frozenset[int]
    constraints: tuple[int, ...]


def leaves(context: Context, rows: Sequence[int]) -> list[TreeLeaf]:
    """The bodies with these rows that hang on one body of a tree alone.

    They keep all motions of free bodies: multipliers that exert nothing on them as a whole exert nothing on that body
    either, so that their compliance is regular wherever the constraints of the scene are independent.
    """
    result = []
    for component in _components(context, rows):
        own = {context.rows[row] for row in component}
        conditions = [
            (n, c) for n, c in enumerate(context.equations.constraints) if any(r in own for r, _ in c.jacobian)
        ]
        carriers = {of for _, c in conditions for of in _carriers(c)}
        if len(carriers) == 1 and None not in carriers:
            (carrier,) = carriers
            result.append(TreeLeaf(str(carrier), frozenset(component), tuple(n for n, _ in conditions)))
    return result


def _carriers(c: Constraint) -> set[str | None]:
    """The bodies of trees that a constraint joins to bodies that keep all coordinates; None for anything else."""
    if c.frames is None:
        return {None}
    return {frame.carrier or None for frame in (c.frames.first, c.frames.second) if not frame.own}


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
