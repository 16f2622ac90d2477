"""Loops of a Kernel as C: contiguous, with counts that the compiler knows, in a form that it turns into vectors.

Sums run in four lanes and matrices in panels of four columns, so that no compiler has to change the order of additions.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction
from itertools import count
from typing import assert_never

from derive.backends.expression_text import C, element, strided, text
from derive.backends.source_map import SourceLine, defining, plain, storing
from derive.backends.wrapping import PLUS, BreakableText, join, statement
from derive.ir.expressions import Expr, MatrixEntry, Number, walk
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
    PackSource,
    RequireFinite,
    StoreLocal,
    StoreStrided,
    TriangularSolve,
    padded,
)

Lines = list[SourceLine]
ZERO = Number(Fraction(0))


class CLoops:
    """The loops of one function; `panel` is the name of the model's helper for products with a panel."""

    def __init__(self, panel: str) -> None:
        self.panel = panel
        self._arrays: set[str] = set()
        self._numbers: Iterator[int] = count(1)

    def lines(self, loop: Loop) -> Lines:
        """The lines of one statement, as they are written in a function."""
        return indented(self._lines(loop))

    def _lines(self, loop: Loop) -> Lines:
        match loop:
            case Map():
                return self._map(loop)
            case Accumulate():
                return self._accumulate(loop)
            case MatVec():
                return self._matvec(loop)
            case MatrixStore():
                return _matrix_store(loop)
            case Pack():
                return _pack(loop)
            case Clear():
                return plain(f"for (int i = 0; i < {loop.count}; i++) {loop.output}[i] = 0.0;")
            case RequireFinite():
                check = f"    if (!isfinite({loop.argument}[i])) return {loop.code}; /* {loop.text} */"
                return plain(f"for (int i = 0; i < {loop.count}; i++)", check)
            case Cholesky():
                return _cholesky(loop)
            case TriangularSolve():
                return _triangular_solve(loop)
            case _:
                assert_never(loop)

    def _map(self, loop: Map) -> Lines:
        declarations = []
        for item in loop.body:
            if isinstance(item, StoreLocal) and item.array not in self._arrays:
                self._arrays.add(item.array)
                declarations.append(f"double {item.array}[{padded(loop.count)}];")
        body = [line for item in loop.body for line in _map_item(item)]
        return [*plain(*declarations, _for("i", loop.count)), *body, *plain("}")]

    def _accumulate(self, loop: Accumulate) -> Lines:
        name = f"sums{next(self._numbers)}"
        many = len(loop.sums)

        def body(index: BreakableText, lane: str) -> Lines:
            lines = []
            for let in loop.lets:
                value = text(let.expr, C, lambda leaf: element(leaf, index))
                lines += defining(statement("    ", f"const double {let.name} = ", value, ";"), let.name)
            for k, total in enumerate(loop.sums):
                value = text(total.term, C, lambda leaf: element(leaf, index))
                lines += plain(*statement("    ", f"{name}[{k}][{lane}] += ", value, ";"))
            return lines

        whole = loop.count // LANES * LANES
        lines = plain(
            f"double {name}[{many}][{LANES}];",
            _for("i", many, 0, ""),
            f"    {_for('l', LANES, 0, f'{name}[i][l] = 0.0;')}",
        )
        if whole:
            inner = [*plain(_for("l", LANES)), *body(BreakableText(("i", " + l")), "l"), *plain("}")]
            lines += [*plain(f"for (int i = 0; i < {whole}; i += {LANES}) {{"), *indented(inner), *plain("}")]
        if loop.count > whole:
            lines += [*plain(_for("i", loop.count, whole)), *body(BreakableText(("i",)), f"i % {LANES}"), *plain("}")]
        for k, total in enumerate(loop.sums):
            lanes = f"(({name}[{k}][0] + {name}[{k}][1]) + ({name}[{k}][2] + {name}[{k}][3]))"
            value = lanes if total.base == ZERO else f"{text(total.base, C)} + {lanes}"
            lines += defining([f"const double {total.name} = {value};"], total.name)
        return lines

    def _matvec(self, loop: MatVec) -> Lines:
        packing = loop.packing
        size, tables = packing.padded, len(packing.tables)
        lines = []
        for vector in dict.fromkeys(vector for term in loop.terms for vector, _ in term.sums):
            if f"x_{vector}" in self._arrays:
                continue
            self._arrays.add(f"x_{vector}")
            lines += [
                f"double x_{vector}[{size}];",
                f"for (int i = 0; i < {packing.count}; i++) x_{vector}[i] = {vector}[i];",
            ]
            if size > packing.count:
                lines.append(f"for (int i = {packing.count}; i < {size}; i++) x_{vector}[i] = 0.0;")
        lines += [f"double {term.name}[{size}];" for term in loop.terms]
        lines.append(_for("i", size))
        start: Lines = []
        for term in loop.terms:
            start += defining([f"{term.name}[i] = {f'{term.base}[i]' if term.base else '0.0'};"], term.name)
        calls: Lines = []
        for term in loop.terms:
            for vector, table in term.sums:
                first = packing.tables.index(table) * LANES * size
                calls += defining([f"{self.panel}({term.name}, panel + {first}, x_{vector} + j);"], term.name)
        head = f"for (int j = 0; j < {size}; j += {LANES}) {{"
        pointer = f"const double *panel = {packing.array} + {tables * size} * j;"
        return [
            *plain(*lines),
            *indented(start),
            *plain("}", head),
            *indented([*plain(pointer), *calls]),
            *plain("}"),
        ]


