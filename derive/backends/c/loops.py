"""Loops of a Kernel as C: contiguous, with counts that the compiler knows, in a form that it turns into vectors.

Sums run in four lanes and matrices in blocks of four rows, so that no compiler has to change the order of additions.
The loop over the lanes is outside of that over the modes: a sum stays in a vector register until it is complete.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import count
from typing import assert_never

from derive.backends.expression_text import C, Named, element, strided, text
from derive.backends.source_map import SourceLine, defining, plain, storing
from derive.backends.wrapping import PLUS, BreakableText, join, statement
from derive.ir.analysis import reads
from derive.ir.expressions import ArrayAccess, Expr, MatrixEntry, Number, ScalarRef, walk
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
    Packing,
    PackSource,
    Product,
    RequireFinite,
    StoreLocal,
    StoreStrided,
    Sum,
    TriangularSolve,
    padded,
)

Lines = list[SourceLine]
ZERO = Number(Fraction(0))


MAX_SUMS = 12
"""Sums of one loop: sixteen vector registers hold as many, and the values that they are made of."""


class CLoops:
    """The loops of one function."""

    def __init__(self) -> None:
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
        whole = loop.count // LANES * LANES
        lines = plain(f"double {name}[{len(loop.sums)}][{LANES}];")
        if whole:
            for first in range(0, len(loop.sums), MAX_SUMS):
                lines += self._lane_sums(loop, loop.sums[first : first + MAX_SUMS], first, name, whole)
        else:
            lines += plain(_for("i", len(loop.sums), 0, ""), f"    {_for('l', LANES, 0, f'{name}[i][l] = 0.0;')}")
        if loop.count > whole:
            rest = _lets(loop.lets, BreakableText(("i",)))
            for k, total in enumerate(loop.sums):
                term = text(total.term, C, lambda leaf: element(leaf, BreakableText(("i",))))
                rest += plain(*statement("    ", f"{name}[{k}][i % {LANES}] += ", term, ";"))
            lines += [*plain(_for("i", loop.count, whole)), *rest, *plain("}")]
        for k, total in enumerate(loop.sums):
            lanes = f"(({name}[{k}][0] + {name}[{k}][1]) + ({name}[{k}][2] + {name}[{k}][3]))"
            value = lanes if total.base == ZERO else f"{text(total.base, C)} + {lanes}"
            lines += defining([f"const double {total.name} = {value};"], total.name)
        return lines

    def _lane_sums(self, loop: Accumulate, sums: tuple[Sum, ...], first: int, name: str, whole: int) -> Lines:
        """Some sums in four lanes, over as many modes as fill all lanes."""
        index = BreakableText(("i", " + l"))
        inner = _lets(_needed(loop.lets, sums), index)
        for total in sums:
            value = text(total.term, C, lambda leaf: element(leaf, index))
            inner += plain(*statement("    ", f"{total.name}_l += ", value, ";"))
        body = [
            *plain(*(f"double {total.name}_l = 0.0;" for total in sums)),
            *plain(f"for (int i = 0; i < {whole}; i += {LANES}) {{"),
            *inner,
            *plain("}", *(f"{name}[{first + k}][l] = {total.name}_l;" for k, total in enumerate(sums))),
        ]
        return [*plain(_for("l", LANES)), *indented(body), *plain("}")]

    def _matvec(self, loop: MatVec) -> Lines:
        packing = loop.packing
        size = packing.padded
        lines = plain(*(f"double {term.name}[{size}];" for term in loop.terms))
        body = plain(*(_pointer(packing, table) for table in _tables_of(loop)))
        for products in rounds(loop):
            for first in range(0, len(products), MAX_SUMS):
                body += _products(packing, products[first : first + MAX_SUMS])
        return [*lines, *plain(_blocks(size)), *indented(body), *plain("}")]


@dataclass(frozen=True)
class RowSum:
    """name_i = base_i + product_i; no base is zero."""

    name: str
    base: str
    product: Product


def rounds(loop: MatVec) -> list[list[RowSum]]:
    """The products of a statement: the first of each term, then the second of those that have one, and so on.

    In a round, products with the same matrix are neighbours.
    """
    result = []
    for k in range(max((len(term.sums) for term in loop.terms), default=0)):
        present = [term for term in loop.terms if len(term.sums) > k]
        products = [RowSum(t.name, t.name if k else t.base, t.sums[k]) for t in present]
        result.append(sorted(products, key=lambda total: loop.packing.first(total.product.table)))
    return result


def _products(packing: Packing, totals: list[RowSum]) -> Lines:
    """Some products of the rows of a block, each in a register until it is complete."""
    starts = [f"double {t.name}_l = {f'{t.base}[i + l]' if t.base else '0.0'};" for t in totals]
    lines: Lines = plain(*starts, _for("j", packing.count, 0, short=False))
    for t in totals:
        p, change = t.product, "+=" if t.product.sign > 0 else "-="
        value = f"{p.table}[{packing.stride(p.table)} * j + l] * {p.vector}[j]"
        lines += defining([f"    {t.name}_l {change} {value};"], t.name)
    lines += plain("}", *(f"{t.name}[i + l] = {t.name}_l;" for t in totals))
    return [*plain(_for("l", LANES)), *indented(lines), *plain("}")]


def _tables_of(loop: MatVec) -> list[str]:
    used = {product.table for term in loop.terms for product in term.sums}
    return [table for table in loop.packing.tables if table in used]


def _pointer(packing: Packing, table: str, column: str = "") -> str:
    """A name for the columns of a matrix in the block of row i."""
    first = packing.first(table)
    start = f"{packing.array}{f' + {first}' if first else ''}"
    return f"const double *{table} = {start} + {packing.block(table) // LANES} * i{column};"


def _blocks(rows: int) -> str:
    """The head of a loop over blocks of rows."""
    return f"for (int i = 0; i < {rows}; i += {LANES}) {{"


def _lets(lets: Iterable[Let], index: BreakableText) -> Lines:
    lines: Lines = []
    for let in lets:
        value = text(let.expr, C, lambda leaf: element(leaf, index))
        lines += defining(statement("    ", f"const double {let.name} = ", value, ";"), let.name)
    return lines


def _needed(lets: tuple[Let, ...], sums: Iterable[Sum]) -> list[Let]:
    """The values that some sums are made of, in their order."""
    names = {n for total in sums for n in reads(Let("", total.term))}
    kept: list[Let] = []
    for let in reversed(lets):
        if let.name in names:
            names |= set(reads(let))
            kept.insert(0, let)
    return kept


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
    """Block by block, in it column by column, so that the tables are read in order."""
    packing = loop.packing
    whole = packing.count // LANES * LANES
    lines: Lines = []
    if whole:
        lines += [*plain(_blocks(whole)), *indented(_matrix_rows(loop, LANES)), *plain("}")]
    if packing.count > whole:
        rest = indented([*plain(f"const int i = {whole};"), *_matrix_rows(loop, packing.count - whole)])
        lines += [*plain("{"), *rest, *plain("}")]
    if loop.diagonal is not None:
        diagonal = text(loop.diagonal, C, lambda leaf: element(leaf, BreakableText(("j",))))
        target = f"{loop.output}[{loop.offset} + {loop.stride + 1} * j] += "
        lines += [*plain(_for("j", packing.count)), *plain(*statement("    ", target, diagonal, ";")), *plain("}")]
    return lines


def _matrix_rows(loop: MatrixStore, rows: int) -> Lines:
    """The columns of a block, or of the rows that are left of it."""
    packing = loop.packing
    used = [t for t in packing.tables if _reads(loop.expr, t)]
    target = f"double *column = {loop.output} + {loop.offset} + {loop.stride} * j + i;"
    columns = storing([target], loop.output, loop.offset, over_modes=True)
    columns += plain(*(_pointer(packing, table, f" + {packing.stride(table)} * j") for table in used))
    value = text(loop.expr, C, _in_block)
    columns += plain(_for("l", rows), *statement("    ", "column[l] = ", value, ";"), "}")
    return [*plain(_for("j", packing.count, 0, short=False)), *indented(columns), *plain("}")]


def _in_block(leaf: Named) -> BreakableText:
    """A leaf of a matrix in row i + l and column j."""
    match leaf:
        case MatrixEntry():
            return BreakableText((f"{leaf.table}[l]",))
        case ArrayAccess():
            return element(leaf, BreakableText(("i", " + l") if leaf.index == "i" else ("j",)))
        case ScalarRef():
            return element(leaf)
        case _:
            assert_never(leaf)


def _pack(loop: Pack) -> Lines:
    packing = loop.packing
    n = packing.count
    even = [s for s in loop.sources if s.parity > 0]
    odd = [s for s in loop.sources if s.parity < 0]

    def entry(source: PackSource) -> str:
        block = f"{packing.block(source.table)} * (i / {LANES}) + i % {LANES}"
        return f"{loop.output}[{packing.first(source.table)} + {block} + {packing.stride(source.table)} * j]"

    inner = ["const int low = i < j ? i : j, high = i < j ? j : i;"]
    if even:
        inner.append(f"const int even = low * {n} - low * (low - 1) / 2 + high - low;")
        inner += [f"{entry(s)} = {_parameter(s, 'even')};" for s in even]
    if odd:
        inner.append("if (i != j) {")
        inner.append(f"    const int odd = low * {n - 1} - low * (low - 1) / 2 + high - low - 1;")
        inner.append("    const double sign = i < j ? 1.0 : -1.0;")
        inner += [f"    {entry(s)} = sign * {_parameter(s, 'odd')};" for s in odd]
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


def _for(index: str, stop: int, start: int = 0, body: str = "{", short: bool = True) -> str:
    """The head of a loop; see LANES_MACRO for the pragma before a short loop."""
    pragma = "TISSERAND_LANES " if short and 1 < stop - start <= SHORT else ""
    return f"{pragma}for (int {index} = {start}; {index} < {stop}; {index}++) {body}".rstrip()


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
