"""Systems of bodies and joints whose right-hand sides are arguments: projections, and solutions with the KKT matrix."""

from __future__ import annotations

from derive.algebra import sp
from derive.ir.expressions import Element
from derive.ir.indices import constant
from derive.ir.kernel import Kernel
from derive.ir.statements import ForEach, Statement, StoreElement
from derive.lowering.flat.context import array_input
from derive.lowering.instances.elimination.block_system import KNOWN, RIGHT
from derive.lowering.instances.functions.accelerations import by_joint, entries_of, solved
from derive.lowering.instances.functions.local_system import Right
from derive.lowering.instances.loop_code.class_code import INSTANCE, ClassCode
from derive.lowering.instances.loop_code.context import InstanceContext
from derive.lowering.instances.loop_code.kernels import Result, whole
from derive.lowering.model_functions import ModelFunction
from derive.mechanics.symbols import local


def project_velocity(context: InstanceContext, function: ModelFunction) -> Kernel:
    """The kernel of the smallest dv, in the metric of M, with G dv = r."""

    def nothing(_: InstanceContext, of: ClassCode) -> Right:
        return Right([sp.S.Zero for _ in of.context.rows], [sp.S.Zero for _ in of.system.multipliers])

    argument = whole("r", len(context.multipliers), "prescribed change of gdot")
    results = {"dv": Result(("body by body",), count=len(context.rows))}
    given = _given_right(context, RIGHT[0], "r")
    return solved(
        context, function, results, nothing, ("t", "q"), "dv", given, {"r": argument}, in_lanes=False, alone=True
    )


def solve_kkt(context: InstanceContext, function: ModelFunction) -> Kernel:
    """The kernel that solves M x - G^T lambda = a, G x = b."""

    def prescribed(_: InstanceContext, of: ClassCode) -> Right:
        a = array_input("a", (local(f"a_{name}") for name in of.context.rows), "")
        return Right([*a.symbols], [sp.S.Zero for _ in of.system.multipliers], (("a", of.row, a),))

    inputs = {
        "a": whole("a", len(context.rows), "right-hand side of the equations of motion"),
        "b": whole("b", len(context.multipliers), "right-hand side of the constraints"),
    }
    results = {
        "x": Result(("body by body",), count=len(context.rows)),
        "lam": Result(("joint by joint",), count=len(context.multipliers)),
    }
    given = _given_right(context, KNOWN, "b")
    return solved(context, function, results, prescribed, ("t", "q"), "x", given, inputs, in_lanes=False)


def _given_right(context: InstanceContext, to_array: str, array: str) -> list[Statement]:
    """The right-hand sides of the joints from an argument with an element for each constraint."""
    result: list[Statement] = []
    if context.blocks:
        for rows, count, to, of in by_joint(context, context.blocks):
            body = [StoreElement(Element(to_array, of.at(k)), Element(array, to.at(k))) for k in range(rows)]
            result.append(ForEach(INSTANCE, constant(0), constant(count), (*entries_of(to), *entries_of(of), *body)))
    return result
