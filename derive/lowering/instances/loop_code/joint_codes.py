"""The codes of varying joints between the bodies of some classes; joints that are alike have one code."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import permutations

from derive.algebra import sp
from derive.lowering.flat.setup_constants import Constants
from derive.lowering.instances.classes.class_equations import with_known
from derive.lowering.instances.classes.gears import constraining
from derive.lowering.instances.classes.groups import Bodies, Group
from derive.lowering.instances.classes.joint_groups import joint_equations, joint_groups
from derive.lowering.instances.classes.varying_parts import FactorPlace
from derive.lowering.instances.elimination.block_system import Blocks
from derive.lowering.instances.loop_code.class_code import ClassCode, LoopCode
from derive.lowering.instances.loop_code.ground_at_rest import JointsWithGround, joined_element
from derive.lowering.instances.loop_code.group_code import JointCode, group_code
from derive.lowering.instances.places import Places
from derive.mechanics.multibody.space.first_body_rows import rows_along_first, turned_axes
from derive.mechanics.multibody.space.joints import SpatialJointInstance


@dataclass(frozen=True)
class JointCodes:
    """The making of the codes of the varying joints between some bodies, and of their gears."""

    bodies: Bodies
    places: Places
    constants: Constants

    def of(self, classes: Sequence[ClassCode]) -> list[JointCode]:
        """The codes of the joints that vary for these classes, which all bodies have."""
        groups = joint_groups(self.bodies, any(code.of.along_first for code in classes))
        return [self._of_group(group, classes) for group in groups]

    def _of_group(self, group: Group, classes: Sequence[ClassCode]) -> JointCode:
        factors, bodies, first = dict[int, tuple[FactorPlace, ...]](), dict[int, range](), 0
        for body in group.first.bodies:
            of, member = next((code, m) for code in classes for m in code.of.members if m.number == body.number)
            (h,) = (h for h, handle in enumerate(member.handles) if handle.joint == group.first.number)
            side, count = member.handles[h].side, len(member.instance.coordinates.rows)
            factors[side], bodies[side] = (*of.varying[h].factors,), range(first, first + count)
            first += count
        equations, reactions = joint_equations(self.bodies, group)
        code = group_code(group, equations, self.bodies.known, self.places, self.constants)
        joint = constraining(self.bodies.mechanism)[group.first.number]
        held = rows_along_first(joint) if group.along_first and isinstance(joint, SpatialJointInstance) else 0
        rows = enumerate(turned_axes()[:held])
        turned: dict[FactorPlace, sp.Symbol] = {(k, m): s for k, row in rows for m, s in enumerate(row)}
        return JointCode(code, group, factors, bodies, reactions, turned)

    def with_ground(self, joints: list[JointCode], blocks: Blocks) -> list[JointCode]:
        """The codes of varying joints after one at the ground has joined those between bodies that are like it."""
        between = [of for of in joints if not of.are_gears]
        for ground, others in permutations(between, 2):
            if found := joined_element(self.bodies, ground, others, blocks):
                side, element = found
                elements = tuple(sorted([element, *others.elements], key=lambda e: e.number))
                group = replace(others.group, members=elements)
                equations, reactions = joint_equations(self.bodies, others.group)
                known = with_known(equations, self.bodies.known, len(element.constants))
                code = LoopCode(group, known, self.places, self.constants, f"{others.code.name}_and_ground")
                own = others.factors, others.bodies, reactions, others.turned
                joined = JointsWithGround(code, group, *own, side=side)
                return [joined if of is others else of for of in joints if of is not ground]
        return joints
