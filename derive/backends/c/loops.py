"""Loops of a Kernel as C: contiguous, with counts that the compiler knows, in a form that it turns into vectors.

Sums run in four lanes and tables in panels of four columns, so that no compiler has to change the order of additions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import count

from derive.backends.expression_text import c_number, statement, text
from derive.ir.expressions import Expr, MatrixEntry, walk
from derive.ir.statements import (
    LANES,
    Accumulate,
    Cholesky,
    Clear,
    Let,
    Map,
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

Lines = list[str]
Loop = Map | Accumulate | MatVec | MatrixStore | Pack | Clear | RequireFinite | Cholesky | TriangularSolve


class Loops:
    """The loops of one function; `panel` is the name of the model's helper for contractions."""

    def __init__(self, panel: str) -> None:
        self.panel = panel
        self._arrays: set[str] = set()
        self._numbers: Iterator[int] = count(1)

    def lines(self, loop: Loop, indent: str = "    ") -> Lines:
        """One statement with loops."""
        writers: dict[type, Callable[..., Lines]] = {
            Map: self._each,
            Accumulate: self._reduce,
            MatVec: self._contract,
            MatrixStore: self._pairs,
            Pack: self._pack,
            Clear: self._clear,
            RequireFinite: self._require_all,
            Cholesky: self._root,
            TriangularSolve: self._substitute,
        }
        return [f"{indent}{line}" if line else "" for line in writers[type(loop)](loop)]

    def _each(self, loop: Map) -> Lines:
        lines = []
        for item in loop.body:
            if isinstance(item, StoreLocal) and item.array not in self._arrays:
                self._arrays.add(item.array)
                lines.append(f"double {item.array}[{padded(loop.count)}];")
        body = []
        for item in loop.body:
            value = text(item.expr, c_number)
            if isinstance(item, Let):
                body += statement("    ", f"const double {item.name} = ", value, ";")
            elif isinstance(item, StoreLocal):
                body += statement("    ", f"{item.array}[i] = ", value, ";")
            else:
                body += statement("    ", f"{item.output}[{_place(item)}] = ", value, ";")
        return [*lines, _for("i", loop.count), *body, "}"]

    def _reduce(self, loop: Accumulate) -> Lines:
        name = f"sums{next(self._numbers)}"
        many = len(loop.sums)

        def body(index: str, lane: str) -> Lines:
            lines = []
            for let in loop.lets:
                lines += statement("    ", f"const double {let.name} = ", text(let.expr, c_number, index=index), ";")
            for k, one in enumerate(loop.sums):
                lines += statement("    ", f"{name}[{k}][{lane}] += ", text(one.term, c_number, index=index), ";")
            return lines

        whole = loop.count // LANES * LANES
        lines = [f"double {name}[{many}][{LANES}];"]
        lines += [
            _for("i", many, 0, ""),
            _indented(_for("l", LANES, 0, f"{name}[i][l] = 0.0;")),
        ]
        if whole:
            inner = [_for("l", LANES), *body("i + l", "l"), "}"]
            lines += [f"for (int i = 0; i < {whole}; i += {LANES}) {{", *map(_indented, inner), "}"]
        if loop.count > whole:
            lines += [_for("i", loop.count, whole), *body("i", f"i % {LANES}"), "}"]
        for k, one in enumerate(loop.sums):
            total = f"(({name}[{k}][0] + {name}[{k}][1]) + ({name}[{k}][2] + {name}[{k}][3]))"
            base = text(one.base, c_number)
            lines.append(
                f"const double {one.name} = {total};"
                if base == "0.0"
                else f"const double {one.name} = {base} + {total};"
            )
        return lines

    def _contract(self, loop: MatVec) -> Lines:
        packing = loop.packing
        size, tables = packing.padded, len(packing.tables)
        lines = []
        for vector in dict.fromkeys(vector for lane in loop.terms for vector, _ in lane.sums):
            if f"x_{vector}" in self._arrays:
                continue
            self._arrays.add(f"x_{vector}")
            lines += [
                f"double x_{vector}[{size}];",
                f"for (int i = 0; i < {packing.count}; i++) x_{vector}[i] = {vector}[i];",
            ]
            if size > packing.count:
                lines.append(f"for (int i = {packing.count}; i < {size}; i++) x_{vector}[i] = 0.0;")
        lines += [f"double {lane.name}[{size}];" for lane in loop.terms]
        start = (f"{lane.name}[i] = {f'{lane.base}[i]' if lane.base else '0.0'};" for lane in loop.terms)
        lines += [_for("i", size), *map(_indented, start), "}"]
        calls = []
        for lane in loop.terms:
            for vector, table in lane.sums:
                place = packing.tables.index(table) * LANES * size
                calls.append(f"{self.panel}({lane.name}, panel + {place}, x_{vector} + j);")
        head = f"for (int j = 0; j < {size}; j += {LANES}) {{"
        pointer = f"const double *panel = {packing.array} + {tables * size} * j;"
        return [*lines, head, *map(_indented, [pointer, *calls]), "}"]

    def _pairs(self, loop: MatrixStore) -> Lines:
        packing = loop.packing
        used = [t for t in packing.tables if _reads(loop.expr, t)]
        lines = [f"double *column = {loop.output} + {loop.offset} + {loop.stride} * j;"]
        if used:
            columns = len(packing.tables) * LANES
            first = f"(j / {LANES} * {columns} + j % {LANES}) * {packing.padded}"
            lines.append(f"const double *table = {packing.array} + {first};")
            for name in used:
                lines.append(f"const double *{name} = table + {packing.tables.index(name) * LANES * packing.padded};")
        lines += [_for("i", packing.count), *statement("    ", "column[i] = ", text(loop.expr, c_number), ";"), "}"]
        if loop.diagonal is not None:
            lines += statement("", "column[j] += ", text(loop.diagonal, c_number, index="j"), ";")
        return [_for("j", packing.count), *map(_indented, lines), "}"]

    def _pack(self, loop: Pack) -> Lines:
        packing = loop.packing
        n, size, columns = packing.count, packing.padded, len(packing.tables) * LANES
        even = [s for s in loop.sources if s.parity > 0]
        odd = [s for s in loop.sources if s.parity < 0]

        def place(source: PackSource) -> int:
            return packing.tables.index(source.table) * LANES * size

        inner = [
            "const int low = i < j ? i : j, high = i < j ? j : i;",
            f"double *to = {loop.output} + (j / {LANES} * {columns} + j % {LANES}) * {size} + i;",
        ]
        if even:
            inner.append(f"const int even = low * {n} - low * (low - 1) / 2 + high - low;")
            inner += [f"to[{place(s)}] = {_parameter(s, 'even')};" for s in even]
        if odd:
            inner.append("if (i != j) {")
            inner.append(f"    const int odd = low * {n - 1} - low * (low - 1) / 2 + high - low - 1;")
            inner.append("    const double sign = i < j ? 1.0 : -1.0;")
            inner += [f"    to[{place(s)}] = sign * {_parameter(s, 'odd')};" for s in odd]
            inner.append("}")
        rows = [_for("i", n), *map(_indented, inner), "}"]
        return [_for("j", n), *map(_indented, rows), "}"]

    def _clear(self, loop: Clear) -> Lines:
        return [f"for (int i = 0; i < {loop.count}; i++) {loop.output}[i] = 0.0;"]

    def _require_all(self, loop: RequireFinite) -> Lines:
        head = f"for (int i = 0; i < {loop.count}; i++)"
        return [head, f"    if (!isfinite({loop.argument}[i])) return {loop.code}; /* {loop.text} */"]

    def _root(self, loop: Cholesky) -> Lines:
        n = loop.count
        return [
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
        ]

    def _substitute(self, loop: TriangularSolve) -> Lines:
        """All arrays in one pass, so that each entry of the factor is read once."""
        n, many = loop.count, range(len(loop.arrays))
        scale = [f"{name}[j] *= {loop.factor}[{n + 1} * j];" for name in loop.arrays]
        if loop.transposed:
            below = [f"{name}[j] -= {loop.factor}[{n} * j + i] * {name}[i];" for name in loop.arrays]
            inner = [f"for (int i = j + 1; i < {n}; i++) {{", *map(_indented, below), "}", *scale]
            return [f"for (int j = {n - 1}; j >= 0; j--) {{", *map(_indented, inner), "}"]
        fixed = [f"const double y{k} = {loop.arrays[k]}[j];" for k in many]
        below = [f"{loop.arrays[k]}[i] -= {loop.factor}[{n} * j + i] * y{k};" for k in many]
        inner = [*scale, *fixed, f"for (int i = j + 1; i < {n}; i++) {{", *map(_indented, below), "}"]
        return [_for("j", n), *map(_indented, inner), "}"]


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


def panel_helper(name: str, size: int) -> Lines:
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
    """The head of a loop; see LANES_MACRO for what stands before a short one."""
    short = "TISSERAND_LANES " if 1 < stop - start <= SHORT else ""
    return f"{short}for (int {index} = {start}; {index} < {stop}; {index}++) {body}".rstrip()


def _indented(line: str) -> str:
    return f"    {line}"


def _place(item: StoreStrided) -> str:
    index = "i" if item.stride == 1 else f"{item.stride} * i"
    return f"{item.offset} + {index}" if item.offset else index


def _parameter(source: PackSource, index: str) -> str:
    if source.components == 1:
        return f"{source.array}[{index}]"
    return f"{source.array}[{source.components} * {index} + {source.component}]"


def _reads(expr: Expr, table: str) -> bool:
    return any(isinstance(part, MatrixEntry) and part.table == table for part in walk(expr))