def _map_item(item: MapItem) -> Lines:
    value = text(item.expr, C)
    match item:
        case Let():
            return defining(statement("    ", f"const double {item.name} = ", value, ";"), item.name)
        case StoreLocal():
            return defining(statement("    ", f"{item.array}[i] = ", value, ";"), item.array)
        case StoreStrided():
            target = f"{item.output}[{_element_index(item)}] = "
            return storing(statement("    ", target, value, ";"), item.output, item.offset, over_modes=True)
        case _:
            assert_never(item)


def _matrix_store(loop: MatrixStore) -> Lines:
    packing = loop.packing
    used = [t for t in packing.tables if _reads(loop.expr, t)]
    pointer = f"double *column = {loop.output} + {loop.offset} + {loop.stride} * j;"
    lines = storing([pointer], loop.output, loop.offset, over_modes=True)
    if used:
        columns = len(packing.tables) * LANES
        first = f"(j / {LANES} * {columns} + j % {LANES}) * {packing.padded}"
        lines += plain(f"const double *table = {packing.array} + {first};")
        for name in used:
            lines += plain(f"const double *{name} = table + {packing.tables.index(name) * LANES * packing.padded};")
    body = statement("    ", "column[i] = ", text(loop.expr, C), ";")
    lines += plain(_for("i", packing.count), *body, "}")
    if loop.diagonal is not None:
        diagonal = text(loop.diagonal, C, lambda leaf: element(leaf, BreakableText(("j",))))
        lines += plain(*statement("", "column[j] += ", diagonal, ";"))
    return [*plain(_for("j", packing.count)), *indented(lines), *plain("}")]


def _pack(loop: Pack) -> Lines:
    packing = loop.packing
    n, size, columns = packing.count, packing.padded, len(packing.tables) * LANES
    even = [s for s in loop.sources if s.parity > 0]
    odd = [s for s in loop.sources if s.parity < 0]

    def first(source: PackSource) -> int:
        return packing.tables.index(source.table) * LANES * size

    inner = [
        "const int low = i < j ? i : j, high = i < j ? j : i;",
        f"double *to = {loop.output} + (j / {LANES} * {columns} + j % {LANES}) * {size} + i;",
    ]
    if even:
        inner.append(f"const int even = low * {n} - low * (low - 1) / 2 + high - low;")
        inner += [f"to[{first(s)}] = {_parameter(s, 'even')};" for s in even]
    if odd:
        inner.append("if (i != j) {")
        inner.append(f"    const int odd = low * {n - 1} - low * (low - 1) / 2 + high - low - 1;")
        inner.append("    const double sign = i < j ? 1.0 : -1.0;")
        inner += [f"    to[{first(s)}] = sign * {_parameter(s, 'odd')};" for s in odd]
        inner.append("}")
    rows = plain(_for("i", n), *(f"    {line}" for line in inner), "}")
    return [*plain(_for("j", n)), *indented(rows), *plain("}")]


