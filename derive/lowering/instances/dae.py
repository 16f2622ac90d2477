"""The equations F(t, y, ydot) = 0 for implicit integrators, and their iteration matrices, body by body."""

from __future__ import annotations

from collections.abc import Iterator

import casadi as ca

from derive.ir.expressions import Element, Operator
from derive.ir.indices import constant
from derive.ir.model import Argument, Kernel
from derive.ir.patterns import pattern
from derive.ir.statements import Clear, Statement, StoreElement
from derive.lowering.flat.context import Input, array_input, stores
from derive.lowering.flat.dae import residual_rows, states
from derive.lowering.flat.schedule import Step
from derive.lowering.instances.class_code import ClassCode, Loaded
from derive.lowering.instances.classes import Member
from derive.lowering.instances.context import (
    GroupCode,
    InstanceContext,
    Result,
    given_inputs,
    kernel,
    known_value,
    loads,
    scatter,
    spread,
    whole,
)
from derive.lowering.model_functions import ModelFunction

PARTS = {"": ("position",), "ggl": ("rate", "position"), "index1": ("bias",)}
"""For each form the parts of the constraints that the blocks of F after the equations of motion contain."""


class DaeLayout:
    """The layout of y and F in one form: q, v and lambda, and in the stabilised form mu."""

    def __init__(self, context: InstanceContext, form: str) -> None:
        self.context, self.form = context, form
        self.coordinates, self.constraints = len(context.rows), len(context.multipliers)
        self.blocks = len(PARTS[form])
        self.size = 2 * self.coordinates + self.blocks * self.constraints

    def positions(self, of: ClassCode) -> list[list[int]]:
        """For each member of a class the indices in y, and in F, of its own elements in the order of its context."""
        n, result = len(of.context.rows), []
        for m in of.of.members:
            own = [m.coordinate + k for k in range(n)]
            first = 2 * self.coordinates
            result.append([*own, *(self.coordinates + i for i in own), *self._joints(of, m, first, self.blocks)])
        return result

    def parameter_rows(self, of: ClassCode) -> list[list[int]]:
        """For each member of a class the rows of its derivatives with respect to the parameters.

        They are its equations of motion, and g, gdot and G vdot - gamma of its joints.
        """
        own, first = range(len(of.context.rows)), self.coordinates
        return [[*(m.coordinate + k for k in own), *self._joints(of, m, first, 3)] for m in of.of.members]

    def _joints(self, of: ClassCode, member: Member, first: int, blocks: int) -> list[int]:
        """The indices of the constraints of a body in blocks of all constraints, which follow each other."""
        rows = [
            self.context.first_rows[handle.joint] + k
            for handle, numbers in zip(member.handles, of.rows, strict=True)
            for k in range(len(numbers))
        ]
        return [first + b * self.constraints + r for b in range(blocks) for r in rows]

    def reads(self, of: ClassCode, array: str, given: Input, what: str) -> Iterator[Loaded]:
        """The elements of an array of the size of y that one body has."""
        positions = self.positions(of)
        for k, symbol in enumerate(given.symbols):
            yield array, of.place(f"{what}_{k}", [own[k] for own in positions]), array_input(array, (symbol,), "")

    def velocities(self, group: GroupCode) -> list[list[int]]:
        """For each element of a group the indices in y of the velocities of its bodies."""
        return [[self.coordinates + k for k in own] for own in group.coordinates]

    def states(self, group: GroupCode) -> list[Loaded]:
        """Where the coordinates and the velocities of the bodies of a group are."""
        ctx, positions = group.code.context, zip(group.coordinates, self.velocities(group), strict=True)
        return loads(group.code, "y", array_input("y", ctx.state, ""), [[*q, *v] for q, v in positions])

    @property
    def arguments(self) -> dict[str, Argument]:
        """y and ydot."""
        blocks = "[q; v; lambda; mu]" if self.form == "ggl" else "[q; v; lambda]"
        return {
            "y": whole("y", self.size, f"state {blocks}"),
            "ydot": whole("ydot", self.size, "time derivative of y"),
            "cj": Argument("cj", (), "factor of dF/dydot", scalar=True),
        }


