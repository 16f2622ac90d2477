"""Loops over rows of tables and of joints inside of loops over instances, written out: the same operations in a line.

A batch has a loop over its states in place of each line, and its rows are as long as registers; there a loop over rows
would store and load what a line keeps. The bits are those of the loops.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import count

from derive.ir.expressions import Element, Ends, Expr, Leaf, ScalarRef, mapped
from derive.ir.indices import ElementIndex
from derive.ir.kernel import Kernel
from derive.ir.model import Model
from derive.ir.statements import ForEach, InstanceItem, Let, Require, Statement, StoreElement, Work


def with_rows_written_out(model: Model) -> Model:
    """A model whose loops over instances have no arrays of their own and no short loops inside."""
    return replace(model, kernels=tuple(map(_written_out, model.kernels)))


def _written_out(kernel: Kernel) -> Kernel:
    sections = tuple(replace(s, body=tuple(map(_statement, s.body))) for s in kernel.sections)
    return kernel if sections == kernel.sections else replace(kernel, sections=sections)


def _statement(statement: Statement) -> Statement:
    return _loop(statement) if isinstance(statement, ForEach) else statement


def _loop(loop: ForEach) -> ForEach:
    inner = [item for item in loop.body if isinstance(item, ForEach)]
    if len(inner) == len(loop.body):  # a loop over both ends of a path
        return replace(loop, body=tuple(map(_loop, inner)))
    arrays = {item.array for item in loop.body if isinstance(item, Work)}
    is_written_out = arrays or any(item.short for item in inner)
    return replace(loop, body=(*_lines(loop.body, arrays),)) if is_written_out else loop


def _lines(body: Iterable[InstanceItem], arrays: set[str]) -> Iterator[InstanceItem]:
    """The lines of a body, in which elements of its arrays are values with names."""
    return _Lines(arrays).of(body, {}, {})


class _Lines:
    """The lines of a body; `arrays` are those of an iteration, whose elements have names."""

    def __init__(self, arrays: set[str]) -> None:
        self.arrays = arrays
        self.numbers = count(1)

    def of(
        self, body: Iterable[InstanceItem], variables: dict[str, int], names: dict[str, str]
    ) -> Iterator[InstanceItem]:
        """The lines for values of the variables of loops around; names: those of values in these loops."""

        def at_ends(item: Ends) -> Ends:
            return replace(item, first=_at(item.first, variables), second=_at(item.second, variables))

        def leaf(item: Leaf) -> Expr:
            if isinstance(item, ScalarRef):
                return replace(item, name=names.get(item.name, item.name))
            if isinstance(item, Ends):
                return at_ends(item)
            if not isinstance(item, Element) or not item.index:
                return item
            index = _at(item.index, variables)
            return (
                ScalarRef(_name(item.array, index.offset)) if item.array in self.arrays else replace(item, index=index)
            )

        for item in body:
            match item:
                case Work():
                    pass
                case ForEach(variable, start, stop):
                    first, last = _at(start, variables).offset, _at(stop, variables).offset
                    for value in range(first, last):
                        yield from self.of(item.body, {**variables, variable: value}, dict(names))
                case Let():
                    expr = mapped(item.expr, leaf)
                    if variables:
                        names[item.name] = f"{item.name}_{next(self.numbers)}"
                    yield Let(names.get(item.name, item.name), expr)
                case StoreElement(Element() as target) if target.index:
                    expr, index = mapped(item.expr, leaf), _at(target.index, variables)
                    if target.array in self.arrays:
                        yield Let(_name(target.array, index.offset), expr)
                    else:
                        yield replace(item, target=replace(target, index=index), expr=expr)
                case StoreElement(Ends() as ends):
                    yield replace(item, target=at_ends(ends), expr=mapped(item.expr, leaf))
                case StoreElement() | Require():
                    yield replace(item, expr=mapped(item.expr, leaf))
                case _:
                    yield item


def _at(index: ElementIndex, values: dict[str, int]) -> ElementIndex:
    for variable, value in values.items():
        index = index.with_value(variable, value)
    return index


def _name(array: str, index: int) -> str:
    return f"{array}_{index}"
