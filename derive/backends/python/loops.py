"""Loops of a Kernel as NumPy: a loop over the modes is an axis, the last one; packed tables are matrices.

In a matrix the last two axes are j and i. Scalars get axes of length one by `_last`.
"""

from __future__ import annotations

from typing import assert_never

from derive.backends.expression_text import PYTHON, Named, text
from derive.backends.source_map import SourceLine, defining, plain, storing
from derive.backends.wrapping import PLUS, WIDTH, BreakableText, join, statement
from derive.ir.expansion import ZERO
from derive.ir.expressions import Element, Ends, Expr, MatrixEntry, ScalarRef, walk
from derive.ir.indices import LANES, ElementIndex, variable
from derive.ir.kernel import Argument
from derive.ir.packing import Packing
from derive.ir.statements import (
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
    TriangularSolve,
)

Lines = list[SourceLine]


def assignment(name: str, value: str | BreakableText) -> list[str]:
    """`name = value` in a function, in parentheses where it takes several lines."""
    code = join(value)
    lines = statement("    ", f"{name} = ", code, "")
    if len(lines) == 1:
        return lines
    return [f"    {name} = (", *statement("        ", "", code, ""), "    )"]


def _short(name: str, value: str | BreakableText) -> list[str]:
    """An assignment on one line if that is not too long."""
    line = f"    {name} = {value}"
    return [line] if len(line) <= WIDTH else assignment(name, value)


class PythonLoops:
    """The loops of one function; `lengths` are those of the arrays that it knows."""

    def __init__(self, arguments: tuple[Argument, ...]) -> None:
        self.lengths = {view.name: view.size for a in arguments for view in a.arrays}
        self.inside: set[str] = set()

    def lines(self, loop: Loop) -> Lines:
        """The lines of one statement, as they are written in a function."""
        match loop:
            case Map():
                return [line for item in loop.body for line in self._map_item(item, loop.count)]
            case Accumulate():
                return self._accumulate(loop)
            case MatVec():
                return self._matvec(loop)
            case MatrixStore():
                return self._matrix_store(loop)
            case Pack():
                return _pack(loop)
            case Clear():
                return []  # outputs are zero when they are made
            case RequireFinite():
                return plain(f'    _require(xp.all(xp.isfinite({loop.argument})), {loop.code}, "{loop.text}")')
            case Cholesky():
                return _cholesky(loop)
            case TriangularSolve():
                return _triangular_solve(loop)
            case _:
                assert_never(loop)

    def _text(self, expr: Expr, count: int, depth: int = 1) -> BreakableText:
        """An expression in a loop of so many steps; in a matrix (depth 2), an array of index i has an axis for j."""

        def name(leaf: Named) -> BreakableText:
            match leaf:
                case MatrixEntry():
                    return BreakableText((leaf.table,))
                case ScalarRef():
                    scalar = leaf.name if leaf.name in self.inside else f"_last({leaf.name})"
                    return BreakableText((scalar if depth == 1 or leaf.name in self.inside else f"_last({scalar})",))
                case Element():
                    assert leaf.index
                    return BreakableText((self._array(leaf.array, leaf.index, count, depth),))
                case Ends():
                    raise AssertionError("no loop over modes has ends")
                case _:
                    assert_never(leaf)

        return text(expr, PYTHON, name)

    def _array(self, array: str, index: ElementIndex, count: int, depth: int = 1) -> str:
        if index.stride("i") > 1:
            return f"{array}[..., {index.offset}::{index.stride('i')}]"
        known = self.lengths.get(array, count)
        cut = array if known == count else f"{array}[..., :{count}]"
        return cut if depth == 1 else f"{cut}[..., None, :]"

    def _map_item(self, item: MapItem, count: int) -> Lines:
        value = self._text(item.expr, count)
        match item:
            case Let():
                self.inside.add(item.name)
                return defining(_short(item.name, value), item.name)
            case StoreLocal():
                self.lengths[item.array] = count
                return defining(_short(item.array, value), item.array)
            case StoreStrided():
                target = f"{item.output}[{_slice(item.offset, item.stride, count)}]"
                return storing(_short(target, value), item.output, item.offset, over_modes=True)
            case _:
                assert_never(item)

    def _accumulate(self, loop: Accumulate) -> Lines:
        lines: Lines = []
        for let in loop.lets:
            self.inside.add(let.name)
            lines += defining(_short(let.name, self._text(let.expr, loop.count)), let.name)
        for item in loop.sums:
            total = join("xp.sum(", self._text(item.term, loop.count), ", axis=-1)")
            value = total if item.base == ZERO else join(text(item.base, PYTHON), PLUS, total)
            lines += defining(_short(item.name, value), item.name)
        return lines

    def _matvec(self, loop: MatVec) -> Lines:
        packing = loop.packing
        n = packing.count
        lines: Lines = []
        for term in loop.terms:
            parts = [self._array(term.base, variable("i"), n)] if term.base else []
            for p in term.sums:
                matrix = f"_table(xp, {packing.array}, {_places(packing, p.table)}, {n})"
                parts.append(f"{'-' if p.sign < 0 else ''}_product(xp, {p.vector}, {matrix})")
            value = join(parts[0], *(part for other in parts[1:] for part in (PLUS, other)))
            lines += defining(_short(term.name, value), term.name)
            self.lengths[term.name] = n
        return lines

    def _matrix_store(self, loop: MatrixStore) -> Lines:
        packing = loop.packing
        n = packing.count
        texts: list[str] = []
        for name in packing.tables:
            if any(isinstance(e, MatrixEntry) and e.table == name for e in walk(loop.expr)):
                texts += _short(name, f"_table(xp, {packing.array}, {_places(packing, name)}, {n})")
        texts += _short("block", self._text(loop.expr, n, 2))
        texts += [f"    for j in range({n}):", f"        first = {loop.offset} + {loop.stride} * j"]
        lines = plain(*texts)
        lines += storing(
            [f"        {loop.output}[..., first : first + {n}] = block[..., j, :]"],
            loop.output,
            loop.offset,
            over_modes=True,
        )
        if loop.diagonal is not None:
            diagonal = self._text(loop.diagonal, n)
            target = f"{loop.output}[{_slice(loop.offset, loop.stride + 1, n)}]"
            lines += plain(*_short(target, join(target, PLUS, "(", diagonal, ")")))
        return lines


