"""The parts of a kernel as loops over a block of states: straight lines, and loops over the modes between them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace

from derive.backends.c.batch_loops import totals
from derive.ir.analysis import expressions, reads
from derive.ir.expressions import Expr, Operation, Operator, ScalarRef, TableValue, walk
from derive.ir.model import Kernel
from derive.ir.statements import Accumulate, Let, Map, MatVec, Require, ScalarStatement, Store, TriangularSolve

BatchLoop = Map | Accumulate | MatVec | TriangularSolve


@dataclass(frozen=True)
class Angle:
    """An angle, and the names that the arrays of its sines and cosines have."""

    name: str
    sine: str
    cosine: str


@dataclass(frozen=True)
class EarlyLines:
    """Straight lines in a loop over the states, and the angles of which they are followed by the sines and cosines."""

    lets: tuple[Let, ...]
    angles: tuple[Angle, ...]


@dataclass(frozen=True)
class StraightLines:
    """Straight lines; before them, in `stages`, the calls of functions such as sines, with what they need.

    Compilers make no vectors of calls, and none of a loop that has one; sines and cosines have a function of their own
    for all states of a block.
    """

    stages: tuple[EarlyLines, ...]
    lines: tuple[ScalarStatement, ...]


BatchPart = StraightLines | BatchLoop
"""Straight lines, or a loop over the modes."""


def batch_parts(kernel: Kernel, states: frozenset[str]) -> list[BatchPart]:
    """The parts of a kernel in their order; `states` are the elements of q and v."""
    parts = _parts(kernel)
    return [_straight_lines(part, n, states) if isinstance(part, tuple) else part for n, part in enumerate(parts, 1)]


def _parts(kernel: Kernel) -> list[tuple[ScalarStatement, ...] | BatchLoop]:
    """Loops, and the straight lines between them, with those that add the lanes of a sum."""
    parts: list[tuple[ScalarStatement, ...] | BatchLoop] = []
    lines: tuple[ScalarStatement, ...] = ()
    for s in kernel.statements:
        if isinstance(s, Let | Store | Require):
            lines += (s,)
            continue
        if not isinstance(s, Map | Accumulate | MatVec | TriangularSolve):
            raise AssertionError(f"no batch of {type(s).__name__}: {s}")
        parts += [lines] if lines else []
        lines = ()
        parts.append(s)
        if isinstance(s, Accumulate):
            lines = totals(s, f"sums{len(parts)}")
    return [*parts, lines] if lines else parts


def _straight_lines(lines: tuple[ScalarStatement, ...], number: int, states: frozenset[str]) -> StraightLines:
    """Separate the calls of functions from straight lines."""
    named: dict[Expr, str] = {}
    for line in lines:
        if isinstance(line, Let) and _is_call(line.expr):
            named.setdefault(line.expr, line.name)
        for part in (part for e in expressions(line) for part in walk(e) if _is_call(part)):
            what = part.kind.value if isinstance(part, Operation) else "table"
            named.setdefault(part, f"{what}_{number}_{len(named)}")
    if not named:
        return StraightLines((), lines)
    needed = {name for expr, name in named.items() for name in reads(Let(name, expr))}
    before: set[str] = set()
    for line in reversed(lines):
        if isinstance(line, Let) and line.name in needed and not _is_call(line.expr):
            before.add(line.name)
            needed |= set(reads(line))
    early: dict[str, Let] = {}  # in their order: an angle may itself be made of a sine
    for line in lines:
        for part in (part for e in expressions(line) for part in walk(e) if _is_call(part)):
            early.setdefault(named[part], Let(named[part], _with_swapped_arguments(part, named)))
        if isinstance(line, Let) and line.name in before:
            early[line.name] = replace(line, expr=_swapped(line.expr, named))
    rest = tuple(replace(line, expr=_swapped(line.expr, named)) for line in lines)
    kept = tuple(line for line in rest if not _renames_itself(line))
    return StraightLines(_stages(early.values(), number, states), _read(kept, frozenset(before)))


@dataclass
class _EarlyLines:
    """A stage while it is collected: the names of the sine and the cosine by the expression of their angle."""

    lets: list[Let] = field(default_factory=list)
    calls: dict[Expr, dict[Operator, str]] = field(default_factory=dict)


def _stages(early: Iterable[Let], number: int, states: frozenset[str]) -> tuple[EarlyLines, ...]:
    """The stages of the calls, as few as possible: sines of angles that need no sines come first, all together."""
    stages = [_EarlyLines()]
    ready: dict[str, int] = {}
    for let in early:
        level = max((ready[name] for name in reads(let) if name in ready), default=0)
        match let.expr:
            case Operation(Operator.SIN | Operator.COS as kind, (angle,)):
                stages += [_EarlyLines()] if level + 1 == len(stages) else []
                stages[level].calls.setdefault(angle, {})[kind] = let.name
                ready[let.name] = level + 1
            case _:
                stages[level].lets.append(let)
                ready[let.name] = level
    arrays = states | {*ready}
    return tuple(
        _finished(stage, f"{number}_{k}", arrays) for k, stage in enumerate(stages) if stage.lets or stage.calls
    )


def _finished(stage: _EarlyLines, suffix: str, arrays: frozenset[str]) -> EarlyLines:
    """The lines of a stage, in which angles get a name unless they have an array with a value for each state."""
    lets, angles = list(stage.lets), []
    for k, (angle, names) in enumerate(stage.calls.items()):
        if isinstance(angle, ScalarRef) and angle.name in arrays:
            name = angle.name
        else:
            name = f"angle_{suffix}_{k}"
            lets.append(Let(name, angle))
        sine = names.get(Operator.SIN, f"sine_{suffix}_{k}")
        cosine = names.get(Operator.COS, f"cosine_{suffix}_{k}")
        angles.append(Angle(name, sine, cosine))
    return EarlyLines(tuple(lets), tuple(angles))


def _read(lines: tuple[ScalarStatement, ...], early: frozenset[str]) -> tuple[ScalarStatement, ...]:
    """The lines without early values that only calls of functions needed."""
    kept: list[ScalarStatement] = []
    used: set[str] = set()
    for line in reversed(lines):
        if isinstance(line, Let) and line.name in early and line.name not in used:
            continue
        used |= set(reads(line))
        kept.insert(0, line)
    return tuple(kept)


def _is_call(expr: Expr) -> bool:
    return isinstance(expr, TableValue) or (isinstance(expr, Operation) and not expr.kind.vectorises)


def _swapped(expr: Expr, named: dict[Expr, str]) -> Expr:
    return ScalarRef(named[expr]) if _is_call(expr) else _with_swapped_arguments(expr, named)


def _with_swapped_arguments(expr: Expr, named: dict[Expr, str]) -> Expr:
    match expr:
        case Operation(kind, args):
            return Operation(kind, tuple(_swapped(arg, named) for arg in args))
        case TableValue():
            return replace(expr, argument=_swapped(expr.argument, named))
        case _:
            return expr


def _renames_itself(line: ScalarStatement) -> bool:
    return isinstance(line, Let) and line.expr == ScalarRef(line.name)


def block_arrays(parts: Sequence[BatchPart], states: frozenset[str]) -> frozenset[str]:
    """Scalars that have an array: those computed in one loop over the states and read in another, angles and sines.

    Elements of q and v, which are `states`, have one already.
    """
    written: dict[str, int] = {}
    wide = {name for part in parts if isinstance(part, StraightLines) for name in _names_of_angles(part)}
    for number, lines in enumerate(_loops(parts)):
        own = {line.name for line in lines if isinstance(line, Let)}
        for line in lines:
            wide |= {n for n in reads(line) if n in written and written[n] != number and n not in own}
        written |= dict.fromkeys(own, number)
    return frozenset(wide - states)


def _loops(parts: Iterable[BatchPart]) -> Iterator[tuple[ScalarStatement | BatchLoop, ...]]:
    for part in parts:
        if isinstance(part, StraightLines):
            yield from (stage.lets for stage in part.stages)
            yield part.lines
        else:
            yield (part,)


def _names_of_angles(part: StraightLines) -> set[str]:
    return {name for stage in part.stages for a in stage.angles for name in (a.name, a.sine, a.cosine)}
