"""The Kernel: a small program in static single assignment, between the mechanics and the emitted text.

It knows numbers, names and operations, no mechanics and no language. Sections follow the physics.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import accumulate


@dataclass(frozen=True)
class Num:
    """An exact number."""

    value: Fraction


@dataclass(frozen=True)
class Ref:
    """The value of an element of an argument or of an earlier `Let`, by its name."""

    name: str


@dataclass(frozen=True)
class Op:
    """An operation: add, sub, mul, div (two operands), neg, sin, cos (one)."""

    kind: str
    args: tuple[Expr, ...]


@dataclass(frozen=True)
class At:
    """Element offset + stride * index of an array, by the name of the loop that counts the index."""

    array: str
    index: str
    stride: int = 1
    offset: int = 0


@dataclass(frozen=True)
class Entry:
    """Entry (i, j) of a packed table, in a `Pairs`."""

    table: str


Leaf = Num | Ref | At | Entry
Expr = Leaf | Op


@dataclass(frozen=True)
class Let:
    """Name a value."""

    name: str
    expr: Expr


@dataclass(frozen=True)
class Store:
    """Write element `index` of an output."""

    output: str
    index: int
    expr: Expr


@dataclass(frozen=True)
class Require:
    """Leave with return code `code` unless the value is `positive` or `finite` (a NaN is neither)."""

    kind: str
    expr: Expr
    code: int
    text: str


@dataclass(frozen=True)
class Put:
    """Write element i of a local array, in an `Each`."""

    array: str
    expr: Expr


@dataclass(frozen=True)
class StoreAt:
    """Write element offset + stride * i of an output, in an `Each`."""

    output: str
    offset: int
    stride: int
    expr: Expr


@dataclass(frozen=True)
class Each:
    """For i = 0 .. count - 1, independent of each other."""

    count: int
    body: tuple[Let | Put | StoreAt, ...]


@dataclass(frozen=True)
class Sum:
    """name = base + sum over i of term."""

    name: str
    base: Expr
    term: Expr


@dataclass(frozen=True)
class Reduce:
    """Sums over i = 0 .. count - 1. Element i goes to lane i mod 4; lanes are added as (0 + 1) + (2 + 3), then base."""

    count: int
    lets: tuple[Let, ...]
    sums: tuple[Sum, ...]


LANES = 4
"""Lanes of a sum and columns of a panel: what vector units take at once, so that no compiler need reorder a sum."""


@dataclass(frozen=True)
class Packing:
    """Square tables of one size in one array: panels of four columns j, in each the tables, their columns, rows i.

    Rows and columns are padded with zeros to a multiple of four.
    """

    array: str
    count: int
    tables: tuple[str, ...]

    @property
    def padded(self) -> int:
        """Rows of a column."""
        return padded(self.count)

    @property
    def size(self) -> int:
        """Elements of the array."""
        return len(self.tables) * self.padded**2

    def place(self, table: str, i: int, j: int) -> int:
        """Where entry (i, j) of a table lies."""
        panel = (j // LANES * len(self.tables) + self.tables.index(table)) * LANES + j % LANES
        return panel * self.padded + i


def padded(count: int) -> int:
    """The next multiple of four."""
    return -(-count // LANES) * LANES


@dataclass(frozen=True)
class Lane:
    """Local array name_i = base_i + sum over j of vector_j table_ij, for pairs (vector, table); no base is zero."""

    name: str
    base: str
    sums: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Contract:
    """Matrix-vector products of packed tables, panel by panel."""

    packing: Packing
    lanes: tuple[Lane, ...]


@dataclass(frozen=True)
class Pairs:
    """output[offset + stride * j + i] = expr for all i, j; on the diagonal `diagonal` is added."""

    packing: Packing
    output: str
    offset: int
    stride: int
    expr: Expr
    diagonal: Expr | None


@dataclass(frozen=True)
class Source:
    """A table in the parameters: entries for i <= j (i < j, if odd) by rows, `components` together."""

    table: str
    array: str
    component: int
    components: int
    parity: int


@dataclass(frozen=True)
class Pack:
    """Fill an output with the packed tables, from their sources."""

    packing: Packing
    output: str
    sources: tuple[Source, ...]


@dataclass(frozen=True)
class Clear:
    """Set all elements of an output to zero."""

    output: str
    count: int


@dataclass(frozen=True)
class RequireAll:
    """Leave with return code `code` unless all elements of an argument are finite."""

    argument: str
    count: int
    code: int
    text: str


@dataclass(frozen=True)
class Root:
    """The Cholesky factor L of a table given by its entries i <= j, into an output from `offset` on, by columns.

    The diagonal holds 1/L_ii. Leaves with `code` when a pivot is not positive.
    """

    output: str
    offset: int
    source: str
    count: int
    code: int
    text: str


@dataclass(frozen=True)
class Substitute:
    """Overwrite local arrays y by L^-1 y, or by L^-T y if `transposed`; `factor` is the array that `Root` wrote."""

    factor: str
    count: int
    arrays: tuple[str, ...]
    transposed: bool


Statement = Let | Store | Require | Each | Reduce | Contract | Pairs | Pack | Clear | RequireAll | Root | Substitute


@dataclass(frozen=True)
class Section:
    """A named part of a kernel, with the equation it computes."""

    name: str
    equation: str
    doc: str
    body: tuple[Statement, ...]


@dataclass(frozen=True)
class Piece:
    """Rows that each column j of a group has: one `row`, the row first + j (`diagonal`), `count` rows, or those of a
    lower `triangle`, first + j to first + count - 1."""

    kind: str
    first: int
    count: int = 1

    def rows(self, j: int) -> range:
        """The rows in column j of the group."""
        if self.kind == "diagonal":
            return range(self.first + j, self.first + j + 1)
        return range(self.first + (j if self.kind == "triangle" else 0), self.first + self.count)


@dataclass(frozen=True)
class Columns:
    """`count` columns that are alike, with their pieces from the first row to the last."""

    count: int
    pieces: tuple[Piece, ...]


@dataclass(frozen=True)
class Pattern:
    """Compressed columns of a sparse matrix; of a symmetric one the lower triangle is stored.

    `groups` describes it in a few words where it has blocks whose size is the number of shapes.
    """

    rows: int
    cols: int
    colptr: tuple[int, ...]
    rowidx: tuple[int, ...]
    symmetric: bool
    groups: tuple[Columns, ...] = ()

    @property
    def entries(self) -> tuple[tuple[int, int], ...]:
        """(row, column) of each stored value, in the order of the values."""
        return tuple((self.rowidx[k], j) for j in range(self.cols) for k in range(self.colptr[j], self.colptr[j + 1]))

    @property
    def full_nnz(self) -> int:
        """Structural non-zeros of the whole matrix, both triangles counted."""
        return len(self.rowidx) + sum(i != j for i, j in self.entries if self.symmetric)


def pattern(rows: int, cols: int, entries: set[tuple[int, int]], symmetric: bool = False) -> Pattern:
    """The compressed columns of a set of (row, column)."""
    ordered = sorted(entries, key=lambda entry: (entry[1], entry[0]))
    lengths = Counter(j for _, j in ordered)
    colptr = tuple(accumulate((lengths[j] for j in range(cols)), initial=0))
    return Pattern(rows, cols, colptr, tuple(i for i, _ in ordered), symmetric)


def block_pattern(rows: int, groups: tuple[Columns, ...], symmetric: bool = False) -> Pattern:
    """The compressed columns of groups of columns."""
    columns = [[i for piece in g.pieces for i in piece.rows(j)] for g in groups for j in range(g.count)]
    colptr = tuple(accumulate(map(len, columns), initial=0))
    return Pattern(rows, len(columns), colptr, tuple(i for c in columns for i in c), symmetric, groups)


@dataclass(frozen=True)
class View:
    """An array that is a part of an argument."""

    name: str
    offset: int
    size: int


@dataclass(frozen=True)
class Argument:
    """An input: a scalar (no elements) or an array whose elements have names.

    `arrays` are parts of it with one name; `positions` says where the named elements lie, if not one after the other.
    """

    name: str
    elements: tuple[str, ...]
    doc: str
    scalar: bool = False
    arrays: tuple[View, ...] = ()
    positions: tuple[int, ...] = ()

    @property
    def places(self) -> tuple[tuple[int, str], ...]:
        """Where each named element lies."""
        return tuple(zip(self.positions or range(len(self.elements)), self.elements, strict=True))

    @property
    def size(self) -> int:
        """Elements of the array."""
        return len(self.elements) + sum(view.size for view in self.arrays)


@dataclass(frozen=True)
class Output:
    """An output array; `elements` says what each value is; a matrix has a pattern for its values.

    Where there are too many values for names, `size` counts them and `elements` describes groups of them.
    """

    name: str
    elements: tuple[str, ...]
    doc: str
    pattern: Pattern | None = None
    count: int | None = None

    @property
    def size(self) -> int:
        """Values of the array."""
        return len(self.elements) if self.count is None else self.count


@dataclass(frozen=True)
class Kernel:
    """One function of the generated code."""

    name: str
    doc: str
    arguments: tuple[Argument, ...]
    outputs: tuple[Output, ...]
    sections: tuple[Section, ...]

    @property
    def statements(self) -> tuple[Statement, ...]:
        """All statements, in order."""
        return tuple(statement for section in self.sections for statement in section.body)

    @property
    def operations(self) -> int:
        """Arithmetic operations of one evaluation; a sine or a cosine counts as one, padding does not count."""
        return sum(operations(s) for s in self.statements)

    @property
    def used(self) -> frozenset[str]:
        """The names that the kernel reads."""
        return frozenset(name for s in self.statements for name in reads(s))


def walk(expr: Expr) -> Iterator[Expr]:
    """An expression and all its parts, operands first."""
    if isinstance(expr, Op):
        for arg in expr.args:
            yield from walk(arg)
    yield expr


def expressions(statement: Statement) -> tuple[Expr, ...]:
    """The expressions in a statement."""
    match statement:
        case Let() | Store() | Require():
            return (statement.expr,)
        case Each():
            return tuple(item.expr for item in statement.body)
        case Reduce():
            return (*(let.expr for let in statement.lets), *(e for s in statement.sums for e in (s.base, s.term)))
        case Pairs():
            return (statement.expr,) if statement.diagonal is None else (statement.expr, statement.diagonal)
    return ()


def reads(statement: Statement) -> Iterator[str]:
    """The names of values, arrays and tables that a statement reads."""
    for part in (part for expr in expressions(statement) for part in walk(expr)):
        if isinstance(part, Ref):
            yield part.name
        elif isinstance(part, At):
            yield part.array
    match statement:
        case Contract():
            yield statement.packing.array
            for lane in statement.lanes:
                yield from (vector for vector, _ in lane.sums)
                yield from (lane.base,) if lane.base else ()
        case Pairs():
            yield statement.packing.array
        case Pack():
            yield from (source.array for source in statement.sources)
        case Root():
            yield statement.source
        case Substitute():
            yield statement.factor


def operations(statement: Statement) -> int:
    """Arithmetic operations of a statement."""

    def count(expr: Expr) -> int:
        return sum(isinstance(e, Op) for e in walk(expr))

    match statement:
        case Each():
            return statement.count * sum(count(item.expr) for item in statement.body)
        case Reduce():
            once = sum(1 + count(s.base) for s in statement.sums if s.base != Num(Fraction(0)))
            term = sum(1 + count(s.term) for s in statement.sums) + sum(count(let.expr) for let in statement.lets)
            return once + statement.count * term
        case Contract():
            products = sum(len(lane.sums) for lane in statement.lanes)
            return 2 * statement.packing.count**2 * products
        case Pairs():
            n = statement.packing.count
            return n**2 * count(statement.expr) + (n * (1 + count(statement.diagonal)) if statement.diagonal else 0)
        case Root():
            return statement.count**3 // 3 + statement.count**2
        case Substitute():
            return statement.count**2 * len(statement.arrays)
    return sum(count(e) for e in expressions(statement))
