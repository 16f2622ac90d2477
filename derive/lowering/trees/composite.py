"""The mass matrix of trees by composite bodies: the momentum of all that a joint moves, along the joints before it.

Momenta and motions refer to one point, the origin of the tree, so that an entry is one scalar product whatever the
distance of its joints is.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from derive.ir.expressions import Element, Expr, Operation, Operator
from derive.ir.indices import ElementIndex, IndexTerm, constant
from derive.ir.patterns import Pattern, pattern
from derive.ir.statements import Entry, ForEach, InstanceItem, Statement, StoreElement
from derive.lowering.instances.loop_code.kernels import Part
from derive.lowering.trees.ball_columns import MOMENTUM, TWIST, by_pairs, unit_motion
from derive.lowering.trees.link_loop import LINK, LinkLoop
from derive.lowering.trees.motion import FRAME, INERTIA, LEVER, MOMENT, ORIGIN, TreeMotion, axis, matrix
from derive.lowering.vectors import applied, cross, dot, packed, plus, scaled, symmetric, transposed

HEAP = "composite"
"""The array of mass, first moment and inertia behind links."""
BEHIND = "behind"
"""The variable of the loop over what hangs on a link."""
FREE = 6
"""The rows of a free body."""


def mass_pattern(motion: TreeMotion, rows: int) -> Pattern:
    """The pattern of M: pairs of rows of which one moves the other."""
    every: set[tuple[int, int]] = set()
    for number, last in enumerate(motion.tree.last):
        moved = [row for other in range(number, last + 1) for row in _rows(motion, other)]
        for own in _rows(motion, number):
            every.update((row, own) if row > own else (own, row) for row in moved)
    firsts = [motion.tree.links[n].row for n in motion.free]
    none = {(first + i, first + j) for first in firsts for i in range(3) for j in range(i)}
    return pattern(rows, rows, every - none, symmetric=True)


def _rows(motion: TreeMotion, number: int) -> range:
    link = motion.tree.links[number]
    return range(link.row, link.row + (FREE if link.is_free else 1))


def composite(motion: TreeMotion, shape: Pattern) -> list[Part]:
    """The sections of the mass matrix after those of the frames and of the inertias."""
    heaps: list[Statement] = [
        *motion.work((HEAP, 10), cleared=True),
        *([_heaps(motion)] if motion.joints else []),
        *([_free_heaps(motion)] if motion.free else []),
    ]
    momenta = [*motion.work((TWIST, 6), (MOMENTUM, 6)), *([_momenta(motion)] if motion.joints else [])]
    entries: list[Statement] = []
    if motion.free:
        entries.append(_own_block(motion, shape))
    if motion.balls:
        entries += by_pairs(motion, shape)
    else:
        entries += [_columns(motion, shape, motion.joints, 1)] if motion.joints else []
        entries += [_columns(motion, shape, motion.free, FREE)] if motion.free else []
    return [
        ("composite", "(15)", "mass, first moment and inertia of each link with all that hangs on it", heaps),
        (
            "momenta",
            "(15)",
            "unit motions of the joints, and the momenta by them, about the origin of the tree",
            momenta,
        ),
        ("M", "(15)", "the momentum of all behind a joint along each joint before it", entries),
    ]


def _whole(motion: TreeMotion, loop: LinkLoop) -> tuple[ca.SX, list[ca.SX], list[ca.SX]]:
    """Mass, first moment and inertia of each link with what hangs on it."""
    here = loop.of_links()
    mass, *behind = loop.vector(HEAP, here, 10)
    own = [*loop.vector(MOMENT, here), *loop.vector(INERTIA, here, 6)]
    total = plus(behind, own)
    return mass + loop.number(lambda of: of.inertia.mass), total[:3], total[3:]


def _heaps(motion: TreeMotion) -> ForEach:
    loop = motion.loop("composite", motion.joints)
    here, before = loop.of_links(), loop.of_parents()
    mass, s, tensor = _whole(motion, loop)
    loop.store_vector(HEAP, here, [mass, *s, *tensor])
    r, follows = loop.vector(LEVER, here), loop.number(lambda of: of.follows)
    s, tensor = scaled(follows, s), scaled(follows, tensor)
    moved = plus(s, scaled(mass, r))
    g = plus(s, moved)
    trace = dot(r, g)
    change = [[(trace if i == j else 0 * mass) - (r[i] * g[j] + r[j] * g[i]) / 2 for j in range(3)] for i in range(3)]
    loop.store_vector(HEAP, before, [mass, *moved, *plus(tensor, packed(change))], operator=Operator.ADD)
    return loop.made(backward=True)


def _free_heaps(motion: TreeMotion) -> ForEach:
    loop = motion.loop("free_composite", motion.free)
    mass, s, tensor = _whole(motion, loop)
    loop.store_vector(HEAP, loop.of_links(), [mass, *s, *tensor])
    return loop.made()


def _momenta(motion: TreeMotion) -> ForEach:
    loop = motion.loop("momenta", motion.joints)
    here = loop.of_links()
    mass, *rest = loop.vector(HEAP, here, 10)
    s, tensor, e, x = rest[:3], symmetric(rest[3:]), axis(loop, here), loop.vector(ORIGIN, here)
    turns, advances = loop.number(lambda of: of.turns), loop.number(lambda of: of.advances)
    T, w = scaled(advances, e), scaled(turns, e)
    linear = plus(scaled(mass, T), cross(w, s))
    angular = plus(cross(s, T), applied(tensor, w), cross(x, linear))
    loop.store_vector(TWIST, here, unit_motion(loop))
    loop.store_vector(MOMENTUM, here, [*linear, *angular])
    return loop.made(independent=True)


def _own_block(motion: TreeMotion, shape: Pattern) -> ForEach:
    """The block of the rows of free bodies."""
    loop = motion.loop("free_blocks", motion.free)
    here = loop.of_links()
    mass, *rest = loop.vector(HEAP, here, 10)
    s, tensor, Q = rest[:3], symmetric(rest[3:]), matrix(loop.vector(FRAME, here, 9))
    axes = transposed(Q)
    turned = [applied(tensor, axis_of) for axis_of in axes]
    by_row = [[mass if k == i else 0 * mass for i in range(3)] for k in range(3)]
    linear = [*by_row, *(cross(axis_of, s) for axis_of in axes)]
    number = {entry: k for k, entry in enumerate(shape.entries)}
    links = [motion.tree.links[n].row for n in loop.links]
    for i in range(FREE):
        for j in range(i + 1):
            value = linear[i][j] if j < 3 else dot(axes[j - 3], turned[i - 3])
            if (links[0] + i, links[0] + j) in number:
                place = loop.place(f"entry_{i}_{j}", [number[row + i, row + j] for row in links])
                loop.store("M", place.at(0), value)
    return loop.made()


def _columns(motion: TreeMotion, shape: Pattern, links: Sequence[int], count: int) -> ForEach:
    """The loop over columns of M: rows of links, each with the rows of all that hangs on the link."""
    loop = motion.loop("columns" if count == 1 else "free_columns", links)
    own = 0 if count == 1 else 1
    start = loop.place("start", [n + own for n in links]).first
    stop = loop.place("stop", [motion.tree.last[n] + 1 for n in links]).first
    here = loop.of_links()
    number = {entry: k for k, entry in enumerate(shape.entries)}
    spacing, slot = motion.arrays.spacing, motion.arrays.slot(0)

    def momentum(k: int) -> Expr:
        return Element(MOMENTUM, ElementIndex(k * spacing + slot, (IndexTerm(1, BEHIND),)))

    moved = [
        (motion.tree.links[n].row, [of.row for of in motion.tree.links[n + own : motion.tree.last[n] + 1]])
        for n in links
    ]
    inner: list[InstanceItem] = []
    for k in range(count):
        positions = [[number[max(i, row + k), min(i, row + k)] for i in behind] for row, behind in moved]
        index, entry = _entries(loop, f"entries_{k}", positions, [n + own for n in links])
        if count == 1:
            value = _sum([_times(Element(TWIST, here.at(c)), momentum(c)) for c in range(6)])
        elif k < 3:
            value = momentum(k)
        else:
            value = _sum([_times(Element(FRAME, here.at(3 * c + k - 3)), momentum(3 + c)) for c in range(3)])
        inner += [*entry, StoreElement(Element("M", index), value)]
    loops = ForEach(BEHIND, start, stop, tuple(inner))
    return ForEach(LINK, constant(0), constant(len(links)), (*loop.entries, loops))


def _entries(
    loop: LinkLoop, name: str, positions: Sequence[Sequence[int]], firsts: Sequence[int]
) -> tuple[ElementIndex, list[Entry]]:
    """The index of the entries of columns of M, by the variable of what hangs on a link.

    They follow each other if rows are in the order of links; a table has the places of all of them otherwise.
    """
    if all(list(of) == list(range(of[0], of[0] + len(of))) for of in positions if of):
        place = loop.place(name, [of[0] - first if of else 0 for of, first in zip(positions, firsts, strict=True)])
        return ElementIndex(place.first.offset, (*place.first.terms, IndexTerm(1, BEHIND))), []
    begins, every = list[int](), list[int]()
    for of, first in zip(positions, firsts, strict=True):
        begins.append(len(every) - first)
        every += of
    table = loop.arrays.places.integers(f"of_{name}_{loop.name}_places", every)
    begin = loop.place(name, begins).first
    entry = Entry(f"{name}_place", table, ElementIndex(begin.offset, (*begin.terms, IndexTerm(1, BEHIND))))
    return ElementIndex(0, (IndexTerm(1, entry.name),)), [entry]


def _times(a: Expr, b: Expr) -> Expr:
    return Operation(Operator.MUL, (a, b))


def _sum(terms: Sequence[Expr]) -> Expr:
    total = terms[0]
    for term in terms[1:]:
        total = Operation(Operator.ADD, (total, term))
    return total
