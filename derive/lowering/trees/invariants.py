"""Energies, momenta, rates and poses of trees: sums and maps over their links and bodies."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import casadi as ca

from derive.ir.expressions import Element, Expr, Operator
from derive.ir.indices import ElementIndex, IndexTerm, constant
from derive.ir.statements import Statement, StoreElement
from derive.lowering.instances.loop_code.kernels import ZERO
from derive.lowering.trees.link_loop import LINK, LinkLoop
from derive.lowering.trees.links import BodyPlace
from derive.lowering.trees.motion import FRAME, INERTIA, MOMENT, ORIGIN, SPEED, SPIN, TreeMotion, matrix
from derive.lowering.vectors import applied, cross, dot, plus, product, scaled, symmetric

POSE = 12
"""The numbers of the pose of a body: its position, and its rotation tensor by rows."""


def _zeros(array: str, count: int) -> list[Statement]:
    return [StoreElement(Element(array, constant(k)), ZERO) for k in range(count)]


def energy(motion: TreeMotion, gravity: Sequence[Expr] | None) -> list[Statement]:
    """The statements of the kinetic energy, no strain energy, and the potential of gravity, if there is any."""
    loop = motion.loop("energy", motion.massive)
    mass, s, x, v, w, L = of_links(loop)
    kinetic = (mass * dot(v, v) + dot(w, L)) / 2 + dot(v, cross(w, s))
    loop.store("energy", constant(0), kinetic, Operator.ADD)
    if gravity is not None:
        weight = [loop.leaf(g) for g in gravity]
        loop.store("energy", constant(2), -dot(weight, plus(scaled(mass, x), s)), Operator.ADD)
    return [*_zeros("energy", 2 if gravity is None else 3), loop.made()]


def momentum(motion: TreeMotion) -> list[Statement]:
    """The statements of the linear momentum, and of the angular momentum about the inertial origin."""
    loop = motion.loop("momentum", motion.massive)
    mass, s, x, v, w, L = of_links(loop)
    linear = plus(scaled(mass, v), cross(w, s))
    angular = plus(cross(x, linear), cross(s, v), L)
    for k, value in enumerate([*linear, *angular]):
        loop.store("momentum", constant(k), value, Operator.ADD)
    return [*_zeros("momentum", 6), loop.made()]


def of_links(loop: LinkLoop) -> tuple[ca.SX, list[ca.SX], list[ca.SX], list[ca.SX], list[ca.SX], list[ca.SX]]:
    """Mass, first moment, position, velocity, angular velocity, and angular momentum of the rotation of each link."""
    here = loop.of_links()
    mass, s = loop.number(lambda of: of.inertia.mass), loop.vector(MOMENT, here)
    w = loop.vector(SPIN, here)
    spun = applied(symmetric(loop.vector(INERTIA, here, 6)), w)
    return mass, s, loop.vector(ORIGIN, here), loop.vector(SPEED, here), w, spun


def rates(motion: TreeMotion, output: str = "qdot", of: str = "") -> list[Statement]:
    """The statements of qdot: velocities of joints and positions, and those of quaternions.

    of: the array of what they are subtracted from, if that is wanted.
    """
    result: list[Statement] = []
    singles = [n for n in motion.joints if motion.tree.links[n].ball < 0]
    if singles:
        loop = motion.loop("rates", singles)
        _stored(motion, loop, output, of, [motion.velocity(loop)])
        result.append(loop.made())
    if motion.balls:
        loop = motion.loop("ball_rates", motion.balls)
        _stored(motion, loop, output, of, _of_quaternion(motion, loop, 0))
        result.append(loop.made())
    if motion.free:
        loop = motion.loop("free_rates", motion.free)
        moving = [motion.velocity(loop, k) for k in range(3)]
        _stored(motion, loop, output, of, [*moving, *_of_quaternion(motion, loop, 3)])
        result.append(loop.made())
    return result


def _of_quaternion(motion: TreeMotion, loop: LinkLoop, first: int) -> list[ca.SX]:
    """The time derivatives of quaternions that begin so far behind the coordinates and velocities of links."""
    a, b, c, d = (motion.coordinate(loop, first + k) for k in range(4))
    x, y, z = (motion.velocity(loop, first + k) for k in range(3))
    turned = [-b * x - c * y - d * z, a * x - d * y + c * z, d * x + a * y - b * z, b * y - c * x + a * z]
    return scaled(loop.value(Fraction(1, 2)), turned)  # CasADi would round the derivative of a quotient


def _stored(motion: TreeMotion, loop: LinkLoop, output: str, of: str, values: Sequence[ca.SX]) -> None:
    place = loop.place("coordinate", [motion.tree.links[n].coordinate for n in loop.links])
    for k, value in enumerate(values):
        loop.store(output, place.at(k), loop.element(of, place.at(k)) - value if of else value)


def poses(motion: TreeMotion, bodies: Sequence[BodyPlace]) -> list[Statement]:
    """The statements of the positions and rotation tensors of bodies, whose frames have these places."""
    loop = motion.loop("bodies", [of.link for of in bodies])
    here = loop.of_links()
    Q = matrix(loop.vector(FRAME, here, 9))
    origin = [loop.column([of.origin[k] for of in bodies]) for k in range(3)]
    attitude = [[loop.column([of.attitude[i][j] for of in bodies]) for j in range(3)] for i in range(3)]
    values = [*plus(loop.vector(ORIGIN, here), applied(Q, origin))]
    values += [entry for row in product(Q, attitude) for entry in row]
    for k, value in enumerate(values):
        loop.store("pose", ElementIndex(k, (IndexTerm(POSE, LINK),)), value)
    return [loop.made()]
