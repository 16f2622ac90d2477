"""Straight lines for many states: calls of library functions precede them, in as few stages as possible.

Compilers make no vectors of calls, and none of a loop that has one; sines and cosines have a function of their own
for all states of a batch.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace

from derive.ir.analysis import names_read
from derive.ir.expressions import Element, Expr, Operation, Operator, ScalarRef, TableValue, walk
from derive.ir.indices import variable
from derive.ir.loop_nests import START, Assign, For, LoopKind, Node, Sines, expressions_of
from derive.ir.statements import Let, Require

STATE, COUNT = "b", "count"
"""The variable of loops over states, and the number of states."""

Line = Let | Assign | Require
"""A plain statement in straight line."""


def over_states(lines: Iterable[Node]) -> For:
    """Lines in a loop over the states."""
    return For(STATE, START, variable(COUNT), tuple(lines), LoopKind.STATES)


def straight_lines(
    lines: tuple[Line, ...], number: int, states: frozenset[str], arguments: frozenset[str]
) -> list[Node]:
    """Straight lines in a loop over the states; before it the calls of functions such as sines, with what they need.

    number: that of the lines in their kernel, for the names of values. states: the names that have an array already.
    arguments: the arguments with a value for each state, whose elements are angles without a copy: compilers copy in
    shorter vectors than those in which they then read, and processors wait until short ones are in their caches.
    """
    named: dict[Expr, str] = {}
    for line in lines:
        if isinstance(line, Let) and _is_call(line.expr):
            named.setdefault(line.expr, line.name)
        for part in _calls(line):
            what = part.kind.value if isinstance(part, Operation) else "table"
            named.setdefault(part, f"{what}_{number}_{len(named)}")
    if not named:
        return [over_states(lines)]
    needed = {name for expr, name in named.items() for name in names_read([Let(name, expr)])}
    before: set[str] = set()
    for line in reversed(lines):
        if isinstance(line, Let) and line.name in needed and not _is_call(line.expr):
            before.add(line.name)
            needed |= set(names_read([line]))
    early: dict[str, Let] = {}  # in their order: an angle may itself be made of a sine
    for line in lines:
        for part in _calls(line):
            early.setdefault(named[part], Let(named[part], _with_swapped_arguments(part, named)))
        if isinstance(line, Let) and line.name in before:
            early[line.name] = replace(line, expr=_swapped(line.expr, named))
    rest = tuple(replace(line, expr=_swapped(line.expr, named)) for line in lines)
    kept = tuple(line for line in rest if not (isinstance(line, Let) and line.expr == ScalarRef(line.name)))
    return [*_stages(early.values(), number, states, arguments), over_states(_read(kept, frozenset(before)))]


@dataclass
class _Stage:
    """Lines before some sines, and the names of sine and cosine by the expression of their angle."""

    lets: list[Let] = field(default_factory=list)
    calls: dict[Expr, dict[Operator, str]] = field(default_factory=dict)


def _stages(early: Iterable[Let], number: int, states: frozenset[str], arguments: frozenset[str]) -> Iterator[Node]:
    """The stages of the calls, as few as possible: sines of angles that need no sines come first, all together."""
    stages = [_Stage()]
    ready: dict[str, int] = {}
    for let in early:
        level = max((ready[name] for name in names_read([let]) if name in ready), default=0)
        match let.expr:
            case Operation(Operator.SIN | Operator.COS as kind, (angle,)):
                stages += [_Stage()] if level + 1 == len(stages) else []
                stages[level].calls.setdefault(angle, {})[kind] = let.name
                ready[let.name] = level + 1
            case _:
                stages[level].lets.append(let)
                ready[let.name] = level
    arrays = states | {*ready}
    for k, stage in enumerate(stages):
        yield from _finished(stage, f"{number}_{k}", arrays, arguments)


def _finished(stage: _Stage, suffix: str, arrays: frozenset[str], arguments: frozenset[str]) -> Iterator[Node]:
    """The lines of a stage, in which angles get a name unless they have an array with a value for each state."""
    lets, sines = list(stage.lets), list[Sines]()
    rows = {let.name: let.expr for let in lets if isinstance(let.expr, Element) and let.expr.array in arguments}
    for k, (angle, names) in enumerate(stage.calls.items()):
        element = rows.get(angle.name) if isinstance(angle, ScalarRef) else None
        if element is None:
            name = angle.name if isinstance(angle, ScalarRef) and angle.name in arrays else f"angle_{suffix}_{k}"
            lets += [] if angle == ScalarRef(name) else [Let(name, angle)]
            element = Element(name, None)
        sine = names.get(Operator.SIN, f"sine_{suffix}_{k}")
        cosine = names.get(Operator.COS, f"cosine_{suffix}_{k}")
        sines.append(Sines(element, sine, cosine))
    read = set(names_read([*lets, *sines]))
    lets = [let for let in lets if let.name not in rows or let.name in read]
    if lets:
        yield over_states(lets)
    yield from sines


def _read(lines: tuple[Line, ...], early: frozenset[str]) -> tuple[Line, ...]:
    """The lines without early values that only calls of functions needed."""
    kept: list[Line] = []
    used: set[str] = set()
    for line in reversed(lines):
        if isinstance(line, Let) and line.name in early and line.name not in used:
            continue
        used |= set(names_read([line]))
        kept.insert(0, line)
    return tuple(kept)


def has_calls(lines: Iterable[Line]) -> bool:
    """Whether lines call library functions."""
    return any(True for line in lines for _ in _calls(line))


def _calls(line: Line) -> Iterator[Operation | TableValue]:
    parts = (part for expr in expressions_of(line) for part in walk(expr))
    return (part for part in parts if isinstance(part, Operation | TableValue) and _is_call(part))


def _is_call(expr: Expr) -> bool:
    return isinstance(expr, TableValue) or (isinstance(expr, Operation) and not expr.kind.vectorises)


def _swapped(expr: Expr, named: Mapping[Expr, str]) -> Expr:
    return ScalarRef(named[expr]) if _is_call(expr) else _with_swapped_arguments(expr, named)


def _with_swapped_arguments(expr: Expr, named: Mapping[Expr, str]) -> Expr:
    match expr:
        case Operation(kind, args):
            return Operation(kind, tuple(_swapped(arg, named) for arg in args))
        case TableValue():
            return replace(expr, argument=_swapped(expr.argument, named))
        case _:
            return expr
