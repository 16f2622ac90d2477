"""The centre of mass of trees, and their momentum about it as a function of the velocities.

A column of the matrices is the momentum of all behind a joint by its unit rate, that of composite bodies. In trees with
balls, what hangs on one has the momentum of a body that does not turn, so that each link is added by itself.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

import casadi as ca

from derive.ir.expressions import Operator
from derive.ir.indices import constant
from derive.ir.patterns import Pattern, pattern
from derive.ir.statements import Clear, ForEach, Statement, Work
from derive.lowering.trees.ball_columns import MOMENTUM, TWIST, LinkPair, pairs_of
from derive.lowering.trees.composite import HEAP
from derive.lowering.trees.exact_numbers import Exact
from derive.lowering.trees.invariants import of_links
from derive.lowering.trees.link_loop import LinkLoop
from derive.lowering.trees.motion import FRAME, INERTIA, MOMENT, ORIGIN, TreeMotion, matrix
from derive.lowering.vectors import Vector, applied, cross, minus, plus, scaled, symmetric, transposed

SUMS = "sums"
"""The local array of the linear momentum, the angular momentum about the inertial origin, and the first moment."""


def total_mass(motion: TreeMotion) -> Exact:
    """The mass of all links."""
    return sum((link.inertia.mass for link in motion.tree.links), Fraction(0))


def shape_of(motion: TreeMotion, vectors: int, rows: int) -> Pattern:
    """The pattern of the derivatives of vectors, a linear momentum first: those of free bodies move along one axis."""
    none = {(k, motion.tree.links[n].row + i) for n in motion.free for k in range(3) for i in range(3) if i != k}
    return pattern(3 * vectors, rows, {(i, j) for i in range(3 * vectors) for j in range(rows)} - none)


def sums(motion: TreeMotion) -> list[Statement]:
    """The statements of SUMS."""
    loop = motion.loop("sums", motion.massive)
    mass, s, x, v, w, L = of_links(loop)
    linear = plus(scaled(mass, v), cross(w, s))
    angular = plus(cross(x, linear), cross(s, v), L)
    for k, value in enumerate([*linear, *angular, *plus(scaled(mass, x), s)]):
        loop.store(SUMS, constant(k), value, Operator.ADD)
    return [Work(SUMS, 9, cleared=True), loop.made()]


def centre(motion: TreeMotion) -> list[Statement]:
    """The statements of the centre of mass, its velocity, and the mass."""
    loop = LinkLoop(motion.arrays, "centre", [0])
    mass = total_mass(motion)
    for k in range(3):
        for output, first in (("x", 6), ("xdot", 0)):
            value = loop.element(SUMS, constant(first + k)) * loop.value(1 / mass)
            loop.store(output, constant(k), value)
    loop.store("m_total", constant(0), loop.value(mass))
    return [loop.made()]


def about_centre(motion: TreeMotion) -> list[Statement]:
    """The statements of the momentum."""
    loop = LinkLoop(motion.arrays, "about_centre", [0])
    linear, angular = ([loop.element(SUMS, constant(first + k)) for k in range(3)] for first in (0, 3))
    for k, value in enumerate([*linear, *_moved(motion, loop, linear, angular)]):
        loop.store("momentum", constant(k), value)
    return [loop.made()]


def _moved(motion: TreeMotion, loop: LinkLoop, linear: Vector, angular: Vector) -> Vector:
    """An angular momentum about the centre of mass."""
    first = [loop.element(SUMS, constant(6 + k)) for k in range(3)]
    return minus(angular, cross(scaled(loop.value(1 / total_mass(motion)), first), linear))


def columns(motion: TreeMotion, output: str, shape: Pattern) -> Iterator[Statement]:
    """Yield the statements of the matrix of the velocity of the centre of mass, or of six components of momentum."""
    number = {entry: k for k, entry in enumerate(shape.entries)}
    is_momentum = max(i for i, _ in number) > 2
    factor = Fraction(1) if is_momentum else 1 / total_mass(motion)
    if is_momentum and motion.balls:
        yield Clear(output, len(number))
        yield from _link_by_link(motion, output, number)
        return
    if motion.joints:
        loop = motion.loop(f"columns_of_{output}", motion.joints)
        here = loop.of_links()
        linear, angular = loop.vector(MOMENTUM, here), loop.vector(MOMENTUM, here, first=3)
        if is_momentum:
            _store(motion, loop, output, number, 0, [*linear, *_moved(motion, loop, linear, angular)])
        else:
            _store(motion, loop, output, number, 0, scaled(loop.value(factor), linear))
        yield loop.made()
    if motion.free:
        loop = motion.loop(f"free_columns_of_{output}", motion.free)
        here = loop.of_links()
        mass, *rest = loop.vector(HEAP, here, 10)
        s, tensor, x = rest[:3], symmetric(rest[3:]), loop.vector(ORIGIN, here)
        axes = transposed(matrix(loop.vector(FRAME, here, 9)))
        for k in range(6):
            unit = [ca.SX(int(i == k % 3)) for i in range(3)]
            linear = scaled(mass, unit) if k < 3 else cross(axes[k - 3], s)
            angular = cross(s, unit) if k < 3 else applied(tensor, axes[k - 3])
            values = scaled(loop.value(factor), linear)
            if is_momentum:
                values = [*linear, *_moved(motion, loop, linear, plus(angular, cross(x, linear)))]
            _store(motion, loop, output, number, k, values)
        yield loop.made()


def _store(
    motion: TreeMotion,
    loop: LinkLoop,
    output: str,
    number: dict[tuple[int, int], int],
    k: int,
    values: Sequence[ca.SX],
    links: Sequence[int] = (),
) -> None:
    """Write, or add for some `links`, a column of the k-th row of each link; what has no entry is zero."""
    rows = [motion.tree.links[n].row + k for n in links or loop.links]
    for i, value in enumerate(values):
        if (i, rows[0]) in number:
            place = loop.place(f"entry_{i}_{k}", [number[i, row] for row in rows])
            loop.store(output, place.at(0), value, Operator.ADD if links else None)


def _link_by_link(motion: TreeMotion, output: str, number: dict[tuple[int, int], int]) -> Iterator[ForEach]:
    """Yield the loops over pairs of links that add the momentum of each link by the rows that move it."""
    every = [pair for n in range(len(motion.tree.links)) for pair in pairs_of(motion.tree, n)]
    for is_free in (False, True):
        for across in (False, True):
            some = [p for p in every if motion.tree.links[p.link].is_free == is_free and (p.ball is not None) == across]
            if some:
                yield _of_pairs(motion, output, number, some, is_free, across)


def _of_pairs(
    motion: TreeMotion,
    output: str,
    number: dict[tuple[int, int], int],
    pairs: Sequence[LinkPair],
    is_free: bool,
    across: bool,
) -> ForEach:
    name = f"{'free_' * is_free}pairs_of_{output}{'_across' * across}"
    loop = LinkLoop(motion.arrays, name, [of.moved for of in pairs])
    mass, here = loop.number(lambda of: of.inertia.mass), loop.of_links()
    s, x = loop.vector(MOMENT, here), loop.vector(ORIGIN, here)
    tensor = symmetric(loop.vector(INERTIA, here, 6))
    own = loop.place("link", [motion.arrays.slot(of.link) for of in pairs], motion.arrays.spacing)
    if is_free:
        axes, at = transposed(matrix(loop.vector(FRAME, own, 9))), loop.vector(ORIGIN, own)
        units = [[ca.SX(int(i == k)) for i in range(3)] for k in range(3)]
        twists = [*((unit, [ca.SX(0)] * 3) for unit in units), *((cross(at, e), e) for e in axes)]
    else:
        twist = loop.vector(TWIST, own, 6)
        twists = [(twist[:3], twist[3:])]
    for k, (origin, w) in enumerate(twists):
        if across:
            balls = [motion.arrays.slot(of.ball) for of in pairs if of.ball is not None]
            v = plus(origin, cross(w, loop.vector(ORIGIN, loop.place("ball", balls, motion.arrays.spacing))))
            linear = scaled(mass, v)
            angular = cross(plus(scaled(mass, x), s), v)
        else:
            v = plus(origin, cross(w, x))
            linear = plus(scaled(mass, v), cross(w, s))
            angular = plus(cross(x, linear), cross(s, v), applied(tensor, w))
        values = [*linear, *_moved(motion, loop, linear, angular)]
        _store(motion, loop, output, number, k, values, [of.link for of in pairs])
    return loop.made()
