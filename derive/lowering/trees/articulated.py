"""Accelerations of trees by articulated bodies, backward from the leaves and then forward.

A link with all that hangs on it needs the force f = M a + H alpha + p and the torque n = H^T a + J alpha + g about its
origin for the acceleration a of this and the angular acceleration alpha. Its own joint removes its share: with
S = (T, e),
U = (M T + H e, H^T T + J e) and D = S . U

    (M, H, J) - U U^T / D   and   (p, g) + (...) (c, gamma) + U (tau - S . (p, g)) / D

is what the link before it has to carry, moved there by the lever. Gravity is an acceleration of the ground, upward.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from derive.ir.expressions import Expr, Operator
from derive.ir.statements import ForEach, Requirement, ReturnCode, Statement
from derive.lowering.instances.loop_code.kernels import ZERO, Part
from derive.lowering.instances.places import Place
from derive.lowering.trees.joint_axes import joint_axes
from derive.lowering.trees.link_loop import LinkLoop, opposite
from derive.lowering.trees.motion import BIAS, FRAME, INERTIA, LEVER, MOMENT, NEEDED, TreeMotion, axis, matrix
from derive.lowering.vectors import (
    Matrix,
    Vector,
    after_cross,
    applied,
    before_cross,
    cross,
    dot,
    minus,
    packed,
    plus,
    scaled,
    symmetric,
    transposed,
)
from derive.roles import Source

BEHIND, SHARE, FOUND = "behind", "share", "acceleration"
"""The arrays of M, H, J, p and g of what hangs on a link, of U, 1/D and (tau - S . p)/D, and of accelerations."""
M, H, J, P = 0, 6, 15, 21
"""The first components of the parts of BEHIND; p and g are the last six."""
COUNT = 27


def articulated(
    motion: TreeMotion, gravity: Sequence[Expr], forces: str, target: str = "vdot", on_free: str = ""
) -> list[Part]:
    """The sections of the accelerations in an array, after those of the motion and of the inertias.

    Without an array the articulated bodies alone. forces: the array of those of rows, "" without any; on_free: that of
    those on free bodies, which no joint pushes.
    """
    backward = _backward(motion, forces)
    chain = motion.tree.is_chain
    declared = [*motion.work((BEHIND, COUNT), cleared=not chain), *motion.work((SHARE, 8))]
    declared += motion.at_link(BEHIND, len(motion.tree.links) - 1, [ZERO] * COUNT) if chain else []
    loops: list[Statement] = [*declared, backward] if motion.joints else [*declared]
    ground = [*motion.work((FOUND, 6))]
    behind: Part = ("articulated", Source.FACTORISATION, "what each link has to carry, from the leaves on", loops)
    if not target:
        return [behind]
    return [
        behind,
        (
            "accelerations",
            Source.FACTORISATION,
            "accelerations, from the ground on",
            [*ground, *_forward(motion, gravity, target, on_free)],
        ),
    ]


def _backward(motion: TreeMotion, forces: str) -> ForEach:
    """The loop from the leaves on: the share of each joint, and what the link before it has to carry."""
    loop = motion.loop("articulated", motion.joints)
    here, before = loop.of_links(), loop.of_parents()
    m, s, j, p, g = carried(motion, loop, here)
    e = axis(loop, here)
    turns, advances = loop.number(lambda of: of.turns), loop.number(lambda of: of.advances)
    linear = plus(scaled(advances, applied(m, e)), scaled(turns, applied(s, e)))
    angular = plus(scaled(advances, applied(transposed(s), e)), scaled(turns, applied(j, e)))
    pivot = advances * dot(e, linear) + turns * dot(e, angular)
    loop.require(Requirement.POSITIVE, pivot, ReturnCode.PIVOT, "the motion of a joint meets no inertia")
    force = -(advances * dot(e, p) + turns * dot(e, g))
    if forces:
        force = loop.element(forces, motion.row(loop)) + force
    inverse = 1 / pivot
    known = force * inverse
    loop.store_vector(SHARE, here, [*linear, *angular, inverse, known])
    by_linear, by_angular = scaled(inverse, linear), scaled(inverse, angular)
    m = [[x - a * b for x, b in zip(row, linear, strict=True)] for row, a in zip(m, by_linear, strict=True)]
    s = [[x - a * b for x, b in zip(row, by_angular, strict=True)] for row, a in zip(s, linear, strict=True)]
    j = [[x - a * b for x, b in zip(row, angular, strict=True)] for row, a in zip(j, by_angular, strict=True)]
    m, j = symmetric(packed(m)), symmetric(packed(j))
    c, gamma = loop.vector(BIAS, here), loop.vector(BIAS, here, first=3)
    p = plus(p, applied(m, c), applied(s, gamma), scaled(known, linear))
    g = plus(g, applied(transposed(s), c), applied(j, gamma), scaled(known, angular))
    r, follows = loop.vector(LEVER, here), loop.number(lambda of: of.follows)
    s, j, g = [scaled(follows, row) for row in s], [scaled(follows, row) for row in j], scaled(follows, g)
    moved = minus_matrix(s, after_cross(m, r))
    turned = plus_matrix(j, transposed(before_cross(r, s)), before_cross(r, moved))
    g = plus(g, cross(r, p))
    values = [*packed(m), *(x for row in moved for x in row), *packed(turned), *p, *g]
    loop.store_vector(BEHIND, before, values, operator=None if motion.tree.is_chain else Operator.ADD)
    return loop.made(backward=True)


def carried(motion: TreeMotion, loop: LinkLoop, here: Place) -> tuple[Matrix, Matrix, Matrix, Vector, Vector]:
    """M, H, J, p and g of each link with all that hangs on it."""
    behind = loop.vector(BEHIND, here, COUNT)
    mass = loop.number(lambda of: of.inertia.mass)
    s, own, needed = loop.vector(MOMENT, here), loop.vector(INERTIA, here, 6), loop.vector(NEEDED, here, 6)
    m, none = symmetric(behind[M:H]), ca.SX(0)
    for k in range(3):
        m[k][k] = m[k][k] + mass
    h = plus_matrix(matrix(behind[H:J]), [[none, s[2], -s[1]], [-s[2], none, s[0]], [s[1], -s[0], none]])
    j = symmetric(plus(behind[J:P], own))
    return m, h, j, plus(behind[P : P + 3], needed[:3]), plus(behind[P + 3 :], needed[3:])


def _forward(motion: TreeMotion, gravity: Sequence[Expr], target: str, on_free: str) -> list[Statement]:
    """The accelerations of all links, with a ground that accelerates upward, and those of the coordinates."""
    upward = [*map(opposite, gravity)]
    result: list[Statement] = [*motion.at_ground(FOUND, [*upward, ZERO, ZERO, ZERO])]
    if motion.free:
        result.append(_of_free(motion, gravity, target, on_free))
    if motion.joints:
        result.append(_of_joints(motion, target))
    return result


def _of_joints(motion: TreeMotion, target: str) -> ForEach:
    loop = motion.loop("forward", motion.joints)
    here, before = loop.of_links(), loop.of_parents()
    joint = joint_axes(loop, here)
    a, alpha = joint.carried(loop.vector(FOUND, before), loop.vector(FOUND, before, first=3))
    a, alpha = plus(a, loop.vector(BIAS, here)), plus(alpha, loop.vector(BIAS, here, first=3))
    *share, inverse, known = loop.vector(SHARE, here, 8)
    vdot = known - inverse * dot(share, [*a, *alpha])
    loop.require(Requirement.FINITE, vdot, ReturnCode.NOT_FINITE, "a result is not finite")
    loop.store_vector(FOUND, here, joint.moved(a, alpha, vdot))
    loop.store(target, motion.row(loop), vdot)
    return loop.made()


def _of_free(motion: TreeMotion, gravity: Sequence[Expr], target: str, forces: str) -> ForEach:
    """The accelerations of free bodies, of all that hangs on them."""
    loop = motion.loop("free", motion.free)
    here = loop.of_links()
    m, s, j, p, g = carried(motion, loop, here)
    whole = [[*m[i], *s[i]] for i in range(3)] + [[*transposed(s)[i], *j[i]] for i in range(3)]
    Q, wanted = matrix(loop.vector(FRAME, here, 9)), [-x for x in (*p, *g)]
    if forces:
        given = [loop.element(forces, motion.row(loop, k)) for k in range(6)]
        wanted = plus(wanted, [*given[:3], *applied(Q, given[3:])])
    found = solved(loop, whole, wanted)
    a, alpha = found[:3], found[3:]
    loop.store_vector(FOUND, here, found)
    linear = [x + loop.leaf(g) for x, g in zip(a, gravity, strict=True)]
    for k, value in enumerate([*linear, *applied(transposed(Q), alpha)]):
        loop.store(target, motion.row(loop, k), value)
    return loop.made()


def solved(loop: LinkLoop, a: Matrix, b: Vector) -> Vector:
    """The solution of a symmetric positive definite system, by L D L^T."""
    n, lower, inverses = len(b), [list(row) for row in a], list[ca.SX]()
    x = list(b)
    for k in range(n):
        loop.require(Requirement.POSITIVE, lower[k][k], ReturnCode.PIVOT, "a free body has no inertia")
        inverses.append(1 / lower[k][k])
        factors = [lower[i][k] * inverses[k] for i in range(n)]
        for i in range(k + 1, n):
            for col in range(k + 1, i + 1):
                lower[i][col] = lower[i][col] - factors[i] * lower[col][k]
            x[i] = x[i] - factors[i] * x[k]
        for i in range(k + 1, n):
            lower[i][k] = factors[i]
    for k in reversed(range(n)):
        x[k] = x[k] * inverses[k]
        for i in range(k + 1, n):
            x[k] = x[k] - lower[i][k] * x[i]
    return x


def plus_matrix(*matrices: Matrix) -> Matrix:
    """The sum of matrices."""
    return [plus(*rows) for rows in zip(*matrices, strict=True)]


def minus_matrix(a: Matrix, b: Matrix) -> Matrix:
    """The difference of two matrices."""
    return [minus(x, y) for x, y in zip(a, b, strict=True)]
