"""The outputs of a mechanism and their derivatives, in a loop over the elements of each group."""

from __future__ import annotations

from itertools import accumulate

import casadi as ca

from derive.ir.expressions import Element, Operator
from derive.ir.indices import constant
from derive.ir.kernel import Argument, Kernel
from derive.ir.patterns import pattern
from derive.ir.statements import Clear, Statement, StoreElement
from derive.lowering.flat.context import Context, Input, stores
from derive.lowering.flat.schedule import Step
from derive.lowering.instances.loop_code.class_code import Loaded
from derive.lowering.instances.loop_code.context import InstanceContext, given_inputs, scatter
from derive.lowering.instances.loop_code.group_code import GroupCode, loads, spread
from derive.lowering.instances.loop_code.kernels import ZERO, Result, kernel, whole
from derive.lowering.model_functions import ModelFunction


def outputs(context: InstanceContext, function: ModelFunction) -> Kernel:
    """The kernel of the outputs."""
    body: list[Statement] = [
        StoreElement(Element("out", constant(first + k)), ZERO) for first, count in context.sums for k in range(count)
    ]
    for group in context.outputs:
        code, ctx = group.code, group.code.context
        symbols = ctx.symbols(*given_inputs(code, "t", "q", "v"), ctx.vdot, ctx.lam)
        values = [symbols(output.expr) for output in ctx.equations.outputs]
        kept = [k for k, value in enumerate(values) if not (group.adds and value.is_zero())]
        items = stores("out", [values[k] for k in kept])
        components = [[own[k] for k in kept] for own in _components(group)]
        target = spread(code, "out", components, _operator(group))
        if items:
            body.append(code.loop(symbols, [Step(code.name, "", "", items)], _reads(context, group), {"out": target}))
    results = {"out": Result(("output by output",), count=len(context.output_components))}
    text = "outputs in groups that have one code"
    return kernel(context, function, results, ("outputs", "", text, body), inputs=_arguments(context))


def outputs_jacobian(context: InstanceContext, function: ModelFunction) -> Kernel:
    """The kernel of the derivatives of the outputs with respect to q, v, vdot, lambda and u."""
    sizes = [
        context.coordinates,
        *[len(context.rows)] * 2,
        len(context.multipliers),
        len(context.known.context.u.symbols),
    ]
    firsts = [0, *accumulate(sizes)]
    entries, parts = set[tuple[int, int]](), []
    for group in context.outputs:
        code, ctx = group.code, group.code.context
        known = context.known.derivatives_of(code.given.symbols)
        symbols = ctx.symbols(*given_inputs(code, "t", "q", "v"), known, ctx.vdot, ctx.lam)
        values = ca.vertcat(*(symbols(output.expr) for output in ctx.equations.outputs))
        columns = [symbol for argument in _differentiated(ctx) for symbol in argument.symbols]
        matrix = ca.jacobian(values, ca.vertcat(*symbols.values_of(columns)))
        first_input = len(columns) - len(ctx.u.symbols)
        for symbol in code.given.symbols:  # inputs act through what is known as well
            slope = ca.jacobian(values, symbols.values[symbol])
            for j, derivative in context.known.by_inputs(symbol):
                matrix[:, first_input + j] += slope * symbols.values[derivative]
        own = sorted(zip(*matrix.sparsity().get_triplet(), strict=True), key=lambda entry: (entry[1], entry[0]))
        positions = []
        for rows, at, of_v, lam in zip(
            _components(group), group.coordinates, group.rows, group.reactions(context.first_rows), strict=True
        ):
            places = [*at, *(first + k for first in firsts[1:3] for k in of_v)]
            places += [*(firsts[3] + k for k in lam), *range(firsts[4], firsts[5])]
            positions.append([(rows[i], places[j]) for i, j in own])
        entries |= {entry for member in positions for entry in member}
        parts.append((group, symbols, [matrix[i, j] for i, j in own], positions))
    shape = pattern(len(context.output_components), firsts[-1], entries)
    number = {entry: k for k, entry in enumerate(shape.entries)}
    body: list[Statement] = [Clear("jac", len(entries))] if context.sums else []
    for group, symbols, derivatives, positions in parts:
        code = group.code
        target = scatter(code, "derivative", "jac", [[number[e] for e in m] for m in positions], _operator(group))
        step = Step(code.name, "", "", stores("jac", derivatives))
        if derivatives:
            body.append(code.loop(symbols, [step], _reads(context, group), {"jac": target}))
    results = {"jac": Result(pattern=shape)}
    text = "derivatives of the outputs"
    return kernel(context, function, results, ("jacobian", "", text, body), inputs=_arguments(context))


def _differentiated(ctx: Context) -> tuple[Input, ...]:
    """The arguments with respect to which outputs are differentiated."""
    return ctx.q, ctx.v, ctx.vdot, ctx.lam, ctx.u


def _operator(group: GroupCode) -> Operator | None:
    """The operator with which the elements of a group are added to an output, if they are parts of a sum."""
    return Operator.ADD if group.adds else None


def _components(group: GroupCode) -> list[list[int]]:
    """The indices of the components of the output of each element of a group."""
    count = len(group.code.context.equations.outputs)
    return [[element.first + k for k in range(count)] for element in group.elements]


def _reads(context: InstanceContext, group: GroupCode) -> list[Loaded]:
    """The places of the state, the accelerations and the reactions of the bodies of an output."""
    code, ctx = group.code, group.code.context
    named = (("q", ctx.q, group.coordinates), ("v", ctx.v, group.rows), ("vdot", ctx.vdot, group.rows))
    states = (entry for of in named for entry in loads(code, *of))
    return [*states, *loads(code, "lam", ctx.lam, group.reactions(context.first_rows))]


def _arguments(context: InstanceContext) -> dict[str, Argument]:
    return {
        "vdot": whole("vdot", len(context.rows), "accelerations, as from solve"),
        "lam": whole("lam", len(context.multipliers), "constraint reactions on body 2 of each joint, as from solve"),
    }
