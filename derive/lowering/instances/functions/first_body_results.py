"""Accelerations and reactions in the inertial frame, from those along the axes of bodies."""

from __future__ import annotations

from collections.abc import Iterator

import casadi as ca

from derive.ir.statements import Statement
from derive.lowering.flat.accelerations import balanced
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import array_input, stores
from derive.lowering.flat.schedule import Step
from derive.lowering.instances.elimination.block_system import FORCE, Blocks
from derive.lowering.instances.functions.body_motions import BodyMotions
from derive.lowering.instances.loop_code.class_code import ClassCode
from derive.lowering.instances.loop_code.context import InstanceContext, given_inputs
from derive.mechanics.multibody.space.first_body_rows import row_reactions


def inertial_translation(of: ClassCode, symbols: Symbols, unknowns: list[ca.SX]) -> list[ca.SX]:
    """The unknowns of a body with its translation in the inertial frame."""
    if of.axes is None:
        return unknowns
    along = unknowns[: of.axes.cols]
    turned = [
        balanced([symbols(factor) * value for factor, value in zip(row, along, strict=True)])
        for row in of.axes.tolist()
    ]
    return [*turned, *unknowns[of.axes.cols :]]


def reactions_of_joints(context: InstanceContext, system: Blocks) -> Iterator[Statement]:
    """Yield the loops over joints that write their multipliers in the order of the constraints."""
    for group in context.joints_in_lanes:
        code = group.code
        own = array_input(FORCE, row_reactions()[: len(group.multipliers)], "")
        motions = BodyMotions(context).of_joint(group)
        symbols = code.context.symbols(*given_inputs(code), *(given for _, _, given in motions), own)
        items = stores("lam", [symbols(reaction) for reaction in group.multipliers])
        place = code.place("reaction", [system.position[joint] for joint in group.joints], system.spacing)
        to = code.place("multiplier", [context.first_rows[joint] for joint in group.joints])
        inputs = [*motions, (FORCE, place, own)]
        step = Step(code.name, "", "", items)
        yield code.loop(symbols, [step], inputs, {"lam": code.target("lam", to)}, True)
