"""Independent loops over instances in the lanes of vectors: blocks of four instances, of which the last may overlap.

Two or three instances are one block, in which lanes are left.

A block loads what lies at equal distances as vectors. What constant arrays of integers place is copied to local arrays
before, and from local arrays afterwards. Sines are computed for all lanes at once, between two loops over lanes.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import groupby

from derive.ir.analysis import names_read, needed
from derive.ir.expressions import (
    VECTOR_OPERATORS,
    Element,
    Expr,
    Leaf,
    Operation,
    Operator,
    TableValue,
    mapped,
    walk,
)
from derive.ir.indices import LANE, LANES, ElementIndex, constant, variable
from derive.ir.late_loads import with_late_loads
from derive.ir.loop_nests import (
    START,
    Assign,
    For,
    Integer,
    Local,
    LoopKind,
    Node,
    Sines,
    ends_of,
    every,
    expressions_of,
    reindexed,
)
from derive.ir.ordering import with_few_waiting
from derive.ir.overlaid_arrays import overlaid
from derive.ir.parallel_sums import with_parallel_sums
from derive.ir.statements import Let, Require

IN_LANE = variable(LANE)
"""The index of the element of a lane in an array with an element for each."""
LEAST = 2
"""The number of instances from which on a block is faster than one instance after the other."""
COPIES, RESULTS = "copies", "results"
"""The local arrays of elements that integers place, before and after the loop over the lanes."""
CIRCULAR = (Operator.SIN, Operator.COS)


def instances_in_lanes(loop: For) -> tuple[Node, ...]:
    """A loop over instances in blocks of four, if there are several and vectors have its operations."""
    if any(ends_of(loop)):
        return (replace(loop, body=with_parallel_sums(with_late_loads(loop.body)), kind=LoopKind.ENDS, overlaps=False),)
    made = _Block(loop)
    if not made.fits:
        return (replace(loop, kind=LoopKind.ORDERED),)
    body = made.body()
    arrays = [Local(array, LANES) for array in (*made.angles, *made.sines.values())]
    local, lines = overlaid([Local(array, LANES * size, in_lanes=True) for array, size in made.local.items()], body)
    rows = [Local(_array(name, placed), LANES * len(placed)) for name, placed in made.placed.items() if placed]
    return (*arrays, *local, *rows, replace(loop, body=lines, kind=LoopKind.ORDERED, step=made.lanes))


def runs_in_blocks(loop: For) -> bool:
    """Whether a loop over instances runs in blocks, straight on, without sines between two loops over lanes."""
    made = _Block(loop)
    return made.fits and not any(_is_circular(part) for part in made.parts)


@dataclass
class _Block:
    """The body of a loop over blocks of four instances.

    angles: expressions by the names of the arrays of angles; sines: the arrays of sines and cosines by their
    expressions.
    """

    loop: For
    angles: dict[str, Expr] = field(default_factory=dict)
    sines: dict[Operation, str] = field(default_factory=dict)

    @property
    def fits(self) -> bool:
        """Whether the loop can run in blocks."""
        loop, lines = self.loop, self.lines
        assigned = [node for node in every(lines) if isinstance(node, Assign)]
        written = {node.target.array for node in assigned if isinstance(node.target, Element)} - self.local.keys()
        early = needed(lines, [Let("", part) for part in self._parts(lines) if _is_circular(part)])
        return (
            (loop.count or 0) >= LEAST
            and all(isinstance(node, Let | Require | Assign) or _is_inner(node) for node in lines)
            and all(node.operator in (None, Operator.NEG) for node in assigned)
            and all(_is_vector(part) for part in self._parts(lines))
            and not any(_is_circular(part) for part in self._parts(early))
            and written.isdisjoint(names_read(lines))
        )

    @property
    def lanes(self) -> int:
        """The number of instances of a block."""
        return min(LANES, self.loop.count or 0)

    @property
    def lines(self) -> list[Node]:
        """The body of the loop without its integers and its arrays."""
        return [node for node in self.loop.body if not isinstance(node, Integer | Local)]

    @property
    def local(self) -> dict[str, int]:
        """The arrays of an iteration, with the numbers of their elements."""
        return {node.array: node.count for node in self.loop.body if isinstance(node, Local)}

    @property
    def integers(self) -> dict[str, Integer]:
        """The integers of the loop by their names."""
        return {node.name: node for node in self.loop.body if isinstance(node, Integer)}

    @property
    def parts(self) -> list[Expr]:
        """All parts of the expressions of the loop."""
        return self._parts(self.lines)

    @staticmethod
    def _parts(nodes: Iterable[Node]) -> list[Expr]:
        return [part for node in every(nodes) for expr in expressions_of(node) for part in walk(expr)]

    @cached_property
    def placed(self) -> dict[str, list[Element]]:
        """The elements that integers place, each with a row in an array of copies or of results.

        One array for all rows: processors then need a single address for them.
        """
        targets = [node.target for node in self.lines if isinstance(node, Assign)]
        return {COPIES: self._among(self._parts(self.lines)), RESULTS: self._among(targets)}

    def _among(self, parts: Iterable[object]) -> list[Element]:
        return [part for part in dict.fromkeys(parts) if isinstance(part, Element) and self._is_placed(part)]

    def _is_placed(self, element: Element) -> bool:
        return element.index is not None and element.index.has(*self.integers)

    def _row(self, name: str, element: Element) -> Element:
        """The elements of the lanes in the array of copies or of results."""
        placed = self.placed[name]
        return Element(_array(name, placed), IN_LANE.plus(LANES * placed.index(element)))

    def body(self) -> list[Node]:
        """The loops over the lanes of a block."""
        lines = [self._line(node) for node in self.lines]
        angles = [Assign(Element(array, IN_LANE), angle) for array, angle in self.angles.items()]
        before: list[Node] = [*needed(lines, angles), *angles]
        gathered = [Assign(self._row(COPIES, element), element) for element in self.placed[COPIES]]
        stored = [Assign(element, self._row(RESULTS, element)) for element in self.placed[RESULTS]]
        used = set(names_read(lines))
        kept: list[Node] = [node for node in lines if not (isinstance(node, Let) and node.name not in used)]
        return [
            *self._in_order(gathered),
            *([self._lanes(before)] if angles else []),
            *(self._sines(array) for array in self.angles),
            self._lanes(_rows_first(kept) if self.local else with_late_loads(kept)),
            *self._in_order(stored),
        ]

    def _line(self, node: Node) -> Node:
        """A line with local arrays in place of sines and of what integers place."""
        match node:
            case Assign(target=Element() as target):
                to = self._row(RESULTS, target) if self._is_placed(target) else self._in_lane(target)
                return replace(node, target=to, expr=self._swapped(node.expr))
            case For():
                return replace(node, body=tuple(map(self._line, node.body)))
            case Let() | Require():
                return replace(node, expr=self._swapped(node.expr))
            case _:
                raise AssertionError("only straight lines fit")

    def _swapped(self, expr: Expr) -> Expr:
        if isinstance(expr, Operation):
            if expr.kind in CIRCULAR:
                return Element(self._sine(expr), IN_LANE)
            return Operation(expr.kind, tuple(map(self._swapped, expr.args)))
        return mapped(expr, self._leaf)

    def _leaf(self, leaf: Leaf) -> Expr:
        if not isinstance(leaf, Element):
            return leaf
        return self._row(COPIES, leaf) if self._is_placed(leaf) else self._in_lane(leaf)

    def _in_lane(self, element: Element) -> Element:
        """An element, which each lane has of an array of the iteration."""
        if element.array not in self.local or element.index is None:
            return element
        index = element.index.scaled(LANES)
        return replace(element, index=ElementIndex(index.offset, (*index.terms, *IN_LANE.terms)))

    def _sine(self, call: Operation) -> str:
        """The array of a sine or cosine of the lanes."""
        angle = self._swapped(call.args[0])
        known = next((array for array, other in self.angles.items() if other == angle), None)
        number = list(self.angles).index(known) + 1 if known else len(self.angles) + 1
        self.angles.setdefault(f"angle_{number}", angle)
        for kind, name in zip(CIRCULAR, ("sine", "cosine"), strict=True):
            self.sines.setdefault(Operation(kind, call.args), f"{name}_{number}")
        return self.sines[call]

    def _sines(self, array: str) -> Sines:
        number = list(self.angles).index(array) + 1
        return Sines(Element(array, None), f"sine_{number}", f"cosine_{number}", self.lanes)

    # ---- loops over lanes ----

    def _split(self, nodes: Iterable[Node]) -> tuple[Node, ...]:
        name = self.loop.variable
        return tuple(reindexed(node, lambda index: index.split(name, LANE)) for node in nodes)

    def _lanes(self, nodes: Iterable[Node]) -> For:
        kind = LoopKind.LANES if self.lanes == LANES else LoopKind.FEW
        return For(LANE, START, constant(self.lanes), self._split(nodes), kind)

    def _in_order(self, copies: Sequence[Assign]) -> list[For]:
        """A loop over lanes one after the other, which copies elements that integers place."""
        if not copies:
            return []
        elements = [e for node in copies for e in (node.target, node.expr) if isinstance(e, Element) and e.index]
        used = {term.variable for e in elements if e.index for term in e.index.terms}
        integers = [node for name, node in self.integers.items() if name in used]
        return [For(LANE, START, constant(self.lanes), self._split([*integers, *copies]))]


def _rows_first(lines: Sequence[Node]) -> tuple[Node, ...]:
    """Lines whose first loops over rows come first, with what these need; behind them, few values wait for readers.

    The straight line behind the loops is so long that its values and loads are not in registers in any given order.
    Loops behind it stay there: they read arrays that it fills.
    """
    result: list[Node] = []
    left: list[Node] = []
    for is_loop, part in groupby(lines, lambda node: isinstance(node, For)):
        if is_loop:
            result += part
            continue
        nodes = [*left, *part]
        loads = all(isinstance(node, Let) for node in nodes) and not result
        placed = needed(nodes, [node for node in lines if isinstance(node, For)]) if loads else with_few_waiting(nodes)
        left = [node for node in nodes if node not in placed]
        result += placed
    return tuple(result)


def _is_inner(node: Node) -> bool:
    """Whether a statement is a loop inside that names values and assigns elements, as often for all instances."""
    if not isinstance(node, For):
        return False
    around = {n.variable for n in every([node]) if isinstance(n, For)}
    bounds = (n for n in every([node]) if isinstance(n, For))
    known = all(term.variable in around for n in bounds for of in (n.start, n.stop) for term in of.terms)
    return known and all(isinstance(n, Assign | Let | For) for n in every(node.body))


def _array(name: str, placed: Sequence[Element]) -> str:
    """The array of rows for some elements; loops with as many share it."""
    return f"{name}_{len(placed)}"


def _is_circular(part: Expr) -> bool:
    return isinstance(part, Operation) and part.kind in CIRCULAR


def _is_vector(part: Expr) -> bool:
    if isinstance(part, Operation):
        return part.kind in VECTOR_OPERATORS or part.kind in CIRCULAR
    return not isinstance(part, TableValue)
