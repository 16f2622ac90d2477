"""The forms F(t, y, ydot) = 0 of trees for implicit integrators, see `derive.lowering.model_functions.FORMS`."""

from __future__ import annotations

from dataclasses import dataclass, replace

from derive.ir.expressions import Number, Operator
from derive.ir.kernel import Argument
from derive.ir.statements import ForEach, Statement, Work
from derive.lowering.instances.loop_code.kernels import ZERO, Part, whole
from derive.lowering.trees import invariants
from derive.lowering.trees.condition_loops import ConditionLoops
from derive.lowering.trees.joint_axes import joint_axes
from derive.lowering.trees.link_frames import CARRIED
from derive.lowering.trees.motion import FRAME, NEEDED, TreeMotion, matrix
from derive.lowering.trees.newton_euler import carried_accelerations, free_accelerations, newton_euler
from derive.lowering.trees.tree_context import TreeContext
from derive.lowering.vectors import applied, transposed

HELD, CORRECTED = "held", "corrected"
"""The arrays of what multipliers exert on links, and of v - G^T mu."""


@dataclass(frozen=True)
class TreeForm:
    """A form of a tree: its name, and the numbers of its parts."""

    context: TreeContext
    name: str

    @property
    def size(self) -> int:
        """The number of states."""
        sets = 2 if self.name == "ggl" else 1
        return self._multipliers + sets * self.context.multipliers

    @property
    def arguments(self) -> dict[str, Argument]:
        """The state, and its time derivative."""
        doc = "state [q; v; multipliers]"
        return {"y": whole("y", self.size, doc), "ydot": whole("ydot", self.size, "time derivative of y")}

    @property
    def _multipliers(self) -> int:
        return self.context.coordinates + len(self.context.rows)

    @property
    def _motion(self) -> TreeMotion:
        return replace(self.context.motion, q=("y", 0), v=("y", self.context.coordinates))

    def conditions(self, g: str, gdot: str) -> list[Statement]:
        """The statements that write the constraints and their rates to two arrays."""
        if not self.context.multipliers:
            return []
        of = self.context.constrained(self._motion)
        position = of.values(g, lambda c: c.position, moving=False)
        return [position, of.values(gdot, lambda c: c.rate, moving=True)]

    def parts(self) -> list[Part]:
        """The sections of F."""
        context, count = self.context, self.context.coordinates
        motion = self._motion
        of, held = context.constrained(motion), bool(context.multipliers)
        multipliers, target = ("y", self._multipliers), ("F", count)
        corrected: list[Part] = []
        rated = motion
        if held and self.name == "ggl":
            corrected = [("corrected", "(5)", "v - G^T mu", self._corrected(motion, of))]
            rated = replace(motion, v=(CORRECTED, 0))
        return [
            motion.frames(moving=True, placed=held or bool(context.springs)),
            *corrected,
            ("rates", "(1)", "qdot - v", invariants.rates(rated, "F", "ydot")),
            motion.inertias(moving=True),
            *context.applied_at(motion),
            ("reactions", "(15)", "what the multipliers exert on the links", of.loads(multipliers, NEEDED)),
            *newton_euler(motion, context.gravity, target, context.applied_array, ("ydot", count)),
            ("on rows", "(15)", "and on rows", of.on_rows(multipliers, target, True, Operator.SUB)),
            ("constraints", "(1)", "the constraints, or their derivatives", self._conditions(motion, of)),
        ]

    def _conditions(self, motion: TreeMotion, of: ConditionLoops) -> list[Statement]:
        m, first, ground = self.context.multipliers, self._multipliers, [Number(ZERO.value)] * 3
        if not m:
            return []
        if self.name == "index1":
            given = ("ydot", self.context.coordinates)
            result: list[Statement] = [*motion.work((CARRIED, 6)), *motion.at_ground(CARRIED, [ZERO] * 6)]
            result += [free_accelerations(motion, ground, given, CARRIED)] if motion.free else []
            result += [carried_accelerations(motion, given, CARRIED)] if motion.joints else []
            result.append(of.values("F", lambda c: c.bias, moving=True, biased=True, first=first))
            return [*result, *of.on_rows(given, ("F", first), False, Operator.ADD)]
        position = of.values("F", lambda c: c.position, moving=False, first=first + (m if self.name == "ggl" else 0))
        if self.name == "ggl":
            return [of.values("F", lambda c: c.rate, moving=True, first=first), position]
        return [position]

    def _corrected(self, motion: TreeMotion, of: ConditionLoops) -> list[Statement]:
        """The statements of v - G^T mu, from the leaves on."""
        mu = ("y", self._multipliers + self.context.multipliers)
        result: list[Statement] = [Work(CORRECTED, len(self.context.rows)), *motion.work((HELD, 6), cleared=True)]
        result += of.loads(mu, HELD)
        result += [self._of_joints(motion)] if motion.joints else []
        result += [self._of_free(motion)] if motion.free else []
        return [*result, *of.on_rows(mu, (CORRECTED, 0), True, Operator.SUB)]

    @staticmethod
    def _of_joints(motion: TreeMotion) -> ForEach:
        loop = motion.loop("corrected", motion.joints)
        here, before = loop.of_links(), loop.of_parents()
        f, n = loop.vector(HELD, here), loop.vector(HELD, here, first=3)
        joint = joint_axes(loop, here)
        value = motion.velocity(loop) + joint.along(f, n)
        loop.store(CORRECTED, motion.row(loop), value)
        loop.store_vector(HELD, before, joint.passed(f, n), operator=Operator.ADD)
        return loop.made(backward=True)

    @staticmethod
    def _of_free(motion: TreeMotion) -> ForEach:
        loop = motion.loop("free_corrected", motion.free)
        here = loop.of_links()
        f, n = loop.vector(HELD, here), loop.vector(HELD, here, first=3)
        Q = matrix(loop.vector(FRAME, here, 9))
        for k, value in enumerate([*f, *applied(transposed(Q), n)]):
            loop.store(CORRECTED, motion.row(loop, k), motion.velocity(loop, k) + value)
        return loop.made()
