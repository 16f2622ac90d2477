"""Local arrays of a loop over the lanes of vectors that are not needed at the same time share memory.

A body with many modes has sums, what markers owe to them, and rows of its joints in arrays, of which each is read soon
after it was filled. One behind the other, they displace each other and the tables from the nearest cache.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from derive.ir.analysis import accessed_by
from derive.ir.expressions import Element, Expr, Leaf
from derive.ir.loop_nests import For, Local, Node, every, rewritten

NAME = "in_lanes"
"""The first part of the name of the array that others share; loops that share as much memory share it too."""


def overlaid(arrays: Sequence[Local], body: Sequence[Node]) -> tuple[tuple[Local, ...], tuple[Node, ...]]:
    """The arrays of a loop over blocks and its body, with one array in place of those that can share memory.

    arrays: local arrays without values from before the body.
    """
    lives = _lives({array.array for array in arrays}, body)
    places = _places([array for array in arrays if array.array in lives], lives)
    size = max((places[array.array] + array.size for array in arrays if array.array in places), default=0)
    if size >= sum(array.size for array in arrays):
        return tuple(arrays), tuple(body)
    name = f"{NAME}_{size}"

    def leaf(item: Leaf) -> Expr:
        if not isinstance(item, Element) or item.array not in places:
            return item
        assert item.index
        return replace(item, array=name, index=item.index.plus(places[item.array]))

    return (Local(name, size, in_lanes=True),), tuple(rewritten(node, leaf) for node in body)


def _lives(arrays: set[str], body: Iterable[Node]) -> dict[str, tuple[int, int]]:
    """The numbers of the first and the last statement that access each array, with those of loops over lanes apart."""
    statements = [part for node in body for part in (node.body if isinstance(node, For) else (node,))]
    result: dict[str, tuple[int, int]] = {}
    for number, statement in enumerate(statements):
        accessed = (element for node in every([statement]) for element in accessed_by(node))
        for array in {element.array for element in accessed} & arrays:
            result[array] = result.get(array, (number,))[0], number
    return result


def _places(arrays: Iterable[Local], lives: dict[str, tuple[int, int]]) -> dict[str, int]:
    """The first element of each array in the common one: the largest arrays come first, each as far down as it can."""
    placed: dict[str, tuple[int, int]] = {}
    for array in sorted(arrays, key=lambda local: -local.size):
        first, last = lives[array.array]
        others = sorted(span for other, span in placed.items() if lives[other][0] <= last and first <= lives[other][1])
        place = 0
        for start, stop in others:
            if start - place >= array.size:
                break
            place = max(place, stop)
        placed[array.array] = place, place + array.size
    return {array: start for array, (start, _) in placed.items()}