def _slice(offset: int, stride: int, count: int) -> str:
    stop = offset + stride * (count - 1) + 1
    return f"..., {offset}:{stop}" + (f":{stride}" if stride > 1 else "")


def _places(packing: Packing, table: str) -> str:
    """The location of a matrix in its array: its first element, and the distance of its columns."""
    return f"{packing.first(table)}, {packing.stride(table)}"


def _pack(loop: Pack) -> Lines:
    packing = loop.packing
    n = packing.count
    lines = []
    for parity, name in ((1, "even"), (-1, "odd")):
        if any(s.parity == parity for s in loop.sources):
            lines.append(f"    {name} = _pairs({n}, {parity})")
    for s in loop.sources:
        values = s.array if s.components == 1 else f"{s.array}[..., {s.component}::{s.components}]"
        pairs = "even" if s.parity > 0 else "odd"
        arguments = f"{values}, {pairs}, {_places(packing, s.table)}, {n}, {s.parity}"
        lines.append(f"    _pack(xp, {loop.output}, {arguments})")
    return plain(*lines)


def _cholesky(loop: Cholesky) -> Lines:
    n = loop.count
    target = f"{loop.output}[..., {loop.offset}:{loop.offset + n * n}]"
    return plain(
        *_short("low", f"_square(xp, {loop.source}, {n})"),
        f"    for j in range({n}):",
        "        for m in range(j):",
        "            low[..., j, j:] = low[..., j, j:] - low[..., m, j:] * low[..., m, j, None]",
        f'        _require(xp.all(low[..., j, j] > 0), {loop.code}, "{loop.text}")',
        "        inverse = 1 / xp.sqrt(low[..., j, j])",
        "        low[..., j, j + 1 :] = low[..., j, j + 1 :] * inverse[..., None]",
        "        low[..., j, j] = inverse",
        "        low[..., j, :j] = 0.0",
        *_short(target, f"xp.reshape(low, (*low.shape[:-2], {n * n}))"),
    )


