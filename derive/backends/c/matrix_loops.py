"""Loops over packed matrices as C: products with vectors, stores, packing, and triangular factors.

Matrices lie in blocks of four rows. A product of a row stays in a register until it is complete.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import assert_never

from derive.backends.c.lanes import Lines, in_lanes, indented, load, loop_head, over_lanes, store
from derive.backends.expression_text import C, Named, element, text
from derive.backends.source_map import SourceLine, defining, plain, storing
from derive.backends.wrapping import BreakableText, statement
from derive.ir.expressions import ArrayAccess, Expr, MatrixEntry, ScalarRef, walk
from derive.ir.statements import (
    LANES,
    Cholesky,
    MatrixStore,
    MatVec,
    Pack,
    Packing,
    PackSource,
    Product,
    Statement,
    TriangularSolve,
)

MAX_SUMS = 12
"""The largest number of sums in one loop: sixteen vector registers have room for these and for their operands."""


def matvec(loop: MatVec, inside: Iterable[SourceLine] = ()) -> Lines:
    """Products of matrices and vectors, block by block; `inside` are further lines for the block of row i."""
    packing = loop.packing
    size = packing.padded
    lines = plain(*(f"double {term.name}[{size}];" for term in loop.terms))
    body = plain(*(_pointer(packing, table) for table in _tables_of(loop)))
    for products in rounds(loop):
        for first in range(0, len(products), MAX_SUMS):
            body += _products(packing, products[first : first + MAX_SUMS])
    return [*lines, *plain(_blocks(size)), *indented([*body, *inside]), *plain("}")]


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
    starts = [f"tisserand_lanes {t.name}_l = {load(f'{t.base} + i + l') if t.base else '{0.0}'};" for t in totals]
    lines: Lines = plain(*starts, loop_head("j", packing.count, short=False))
    for t in totals:
        p, change = t.product, "+=" if t.product.sign > 0 else "-="
        value = f"{load(f'{p.table} + {packing.stride(p.table)} * j + l')} * {p.vector}[j]"
        lines += defining([f"    {t.name}_l {change} {value};"], t.name)
    lines += plain("}", *(line for t in totals for line in store(f"{t.name} + i + l", f"{t.name}_l")))
    return over_lanes(lines, min(LANES, packing.count))


def _tables_of(loop: MatVec) -> list[str]:
    used = {product.table for term in loop.terms for product in term.sums}
    return [table for table in loop.packing.tables if table in used]


def _pointer(packing: Packing, table: str) -> str:
    """A name for the columns of a matrix in the block of row i."""
    return f"const double *{table} = {_block(packing, table)};"


def _column(packing: Packing, table: str) -> str:
    """A name for column j of a matrix in the block of row i."""
    return f"const double *{table}_j = {_block(packing, table)} + {packing.stride(table)} * j;"


def _block(packing: Packing, table: str) -> str:
    first = packing.first(table)
    return f"{packing.array}{f' + {first}' if first else ''} + {packing.block(table) // LANES} * i"


def _blocks(rows: int) -> str:
    """The head of a loop over blocks of rows."""
    return f"for (int i = 0; i < {rows}; i += {LANES}) {{"


def matrix_store(loop: MatrixStore) -> Lines:
    """The loops of a `MatrixStore`: block by block and in it column by column, so that the tables are read in order."""
    packing = loop.packing
    whole = packing.count // LANES * LANES
    lines: Lines = []
    if whole:
        lines += [*plain(_blocks(whole)), *indented(_matrix_rows(loop, LANES)), *plain("}")]
    if packing.count > whole:
        rest = indented([*plain(f"const int i = {whole};"), *_matrix_rows(loop, packing.count - whole)])
        lines += [*plain("{"), *rest, *plain("}")]
    return [*lines, *diagonal(loop)]


def diagonal(loop: MatrixStore) -> Lines:
    """The loop that adds the diagonal part of a `MatrixStore`."""
    if loop.diagonal is None:
        return []
    value = text(loop.diagonal, C, lambda leaf: element(leaf, BreakableText(("j",))))
    target = f"{loop.output}[{loop.offset} + {loop.stride + 1} * j] += "
    head = loop_head("j", loop.packing.count)
    return plain(head, *statement("    ", target, value, ";"), "}")


def stores_in_block(loop: MatrixStore) -> Lines:
    """The statements that store the columns of a `MatrixStore` in the block of row i, without its diagonal part."""
    packing = loop.packing
    whole = packing.count // LANES * LANES
    full, rest = _matrix_rows(loop, LANES), _matrix_rows(loop, packing.count - whole)
    if whole == packing.count:
        return full
    if not whole:
        return rest
    return [*plain(f"if (i < {whole}) {{"), *indented(full), *plain("} else {"), *indented(rest), *plain("}")]


def stored_in_blocks(body: Sequence[Statement]) -> dict[int, dict[int, MatrixStore]]:
    """The products of matrices in a section, and the stores directly behind them that read the same tables.

    They go through the blocks together, since a block stays in the nearest memory. Statements by their numbers.
    """
    result: dict[int, dict[int, MatrixStore]] = {}
    packing: Packing | None = None
    stores: dict[int, MatrixStore] = {}
    for n, item in enumerate(body):
        match item:
            case MatVec():
                packing, stores = item.packing, {}
                result[n] = stores
            case MatrixStore() if item.packing == packing:
                stores[n] = item
            case _:
                packing = None
    return result


def _matrix_rows(loop: MatrixStore, rows: int) -> Lines:
    """The columns of a block, or of the rows that are left of it."""
    packing = loop.packing
    used = [t for t in packing.tables if _reads(loop.expr, t)]
    target = f"double *column = {loop.output} + {loop.offset} + {loop.stride} * j + i;"
    columns = storing([target], loop.output, loop.offset, over_modes=True)
    columns += plain(*(_column(packing, table) for table in used))
    if rows == LANES:
        columns += over_lanes(plain(*store("column + l", text(loop.expr, C, in_lanes))))
    else:
        row = statement("    ", "column[l] = ", text(loop.expr, C, _in_block), ";")
        columns += plain(loop_head("l", rows), *row, "}")
    return [*plain(loop_head("j", packing.count, short=False)), *indented(columns), *plain("}")]


def _in_block(leaf: Named) -> BreakableText:
    """A leaf of a matrix in row i + l and column j."""
    match leaf:
        case MatrixEntry():
            return BreakableText((f"{leaf.table}_j[l]",))
        case ArrayAccess():
            return element(leaf, BreakableText(("i", " + l") if leaf.index == "i" else ("j",)))
        case ScalarRef():
            return element(leaf)
        case _:
            assert_never(leaf)


def pack(loop: Pack) -> Lines:
    """The loops that pack matrices: each entry comes from its place among the entries i <= j (i < j)."""
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
    rows = plain(loop_head("i", n), *(f"    {line}" for line in inner), "}")
    return [*plain(loop_head("j", n)), *indented(rows), *plain("}")]


def cholesky(loop: Cholesky) -> Lines:
    """The Cholesky factorisation, column by column and in place."""
    n = loop.count
    return plain(
        f"double *low = {loop.output} + {loop.offset};",
        loop_head("j", n),
        f"    for (int i = j; i < {n}; i++) low[{n} * j + i] = {loop.source}[j * {n} - j * (j - 1) / 2 + i - j];",
        "}",
        loop_head("j", n),
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


def triangular_solve(loop: TriangularSolve) -> Lines:
    """The triangular solutions of all arrays in one pass, so that each entry of the factor is read once."""
    n, many = loop.count, range(len(loop.arrays))
    scale = [f"{name}[j] *= {loop.factor}[{n + 1} * j];" for name in loop.arrays]
    if loop.transposed:
        below = [f"    {name}[j] -= {loop.factor}[{n} * j + i] * {name}[i];" for name in loop.arrays]
        inner = plain(f"for (int i = j + 1; i < {n}; i++) {{", *below, "}", *scale)
        return [*plain(f"for (int j = {n - 1}; j >= 0; j--) {{"), *indented(inner), *plain("}")]
    fixed = [f"const double y{k} = {loop.arrays[k]}[j];" for k in many]
    below = [f"    {loop.arrays[k]}[i] -= {loop.factor}[{n} * j + i] * y{k};" for k in many]
    inner = plain(*scale, *fixed, f"for (int i = j + 1; i < {n}; i++) {{", *below, "}")
    return [*plain(loop_head("j", n)), *indented(inner), *plain("}")]


def _parameter(source: PackSource, index: str) -> str:
    if source.components == 1:
        return f"{source.array}[{index}]"
    return f"{source.array}[{source.components} * {index} + {source.component}]"


def _reads(expr: Expr, table: str) -> bool:
    return any(isinstance(part, MatrixEntry) and part.table == table for part in walk(expr))
