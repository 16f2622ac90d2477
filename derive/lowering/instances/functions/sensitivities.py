"""Derivatives with respect to parameters and inputs, in loops over the bodies of each class and the elements of groups.

The rows of a body are its equations of motion, and what it contributes to g, gdot and G vdot - gamma of its joints. A
parameter acts through the constants of the class, as in straight-line code, and through what is known, whose
derivatives are computed before the loops.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import casadi as ca

from derive.ir.expressions import Element, Operator, ScalarRef
from derive.ir.indices import constant
from derive.ir.kernel import Kernel
from derive.ir.patterns import pattern
from derive.ir.statements import Clear, Statement, StoreElement
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import Input, array_input, stores
from derive.lowering.flat.dae import states
from derive.lowering.flat.schedule import Step
from derive.lowering.flat.sensitivities import by_parameters_and_inputs, dynamic_rows
from derive.lowering.instances.classes.known_motion import PARTS, known_symbol
from derive.lowering.instances.functions.dae import DaeLayout
from derive.lowering.instances.loop_code.class_code import Loaded, LoopCode
from derive.lowering.instances.loop_code.context import InstanceContext, scatter
from derive.lowering.instances.loop_code.group_code import GroupCode, loads
from derive.lowering.instances.loop_code.kernels import Result, kernel
from derive.lowering.model_functions import ModelFunction


@dataclass(frozen=True)
class _Rows:
    """The rows of a class or a group.

    inputs: where the loop finds what they depend on; derivatives: besides zeros; entries: for each member the places of
    these in the matrix, as rows and columns.
    """

    code: LoopCode
    symbols: Symbols
    inputs: list[Loaded]
    derivatives: list[ca.SX]
    entries: list[list[tuple[int, int]]]


def parameter_jacobian(context: InstanceContext, function: ModelFunction) -> Kernel:
    """The kernel of the derivatives with respect to the parameters and the inputs."""
    form = DaeLayout(context, "index1")
    every = [rows for rows in _of_all(context, form) if rows.derivatives]
    known = list(_of_known(context))
    first = form.rows + 3 * form.constraints
    columns = len(context.mechanism.parameters) + len(context.known.context.u.symbols)
    entries = {entry for rows in every for member in rows.entries for entry in member}
    shape = pattern(first + len(context.output_components), columns, entries | {entry for entry, _ in known})
    number = {entry: k for k, entry in enumerate(shape.entries)}
    body: list[Statement] = [Clear("jac", len(number))] if number else []
    body += [StoreElement(Element("jac", constant(number[entry])), ScalarRef(name)) for entry, name in known]
    for rows in every:
        numbers = [[number[entry] for entry in member] for member in rows.entries]
        target = scatter(rows.code, "parameters", "jac", numbers, Operator.ADD)
        step = Step(rows.code.name, "", "", stores("jac", rows.derivatives))
        body.append(rows.code.loop(rows.symbols, [step], rows.inputs, {"jac": target}))
    text = "derivatives of the rows by parameters and inputs"
    section = ("parameter_jacobian", "(15)", text, body)
    return kernel(context, function, {"jac": Result(pattern=shape)}, section, inputs=form.arguments)


def _of_all(context: InstanceContext, form: DaeLayout) -> Iterator[_Rows]:
    """The rows of all bodies, of the forces between bodies, and of the outputs."""
    for of in context.classes:
        y, ydot = states(of.context, "index1")
        inputs = [*form.reads(of, "y", y), *form.reads(of, "ydot", ydot)]
        symbols = _symbols(context, of, y, ydot)
        rows = [*dynamic_rows(of.context, symbols).values()]
        yield _derivatives(context, of, symbols, rows, inputs, form.parameter_rows(of))
    for group in context.forces:
        ctx = group.code.context
        symbols = _symbols(context, group.code, ctx.q, ctx.v)
        rows = [*dynamic_rows(ctx, symbols).values()]
        yield _derivatives(context, group.code, symbols, rows, form.states_of(group), group.rows)
    for joints in context.joints:
        ctx = joints.code.context
        y, ydot = states(ctx, "index1")
        symbols = _symbols(context, joints.code, y, ydot)
        rows = [*dynamic_rows(ctx, symbols).values()]
        inputs = form.joint_reads(joints, y, ydot)
        yield _derivatives(context, joints.code, symbols, rows, inputs, form.joint_parameter_rows(joints))
    first = form.rows + 3 * form.constraints
    for group in context.outputs:
        ctx = group.code.context
        symbols = _symbols(context, group.code, ctx.q, ctx.v, ctx.vdot, ctx.lam)
        rows = [symbols(output.expr) for output in ctx.equations.outputs]
        at = [[first + element.first + k for k in range(len(rows))] for element in group.elements]
        yield _derivatives(context, group.code, symbols, rows, _reads(context, form, group), at)


def _symbols(context: InstanceContext, code: LoopCode, *inputs: Input) -> Symbols:
    """The symbols of a class or a group, with the derivatives of what is known."""
    known = context.known.derivatives_of(code.given.symbols)
    return code.context.symbols(code.context.t, code.given, known, *inputs)


def _derivatives(
    context: InstanceContext,
    code: LoopCode,
    symbols: Symbols,
    rows: list[ca.SX],
    inputs: list[Loaded],
    places: list[list[int]],
) -> _Rows:
    """The derivatives of rows; places: for each member the rows in the matrix."""
    matrix = by_parameters_and_inputs(code.context, symbols, rows)
    values = ca.vertcat(*rows)
    for symbol in code.given.symbols:
        slope = ca.jacobian(values, symbols.values[symbol])
        for column, derivative in context.known.derivatives.columns.get(symbol, {}).items():
            matrix[:, column] += slope * symbols.values[derivative]
    own = sorted(zip(*matrix.sparsity().get_triplet(), strict=True), key=lambda entry: (entry[1], entry[0]))
    entries = [[(at[i], j) for i, j in own] for at in places]
    return _Rows(code, symbols, inputs, [matrix[i, j] for i, j in own], entries)


def _of_known(context: InstanceContext) -> Iterator[tuple[tuple[int, int], str]]:
    """The places and the names of the derivatives of what is known of the constraints."""
    first, count = len(context.rows), len(context.multipliers)
    for b, part in enumerate(PARTS):
        for k, condition in enumerate(context.conditions):
            columns = context.known.derivatives.columns.get(known_symbol(part, condition), {})
            yield from (((first + b * count + k, j), str(name)) for j, name in columns.items())


def _reads(context: InstanceContext, form: DaeLayout, group: GroupCode) -> list[Loaded]:
    """The places in y and ydot of the state, the accelerations and the reactions of the bodies of an output."""
    code, ctx, velocities = group.code, group.code.context, form.velocities(group)
    reactions = [[form.states + k for k in own] for own in group.reactions(context.first_rows)]
    positions = [[*a, *b, *c] for a, b, c in zip(group.coordinates, velocities, reactions, strict=True)]
    y = array_input("y", (*ctx.state, *ctx.lam.symbols), "")
    return [*loads(code, "y", y, positions), *loads(code, "ydot", ctx.vdot, velocities)]
