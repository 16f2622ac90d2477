"""The forces that links need for given accelerations, summed up from the leaves: the recursion of Newton and Euler."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from derive.ir.expressions import Expr, Operator
from derive.ir.statements import ForEach, Statement
from derive.lowering.instances.loop_code.kernels import ZERO, Part
from derive.lowering.trees.joint_axes import joint_axes
from derive.lowering.trees.link_loop import LinkLoop, opposite
from derive.lowering.trees.motion import BIAS, FRAME, INERTIA, LEVER, MOMENT, NEEDED, TreeMotion, axis, matrix
from derive.lowering.vectors import applied, cross, plus, scaled, symmetric, transposed

FOUND, FORCE = "acceleration", "force"
"""The arrays of the accelerations of links, and of the forces and torques that they need with all behind them."""
Given = tuple[str, int]
"""An array with the accelerations of the coordinates, and the index of the first one."""


def newton_euler(
    motion: TreeMotion, gravity: Sequence[Expr], target: Given, applied_forces: str, given: Given | None = None
) -> list[Part]:
    """The sections that write M vdot + h, or h without accelerations, for each row from an element of an array on.

    applied_forces: the array of the forces to subtract, if there are any.
    """
    upward = [*map(opposite, gravity)]
    forward: list[Statement] = [
        *motion.work((FOUND, 6), (FORCE, 6), cleared=len(motion.massive) < len(motion.tree.links)),
        *motion.at_ground(FOUND, [*upward, ZERO, ZERO, ZERO]),
        *motion.at_ground(FORCE, [ZERO] * 6),
    ]
    if motion.free:
        forward.append(free_accelerations(motion, upward, given))
    if motion.joints:
        forward.append(carried_accelerations(motion, given))
    forward.append(_forces(motion))
    backward = [_summed(motion, target, applied_forces)] if motion.joints else []
    backward += [_of_free(motion, target, applied_forces)] if motion.free else []
    doing = "for given accelerations" if given else "without accelerations"
    return [
        ("needed", "(15)", f"forces and torques that the links need {doing}", forward),
        ("rows", "(15)", "what they are with all behind a joint, along it", backward),
    ]


def _vdot(motion: TreeMotion, loop: LinkLoop, given: Given, k: int = 0) -> ca.SX:
    return loop.element(given[0], motion.row(loop, k).plus(given[1]))


def carried_accelerations(motion: TreeMotion, given: Given | None, array: str = FOUND) -> ForEach:
    """The loop of the accelerations of links in an array, without those of coordinates if none are given."""
    loop = motion.loop("carried_given" if given else "carried", motion.joints)
    here, before = loop.of_links(), loop.of_parents()
    r, c, gamma = loop.vector(LEVER, here), loop.vector(BIAS, here), loop.vector(BIAS, here, first=3)
    a, alpha = loop.vector(array, before), loop.vector(array, before, first=3)
    follows = loop.number(lambda of: of.follows)
    a, alpha = plus(a, cross(alpha, r), c), plus(scaled(follows, alpha), gamma)
    if given:
        e, vdot = axis(loop, here), _vdot(motion, loop, given)
        turns, advances = loop.number(lambda of: of.turns), loop.number(lambda of: of.advances)
        a, alpha = plus(a, scaled(advances * vdot, e)), plus(alpha, scaled(turns * vdot, e))
    loop.store_vector(array, here, [*a, *alpha])
    return loop.made()


def free_accelerations(motion: TreeMotion, upward: Sequence[Expr], given: Given | None, array: str = FOUND) -> ForEach:
    """The loop of the accelerations of free bodies in an array, on a ground that accelerates upward."""
    loop = motion.loop("free_carried", motion.free)
    here = loop.of_links()
    a, alpha = [loop.leaf(of) for of in upward], [ca.SX(0)] * 3
    if given:
        a = plus(a, [_vdot(motion, loop, given, k) for k in range(3)])
        Q = matrix(loop.vector(FRAME, here, 9))
        alpha = applied(Q, [_vdot(motion, loop, given, 3 + k) for k in range(3)])
    loop.store_vector(array, here, [*a, *alpha])
    return loop.made()


def _forces(motion: TreeMotion) -> ForEach:
    loop = motion.loop("own", motion.massive)
    here = loop.of_links()
    mass = loop.number(lambda of: of.inertia.mass)
    s, tensor = loop.vector(MOMENT, here), symmetric(loop.vector(INERTIA, here, 6))
    a, alpha = loop.vector(FOUND, here), loop.vector(FOUND, here, first=3)
    f = plus(scaled(mass, a), cross(alpha, s), loop.vector(NEEDED, here))
    n = plus(cross(s, a), applied(tensor, alpha), loop.vector(NEEDED, here, first=3))
    loop.store_vector(FORCE, here, [*f, *n])
    return loop.made(independent=True)


def _summed(motion: TreeMotion, target: Given, applied_forces: str) -> ForEach:
    loop = motion.loop("summed", motion.joints)
    here, before = loop.of_links(), loop.of_parents()
    f, n = loop.vector(FORCE, here), loop.vector(FORCE, here, first=3)
    joint = joint_axes(loop, here)
    value, row = joint.along(f, n), motion.row(loop)
    if applied_forces:
        value = value - loop.element(applied_forces, row)
    loop.store(target[0], row.plus(target[1]), value)
    loop.store_vector(FORCE, before, joint.passed(f, n), operator=Operator.ADD)
    return loop.made(backward=True)


def _of_free(motion: TreeMotion, target: Given, applied_forces: str) -> ForEach:
    loop = motion.loop("free_summed", motion.free)
    here = loop.of_links()
    f, n = loop.vector(FORCE, here), loop.vector(FORCE, here, first=3)
    Q = matrix(loop.vector(FRAME, here, 9))
    for k, value in enumerate([*f, *applied(transposed(Q), n)]):
        row = motion.row(loop, k)
        left = value - loop.element(applied_forces, row) if applied_forces else value
        loop.store(target[0], row.plus(target[1]), left)
    return loop.made()
