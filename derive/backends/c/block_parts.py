"""Long loops over bodies in a block of states as functions of their own, which the function of the block calls.

Compilers follow every element from each access to all others in a function, so that the time they take grows faster
than its text; and they find registers for a loop alone. A call for eight states is no measurable part of their time.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, takewhile

from derive.ir.analysis import names_read
from derive.ir.expressions import Element
from derive.ir.loop_nests import Assign, For, LoopKind, Node, Sines, every
from derive.ir.statements import Require

LONG = 100
"""The lines of a loop that is worth a function, and those of shorter statements between such loops."""


@dataclass(frozen=True)
class BlockPart:
    """Statements of a block, in their order.

    apart: whether they are worth a function; names: what they read and write: arrays, arguments and values.
    """

    nodes: tuple[Node, ...]
    apart: bool

    @property
    def names(self) -> frozenset[str]:
        """The names of arrays, arguments and values that the statements read or write."""
        targets = (node.target for node in every(self.nodes) if isinstance(node, Assign))
        sines = (node for node in every(self.nodes) if isinstance(node, Sines))
        written = [array for node in sines for array in (node.sine, node.cosine)]
        written += [target.array for target in targets if isinstance(target, Element)]
        return frozenset((*names_read(self.nodes), *written))

    @property
    def sines(self) -> bool:
        """Whether the statements are sines alone."""
        return all(isinstance(node, Sines) for node in self.nodes)

    @property
    def checked(self) -> bool:
        """Whether the statements may change the codes of states."""
        return any(isinstance(node, Require) for node in every(self.nodes))


def block_parts(nodes: Sequence[Node], several: bool) -> list[BlockPart]:
    """The parts of a block, of which sines at its beginning are one; several: whether functions may be made of them."""
    if not several:
        first = len(tuple(takewhile(lambda node: isinstance(node, Sines), nodes)))
        return [BlockPart(tuple(part), False) for part in (nodes[:first], nodes[first:]) if part]
    return [BlockPart(part, _lines(part) >= LONG) for part in _divided(nodes)]


def _divided(nodes: Iterable[Node]) -> Iterator[tuple[Node, ...]]:
    """Long loops alone, and what is between them."""
    for is_long, group in groupby(nodes, lambda node: _is_ordered(node) and _lines([node]) >= LONG):
        if is_long:
            yield from ((node,) for node in group)
        else:
            yield tuple(group)


def _is_ordered(node: Node) -> bool:
    return isinstance(node, For) and node.kind is LoopKind.ORDERED


def _lines(nodes: Iterable[Node]) -> int:
    return sum(not isinstance(node, For) for node in every(nodes))
