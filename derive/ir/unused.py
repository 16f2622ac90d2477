"""Statements over instances without what nothing reads, and with names that differ from those around them.

Both are for compilers that warn of unused and of shadowed variables; the values are those of the statements.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import count
from typing import Any

from derive.ir.analysis import reads
from derive.ir.expressions import Element, Ends, Expr, Leaf, ScalarRef, mapped, walk
from derive.ir.indices import ElementIndex
from derive.ir.statements import Entry, ForEach, InstanceItem, Let, Require, Statement, StoreElement, Work, inside

Bodies = Sequence[tuple[Statement, ...]]


def without_unused(bodies: Bodies, arrays: Iterable[str]) -> list[tuple[Statement, ...]]:
    """The bodies of the sections of a kernel without values, arrays and loops that change nothing.

    arrays: those that the kernel writes for its caller. Statements that do not run over instances stay.
    """
    every = (part for body in bodies for item in body for part in (item, *_inside(item)))
    needed = _Needed({part.array for part in every if isinstance(part, Work)} - {*arrays})
    while True:
        known, read = len(needed.arrays), set[str]()
        result = [tuple(needed.part(body, read)) for body in reversed(bodies)]
        if len(needed.arrays) == known:
            return result[::-1]


class _Needed:
    """The needed statements of bodies; `local`: the local arrays, of which `arrays` are read by what is needed."""

    def __init__(self, local: set[str]) -> None:
        self.local = local
        self.arrays: set[str] = set()

    def part(self, body: Sequence[Statement | InstanceItem], read: set[str]) -> list[Any]:
        """The needed statements of a body. read: the names that are read behind it, to which its own are added."""
        result: list[Statement | InstanceItem] = []
        for whole in reversed(body):
            item = self._loop(whole, read) if isinstance(whole, ForEach) else whole
            if self._needs(item, read):
                names = {*_read(item)}
                self.arrays |= names & self.local
                read |= names
                result.append(item)
        return result[::-1]

    def _loop(self, loop: ForEach, read: set[str]) -> ForEach:
        """A loop with the needed statements of its body."""
        inner: set[str] = set()
        body = tuple(self.part(loop.body, inner))
        read |= inner - {loop.variable, *(item.name for item in body if isinstance(item, Let | Entry))}
        return replace(loop, body=body)

    def _needs(self, item: Statement | InstanceItem, read: set[str]) -> bool:
        match item:
            case Let() | Entry():
                return item.name in read
            case Work():
                return item.array in self.arrays
            case StoreElement():
                return item.target.array not in self.local or item.target.array in self.arrays
            case ForEach():
                return bool(item.body)
            case _:
                return True


def _inside(item: Statement) -> Iterator[InstanceItem]:
    return inside(item) if isinstance(item, ForEach) else iter(())


def _read(item: Statement | InstanceItem) -> Iterator[str]:
    """The names that a statement reads by itself."""
    match item:
        case ForEach():
            yield from _in_index(item.start)
            yield from _in_index(item.stop)
        case Entry():
            yield item.array
            yield from _in_index(item.index)
        case StoreElement():
            yield from _in_expression(item.expr)
            yield from _in_leaf(item.target)
        case Let() | Require():
            yield from _in_expression(item.expr)
        case _:
            yield from reads(item)


def _in_expression(expr: Expr) -> Iterator[str]:
    for part in walk(expr):
        if isinstance(part, ScalarRef):
            yield part.name
        elif isinstance(part, Element | Ends):
            yield part.array
            yield from _in_leaf(part)


def _in_leaf(leaf: Element | Ends) -> Iterator[str]:
    for index in (leaf.first, leaf.second) if isinstance(leaf, Ends) else (leaf.index,):
        yield from _in_index(index)


def _in_index(index: ElementIndex | None) -> Iterator[str]:
    return (term.variable for term in (index.terms if index else ()))


def without_shadows(bodies: Bodies) -> list[tuple[Statement, ...]]:
    """The bodies of the sections of a kernel in which values of loops have other names than those around the loops."""
    every = (part for body in bodies for item in body if isinstance(item, ForEach) for part in inside(item))
    names = _Names({part.name for part in every if isinstance(part, Let)})
    visible: dict[str, str] = {}
    return [tuple(names.renamed(body, visible)) for body in bodies]


class _Names:
    """The names of values in loops; `taken` are those of all of them."""

    def __init__(self, taken: set[str]) -> None:
        self.taken = taken

    def renamed(self, body: Iterable[Statement], visible: dict[str, str]) -> Iterator[Statement]:
        """The statements of a body; `visible`: the names of the values around, as they were and as they are."""
        own: set[str] = set()

        def leaf(part: Leaf) -> Expr:
            return replace(part, name=visible.get(part.name, part.name)) if isinstance(part, ScalarRef) else part

        for item in body:
            match item:
                case Let():
                    expr = mapped(item.expr, leaf)
                    visible[item.name] = self._name(item.name) if item.name in visible.keys() - own else item.name
                    own.add(item.name)
                    yield replace(item, name=visible[item.name], expr=expr)
                case Require() | StoreElement():
                    yield replace(item, expr=mapped(item.expr, leaf))
                case ForEach():
                    yield replace(item, body=tuple(self.renamed(item.body, dict(visible))))  # type: ignore[arg-type]
                case _:
                    yield item

    def _name(self, name: str) -> str:
        new = next(f"{name}_{k}" for k in count(2) if f"{name}_{k}" not in self.taken)
        self.taken.add(new)
        return new
