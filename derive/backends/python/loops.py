"""Loops of a Kernel as NumPy: a loop over the shapes is an axis, the last one; tables are matrices.

In pairs of shapes the last two axes are j and i. Scalars get axes of length one by `_last`.
"""

from __future__ import annotations

from derive.backends.expression_text import python_number, text
from derive.ir.expressions import ArrayAccess, MatrixEntry, ScalarRef, walk
from derive.ir.model import Argument
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
    RequireFinite,
    StoreLocal,
    TriangularSolve,
)

Lines = list[str]
Loop = Map | Accumulate | MatVec | MatrixStore | Pack | Clear | RequireFinite | Cholesky | TriangularSolve


class Loops:
    """The loops of one function; `arrays` are those that it knows, with their lengths."""

    def __init__(self, arguments: tuple[Argument, ...]) -> None:
        self.lengths = {view.name: view.size for a in arguments for view in a.arrays}
        self.inside: set[str] = set()

    def lines(self, loop: Loop) -> Lines:
        """One statement with loops."""
        match loop:
            case Map():
                return self._each(loop)
            case Accumulate():
                return self._reduce(loop)
            case MatVec():
                return self._contract(loop)
            case MatrixStore():
                return self._pairs(loop)
            case Pack():
                return _pack(loop)
            case Clear():
                return []
            case RequireFinite():
                return [f'_require(xp.all(xp.isfinite({loop.argument})), "{loop.text}")']
            case Cholesky():
                return _root(loop)
            case TriangularSolve():
                return _substitute(loop)

    def _leaf(self, leaf: ScalarRef | ArrayAccess | MatrixEntry, count: int, depth: int = 1) -> str:
        """A name or an array in a loop of so many steps; in pairs (depth 2), an array of index i has an axis for j."""
        if isinstance(leaf, MatrixEntry):
            return leaf.table
        if isinstance(leaf, ScalarRef):
            if leaf.name in self.inside:
                return leaf.name
            return f"_last({leaf.name})" if depth == 1 else f"_last(_last({leaf.name}))"
        if leaf.stride > 1:
            return f"{leaf.array}[..., {leaf.offset}::{leaf.stride}]"
        known = self.lengths.get(leaf.array, count)
        cut = leaf.array if known == count else f"{leaf.array}[..., :{count}]"
        return cut if depth == 1 else f"{cut}[..., None, :]"

    def _each(self, loop: Map) -> Lines:
        n, lines = loop.count, []
        for item in loop.body:
            value = text(item.expr, python_number, "xp.", name=lambda leaf: self._leaf(leaf, n))
            if isinstance(item, Let):
                self.inside.add(item.name)
                lines.append(f"{item.name} = {value}")
            elif isinstance(item, StoreLocal):
                self.lengths[item.array] = n
                lines.append(f"{item.array} = {value}")
            else:
                lines.append(f"{item.output}[{_slice(item.offset, item.stride, n)}] = {value}")
        return lines

    def _reduce(self, loop: Accumulate) -> Lines:
        n, lines = loop.count, []
        for let in loop.lets:
            self.inside.add(let.name)
            lines.append(f"{let.name} = {text(let.expr, python_number, 'xp.', name=lambda leaf: self._leaf(leaf, n))}")
        for one in loop.sums:
            base = text(one.base, python_number)
            term = text(one.term, python_number, "xp.", name=lambda leaf: self._leaf(leaf, n))
            total = f"xp.sum({term}, axis=-1)"
            lines.append(f"{one.name} = {total}" if base == "0" else f"{one.name} = {base} + {total}")
        return lines

    def _contract(self, loop: MatVec) -> Lines:
        packing = loop.packing
        n, lines = packing.count, []
        for lane in loop.terms:
            terms = [self._leaf(ArrayAccess(lane.base, "i"), n)] if lane.base else []
            for vector, table in lane.sums:
                place = packing.tables.index(table)
                matrix = f"_table({packing.array}, {len(packing.tables)}, {place}, {n})"
                terms.append(f"_product(xp, {vector}, {matrix})")
            lines.append(f"{lane.name} = {' + '.join(terms)}")
            self.lengths[lane.name] = n
        return lines

    def _pairs(self, loop: MatrixStore) -> Lines:
        packing = loop.packing
        n, lines = packing.count, []
        for place, name in enumerate(packing.tables):
            if any(isinstance(e, MatrixEntry) and e.table == name for e in walk(loop.expr)):
                lines.append(f"{name} = _table({packing.array}, {len(packing.tables)}, {place}, {n})")
        block = text(loop.expr, python_number, "xp.", name=lambda leaf: self._leaf(leaf, n, 2))
        lines.append(f"block = {block}")
        lines.append(f"for j in range({n}):")
        lines.append(f"    first = {loop.offset} + {loop.stride} * j")
        lines.append(f"    {loop.output}[..., first : first + {n}] = block[..., j, :]")
        if loop.diagonal is not None:
            diagonal = text(loop.diagonal, python_number, "xp.", name=lambda leaf: self._leaf(leaf, n))
            where = _slice(loop.offset, loop.stride + 1, n)
            lines.append(f"{loop.output}[{where}] = {loop.output}[{where}] + ({diagonal})")
        return lines


