"""Loops of a Kernel as C: contiguous, with counts that the compiler knows, in a form that it turns into vectors.

Sums run in four lanes and matrices in blocks of four rows, so that no compiler has to change the order of additions.
The loop over the lanes is outside of that over the modes: a sum stays in a vector register until it is complete.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from itertools import count
from typing import assert_never

from derive.backends.c.lanes import (
    Lines,
    fits_vectors,
    has_lanes,
    in_lanes,
    indented,
    lane_let,
    loop_head,
    over_lanes,
    scatter,
    store,
)
from derive.backends.c.matrix_loops import MAX_SUMS, cholesky, matrix_store, matvec, pack, triangular_solve
from derive.backends.expression_text import C, Named, element, strided, text
from derive.backends.source_map import SourceLine, defining, plain, storing
from derive.backends.wrapping import PLUS, BreakableText, join, statement
from derive.ir.analysis import reads
from derive.ir.expressions import Expr, Number, ScalarRef
from derive.ir.statements import (
    LANES,
    Accumulate,
    Cholesky,
    Clear,
    Let,
    Loop,
    Map,
    MapItem,
    MatrixStore,
    MatVec,
    Pack,
    RequireFinite,
    StoreLocal,
    StoreStrided,
    Sum,
    TriangularSolve,
    padded,
)

ZERO = Number(Fraction(0))


class CLoops:
    """The loops of one function."""

    def __init__(self) -> None:
        self._arrays: set[str] = set()
        self._numbers: Iterator[int] = count(1)

    def lines(self, loop: Loop, inside: Sequence[SourceLine] = ()) -> Lines:
        """The lines of one statement, as they are written in a function.

        inside: of products of matrices, further lines for the block of row i.
        """
        return indented(matvec(loop, inside) if isinstance(loop, MatVec) and inside else self._lines(loop))

    def _lines(self, loop: Loop) -> Lines:
        match loop:
            case Map():
                return self._map(loop)
            case Accumulate():
                return _accumulate(loop, f"sums{next(self._numbers)}")
            case MatVec():
                return matvec(loop)
            case MatrixStore():
                return matrix_store(loop)
            case Pack():
                return pack(loop)
            case Clear():
                return plain(f"for (int i = 0; i < {loop.count}; i++) {loop.output}[i] = 0.0;")
            case RequireFinite():
                check = f"    if (!isfinite({loop.argument}[i])) return {loop.code}; /* {loop.text} */"
                return plain(f"for (int i = 0; i < {loop.count}; i++)", check)
            case Cholesky():
                return cholesky(loop)
            case TriangularSolve():
                return triangular_solve(loop)
            case _:
                assert_never(loop)

    def _map(self, loop: Map) -> Lines:
        declarations = []
        for item in loop.body:
            if isinstance(item, StoreLocal) and item.array not in self._arrays:
                self._arrays.add(item.array)
                declarations.append(f"double {item.array}[{padded(loop.count)}];")
        whole = loop.count // LANES * LANES if all(fits_vectors(item.expr) for item in loop.body) else 0
        lines = plain(*declarations)
        if whole:
            names: set[str] = set()
            body = [line for item in loop.body for line in _lane_item(item, names)]
            lines += [
                *plain(f"for (int i = 0; i < {whole}; i += {LANES}) {{"),
                *indented(over_lanes(body)),
                *plain("}"),
            ]
        if loop.count > whole:
            body = [line for item in loop.body for line in _map_item(item)]
            lines += [*plain(loop_head("i", loop.count, whole)), *body, *plain("}")]
        return lines


def _accumulate(loop: Accumulate, name: str) -> Lines:
    """Sums, whose lanes are in the array `name`."""
    whole = loop.count // LANES * LANES if _in_vectors(loop) else 0
    if loop.count < LANES:
        return _few_terms(loop)
    lines = plain(f"double {name}[{len(loop.sums)}][{LANES}];")
    if whole:
        for first in range(0, len(loop.sums), MAX_SUMS):
            lines += _lane_sums(loop, loop.sums[first : first + MAX_SUMS], first, name, whole)
    else:
        clear = loop_head("l", LANES, 0, f"{name}[i][l] = 0.0;")
        lines += plain(loop_head("i", len(loop.sums), 0, ""), f"    {clear}")
    if loop.count > whole:
        rest = [line for let in loop.lets for line in _map_item(let)]
        for k, total in enumerate(loop.sums):
            rest += plain(*statement("    ", f"{name}[{k}][i % {LANES}] += ", text(total.term, C), ";"))
        lines += [*plain(loop_head("i", loop.count, whole)), *rest, *plain("}")]
    for k, total in enumerate(loop.sums):
        lanes = f"(({name}[{k}][0] + {name}[{k}][1]) + ({name}[{k}][2] + {name}[{k}][3]))"
        value = lanes if total.base == ZERO else f"{text(total.base, C)} + {lanes}"
        lines += defining([f"const double {total.name} = {value};"], total.name)
    return lines


def _few_terms(loop: Accumulate) -> Lines:
    """Sums of fewer terms than there are lanes, in straight line; a zero in front, since a sum never is -0."""
    names = {let.name for let in loop.lets}

    def term(expr: Expr, k: int) -> BreakableText:
        def leaf(item: Named) -> BreakableText:
            if isinstance(item, ScalarRef):
                return BreakableText((f"{item.name}_{k}" if item.name in names else item.name,))
            return element(item, BreakableText((str(k),)))

        return text(expr, C, leaf)

    lines: Lines = []
    for k in range(loop.count):
        for let in loop.lets:
            lines += defining(statement("", f"const double {let.name}_{k} = ", term(let.expr, k), ";"), let.name)
    for total in loop.sums:
        base = "" if total.base == ZERO else join(text(total.base, C), PLUS)
        added = join("(0.0", *(part for k in range(loop.count) for part in (PLUS, "(", term(total.term, k), ")")), ")")
        lines += defining(statement("", f"const double {total.name} = ", join(base, added), ";"), total.name)
    return lines


def _in_vectors(loop: Accumulate) -> bool:
    return all(map(fits_vectors, (*(let.expr for let in loop.lets), *(total.term for total in loop.sums))))


def _lane_sums(loop: Accumulate, sums: tuple[Sum, ...], first: int, name: str, whole: int) -> Lines:
    """Some sums in four lanes, over as many modes as fill all lanes."""
    names: set[str] = set()
    inner = [line for let in _needed(loop.lets, sums) for line in lane_let(let, names)]
    for total in sums:
        inner += plain(*statement("", f"{total.name}_l += ", text(total.term, C, in_lanes), ";"))
    body = [
        *plain(*(f"tisserand_lanes {total.name}_l = {{0.0}};" for total in sums)),
        *plain(f"for (int i = 0; i < {whole}; i += {LANES}) {{"),
        *indented(inner),
        *plain("}"),
        *plain(*(line for k, t in enumerate(sums, first) for line in store(f"{name}[{k}] + l", f"{t.name}_l"))),
    ]
    return over_lanes(body)


def _needed(lets: tuple[Let, ...], sums: Iterable[Sum]) -> list[Let]:
    """The values that some sums are made of, in their order."""
    names = {n for total in sums for n in reads(Let("", total.term))}
    kept: list[Let] = []
    for let in reversed(lets):
        if let.name in names:
            names |= set(reads(let))
            kept.insert(0, let)
    return kept


def _lane_item(item: MapItem, names: set[str]) -> Lines:
    """An item of a `Map` in lanes; `names` are the values that differ from lane to lane."""
    value = text(item.expr, C, in_lanes)
    match item:
        case Let():
            return lane_let(item, names)
        case StoreLocal():
            output, offset, stride = item.array, 0, 1
        case StoreStrided():
            output, offset, stride = item.output, item.offset, item.stride
        case _:
            assert_never(item)
    if has_lanes(item.expr, names):
        texts = scatter(output, offset, stride, value)
    else:
        index = _element_index(offset, stride, BreakableText(("i", " + l", " + m")))
        texts = statement("", f"for (int m = 0; m < TISSERAND_WIDTH; m++) {output}[{index}] = ", value, ";")
    if isinstance(item, StoreStrided):
        return storing(texts, output, offset, over_modes=True)
    return defining(texts, output)


def _map_item(item: MapItem) -> Lines:
    value = text(item.expr, C)
    match item:
        case Let():
            return defining(statement("    ", f"const double {item.name} = ", value, ";"), item.name)
        case StoreLocal():
            return defining(statement("    ", f"{item.array}[i] = ", value, ";"), item.array)
        case StoreStrided():
            target = f"{item.output}[{_element_index(item.offset, item.stride, BreakableText(('i',)))}] = "
            return storing(statement("    ", target, value, ";"), item.output, item.offset, over_modes=True)
        case _:
            assert_never(item)


def _element_index(offset: int, stride: int, i: BreakableText) -> str:
    """The index of the element that a step i writes, its offset first."""
    index = strided(0, stride, i)
    return str(join(str(offset), PLUS, index) if offset else index)
