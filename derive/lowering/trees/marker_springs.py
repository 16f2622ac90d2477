"""Springs and bushings between markers of trees, in a loop over those of one kind.

Their loads are those of straight-line code for frames whose motion has symbols of its own, and for values with symbols.
Springs of one kind share the code if the same values are zero and the same ends are at rest.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca

from derive.algebra import sp
from derive.ir.expressions import Operator
from derive.ir.indices import constant
from derive.ir.statements import Requirement, ReturnCode, Statement
from derive.lowering.trees.conditions import frame_symbol, moving_frame
from derive.lowering.trees.exact_numbers import Exact, exact
from derive.lowering.trees.link_frames import frame_motion
from derive.lowering.trees.link_loop import LinkLoop
from derive.lowering.trees.links import BodyPlace, Tree, marker_place
from derive.lowering.trees.motion import NEEDED, TreeMotion
from derive.lowering.trees.row_loads import acts_between_frames
from derive.lowering.vectors import cross, plus
from derive.mechanics.multibody.space.actions import loads_of
from derive.mechanics.multibody.space.forces import ActionLoads
from derive.mechanics.multibody.space.joints import SpatialEliminatedJoint
from derive.mechanics.multibody.space.mechanism import SpatialActionInstance, SpatialMechanism
from derive.mechanics.multibody.space.rows import DISPLACEMENTS
from derive.mechanics.symbols import local


@dataclass(frozen=True)
class MarkerSpring:
    """A spring between markers.

    ends: the places of its markers; roots: the first coordinates of the free bodies that these follow, -1 without one.
    values: those of its keys, of which each that does not vanish is a symbol; numbers: what these stand for.
    """

    action: SpatialActionInstance
    ends: tuple[BodyPlace, BodyPlace]
    roots: tuple[int, int]
    values: Mapping[str, Any]
    numbers: tuple[Exact, ...]

    @property
    def code(self) -> tuple[Any, ...]:
        """The numbers that springs with one code share."""
        moves, free = (tuple(n >= 0 for n in of) for of in ([end.link for end in self.ends], self.roots))
        return self.action.element.kind, moves, free, str(self.values)


@dataclass(frozen=True)
class SpringGroup:
    """Springs with one code."""

    number: int
    springs: tuple[MarkerSpring, ...]

    @cached_property
    def loads(self) -> ActionLoads:
        """The loads of the first one, for frames and values in symbols."""
        first = self.springs[0]
        frames = moving_frame(0)[0], moving_frame(1)[0]
        return loads_of(first.action.element, first.action.markers, frames, first.values, None)

    def acting(self, motion: TreeMotion, in_tree: bool) -> Statement:
        """The loop that subtracts the loads from what links need; in_tree: see `TreeMotion.frames`."""
        loop, levers = self._loop(motion, f"springs_{self.number}", in_tree)
        first, arrays = self.springs[0], motion.arrays
        for load in self.loads.loads:
            end = first.action.markers.index(load.marker)
            if first.ends[end].link < 0:
                continue
            slot = loop.place(f"end_{end}", [arrays.slot(of.ends[end].link) for of in self.springs], arrays.spacing)
            force, torque = ([loop.symbols(x) for x in vector] for vector in (load.force, load.torque))
            values = [*force, *plus(torque, cross(levers[end], force))]
            loop.store_vector(NEEDED, slot, values, operator=Operator.SUB)
        return loop.made()

    def stored(self, motion: TreeMotion) -> Statement:
        """The loop that adds the energy of the springs."""
        loop, _ = self._loop(motion, f"stored_{self.number}", in_tree=False)
        loop.store("energy", constant(1), loop.symbols(self.loads.potential), Operator.ADD)
        return loop.made()

    def _loop(self, motion: TreeMotion, name: str, in_tree: bool) -> tuple[LinkLoop, list[list[ca.SX]]]:
        """A loop over the springs in which their definitions have values; the levers of both ends."""
        loop, levers = LinkLoop(motion.arrays, name, range(len(self.springs))), []
        for end in range(2):
            known = frame_motion(loop, f"end_{end}", [of.ends[end] for of in self.springs], moving=True)
            if in_tree and self.springs[0].roots[end] >= 0:
                root = loop.place(f"root_{end}", [of.roots[end] for of in self.springs])
                origin = [loop.element(motion.q[0], root.at(k + motion.q[1])) for k in range(3)]
                known["position"] = plus(known["position"], origin)
            levers.append(known.pop("lever"))
            for what, values in known.items():
                loop.symbols.values |= {frame_symbol(end, what, k): value for k, value in enumerate(values)}
        for k, column in enumerate(zip(*(of.numbers for of in self.springs), strict=True)):
            loop.symbols.values[_value(k)] = loop.column(column)
        for d in self.loads.definitions:
            loop.symbols.define(d.symbol, d.expr)
            if d.divisor is not None:
                text = d.divisor_text if len(self.springs) == 1 else "the ends of a spring coincide"
                loop.require(Requirement.POSITIVE, loop.symbols.values[d.divisor], ReturnCode.NOT_FINITE, text)
        return loop, levers


def spring_groups(mechanism: SpatialMechanism, tree: Tree) -> tuple[SpringGroup, ...]:
    """The springs between markers of a mechanism. Raises SpecError where a joint leaves a spring no direction."""
    groups: dict[Any, list[MarkerSpring]] = {}
    numbers = {c.symbol: c.value for c in mechanism.constants}
    for action in mechanism.forces:
        if acts_between_frames(mechanism, action):
            spring = _spring(mechanism, tree, action, numbers)
            groups.setdefault(spring.code, []).append(spring)
    return tuple(SpringGroup(n, tuple(springs)) for n, springs in enumerate(groups.values()))


def _spring(
    mechanism: SpatialMechanism, tree: Tree, action: SpatialActionInstance, known: Mapping[sp.Symbol, sp.Expr]
) -> MarkerSpring:
    first, second = (marker_place(mechanism, tree.bodies, marker) for marker in action.markers)
    numbers = list[Exact]()

    def symbol(value: Any) -> sp.Expr:
        if value == 0:
            return sp.S.Zero
        numbers.append(exact(value, known))
        return _value(len(numbers) - 1)

    values = {
        key: value.applyfunc(symbol) if isinstance(value, sp.MatrixBase) else symbol(value)
        for key, value in action.values.items()
    }
    joint = mechanism.joint_of(action)
    if isinstance(joint, SpatialEliminatedJoint) and {*DISPLACEMENTS} <= {*joint.type.removed(joint.joint)}:
        loads_of(action.element, action.markers, (moving_frame(0)[0],) * 2, values, None)  # which raises it
    return MarkerSpring(action, (first, second), (_root(tree, first), _root(tree, second)), values, tuple(numbers))


def _root(tree: Tree, at: BodyPlace) -> int:
    """The first coordinate of the free body that a place follows; -1 if it follows none."""
    link = at.link
    while link >= 0 and tree.links[link].parent >= 0:
        link = tree.links[link].parent
    return tree.links[link].coordinate if link >= 0 and tree.links[link].is_free else -1


def _value(k: int) -> sp.Symbol:
    return local(f"spring_value_{k}")
