"""How the modes of a body move its markers: by coordinates that are coupled with them, and by the forces on them.

Both are sums over the modes of products with the same constants, the components of the modes at the markers. Written
out, those with the coupled coordinates are linear forms in the amplitudes, whose factors are three times as many
numbers as these constants; a loop over the constants of all markers reads each of them once.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property, reduce

import casadi as ca

from derive.ir.expressions import Element, Expr, Operation, Operator, ScalarRef
from derive.ir.indices import ElementIndex, IndexTerm, constant, variable
from derive.ir.statements import ForEach, InstanceItem, Let, StoreElement
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import stores
from derive.lowering.flat.schedule import StepItem
from derive.lowering.instances.loop_code.class_code import InnerLoops, Tables
from derive.lowering.ldlt import Factorisation
from derive.mechanics.symbols import Identity, local

LABEL = "label"
"""The variable of the loop over the constants, each of which all modes have."""


def product(a: Expr, b: Expr) -> Expr:
    """A product of two numbers of a loop."""
    return Operation(Operator.MUL, (a, b))


def total(parts: Sequence[Expr]) -> Expr:
    """The sum of some numbers of a loop, from the first to the last."""
    return reduce(lambda a, b: Operation(Operator.ADD, (a, b)), parts)


def named(body: list[InstanceItem], name: str, value: Expr) -> Expr:
    """A value of a loop with a name, which is added to the body of the loop."""
    body.append(Let(name, value))
    return ScalarRef(name)


class MarkerModes:
    """The motions of the markers of a body, as elements of an array that a loop fills.

    constants: those of each label, by the numbers of the modes; coupled: the coordinates with which modes are coupled;
    half_force: L^-1 f.
    """

    def __init__(
        self,
        name: str,
        constants: Mapping[Identity, Mapping[int, ca.SX]],
        factors: Factorisation,
        coupled: Sequence[int],
        half_force: Mapping[int, ca.SX],
    ) -> None:
        self.labels, self.constants, self.factors = [*constants], constants, factors
        self.coupled, self.half_force = coupled, half_force
        self.modes = sorted({j for of in constants.values() for j in of})
        self.table, self.acting, self.moved = (f"{what}_of_{name}" for what in ("shapes", "acting", "moved"))

    @cached_property
    def _acting(self) -> list[ca.SX]:
        """The factors of the constants of all modes: L between these and coupled coordinates, and D^-1 f."""
        lower = [dict(self.factors.lower[j]) for j in self.modes]
        inverse = dict(zip(self.factors.order, self.factors.inverses, strict=True))
        forces = (inverse[j] * self.half_force[j] for j in self.modes)
        return [*(of.get(i, ca.SX(0)) for i in self.coupled for of in lower), *forces]

    def items(self) -> Iterator[StepItem]:
        """The items that store what the loop reads."""
        yield from stores(self.acting, self._acting)
        yield from stores(self.table, [of.get(j, ca.SX(0)) for of in self.constants.values() for j in self.modes])

    def inputs(self, symbols: Symbols) -> tuple[dict[Identity, dict[int, ca.SX]], dict[Identity, ca.SX]]:
        """The motion along each constant by each coupled coordinate, and by the forces, whose elements have symbols."""
        made = [[local(f"{self.moved}_{by}_{k}") for k in range(len(self.labels))] for by in range(self._by)]
        for by, row in enumerate(made):
            for k, symbol in enumerate(row):
                symbols.input(symbol, self.at(by, constant(k)))
        values = [[symbols.values[symbol] for symbol in row] for row in made]
        of_coordinates = {
            label: {i: values[by][k] for by, i in enumerate(self.coupled)} for k, label in enumerate(self.labels)
        }
        return of_coordinates, dict(zip(self.labels, values[-1], strict=True))

    @property
    def _by(self) -> int:
        return len(self.coupled) + 1

    def at(self, by: int, label: ElementIndex) -> Element:
        """The motion along a constant by a coupled coordinate, or last by the forces."""
        return Element(self.moved, label.plus(by * len(self.labels)))

    def loops(self) -> InnerLoops:
        """The loop, with its arrays and the table of the constants."""
        arrays = {self.acting: len(self._acting), self.moved: self._by * len(self.labels)}
        return InnerLoops(arrays, {self.table: len(self.labels) * len(self.modes)}, lambda at: [self._loop(at)])

    def _loop(self, at: Tables) -> ForEach:
        count = len(self.modes)
        body: list[InstanceItem] = []
        own = [named(body, f"shape_{j + 1}", at(self.table, j, IndexTerm(count, LABEL))) for j in range(count)]
        for by in range(self._by):
            parts = [product(own[j], Element(self.acting, constant(count * by + j))) for j in range(count)]
            body.append(StoreElement(self.at(by, variable(LABEL)), total(parts)))
        return ForEach(LABEL, constant(0), constant(len(self.labels)), tuple(body))