def _triangular_solve(loop: TriangularSolve) -> Lines:
    call = "_back" if loop.transposed else "_forward"
    lines = [_short(name, f"{call}(xp, {loop.factor}, {name}, {loop.count})") for name in loop.arrays]
    return plain(*(text for texts in lines for text in texts))


HELPERS = f'''

def _last(value):
    """A scalar of each member of the batch with an axis for the modes."""
    return value if isinstance(value, (int, float)) else value[..., None]


def _table(xp, tables, first, stride, count):
    """A packed table as a matrix (..., j, i): blocks of {LANES} rows, in each the columns, `stride` apart."""
    size = -(-count // {LANES}) * {LANES}
    last = first + stride * size * size // {LANES} - stride
    rows = [tables[..., first + r : last + r + 1 : stride] for r in range({LANES})]
    blocks = xp.stack(rows, axis=-1).reshape((*tables.shape[:-1], size // {LANES}, size, {LANES}))
    return xp.moveaxis(blocks, -3, -2).reshape((*tables.shape[:-1], size, size))[..., :count, :count]


def _product(xp, vector, matrix):
    """Sums over j of vector_j matrix_ji."""
    return xp.matmul(vector[..., None, :], matrix)[..., 0, :]


def _pairs(count, parity):
    """Where the entries (i, j), by rows, lie among those for i <= j (i < j if odd), and their signs."""
    positions, signs = [], []
    for i in range(count):
        for j in range(count):
            low, high = min(i, j), max(i, j)
            if parity > 0:
                positions.append(low * count - low * (low - 1) // 2 + high - low)
                signs.append(1.0)
            else:
                positions.append(low * (count - 1) - low * (low - 1) // 2 + high - low - 1 if i != j else 0)
                signs.append(float(i < j) - float(i > j))
    return positions, signs


def _square(xp, values, count):
    """A symmetric matrix (..., i, j) of its entries for i <= j."""
    positions, _ = _pairs(count, 1)
    return xp.asarray(values[..., positions]).reshape((*values.shape[:-1], count, count))


def _pack(xp, k, values, pairs, first, stride, count, parity):
    """Write one table into the packed ones: blocks of {LANES} rows, in each the columns, `stride` apart."""
    positions, signs = pairs
    if values.shape[-1] == 0:
        return
    matrix = (values[..., positions] * xp.asarray(signs)).reshape((*values.shape[:-1], count, count))
    size = -(-count // {LANES}) * {LANES}
    for i in range(count):
        start = first + i // {LANES} * stride * size + i % {LANES}
        k[..., start : start + stride * (count - 1) + 1 : stride] = matrix[..., i, :]


def _forward(xp, factor, vector, count):
    """L^-1 vector."""
    vector = vector + 0 * factor[..., :1]
    for j in range(count):
        vector[..., j] = vector[..., j] * factor[..., (count + 1) * j]
        below = factor[..., count * j + j + 1 : count * (j + 1)]
        vector[..., j + 1 :] = vector[..., j + 1 :] - below * vector[..., j, None]
    return vector


def _back(xp, factor, vector, count):
    """L^-T vector."""
    vector = vector + 0 * factor[..., :1]
    for j in reversed(range(count)):
        rest = xp.sum(factor[..., count * j + j + 1 : count * (j + 1)] * vector[..., j + 1 :], axis=-1)
        vector[..., j] = (vector[..., j] - rest) * factor[..., (count + 1) * j]
    return vector
'''
"""The Python helper functions that the loops of a module call."""
