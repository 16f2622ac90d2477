"""Places of the numbers of an instance: indices that count from a loop variable, or from a constant array."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from derive.ir.indices import ElementIndex, IndexTerm, constant
from derive.ir.kernel import ConstantArray
from derive.ir.statements import Entry


@dataclass(frozen=True)
class Place:
    """The index of a first element for each instance of a loop, and the statement that names it, if it needs one."""

    first: ElementIndex
    entry: Entry | None = None
    spacing: int = 1
    """The distance of the elements of an instance."""

    @property
    def entries(self) -> tuple[Entry, ...]:
        """The statement that names it, if it needs one."""
        return () if self.entry is None else (self.entry,)

    def at(self, number: int) -> ElementIndex:
        """The index of an element, counted from the first one."""
        return self.first.plus(number * self.spacing)


@dataclass
class Places:
    """The constant arrays of a model, by their names, as loops come to need them."""

    arrays: dict[str, ConstantArray] = field(default_factory=dict)

    def place(self, name: str, variable: str, firsts: Sequence[int], spacing: int = 1) -> Place:
        """The place of the first elements `firsts` of the instances that a variable counts.

        name: that of the constant array and of the integer, if the elements are not equally spaced.
        """
        stride = firsts[1] - firsts[0] if len(firsts) > 1 else 0
        if all(first == firsts[0] + stride * n for n, first in enumerate(firsts)):
            first = ElementIndex(firsts[0], (IndexTerm(stride, variable),)) if stride else constant(firsts[0])
            return Place(first, spacing=spacing)
        array = self.integers(f"of_{name}", firsts)  # no integer is called so
        return Place(
            ElementIndex(0, (IndexTerm(1, name),)),
            Entry(name, array, ElementIndex(0, (IndexTerm(1, variable),))),
            spacing,
        )

    def integers(self, name: str, values: Iterable[int]) -> str:
        """The name of a constant array of integers, which is added; equal arrays of one name are one."""
        return self._add(ConstantArray(name, tuple(values), True))

    def numbers(self, array: ConstantArray) -> str:
        """The name of a constant array of numbers, which is added."""
        return self._add(array)

    def _add(self, array: ConstantArray) -> str:
        known = self.arrays.setdefault(array.name, array)
        assert known == array, f"two constant arrays are called {array.name}"
        return array.name
