"""Sums over the modes of bodies in loops over instances, in loops over the rows of tables.

A finite-element body has dense integrals: S_i = C4_i + sum_j C5_ij alpha_j for each mode i and each component. Written
out, these sums are most of the text of a loop over bodies, which then comes from memory more slowly than it is run, and
their factors and results do not stay in registers. They are linear forms in neighbouring elements of an array, and are
found by this structure, whatever their names are: tables have their factors row by row, for each instance, and a loop
over the rows computes them at the beginning of the body. The order of additions is that of the elements.
"""

from __future__ import annotations

from collections.abc import Collection, Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from derive.ir.expansion import expand
from derive.ir.expressions import Element, Expr, Leaf, Number, Operation, Operator, ScalarRef, mapped, walk
from derive.ir.factor_tables import FactorTables, RowPlace, rows_in_an_array
from derive.ir.indices import LANES, constant
from derive.ir.instance_lanes import runs_in_blocks
from derive.ir.kernel import ConstantArray, Kernel
from derive.ir.linear_forms import FEWEST_OPERATIONS, FEWEST_ROWS
from derive.ir.loop_nests import For
from derive.ir.model import Model
from derive.ir.operator_functions import ARITHMETIC
from derive.ir.statements import Entry, ForEach, InstanceItem, Let, Require, Statement, StoreElement, Work
from derive.ir.symmetric_tables import Values, matrices, signed
from derive.ir.window_forms import ONE, ZERO, Window, WindowForm, combined_forms

MANY = 64
"""The numbers of an instance from which on they do not stay in registers, and are read from memory at each use."""

Row = tuple[Expr, tuple[tuple[int, Expr], ...]]
"""The constant term of a linear form, and its factors with the places of the elements of a window."""


def with_sums_over_modes(model: Model, kept: Container[str] = ()) -> Model:
    """A model whose loops over instances have loops over the rows of tables in place of dense sums.

    kept: the kernels that stay as they are, since several of them have one text.
    """
    if model.lowering != "instances" or not model.in_space:
        return model
    tables = FactorTables()
    kernels = [kernel if kernel.name in kept else _with_sums(kernel, tables) for kernel in model.kernels]
    arrays = tables.arrays
    return replace(model, kernels=tuple(_with_arrays(kernel, arrays) for kernel in kernels))


def _with_sums(kernel: Kernel, tables: FactorTables) -> Kernel:
    """A kernel with sums in loops, still without the constant arrays of their tables."""
    known = {array.name: array for array in kernel.constants if not array.integers}
    sections = tuple(
        replace(section, body=tuple(_statement(statement, known, tables) for statement in section.body))
        for section in kernel.sections
    )
    return kernel if sections == kernel.sections else replace(kernel, sections=sections)


def _with_arrays(kernel: Kernel, arrays: Mapping[str, ConstantArray]) -> Kernel:
    """A kernel with the constant arrays that it reads."""
    used = kernel.used
    of_tables = [array for name, array in arrays.items() if name in used]
    if not of_tables:
        return kernel
    return replace(kernel, constants=(*(a for a in kernel.constants if a.name in used), *of_tables))


def _statement(statement: Statement, known: Mapping[str, ConstantArray], tables: FactorTables) -> Statement:
    """A statement with sums in loops, if it is a loop over instances in vectors that has enough of them."""
    if not isinstance(statement, ForEach) or not statement.independent:
        return statement
    if statement.start != constant(0) or statement.stop.terms:
        return statement
    (loop,) = expand(statement)
    of_one = statement.stop.offset == 1
    in_blocks = isinstance(loop, For) and runs_in_blocks(loop)
    return _LoopForms(statement, known).in_rows(tables) if of_one or in_blocks else statement


def _parts_of(row: Row) -> Iterator[Expr]:
    """All parts of the numbers of a row."""
    for expr in (row[0], *(factor for _, factor in row[1])):
        yield from walk(expr)


