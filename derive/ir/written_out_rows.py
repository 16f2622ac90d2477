"""Loops over the rows of tables inside of loops over instances, written out: the same operations in a straight line.

A batch has a loop over its states in place of each line, and its rows are as long as registers; there a loop over rows
would store and load what a line keeps. The bits are those of the loops.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from derive.ir.expressions import Element, Expr, Leaf, ScalarRef, mapped
from derive.ir.kernel import Kernel
from derive.ir.model import Model
from derive.ir.statements import ForEach, InstanceItem, Let, Require, Statement, StoreElement, Work


def with_rows_written_out(model: Model) -> Model:
    """A model whose loops over instances have no arrays and loops of their own."""
    return replace(model, kernels=tuple(map(_written_out, model.kernels)))


def _written_out(kernel: Kernel) -> Kernel:
    sections = tuple(replace(s, body=tuple(map(_statement, s.body))) for s in kernel.sections)
    return kernel if sections == kernel.sections else replace(kernel, sections=sections)


def _statement(statement: Statement) -> Statement:
    if not isinstance(statement, ForEach):
        return statement
    arrays = {item.array for item in statement.body if isinstance(item, Work)}
    return replace(statement, body=(*_lines(statement.body, arrays),)) if arrays else statement


def _lines(body: Iterable[InstanceItem], arrays: set[str]) -> Iterator[InstanceItem]:
    """The lines of a body, in which elements of its arrays are values with names."""

    def leaf(item: Leaf) -> Expr:
        if isinstance(item, Element) and item.array in arrays:
            assert item.index
            return ScalarRef(_name(item.array, item.index.offset))
        return item

    for item in body:
        match item:
            case Work():
                pass
            case ForEach(variable, start, stop):
                for value in range(start.offset, stop.offset):
                    yield from (_line(line, variable, value) for line in item.body)
            case Let() | Require() | StoreElement():
                yield replace(item, expr=mapped(item.expr, leaf))
            case _:
                yield item


def _line(line: InstanceItem, variable: str, value: int) -> InstanceItem:
    """A line of a loop for a value of its variable."""
    assert isinstance(line, StoreElement)
    assert isinstance(line.target, Element)
    assert line.target.index

    def leaf(item: Leaf) -> Expr:
        return _at(item, variable, value) if isinstance(item, Element) else item

    return Let(_name(line.target.array, line.target.index.with_value(variable, value).offset), mapped(line.expr, leaf))


def _at(element: Element, variable: str, value: int) -> Element:
    return replace(element, index=element.index.with_value(variable, value)) if element.index else element


def _name(array: str, index: int) -> str:
    return f"{array}_{index}"
