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
    """Named values, assignments to elements and requirements in a good order, each behind what it needs."""
    if len(lines) > LONG:
        return tuple(lines)
    order = _Order(_Needs.of(lines))
    return tuple(lines[number] for number in order.chosen())


@dataclass(frozen=True)
class _Needs:
    """What lines need, by their numbers.

    before: the lines that have to precede a line; values: those of them whose values it reads.
    """

    before: list[set[int]]
    values: list[list[int]]

    @staticmethod
    def of(lines: Sequence[Node]) -> _Needs:
        before: list[set[int]] = []
        values: list[list[int]] = []
        named: dict[str, int] = {}
        known: defaultdict[str, list[tuple[int, Element, bool]]] = defaultdict(list)
        required: dict[ReturnCode, int] = {}
        for number, line in enumerate(lines):
            read = [part for expr in expressions_of(line) for part in walk(expr)]
            own = {named[part.name] for part in read if isinstance(part, ScalarRef) and part.name in named}
            values.append(sorted(own))
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
            before.append(own | met)
            for element, writes in accesses:
                known[element.array].append((number, element, writes))
            if isinstance(line, Let):
                named[line.name] = number
        return _Needs(before, values)


def _accesses(line: Node, read: Iterable[Expr]) -> Iterator[tuple[Element, bool]]:
    yield from ((part, False) for part in read if isinstance(part, Element))
    if isinstance(line, Assign) and isinstance(line.target, Element):
        yield line.target, True


class _Order:
    """The order of lines while it is made.

    readers: the lines to come that read the value of a line; left: how many lines have still to precede a line; ready:
    the lines that may come next, with the change of the number of waiting values.
    """

    def __init__(self, needs: _Needs) -> None:
        self.values = needs.values
        lines = range(len(needs.before))
        self.after: list[list[int]] = [[] for _ in lines]
        self.readers: list[set[int]] = [set() for _ in lines]
        for number in lines:
            for other in needs.before[number]:
                self.after[other].append(number)
            for value in needs.values[number]:
                self.readers[value].add(number)
        self.left = [len(before) for before in needs.before]
        self.ready = {number: self._change(number) for number in lines if not self.left[number]}

    def chosen(self) -> Iterator[int]:
        """The numbers of the lines in their order."""
        while self.ready:
            number = self._best()
            yield number
            self._place(number)

    def _change(self, number: int, before: int = -1) -> int:
        """The change of the number of waiting values due to a line, if another one comes before it."""
        readers = (self.readers[value] for value in self.values[number])
        ended = sum(len(of) == 1 or (len(of) == 2 and before in of) for of in readers)
        return bool(self.readers[number]) - ended

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

    def _place(self, number: int) -> None:
        del self.ready[number]
        for value in self.values[number]:
            self.readers[value].discard(number)
            for line in self.readers[value] if len(self.readers[value]) == 1 else ():
                if line in self.ready:
                    self.ready[line] = self._change(line)
        for line in self.after[number]:
            self.left[line] -= 1
            if not self.left[line]:
                self.ready[line] = self._change(line)
