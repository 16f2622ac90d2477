"""Loops of a Kernel over instances as loops of Python, over lists of the elements of arrays."""

from __future__ import annotations

from collections.abc import Callable
from typing import assert_never

from derive.backends.expression_text import PYTHON, Named, element, index_text, text
from derive.backends.python.loops import assignment
from derive.backends.source_map import SourceLine, defining, plain
from derive.backends.wrapping import BreakableText
from derive.ir.expressions import Element, Ends, Operation, Operator
from derive.ir.indices import ElementIndex
from derive.ir.statements import Entry, ForEach, InstanceItem, Let, Require, StoreElement, Work

Lines = list[SourceLine]


def instance_lines(item: InstanceItem | Work, require: Callable[[Require], list[str]], depth: int = 1) -> Lines:
    """The lines of a statement; `require` prints requirements at the beginning of a line of a function."""
    match item:
        case Let():
            return _indented(defining(assignment(item.name, text(item.expr, PYTHON, _named)), item.name), depth)
        case Require():
            return _indented(plain(*require(item)), depth)
        case Work():
            return _indented(plain(f"    {item.array} = [0.0] * {item.count}"), depth)
        case Entry():
            return _indented(plain(f"    {item.name} = {item.array}[{index_text(item.index)}]"), depth)
        case StoreElement():
            target = element_text(item.target)
            expr = item.expr if item.operator is None else _changed(item)
            return _indented(plain(*assignment(target, text(expr, PYTHON, _named))), depth)
        case ForEach():
            body = [line for inner in item.body for line in instance_lines(inner, require, depth + 1)]
            return [*_indented(plain(f"    for {item.variable} in {_range(item)}:"), depth), *body]
        case _:
            assert_never(item)


def _named(leaf: Named) -> BreakableText:
    return BreakableText((element_text(leaf),)) if isinstance(leaf, Element | Ends) else element(leaf)


def element_text(element: Element | Ends) -> str:
    """An element of a list."""
    if isinstance(element, Ends):
        first, second = index_text(element.first), index_text(element.second)
        return f"{element.array}[{second} if {element.variable} else {first}]"
    assert element.index
    return f"{element.array}[{index_text(element.index)}]"


def _changed(item: StoreElement) -> Operation:
    """The new value: in place, the arrays of a batch would change wherever they are."""
    assert item.operator in (Operator.ADD, Operator.SUB)
    return Operation(item.operator, (item.target, item.expr))


def _range(loop: ForEach) -> str:
    start, stop = index_text(loop.start), index_text(loop.stop)
    if loop.backward:
        return f"range({_minus_one(loop.stop)}, {_minus_one(loop.start)}, -1)"
    return f"range({stop})" if start == "0" else f"range({start}, {stop})"


def _minus_one(index: ElementIndex) -> str:
    return index_text(index.plus(-1), False)


def _indented(lines: Lines, depth: int) -> Lines:
    for _ in range(depth - 1):
        lines = [line.indented() for line in lines]
    return lines
