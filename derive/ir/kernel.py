"""A function of the generated code: a small program in static single assignment, with its arguments and outputs.

It stands between the mechanics and the emitted text and consists of sections that follow the physics; it knows numbers,
names and operations, no mechanics and no language.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from functools import cached_property
from typing import Any

from derive.ir.analysis import operations, reads
from derive.ir.patterns import Pattern
from derive.ir.statements import ForEach, Require, Statement, inside


@dataclass(frozen=True)
class Section:
    """A named part of a kernel.

    equation: the numbers of the equations of the paper that it computes, in parentheses, or a `Source`; empty if there
    is neither. doc: what it computes, in words.
    """

    name: str
    equation: str
    doc: str
    body: tuple[Statement, ...]


@dataclass(frozen=True)
class View:
    """An array that is a part of an argument."""

    name: str
    offset: int
    size: int


@dataclass(frozen=True)
class Argument:
    """An input: a scalar (no elements) or an array whose elements have names.

    `arrays` are parts of it with one name, or the whole under its own name; `positions` are the indices of the named
    elements, if those do not follow each other from 0. integer: whether a scalar is one from which indices count.
    """

    name: str
    elements: tuple[str, ...]
    doc: str
    scalar: bool = False
    arrays: tuple[View, ...] = ()
    positions: tuple[int, ...] = ()
    integer: bool = False

    @property
    def named_elements(self) -> tuple[tuple[int, str], ...]:
        """The index and the name of each named element."""
        return tuple(zip(self.positions or range(len(self.elements)), self.elements, strict=True))

    @property
    def parts(self) -> tuple[View, ...]:
        """The arrays that are less than the whole argument."""
        return tuple(view for view in self.arrays if view.name != self.name)

    @property
    def names(self) -> frozenset[str]:
        """The names of elements and of parts."""
        return frozenset({*self.elements, *(view.name for view in self.arrays)})

    @property
    def size(self) -> int:
        """The number of elements of the array; 0 for a scalar."""
        return len(self.elements) + sum(view.size for view in self.arrays)


class OutputKind(Enum):
    """The kind of the values of an output."""

    NAMED = "named"
    """Values that have a name each."""
    COUNTED = "counted"
    """Values that loops over the modes write, too many for individual names: only groups of them have names."""
    MATRIX = "matrix"
    """Values of a sparse matrix in the order of its pattern."""


@dataclass(frozen=True)
class Output:
    """An output array; `elements` describes each value; a matrix has a pattern for its values.

    Where there are too many values for names, `size` counts them and `elements` describes groups of them.
    """

    name: str
    elements: tuple[str, ...]
    doc: str
    pattern: Pattern | None = None
    count: int | None = None

    @property
    def size(self) -> int:
        """The number of values of the array."""
        return len(self.elements) if self.count is None else self.count

    @property
    def kind(self) -> OutputKind:
        """The kind of the values."""
        if self.pattern is not None:
            return OutputKind.MATRIX
        return OutputKind.NAMED if self.count is None else OutputKind.COUNTED


@dataclass(frozen=True)
class ConstantArray:
    """A constant array of the generated code: exact numbers, or integers from which indices count.

    instances: the number of instances, if it holds a number of all of them after the other.
    """

    name: str
    values: tuple[int, ...] | tuple[Fraction, ...]
    integers: bool
    instances: int = 0

    def interpreted(self, number: Callable[[Fraction], Any]) -> list[Any]:
        """The values in Python; numbers in the type that `number` returns."""
        return list(self.values) if self.integers else [number(Fraction(value)) for value in self.values]


@dataclass(frozen=True)
class Kernel:
    """One function of the generated code; `constants` are the constant arrays that it reads."""

    name: str
    doc: str
    arguments: tuple[Argument, ...]
    outputs: tuple[Output, ...]
    sections: tuple[Section, ...]
    constants: tuple[ConstantArray, ...] = ()

    @cached_property
    def statements(self) -> tuple[Statement, ...]:
        """All statements, in order."""
        return tuple(statement for section in self.sections for statement in section.body)

    @cached_property
    def operations(self) -> int:
        """Arithmetic operations of one evaluation; a sine or a cosine counts as one, padding does not count."""
        integers: dict[str, Sequence[int]] = {a.name: list(map(int, a.values)) for a in self.constants if a.integers}
        first = {a.name: 0 for a in self.arguments if a.integer}
        return sum(operations(s, integers, first) for s in self.statements)

    @property
    def repeats(self) -> bool:
        """Whether it has loops over instances."""
        return any(isinstance(statement, ForEach) for statement in self.statements)

    @property
    def checked(self) -> bool:
        """Whether a requirement may end the kernel, besides those that only setup has."""
        items = (item for s in self.statements for item in (s, *(inside(s) if isinstance(s, ForEach) else ())))
        return any(isinstance(item, Require) for item in items)

    @cached_property
    def used(self) -> frozenset[str]:
        """The names that the kernel reads."""
        return frozenset(name for s in self.statements for name in reads(s))
