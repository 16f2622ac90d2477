"""Independent loops in one with the ordered loops that need them: an instance is computed in the step that reads it.

What an instance hands to the step then stays in registers, and is not stored where nothing else reads it. An iteration
moves down to the first step that touches what it writes, or up to the last one that writes what it reads, if successive
iterations move to successive steps. All operations are those of the loops before, and so are the bits.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from derive.ir.accesses import Accesses, is_ordered, iterations, met
from derive.ir.analysis import codes_in_order, names_read
from derive.ir.expressions import Element, Ends, Expr, LaneSum, Leaf, MatrixEntry, ScalarRef, walk
from derive.ir.forwarding import forwarded, without_idle_stores, without_unread_arrays, without_unread_values
from derive.ir.indices import ElementIndex, IndexTerm, Of, constant
from derive.ir.loop_nests import Assign, For, Local, Node, every, expressions_of, reindexed, rewritten
from derive.ir.nearby_reads import with_nearby_reads
from derive.ir.shared_places import with_shared_places
from derive.ir.statements import Let, Require

FEW = 2
"""The number of iterations that are worth the text of a loop that is divided for them; one is, among so few steps."""


def fused(nodes: Iterable[Node]) -> tuple[Node, ...]:
    """Plain statements with iterations of independent loops in the bodies of ordered loops.

    Nothing moves if indices need constant arrays. Of the codes of several requirements the first counts: where those
    with one code are checked before those with the next, they stay so, and elsewhere nothing moves.
    """
    result = tuple(nodes)
    if not any(isinstance(node, For) and node.overlaps for node in result) or not are_plain(result):
        return result
    known, codes = Accesses(), codes_in_order(result)
    whole = result
    while True:
        others = (move.made(result) for move in _moves(result, known, whole))
        moved = next((nodes for nodes in others if codes_in_order(nodes) == codes), None)
        if moved is None:
            break
        result = moved
    if result is whole:
        return result
    result = tuple(
        forwarded(_at_place(node)) if isinstance(node, For) and is_ordered(node) else node for node in result
    )
    stored = without_unread_arrays(without_idle_stores(with_nearby_reads(result)))
    return with_shared_places(without_unread_values(stored))


def _at_place(loop: For) -> For:
    """A loop of one iteration, in which elements have numbers alone."""
    if iterations(loop) != 1:
        return loop
    value = loop.start.offset
    body = tuple(reindexed(node, lambda index: index.with_value(loop.variable, value)) for node in loop.body)
    return replace(loop, body=body)


def are_plain(nodes: Sequence[Node]) -> bool:
    """Whether all indices are numbers of elements, counted from the variable of one loop with constant bounds."""
    lines = tuple(every(nodes))
    parts = [part for node in lines for expr in expressions_of(node) for part in walk(expr)]
    parts += [node.target for node in lines if isinstance(node, Assign)]
    terms = [term for part in parts if isinstance(part, Element) and part.index for term in part.index.terms]
    return (
        all(isinstance(node, Let | Require | Assign | Local | For) for node in lines)
        and all(isinstance(node.target, Element) for node in lines if isinstance(node, Assign))
        and all(node.count is not None for node in _loops(lines))
        and not any(isinstance(item, For) for node in _loops(nodes) for item in node.body)
        and not any(isinstance(part, Ends | LaneSum | MatrixEntry) for part in parts)
        and all(term.of is Of.VALUE for term in terms)
        and (bool(codes_in_order(nodes)) or not any(isinstance(node, Require) for node in lines))
    )


def _loops(nodes: Iterable[Node]) -> Iterator[For]:
    return (node for node in nodes if isinstance(node, For))


@dataclass(frozen=True)
class _Move:
    """`count` iterations of the loop `number` from `first` on, into loop `to` from its iteration `step` on.

    direction: whether successive iterations go to successive steps, 1, or to earlier ones, -1.
    """

    number: int
    to: int
    first: int
    step: int
    count: int
    direction: int

    def made(self, nodes: tuple[Node, ...]) -> tuple[Node, ...]:
        """The nodes after the move: each of the two loops is divided where its neighbours stay."""
        loop, into = nodes[self.number], nodes[self.to]
        assert isinstance(loop, For)
        assert isinstance(into, For)
        begin = loop.start.offset
        parts = [(begin, begin + self.first), (begin + self.first + self.count, loop.stop.offset)]
        left = [replace(loop, start=constant(a), stop=constant(b)) for a, b in parts if a < b]
        low = self.step if self.direction > 0 else self.step - self.count + 1
        pieces = [(0, low), (low, low + self.count), (low + self.count, iterations(into))]
        steps = [_piece(into, a, b) for a, b in pieces]
        here = steps[1]
        names = {node.name for node in here.body if isinstance(node, Let)}
        moved = tuple(_renamed(self._lines(loop, into), names))
        body = (*moved, *here.body) if self.to > self.number else (*here.body, *moved)
        divided = [part for part in (steps[0], replace(here, body=body), steps[2]) if iterations(part)]
        changed: dict[int, Sequence[Node]] = {self.number: left, self.to: divided}
        return tuple(part for k, node in enumerate(nodes) for part in changed.get(k, [node]))

    def _lines(self, loop: For, into: For) -> tuple[Node, ...]:
        """The body of the loop in terms of the variable of the piece of the other one."""
        first = self.first if self.direction > 0 else self.first + self.count - 1
        at, slope = loop.start.offset + first, self.direction
        if into.step < 0:
            at, slope = at + self.direction * (self.count - 1), -slope

        def change(index: ElementIndex) -> ElementIndex:
            stride = index.stride(loop.variable)
            moved = index.with_value(loop.variable, at)
            terms = (IndexTerm(slope * stride, into.variable),) if stride and self.count > 1 else ()
            return ElementIndex(moved.offset, (*moved.terms, *terms))

        return tuple(reindexed(node, change) for node in loop.body)


def _piece(loop: For, first: int, stop: int) -> For:
    """Some iterations of a loop, in the order of these, with a variable that begins at zero.

    The indices of a single one are numbers, in which what it stores is known to be what it reads.
    """
    lowest = loop.start.offset + loop.step * (first if loop.step > 0 else stop - 1)

    def change(index: ElementIndex) -> ElementIndex:
        moved = index.plus(lowest * index.stride(loop.variable))
        return moved.with_value(loop.variable, 0) if stop - first == 1 else moved

    body = tuple(reindexed(node, change) for node in loop.body)
    count = stop - first
    bounds = (0, count) if loop.step > 0 else (count - 1, -1)
    return replace(loop, start=constant(bounds[0]), stop=constant(bounds[1]), body=body)


def _renamed(lines: Iterable[Node], taken: set[str]) -> Iterator[Node]:
    """The lines of an instance, with other names of their values where these are taken."""
    lines = tuple(lines)
    own = {node.name for node in lines if isinstance(node, Let)}
    names: dict[str, str] = {}
    for name in sorted(own & taken):
        new = f"{name}_instance"
        while new in own | taken:
            new += "_"
        names[name] = new

    def leaf(item: Leaf) -> Expr:
        return ScalarRef(names[item.name]) if isinstance(item, ScalarRef) and item.name in names else item

    for node in lines:
        result = rewritten(node, leaf)
        yield replace(result, name=names.get(result.name, result.name)) if isinstance(result, Let) else result


def _moves(nodes: tuple[Node, ...], known: Accesses, whole: Sequence[Node]) -> Iterator[_Move]:
    """The moves of iterations that are possible, long runs of them first; whole: the nodes before any move."""
    undivided = {id(node) for node in whole}
    for least in (FEW, 1):
        for number, node in enumerate(nodes):
            if isinstance(node, For) and node.overlaps:
                for to, steps in _destinations(nodes, number, node, known):
                    into = nodes[to]
                    most = FEW if id(into) in undivided else 1
                    if is_ordered(into):
                        yield from (
                            _Move(number, to, *run)
                            for run in _runs(steps)
                            if run[2] >= least and (least > 1 or iterations(into) <= most)
                        )


def _destinations(
    nodes: tuple[Node, ...], number: int, loop: For, known: Accesses
) -> Iterator[tuple[int, dict[int, int]]]:
    """The nodes to which iterations may move, and the step there of each: first those below, then those above."""
    own, count, scalars = known.of(loop), iterations(loop), set(names_read(loop.body))
    for down in (True, False):
        left = set(range(count))
        for to in range(number + 1, len(nodes)) if down else range(number - 1, -1, -1):
            node = nodes[to]
            if isinstance(node, Let) and node.name in scalars:
                break
            limits = met(own, count, node, known.of(node))
            steps = {x: (first if down else last) for x, (first, last) in limits.items() if x in left}
            left -= limits.keys()
            if steps:
                yield to, steps
            if not left:
                break


def _runs(steps: dict[int, int]) -> Iterator[tuple[int, int, int, int]]:
    """Runs of iterations that go to successive steps: the first one, its step, their number, and the direction."""
    every_x = sorted(steps)
    at = 0
    while at < len(every_x):
        first, length, direction = every_x[at], 1, 1
        while at + length < len(every_x) and every_x[at + length] == first + length:
            change = steps[first + length] - steps[first + length - 1]
            if abs(change) != 1 or (length > 1 and change != direction):
                break
            direction, length = change, length + 1
        yield first, steps[first], length, direction
        at += length
