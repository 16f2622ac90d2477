"""Sines of the states of a batch one instance ahead, so that their long chains of operations overlap with other work.

A processor looks some hundred instructions ahead. Where the lines of an instance follow its sines, they fill this view
and wait. In a loop that keeps its sines and cosines in local arrays, those of the next instance are computed before the
lines of this one, and those of first instances all together. They are stored where they are kept.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from derive.ir.expressions import Element, ScalarRef
from derive.ir.fusion import are_plain
from derive.ir.loop_nests import Assign, For, If, LoopKind, Node, Sines, reindexed
from derive.ir.statements import Let

Place = tuple[str, int]
"""An array, and the number of one of its elements."""


def with_early_sines(nodes: Sequence[Node], arguments: frozenset[str]) -> tuple[Node, ...]:
    """Plain statements with loops over states, in which sines come early; arguments: the arrays of angles.

    Nothing changes if indices need constant arrays.
    """
    flat = tuple(_without_states(nodes))
    if not are_plain(flat):
        return tuple(nodes)
    written = Counter(place for node in flat for place in _written(node))
    changed = {
        number: early
        for number, node in enumerate(nodes)
        if isinstance(node, For) and (early := _early(node, arguments, written))
    }
    first = tuple(sines for early in changed.values() for sines in early.first)
    loops = [changed[number].loop if number in changed else node for number, node in enumerate(nodes)]
    begin = min(changed, default=0)
    return (*loops[:begin], *first, *loops[begin:])


def _without_states(nodes: Iterable[Node]) -> Iterator[Node]:
    """Plain statements without their loops over states, and without sines."""
    for node in nodes:
        if isinstance(node, For) and node.kind is LoopKind.STATES:
            yield from node.body
        elif isinstance(node, For):
            yield replace(node, body=tuple(_without_states(node.body)))
        elif not isinstance(node, Sines):
            yield node


def _written(node: Node) -> Iterator[Place]:
    """All elements that a plain statement writes, one as often as it does so."""
    for line in node.body if isinstance(node, For) else (node,):
        if isinstance(line, Assign) and isinstance(line.target, Element) and line.target.index:
            for value in node.values({}) if isinstance(node, For) else (0,):
                values = {node.variable: value} if isinstance(node, For) else {}
                yield line.target.array, line.target.index.at(values)


@dataclass(frozen=True)
class _Early:
    """A loop whose sines come early, and those of its first iteration."""

    loop: For
    first: tuple[Node, ...]


def _early(node: For, arguments: frozenset[str], written: Counter[Place]) -> _Early | None:
    """A loop that begins with sines, stores them in places that nothing else writes, and has no other calls."""
    *sines, over_states = node.body
    if not sines or not isinstance(over_states, For) or node.step != 1:
        return None
    stores = {
        line.expr.name: line
        for line in over_states.body
        if isinstance(line, Assign) and isinstance(line.expr, ScalarRef) and line.operator is None
    }
    kept: list[Sines] = []
    for item in sines:
        if not isinstance(item, Sines) or item.angle.array not in arguments:
            return None
        targets = [stores[name].target for name in (item.sine, item.cosine) if name in stores]
        elements = [e for e in targets if isinstance(e, Element) and e.index and _is_own(e, node, written)]
        if len(elements) < 2:
            return None
        sine, cosine = elements
        assert sine.index
        assert cosine.index
        kept.append(Sines(item.angle, sine.array, cosine.array, rows=(sine.index, cosine.index)))
    names = {name for item in sines if isinstance(item, Sines) for name in (item.sine, item.cosine)}
    loads = [Let(name, stores[name].target) for name in sorted(names)]
    lines = (line for line in over_states.body if not any(line is stores[name] for name in names))
    states = replace(over_states, body=(*loads, *lines))
    first, last = node.start.offset, node.stop.offset - 1
    following = tuple(reindexed(item, lambda index: index.plus(index.stride(node.variable))) for item in kept)
    ahead = (If(node.variable, last, following, ()),) if last > first else ()
    begin = tuple(reindexed(item, lambda index: index.with_value(node.variable, first)) for item in kept)
    return _Early(replace(node, body=(*ahead, states)), begin)


def _is_own(element: Element, node: For, written: Counter[Place]) -> bool:
    """Whether nothing else writes an element in any iteration."""
    assert element.index
    return all(written[element.array, element.index.at({node.variable: value})] == 1 for value in node.values({}))
