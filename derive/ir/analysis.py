"""Analysis of statements: their expressions, the names that they read, and their arithmetic operations."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from derive.ir.expansion import expand
from derive.ir.expressions import Element, Ends, Expr, LaneSum, Operation, ScalarRef, TableValue, walk
from derive.ir.loop_nests import (
    CHANGES,
    Alias,
    Assign,
    BlockProduct,
    For,
    Integer,
    LoopKind,
    Node,
    every,
    expressions_of,
    inner,
)
from derive.ir.statements import Let, Require, ReturnCode, Statement


def expressions(statement: Statement) -> tuple[Expr, ...]:
    """The expressions in a statement."""
    return tuple(expr for node in every(expand(statement)) for expr in expressions_of(node))


def reads(statement: Statement) -> Iterator[str]:
    """The names that a statement reads: scalars and arrays."""
    return names_read(expand(statement))


_OF_INTEGERS, _OF_ARRAYS = (Alias, Integer), (Element, Ends, LaneSum)
"""Tuples, since a union is made anew at each test."""


def names_read(nodes: Iterable[Node]) -> Iterator[str]:
    """The names that plain statements read: scalars and arrays."""
    for node in every(nodes):
        if isinstance(node, _OF_INTEGERS):
            yield node.array
        elif isinstance(node, BlockProduct):
            yield node.matrix
        for part in (part for expr in expressions_of(node) for part in walk(expr)):
            if isinstance(part, ScalarRef):
                yield part.name
            elif isinstance(part, _OF_ARRAYS):
                yield part.array


def accessed_by(node: Node) -> Iterator[Element | Ends]:
    """The elements that a plain statement reads and writes, without those of its body."""
    yield from (p for expr in expressions_of(node) for p in walk(expr) if isinstance(p, Element | Ends))
    if isinstance(node, Assign) and isinstance(node.target, Element | Ends):
        yield node.target


def needed(body: Iterable[Node], terms: Iterable[Node]) -> list[Let]:
    """The named values of a body that some statements are made of, in their order."""
    names = set(names_read(terms))
    kept: list[Let] = []
    for let in reversed([node for node in body if isinstance(node, Let)]):
        if let.name in names:
            names |= set(names_read([let]))
            kept.insert(0, let)
    return kept


def operations(
    statement: Statement,
    constants: Mapping[str, Sequence[int]] | None = None,
    integers: Mapping[str, int] | None = None,
) -> int:
    """Arithmetic operations of a statement; a sine or a look-up counts as one, padding does not count.

    constants: the constant arrays of integers, on which the bounds of loops over instances may depend; integers:
    values of arguments that are integers.
    """
    return _operations(expand(statement), integers or {}, constants or {})


def _operations(nodes: Iterable[Node], values: Mapping[str, int], constants: Mapping[str, Sequence[int]]) -> int:
    """Operations where the variables of the loops around have these values."""
    known, total = dict(values), 0
    for node in nodes:
        if isinstance(node, Integer):
            known[node.name] = constants[node.array][node.index.at(known)] * node.factor(known)
        total += _operations_of(node, known, constants)
    return total


def _operations_of(node: Node, values: Mapping[str, int], constants: Mapping[str, Sequence[int]]) -> int:
    match node:
        case For():
            steps = range(node.start.at(values), node.stop.at(values), node.step)
            if steps and not _varies(node):
                return len(steps) * _operations(node.body, {**values, node.variable: steps[0]}, constants)
            return sum(_operations(node.body, {**values, node.variable: step}, constants) for step in steps)
        case Assign():
            target = 1 if node.operator in CHANGES else 0
            return target + sum(isinstance(part, Operation | TableValue) for part in walk(node.expr))
        case _:
            own = sum(isinstance(p, Operation | TableValue) for e in expressions_of(node) for p in walk(e))
            return own + _operations(inner(node), values, constants)


def codes_in_order(nodes: Iterable[Node]) -> tuple[ReturnCode, ...]:
    """The codes of the requirements, if all with one code are checked before all with the next one; else nothing."""
    runs = _runs_of_codes(nodes)
    return tuple(runs) if len(runs) == len(set(runs)) else ()


def _runs_of_codes(nodes: Iterable[Node]) -> list[ReturnCode]:
    """The codes of the requirements in the order of their checks, once where a code follows itself."""
    runs: list[ReturnCode] = []
    for node in nodes:
        own = [node.code] if isinstance(node, Require) else _runs_of_codes(inner(node))
        repeats = isinstance(node, For) and node.kind is not LoopKind.STATES and node.count != 1
        runs += own * 2 if repeats else own
    return [code for k, code in enumerate(runs) if not k or runs[k - 1] is not code]


def _varies(loop: For) -> bool:
    """Whether the number of iterations of a loop inside depends on the iteration of this one."""
    parts = tuple(every(loop.body))
    names = (loop.variable, *(part.name for part in parts if isinstance(part, Integer)))
    return any(isinstance(part, For) and (part.start.has(*names) or part.stop.has(*names)) for part in parts)
