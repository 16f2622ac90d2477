"""Sums of many terms side by side: successive sums with common factors are computed term by term, all at once.

The elimination of a joint multiplies blocks. Written sum by sum, each factor of a large block comes from memory again
for every sum, and reads from memory are what such a loop waits for. Term by term, a factor serves a whole row of sums
while it is in a register. All operations are those of the sums as they were, and so are the bits.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import count, takewhile

from derive.ir.expressions import Element, Ends, Expr, Operation, Operator, ScalarRef, walk
from derive.ir.loop_nests import Assign, For, Node, every
from derive.ir.statements import Let

FEWEST_TERMS = 4
"""The terms of a sum from which on its factors do not stay in registers."""
MOST = 8
"""The sums that are computed at once: each has a register, as their common factor and one other have."""


def with_parallel_sums(lines: Iterable[Node]) -> tuple[Node, ...]:
    """Lines in which successive assignments of sums with as many terms are computed term by term."""
    nodes = [replace(node, body=with_parallel_sums(node.body)) if isinstance(node, For) else node for node in lines]
    taken = {node.name for node in every(nodes) if isinstance(node, Let)}
    free = (prefix for prefix in map("sum{}_".format, count(1)) if f"{prefix}0_0" not in taken)
    result: list[Node] = []
    place = 0
    while place < len(nodes):
        sums = _sums(nodes[place : place + MOST])
        if len(sums) > 1:
            result += _side_by_side(sums, _values_before(result), next(free))
        else:
            result.append(nodes[place])
        place += max(len(sums), 1)
    return tuple(result)


def _sums(nodes: Sequence[Node]) -> list[Assign]:
    """The assignments at the beginning of some lines whose sums have as many terms as the first one."""
    first = nodes[0]
    terms = len(_terms(first.expr)) if isinstance(first, Assign) else 0
    found = takewhile(lambda node: isinstance(node, Assign) and _is_sum(node, terms), nodes)
    return [node for node in found if isinstance(node, Assign)]


def _is_sum(node: Assign, terms: int) -> bool:
    reads_elements = any(isinstance(part, Element | Ends) for part in walk(node.expr))
    return terms >= FEWEST_TERMS and len(_terms(node.expr)) == terms and node.operator is None and not reads_elements


def _terms(expr: Expr) -> list[Expr]:
    """The terms of a sum in the order in which they are added."""
    later: list[Expr] = []
    while isinstance(expr, Operation) and expr.kind is Operator.ADD:
        expr, term = expr.args
        later.append(term)
    return [expr, *reversed(later)]


def _values_before(lines: list[Node]) -> dict[str, Let]:
    """The named values at the end of some lines, which are taken from there: each waits for the term that reads it."""
    values: list[Let] = []
    while lines and isinstance(last := lines[-1], Let):
        values.append(last)
        lines.pop()
    return {value.name: value for value in reversed(values)}


def _side_by_side(sums: Sequence[Assign], waiting: dict[str, Let], prefix: str) -> Iterator[Node]:
    """The assignments with their sums term by term, and each value before the first term that reads it."""
    terms = [_terms(node.expr) for node in sums]
    read = {name for row in terms for name in _names(row)}
    yield from _due([ScalarRef(name) for name in waiting if name not in read], waiting)
    totals: list[Expr] = [row[0] for row in terms]
    for k, column in enumerate(zip(*terms, strict=True)):
        yield from _due(column, waiting)
        for n, term in enumerate(column):
            if k:
                totals[n] = Operation(Operator.ADD, (totals[n], term))
            if k < len(terms[0]) - 1:
                yield Let(f"{prefix}{n}_{k}", totals[n])
                totals[n] = ScalarRef(f"{prefix}{n}_{k}")
    yield from (replace(node, expr=total) for node, total in zip(sums, totals, strict=True))


def _due(exprs: Iterable[Expr], waiting: dict[str, Let]) -> Iterator[Let]:
    """The values that some expressions need and that are still waiting, each behind those that it needs."""
    for name in _names(exprs):
        if name in waiting:
            value = waiting.pop(name)
            yield from _due([value.expr], waiting)
            yield value


def _names(exprs: Iterable[Expr]) -> list[str]:
    return [part.name for expr in exprs for part in walk(expr) if isinstance(part, ScalarRef)]
