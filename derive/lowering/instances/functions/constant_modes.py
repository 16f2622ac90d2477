"""One body with many modes between its joints, where modes are independent and their factors in G are constants' sums.

In the mean frame the modes of a finite-element body are coupled with its rotation alone, and c8 is diagonal. With
G_a = P_a B of each constraint a, in which B has constants of the modes at the markers and P_a few coefficients, its
compliance is P_a (B c8^-1 B^T) P_b^T: the matrix between is constant. The rotation, which is eliminated last, adds a
correction of rank three through B C with C = M between modes and rotation. A translation that moves the markers along
these constants, as it does along the axes of the body, is one mode more of each of them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from derive.algebra import sp
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.instances.classes.mode_factors import FEWEST_MODES, constants_of_modes, mode_coefficients
from derive.lowering.instances.functions.marker_modes import MarkerModes
from derive.lowering.instances.loop_code.class_code import ClassCode
from derive.lowering.ldlt import Factorisation
from derive.mechanics.symbols import Identity, identity

ROTATIONS = 3
"""The most coordinates that may be coupled with the others."""


@dataclass(frozen=True)
class _Row:
    """A constraint: its factors of coordinates without constants of modes, and the coefficients of these constants."""

    factors: dict[int, ca.SX]
    coefficients: dict[Identity, ca.SX]


def elimination_order(of: ClassCode) -> tuple[int, ...] | None:
    """The order of the coordinates of a body: those that are independent of each other first; None if it has none."""
    mass = of.system.equations.mass
    n = range(mass.rows)
    constants = {c.symbol for c in of.system.equations.coefficients}
    coupled = [j for j in n if sum(mass[i, j] != 0 for i in n) > 1 + ROTATIONS or mass[j, j].free_symbols - constants]
    others = [j for j in n if j not in coupled]
    apart = all(mass[i, j] == 0 for i in others for j in others if i != j)
    return (*others, *coupled) if apart and len(coupled) <= ROTATIONS and len(others) >= FEWEST_MODES else None


class ConstantModes:
    """The products of the rows of G of a body with the inverse of its mass matrix, whose factors are given."""

    def __init__(
        self,
        of: ClassCode,
        symbols: Symbols,
        factors: Factorisation,
        rows: Sequence[_Row],
        half_force: Mapping[int, ca.SX],
        in_loop: bool,
        translations: Mapping[Identity, int],
    ) -> None:
        context = of.system
        self.factors, self.rows = factors, rows
        self.inverse = dict(zip(factors.order, factors.inverses, strict=True))
        known = constants_of_modes(c.symbol for c in context.equations.coefficients)
        rows_of = enumerate(context.equations.rows)
        self.modes = {shape: j for j, row in rows_of for shape in identity(row.v).shapes}
        self.labels = [*dict.fromkeys(label for row in rows for label in row.coefficients)]
        self.constants: dict[Identity, dict[int, ca.SX]] = {label: {} for label in self.labels}
        for symbol, label in known.items():
            if label in self.constants:
                (shape,) = identity(symbol).shapes
                self.constants[label][self.modes[shape]] = symbols(symbol)
        shapes = {label: dict(of_modes) for label, of_modes in self.constants.items()}
        for label, j in translations.items():
            self.constants[label][j] = ca.SX(1)
        weighted = {
            label: {j: self.inverse[j] * value for j, value in of_modes.items()}
            for label, of_modes in self.constants.items()
        }
        self.compliances = {
            (a, b): _dot(self.constants[a], weighted[b]) for n, a in enumerate(self.labels) for b in self.labels[n:]
        }
        self.compliances |= {(b, a): value for (a, b), value in self.compliances.items()}
        self.weighted = weighted
        last = factors.order[-ROTATIONS:]
        self.coupled = [j for j in last if any(j == i for of_j in factors.lower.values() for i, _ in of_j)]
        self.half_force = half_force
        self.of_translations = {label: self.inverse[j] * half_force[j] for label, j in translations.items()}
        self.markers: MarkerModes | None = None
        if in_loop:
            self.markers = MarkerModes(of.name, shapes, factors, self.coupled, half_force)
            self.couplings, self.of_labels = self.markers.inputs(symbols)
            for label, value in self.of_translations.items():
                self.of_labels[label] = self.of_labels[label] + value
        else:
            self.couplings = {
                label: {
                    i: _dot(of_modes, {j: dict(factors.lower[j])[i] for j in of_modes if i in dict(factors.lower[j])})
                    for i in self.coupled
                }
                for label, of_modes in self.constants.items()
            }
            self.of_labels = {label: _dot(weights, half_force) for label, weights in weighted.items()}
        self.halves = [self._half(row) for row in rows]

    def _half(self, row: _Row) -> dict[int, ca.SX]:
        """The part of L^-1 G^T of the coordinates that have no constants of modes."""
        x = dict(row.factors)
        for i in self.coupled:
            parts = [c * self.couplings[label][i] for label, c in row.coefficients.items()]
            if parts:
                total = sum(parts[1:], start=parts[0])
                x[i] = x[i] - total if i in x else -total
        for j in self.factors.order:
            if j in x:
                for i, entry in self.factors.lower[j]:
                    x[i] = x[i] - entry * x[j] if i in x else -entry * x[j]
        return x

    def compliance(self, a: int, b: int) -> ca.SX:
        """The entry of G M^-1 G^T of two constraints."""
        total = ca.SX(0)
        for label, factor in self.rows[a].coefficients.items():
            inner = ca.SX(0)
            for other, of_other in self.rows[b].coefficients.items():
                inner = inner + self.compliances[label, other] * of_other
            total = total + factor * inner
        for one, two in ((a, b), (b, a)):  # a row with too many constants for coefficients has plain factors of modes
            for label, factor in self.rows[one].coefficients.items():
                total = total + factor * _dot(self.weighted[label], self.rows[two].factors)
        return total + self.product(self.halves[a], self.halves[b])

    def product(self, a: Mapping[int, ca.SX], b: Mapping[int, ca.SX]) -> ca.SX:
        """The product of two vectors with the inverse of D."""
        total = ca.SX(0)
        for j, value in a.items():
            if j in b:
                total = total + value * (self.inverse[j] * b[j])
        return total

    def floor(self, a: int) -> ca.SX:
        """The diagonal entry of a constraint if all its factors were 1."""
        present = {*self.halves[a]}
        for label in self.rows[a].coefficients:
            present |= {*self.constants[label]}
        return sum((self.inverse[j] for j in self.factors.order if j in present), start=ca.SX(0))

    def motions(self) -> list[ca.SX]:
        """G M^-1 f of each constraint."""
        result = []
        for row, half in zip(self.rows, self.halves, strict=True):
            total = self.product(half, self.half_force)
            for label, factor in row.coefficients.items():
                total = total + factor * self.of_labels[label]
            result.append(total)
        return result

    def loads(self, forces: Sequence[ca.SX], multipliers: Sequence[ca.SX]) -> list[ca.SX]:
        """f + G^T lambda."""
        total = list(forces)
        of_labels: dict[Identity, ca.SX] = {}
        for row, multiplier in zip(self.rows, multipliers, strict=True):
            for j, factor in row.factors.items():
                total[j] = total[j] + factor * multiplier
            for label, factor in row.coefficients.items():
                value = factor * multiplier
                of_labels[label] = of_labels[label] + value if label in of_labels else value
        for label, load in of_labels.items():
            for j, constant in self.constants[label].items():
                total[j] = total[j] + constant * load
        return total


def _dot(a: Mapping[int, ca.SX], b: Mapping[int, ca.SX]) -> ca.SX:
    total: ca.SX | None = None
    for j, value in a.items():
        if j in b:
            total = value * b[j] if total is None else total + value * b[j]
    return ca.SX(0) if total is None else total


def constant_modes(
    of: ClassCode, symbols: Symbols, factors: Factorisation, half_force: Mapping[int, ca.SX], in_loop: bool
) -> ConstantModes | None:
    """The products of a body, or None if the factors of its modes are no sums of constants.

    half_force: L^-1 f; in_loop: whether a loop over the constants of modes adds up their products.
    """
    context = of.system
    constants = constants_of_modes(c.symbol for c in context.equations.coefficients)
    number = {name: j for j, name in enumerate(context.rows)}
    found: list[tuple[dict[int, sp.Expr], dict[Identity, sp.Expr]]] = []
    for condition in context.equations.constraints:
        factors_of = {number[row]: factor for row, factor in condition.jacobian}
        of_modes = {j: factor for j, factor in factors_of.items() if factor.free_symbols & constants.keys()}
        coefficients = mode_coefficients(of_modes, constants)
        if of_modes and coefficients is None:
            return None
        found.append(({j: factor for j, factor in factors_of.items() if j not in of_modes}, coefficients or {}))
    translations = _translations(found)
    moved = {*translations.values()}
    rows = []
    for others, own in found:
        plain = {j: symbols(factor) for j, factor in others.items() if j not in moved}
        rows.append(_Row(plain, {label: symbols(c) for label, c in own.items()}))
    some = any(row.coefficients for row in rows)
    return ConstantModes(of, symbols, factors, rows, half_force, in_loop, translations) if some else None


def _translations(rows: Sequence[tuple[Mapping[int, sp.Expr], Mapping[Identity, sp.Expr]]]) -> dict[Identity, int]:
    """The constants of modes along which a coordinate moves a marker, with this coordinate.

    rows: for each constraint its factors of coordinates without constants, and the coefficients of the constants. All
    constraints have equal factors of such a coordinate and of its constant at the marker.
    """
    result: dict[Identity, int] = {}
    points = [{label.point for label in own} for _, own in rows]
    for j in sorted({j for others, _ in rows for j in others}):
        equal = (label for others, own in rows for label, factor in own.items() if others.get(j) == factor)
        along = dict.fromkeys(equal, j)
        whole = all(j not in others or along.keys() & own.keys() for others, own in rows)
        of_marker = [(others.get(j), own, at) for (others, own), at in zip(rows, points, strict=True)]
        if whole and all(own.get(n) == factor for factor, own, at in of_marker for n in along if n.point in at):
            result |= along
    return result
