"""Plain statements: declarations, assignments and loops, to which all statements of a Kernel are expanded.

A backend prints these few for all statements. `expansion.py` makes them of the statements, `lanes.py` runs loops in the
lanes of vectors, `batches.py` adds a loop over states: each from plain statements to plain statements, which the
interpreter runs before and after.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import assert_never

from derive.ir.expressions import Element, Ends, Expr, Leaf, Operator, ScalarRef, mapped, walk
from derive.ir.indices import ElementIndex, constant, padded
from derive.ir.statements import Let, Require


@dataclass(frozen=True)
class Local:
    """Declare a local array with room for `count` elements, padded to a multiple of four.

    totals: the names of the sums whose lanes it holds, one sum after the other. cleared: whether its elements begin as
    zeros. spacing: the distance of the components of an instance, if the array holds one component of all instances
    after the other. in_lanes: whether it holds an element for each lane of a vector, one vector after the other.
    """

    array: str
    count: int
    totals: tuple[str, ...] = ()
    cleared: bool = False
    spacing: int = 0
    in_lanes: bool = False

    @property
    def size(self) -> int:
        """The number of elements, padded."""
        return padded(self.count)


@dataclass(frozen=True)
class Alias:
    """Name the part of an array that begins with an element."""

    name: str
    array: str
    index: ElementIndex


@dataclass(frozen=True)
class Integer:
    """Name an element of a constant array of integers, which indices and bounds of loops count from.

    times: the variable of a loop by which it is multiplied, if there is one.
    """

    name: str
    array: str
    index: ElementIndex
    times: str = ""

    def factor(self, variables: Mapping[str, int]) -> int:
        """The number by which the element is multiplied, for values of the variables."""
        return variables[self.times] if self.times else 1


@dataclass(frozen=True)
class Accumulator:
    """Name a number that additions change: the element of an array, or the sum, `total` while it is computed."""

    total: str
    expr: Expr

    @property
    def name(self) -> str:
        """The name of the number."""
        return f"{self.total}_l"


@dataclass(frozen=True)
class Assign:
    """Assign to an element or a variable; with an operator, the result of its old value and the expression.

    The operator NEG assigns the negative expression.
    """

    target: Element | Ends | ScalarRef
    expr: Expr
    operator: Operator | None = None


class LoopKind(Enum):
    """The order in which the iterations of a loop may run."""

    ORDERED = "ordered"
    """The iterations run one after the other."""
    INDEPENDENT = "independent"
    """The iterations run in any order if additions to an element keep theirs; such a loop may run in lanes."""
    LANES = "lanes"
    """Several iterations run at once, in vectors: all additions are to variables of the iteration."""
    FEW = "few"
    """Fewer iterations than vectors have lanes run at once. The lanes that are left repeat the last iteration."""
    ENDS = "ends"
    """The two iterations run at once, in vectors of two."""
    STATES = "states"
    """Several iterations run at once: the loop over the states of a batch. A requirement fails a single state."""


@dataclass(frozen=True)
class For:
    """The body for a variable from `start` to `stop`, which is left out, with a step that may be negative.

    padded: an independent loop may also run for the iterations up to the next multiple of four. overlaps: iterations
    may run twice, so that the last block of several ends at `stop` and overlaps the one before.
    """

    variable: str
    start: ElementIndex
    stop: ElementIndex
    body: tuple[Node, ...]
    kind: LoopKind = LoopKind.ORDERED
    step: int = 1
    padded: bool = False
    overlaps: bool = False

    def values(self, variables: Mapping[str, int]) -> Iterable[int]:
        """The values of the variable, where those of the variables around the loop are given."""
        start, stop = self.start.at(variables), self.stop.at(variables)
        steps = range(start, stop, self.step)
        return (min(value, stop - self.step) for value in steps) if self.overlaps else steps

    @property
    def count(self) -> int | None:
        """The number of iterations, if both bounds are numbers."""
        if self.start.terms or self.stop.terms:
            return None
        return len(range(self.start.offset, self.stop.offset, self.step))


START = constant(0)


def ordered_loop(index: str, stop: int | ElementIndex, body: Iterable[Node], start: ElementIndex = START) -> For:
    """A loop over an index, in order."""
    return For(index, start, constant(stop) if isinstance(stop, int) else stop, tuple(body))


@dataclass(frozen=True)
class If:
    """The first part where a variable is less than a bound, else the second."""

    variable: str
    bound: int
    then: tuple[Node, ...]
    otherwise: tuple[Node, ...]


@dataclass(frozen=True)
class PartOf:
    """Plain statements that belong to another statement of the section, by its number there."""

    statement: int
    body: tuple[Node, ...]


@dataclass(frozen=True)
class BlockProduct:
    """target_r = target_r + sign * (A_r0 x_0 + ... + A_r3 x_3), added from the left, for a block of four rows r.

    A_rc is element r + stride * c of `matrix` from `first` on; `vector` and `target` are the first of four elements.
    """

    matrix: str
    first: ElementIndex
    stride: int
    sign: int
    vector: Element
    target: Element


@dataclass(frozen=True)
class Sines:
    """The sines and cosines of angles, in two arrays: of all states of a batch, or of `count` elements of an array.

    stride: the distance of these elements, of which `angle` is the first one; 0: `angle` is a whole array. rows: the
    elements of the two arrays, if these have several, with a value for each state.
    """

    angle: Element
    sine: str
    cosine: str
    count: int | None = None
    stride: int = 0
    rows: tuple[ElementIndex, ElementIndex] | None = None


Node = Let | Require | Local | Alias | Integer | Accumulator | Assign | For | If | PartOf | BlockProduct | Sines
"""A plain statement."""


def inner(node: Node) -> tuple[Node, ...]:
    """The plain statements in the body of another one."""
    match node:
        case For() | PartOf():
            return node.body
        case If():
            return (*node.then, *node.otherwise)
        case Let() | Require() | Local() | Alias() | Integer() | Accumulator() | Assign() | BlockProduct() | Sines():
            return ()
        case _:
            assert_never(node)


_WITH_BODIES = (For, PartOf, If)
"""A tuple, since a union is made anew at each test."""


def every(nodes: Iterable[Node]) -> Iterator[Node]:
    """All plain statements, also those in bodies, in order."""
    for node in nodes:
        yield node
        if isinstance(node, _WITH_BODIES):
            yield from every(inner(node))


IndexChange = Callable[[ElementIndex], ElementIndex]
"""A function that replaces an index by another one."""


def reindexed(node: Node, change: IndexChange) -> Node:
    """A plain statement with other indices, also in its body; bounds of loops stay."""

    def leaf(item: Leaf) -> Expr:
        return replace(item, index=change(item.index)) if isinstance(item, Element) and item.index else item

    return rewritten(node, leaf, change)


def rewritten(node: Node, leaf: Callable[[Leaf], Expr], change: IndexChange = lambda index: index) -> Node:
    """A plain statement with other leaves of expressions and other indices of aliases, also in its body."""

    def element(item: Element) -> Element:
        result = leaf(item)
        assert isinstance(result, Element)
        return result

    def body(nodes: tuple[Node, ...]) -> tuple[Node, ...]:
        return tuple(rewritten(item, leaf, change) for item in nodes)

    match node:
        case Let() | Require() | Accumulator():
            return replace(node, expr=mapped(node.expr, leaf))
        case Assign():
            target = leaf(node.target) if isinstance(node.target, Element | Ends) else node.target
            assert isinstance(target, Element | Ends | ScalarRef)
            return replace(node, target=target, expr=mapped(node.expr, leaf))
        case Alias() | Integer():
            return replace(node, index=change(node.index))
        case For() | PartOf():
            return replace(node, body=body(node.body))
        case If():
            return replace(node, then=body(node.then), otherwise=body(node.otherwise))
        case BlockProduct():
            return replace(node, first=change(node.first), vector=element(node.vector), target=element(node.target))
        case Sines():
            rows = (change(node.rows[0]), change(node.rows[1])) if node.rows else None
            return replace(node, angle=element(node.angle), rows=rows)
        case Local():
            return node
        case _:
            assert_never(node)


def expressions_of(node: Node) -> tuple[Expr, ...]:
    """The expressions of a plain statement, not those in its body."""
    match node:
        case Let() | Require() | Accumulator():
            return (node.expr,)
        case Assign():
            return (node.target, node.expr) if node.operator in CHANGES else (node.expr,)
        case BlockProduct():
            return (node.vector, node.target)
        case Sines():
            return (node.angle,)
        case Local() | Alias() | Integer() | For() | If() | PartOf():
            return ()
        case _:
            assert_never(node)


def ends_of(loop: For) -> Iterator[Ends]:
    """The elements of both ends that a loop reads and writes."""
    for node in every(loop.body):
        yield from (part for expr in expressions_of(node) for part in walk(expr) if isinstance(part, Ends))
        if isinstance(node, Assign) and isinstance(node.target, Ends):
            yield node.target


CHANGES = frozenset({Operator.ADD, Operator.SUB, Operator.MUL})
"""The operators of assignments that read the old value."""
