"""Forces and torques at markers of trees in one loop: what the links that they act on need besides them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from derive.algebra import fraction, sp
from derive.ir.expressions import Element, Number, Operator, ScalarRef
from derive.ir.indices import constant
from derive.ir.statements import Statement, StoreElement, Work
from derive.lowering.trees.link_loop import LinkLoop
from derive.lowering.trees.links import BodyPlace, Tree, marker_place
from derive.lowering.trees.motion import FRAME, NEEDED, TreeMotion, matrix
from derive.lowering.vectors import applied, cross, plus, scaled
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from derive.mechanics.symbols import local
from derive.mechanics.terms import Intermediate
from derive.spec.model.instances import identifier
from derive.spec.model.markers import MarkerRef
from derive.spec.model.spatial_forces import SpatialForce, SpatialTorque

VALUES = "load_values"
"""The local array of the components of loads."""


@dataclass(frozen=True)
class LinkLoad:
    """A load on a link: `sign` times the vector with the components of load `number` in a frame.

    at: the link with the position of the marker there; axes: the link whose frame turns the components, -1 for inertial
    ones, with their axes there; is_force: whether it is a force at the marker, or a torque.
    """

    number: int
    at: BodyPlace
    axes: BodyPlace
    is_force: bool
    sign: int = 1


@dataclass(frozen=True)
class MarkerLoads:
    """The loads at markers; components: those of each of them, as expressions; names: those of the loads."""

    names: tuple[str, ...]
    components: tuple[tuple[sp.Expr, ...], ...]
    loads: tuple[LinkLoad, ...]

    @property
    def definitions(self) -> list[Intermediate]:
        """The definitions of the components that are no numbers."""
        return [
            Intermediate(_symbol(name, k), value, name, "(10)", f"component {k} of {name}")
            for name, values in zip(self.names, self.components, strict=True)
            for k, value in enumerate(values, 1)
            if not value.is_Rational
        ]


def _symbol(name: str, k: int) -> sp.Symbol:
    return local(identifier("component", f"{name}_{k}"))


def marker_loads(mechanism: SpatialMechanism, tree: Tree) -> MarkerLoads:
    """The forces and torques at markers of a mechanism."""
    names, components, loads = list[str](), list[tuple[sp.Expr, ...]](), list[LinkLoad]()

    def place(marker: MarkerRef) -> BodyPlace:
        return marker_place(mechanism, tree.bodies, marker)

    for action in mechanism.forces:
        element = action.element
        if not isinstance(element, SpatialForce | SpatialTorque):
            continue
        is_force = isinstance(element, SpatialForce)
        first = place(action.markers[0])
        axes = first if element.frame == "body" else BodyPlace(-1)
        vector = sp.Matrix(action.values["force" if is_force else "torque"])
        for marker, sign in zip(action.markers, (1, -1), strict=False):
            if (at := place(marker)).link >= 0:
                loads.append(LinkLoad(len(names), at, axes, is_force, sign))
        names.append(element.name)
        components.append(tuple(map(sp.sympify, vector)))
    return MarkerLoads(tuple(names), tuple(components), tuple(loads))


def acting(motion: TreeMotion, of: MarkerLoads) -> list[Statement]:
    """The statements that subtract the loads from what the links need."""
    if not of.loads:
        return []
    result: list[Statement] = [Work(VALUES, 3 * len(of.names))]
    for n, (name, values) in enumerate(zip(of.names, of.components, strict=True)):
        for k, value in enumerate(values):
            leaf = Number(fraction(value)) if value.is_Rational else ScalarRef(str(_symbol(name, k + 1)))
            result.append(StoreElement(Element(VALUES, constant(3 * n + k)), leaf))
    return [*result, _loop(motion, of.loads).made()]


def _loop(motion: TreeMotion, loads: Sequence[LinkLoad]) -> LinkLoop:
    loop = motion.loop("loads", [of.at.link for of in loads])
    at, spacing = loop.of_links(), motion.arrays.spacing
    frames = loop.place("axes", [motion.arrays.slot(of.axes.link) for of in loads], spacing)
    first = loop.place("value", [3 * of.number for of in loads])
    given = [loop.element(VALUES, first.at(k)) for k in range(3)]
    axes = [[loop.column([of.axes.attitude[i][j] for of in loads]) for j in range(3)] for i in range(3)]
    sign = loop.column([Fraction(-of.sign) for of in loads])
    vector = scaled(sign, applied(matrix(loop.vector(FRAME, frames, 9)), applied(axes, given)))
    is_force = loop.column([Fraction(of.is_force) for of in loads])
    origin = [loop.column([of.at.origin[k] for of in loads]) for k in range(3)]
    lever = applied(matrix(loop.vector(FRAME, at, 9)), origin)
    force = scaled(is_force, vector)
    torque = plus(cross(lever, force), scaled(1 - is_force, vector))
    loop.store_vector(NEEDED, at, [*force, *torque], operator=Operator.ADD)
    return loop
