"""The motion of markers of trees by one function for all, whose argument is the number of the marker.

A force at the marker is passed along the links to the ground as in the recursion of Newton and Euler; what it does on
the motion of a link is the factor of its velocity in that of the marker.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import casadi as ca

from derive.algebra import sp
from derive.ir.expressions import Operator
from derive.ir.indices import ElementIndex, IndexTerm, constant, variable
from derive.ir.kernel import Argument, Kernel
from derive.ir.model import MarkerClass, Variable
from derive.ir.patterns import Pattern, pattern
from derive.ir.statements import ForEach, Statement, Work
from derive.lowering.instances.loop_code.kernels import ZERO, Part, Result, kernel
from derive.lowering.model_functions import FunctionKind, ModelFunction
from derive.lowering.trees.joint_axes import joint_axes
from derive.lowering.trees.link_loop import LINK, LinkLoop
from derive.lowering.trees.links import BodyPlace, marker_in_body
from derive.lowering.trees.motion import FRAME, ORIGIN, SPEED, SPIN, STILL, TreeMotion, matrix
from derive.lowering.trees.tree_context import TreeContext
from derive.lowering.vectors import applied, cross, dot, plus, transposed
from derive.mechanics.axes import AXES
from derive.mechanics.terms import MarkerEquations
from derive.spec.model.instances import identifier, joined

NAME, NUMBER = "of_tree", "number"
"""The name of the class of all markers, and the argument that is the number of one."""
UNITS = "unit_forces"
"""The array of the forces and torques on links that hold three unit forces at the marker."""


@dataclass(frozen=True)
class TreeMarkers:
    """The markers of a tree on bodies that move: the names for people, and their places."""

    shown: tuple[str, ...]
    places: tuple[BodyPlace, ...]
    rows: int

    @property
    def pattern(self) -> Pattern:
        """The pattern of the Jacobians: any link may move a marker."""
        return pattern(3, self.rows, {(i, j) for i in range(3) for j in range(self.rows)})

    @property
    def classes(self) -> tuple[MarkerClass, ...]:
        """One class, if there are markers."""
        variables = tuple(Variable(identifier(text), "", "m", shown=text) for text in self.shown)
        of = MarkerClass(NAME, "a marker of a body", self.pattern, variables, (0,) * len(variables))
        return (of,) if variables else ()

    @property
    def equations(self) -> tuple[MarkerEquations, ...]:
        """The marker that stands for all of them in the table of functions."""
        none = sp.ImmutableMatrix(3, 1, [0, 0, 0])
        return tuple(MarkerEquations(NAME, of.doc, (), none, none, none, none, (), ()) for of in self.classes)


def markers_of(context: TreeContext) -> TreeMarkers:
    """The markers of the bodies of a tree that move."""
    found = [
        (joined(of.component.specified, name), context.tree.bodies[of.name].at(*marker_in_body(of, name)))
        for of in context.mechanism.instances
        for name in of.component.markers
        if of.moves
    ]
    return TreeMarkers(tuple(name for name, _ in found), tuple(place for _, place in found), len(context.rows))


def marker(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the position, the velocity and the Jacobian d(velocity)/dv of a marker."""
    of, motion = markers_of(context), context.motion
    labels = tuple(f"x{k}" for k in AXES)
    results = {"x": Result(labels), "xdot": Result(tuple(f"{label}dot" for label in labels))}
    parts: list[Part] = [
        motion.frames(moving=True, placed=True),
        ("marker", "(1)", "the marker on its link", [*motion.work((UNITS, 18), cleared=True), _at_marker(motion, of)]),
        ("jacobian", "(1)", "its velocity by unit rates of the links", [*_jacobian(motion, of)]),
    ]
    results |= {"jacobian": Result(pattern=of.pattern)}
    return kernel(context, _of_number(function), results, *parts, inputs=_number(of))


