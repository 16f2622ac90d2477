"""The factors in G that depend on both bodies of a joint, which the system of the joints computes before the bodies."""

from __future__ import annotations

from collections.abc import Iterator

import casadi as ca

from derive.algebra import sp
from derive.ir.expressions import Element, Operator
from derive.ir.indices import constant
from derive.ir.statements import Statement, StoreElement, Work
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import Context, array_input, stores
from derive.lowering.flat.kkt_matrix import jacobian_entries
from derive.lowering.flat.schedule import Step, StepItem
from derive.lowering.instances.classes.body_classes import NO_JOINT
from derive.lowering.instances.classes.gears import constraining
from derive.lowering.instances.classes.mode_factors import constants_of_modes, mode_coefficients
from derive.lowering.instances.elimination.block_system import KNOWN, ZERO, Blocks, spaced
from derive.lowering.instances.functions.body_motions import BodyMotions
from derive.lowering.instances.loop_code.class_code import ClassCode, Loaded, LoopTarget
from derive.lowering.instances.loop_code.context import InstanceContext, given_inputs
from derive.lowering.instances.loop_code.ground_at_rest import JointsWithGround
from derive.lowering.instances.loop_code.group_code import JointCode
from derive.mechanics.symbols import Identity

FACTORS = ("first_factor", "second_factor", "third_factor", "fourth_factor")
"""The local arrays of the factors of the first and of the second body of each joint, and of further ones of gears."""


def _coefficients(context: Context, columns: range) -> dict[int, dict[Identity, sp.Expr]]:
    """The coefficients of the constants of modes in each constraint of a joint; columns: those of their body."""
    constants = constants_of_modes(c.symbol for c in context.equations.coefficients)
    own = {context.rows[j]: j for j in columns}
    result = {}
    for k, condition in enumerate(context.equations.constraints):
        factors = {own[row]: f for row, f in condition.jacobian if row in own and f.free_symbols & constants.keys()}
        result[k] = mode_coefficients(factors, constants) or {}
    return result


class VaryingFactors:
    """The arrays of the factors of all varying joints, one of these after the other in each component."""

    def __init__(self, context: InstanceContext, in_lanes: bool) -> None:
        self.context, self.groups = context, context.joints_in_lanes if in_lanes else context.joints
        joints = [joint for group in self.groups for joint in group.joints]
        self.has_spare = bool(joints) and any(of.of.is_joined for of in context.classes_in_lanes)
        self.number = {joint: n for n, joint in enumerate([*joints, *([NO_JOINT] if self.has_spare else [])])}
        self.spacing = spaced(len(self.number))

    def works(self) -> Iterator[Statement]:
        """The arrays of factors, one for each side of the joints that has any, with zeros where there is no joint."""
        for side, array in enumerate(FACTORS):
            count = max((len(group.factors.get(side, ())) for group in self.groups), default=0)
            if count:
                yield Work(array, count * self.spacing, spacing=self.spacing)
            for k in range(count if self.has_spare else 0):
                yield StoreElement(Element(array, constant(k * self.spacing + self.number[NO_JOINT])), ZERO)

    def loops(self, system: Blocks, names: tuple[str, ...], has_bias: bool, in_lanes: bool) -> Iterator[Statement]:
        """The loop over the joints of each group, after what it reads.

        has_bias: whether it writes gamma as well, to what is known.
        """
        context = self.context
        for group in self.groups:
            code, ctx = group.code, group.code.context
            if group.turned:
                read = BodyMotions(context).of_joint(group)
                symbols = ctx.symbols(*given_inputs(code), *(given for _, _, given in read))
            else:
                read, symbols = group.state(*names), ctx.symbols(*given_inputs(code, *names))
                if isinstance(group, JointsWithGround):
                    sizes = {"q": context.coordinates, "v": len(context.rows)}
                    yield from group.copies((name, sizes[name]) for name in names if name in sizes)
            entries = jacobian_entries(ctx, symbols)
            items: list[StepItem] = []
            targets: dict[str, LoopTarget] = {}
            place = code.place("factor", [self.number[joint] for joint in group.joints], self.spacing)
            for side, factors in group.factors.items():
                columns = group.bodies[side]
                of_modes = _coefficients(ctx, columns) if any(isinstance(what, Identity) for _, what in factors) else {}
                values = []
                for k, what in factors:
                    if (k, what) in group.turned:
                        values.append(symbols(group.turned[k, what]))
                    elif isinstance(what, int):
                        values.append(entries.get((k, columns[what]), ca.SX(0)))
                    else:
                        values.append(symbols(of_modes[k].get(what, sp.S.Zero)))
                items += stores(FACTORS[side], values)
                targets[FACTORS[side]] = code.target(FACTORS[side], place)
            if has_bias:
                more, targets[KNOWN] = self._bias(system, group, symbols)
                items += more
            step = Step(code.name, "(6)", "", tuple(items))
            yield code.loop(symbols, [step], read, targets, in_lanes)

    def _bias(self, system: Blocks, group: JointCode, symbols: Symbols) -> tuple[tuple[StepItem, ...], LoopTarget]:
        """The items that write gamma of the joints of a group, which is added to that of their drives."""
        constraints = group.code.context.equations.constraints
        rows = [k for k, condition in enumerate(constraints) if condition.bias != 0]
        is_driven = constraining(self.context.mechanism)[group.joints[0]].drive is not None
        place = group.code.place("bias", [system.position[joint] for joint in group.joints], system.spacing)
        index = [place.at(k) for k in rows]
        target = LoopTarget(KNOWN, index.__getitem__, Operator.ADD if is_driven else None, place.entries)
        return stores(KNOWN, [-symbols(constraints[k].bias) for k in rows]), target

    def reads(self, of: ClassCode) -> list[Loaded]:
        """The places of the factors that a body of a class reads."""
        result = []
        for h, part in of.varying.items():
            handles = [m.handles[h] for m in of.of.members]
            place = of.place(f"factor_{h}", [self.number[handle.joint] for handle in handles], self.spacing)
            array = FACTORS[handles[0].side]
            result.append((array, place, array_input(array, part.factors.values(), "")))
        return result
