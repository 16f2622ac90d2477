"""The equations F(t, y, ydot) = 0 for implicit integrators, and their iteration matrices, body by body."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import casadi as ca

from derive.ir.expressions import Element, Operator
from derive.ir.indices import ElementIndex, constant
from derive.ir.kernel import Argument, Kernel
from derive.ir.patterns import pattern
from derive.ir.statements import Clear, Statement, StoreElement
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import Input, array_input, stores
from derive.lowering.flat.dae import residual_rows, stabilising_rows, states
from derive.lowering.flat.schedule import Step
from derive.lowering.instances.classes.body_classes import Member
from derive.lowering.instances.loop_code.class_code import ClassCode, Loaded, LoopTarget
from derive.lowering.instances.loop_code.context import InstanceContext, given_inputs, known_value, scatter
from derive.lowering.instances.loop_code.group_code import GroupCode, JointCode, loads, spread
from derive.lowering.instances.loop_code.kernels import ZERO, Result, kernel, whole
from derive.lowering.model_functions import ModelFunction
from derive.mechanics.symbols import local

PARTS = {"": ("position",), "ggl": ("rate", "position"), "index1": ("bias",)}
"""For each form the parts of the constraints that the blocks of F after the equations of motion contain."""

FEW = 16
"""The elements that are set to zero one by one."""


class DaeLayout:
    """The layout of y and F in one form: q, v and lambda, and in the stabilised form mu."""

    def __init__(self, context: InstanceContext, form: str) -> None:
        self.context, self.form = context, form
        self.coordinates, self.rows = context.coordinates, len(context.rows)
        self.constraints, self.blocks = len(context.multipliers), len(PARTS[form])
        self.states = self.coordinates + self.rows
        self.size = self.states + self.blocks * self.constraints

    def positions(self, of: ClassCode) -> list[list[int]]:
        """The indices in y, and in F, of the elements of each member of a class, in the order of its context."""
        coordinates, rows = (range(len(given.symbols)) for given in (of.context.q, of.context.v))
        return [
            [
                *(m.coordinate + k for k in coordinates),
                *(self.coordinates + m.row + k for k in rows),
                *self._joints(of, m, self.states, self.blocks),
            ]
            for m in of.of.members
        ]

    def parameter_rows(self, of: ClassCode) -> list[list[int]]:
        """The rows of the derivatives of each member of a class with respect to the parameters.

        They are its equations of motion, and g, gdot and G vdot - gamma of its joints.
        """
        own = range(len(of.context.rows))
        return [[*(m.row + k for k in own), *self._joints(of, m, self.rows, 3)] for m in of.of.members]

    def _joints(self, of: ClassCode, member: Member, first: int, blocks: int) -> list[int]:
        """The indices of the constraints of a body in blocks of all constraints, which follow each other."""
        rows = [
            self.context.first_rows[handle.joint] + k
            for handle, numbers in zip(member.handles, of.rows, strict=True)
            for k in range(len(numbers))
        ]
        return [first + b * self.constraints + r for b in range(blocks) for r in rows]

    def reads(self, of: ClassCode, array: str, given: Input) -> Iterator[Loaded]:
        """The elements of an array of the size of y that one body has, in all forms at the same places."""
        positions = self.positions(of)
        for k, symbol in enumerate(given.symbols):
            yield array, of.place(f"state_{k}", [own[k] for own in positions]), array_input(array, (symbol,), "")

    def velocities(self, group: GroupCode) -> list[list[int]]:
        """The indices in y of the velocities of the bodies of each element of a group."""
        return [[self.coordinates + k for k in own] for own in group.rows]

    def joint_positions(self, group: JointCode) -> list[list[int]]:
        """The indices in y, and in F, of the elements in the equations of each varying joint of a group."""
        of_bodies = zip(group.coordinates, self.velocities(group), strict=True)
        return self._of_joints(group, [[*q, *v] for q, v in of_bodies], self.states, self.blocks)

    def joint_parameter_rows(self, group: JointCode) -> list[list[int]]:
        """The rows of the derivatives of each varying joint of a group with respect to the parameters."""
        return self._of_joints(group, group.rows, self.rows, 3)

    def _of_joints(self, group: JointCode, of_bodies: list[list[int]], first: int, blocks: int) -> list[list[int]]:
        """The indices of the bodies of each joint, then those of its constraints in blocks of all from `first` on."""
        of_joints = zip(of_bodies, group.own_rows(self.context.first_rows), strict=True)
        return [
            [*own, *(first + b * self.constraints + r for b in range(blocks) for r in rows)] for own, rows in of_joints
        ]

    def joint_reads(self, group: JointCode, y: Input, ydot: Input) -> list[Loaded]:
        """The places of the elements of y and ydot in the equations of the varying joints of a group."""
        positions = self.joint_positions(group)
        return [*loads(group.code, "y", y, positions), *loads(group.code, "ydot", ydot, positions)]

    def states_of(self, group: GroupCode) -> list[Loaded]:
        """The places of the coordinates and the velocities of the bodies of a group."""
        ctx, positions = group.code.context, zip(group.coordinates, self.velocities(group), strict=True)
        return loads(group.code, "y", array_input("y", ctx.state, ""), [[*q, *v] for q, v in positions])

    @property
    def arguments(self) -> dict[str, Argument]:
        """The arguments of a DAE function: y, ydot and the factor cj."""
        blocks = "[q; v; lambda; mu]" if self.form == "ggl" else "[q; v; lambda]"
        return {
            "y": whole("y", self.size, f"state {blocks}"),
            "ydot": whole("ydot", self.size, "time derivative of y"),
            "cj": Argument("cj", (), "factor of dF/dydot", scalar=True),
        }


def residual(context: InstanceContext, function: ModelFunction) -> Kernel:
    """The kernel of F(t, y, ydot)."""
    form = DaeLayout(context, function.variant)
    both, joints = form.states, form.size - form.states
    body: list[Statement] = [Clear("F", joints, both)] if joints else []
    for b, part in enumerate(PARTS[form.form]):
        first = both + b * form.constraints
        known = ((k, known_value(part, c)) for k, c in enumerate(context.conditions))
        body += [StoreElement(Element("F", constant(first + k)), value) for k, value in known if value is not None]
    for of in context.classes:
        y, ydot = states(of.context, form.form)
        symbols = of.context.symbols(of.context.t, of.given, y, ydot)
        rows = residual_rows(of.context, form.form, symbols, stabilised=False)
        more = stabilising_rows(of.context, symbols) if form.form == "ggl" else []
        target, own = scatter(of, "state", "F", form.positions(of), None), len(of.context.state)
        added = replace(target, operator=Operator.ADD)
        shared = replace(added, index=partial(_behind, target, own))
        items = (*stores("own", rows[:own]), *stores("added", more), *stores("shared", rows[own:]))
        given = (*form.reads(of, "y", y), *form.reads(of, "ydot", ydot))
        targets = {"own": target, "added": added, "shared": shared}
        body.append(of.loop(symbols, [Step(of.name, "", "", items)], given, targets))
    body += _between_bodies(context, form)
    body += _of_varying_joints(context, form)
    text = "kinematics, equations of motion, constraints"
    results = {"F": Result(("in the order of y",), count=form.size)}
    return kernel(context, function, results, ("residual", "(15)", text, body), inputs=form.arguments)


def _behind(target: LoopTarget, first: int, number: int) -> ElementIndex:
    """The index of an element of a target, counted from one of its elements on."""
    return target.index(first + number)


def _between_bodies(context: InstanceContext, form: DaeLayout) -> list[Statement]:
    """The loops that add the forces between bodies to F."""
    result: list[Statement] = []
    for group in context.forces:
        code, ctx = group.code, group.code.context
        symbols = ctx.symbols(*given_inputs(code, "t", "q", "v"))
        items = stores("F", [symbols(ctx.equations.sum_of(row.name)) for row in ctx.equations.rows])
        target = spread(code, "F", form.velocities(group), Operator.ADD)
        result.append(code.loop(symbols, [Step(code.name, "(10)", "", items)], form.states_of(group), {"F": target}))
    return result


def _of_varying_joints(context: InstanceContext, form: DaeLayout) -> Iterator[Statement]:
    """The loops that add the reactions of varying joints and their constraints to F."""
    for group in context.joints:
        code, ctx = group.code, group.code.context
        y, ydot = states(ctx, form.form)
        symbols = ctx.symbols(ctx.t, code.given, y, ydot)
        rows = residual_rows(ctx, form.form, symbols, joints_alone=True)
        present = [k for k, row in enumerate(rows) if not row.is_zero()]
        positions = [[at[k] for k in present] for at in form.joint_positions(group)]
        target = spread(code, "F", positions, Operator.ADD, f"F_{form.form}")
        step = Step(code.name, "", "", stores("F", [rows[k] for k in present]))
        yield code.loop(symbols, [step], form.joint_reads(group, y, ydot), {"F": target})


def jacobian(context: InstanceContext, function: ModelFunction) -> Kernel:
    """The kernel of the iteration matrix dF/dy + cj dF/dydot."""
    form = DaeLayout(context, function.variant)
    entries = {(i, i) for i in range(form.size)}
    written: set[tuple[int, int]] = set()
    of_bodies, between = [], []
    for of in context.classes:
        y, ydot = states(of.context, form.form)
        symbols = of.context.symbols(of.context.t, of.given, y, ydot, of.context.cj)
        own, values = _iteration_matrix(symbols, residual_rows(of.context, form.form, symbols), y, ydot, diagonal=True)
        positions = [[(at[i], at[j]) for i, j in own] for at in form.positions(of)]
        written |= {entry for member in positions for entry in member}
        of_bodies.append((of, symbols, (y, ydot), values, positions))
    for group in context.forces:
        code, ctx = group.code, group.code.context
        symbols = ctx.symbols(*given_inputs(code, "t", "q", "v"))
        rows = ca.vertcat(*(symbols(ctx.equations.sum_of(row.name)) for row in ctx.equations.rows))
        matrix = ca.jacobian(rows, ca.vertcat(*symbols.values_of(ctx.q.symbols + ctx.v.symbols)))
        own = sorted(zip(*matrix.sparsity().get_triplet(), strict=True), key=lambda entry: (entry[1], entry[0]))
        positions = [
            [(form.coordinates + rows[i], [*at, *(form.coordinates + k for k in rows)][j]) for i, j in own]
            for at, rows in zip(group.coordinates, group.rows, strict=True)
        ]
        entries |= {entry for member in positions for entry in member}
        between.append((group, symbols, form.states_of(group), [matrix[i, j] for i, j in own], positions))
    for group in context.joints:
        code, ctx = group.code, group.code.context
        y, ydot = states(ctx, form.form)
        symbols = ctx.symbols(ctx.t, code.given, y, ydot, ctx.cj)
        own, values = _iteration_matrix(symbols, residual_rows(ctx, form.form, symbols, joints_alone=True), y, ydot)
        positions = [[(at[i], at[j]) for i, j in own] for at in form.joint_positions(group)]
        entries |= {entry for member in positions for entry in member}
        between.append((group, symbols, form.joint_reads(group, y, ydot), values, positions))
    shape = pattern(form.size, form.size, entries | written)
    number = {entry: k for k, entry in enumerate(shape.entries)}
    body = _cleared([number[entry] for entry in sorted(entries - written)], len(number))
    for of, symbols, (y, ydot), values, positions in of_bodies:
        target = spread(of, "jac", [[number[e] for e in m] for m in positions], None, f"iteration_{form.form}")
        given = (*form.reads(of, "y", y), *form.reads(of, "ydot", ydot))
        body.append(of.loop(symbols, [Step(of.name, "", "", stores("jac", values))], given, {"jac": target}))
    for group, symbols, inputs, values, positions in between:
        code = group.code
        target = scatter(code, f"force_{form.form}", "jac", [[number[e] for e in m] for m in positions], Operator.ADD)
        body.append(code.loop(symbols, [Step(code.name, "", "", stores("jac", values))], inputs, {"jac": target}))
    results = {"jac": Result(pattern=shape)}
    text = "derivatives of the residual"
    return kernel(context, function, results, ("jacobian", "(15)", text, body), inputs=form.arguments)


def _cleared(places: list[int], size: int) -> list[Statement]:
    """The statements that set some elements of the iteration matrix to zero: all, unless there are few."""
    if len(places) > FEW:
        return [Clear("jac", size)]
    return [StoreElement(Element("jac", constant(place)), ZERO) for place in places]


def _iteration_matrix(
    symbols: Symbols, rows: list[ca.SX], y: Input, ydot: Input, diagonal: bool = False
) -> tuple[list[tuple[int, int]], list[ca.SX]]:
    """The entries of dF/dy + cj dF/dydot that do not vanish, by columns, and their values.

    diagonal: whether the entries of the diagonal are among them in any case.
    """
    by_y, by_ydot = (ca.jacobian(ca.vertcat(*rows), ca.vertcat(*symbols.values_of(a.symbols))) for a in (y, ydot))
    matrix = by_y + symbols.values[local("cj")] * by_ydot
    entries = set(zip(*matrix.sparsity().get_triplet(), strict=True))
    entries |= {(i, i) for i in range(len(rows))} if diagonal else set()
    own = sorted(entries, key=lambda entry: (entry[1], entry[0]))
    return own, [matrix[i, j] if matrix.sparsity().has_nz(i, j) else ca.SX(0) for i, j in own]
