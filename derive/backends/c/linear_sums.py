"""Sums over the modes of bodies in space in C: rows of a table times elements of an argument, in one static function.

A finite-element body with many modes has dense integrals, whose sums over the modes are most of its text. Their factors
are rows of one table of the file: bodies of one file, and all functions that need a sum, share its row. In a table lie
rows beside each other, first their constant terms, then their factors of one element after the other.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import count

from derive.backends.c.loop_text import address_text, declarations
from derive.backends.c.nests import CNests
from derive.backends.c.signatures import signature
from derive.backends.source_map import SourceLine, plain
from derive.backends.wrapping import comment
from derive.ir.expansion import expand
from derive.ir.expressions import Element, Expr, Operation, Operator, ScalarRef
from derive.ir.indices import LANE, LANES, ElementIndex, IndexTerm, constant, variable
from derive.ir.kernel import ConstantArray, Kernel
from derive.ir.linear_forms import FormValues, KernelForms, LinearParts, Row, Window, linear_parts, linear_rows
from derive.ir.loop_nests import START, Accumulator, Alias, Assign, For, Local, LoopKind, Node
from derive.ir.model import Model
from derive.ir.statements import Let

TOGETHER = 4 * LANES
"""The rows that are computed together, and lie beside each other in a table: vectors of four sums hide each other's
waiting, and share the loads of x."""


@dataclass(frozen=True)
class RowTable:
    """The rows of the sums over a number of elements, and the static function that computes a part of them."""

    model: str
    columns: int
    rows: tuple[Row, ...]

    @property
    def function_name(self) -> str:
        """The name of the static function."""
        return f"{self.model}_sums_of_{self.columns}"

    @property
    def array(self) -> ConstantArray:
        """The constant array of the table; the last block of rows is filled with zeros."""
        zeros = Row((Fraction(0),) * self.columns, Fraction(0))
        rows = [*self.rows, *[zeros] * (-len(self.rows) % TOGETHER)]
        values: list[Fraction] = []
        for first in range(0, len(rows), TOGETHER):
            block = rows[first : first + TOGETHER]
            values += [row.offset for row in block]
            values += [row.factors[j] for j in range(self.columns) for row in block]
        return ConstantArray(f"{self.function_name}_rows", tuple(values), False)

    @property
    def block(self) -> int:
        """The numbers of a block of four rows."""
        return TOGETHER * (self.columns + 1)

    def nodes(self, blocks: ElementIndex) -> tuple[Node, ...]:
        """The plain statements of the static function: sums_i = the constant term + the products of row i and x."""
        names = [f"sum_{first // LANES}" for first in range(0, TOGETHER, LANES)]
        totals: list[Node] = []
        products: list[Node] = []
        stores: list[Node] = []
        for k, name in enumerate(names):
            row = ElementIndex(LANES * k, (IndexTerm(self.block, "i"), IndexTerm(1, LANE)))
            factor = Element("rows", ElementIndex(row.offset + TOGETHER, (*row.terms, IndexTerm(TOGETHER, "j"))))
            total = Accumulator(name, Element("rows", row))
            product = Operation(Operator.MUL, (factor, Element("x", variable("j"))))
            target = Element("sums", ElementIndex(LANES * k, (IndexTerm(TOGETHER, "i"), IndexTerm(1, LANE))))
            totals.append(total)
            products.append(Assign(ScalarRef(total.name), product, Operator.ADD))
            stores.append(Assign(target, ScalarRef(total.name)))
        columns = For("j", START, constant(self.columns), tuple(products))
        lanes = For(LANE, START, constant(LANES), (*totals, columns, *stores), LoopKind.LANES)
        return (For("i", START, blocks, (lanes,)),)

    def function(self) -> list[SourceLine]:
        """The lines of the static function."""
        head = signature(
            f"TISSERAND_SHARED void {self.function_name}",
            (
                "ptrdiff_t blocks",
                *(f"const double *TISSERAND_RESTRICT {name}" for name in ("rows", "x")),
                "double *TISSERAND_RESTRICT sums",
            ),
        )
        doc = f"Blocks of {TOGETHER} sums over {self.columns} elements of x; the constant terms are first in the rows."
        lines = CNests({"sums"}, counter="ptrdiff_t").lines(self.nodes(variable("blocks")))
        return [*plain(*comment([doc]), *head, "{"), *lines, *plain("}", "")]


@dataclass(frozen=True)
class SumCall:
    """A call of the static function of a table: `count` blocks of it from `first` on, whose sums go to an array.

    start: the index of the first sum in the array.
    """

    table: RowTable
    first: int
    count: int
    window: Window
    array: str
    start: int

    @property
    def _places(self) -> tuple[tuple[str, str, int], ...]:
        """The parameters of the static function, and the arrays and the elements that they point to."""
        return (
            ("rows", self.table.array.name, self.table.block * self.first),
            ("x", self.window.argument, self.window.first),
            ("sums", self.array, self.start),
        )

    @property
    def line(self) -> str:
        """The line of the call."""
        addresses = (address_text(array, constant(first)) for _, array, first in self._places)
        return f"    {self.table.function_name}({', '.join([str(self.count), *addresses])});"

    def nodes(self) -> tuple[Node, ...]:
        """The operations of the call, as plain statements."""
        views = (Alias(name, array, constant(first)) for name, array, first in self._places)
        return (*views, *self.table.nodes(constant(self.count)))

    def row_by_row(self) -> For:
        """The operations of the call with one statement for each row, for loops over the states of a batch."""
        (rows, place), (x, first), (sums, start) = ((array, element) for _, array, element in self._places)
        row = ElementIndex(place, (IndexTerm(self.table.block, "i"), IndexTerm(1, "r")))
        total: Expr = Element(rows, row)
        for j in range(self.table.columns):
            factor = Element(rows, row.plus(TOGETHER * (j + 1)))
            product = Operation(Operator.MUL, (factor, Element(x, constant(first + j))))
            total = Operation(Operator.ADD, (total, product))
        target = Element(sums, ElementIndex(start, (IndexTerm(TOGETHER, "i"), IndexTerm(1, "r"))))
        inner = For("r", START, constant(TOGETHER), (Assign(target, total),))
        return For("i", START, constant(self.count), (inner,))


@dataclass(frozen=True)
class KernelSums:
    """A kernel without its linear forms, and the calls at its beginning that compute their values.

    kernel: the kernel with the constant arrays of the tables; arrays: the names and the sizes of the arrays of values.
    """

    kernel: Kernel
    parts: LinearParts
    calls: tuple[SumCall, ...]
    arrays: tuple[tuple[str, int], ...]

    @property
    def lines(self) -> list[SourceLine]:
        """The lines of the declarations and the calls."""
        declared = declarations(f"{name}[{size}]" for name, size in self.arrays)
        return plain(*declared, *(call.line for call in self.calls))

    def nodes(self, row_by_row: bool = False) -> Iterator[Node]:
        """The kernel as plain statements; it reads the arrays of the tables."""
        yield from (Local(name, size) for name, size in self.arrays)
        for call in self.calls:
            yield from (call.row_by_row(),) if row_by_row else call.nodes()
        for section in self.parts.sections:
            for _, statement in section:
                yield from expand(statement)


@dataclass(frozen=True)
class LinearSums:
    """The tables of a model, and the kernels that read their values, by name."""

    tables: tuple[RowTable, ...]
    kernels: Mapping[str, KernelSums]


NO_SUMS = LinearSums((), {})


def linear_sums(model: Model) -> LinearSums:
    """The sums of the kernels of a scene in space in straight-line code; other models have none."""
    if model.lowering != "flat" or not model.in_space:
        return NO_SUMS
    kernels = [kernel for kernel in model.kernels if kernel.name != "setup"]
    known = {kernel.name: KernelForms(kernel) for kernel in kernels}
    wanted = {name: linear_rows(forms) for name, forms in known.items()}
    collected: dict[int, _Rows] = {}
    for windows in wanted.values():
        for window, rows in windows.items():
            for row in rows:
                collected.setdefault(window.count, _Rows()).add(row, window.argument)
    tables = {columns: RowTable(model.name, columns, tuple(of.rows)) for columns, of in collected.items()}
    result = {
        kernel.name: _kernel_sums(kernel, known[kernel.name], wanted[kernel.name], tables, collected)
        for kernel in kernels
        if wanted[kernel.name]
    }
    return LinearSums(tuple(tables.values()), result)


@dataclass
class _Rows:
    """The rows of a table while they are collected.

    Of two opposite rows, the functions of an argument read the one that came first. Each argument has rows of its own,
    which begin a block: the sums of positions and of velocities differ in signs, and no block is computed for both.
    """

    rows: list[Row] = field(default_factory=list)
    _numbers: dict[str, dict[Row, int]] = field(default_factory=dict)
    _argument: str = ""

    def add(self, row: Row, argument: str) -> None:
        """Add a row that an argument needs, if it does not have it or its opposite."""
        known = self._numbers.setdefault(argument, {})
        if row.among(known) in known:
            return
        if argument != self._argument:
            zeros = Row((Fraction(0),) * len(row.factors), Fraction(0))
            self.rows += [zeros] * (-len(self.rows) % TOGETHER)
            self._argument = argument
        known[row] = len(self.rows)
        self.rows.append(row)

    def numbered(self, row: Row, argument: str) -> tuple[Row, int]:
        """A row of an argument with the sign that the table has, and its number."""
        known = self._numbers[argument]
        signed = row.among(known)
        return signed, known[signed]


def _kernel_sums(
    kernel: Kernel,
    known: KernelForms,
    windows: Mapping[Window, Iterable[Row]],
    tables: Mapping[int, RowTable],
    collected: Mapping[int, _Rows],
) -> KernelSums:
    """The kernel with the values of its rows in an array for each window."""
    taken = {*kernel.used, *(o.name for o in kernel.outputs)}
    taken |= {statement.name for statement in kernel.statements if isinstance(statement, Let)}
    values: list[FormValues] = []
    arrays: list[tuple[str, int]] = []
    calls: list[SumCall] = []
    for window, rows in windows.items():
        places = dict(collected[window.count].numbered(row, window.argument) for row in rows)
        blocks = sorted({place // TOGETHER for place in places.values()})
        order = {block: n for n, block in enumerate(blocks)}
        stem = f"sums_{window.argument}"
        name = next(name for name in (f"{stem}_{k}" for k in count(window.first)) if name not in taken)
        taken.add(name)
        indices = {row: TOGETHER * order[place // TOGETHER] + place % TOGETHER for row, place in places.items()}
        values.append(FormValues(name, window, indices))
        arrays.append((name, TOGETHER * len(blocks)))
        calls += [
            SumCall(tables[window.count], first, length, window, name, TOGETHER * order[first])
            for first, length in _runs(blocks)
        ]
    constants = (tables[columns].array for columns in dict.fromkeys(window.count for window in windows))
    reading = replace(kernel, constants=(*kernel.constants, *constants))
    return KernelSums(reading, linear_parts(known, values), tuple(calls), tuple(arrays))


def _runs(numbers: Iterable[int]) -> Iterator[tuple[int, int]]:
    """The first number and the length of each run of successive numbers."""
    first, length = -1, 0
    for number in numbers:
        if length and number == first + length:
            length += 1
            continue
        if length:
            yield first, length
        first, length = number, 1
    if length:
        yield first, length