def _slice(offset: int, stride: int, count: int) -> str:
    stop = offset + stride * (count - 1) + 1
    return f"..., {offset}:{stop}" + (f":{stride}" if stride > 1 else "")


def _pack(loop: Pack) -> Lines:
    packing = loop.packing
    n = packing.count
    lines = []
    for parity, name in ((1, "even"), (-1, "odd")):
        if any(s.parity == parity for s in loop.sources):
            lines.append(f"{name} = _pairs({n}, {parity})")
    for s in loop.sources:
        given = s.array if s.components == 1 else f"{s.array}[..., {s.component}::{s.components}]"
        index = "even" if s.parity > 0 else "odd"
        place = packing.tables.index(s.table)
        lines.append(f"_pack(xp, {loop.output}, {given}, {index}, {len(packing.tables)}, {place}, {n}, {s.parity})")
    return lines


def _root(loop: Cholesky) -> Lines:
    n = loop.count
    return [
        f"low = _square(xp, {loop.source}, {n})",
        f"for j in range({n}):",
        "    for m in range(j):",
        "        low[..., j, j:] = low[..., j, j:] - low[..., m, j:] * low[..., m, j, None]",
        f'    _require(xp.all(low[..., j, j] > 0), "{loop.text}")',
        "    inverse = 1 / xp.sqrt(low[..., j, j])",
        "    low[..., j, j + 1 :] = low[..., j, j + 1 :] * inverse[..., None]",
        "    low[..., j, j] = inverse",
        "    low[..., j, :j] = 0.0",
        f"{loop.output}[..., {loop.offset}:{loop.offset + n * n}] = xp.reshape(low, (*low.shape[:-2], {n * n}))",
    ]


def _substitute(loop: TriangularSolve) -> Lines:
    call = "_back" if loop.transposed else "_forward"
    return [f"{name} = {call}(xp, {loop.factor}, {name}, {loop.count})" for name in loop.arrays]


HELPERS = f'''

def _last(value):
    """A scalar of each member of the batch with an axis for the shapes."""
    return value if isinstance(value, (int, float)) else value[..., None]


def _table(tables, number, index, count):
    """A packed table as a matrix (..., j, i): panels of {LANES} columns hold the tables one after the other."""
    size = -(-count // {LANES}) * {LANES}
    panels = tables.reshape((*tables.shape[:-1], size // {LANES}, number, {LANES}, size))[..., index, :, :]
    return panels.reshape((*tables.shape[:-1], size, size))[..., :count, :count]


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


def _pack(xp, k, values, pairs, number, index, count, parity):
    """Write one table into the packed ones; columns j, in them rows i."""
    positions, signs = pairs
    if values.shape[-1] == 0:
        return
    matrix = (values[..., positions] * xp.asarray(signs)).reshape((*values.shape[:-1], count, count))
    size = -(-count // {LANES}) * {LANES}
    for j in range(count):
        first = ((j // {LANES} * number + index) * {LANES} + j % {LANES}) * size
        k[..., first : first + count] = matrix[..., :, j]


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
"""What the loops of a module call."""
