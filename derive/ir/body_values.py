"""The values of the body of a loop: which are the same in several bodies, and statements for some of them alone."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterable, Mapping, Sequence
from dataclasses import replace

from derive.ir.expressions import Element, Expr, Leaf, Operation, ScalarRef, TableValue, mapped, walk
from derive.ir.indices import ElementIndex
from derive.ir.loop_nests import Assign, Integer, Node
from derive.ir.statements import Let

Numbers = dict[Hashable, int]
"""The number of each value: the same for equal operations on equal operands, whatever their names."""


class BodyValues:
    """The statements of the body of a loop, with the numbers of their values."""

    def __init__(self, nodes: Sequence[Node], numbers: Numbers) -> None:
        self.nodes, self._numbers = nodes, numbers
        self.of_names: dict[str, int] = {}
        for node in nodes:
            if isinstance(node, Let):
                self.of_names[node.name] = self.number(node.expr)
            elif isinstance(node, Integer):
                self.of_names[node.name] = self._of(node.array, self.place(node.index), node.times)

    @property
    def assignments(self) -> dict[int, Assign]:
        """The assignments, by their places in the body."""
        return {n: node for n, node in enumerate(self.nodes) if isinstance(node, Assign)}

    def _of(self, *key: Hashable) -> int:
        return self._numbers.setdefault(key, len(self._numbers))

    def place(self, index: ElementIndex | None) -> Hashable:
        """An index with numbers in place of integers that the body names."""
        assert index is not None
        return index.offset, tuple((t.stride, self.of_names.get(t.variable, t.variable), t.of) for t in index.terms)

    def target(self, node: Assign) -> Hashable:
        """The element to which a statement assigns."""
        assert isinstance(node.target, Element)
        return node.target.array, self.place(node.target.index)

    def number(self, expr: Expr) -> int:
        """The number of the value of an expression."""
        match expr:
            case ScalarRef():
                return self.of_names[expr.name] if expr.name in self.of_names else self._of(expr)
            case Element():
                return self._of(expr.array, self.place(expr.index))
            case Operation():
                return self._of(expr.kind, *map(self.number, expr.args))
            case TableValue():
                return self._of(expr.table, expr.order, self.number(expr.argument))
            case _:
                return self._of(expr)


def matched(columns: Sequence[Sequence[tuple[int, Hashable]]]) -> list[tuple[int, ...]]:
    """The longest sequence of equal keys that is in all of some sequences of places with keys: their places in each."""
    first, *others = columns
    result: list[tuple[tuple[int, ...], Hashable]] = [((n,), key) for n, key in first]
    for other in others:
        result = [((*result[a][0], other[b][0]), result[a][1]) for a, b in _longest(result, other)]
    return [places for places, _ in result]


def _longest(a: Sequence[tuple[object, Hashable]], b: Sequence[tuple[object, Hashable]]) -> list[tuple[int, int]]:
    """The longest common subsequence of the keys of two sequences, as pairs of indices."""
    lengths = [[0] * (len(b) + 1) for _ in range(len(a) + 1)]
    for i in reversed(range(len(a))):
        for j in reversed(range(len(b))):
            longer = max(lengths[i + 1][j], lengths[i][j + 1])
            lengths[i][j] = 1 + lengths[i + 1][j + 1] if a[i][1] == b[j][1] else longer
    pairs, i, j = [], 0, 0
    while i < len(a) and j < len(b):
        if a[i][1] == b[j][1]:
            pairs.append((i, j))
            i, j = i + 1, j + 1
        elif lengths[i + 1][j] >= lengths[i][j + 1]:
            i += 1
        else:
            j += 1
    return pairs


class Scope:
    """The values that a part of a function has named, by their numbers; `taken` are all names in it."""

    def __init__(self, taken: Iterable[str], names: Mapping[int, str] | None = None) -> None:
        self.taken, self.names = set(taken), dict(names or {})

    def inner(self) -> Scope:
        """The scope of a part inside."""
        return Scope(self.taken, self.names)

    def new(self, name: str, others: Collection[str] = ()) -> str:
        """A name that begins with this one, is not taken and none of some others."""
        result, count = name, 1
        while result in self.taken or result in others:
            count += 1
            result = f"{name}_{count}"
        self.taken.add(result)
        return result

    def written(self, body: BodyValues, chosen: Collection[int], targets: Mapping[int, Sequence[Node]]) -> list[Node]:
        """Some assignments of a body, with the values that they need and that have no name yet.

        chosen: the places of the assignments; targets: for some of them the statements in their place, whose last one
        is the assignment.
        """
        wanted = self._needed(body, chosen, targets)
        renamed: dict[str, str] = {}
        result: list[Node] = []
        for n, node in enumerate(body.nodes):
            if isinstance(node, Assign):
                if n in chosen:
                    result += (_renamed(item, renamed) for item in targets.get(n, (node,)))
            elif isinstance(node, Let | Integer):
                number = body.of_names[node.name]
                if number not in self.names and node.name in wanted:
                    self.names[number] = self.new(node.name)
                    named = replace(node, name=self.names[number])
                    result.append(_renamed(named, renamed))
                if number in self.names:
                    renamed[node.name] = self.names[number]
        return result

    def _needed(self, body: BodyValues, chosen: Collection[int], targets: Mapping[int, Sequence[Node]]) -> set[str]:
        """The names in a body that some assignments and the values that these need read."""
        names: set[str] = set()
        for n, node in reversed([*enumerate(body.nodes)]):
            if n in chosen:
                for item in targets.get(n, (node,)):
                    names |= set(_read(item))
            elif isinstance(node, Let | Integer) and node.name in names and body.of_names[node.name] not in self.names:
                names |= set(_read(node))
        return names


def _read(node: Node) -> Iterable[str]:
    """The names of numbers and of integers that a statement reads."""
    exprs = (node.expr,) if isinstance(node, Let) else (node.target, node.expr) if isinstance(node, Assign) else ()
    indices = [node.index] if isinstance(node, Integer) else []
    for part in (part for expr in exprs for part in walk(expr)):
        if isinstance(part, ScalarRef):
            yield part.name
        elif isinstance(part, Element) and part.index is not None:
            indices.append(part.index)
    yield from (term.variable for index in indices for term in index.terms)


def _renamed(node: Node, names: Mapping[str, str]) -> Node:
    """A statement with other names of the numbers and integers that it reads."""

    def index(of: ElementIndex) -> ElementIndex:
        return replace(of, terms=tuple(replace(t, variable=names.get(t.variable, t.variable)) for t in of.terms))

    def leaf(item: Leaf) -> Expr:
        if isinstance(item, ScalarRef):
            return replace(item, name=names.get(item.name, item.name))
        return replace(item, index=index(item.index)) if isinstance(item, Element) and item.index else item

    match node:
        case Let():
            return replace(node, expr=mapped(node.expr, leaf))
        case Assign():
            target = leaf(node.target)
            assert isinstance(target, Element)
            return replace(node, target=target, expr=mapped(node.expr, leaf))
        case Integer():
            return replace(node, index=index(node.index))
    raise AssertionError("a body has values, integers and assignments")
