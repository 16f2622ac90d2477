"""Independent loops in the lanes of vectors: sums in four lanes, and rows in blocks of four that are computed together.

The loop over the lanes is outside of that over the modes: a sum stays in a vector register until it is complete. The
order of additions is that of the loops before.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

from derive.ir.analysis import needed
from derive.ir.expansion import MAX_SUMS, ZERO, expand
from derive.ir.expressions import VECTOR_OPERATORS, Element, Expr, Operation, Operator, ScalarRef, TableValue, walk
from derive.ir.indices import LANE, LANES, constant, padded
from derive.ir.instance_lanes import instances_in_lanes
from derive.ir.late_loads import with_late_loads
from derive.ir.loop_nests import (
    START,
    Accumulator,
    Alias,
    Assign,
    For,
    If,
    Local,
    LoopKind,
    Node,
    PartOf,
    every,
    expressions_of,
    reindexed,
)
from derive.ir.parallel_sums import with_parallel_sums
from derive.ir.sines_of_bodies import with_sines_of_bodies
from derive.ir.statements import Statement


def section_in_lanes(body: Sequence[Statement]) -> Iterator[tuple[int, tuple[Node, ...]]]:
    """The statements of a section as plain statements with loops in lanes, by the number of the statement.

    Matrices that are stored directly behind products with matrices of the same array are stored within these, block by
    block, since a block stays in the nearest memory. Of the products they read the same row only.
    """
    plain = with_sines_of_bodies([expand(statement) for statement in body])
    nodes = list(map(in_lanes, plain))
    products: int | None = None
    for n, loops in enumerate(plain):
        if any(isinstance(node, For) and node.padded for node in loops):
            products = n
        elif products is not None and _matrices(loops) and _matrices(loops) == _matrices(plain[products]):
            nodes[products], nodes[n] = _fused(nodes[products], n, nodes[n])
        else:
            products = None
    return enumerate(nodes)


def _matrices(nodes: Iterable[Node]) -> set[str]:
    """The arrays in which the matrices lie that plain statements read."""
    return {node.array for node in every(nodes) if isinstance(node, Alias)}


def in_lanes(nodes: Iterable[Node]) -> tuple[Node, ...]:
    """Plain statements with those independent loops in lanes whose operations vectors have."""
    result: list[Node] = []
    for node in nodes:
        if isinstance(node, For) and node.overlaps:
            result += instances_in_lanes(node)
        elif isinstance(node, For) and node.kind is LoopKind.INDEPENDENT and _fits_vectors(node):
            if _adds(node):
                lanes = next(item for item in reversed(result) if isinstance(item, Local) and item.totals)
                result[result.index(lanes)] = replace(lanes, cleared=False)
                result += _sums(node, lanes.totals)
            else:
                result += _rows(node)
        elif isinstance(node, For) and node.kind is LoopKind.ORDERED:
            result.append(replace(node, body=with_parallel_sums(with_late_loads(node.body))))
        else:
            result.append(node)
    return tuple(result)


def _fits_vectors(loop: For) -> bool:
    """Whether vectors have all operations of a loop, and its arrays are read element after element."""
    parts = (part for node in every(loop.body) for expr in expressions_of(node) for part in walk(expr))
    enough = (loop.count or 0) >= (1 if _has_views(loop) else LANES)
    return enough and all(_is_vector(part, loop.variable) for part in parts)


def _has_views(loop: For) -> bool:
    """Whether a loop reads matrices, which lie in blocks of four rows also where there are fewer."""
    return bool(_matrices(loop.body))


def _is_vector(part: Expr, index: str) -> bool:
    match part:
        case Operation():
            return part.kind in VECTOR_OPERATORS
        case Element():
            return part.index is not None and part.index.stride(index) in (0, 1)
        case _:
            return not isinstance(part, TableValue)


def _adds(loop: For) -> bool:
    """Whether a loop adds to the lanes of sums."""
    return any(isinstance(node, Assign) and node.operator is Operator.ADD for node in loop.body)


def _over_lanes(body: Iterable[Node], lanes: int = LANES) -> For:
    return For(LANE, START, constant(lanes), tuple(body), LoopKind.LANES)


def _blocks(loop: For, start: int, stop: int, body: Iterable[Node]) -> For:
    return For(loop.variable, constant(start), constant(stop), tuple(body), step=LANES)


def _split(loop: For, nodes: Iterable[Node]) -> tuple[Node, ...]:
    """Nodes with the variable of a loop replaced by the sum of a multiple of four and a lane."""
    return tuple(reindexed(node, lambda index: index.split(loop.variable, LANE)) for node in nodes)


def _sums(loop: For, totals: tuple[str, ...]) -> list[Node]:
    """Some sums at a time in four lanes, over as many modes as fill all lanes; then the modes that are left."""
    count = loop.stop.offset
    whole = count // LANES * LANES
    terms = [node for node in loop.body if isinstance(node, Assign)]
    result: list[Node] = []
    for first in range(0, len(terms), MAX_SUMS):
        together = terms[first : first + MAX_SUMS]
        accumulators = [Accumulator(total, ZERO) for total in totals[first : first + MAX_SUMS]]
        adds = [replace(term, target=ScalarRef(v.name)) for term, v in zip(together, accumulators, strict=True)]
        inner = _split(loop, (*needed(loop.body, adds), *adds))
        whole_sums = [replace(t, expr=ScalarRef(v.name)) for t, v in zip(together, accumulators, strict=True)]
        stores = [replace(node, operator=None) for node in _split(loop, whole_sums) if isinstance(node, Assign)]
        result.append(_over_lanes([*accumulators, _blocks(loop, 0, whole, inner), *stores]))
    left = [replace(loop, start=constant(whole), kind=LoopKind.ORDERED)] if count > whole else []
    return [*result, *left]


def _rows(loop: For) -> list[Node]:
    """Rows in blocks of four; then the rows that are left, in a block as well if they read one."""
    count = loop.stop.offset
    if loop.padded:
        return [_blocks(loop, 0, padded(count), _block(loop, min(LANES, count)))]
    whole = count // LANES * LANES
    result: list[Node] = [_blocks(loop, 0, whole, _block(loop, LANES))] if whole else []
    if count > whole:
        result.append(_left(loop, whole))
    return result


def _block(loop: For, lanes: int) -> Iterator[Node]:
    """The body of a loop over blocks: what all lanes share, then loops over the lanes, as far inside as possible."""
    match loop.body:
        case (For() as columns,):
            body = tuple(_block(replace(loop, body=columns.body), lanes))
            yield replace(columns, body=body, kind=LoopKind.ORDERED)
        case _:
            yield from _split(loop, (node for node in loop.body if isinstance(node, Alias)))
            for group in _groups([node for node in loop.body if not isinstance(node, Alias)]):
                yield _over_lanes(_split(loop, group), lanes)


def _groups(nodes: list[Node]) -> Iterator[list[Node]]:
    """Parts of a body that share no accumulators: a new one begins where accumulators follow something else."""
    begins = [isinstance(node, Accumulator) for node in nodes]
    starts = [n for n, (before, now) in enumerate(pairwise(begins), 1) if now and not before]
    for start, stop in pairwise((0, *starts, len(nodes))):
        yield nodes[start:stop]


def _left(loop: For, whole: int) -> For:
    """The rows from `whole` on, which fill no block."""
    rest = loop.stop.offset - whole
    if not _has_views(loop):
        return replace(loop, start=constant(whole), kind=LoopKind.ORDERED)
    return _blocks(loop, whole, whole + rest, map(_ordered_lanes, _block(loop, rest)))


def _ordered_lanes(node: Node) -> Node:
    """A loop over lanes as an ordinary one."""
    if not isinstance(node, For):
        return node
    if node.kind is LoopKind.LANES:
        return replace(node, kind=LoopKind.ORDERED)
    return replace(node, body=tuple(map(_ordered_lanes, node.body)))


def _fused(
    products: tuple[Node, ...], number: int, stores: tuple[Node, ...]
) -> tuple[tuple[Node, ...], tuple[Node, ...]]:
    """Products with the blocks of stores within their own, and the stores without their blocks.

    number: that of the statement to which the stores belong. Rows that fill no block are stored by the second part.
    """
    *before, loop = products
    assert isinstance(loop, For)
    blocks = [node for node in stores if isinstance(node, For) and node.step == LANES]
    if not blocks:
        return products, stores
    bodies = tuple(block.body for block in blocks)
    inside = (If(loop.variable, blocks[0].stop.offset, *bodies),) if len(bodies) == 2 else bodies[0]
    fused = replace(loop, body=(*loop.body, PartOf(number, inside)))
    return (*before, fused), tuple(node for node in stores if node not in blocks)
