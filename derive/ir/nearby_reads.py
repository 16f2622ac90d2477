"""Values that are read where they are in the cache already: numbers, and elements of arrays without instances.

An element of an instance that always has the value of one of them is not read, and then often need not be stored.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Sequence
from dataclasses import replace

from derive.ir.accesses import are_apart
from derive.ir.expressions import Element, Expr, Number, ScalarRef
from derive.ir.indices import constant
from derive.ir.loop_nests import Assign, For, Local, Node
from derive.ir.statements import Let

Place = tuple[str, int]
"""An array, and the number of one of its elements."""
Value = tuple[object, ...]
"""The origin of a value, which identifies it: a number, or the line that computes it in an iteration."""


def with_nearby_reads(nodes: Sequence[Node]) -> tuple[Node, ...]:
    """Plain statements, all of whose indices count from the variable of one loop, that read what is near."""
    local = {node.array: node.spacing for node in nodes if isinstance(node, Local)}
    cleared = {node.array for node in nodes if isinstance(node, Local) and node.cleared}
    far = {array for array, spacing in local.items() if spacing} - cleared
    nodes = [with_early_loads(node, far) if isinstance(node, For) else node for node in nodes]
    near = {array for array, spacing in local.items() if not spacing}
    values = _Values(nodes, near, far).replacements()
    return tuple(
        replace(node, body=tuple(_changed(line, values.get((number, k))) for k, line in enumerate(node.body)))
        if isinstance(node, For)
        else node
        for number, node in enumerate(nodes)
    )


def _changed(line: Node, value: Expr | None) -> Node:
    return replace(line, expr=value) if value is not None and isinstance(line, Let) else line


def with_early_loads(loop: For, arrays: Collection[str]) -> For:
    """A loop whose iterations first read the elements that they name, as far as they do not write them before."""
    early: list[Node] = []
    others: list[Node] = []
    written: list[Element] = []
    for line in loop.body:
        element = line.expr if isinstance(line, Let) else None
        if isinstance(element, Element) and element.array in arrays and all(are_apart(element, e) for e in written):
            early.append(line)
        else:
            others.append(line)
        if isinstance(line, Assign) and isinstance(line.target, Element):
            written.append(line.target)
    return replace(loop, body=(*early, *others))


class _Values:
    """The values of elements while all statements run, and the elements that hold each."""

    def __init__(self, nodes: Sequence[Node], near: Collection[str], far: Collection[str]) -> None:
        self.nodes, self.near, self.far = nodes, near, far
        self.values: dict[Place, Value] = {}
        self.holders: defaultdict[Value, set[Place]] = defaultdict(set)

    def replacements(self) -> dict[tuple[int, int], Expr]:
        """The values to read in place of elements, by the numbers of the node and of the line in it."""
        options: dict[tuple[int, int], set[Expr]] = {}
        for number, node in enumerate(self.nodes):
            lines = node.body if isinstance(node, For) else (node,)
            kept = [(k, line) for k, line in enumerate(lines) if isinstance(line, Assign) or self._reads_far(line)]
            for value in node.values({}) if isinstance(node, For) else (0,):
                for k, line in kept:
                    if isinstance(line, Assign):
                        self._assign(line, value, (number, k, value))
                    elif isinstance(line, Let) and isinstance(line.expr, Element):
                        own = self._options(_place(line.expr, value))
                        options[number, k] = options.get((number, k), own) & own
        return {at: min(of, key=repr) for at, of in options.items() if of}

    def _reads_far(self, line: Node) -> bool:
        return isinstance(line, Let) and isinstance(line.expr, Element) and line.expr.array in self.far

    def _assign(self, line: Assign, value: int, at: tuple[int, int, int]) -> None:
        assert isinstance(line.target, Element)
        place = _place(line.target, value)
        if place in self.values:
            self.holders[self.values[place]].discard(place)
        number, _, step = at
        new: Value = at
        if line.operator is None and isinstance(line.expr, Number):
            new = (line.expr,)
        elif line.operator is None and isinstance(line.expr, ScalarRef):
            new = (line.expr.name, number, step)
        self.values[place] = new
        self.holders[new].add(place)

    def _options(self, place: Place) -> set[Expr]:
        """The number, and the elements of near arrays, that have the value of an element."""
        value = self.values.get(place)
        if value is None:
            return set()
        (first, *others) = value
        numbers: set[Expr] = {first} if isinstance(first, Number) and not others else set()
        return numbers | {Element(a, constant(index)) for a, index in self.holders[value] if a in self.near}


def _place(element: Element, value: int) -> Place:
    """An element where the variable of the loop around has a value."""
    assert element.index
    return element.array, element.index.offset + value * sum(term.stride for term in element.index.terms)