def load(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the generalised forces of a force at a marker: its products with the columns of the Jacobian."""
    of, motion, rows = markers_of(context), context.motion, len(context.rows)
    force = Argument("F", ("F1", "F2", "F3"), "force at the marker, in the inertial frame [N]")
    still: list[Statement] = [
        Work(STILL, rows, cleared=True),
        Work("jacobian", 3 * rows),
        Work("x", 3),
        Work("xdot", 3),
    ]
    motion = replace(motion, v=(STILL, 0))
    loop = LinkLoop(motion.arrays, "load", range(rows))
    value = [loop.element("jacobian", ElementIndex(k, (IndexTerm(3, LINK),))) for k in range(3)]
    loop.store("f", variable(LINK), dot(value, [loop.scalar(name) for name in force.elements]))
    parts: list[Part] = [
        ("still", "", "no velocities", still),
        motion.frames(moving=True, placed=True),
        ("marker", "(1)", "the marker on its link", [*motion.work((UNITS, 18), cleared=True), _at_marker(motion, of)]),
        ("jacobian", "(1)", "its velocity by unit rates of the links", [*_jacobian(motion, of)]),
        ("f", "(10)", "virtual work of the force", [loop.made()]),
    ]
    inputs = {**_number(of), "F": force}
    return kernel(context, _of_number(function), {"f": Result(("row by row",), count=rows)}, *parts, inputs=inputs)


OF_MARKERS: Mapping[FunctionKind, Callable[[TreeContext, ModelFunction], Kernel]] = {
    FunctionKind.MARKER: marker,
    FunctionKind.LOAD: load,
}
"""The functions of markers, by their kinds."""


def _of_number(function: ModelFunction) -> ModelFunction:
    return replace(function, arguments=(NUMBER, *function.arguments))


def _number(of: TreeMarkers) -> dict[str, Argument]:
    doc = f"number i of the marker, 0 .. {len(of.shown) - 1}"
    return {NUMBER: Argument(NUMBER, (), doc, scalar=True, integer=True)}


def _at_marker(motion: TreeMotion, of: TreeMarkers) -> ForEach:
    loop = motion.loop("markers", [place.link for place in of.places])
    here = loop.of_links()
    lever = applied(
        matrix(loop.vector(FRAME, here, 9)), [loop.column([place.origin[k] for place in of.places]) for k in range(3)]
    )
    position = plus(loop.vector(ORIGIN, here), lever)
    velocity = plus(loop.vector(SPEED, here), cross(loop.vector(SPIN, here), lever))
    for k in range(3):
        loop.store("x", constant(k), position[k])
        loop.store("xdot", constant(k), velocity[k])
        unit = [ca.SX(int(i == k)) for i in range(3)]
        for i, value in enumerate([*unit, *cross(lever, unit)]):
            loop.store(UNITS, here.at(6 * k + i), value)
    return replace(loop.made(), start=variable(NUMBER), stop=variable(NUMBER, offset=1))


def _jacobian(motion: TreeMotion, of: TreeMarkers) -> Iterator[Statement]:
    yield from motion.at_ground(UNITS, [ZERO] * 18)
    if motion.joints:
        loop = motion.loop("marker_jacobian", motion.joints)
        here, before = loop.of_links(), loop.of_parents()
        joint = joint_axes(loop, here)
        for k in range(3):
            f, n = loop.vector(UNITS, here, first=6 * k), loop.vector(UNITS, here, first=6 * k + 3)
            _store(motion, loop, 0, k, joint.along(f, n))
            loop.store_vector(UNITS, before, joint.passed(f, n), first=6 * k, operator=Operator.ADD)
        yield loop.made(backward=True)
    if motion.free:
        loop = motion.loop("free_marker_jacobian", motion.free)
        here = loop.of_links()
        Q = matrix(loop.vector(FRAME, here, 9))
        for k in range(3):
            f, n = loop.vector(UNITS, here, first=6 * k), loop.vector(UNITS, here, first=6 * k + 3)
            for row, value in enumerate([*f, *applied(transposed(Q), n)]):
                _store(motion, loop, row, k, value)
        yield loop.made()


def _store(motion: TreeMotion, loop: LinkLoop, row: int, k: int, value: ca.SX) -> None:
    """Write the entry of component k in the column of a row of each link."""
    places = [3 * (motion.tree.links[n].row + row) for n in loop.links]
    loop.store("jacobian", loop.place(f"column_{row}", places).at(k), value)
