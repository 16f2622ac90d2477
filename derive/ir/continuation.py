"""Loops that continue the loops before them, in one loop with these: one text for all iterations.

Bodies with other joints have code of their own, since their joints matter. Where they do not, as in the mass
matrix, the loops of these bodies differ in names and in the elements that they access alone; and where the elements
follow each other as the iterations do, one loop has the iterations of both, with their operations in their order.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from itertools import combinations
from typing import Any

from derive.errors import TisserandError
from derive.ir.analysis import reads
from derive.ir.expressions import Element, ScalarRef
from derive.ir.indices import ElementIndex, IndexTerm, Of, constant
from derive.ir.loop_nests import For, Integer, LoopKind, Node
from derive.ir.statements import Entry, ForEach, Let, Statement, StoreElement, inside


def continued_statements(statements: Iterable[Statement]) -> Iterator[Statement]:
    """Statements with one loop over instances in place of neighbouring ones that continue each other."""
    kept: list[Statement] = []
    for item in statements:
        joined = _one_for_each(kept[-1], item) if kept else None
        if joined is None:
            kept.append(item)
        else:
            kept[-1] = joined
    return iter(kept)


def _one_for_each(first: Statement, second: Statement) -> Statement | None:
    """The loop over instances with the iterations of two, if the second one continues the first."""
    if not isinstance(first, ForEach) or not isinstance(second, ForEach) or first.backward or second.backward:
        return None
    if replace(first, start=second.start, stop=second.stop, body=second.body) != second:
        return None
    runs = (_run(loop.start, loop.stop) for loop in (first, second))
    joined = _joined(first.variable, (*runs,), first.body, second.body)
    if joined is None:
        return None
    run, body = joined
    loop = replace(first, start=constant(run.start), stop=constant(run.stop), body=body)
    return loop if not loop.independent or _writes_apart(loop, len(run)) else None


def continued_loops(nodes: Iterable[Node]) -> Iterator[Node]:
    """Plain statements with one ordered loop in place of neighbouring ones that continue each other.

    The order of bodies does not matter; they get that in which their loops come.
    """
    kept: list[Node] = []
    for node in nodes:
        item = node
        if isinstance(node, For) and node.overlaps:
            item = replace(node, kind=LoopKind.ORDERED, overlaps=False)
        joined = _one_loop(kept[-1], item) if kept else None
        if joined is None:
            kept.append(item)
        else:
            kept[-1] = joined
    return iter(kept)


def _one_loop(first: Node, second: Node) -> Node | None:
    """The loop with the iterations of two, if the second one continues the first."""
    if not isinstance(first, For) or not isinstance(second, For) or first.kind is not LoopKind.ORDERED:
        return None
    if replace(first, start=second.start, stop=second.stop, step=second.step, body=second.body) != second:
        return None
    runs = tuple(_run(loop.start, loop.stop, loop.step) for loop in (first, second))
    if any(len(run) > 1 and abs(run.step) != 1 for run in runs):
        return None
    joined = _joined(first.variable, runs, first.body, second.body)
    if joined is None:
        return None
    run, body = joined
    return replace(first, start=constant(run.start), stop=constant(run.stop), step=run.step, body=body)


def _run(start: ElementIndex, stop: ElementIndex, step: int = 1) -> range:
    """The values of the variable of a loop; none if they depend on other variables."""
    return range(0) if start.terms or stop.terms else range(start.offset, stop.offset, step)


def _joined(
    variable: str, runs: tuple[range, ...], first: tuple[Any, ...], second: tuple[Any, ...]
) -> tuple[range, tuple[Any, ...]] | None:
    """The values of the variable of the loop that has the iterations of two, and its body, if the bodies agree."""
    before, after = runs
    if not before or not after:
        return None
    step = after.step if len(before) == 1 else before.step
    whole = range(len(before) + len(after))[::step]
    try:
        return whole, _Agreement(variable, before, after, whole).of(first, second)
    except _DifferentError:
        return None


class _DifferentError(TisserandError):
    """Two bodies differ in more than names, and elements that follow each other."""


@dataclass
class _Agreement:
    """The body of the loop with the iterations of two loops.

    before, after, whole: the values of the variable in the two loops and in the new one. names: those of the first
    body, by those of the second.
    """

    variable: str
    before: range
    after: range
    whole: range
    names: dict[str, str] = field(default_factory=dict)

    def of(self, a: Any, b: Any) -> Any:
        """The value that stands for two parts of the bodies at the same place. Raises _DifferentError."""
        if type(a) is not type(b):
            raise _DifferentError
        match a:
            case ElementIndex():
                return self._index(a, b)
            case ScalarRef():
                return self._named(a, b)
            case Let() | Entry() | Integer():
                result = self._parts(a, replace(b, name=a.name))
                self.names[b.name] = a.name
                return result
            case tuple():
                if len(a) != len(b):
                    raise _DifferentError
                return tuple(self.of(x, y) for x, y in zip(a, b, strict=True))
        return self._parts(a, b) if is_dataclass(a) else self._equal(a, b)

    def _parts(self, a: Any, b: Any) -> Any:
        values = {f.name: self.of(getattr(a, f.name), getattr(b, f.name)) for f in fields(a)}
        return replace(a, **values)

    @staticmethod
    def _equal(a: Any, b: Any) -> Any:
        if a != b:
            raise _DifferentError
        return a

    def _named(self, a: ScalarRef, b: ScalarRef) -> ScalarRef:
        self._equal(a.name, self.names.get(b.name, b.name))
        return a

    def _index(self, a: ElementIndex, b: ElementIndex) -> ElementIndex:
        """The index whose elements are those of both: a line through the first one of each, and through all others."""
        terms = self._equal(self._others(a, {}), self._others(b, self.names))
        first, last = (a.offset + a.stride(self.variable) * value for value in (self.before[0], self.before[-1]))
        distance = b.offset + b.stride(self.variable) * self.after[0] - last
        for index, run in ((a, self.before), (b, self.after)):
            if len(run) > 1:
                self._equal(index.stride(self.variable) * run.step, distance)
        stride = distance * self.whole.step
        own = (IndexTerm(stride, self.variable),) if stride else ()
        return ElementIndex(first - stride * self.whole[0], (*own, *terms))

    def _others(self, index: ElementIndex, names: Mapping[str, str]) -> tuple[IndexTerm, ...]:
        """The terms of other variables than that of the loop, under the names of the first body."""
        return tuple(replace(t, variable=names.get(t.variable, t.variable)) for t in index.terms if not self._is_own(t))

    def _is_own(self, term: IndexTerm) -> bool:
        if term.variable == self.variable and term.of is not Of.VALUE:
            raise _DifferentError
        return term.variable == self.variable


def _writes_apart(loop: ForEach, count: int) -> bool:
    """Whether so many iterations write elements of their own, which none of them reads."""
    targets = [item.target for item in inside(loop) if isinstance(item, StoreElement)]
    indices: dict[str, list[ElementIndex]] = {}
    for target in targets:
        index = target.index if isinstance(target, Element) else None
        if index is None or any(term.variable != loop.variable for term in index.terms):
            return False
        indices.setdefault(target.array, []).append(index)
    apart = all(_are_apart(own, loop.variable, count) for own in indices.values())
    return apart and indices.keys().isdisjoint(reads(loop))


def _are_apart(indices: list[ElementIndex], variable: str, count: int) -> bool:
    """Whether the elements of an array at some indices are others in each of so many iterations."""
    strides = {index.stride(variable) for index in indices}
    if len(strides) > 1 or 0 in strides:
        return False
    (stride,) = strides
    quotients = (divmod(b.offset - a.offset, stride) for a, b in combinations(indices, 2))
    return all(rest or quotient == 0 or abs(quotient) >= count for quotient, rest in quotients)
