"""Numbers of instances in tiles: those of the four instances of a vector beside each other, one vector after the other.

Arrays hold one number of all instances after the other. A block of four then reads vectors that lie as far apart as
there are instances, of which each touches one or two lines of the cache and uses a part of them. Where a body has many
numbers, those of a block are a tile here, which is read from its beginning to its end. The last block may overlap the
one before, and has a tile of its own.

Local arrays of what a body keeps from one loop for another are in tiles too, if all loops have the same blocks.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping
from dataclasses import replace
from fractions import Fraction
from types import MappingProxyType

from derive.ir.analysis import accessed_by
from derive.ir.expressions import Element, Ends, Expr, Leaf
from derive.ir.indices import LANE, LANES, ElementIndex, IndexTerm, Of
from derive.ir.kernel import ConstantArray
from derive.ir.loop_nests import Alias, For, Local, LoopKind, Node, every, rewritten

FEWEST_COLUMNS = 64
"""The numbers of an instance from which on they lie in tiles: fewer ones fit into the nearest cache in any order."""
NO_TABLES: Mapping[str, ConstantArray] = MappingProxyType({})


def numbers_of_instances(arrays: Iterable[ConstantArray]) -> dict[str, ConstantArray]:
    """The constant arrays that lie in tiles, by their names."""
    return {
        array.name: array
        for array in arrays
        if array.instances > 1 and len(array.values) >= FEWEST_COLUMNS * array.instances
    }


def tiled_name(name: str) -> str:
    """The name of the array of the tiles of a constant array."""
    return f"{name}_in_tiles"


def tiles_read(tables: Iterable[str]) -> set[str]:
    """The names of the tiles, in which lanes that are left have numbers too."""
    return {_tile(name) for name in tables}


def tiled(array: ConstantArray) -> ConstantArray:
    """The tiles of a constant array; lanes that are left have the numbers of the last instance."""
    count, last = array.instances, array.instances - 1
    firsts = [min(first, max(count - LANES, 0)) for first in range(0, count, LANES)]
    columns = range(0, len(array.values), count)
    places = (column + min(first + lane, last) for first in firsts for column in columns for lane in range(LANES))
    values = tuple(Fraction(array.values[k]) for k in places)
    return replace(array, name=tiled_name(array.name), values=values, instances=0)


def kept_in_tiles(nodes: Iterable[Node], others: Container[str]) -> dict[str, Local]:
    """The local arrays, besides others, of which all loops access the numbers of an instance in the same blocks."""
    nodes = tuple(nodes)
    arrays = {
        node.array: node
        for node in every(nodes)
        if isinstance(node, Local) and node.spacing > LANES and not node.cleared and node.array not in others
    }
    stops: dict[str, set[int | None]] = {}
    for node in nodes:
        inside = {id(part) for loop in _lanes_of(node) for part in every([loop])}
        for part in every([node]):
            for element in accessed_by(part):
                if element.array in arrays:
                    stop = _stop(element, node, arrays[element.array].spacing) if id(part) in inside else None
                    stops.setdefault(element.array, set()).add(stop)
    return {name: arrays[name] for name, of in stops.items() if len(of) == 1 and None not in of}


def with_kept_in_tiles(node: Node, arrays: Mapping[str, Local]) -> Node:
    """A plain statement with the elements of local arrays in tiles."""
    if not arrays or not isinstance(node, For):
        return node

    def leaf(item: Leaf) -> Expr:
        if not isinstance(item, Element) or item.array not in arrays:
            return item
        array = arrays[item.array]
        index = _index(item.index, node.variable, array.spacing) if item.index else None
        assert index
        tile = IndexTerm(array.size // array.spacing * LANES, node.variable, Of.CEILING)
        return replace(item, index=replace(index, terms=(tile, *index.terms)))

    return rewritten(node, leaf)


def _lanes_of(node: Node) -> list[For]:
    """The loops over lanes of a loop over blocks of instances that begin with the first one."""
    if not isinstance(node, For) or not node.overlaps or node.start.offset or node.start.terms:
        return []
    return [part for part in node.body if isinstance(part, For) and part.kind in (LoopKind.LANES, LoopKind.FEW)]


def _stop(element: Element | Ends, node: Node, spacing: int) -> int | None:
    """Where the blocks of a loop end, if an element in it is a number of the instance that a lane has."""
    if not isinstance(node, For) or not isinstance(element, Element) or not element.index:
        return None
    return node.stop.offset if _index(element.index, node.variable, spacing) else None


def in_tiles(node: Node, tables: Mapping[str, ConstantArray]) -> Node:
    """A loop over blocks of instances that reads numbers from tiles; other statements stay as they are."""
    if not tables or not isinstance(node, For):
        return node
    lanes = _lanes_of(node)
    read: dict[str, None] = {}

    def leaf(item: Leaf) -> Expr:
        if isinstance(item, Element) and item.index and item.array in tables:
            index = _index(item.index, node.variable, tables[item.array].instances)
            if index is not None:
                read.setdefault(item.array)
                return replace(item, array=_tile(item.array), index=index)
        return item

    body = tuple(rewritten(part, leaf) if part in lanes else part for part in node.body)
    views: list[Node] = []
    for name in read:
        size = len(tables[name].values) // tables[name].instances * LANES
        first = ElementIndex(0, (IndexTerm(size, node.variable, Of.CEILING),))
        views.append(Alias(_tile(name), tiled_name(name), first))
    return replace(node, body=(*views, *body))


def _tile(name: str) -> str:
    """The name of the tile of a block of instances."""
    return f"{name}_tile"


def _index(index: ElementIndex, block: str, spacing: int) -> ElementIndex | None:
    """The index in its tile of an element that the lanes of a block read beside each other; None for other ones.

    spacing: the distance of the numbers of an instance.
    """
    others = [term for term in index.terms if term.variable not in (block, LANE)]
    own = {(term.variable, term.stride, term.of) for term in index.terms if term not in others}
    if own != {(block, 1, Of.VALUE), (LANE, 1, Of.VALUE)}:
        return None
    if index.offset % spacing or any(term.stride % spacing or term.of is not Of.VALUE for term in others):
        return None
    terms = [replace(term, stride=term.stride // spacing * LANES) for term in others]
    return ElementIndex(index.offset // spacing * LANES, (*terms, IndexTerm(1, LANE)))
