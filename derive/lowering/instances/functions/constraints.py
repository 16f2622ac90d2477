"""Constraints, their time derivatives, Jacobian and bias: sums over the bodies that a joint connects."""

from __future__ import annotations

from collections.abc import Iterator

from derive.ir.expressions import Element, Operator
from derive.ir.indices import constant
from derive.ir.kernel import Kernel
from derive.ir.patterns import Pattern, pattern
from derive.ir.statements import Clear, Statement, StoreElement
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import stores
from derive.lowering.flat.kkt_matrix import jacobian_entries, jacobian_pattern
from derive.lowering.flat.schedule import Step, StepItem
from derive.lowering.instances.loop_code.class_code import ClassCode, LoopTarget
from derive.lowering.instances.loop_code.context import (
    InstanceContext,
    given_inputs,
    known_value,
    loops_of,
    merged,
    scatter,
)
from derive.lowering.instances.loop_code.group_code import JointCode, spread
from derive.lowering.instances.loop_code.kernels import Result, kernel
from derive.lowering.model_functions import ModelFunction


def _constraint_sums(
    context: InstanceContext, output: str, part: str, *names: str, bias_sign: int = 1
) -> list[Statement]:
    """An output with an element for each constraint: what is known, then what each body adds."""
    known = ((k, known_value(part, c, bias_sign)) for k, c in enumerate(context.conditions))
    given = [StoreElement(Element(output, constant(k)), value) for k, value in known if value is not None]

    def items(of: ClassCode, symbols: Symbols) -> tuple[list[StepItem], dict[str, LoopTarget]]:
        values = [bias_sign * symbols(getattr(c, part)) for c in of.context.equations.constraints]
        return [*stores(output, values)], {output: merged(of, output, context.rows_of(of), Operator.ADD)}

    loops = [*loops_of(context, items, *names), *_varying_sums(context, output, part, names, bias_sign)]
    count = len(context.multipliers)
    return [Clear(output, count), *given, *loops] if count else []


def _varying_sums(
    context: InstanceContext, output: str, part: str, names: tuple[str, ...], sign: int
) -> Iterator[Statement]:
    """The loops over varying joints, whose constraints are known but for the motion of a drive."""
    for group in context.joints:
        code, ctx = group.code, group.code.context
        symbols = ctx.symbols(*given_inputs(code, *names))
        items = stores(output, [sign * symbols(getattr(c, part)) for c in ctx.equations.constraints])
        target = spread(code, output, group.own_rows(context.first_rows), Operator.ADD)
        yield code.loop(symbols, [Step(code.name, "(1)", "", items)], group.state(*names), {output: target})


def constraints(context: InstanceContext, function: ModelFunction) -> Kernel:
    """The kernel of the constraints g(t, q)."""
    body = _constraint_sums(context, "g", "position", "t", "q")
    return kernel(
        context,
        function,
        {"g": Result(("joint by joint",), count=len(context.multipliers))},
        ("g", "(1)", "points of body 2 minus points of body 1", body),
    )


def constraint_rates(context: InstanceContext, function: ModelFunction) -> Kernel:
    """The kernel of the time derivatives gdot = G v + dg/dt of the constraints."""
    body = _constraint_sums(context, "gdot", "rate", "t", "q", "v")
    return kernel(
        context,
        function,
        {"gdot": Result(("joint by joint",), count=len(context.multipliers))},
        ("gdot", "(1)", "velocities of body 2 minus those of body 1", body),
    )


def constraint_bias(context: InstanceContext, function: ModelFunction) -> Kernel:
    """The kernel of the right-hand side gamma of the constraints on accelerations, G vdot = gamma."""
    body = _constraint_sums(context, "gamma", "bias", "t", "q", "v", bias_sign=-1)
    return kernel(
        context,
        function,
        {"gamma": Result(("joint by joint",), count=len(context.multipliers))},
        ("gamma", "(5)", "centrifugal and Coriolis parts", body),
    )


def constraint_pattern(context: InstanceContext) -> Pattern:
    """The pattern of G."""
    entries = {entry for of in context.classes for own in _jacobian_positions(context, of) for entry in own}
    entries |= {entry for group in context.joints for own in _varying_positions(context, group) for entry in own}
    return pattern(len(context.multipliers), len(context.rows), entries)


def _jacobian_positions(context: InstanceContext, of: ClassCode) -> list[list[tuple[int, int]]]:
    """The rows and columns in G of the entries of each member of a class."""
    local_rows = [(h, k) for h, rows in enumerate(of.rows) for k in range(len(rows))]
    result = []
    for m in of.of.members:
        firsts = [context.first_rows[handle.joint] for handle in m.handles]
        result.append(
            [(firsts[local_rows[i][0]] + local_rows[i][1], m.row + j) for i, j in jacobian_pattern(of.context).entries]
        )
    return result


def _varying_positions(context: InstanceContext, group: JointCode) -> list[list[tuple[int, int]]]:
    """The rows and columns in G of the entries of each varying joint of a group."""
    entries = jacobian_pattern(group.code.context).entries
    of_joints = zip(group.own_rows(context.first_rows), group.rows, strict=True)
    return [[(rows[i], columns[j]) for i, j in entries] for rows, columns in of_joints]


def constraint_jacobian(context: InstanceContext, function: ModelFunction) -> Kernel:
    """The kernel of the constraint Jacobian G(t, q) = d gdot / dv."""
    shape = constraint_pattern(context)
    number = {entry: k for k, entry in enumerate(shape.entries)}

    def items(of: ClassCode, symbols: Symbols) -> tuple[list[StepItem], dict[str, LoopTarget]]:
        values = jacobian_entries(of.context, symbols)
        positions = [[number[entry] for entry in own] for own in _jacobian_positions(context, of)]
        target = scatter(of, "jacobian", "G", positions, None)
        return [*stores("G", [values[entry] for entry in jacobian_pattern(of.context).entries])], {"G": target}

    loops = loops_of(context, items, "q")
    for group in context.joints:
        code, ctx = group.code, group.code.context
        symbols = ctx.symbols(*given_inputs(code, "t", "q"))
        values = jacobian_entries(ctx, symbols)
        positions = [[number[entry] for entry in own] for own in _varying_positions(context, group)]
        target = scatter(code, "jacobian", "G", positions, None)
        step = Step(code.name, "(6)", "", stores("G", [values[entry] for entry in jacobian_pattern(ctx).entries]))
        loops.append(code.loop(symbols, [step], group.state("t", "q"), {"G": target}))
    return kernel(
        context,
        function,
        {"G": Result(pattern=shape)},
        ("G", "(6)", "factors of the generalised velocities", loops),
    )
