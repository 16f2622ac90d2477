"""Lines in an order in which few values wait for their readers, so that most of them stay in registers.

Compilers keep the order of a long straight line, and store and load again what its registers have no room for. The next
line is the one after which the fewest values are waiting. All operations are those of the lines as they were, and so
are the bits.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from derive.ir.accesses import are_apart
from derive.ir.expressions import Element, Expr, ScalarRef, walk
from derive.ir.loop_nests import Assign, Node, expressions_of
from derive.ir.statements import Let, Require, ReturnCode

LONG = 1500
"""More lines keep their order: another one would take seconds to find."""


def with_few_waiting(lines: Sequence[Node]) -> tuple[Node, ...]:
    """Named values, assignments to elements and requirements in a good order, each behind what it needs.

    An element that a line names without computing is read where its first reader is, which may read it from memory.
    """
    if len(lines) > LONG:
        return tuple(lines)
    order = _Order(_Needs.of(lines))
    return tuple(lines[number] for number in order.chosen())


@dataclass(frozen=True)
class _Needs:
    """The lines that each line needs, by their numbers.

    before: the lines that have to precede a line, without loads; values: the lines whose values it reads; loads: those
    lines that name an element and compute nothing; overwritten: the loads of an element that a line writes.
    """

    before: list[set[int]]
    values: list[list[int]]
    loads: set[int]
    overwritten: list[set[int]]

    @staticmethod
    def of(lines: Sequence[Node]) -> _Needs:
        result = _Needs([], [], set(), [])
        named: dict[str, int] = {}
        known: defaultdict[str, list[tuple[int, Element, bool]]] = defaultdict(list)
        required: dict[ReturnCode, int] = {}
        for number, line in enumerate(lines):
            read = [part for expr in expressions_of(line) for part in walk(expr)]
            own = {named[part.name] for part in read if isinstance(part, ScalarRef) and part.name in named}
            accesses = [(element, writes) for element, writes in _accesses(line, read)]
            met = {
                other
                for element, writes in accesses
                for other, place, wrote in known[element.array]
                if (writes or wrote) and not are_apart(element, place)
            }
            if isinstance(line, Require):  # the first of several codes counts
                met |= {other for code, other in required.items() if code is not line.code}
                required[line.code] = number
            for load in own & result.loads:
                met |= result.before[load]
            result.before.append((own | met) - result.loads)
            result.values.append(sorted(own))
            result.overwritten.append(met & result.loads)
            for element, writes in accesses:
                known[element.array].append((number, element, writes))
            if isinstance(line, Let):
                named[line.name] = number
                if isinstance(line.expr, Element):
                    result.loads.add(number)
        return result


def _accesses(line: Node, read: Iterable[Expr]) -> Iterator[tuple[Element, bool]]:
    yield from ((part, False) for part in read if isinstance(part, Element))
    if isinstance(line, Assign) and isinstance(line.target, Element):
        yield line.target, True


class _Order:
    """The order of lines while it is made.

    readers: the lines to come that read the value of a line; idle: loads that are still to come; left: how many lines
    have still to precede a line; ready: the lines that may come next, with the change of the number of waiting values.
    """

    def __init__(self, needs: _Needs) -> None:
        self.values, self.overwritten, self.idle = needs.values, needs.overwritten, set(needs.loads)
        lines = [number for number in range(len(needs.before)) if number not in needs.loads]
        self.after: defaultdict[int, list[int]] = defaultdict(list)
        self.readers: defaultdict[int, set[int]] = defaultdict(set)
        for number in lines:
            for other in needs.before[number]:
                self.after[other].append(number)
            for value in needs.values[number]:
                self.readers[value].add(number)
        self.left = {number: len(needs.before[number]) for number in lines}
        self.ready = {number: self._change(number) for number in lines if not self.left[number]}

    def chosen(self) -> Iterator[int]:
        """The numbers of the lines in their order."""
        while self.ready:
            number = self._best()
            loads = sorted(self.idle & {*self.values[number], *self.overwritten[number]})
            self.idle.difference_update(loads)
            yield from (load for load in loads if self.readers[load])
            yield number
            self._place(number, loads)

    def _change(self, number: int, before: int = -1) -> int:
        """The change of the number of waiting values due to a line, if another one comes before it."""
        result = 1 if self.readers[number] else 0
        for value in {*self.values[number], *self.overwritten[number]}:
            others = self.readers[value] - {number, before}
            if value not in self.idle or before in self.readers[value]:
                result -= number in self.readers[value] and not others
            else:
                result += bool(others)
        return result

    def _best(self) -> int:
        """The line to come next."""
        least, *others = sorted(self.ready.values())[:2]
        lines = [number for number, change in self.ready.items() if change == least]
        other = min(0, others[0] if others else 0)
        return min(lines, key=lambda number: (self._follows(number, other), -self._share(number), number))

    def _follows(self, number: int, other: int) -> int:
        """The least change due to the line after a line; `other` is that due to lines that share nothing with it."""
        pairs = (self.readers[value] for value in self.values[number])
        last = [line for of in pairs if len(of) == 2 for line in of if line != number and line in self.ready]
        freed = [line for line in self.after[number] if self.left[line] == 1]
        return min([other, *(self._change(line, number) for line in (*last, *freed))])

    def _share(self, number: int) -> float:
        """The part of the waiting values that a line reads, where each reader of a value has an equal part of it."""
        return sum(1 / len(self.readers[value]) for value in self.values[number])

    def _place(self, number: int, loads: Iterable[int]) -> None:
        del self.ready[number]
        changed = {line for load in loads for line in self.readers[load]}
        for value in self.values[number]:
            self.readers[value].discard(number)
            changed |= self.readers[value]
        for line in self.after[number]:
            self.left[line] -= 1
            if not self.left[line]:
                self.ready[line] = self._change(line)
        for line in changed & self.ready.keys():
            self.ready[line] = self._change(line)
