"""The mass matrix of trees with balls: a scalar product for each pair of links of which one moves the other.

What hangs on a ball does not turn with the links before this: they give all of it the velocity of the ball. The moment
of its momentum that they feel is that of the momentum at the ball next to them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from derive.ir.patterns import Pattern
from derive.ir.statements import ForEach
from derive.lowering.trees.link_loop import LinkLoop
from derive.lowering.trees.links import Tree
from derive.lowering.trees.motion import FRAME, ORIGIN, TreeMotion, matrix
from derive.lowering.vectors import Vector, applied, cross, dot, plus, scaled, transposed

TWIST, MOMENTUM = "twist", "momentum_of"
"""The arrays of unit motions of rows, and of the momenta by them."""


@dataclass(frozen=True)
class LinkPair:
    """A link that moves another one, and the ball between them that is next to it, if there is one."""

    link: int
    moved: int
    ball: int | None


def pairs_of(tree: Tree, link: int) -> Iterator[LinkPair]:
    """Yield the pairs of a link with itself and all that hang on it."""
    balls: dict[int, int | None] = {link: None}
    for moved in range(link, tree.last[link] + 1):
        of = tree.links[moved]
        if moved > link:
            before = balls[of.parent]
            balls[moved] = moved if before is None and not of.follows else before
        yield LinkPair(link, moved, balls[moved])


def by_pairs(motion: TreeMotion, shape: Pattern) -> Iterator[ForEach]:
    """Yield the loops over the pairs of links, those of free bodies last."""
    number = {entry: k for k, entry in enumerate(shape.entries)}
    every = [pair for link in motion.joints for pair in pairs_of(motion.tree, link)]
    for name, pairs in _by_ball("pairs", every):
        loop, linear, angular = _momentum(motion, name, pairs)
        here = loop.place("link", [motion.arrays.slot(of.link) for of in pairs], motion.arrays.spacing)
        twist = loop.vector(TWIST, here, 6)
        _store(motion, loop, number, pairs, 0, dot(twist, [*linear, *angular]))
        yield loop.made()
    every = [pair for link in motion.free for pair in pairs_of(motion.tree, link) if pair.moved != link]
    for name, pairs in _by_ball("free_pairs", every):
        loop, linear, angular = _momentum(motion, name, pairs)
        here = loop.place("link", [motion.arrays.slot(of.link) for of in pairs], motion.arrays.spacing)
        Q = matrix(loop.vector(FRAME, here, 9))
        for k, value in enumerate([*linear, *applied(transposed(Q), angular)]):
            _store(motion, loop, number, pairs, k, value)
        yield loop.made()


def unit_motion(loop: LinkLoop) -> Vector:
    """The velocity of the origin of all positions, as of a point of each link, by its unit rate, and its rotation."""
    here = loop.of_links()
    e, x = [loop.element(FRAME, here.at(3 * i + 2)) for i in range(3)], loop.vector(ORIGIN, here)
    turns, advances = loop.number(lambda of: of.turns), loop.number(lambda of: of.advances)
    w = scaled(turns, e)
    return [*plus(scaled(advances, e), cross(x, w)), *w]


def _by_ball(name: str, pairs: Sequence[LinkPair]) -> Iterator[tuple[str, list[LinkPair]]]:
    for across in (False, True):
        if some := [of for of in pairs if (of.ball is not None) == across]:
            yield f"{name}_across" if across else name, some


def _momentum(motion: TreeMotion, name: str, pairs: Sequence[LinkPair]) -> tuple[LinkLoop, Vector, Vector]:
    loop = LinkLoop(motion.arrays, name, range(len(pairs)))
    moved = loop.place("moved", [motion.arrays.slot(of.moved) for of in pairs], motion.arrays.spacing)
    linear = loop.vector(MOMENTUM, moved)
    if pairs[0].ball is None:
        return loop, linear, loop.vector(MOMENTUM, moved, first=3)
    balls = [motion.arrays.slot(of.ball) for of in pairs if of.ball is not None]
    at = loop.vector(ORIGIN, loop.place("ball", balls, motion.arrays.spacing))
    return loop, linear, cross(at, linear)


def _store(
    motion: TreeMotion,
    loop: LinkLoop,
    number: Mapping[tuple[int, int], int],
    pairs: Sequence[LinkPair],
    k: int,
    value: ca.SX,
) -> None:
    rows = [(motion.tree.links[of.moved].row, motion.tree.links[of.link].row + k) for of in pairs]
    places = [number[max(of), min(of)] for of in rows]
    loop.store("M", loop.place(f"entry_{k}", places).at(0), value)
