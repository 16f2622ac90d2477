"""The Kernel: a small program in static single assignment, between the mechanics and the emitted text.

It knows numbers, names and operations, no mechanics and no language. Sections follow the physics.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction


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


Expr = Num | Ref | Op


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


Statement = Let | Store | Require


@dataclass(frozen=True)
class Section:
    """A named part of a kernel, with the equation it computes."""

    name: str
    equation: str
    doc: str
    body: tuple[Statement, ...]


@dataclass(frozen=True)
class Pattern:
    """Compressed columns of a sparse matrix; of a symmetric one the lower triangle is stored."""

    rows: int
    cols: int
    colptr: tuple[int, ...]
    rowidx: tuple[int, ...]
    symmetric: bool

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
    colptr = tuple(sum(1 for _, j in ordered if j < col) for col in range(cols + 1))
    return Pattern(rows, cols, colptr, tuple(i for i, _ in ordered), symmetric)


@dataclass(frozen=True)
class Argument:
    """An input: a scalar (no elements) or an array whose elements have names."""

    name: str
    elements: tuple[str, ...]
    doc: str
    scalar: bool = False


@dataclass(frozen=True)
class Output:
    """An output array; `elements` says what each value is; a matrix has a pattern for its values."""

    name: str
    elements: tuple[str, ...]
    doc: str
    pattern: Pattern | None = None


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
        """Arithmetic operations of one evaluation; a sine or a cosine counts as one."""
        return sum(isinstance(e, Op) for s in self.statements for e in walk(s.expr))

    @property
    def used(self) -> frozenset[str]:
        """The names that the kernel reads."""
        return frozenset(e.name for s in self.statements for e in walk(s.expr) if isinstance(e, Ref))


def walk(expr: Expr) -> Iterator[Expr]:
    """An expression and all its parts, operands first."""
    if isinstance(expr, Op):
        for arg in expr.args:
            yield from walk(arg)
    yield expr
