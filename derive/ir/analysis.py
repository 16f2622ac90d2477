"""Analysis of statements: their expressions, the names that they read, and their arithmetic operations."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from derive.ir.expansion import expand
from derive.ir.expressions import Element, Expr, LaneSum, Operation, ScalarRef, TableValue, walk
from derive.ir.loop_nests import CHANGES, Alias, Assign, BlockProduct, For, Node, every, expressions_of, inner
from derive.ir.statements import Statement


def expressions(statement: Statement) -> tuple[Expr, ...]:
    """The expressions in a statement."""
    return tuple(expr for node in every(expand(statement)) for expr in expressions_of(node))


def reads(statement: Statement) -> Iterator[str]:
    """The names that a statement reads: scalars and arrays."""
    return names_read(expand(statement))


def names_read(nodes: Iterable[Node]) -> Iterator[str]:
    """The names that plain statements read: scalars and arrays."""
    for node in every(nodes):
        if isinstance(node, Alias):
            yield node.array
        elif isinstance(node, BlockProduct):
            yield node.matrix
        for part in (part for expr in expressions_of(node) for part in walk(expr)):
            if isinstance(part, ScalarRef):
                yield part.name
            elif isinstance(part, Element | LaneSum):
                yield part.array


def operations(statement: Statement) -> int:
    """Arithmetic operations of a statement; a sine or a look-up counts as one, padding does not count."""
    return _operations(expand(statement), {})


def _operations(nodes: Iterable[Node], values: Mapping[str, int]) -> int:
    """Operations where the variables of the loops around have these values."""
    return sum(_operations_of(node, values) for node in nodes)


def _operations_of(node: Node, values: Mapping[str, int]) -> int:
    match node:
        case For():
            steps = range(node.start.at(values), node.stop.at(values), node.step)
            if any(isinstance(part, For) and _bounds_depend(part, node.variable) for part in every(node.body)):
                return sum(_operations(node.body, {**values, node.variable: step}) for step in steps)
            return len(steps) * _operations(node.body, {**values, node.variable: 0})
        case Assign():
            target = 1 if node.operator in CHANGES else 0
            return target + sum(isinstance(part, Operation | TableValue) for part in walk(node.expr))
        case _:
            own = sum(isinstance(p, Operation | TableValue) for e in expressions_of(node) for p in walk(e))
            return own + _operations(inner(node), values)


def _bounds_depend(loop: For, variable: str) -> bool:
    return loop.start.has(variable) or loop.stop.has(variable)
