"""Accelerations and multipliers of scenes with trees by articulated bodies, with a Schur complement for constraints.

With M = L D L^T along the trees and W = L^-1 G^T, the multipliers follow from (W^T D^-1 W) lambda = gamma + W^T D^-1
L^-1 h. A column of W has an entry for each row between the bodies of its constraint and the root alone. Other bodies,
above all flexible ones, have blocks of M of their own, so that W^T D^-1 W is the response of the trees and the
compliance of these bodies at their joints. Those that hang on one body of a tree add to its inertia instead.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from derive.ir.kernel import Kernel
from derive.ir.statements import Requirement, ReturnCode
from derive.lowering.elimination_orders import EliminationRule
from derive.lowering.flat.accelerations import balanced
from derive.lowering.flat.body_functions import pivot_checks
from derive.lowering.flat.casadi_symbols import Symbols, added, divided
from derive.lowering.flat.context import Context, stores
from derive.lowering.flat.schedule import EarlyValue, NamedValue, RequiredValue, Step, StepItem
from derive.lowering.flat.trees.compliance import Compliance, with_reactions
from derive.lowering.flat.trees.hung_bodies import HungBodies, hung_bodies
from derive.lowering.flat.trees.joint_rows import JointRow, JointRows
from derive.lowering.flat.trees.other_bodies import Column, OtherBodies, leaves, other_bodies
from derive.lowering.flat.trees.recursions import ArticulatedBodies, articulated_bodies
from derive.lowering.flat.trees.steps import NO_WRENCH, Shift, Wrench
from derive.lowering.flat.trees.tree_dynamics import TreeDynamics
from derive.lowering.ldlt import Factorisation, solve
from derive.lowering.model_functions import ModelFunction, OutputElements
from derive.mechanics.symbols import Family, identity
from derive.roles import Source


def by_articulated_bodies(context: Context, tree: TreeDynamics) -> bool:
    """Whether the accelerations of a model can follow from articulated bodies.

    Redundant constraints and orders that a user chooses need the KKT matrix, and so do trees that have accelerations in
    common with other bodies.
    """
    safe = context.elimination is EliminationRule.SAFE and not context.proximal
    if context.sensitivities and len(tree.rows) < len(context.rows):
        return False  # what follows takes the transposes of rotation tensors for their inverses
    apart = all((i in tree.rows) == (j in tree.rows) for i, j in context.mass_pattern().entries)
    return safe and apart and all(c.jacobian for c in context.equations.constraints)


@dataclass(frozen=True)
class _Eliminated:
    """The rows of a scene as eliminated: those of bodies beside trees, of leaves with their constraints, and of trees.

    open: the numbers of the other constraints; compliance, multipliers: theirs. before, rests: the forces that
    accelerate each row alone, without and with these multipliers.
    """

    others: OtherBodies
    joints: JointRows
    hung: Sequence[HungBodies]
    bodies: ArticulatedBodies
    open: Sequence[int]
    compliance: Compliance
    multipliers: Sequence[ca.SX]
    before: Column
    rests: Column

    def solved(self) -> tuple[dict[int, ca.SX], dict[int, ca.SX]]:
        """The accelerations by row and the multipliers by constraint."""
        vdot, motions = self.bodies.backward(self.rests)
        multipliers, rests = dict(zip(self.open, self.multipliers, strict=True)), self.rests
        for of in self.hung:
            known = of.multipliers(motions[of.link])
            rests = with_reactions(rests, of.compliance.columns, [*known.values()])
            multipliers |= known
        return vdot | self.others.backward(rests), multipliers


def articulated_accelerations(
    context: Context,
    function: ModelFunction,
    outputs: Mapping[str, OutputElements],
    symbols: Symbols,
    tree: TreeDynamics,
) -> Kernel:
    """The kernel of the accelerations, and of the multipliers if `outputs` has them.

    Raises LoweringError if a pivot vanishes in every state.
    """
    of = _eliminated(context, symbols, tree)
    vdot, multipliers = of.solved()
    results = {"vdot": [vdot[n] for n in range(len(vdot))], "lam": of.joints.multipliers(multipliers)}
    present = [x for x in (*results["vdot"], *multipliers.values()) if not x.is_zero()]
    finite = RequiredValue(Requirement.FINITE, balanced(present), ReturnCode.NOT_FINITE, "a result is not finite")
    return context.kernel(
        function,
        outputs,
        symbols,
        Step("pivots", Source.FACTORISATION, _text(context, tree, of), tuple(_pivots(context, tree, of))),
        Step(
            "solution",
            Source.FACTORISATION,
            "accelerations from the root to the leaves",
            tuple(item for name in outputs for item in stores(name, results[name])),
        ),
        Step(
            "check",
            "",
            "check the pivots and that the result is finite",
            (*_checks(context, symbols, tree, of), finite),
        ),
        method=" By articulated bodies, without M.",
    )


def _eliminated(context: Context, symbols: Symbols, tree: TreeDynamics) -> _Eliminated:
    rows = [n for n in range(len(context.rows)) if n not in tree.rows]
    others = other_bodies(context, symbols, rows)
    joints = JointRows(context, symbols, tree, others.turned)
    free = others.forward(others.along_own_axes({row: -symbols(context.force_rows[row]) for row in rows}))
    columns = [others.forward(of.others) for of in joints.every]
    hung = []
    for leaf in leaves(context, rows):
        own = [joints.every[n] for n in leaf.constraints]
        compliance = Compliance([columns[n] for n in leaf.constraints], others.inverses)
        hung.append(hung_bodies(tree.frames, leaf, own, compliance, compliance.lacking([of.gamma for of in own], free)))
    bodies = articulated_bodies(tree.links, [(of.link, of.inertia) for of in hung])
    wrenches = tree.wrenches
    for of in hung:
        wrenches[of.link] = wrenches[of.link] + of.needed
    before = free | bodies.forward({row: -tree.applied(row) for row in tree.rows}, wrenches)
    held = {n for of in hung for n in of.leaf.constraints}
    still_open = [n for n in range(len(columns)) if n not in held]
    compliance = Compliance(
        [_of_trees(bodies, joints.every[n]) | columns[n] for n in still_open],
        {row: of.inverse for row, of in bodies.eliminated.items()} | others.inverses,
    )
    lacking = compliance.lacking([joints.every[n].gamma for n in still_open], before)
    multipliers = solve(compliance.factors, lacking)
    rests = with_reactions(before, compliance.columns, multipliers)
    return _Eliminated(others, joints, hung, bodies, still_open, compliance, multipliers, before, rests)


def _of_trees(bodies: ArticulatedBodies, row: JointRow) -> dict[int, ca.SX]:
    """The entries of a column of W for the rows of trees."""
    if not row.on_links and not row.of_trees:
        return {}
    wrenches = [NO_WRENCH] * len(bodies.links)
    for link, (place, exerted) in row.on_links.items():
        wrenches[link] = Shift(place).wrench(Wrench([-x for x in exerted.force], [-x for x in exerted.torque]))
    found = bodies.forward(row.of_trees, wrenches)
    return {row: x for row, x in found.items() if not x.is_zero()}


def _compliances(context: Context, of: _Eliminated) -> Iterator[tuple[Factorisation, tuple[str, ...]]]:
    """The factors of the compliances of leaves and of the other constraints, with the names of their multipliers."""
    for hung in of.hung:
        yield hung.compliance.factors, tuple(context.multipliers[n] for n in hung.leaf.constraints)
    yield of.compliance.factors, tuple(context.multipliers[n] for n in of.open)


def _pivots(context: Context, tree: TreeDynamics, of: _Eliminated) -> Iterator[StepItem]:
    """The pivots and the right-hand sides beside them."""
    names, others = context.rows, of.others
    for j, pivot in zip(others.factors.order, others.factors.pivots, strict=True):
        yield NamedValue(f"pivot_{names[others.rows[j]]}", pivot)
        yield EarlyValue(of.before[others.rows[j]])
    *leaves_first, last = _compliances(context, of)
    for factors, multipliers in leaves_first:
        yield from _pivots_of(factors, multipliers)
    for row in tree.in_order():
        yield NamedValue(f"pivot_{names[row]}", of.bodies.eliminated[row].pivot)
        yield EarlyValue(of.before[row])
    yield from _pivots_of(*last)


def _pivots_of(factors: Factorisation, names: Sequence[str]) -> Iterator[NamedValue]:
    for j, pivot in zip(factors.order, factors.pivots, strict=True):
        yield NamedValue(f"pivot_{names[j]}", pivot)


def _checks(context: Context, symbols: Symbols, tree: TreeDynamics, of: _Eliminated) -> Iterator[RequiredValue]:
    more = []
    for hung in of.hung:
        C = hung.inertia.C
        moment = divided(added(added(C[0][0], C[1][1]), C[2][2]), ca.SX(2))
        more.append((hung.link, _mass(context, symbols, hung.leaf.rows), moment))
    yield from tree.pivot_checks(of.bodies, more)
    yield from pivot_checks(symbols, of.others.factors, tuple(context.rows[row] for row in of.others.rows))
    for factors, multipliers in _compliances(context, of):
        yield from pivot_checks(symbols, factors, multipliers)


def _mass(context: Context, symbols: Symbols, rows: Iterable[int]) -> ca.SX:
    """The mass of bodies with these rows, by their first translations."""
    eq, total = context.equations, ca.SX(0)
    for row in rows:
        of = identity(eq.rows[row].v)
        if of.family is Family.TRANSLATION and of.components == (1,):
            total = added(total, symbols(eq.mass[row, row]))
    return total


def _text(context: Context, tree: TreeDynamics, of: _Eliminated) -> str:
    """The rows in the order of their elimination, for people."""
    names = context.rows
    first = [names[of.others.rows[j]] for j in of.others.factors.order]
    *leaves_first, (factors, multipliers) = _compliances(context, of)
    for own, shown in leaves_first:
        first += [shown[j] for j in own.order]
    eliminated = f"eliminate {', '.join(first)}; " if first else ""
    joined = f"; then {', '.join(multipliers[j] for j in factors.order)}, fill-in {factors.fill}" if multipliers else ""
    released = ", ".join(names[row] for row in tree.in_order())
    return f"articulated bodies: {eliminated}release {released}{joined}"
