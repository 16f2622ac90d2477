"""The parts of a kernel as loops over a block of states: straight lines, and loops over the modes between them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from derive.backends.c.batch_loops import totals
from derive.ir.analysis import expressions, reads
from derive.ir.expressions import Expr, Operation, ScalarRef, TableValue, walk
from derive.ir.model import Kernel
from derive.ir.statements import Accumulate, Let, Map, MatVec, Require, ScalarStatement, Store, TriangularSolve

BatchLoop = Map | Accumulate | MatVec | TriangularSolve


@dataclass(frozen=True)
class StraightLines:
    """Straight lines; `early` are the calls of functions such as sines, with what they need, in a loop of their own.

    Compilers make no vectors of those, and none of a loop that has one.
    """

    early: tuple[Let, ...]
    lines: tuple[ScalarStatement, ...]


BatchPart = StraightLines | BatchLoop
"""Straight lines, or a loop over the modes."""


def batch_parts(kernel: Kernel) -> list[BatchPart]:
    """The parts of a kernel in their order."""
    parts = _parts(kernel)
    return [_straight_lines(part, n) if isinstance(part, tuple) else part for n, part in enumerate(parts, 1)]


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


def _straight_lines(lines: tuple[ScalarStatement, ...], number: int) -> StraightLines:
    """Take the calls of functions out."""
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
        for part in (part for e in expressions(line) for part in walk(e) if part in named):
            early.setdefault(named[part], Let(named[part], part))
        if isinstance(line, Let) and line.name in before:
            early[line.name] = replace(line, expr=_swapped(line.expr, named))
    rest = tuple(replace(line, expr=_swapped(line.expr, named)) for line in lines)
    kept = tuple(line for line in rest if not _renames_itself(line))
    return StraightLines(tuple(early.values()), _read(kept, frozenset(before)))


def _read(lines: tuple[ScalarStatement, ...], early: frozenset[str]) -> tuple[ScalarStatement, ...]:
    """Lines without those that the calls of functions alone needed."""
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
    if expr in named:
        return ScalarRef(named[expr])
    return (
        Operation(expr.kind, tuple(_swapped(arg, named) for arg in expr.args)) if isinstance(expr, Operation) else expr
    )


def _renames_itself(line: ScalarStatement) -> bool:
    return isinstance(line, Let) and line.expr == ScalarRef(line.name)


def block_arrays(parts: Iterable[BatchPart]) -> frozenset[str]:
    """Scalars that are computed in one loop over the states and read in another."""
    written: dict[str, int] = {}
    wide = set()
    number = 0
    for part in parts:
        for lines in (part.early, part.lines) if isinstance(part, StraightLines) else ((part,),):
            number += 1
            own = {line.name for line in lines if isinstance(line, Let)}
            for line in lines:
                wide |= {n for n in reads(line) if n in written and written[n] != number and n not in own}
            written |= dict.fromkeys(own, number)
    return frozenset(wide)
