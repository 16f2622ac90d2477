"""Statements of a Kernel that run over the shapes: what they compute; how they are written is up to each language."""

from __future__ import annotations

from dataclasses import dataclass

from derive.ir.expressions import Expr, Let


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
