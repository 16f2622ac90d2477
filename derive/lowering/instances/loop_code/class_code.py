"""The loop over the bodies of a class: statements of straight-line code, whose names are elements of arrays."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from types import MappingProxyType

import casadi as ca

from derive.algebra import fraction
from derive.ir.analysis import expressions, reads
from derive.ir.expressions import Element, Expr, Number, Operator, ScalarRef, walk
from derive.ir.indices import ElementIndex, IndexTerm
from derive.ir.kernel import ConstantArray
from derive.ir.statements import Entry, ForEach, InstanceItem, Let, Require, Store, StoreElement, Work
from derive.lowering.attitude import attitude_checks
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import Context, Input, array_input
from derive.lowering.flat.schedule import Step, never_met
from derive.lowering.flat.setup_constants import Constants
from derive.lowering.instances.classes.body_classes import BodyClass, Member
from derive.lowering.instances.classes.class_equations import ClassEquations
from derive.lowering.instances.classes.groups import Group, GroupElement
from derive.lowering.instances.loop_code.numbers_of_instances import evaluated, meets, with_numbers
from derive.lowering.instances.places import Place, Places
from derive.mechanics.equations import Equations

INSTANCE = "i"
"""The variable of loops over instances, as the index of tables with `count`."""


@dataclass(frozen=True)
class LoopTarget:
    """The place of the elements of an output of a loop, and the operator with which values are added to it."""

    array: str
    index: Callable[[int], ElementIndex]
    operator: Operator | None = None
    entries: tuple[Entry, ...] = ()


Loaded = tuple[str, Place, Input]
"""An array, the place of the elements of an instance in it, and their names."""


Tables = Callable[..., Element]
"""The element of a table of constants, by its name, an offset, and the terms of loops around."""


@dataclass(frozen=True)
class InnerLoops:
    """Loops in the body of a loop, behind the statements of a step, and what they read of it.

    arrays: the local arrays of an iteration with their sizes, of which outputs of the steps fill some; tables: those of
    outputs that are constants of an instance; made: the loops, with the elements of the tables.
    """

    arrays: Mapping[str, int]
    tables: Mapping[str, int]
    made: Callable[[Tables], Iterable[InstanceItem]]

    def and_then(self, other: InnerLoops) -> InnerLoops:
        """These loops, and other ones behind them."""
        arrays, tables = {**self.arrays, **other.arrays}, {**self.tables, **other.tables}
        return InnerLoops(arrays, tables, lambda at: [*self.made(at), *other.made(at)])


class LoopCode:
    """The code of a class of bodies or of a group: its context of straight-line code, and places of its instances."""

    def __init__(
        self, of: BodyClass | Group, equations: ClassEquations, places: Places, constants: Constants, name: str = ""
    ) -> None:
        self.name, self.places = name or of.name, places
        self.context = Context(_with_differences(of, equations))
        constants.coefficients |= self.context.constants.coefficients
        self.context.constants = constants
        self.differing = frozenset(str(c.symbol) for c in self.context.equations.coefficients if c.value == c.symbol)
        constants.of_instances |= self.differing
        self.given = array_input("known", equations.given, "what is known")
        self.given_still = array_input("known", equations.given_still, "what is known, and does not depend on the time")
        self.count = len(of.members)
        self._values = [
            dict(zip((str(c.symbol) for c in equations.equations.coefficients), _values(m), strict=False))
            for m in of.members
            if self.differing
        ]
        self._members = [_name(m) for m in of.members]
        self._columns: list[Expr] = []
        self._firsts: dict[tuple[Expr, ...], int] = {}

    def place(self, what: str, firsts: Sequence[int], spacing: int = 1) -> Place:
        """The place of the first of some elements of each instance, and the distance of these."""
        return self.places.place(f"{what}_{self.name}", INSTANCE, firsts, spacing)

    def target(self, array: str, place: Place, operator: Operator | None = None) -> LoopTarget:
        """The target of outputs whose elements are equally spaced from a place on."""
        return LoopTarget(array, place.at, operator, place.entries)

    def loop(
        self,
        symbols: Symbols,
        steps: Iterable[Step],
        inputs: Iterable[Loaded],
        targets: Mapping[str, LoopTarget],
        in_lanes: bool = False,
        inner: Mapping[str, InnerLoops] = MappingProxyType({}),
    ) -> ForEach:
        """The loop over the instances of the class.

        targets: those of the outputs of the steps, by name. in_lanes: whether instances that do not add to elements are
        worth the text and the time of compilers that vectors take. inner: the loops behind steps, by their names.
        """
        sections = self.context.sections(symbols, *steps)
        statements = [statement for section in sections for statement in section.body]
        arrays = {name: size for of in inner.values() for name, size in of.arrays.items()}
        tables: dict[str, dict[int, Expr]] = {table: {} for of in inner.values() for table in of.tables}
        for store in (s for s in statements if isinstance(s, Store) and s.output in tables):
            tables[store.output][store.index] = store.expr
        arrays |= {name: len(of) for name, of in tables.items() if not self._is_known(of.values())}
        known = {name: tuple(of[k] for k in range(len(of))) for name, of in tables.items() if name not in arrays}
        for table in known.values():
            self._number(table, 0, ())
        read = [s for s in statements if not (isinstance(s, Store) and s.output in known)]
        used = {part.name for s in read for e in expressions(s) for part in walk(e) if isinstance(part, ScalarRef)}
        checks = attitude_checks(self.context.equations, used)
        used |= {name for check in checks for name in reads(check)}
        loads: list[InstanceItem] = []
        entries: list[Entry] = []
        for array, place, given in inputs:
            names = [(k, name) for k, name in enumerate(given.elements) if name in used]
            loads += [Let(name, Element(array, place.at(k))) for k, name in names]
            entries += place.entries if names else ()
        loads += [Let(name, self._constant(name)) for name in sorted(used & self.context.constants.of_instances)]

        def at(table: str, offset: int, *terms: IndexTerm) -> Element:
            if table in known:
                return self._number(known[table], offset, terms)
            return Element(table, ElementIndex(offset, terms))

        body: list[InstanceItem] = [*checks]
        for section in sections:
            for statement in section.body:
                if isinstance(statement, Store) and statement.output in arrays:
                    body.append(StoreElement(Element(statement.output, ElementIndex(statement.index)), statement.expr))
                elif isinstance(statement, Store) and statement.output in targets:
                    target = targets[statement.output]
                    element = Element(target.array, target.index(statement.index))
                    body.append(StoreElement(element, statement.expr, target.operator))
                    entries += target.entries
                elif not isinstance(statement, Store):
                    assert isinstance(statement, Let | Require)
                    body.append(statement)
            body += inner[section.name].made(at) if section.name in inner else ()
        works = [Work(name, size) for name, size in arrays.items()]
        body = [*dict.fromkeys(entries), *loads, *works, *body]
        start, stop = ElementIndex(0), ElementIndex(self.count)
        in_lanes = in_lanes and all(target.operator is None for target in targets.values())
        return ForEach(INSTANCE, start, stop, tuple(body), independent=in_lanes)

    # ---- numbers that differ from instance to instance ----

    def _constant(self, name: str) -> Element:
        """The element of the constant array of the class that holds a constant."""
        return self._number((ScalarRef(name),), 0, ())

    def _number(self, table: tuple[Expr, ...], offset: int, terms: Sequence[IndexTerm]) -> Element:
        """The element of the constant array of the class with a number of a table, whose numbers follow each other."""
        if table not in self._firsts:
            self._firsts[table] = len(self._columns)
            for expr in table:
                self._firsts.setdefault((expr,), len(self._columns))
                self._columns.append(expr)
        more = (replace(term, stride=term.stride * self.count) for term in terms)
        index = ElementIndex((self._firsts[table] + offset) * self.count, (*more, IndexTerm(1, INSTANCE)))
        return Element(self._array, index)

    def _is_known(self, values: Iterable[Expr]) -> bool:
        """Whether values are numbers of the instances that differ, so that the constant array of the class has them."""
        names = {part.name for value in values for part in walk(value) if isinstance(part, ScalarRef)}
        return names <= self.context.constants.of_instances

    @property
    def _array(self) -> str:
        return f"numbers_{self.name}"

    def add_numbers(self) -> None:
        """Add the constant array of the numbers that the loops of the class have used."""
        if not self._columns:
            return
        hoisted = {name: expr for expr, name in self.context.constants.hoisted.items()}
        columns: list[Fraction] = []
        nothing: dict[str, Fraction] = {}
        for expr in self._columns:
            columns += [evaluated(expr, values, hoisted) for values in self._values or [nothing] * self.count]
        self.places.numbers(ConstantArray(self._array, tuple(columns), False, self.count))

    def of_members(self, requirement: Require) -> Iterator[Require]:
        """Yield a requirement for each instance with its numbers, besides those that these numbers alone meet.

        Raises LoweringError if they do not meet it.
        """
        hoisted = {name: expr for expr, name in self.context.constants.hoisted.items()}
        for name, values in zip(self._members, self._values, strict=False):
            numbers = {symbol: values[symbol] for symbol in self.differing}
            expr = with_numbers(requirement.expr, numbers, hoisted)
            text = f"{name}: {requirement.text}"
            if any(isinstance(part, ScalarRef) for part in walk(expr)):
                yield replace(requirement, expr=expr, text=text)
            elif not meets(requirement.kind, expr):
                raise never_met(text)


class ClassCode(LoopCode):
    """The code of a class of bodies; `rows` are the numbers of its constraints for each of its handles.

    system, system_rows: the context and these numbers in the system of the joints, where it contributes to all of them;
    varying: what it contributes to varying joints, by its handle; axes: see `ClassEquations`.
    """

    def __init__(
        self, of: BodyClass, equations: ClassEquations, places: Places, constants: Constants, name: str = ""
    ) -> None:
        super().__init__(of, equations, places, constants, name)
        self.of, self.rows, self.axes = of, equations.rows, equations.axes
        self.varying, self.system_rows, self.system = equations.varying, equations.system_rows, self.context
        if self.varying:
            self.system = Context(replace(self.context.equations, constraints=equations.system.constraints))
            self.system.constants = constants
        coordinates, rows = [m.coordinate for m in of.members], [m.row for m in of.members]
        self.coordinate = self.place("coordinate", coordinates)
        self.row = self.coordinate if rows == coordinates else self.place("row", rows)


def _name(member: Member | GroupElement) -> str:
    bodies = (member,) if isinstance(member, Member) else member.bodies
    return ", ".join(body.instance.name for body in bodies)


def _values(member: Member | GroupElement) -> list[Fraction]:
    """The constants of a member as numbers; those that setup computes do not differ."""
    return [fraction(c.value) if c.value.is_Rational else Fraction(0) for c in member.constants]


def _with_differences(of: BodyClass | Group, equations: ClassEquations) -> Equations:
    """The equations with symbols as the values of the constants in which the members differ."""
    every, count = [[c.value for c in member.constants] for member in of.members], equations.constants
    same = [all(values[k] == every[0][k] for values in every) for k in range(count)]
    own, others = equations.equations.coefficients[:count], equations.equations.coefficients[count:]
    changed = (c if equal else replace(c, value=c.symbol) for c, equal in zip(own, same, strict=True))
    return replace(equations.equations, coefficients=(*changed, *others))


def kept_values(
    symbols: Symbols, values: list[ca.SX], later: Sequence[ca.SX], inverses: Sequence[tuple[ca.SX, ca.SX]]
) -> tuple[list[ca.SX], list[ca.SX], list[ca.SX]]:
    """Expressions in which all that does not depend on the symbols `later` is a symbol of its own.

    inverses: symbols in the expressions that stand for values. Returns the expressions, their new symbols, and the
    values that these stand for, which do not depend on numbers alone.
    """
    given = [s for s in symbols.inputs if not any(ca.is_equal(s, other) for other in later)]
    vector, new, stand_for = ca.extract_parametric(ca.vertcat(*values), ca.vertcat(*given))
    constants = {str(s) for s, leaf in zip(symbols.inputs, symbols.leaves, strict=True) if isinstance(leaf, Number)}
    varying: list[tuple[ca.SX, ca.SX]] = []
    fixed: list[tuple[ca.SX, ca.SX]] = []
    for symbol, value in zip(new, stand_for, strict=True):
        (fixed if {str(s) for s in ca.symvar(value)} <= constants else varying).append((symbol, value))
    vector = _substituted(vector, fixed)
    plain = {str(s) for s in ca.symvar(vector)}
    kept = [*varying, *((symbol, symbol) for symbol, _ in inverses if str(symbol) in plain)]
    values_of = [_substituted(value, inverses) for _, value in kept]
    return ca.vertsplit(vector), [symbol for symbol, _ in kept], values_of


def _substituted(expr: ca.SX, pairs: Sequence[tuple[ca.SX, ca.SX]]) -> ca.SX:
    """An expression with values in place of symbols."""
    if not pairs:
        return expr
    symbols, values = (ca.vertcat(*column) for column in zip(*pairs, strict=True))
    result: ca.SX = ca.substitute(expr, symbols, values)
    return result
