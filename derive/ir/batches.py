"""A kernel for many states at once: the loop over the states is the innermost one, inside each loop over the modes.

Each state has the operations of the kernel in their order, so its bits are equal. Arrays and scalars get a value for
each state; what all states share stays as it is.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import count, groupby

from derive.ir.analysis import accessed_by, names_read
from derive.ir.continuation import continued_loops
from derive.ir.early_sines import with_early_sines
from derive.ir.expansion import ZERO, expand_in_tiles
from derive.ir.expressions import Element, Ends, Expr, LaneSum, Leaf, ScalarRef, mapped
from derive.ir.fusion import fused
from derive.ir.indices import ElementIndex, constant, variable
from derive.ir.kernel import Argument, Kernel, View
from derive.ir.library_calls import STATE, Line, has_calls, over_states, straight_lines
from derive.ir.loop_nests import (
    START,
    Assign,
    BlockProduct,
    For,
    If,
    Local,
    LoopKind,
    Node,
    PartOf,
    Sines,
    ends_of,
    every,
    rewritten,
)
from derive.ir.ordering import with_few_waiting
from derive.ir.statements import Let, Require

SHARED = ("k", "u")
"""Arguments that all states of a batch share."""


@dataclass(frozen=True)
class Batch:
    """The plain statements of a kernel for many states; `scalars` are those with a value for each state."""

    nodes: tuple[Node, ...]
    scalars: frozenset[str]

    @property
    def arrays(self) -> dict[str, int]:
        """The local arrays with their numbers of elements, each of which has a value for each state.

        Those whose elements are kept under names in a loop that was fused of several are not among them.
        """
        targets = (node.target for node in every(self.nodes) if isinstance(node, Assign))
        accessed = {*names_read(self.nodes), *(target.array for target in targets if isinstance(target, Element))}
        local = (node for node in every(self.nodes) if isinstance(node, Local))
        return {node.array: node.size for node in local if node.array in accessed}


def state_arguments(kernel: Kernel) -> list[Argument]:
    """The arguments that have a value for each state."""
    return [a for a in kernel.arguments if not a.scalar and a.name not in SHARED]


def state_elements(kernel: Kernel) -> dict[str, Element]:
    """The named elements of these arguments."""
    elements = ((name, a.name, index) for a in state_arguments(kernel) for index, name in a.named_elements)
    return {name: Element(argument, constant(index), STATE) for name, argument, index in elements}


def state_views(kernel: Kernel) -> list[tuple[str, View]]:
    """The parts of these arguments that the kernel reads, with the names of the arguments."""
    return [(a.name, view) for a in state_arguments(kernel) for view in a.parts if view.name in kernel.used]


def batch(kernel: Kernel, instead: Iterable[Node] | None = None) -> Batch:
    """A kernel for many states; instead: plain statements in place of its own."""
    nodes = [node for argument, view in state_views(kernel) for node in _gathered(argument, view)]
    own = (node for statement in kernel.statements for node in expand_in_tiles(statement))
    nodes += own if instead is None else instead
    nodes = [*_initialised(continued_loops(_in_records(fused(_extended(_one_by_one(nodes))))))]
    arguments = frozenset(argument.name for argument in state_arguments(kernel))
    nodes = _in_loops(nodes, frozenset(state_elements(kernel)), arguments)
    if kernel.repeats:
        nodes = [*map(_reordered, with_early_sines(nodes, arguments))]
    scalars = _scalars(nodes) - state_elements(kernel).keys()
    shared = {a.name for a in kernel.arguments if a.name in SHARED}
    shared |= {view.name for a in kernel.arguments if a.name in SHARED for view in a.arrays}
    shared |= {array.name for array in kernel.constants}
    naming = _Naming(state_elements(kernel), scalars, frozenset(shared))
    return Batch(tuple(map(naming.node, nodes)), frozenset(scalars))


def _one_by_one(nodes: Iterable[Node]) -> Iterator[Node]:
    """Plain statements with a loop for each end of a path in place of loops over both.

    The loop of the first end is beside that of the joint that is left on its side, behind it and, in the back
    substitution, before it.
    """
    for node in nodes:
        if isinstance(node, For) and (names := {e.variable for e in ends_of(node)}):
            assert names == {node.variable}
            backward = any(isinstance(loop, For) and loop.step < 0 for loop in node.body)
            yield from (loop for end in ((0, 1) if backward else (1, 0)) for loop in _at_end(node, end).body)
        else:
            yield node


def _extended(nodes: Iterable[Node]) -> Iterator[Node]:
    """Plain statements with one loop in place of two with the same body, of which the second begins where one stops."""
    kept: list[Node] = []
    for node in nodes:
        last = kept[-1] if kept else None
        if isinstance(last, For) and isinstance(node, For) and node == replace(last, start=last.stop, stop=node.stop):
            kept[-1] = replace(last, stop=node.stop)
        else:
            kept.append(node)
    return iter(kept)


def _at_end(loop: For, end: int) -> For:
    """The iteration of a loop over both ends for one of them."""

    def leaf(item: Leaf) -> Expr:
        if isinstance(item, Ends):
            return item.of(end)
        if isinstance(item, Element) and item.index:
            return replace(item, index=item.index.with_value(loop.variable, end))
        return item

    body = tuple(rewritten(node, leaf) for node in loop.body)
    return replace(loop, start=constant(end), stop=constant(end + 1), body=body)


def _in_records(nodes: Iterable[Node]) -> Iterator[Node]:
    """Plain statements in which the components of an instance follow each other, where they were `spacing` apart.

    The states of a block are as long as the lines of a cache, so that neighbouring instances share none; and what an
    instance reads and writes is then in few pages.
    """
    nodes = tuple(nodes)
    arrays = {n.array: n for n in every(nodes) if isinstance(n, Local) and n.spacing}
    used = {array: set(range(n.size // n.spacing)) if n.cleared else set() for array, n in arrays.items()}
    for element in (element for node in every(nodes) for element in accessed_by(node)):
        if element.array in arrays:
            assert isinstance(element, Element) and element.index
            used[element.array].add(element.index.offset // arrays[element.array].spacing)
    components = {array: sorted(of) for array, of in used.items()}

    def leaf(item: Leaf) -> Expr:
        if not isinstance(item, Element) or item.array not in arrays:
            return item
        assert item.index
        spacing, own = arrays[item.array].spacing, components[item.array]
        component, place = divmod(item.index.offset, spacing)
        terms = (
            replace(t, stride=t.stride * len(own) if t.stride % spacing else t.stride // spacing)
            for t in item.index.terms
        )
        return replace(item, index=ElementIndex(own.index(component) + place * len(own), tuple(terms)))

    for node in nodes:
        if isinstance(node, Local) and node.array in arrays:
            yield replace(node, count=node.spacing * len(components[node.array]))
        else:
            yield rewritten(node, leaf)


def _gathered(argument: str, view: View) -> tuple[Node, ...]:
    """A local copy of a part of an argument, whose elements are closer together."""
    copied = Assign(Element(view.name, variable("i")), Element(argument, variable("i", 1, view.offset)))
    return Local(view.name, view.size), For("i", START, constant(view.size), (copied,))


def _initialised(nodes: Iterable[Node]) -> Iterator[Node]:
    """Loops that clear local arrays where these are declared: the lanes of sums, and the padding of vectors."""
    nodes = tuple(nodes)
    vectors = {node.vector.array for node in every(nodes) if isinstance(node, BlockProduct)}
    for declares, group in groupby(nodes, lambda node: isinstance(node, Local)):
        if not declares:
            yield from group
            continue
        parts: dict[tuple[int, int], list[str]] = {}
        for local in group:
            assert isinstance(local, Local)
            yield replace(local, cleared=False)
            if local.cleared or (local.array in vectors and local.count < local.size):
                parts.setdefault((0 if local.cleared else local.count, local.size), []).append(local.array)
        for (first, last), arrays in parts.items():
            zeros = (Assign(Element(array, variable("i")), ZERO) for array in arrays)
            yield For("i", constant(first), constant(last), tuple(zeros))


# ---- loops over the states ----


def _in_loops(nodes: Iterable[Node], states: frozenset[str], arguments: frozenset[str]) -> list[Node]:
    """Plain statements with straight lines in loops over the states, and sines of all states between them."""
    result: list[Node] = []
    lines: list[Line] = []
    runs = count(1)

    def finish() -> None:
        if lines:
            result.extend(straight_lines(tuple(lines), next(runs), states, arguments))
            lines.clear()

    for node in nodes:
        if isinstance(node, Let | Assign | Require):
            lines.append(node)
        elif isinstance(node, Local):
            result.append(node)
        else:
            finish()
            result.append(_inside(node, runs, states, arguments))
    finish()
    return result


def _inside(node: Node, runs: Iterator[int], states: frozenset[str], arguments: frozenset[str]) -> Node:
    """A loop over modes or instances with the lines of its body in loops over the states, after sines of all states."""
    if not isinstance(node, For):
        return node
    body: list[Node] = []
    for _, group in groupby(node.body, lambda item: isinstance(item, Let | Assign | Require)):
        items = tuple(group)
        lines = [item for item in items if isinstance(item, Let | Assign | Require)]
        if not lines:
            body += (_inside(item, runs, states, arguments) for item in items)
        elif has_calls(lines):
            body += straight_lines(tuple(lines), next(runs), states, arguments)
        else:
            body.append(over_states(lines))
    return replace(node, body=tuple(body), kind=LoopKind.ORDERED)


def _reordered(node: Node) -> Node:
    """A loop whose lines over the states leave few values waiting."""
    if not isinstance(node, For):
        return node
    over_states = node.kind is LoopKind.STATES
    return replace(node, body=with_few_waiting(node.body) if over_states else tuple(map(_reordered, node.body)))


# ---- values for each state ----


def _scalars(nodes: Iterable[Node]) -> set[str]:
    """Scalars that have an array: those computed in one loop over the states and read in another, angles and sines."""
    written: dict[str, int] = {}
    scalars: set[str] = set()
    for number, node in enumerate(every(nodes)):
        if isinstance(node, Sines):
            scalars |= {
                *([] if node.rows else [node.sine, node.cosine]),
                *([] if node.angle.index else [node.angle.array]),
            }
        if isinstance(node, For) and node.kind is LoopKind.STATES:
            own = {line.name for line in node.body if isinstance(line, Let)}
            for name in names_read(node.body):
                if name in written and written[name] != number and name not in own:
                    scalars.add(name)
            written |= dict.fromkeys(own, number)
    return scalars


@dataclass(frozen=True)
class _Naming:
    """Adds the index of the state to elements and scalars that differ from state to state.

    elements: the named elements of the states; scalars: those with an array; shared: the arrays that have no states.
    """

    elements: Mapping[str, Element]
    scalars: set[str]
    shared: frozenset[str]

    def node(self, node: Node) -> Node:
        """A plain statement outside of loops over the states."""
        match node:
            case For(kind=LoopKind.STATES):
                return replace(node, body=(*self._loads(node.body), *map(self._line, node.body)))
            case For() | PartOf():
                return replace(node, body=tuple(map(self.node, node.body)))
            case If():
                return replace(node, then=tuple(map(self.node, node.then)))
            case Sines():
                return replace(node, angle=self.elements.get(node.angle.array, node.angle))
            case _:
                return node

    def _loads(self, body: Iterable[Node]) -> list[Let]:
        """The named elements that a loop reads."""
        used = set(names_read(body))
        return [Let(name, element) for name, element in self.elements.items() if name in used]

    def _line(self, node: Node) -> Node:
        if isinstance(node, Let) and node.name in self.scalars:
            return self._line(Assign(Element(node.name, None), node.expr))
        return rewritten(node, self._leaf)

    def _leaf(self, leaf: Leaf) -> Expr:
        match leaf:
            case ScalarRef() if leaf.name in self.scalars:
                return Element(leaf.name, None, STATE)
            case Element() if leaf.array not in self.shared:
                return replace(leaf, state=STATE)
            case LaneSum():
                return mapped(leaf.expr, self._leaf)
            case _:
                return leaf