def residual(context: InstanceContext, function: ModelFunction) -> Kernel:
    """The kernel of F(t, y, ydot)."""
    form = DaeLayout(context, function.variant)
    body: list[Statement] = [Clear("F", form.size)]
    for b, part in enumerate(PARTS[form.form]):
        first = 2 * form.coordinates + b * form.constraints
        known = ((k, known_value(part, c)) for k, c in enumerate(context.conditions))
        body += [StoreElement(Element("F", constant(first + k)), value) for k, value in known if value is not None]
    for of in context.classes:
        y, ydot = states(of.context, form.form)
        symbols = of.context.symbols(of.context.t, of.given, y, ydot)
        rows = residual_rows(of.context, form.form, symbols)
        target = scatter(of, f"state_{form.form}", "F", form.positions(of), Operator.ADD)
        given = (*form.reads(of, "y", y, f"state_{form.form}"), *form.reads(of, "ydot", ydot, f"state_{form.form}"))
        body.append(of.loop(symbols, [Step(of.name, "", "", stores("F", rows))], given, {"F": target}))
    body += _between_bodies(context, form)
    text = "kinematics, equations of motion, constraints"
    results = {"F": Result(("in the order of y",), count=form.size)}
    return kernel(context, function, results, ("residual", "(15)", text, body), inputs=form.arguments)


def _between_bodies(context: InstanceContext, form: DaeLayout) -> list[Statement]:
    """The loops that add the forces between bodies to F."""
    result: list[Statement] = []
    for group in context.forces:
        code, ctx = group.code, group.code.context
        symbols = ctx.symbols(*given_inputs(code, "t", "q", "v"))
        items = stores("F", [symbols(ctx.equations.sum_of(row.name)) for row in ctx.equations.rows])
        target = spread(code, "F", form.velocities(group), Operator.ADD)
        result.append(code.loop(symbols, [Step(code.name, "(10)", "", items)], form.states(group), {"F": target}))
    return result


def jacobian(context: InstanceContext, function: ModelFunction) -> Kernel:
    """The kernel of the iteration matrix dF/dy + cj dF/dydot."""
    form = DaeLayout(context, function.variant)
    entries = {(i, i) for i in range(form.size)}
    local, between = [], []
    for of in context.classes:
        y, ydot = states(of.context, form.form)
        symbols = of.context.symbols(of.context.t, of.given, y, ydot, of.context.cj)
        rows = ca.vertcat(*residual_rows(of.context, form.form, symbols))
        by_y, by_ydot = (ca.jacobian(rows, ca.vertcat(*symbols.values_of(a.symbols))) for a in (y, ydot))
        (cj,) = symbols.values_of(of.context.cj.symbols)
        matrix = by_y + cj * by_ydot
        own = sorted(zip(*matrix.sparsity().get_triplet(), strict=True), key=lambda entry: (entry[1], entry[0]))
        positions = [[(at[i], at[j]) for i, j in own] for at in form.positions(of)]
        entries |= {entry for member in positions for entry in member}
        local.append((of, symbols, (y, ydot), [matrix[i, j] for i, j in own], positions))
    for group in context.forces:
        code, ctx = group.code, group.code.context
        symbols = ctx.symbols(*given_inputs(code, "t", "q", "v"))
        rows = ca.vertcat(*(symbols(ctx.equations.sum_of(row.name)) for row in ctx.equations.rows))
        matrix = ca.jacobian(rows, ca.vertcat(*symbols.values_of(ctx.q.symbols + ctx.v.symbols)))
        own = sorted(zip(*matrix.sparsity().get_triplet(), strict=True), key=lambda entry: (entry[1], entry[0]))
        positions = [
            [(form.coordinates + at[i], [*at, *(form.coordinates + k for k in at)][j]) for i, j in own]
            for at in group.coordinates
        ]
        entries |= {entry for member in positions for entry in member}
        between.append((group, symbols, [matrix[i, j] for i, j in own], positions))
    shape = pattern(form.size, form.size, entries)
    number = {entry: k for k, entry in enumerate(shape.entries)}
    body: list[Statement] = [Clear("jac", len(number))]
    for of, symbols, (y, ydot), values, positions in local:
        target = scatter(of, f"iteration_{form.form}", "jac", [[number[e] for e in m] for m in positions], None)
        given = (*form.reads(of, "y", y, f"state_{form.form}"), *form.reads(of, "ydot", ydot, f"state_{form.form}"))
        body.append(of.loop(symbols, [Step(of.name, "", "", stores("jac", values))], given, {"jac": target}))
    for group, symbols, values, positions in between:
        code, inputs = group.code, form.states(group)
        target = scatter(code, f"force_{form.form}", "jac", [[number[e] for e in m] for m in positions], Operator.ADD)
        body.append(code.loop(symbols, [Step(code.name, "", "", stores("jac", values))], inputs, {"jac": target}))
    results = {"jac": Result(pattern=shape)}
    text = "derivatives of the residual"
    return kernel(context, function, results, ("jacobian", "(15)", text, body), inputs=form.arguments)
