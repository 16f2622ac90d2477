"""The Kernel: a small program in static single assignment, between the mechanics and the emitted text.

It knows numbers, names and operations, no mechanics and no language. Sections follow the physics.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from derive.ir.expressions import At, Expr, Let, Num, Op, Ref, walk
from derive.ir.loops import Clear, Contract, Each, Pack, Pairs, Reduce, RequireAll, Root, Substitute
from derive.ir.patterns import Pattern


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


Statement = Let | Store | Require | Each | Reduce | Contract | Pairs | Pack | Clear | RequireAll | Root | Substitute


@dataclass(frozen=True)
class Section:
    """A named part of a kernel, with the equation it computes."""

    name: str
    equation: str
    doc: str
    body: tuple[Statement, ...]


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
