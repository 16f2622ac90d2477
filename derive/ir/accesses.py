"""The elements that plain statements access, and the iterations of loops that meet in one of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from derive.ir.expressions import Element, walk
from derive.ir.loop_nests import Assign, For, Local, LoopKind, Node, expressions_of


def is_ordered(node: Node) -> bool:
    """Whether a plain statement is a loop whose iterations run one after the other, up or down by one."""
    return isinstance(node, For) and node.kind is LoopKind.ORDERED and abs(node.step) == 1


@dataclass(frozen=True)
class Access:
    """The elements of an array that the iterations of a loop access: number first + stride * iteration."""

    array: str
    first: int
    stride: int
    writes: bool


def accesses_of(node: Node) -> set[Access]:
    """The accesses of a plain statement, those of a loop counted in the order of its iterations."""
    if isinstance(node, For):
        start = node.start.offset
        return {
            Access(a.array, a.first + a.stride * start, a.stride * node.step, a.writes)
            for item in node.body
            for a in _of_line(item, node.variable)
        }
    return _of_line(node, "")


def _of_line(node: Node, variable: str) -> set[Access]:
    parts = [(part, False) for expr in expressions_of(node) for part in walk(expr)]
    if isinstance(node, Assign):
        parts.append((node.target, True))
    return {
        Access(part.array, part.index.offset, part.index.stride(variable), writes)
        for part, writes in parts
        if isinstance(part, Element) and part.index
    }


class Accesses(dict[int, tuple[Node, set[Access]]]):
    """The accesses of plain statements, each of which is looked at once."""

    def of(self, node: Node) -> set[Access]:
        """The accesses of a plain statement."""
        if id(node) not in self:
            self[id(node)] = node, accesses_of(node)
        return self[id(node)][1]


def iterations(node: Node) -> int:
    """The number of iterations of a plain statement, 1 if it is no loop."""
    return (node.count or 0) if isinstance(node, For) else 1


def met(own: set[Access], count: int, node: Node, accesses: set[Access]) -> dict[int, tuple[int, int]]:
    """The first and the last iteration of a node that share elements with each iteration of a loop, by the latter.

    own, count: the accesses of the loop that they belong to, and the number of its iterations; accesses: those of the
    node. Other iterations may pass the node. Iterations stay behind a declaration of their arrays.
    """
    others = iterations(node)
    if isinstance(node, Local):
        declares = any(access.array == node.array for access in own)
        return dict.fromkeys(range(count), (0, 0)) if declares else {}
    lines: set[tuple[int, int, int]] = set()
    for a in own:
        for b in accesses:
            if a.array == b.array and (a.writes or b.writes):
                lines.add((a.stride, b.stride, b.first - a.first))
    result: dict[int, tuple[int, int]] = {}
    for stride, other, distance in lines:
        for x, s in _solutions(stride, other, distance, count, others):
            first, last = result.get(x, (s, s))
            result[x] = min(first, s), max(last, s)
    return result


def _solutions(stride: int, other: int, distance: int, count: int, others: int) -> Iterator[tuple[int, int]]:
    """The pairs of iterations x < count and s < others with stride * x = distance + other * s."""
    for s in _between(-distance, stride * (count - 1) - distance, other, others):
        if not stride:
            yield from ((x, s) for x in range(count))
        elif not (distance + other * s) % stride:
            yield (distance + other * s) // stride, s


def _between(one: int, two: int, slope: int, count: int) -> range:
    """The numbers s < count for which slope * s is between two numbers."""
    low, high = min(one, two), max(one, two)
    if not slope:
        return range(count if low <= 0 <= high else 0)
    if slope < 0:
        slope, low, high = -slope, -high, -low
    return range(max(0, -(-low // slope)), min(count, high // slope + 1))


def are_apart(a: Element, b: Element) -> bool:
    """Whether two elements differ in all iterations."""
    if a.array != b.array or a.index is None or b.index is None:
        return a.array != b.array
    return set(a.index.terms) == set(b.index.terms) and a.index.offset != b.index.offset