def _cholesky(loop: Cholesky) -> Lines:
    n = loop.count
    return plain(
        f"double *low = {loop.output} + {loop.offset};",
        _for("j", n),
        f"    for (int i = j; i < {n}; i++) low[{n} * j + i] = {loop.source}[j * {n} - j * (j - 1) / 2 + i - j];",
        "}",
        _for("j", n),
        "    for (int m = 0; m < j; m++) {",
        f"        const double above = low[{n} * m + j];",
        f"        for (int i = j; i < {n}; i++) low[{n} * j + i] -= low[{n} * m + i] * above;",
        "    }",
        f"    if (!(low[{n + 1} * j] > 0.0)) return {loop.code}; /* {loop.text} */",
        f"    const double inverse = 1.0 / sqrt(low[{n + 1} * j]);",
        f"    for (int i = j + 1; i < {n}; i++) low[{n} * j + i] *= inverse;",
        f"    low[{n + 1} * j] = inverse;",
        "}",
    )


def _triangular_solve(loop: TriangularSolve) -> Lines:
    """All arrays in one pass, so that each entry of the factor is read once."""
    n, many = loop.count, range(len(loop.arrays))
    scale = [f"{name}[j] *= {loop.factor}[{n + 1} * j];" for name in loop.arrays]
    if loop.transposed:
        below = [f"    {name}[j] -= {loop.factor}[{n} * j + i] * {name}[i];" for name in loop.arrays]
        inner = plain(f"for (int i = j + 1; i < {n}; i++) {{", *below, "}", *scale)
        return [*plain(f"for (int j = {n - 1}; j >= 0; j--) {{"), *indented(inner), *plain("}")]
    fixed = [f"const double y{k} = {loop.arrays[k]}[j];" for k in many]
    below = [f"    {loop.arrays[k]}[i] -= {loop.factor}[{n} * j + i] * y{k};" for k in many]
    inner = plain(*scale, *fixed, f"for (int i = j + 1; i < {n}; i++) {{", *below, "}")
    return [*plain(_for("j", n)), *indented(inner), *plain("}")]


SHORT = 16
"""Iterations that gcc unrolls completely before it makes vectors."""

LANES_MACRO = """\
/* Before a short loop: gcc would unroll it first, and then not make vectors of it. */
#if defined(__GNUC__) && !defined(__clang__) && __GNUC__ >= 8
#  define TISSERAND_LANES _Pragma("GCC unroll 1")
#else
#  define TISSERAND_LANES
#endif
"""


def panel_helper(name: str, size: int) -> list[str]:
    """y += A x for four columns of A."""
    sum_of = " + ".join(f"a[{f'{k * size} + ' if k else ''}i] * x{k}" for k in range(LANES))
    return [
        "/* y += A x for a panel of four columns */",
        f"static inline void {name}(",
        "    double *TISSERAND_RESTRICT y,",
        "    const double *TISSERAND_RESTRICT a,",
        "    const double *TISSERAND_RESTRICT x)",
        "{",
        f"    const double {', '.join(f'x{k} = x[{k}]' for k in range(LANES))};",
        f"    {_for('i', size, 0, f'y[i] = y[i] + {sum_of};')}",
        "}",
        "",
    ]


def _for(index: str, stop: int, start: int = 0, body: str = "{") -> str:
    """The head of a loop; see LANES_MACRO for the pragma before a short loop."""
    short = "TISSERAND_LANES " if 1 < stop - start <= SHORT else ""
    return f"{short}for (int {index} = {start}; {index} < {stop}; {index}++) {body}".rstrip()


def indented(lines: Iterable[SourceLine]) -> Lines:
    """Lines, one step further to the right."""
    return [line.indented() for line in lines]


def _element_index(item: StoreStrided) -> str:
    """The index of the element that a step i writes, its offset first."""
    index = strided(0, item.stride)
    return str(join(str(item.offset), PLUS, index) if item.offset else index)


def _parameter(source: PackSource, index: str) -> str:
    if source.components == 1:
        return f"{source.array}[{index}]"
    return f"{source.array}[{source.components} * {index} + {source.component}]"


def _reads(expr: Expr, table: str) -> bool:
    return any(isinstance(part, MatrixEntry) and part.table == table for part in walk(expr))
