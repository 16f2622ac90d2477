"""A loop over links: what it reads and writes of the arrays of all links, and the numbers in which links differ."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field
from fractions import Fraction

import casadi as ca

from derive.algebra import fraction, sp
from derive.ir.expressions import Element, Expr, Number, Operation, Operator, ScalarRef
from derive.ir.indices import LANES, ElementIndex, IndexTerm, constant
from derive.ir.kernel import ConstantArray
from derive.ir.statements import (
    Entry,
    ForEach,
    InstanceItem,
    Let,
    Require,
    Requirement,
    ReturnCode,
    Store,
    StoreElement,
)
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.graph import Graph
from derive.lowering.flat.schedule import OutputValue, RequiredValue, Step, StepItem, schedule
from derive.lowering.flat.setup_constants import Constants
from derive.lowering.instances.elimination.block_system import spaced
from derive.lowering.instances.places import Place, Places
from derive.lowering.trees.exact_numbers import Exact
from derive.lowering.trees.links import TreeLink
from derive.mechanics.symbols import local

LINK = "link"
"""The variable of loops over links."""
FIRST = LANES
"""The slot of the first link: that before it is the one of the ground."""

Column = Sequence[Exact]


@dataclass
class LinkArrays:
    """The arrays of a model with a slot for each link and one for the ground, and the constant arrays.

    links: those of all trees. parametric: the names of the constants of setup that are expressions of parameters.
    made: all statements of loops so far, and the loops, by the identities of the statements.
    """

    links: tuple[TreeLink, ...]
    places: Places
    constants: Constants
    parametric: dict[sp.Expr, str] = field(default_factory=dict)
    made: dict[int, tuple[ForEach, LinkLoop]] = field(default_factory=dict)

    @property
    def spacing(self) -> int:
        """The distance of the components of a quantity."""
        return spaced(len(self.links) + FIRST)

    def slot(self, link: int) -> int:
        """The number of the slot of a link, -1 for the ground."""
        return FIRST + link


class LinkLoop:
    """The body of a loop over some links, as values are read, computed and written."""

    def __init__(self, arrays: LinkArrays, name: str, links: Sequence[int]) -> None:
        self.arrays, self.name, self.links = arrays, name, links
        self.symbols = Symbols(frozenset(), frozenset())
        self._read: dict[Element, ca.SX] = {}
        self._names: dict[str, Element] = {}
        self._scalars: dict[str, ca.SX] = {}
        self.entries: list[Entry] = []
        self._targets: list[tuple[Element, Operator | None]] = []
        self._items: list[StepItem] = []
        self._columns: dict[tuple[Fraction, ...], int] = {}

    # ---- places ----

    def place(self, what: str, firsts: Sequence[int], spacing: int = 1) -> Place:
        """The place of the first of some elements of each link."""
        place = self.arrays.places.place(f"{what}_{self.name}", LINK, firsts, spacing)
        if place.entry and place.entry not in self.entries:
            self.entries.append(place.entry)
        return place

    def of_links(self) -> Place:
        """The place of the quantities of each link."""
        return self.place("slot", [self.arrays.slot(n) for n in self.links], self.arrays.spacing)

    def of_parents(self) -> Place:
        """The place of the quantities of the link before each link."""
        slots = [self.arrays.slot(self.arrays.links[n].parent) for n in self.links]
        return self.place("parent", slots, self.arrays.spacing)

    # ---- values ----

    def element(self, array: str, index: ElementIndex) -> ca.SX:
        """The value of an element."""
        element = Element(array, index)
        if element not in self._read:
            name = f"{array}_{len(self._read) + 1}_"
            self.symbols.input(local(name), ScalarRef(name))
            self._names[name] = element
            self._read[element] = self.symbols.values[local(name)]
        return self._read[element]

    def vector(self, array: str, place: Place, count: int = 3, first: int = 0) -> list[ca.SX]:
        """The values of some components."""
        return [self.element(array, place.at(first + k)) for k in range(count)]

    def scalar(self, name: str) -> ca.SX:
        """The value of a scalar of the kernel."""
        symbol = local(name)
        if symbol not in self.symbols.values:
            self.symbols.input(symbol, ScalarRef(name))
            self._scalars[name] = self.symbols.values[symbol]
        return self.symbols.values[symbol]

    def value(self, number: Exact) -> ca.SX:
        """A number, or the constant of setup that is an expression of parameters."""
        if isinstance(number, int | Fraction):
            return self.symbols.number(Fraction(number))
        if number.is_Rational:
            return self.symbols.number(fraction(number))
        return self.scalar(self.arrays.parametric.setdefault(number, f"of_parameters_{len(self.arrays.parametric)}"))

    def leaf(self, leaf: Expr) -> ca.SX:
        """The value of a number or of a scalar of the kernel, perhaps with the opposite sign."""
        match leaf:
            case Number(value):
                return self.symbols.number(value)
            case Operation(Operator.NEG, (inner,)):
                return -self.leaf(inner)
            case ScalarRef(name):
                return self.scalar(name)
        raise TypeError(f"no number, and no scalar: {leaf}")

    def number(self, of: Callable[[TreeLink], Exact]) -> ca.SX:
        """A number of each link; one that all have is part of the code."""
        return self.column([of(self.arrays.links[n]) for n in self.links])

    def numbers(self, of: Callable[[TreeLink], Column]) -> list[ca.SX]:
        """Some numbers of each link, such as the components of a vector."""
        every = [of(self.arrays.links[n]) for n in self.links]
        return [self.column(values) for values in zip(*every, strict=True)]

    def matrix(self, of: Callable[[TreeLink], Sequence[Column]]) -> list[list[ca.SX]]:
        """The rows of a matrix of each link."""
        every = [of(self.arrays.links[n]) for n in self.links]
        return [[self.column(values) for values in zip(*rows, strict=True)] for rows in zip(*every, strict=True)]

    def column(self, values: Column) -> ca.SX:
        """A number for each iteration; one that all have is part of the code.

        Expressions of parameters, of which there are few, have a column of zeros and ones each.
        """
        if len(set(values)) == 1:
            return self.value(values[0])
        others = dict.fromkeys(x for x in values if not isinstance(x, int | Fraction))
        if others:
            total = self.column([x if isinstance(x, int | Fraction) else Fraction(0) for x in values])
            for other in others:
                total = total + self.column([Fraction(x == other) for x in values]) * self.value(other)
            return total
        column = self._columns.setdefault(tuple(values), len(self._columns))
        return self.element(self._array, ElementIndex(column * len(self.links), (IndexTerm(1, LINK),)))

    @property
    def _array(self) -> str:
        return f"numbers_{self.name}"

    # ---- results ----

    def store(self, array: str, index: ElementIndex, value: ca.SX, operator: Operator | None = None) -> None:
        """Write an element, or change it by an operator."""
        self._items.append(OutputValue("result", len(self._targets), value))
        self._targets.append((Element(array, index), operator))

    def store_vector(
        self, array: str, place: Place, values: Sequence[ca.SX], first: int = 0, operator: Operator | None = None
    ) -> None:
        """Write some components."""
        for k, value in enumerate(values, first):
            if operator is None or not value.is_zero():
                self.store(array, place.at(k), value, operator)

    def require(self, kind: Requirement, value: ca.SX, code: ReturnCode, text: str) -> None:
        """Require a value to be finite or positive."""
        self._items.append(RequiredValue(kind, value, code, text))

    def made(self, backward: bool = False, independent: bool = False) -> ForEach:
        """The loop."""
        statement = self._statement(backward, independent)
        self.arrays.made[id(statement)] = statement, self
        return statement

    def tangent(self, backward: bool, active: set[str], scalars: Mapping[str, int]) -> ForEach | None:
        """The loop of the derivatives of what it writes by what it reads of `active` arrays, and by scalars.

        Derivatives are in arrays with names of their own, which hold zeros before; what has some becomes active. Those
        of scalars have these places in `SLOPES`. All that the loop reads has to be what it was.
        """
        values = [(*self._targets[item.index], item.value) for item in self._items if isinstance(item, OutputValue)]
        given = [(Element(SLOPES, constant(scalars[s])), x) for s, x in self._scalars.items() if s in scalars]
        while True:  # a link may read what the loop has written for another one
            read = [(Element(tangent_of(e.array), e.index), x) for e, x in self._read.items() if e.array in active]
            read += given
            if not read:
                return None
            by = ca.vertcat(*(x for _, x in read))
            found = {target.array for target, _, value in values if ca.depends_on(value, by)}
            if found <= active:
                break
            active |= found
        result = copy(self)
        result._read, result._names, result.symbols = dict(self._read), dict(self._names), self.symbols.copy()
        result._items, result._targets = [], []
        along = ca.vertcat(*(result.element(of.array, of.index) for of, _ in read if of.index))
        for target, operator, value in values:
            derivative = ca.jtimes(value, by, along)
            if not derivative.is_zero() and target.index:
                result.store(tangent_of(target.array), target.index, derivative, operator)
        return result._statement(backward, independent=False) if result._items else None

    def _statement(self, backward: bool, independent: bool) -> ForEach:
        step = Step(self.name, "", "", tuple(self._items))
        sections = schedule(Graph(self.arrays.constants), self.symbols, (), (step,))
        body: list[InstanceItem] = []
        for statement in (s for section in sections for s in section.body):
            if isinstance(statement, Store):
                target, operator = self._targets[statement.index]
                body.append(StoreElement(target, statement.expr, operator))
            else:
                assert isinstance(statement, Let | Require)
                body.append(statement)
        loads = [Let(name, element) for name, element in self._names.items()]
        if self._columns:
            values = tuple(value for column in self._columns for value in column)
            self.arrays.places.numbers(ConstantArray(self._array, values, False, len(self.links)))
        every = (*self.entries, *loads, *body)
        return ForEach(LINK, constant(0), constant(len(self.links)), every, backward, independent and not backward)


def tangent_of(array: str) -> str:
    """The name of the array of the derivatives of another one."""
    return f"tangent_of_{array}"


SLOPES = tangent_of("scalars")
"""The array of the derivatives of scalars."""


def opposite(leaf: Expr) -> Expr:
    """A number or a scalar with the opposite sign."""
    return Number(-leaf.value) if isinstance(leaf, Number) else Operation(Operator.NEG, (leaf,))
