"""Instances that use a component of a local array one after the other share one place for it.

What a step of an elimination hands to the next one then stays in a few lines of the first-level cache, in place of a
line for each instance, which would displace what is kept for the back substitution.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from derive.ir.expressions import Element, Expr, Leaf, walk
from derive.ir.indices import constant
from derive.ir.loop_nests import Assign, For, Local, Node, expressions_of, rewritten

Component = tuple[str, int]
"""An array, and the number of one of its components."""
Access = tuple[Component, Element, bool]
"""A component, the element of it, and whether it is written."""


def with_shared_places(nodes: Sequence[Node]) -> tuple[Node, ...]:
    """Plain statements with fewer elements of local arrays; all indices count from the variable of one loop."""
    spacing = {n.array: n.spacing for n in nodes if isinstance(n, Local) and n.spacing and not n.cleared}
    shared = _shared(nodes, spacing)
    if not shared:
        return tuple(nodes)
    numbers: dict[str, list[int]] = {}
    for array, component in sorted(shared):
        numbers.setdefault(array, []).append(component)

    def leaf(item: Leaf) -> Expr:
        if isinstance(item, Element) and (of := _component(item, spacing)) in shared:
            return Element(_name(item.array), constant(numbers[item.array].index(of[1])))
        return item

    arrays = [Local(_name(array), len(components)) for array, components in numbers.items()]
    return (*arrays, *(rewritten(node, leaf) for node in nodes))


def _name(array: str) -> str:
    return f"{array}_in_turn"


def _component(element: Element, spacing: Mapping[str, int]) -> Component:
    assert element.index
    return element.array, element.index.offset // spacing.get(element.array, 1)


def _accesses(line: Node, spacing: Mapping[str, int]) -> Iterator[Access]:
    """The accesses of a line to the arrays: first those that read."""
    parts = [(part, False) for expr in expressions_of(line) for part in walk(expr)]
    if isinstance(line, Assign):
        parts += [(line.target, False)] if line.operator else []
        parts.append((line.target, True))
    for part, writes in parts:
        if isinstance(part, Element) and part.array in spacing:
            yield _component(part, spacing), part, writes


def _shared(nodes: Iterable[Node], spacing: Mapping[str, int]) -> set[Component]:
    """The components of which no element is read after another one was written."""
    current: dict[Component, int] = {}
    several: set[Component] = set()
    failed: set[Component] = set()
    for component, index, writes in _in_time(nodes, spacing):
        if current.get(component) != index:
            if not writes:
                failed.add(component)
            if component in current:
                several.add(component)
            current[component] = index
    return several - failed


def _in_time(nodes: Iterable[Node], spacing: Mapping[str, int]) -> Iterator[tuple[Component, int, bool]]:
    """All accesses in the order in which they happen, with the numbers of the elements."""
    for node in nodes:
        lines = node.body if isinstance(node, For) else (node,)
        accesses = [access for line in lines for access in _accesses(line, spacing)]
        for value in node.values({}) if isinstance(node, For) else (0,):
            for component, element, writes in accesses:
                assert element.index
                strides = sum(term.stride for term in element.index.terms)
                yield component, element.index.offset + strides * value, writes