def _apart(rows: Iterable[Row]) -> list[list[Row]]:
    """The rows of a window in parts whose elements lie apart, such as the modes of two bodies that a joint connects."""
    spans = {row: (row[1][0][0], row[1][-1][0]) for row in rows}
    parts: list[list[Row]] = []
    stop = -1
    for row, (first, last) in sorted(spans.items(), key=lambda item: item[1]):
        if first > stop or not parts:
            parts.append([])
        parts[-1].append(row)
        stop = max(stop, last)
    order = {row: number for number, row in enumerate(spans)}
    return [sorted(part, key=order.__getitem__) for part in parts]


class _LoopForms:
    """The linear forms of a loop over instances whose factors are numbers."""

    def __init__(self, loop: ForEach, constants: Mapping[str, ConstantArray]) -> None:
        self.loop, self.constants = loop, constants
        self.names: dict[Window, dict[int, str]] = {}
        self.known: dict[str, WindowForm] = {}
        self.groups: dict[tuple[Window, bool], dict[Row, None]] = {}
        self.chosen: dict[tuple[Window, bool], dict[Row, Expr]] = {}
        written = {item.target.array for item in loop.body if isinstance(item, StoreElement)}
        for item in loop.body:
            if isinstance(item, Let) and isinstance(item.expr, Element) and item.expr.array not in written:
                self._load(item.name, item.expr)

    def _load(self, name: str, element: Element) -> None:
        """Know an element that is loaded: a number, or one of a window."""
        assert element.index
        if element.array in self.constants:
            self.known[name] = WindowForm(None, {}, element)
            return
        window = element.array, element.index.terms
        self.names.setdefault(window, {})[element.index.offset] = name
        self.known[name] = WindowForm(window, {element.index.offset: ONE}, ZERO)

    def in_rows(self, tables: FactorTables) -> ForEach:
        """The loop with loops over rows at its beginning, and without what they replace."""
        loop = self.loop
        for item in loop.body:
            self._seen(item)
        shifted = self._without_offsets()
        groups = {key: rows for key, rows in self.groups.items() if len(rows) >= FEWEST_ROWS}
        if not groups:
            loads = [item.expr for item in loop.body if isinstance(item, Let) and isinstance(item.expr, Element)]
            numbers = sum(load.array in self.constants for load in loads)
            return replace(loop, body=(*_read_in_place(loop.body, self.constants),)) if numbers >= MANY else loop
        before: list[InstanceItem] = []
        arrays = set[str]()
        parts = [(key, part) for key, rows in groups.items() for part in _apart(rows)]
        for number, (key, rows) in enumerate(parts, 1):
            sums = f"sums_over_modes_{number}_of_{len(rows)}"
            arrays.add(sums)
            chosen, loops = self._in_table(key, rows, sums, tables)
            self.chosen[key] = self.chosen.get(key, {}) | chosen
            before += [Work(sums, self._size(rows)), *loops]
        for window, rows in shifted.items():
            sums_of = self.chosen[window, True]
            self.chosen[window, False] = {row: Operation(Operator.ADD, (row[0], sums_of[ZERO, row[1]])) for row in rows}
        lines = [self._replaced(item) for item in loop.body]
        first = next(k for k, item in enumerate(lines) if not _is_load(item))
        lines = [*lines[:first], *before, *lines[first:]]
        return replace(loop, body=(*_needed([*_read_in_place(lines, {*self.constants, *arrays})]),))

    def _without_offsets(self) -> dict[Window, list[Row]]:
        """Move rows with constant terms that are too few for a table of their own to those without, and return them.

        A body has few markers: their places have the factors of their velocities, and with these are enough.
        """
        result = dict[Window, list[Row]]()
        for (window, is_homogeneous), rows in self.groups.items():
            joined = self.groups.get((window, True), {}).keys() | {(ZERO, row[1]) for row in rows}
            if not is_homogeneous and len(rows) < FEWEST_ROWS <= len(joined):
                result[window] = [*rows]
        for window, few in result.items():
            del self.groups[window, False]
            self.groups.setdefault((window, True), {}).update({(ZERO, row[1]): None for row in few})
        return result

    def _in_table(
        self, key: tuple[Window, bool], rows: Iterable[Row], sums: str, tables: FactorTables
    ) -> tuple[dict[Row, Expr], list[ForEach]]:
        """The values of rows of a window as elements of an array, and the loops over rows of a table that fill it."""
        window, is_homogeneous = key
        used = [k for _, factors in rows for k, _ in factors]
        names = {k: name for k, name in sorted(self.names[window].items()) if min(used) <= k <= max(used)}
        differ = any(isinstance(expr, Element) for row in rows for expr in _parts_of(row))
        count = self.loop.stop.offset if differ else 1
        columns = {
            row: [*([] if is_homogeneous else [row[0]]), *(dict(row[1]).get(k, ZERO) for k in names)] for row in rows
        }
        values: dict[Row, Values] = {
            row: tuple(self._value(expr, n) for expr in own for n in range(count)) for row, own in columns.items()
        }
        listed, numbers = [*values], [*values.values()]
        result: dict[Row, Expr] = {}
        loops = list[ForEach]()
        if self._is_alone:
            stored = tables.in_columns(numbers, not is_homogeneous)
            loops.append(stored.loop(0, stored.column, Element(sums, constant(0)), [*names.values()]))
            return {row: Element(sums, constant(k)) for k, row in enumerate(listed)}, loops
        for kind, of_kind in matrices(numbers, len(names), count, not is_homogeneous):
            packed = tables.of_matrices(kind)
            first = packed.place([[signed(numbers, row) for row in matrix] for matrix in of_kind])
            to = Element(sums, constant(len(result)))
            loops.append(packed.loop(first, len(of_kind), to, self.loop.variable, [*names.values()]))
            for row in (row for of_all in zip(*of_kind, strict=True) for row in of_all):
                result[listed[row.number]] = _negative(Element(sums, constant(len(result))), row.is_opposite)
        others = [row for row in listed if row not in result]
        in_array = rows_in_an_array([columns[row] for row in others], not is_homogeneous)
        if in_array:
            stored, places = in_array[0], {row: RowPlace(k) for row, k in zip(others, in_array[1], strict=True)}
        else:
            table = tables.of(len(names) + (not is_homogeneous), count, not is_homogeneous)
            stored, places = table.stored(self.loop.variable), {row: table.place(values[row]) for row in others}
        start = len(result)
        position = dict[int, int]()
        for first, stop in _runs({place.number for place in places.values()}):
            to = Element(sums, constant(start + len(position)))
            loops.append(stored.loop(first, stop, to, [*names.values()]))
            position |= {k: start + len(position) + k - first for k in range(first, stop)}
        for of_row, place in places.items():
            result[of_row] = _negative(Element(sums, constant(position[place.number])), place.is_opposite)
        return result, loops

    @property
    def _is_alone(self) -> bool:
        """Whether the loop is of one body, whose vectors have several rows."""
        return self.loop.stop.offset == 1

    def _size(self, rows: Sequence[Row]) -> int:
        return -(-len(rows) // LANES) * LANES if self._is_alone else len(rows)

    # ---- forms ----

    def _seen(self, item: InstanceItem) -> None:
        """Collect the rows of a line."""
        if isinstance(item, Let | Require | StoreElement):
            if isinstance(item, Let) and item.name in self.known:
                return
            form, expr, operations = self._parts(item.expr)
            if isinstance(item, Let) and form is not None:
                self.known[item.name] = form
            self._whole(form, expr, operations)

    def _replaced(self, item: InstanceItem) -> InstanceItem:
        if isinstance(item, Let | Require | StoreElement) and not _is_load(item):
            return replace(item, expr=self._whole(*self._parts(item.expr)))
        return item

    def _parts(self, expr: Expr) -> tuple[WindowForm | None, Expr, int]:
        """The form of an expression, the expression with the forms in it replaced if it is none, its operations."""
        if isinstance(expr, Operation):
            parts = [self._parts(arg) for arg in expr.args]
            operations = 1 + sum(count for *_, count in parts)
            forms = [form for form, *_ in parts if form is not None]
            form = combined_forms(expr.kind, forms) if len(forms) == len(parts) else None
            if form is not None:
                return form, expr, operations
            return None, Operation(expr.kind, tuple(self._whole(*part) for part in parts)), operations
        if isinstance(expr, ScalarRef):
            return self.known.get(expr.name), expr, 0
        return (WindowForm(None, {}, expr) if isinstance(expr, Number) else None), expr, 0

    def _whole(self, form: WindowForm | None, expr: Expr, operations: int) -> Expr:
        """An expression, or the element of an array in its place if it is a form that is worth a row."""
        if form is None or form.window is None or operations < FEWEST_OPERATIONS or not form.is_dense:
            return expr
        key = form.window, form.offset == ZERO
        row = form.offset, tuple(sorted(form.factors.items(), key=lambda item: item[0]))
        self.groups.setdefault(key, {})[row] = None
        return self.chosen[key][row] if key in self.chosen else expr

    def _value(self, expr: Expr, instance: int) -> Fraction:
        """The value of a factor for one of the instances."""
        match expr:
            case Number():
                return expr.value
            case Element():
                assert expr.index
                return Fraction(self.constants[expr.array].values[expr.index.at({self.loop.variable: instance})])
            case Operation():
                return Fraction(ARITHMETIC[expr.kind](*(self._value(arg, instance) for arg in expr.args)))
        raise AssertionError("factors are made of numbers")


def _negative(element: Element, is_opposite: bool) -> Expr:
    """An element, or the opposite of it."""
    return Operation(Operator.NEG, (element,)) if is_opposite else element


def _is_load(item: InstanceItem) -> bool:
    """Whether a line names an integer or loads an element."""
    return isinstance(item, Entry) or (isinstance(item, Let) and isinstance(item.expr, Element))


def _read_in_place(body: Iterable[InstanceItem], arrays: Collection[str]) -> Iterator[InstanceItem]:
    """The lines of a body that read elements of some arrays where they need them: operations read them from memory."""
    places: dict[str, Element] = {}

    def leaf(part: Leaf) -> Expr:
        return places.get(part.name, part) if isinstance(part, ScalarRef) else part

    for item in body:
        if isinstance(item, Let) and isinstance(item.expr, Element) and item.expr.array in arrays:
            places[item.name] = item.expr
        elif isinstance(item, Let | Require | StoreElement):
            yield replace(item, expr=mapped(item.expr, leaf))
        else:
            yield item


def _needed(body: Sequence[InstanceItem]) -> Iterator[InstanceItem]:
    """The lines of a body without values that nothing reads any more."""
    read: set[str] = set()
    kept: list[InstanceItem] = []
    for item in reversed(body):
        if isinstance(item, Let) and item.name not in read:
            continue
        read |= {part.name for expr in _expressions(item) for part in walk(expr) if isinstance(part, ScalarRef)}
        kept.append(item)
    return reversed(kept)


def _expressions(item: InstanceItem) -> Iterable[Expr]:
    if isinstance(item, ForEach):
        return (expr for inner in item.body for expr in _expressions(inner))
    return (item.expr,) if isinstance(item, Let | Require | StoreElement) else ()


def _runs(numbers: Iterable[int]) -> Iterator[tuple[int, int]]:
    """The first number of each run of successive ones, and the first one behind it."""
    first = stop = -1
    for number in sorted(numbers):
        if number != stop:
            if stop >= 0:
                yield first, stop
            first = number
        stop = number + 1
    if stop >= 0:
        yield first, stop
