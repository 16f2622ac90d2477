"""Accelerations and multipliers of trees by articulated bodies, with a Schur complement for their constraints.

With M = L D L^T along the tree and W = L^-1 G^T, the multipliers follow from (W^T D^-1 W) lambda = gamma + W^T D^-1
L^-1 h. A column of W has an entry for each row between the bodies of its constraint and the root alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import reduce

import casadi as ca

from derive.ir.kernel import Kernel
from derive.ir.patterns import pattern
from derive.ir.statements import Requirement, ReturnCode
from derive.lowering.elimination_orders import EliminationRule
from derive.lowering.flat.accelerations import balanced
from derive.lowering.flat.body_functions import pivot_checks
from derive.lowering.flat.casadi_symbols import Symbols, added, multiplied, subtracted
from derive.lowering.flat.context import Context, stores
from derive.lowering.flat.schedule import EarlyValue, NamedValue, RequiredValue, Step, StepItem
from derive.lowering.flat.trees.spatial_vectors import ZERO
from derive.lowering.flat.trees.tree_dynamics import TreeDynamics
from derive.lowering.ldlt import Entries, Factorisation, factorise, solve
from derive.lowering.model_functions import ModelFunction, OutputElements
from derive.roles import Source

Column = Mapping[int, ca.SX]


def by_articulated_bodies(context: Context, tree: TreeDynamics) -> bool:
    """Whether the accelerations of a model follow from articulated bodies: all of its rows are those of trees.

    Redundant constraints and orders that a user chooses need the KKT matrix.
    """
    safe = context.elimination is EliminationRule.SAFE and not context.proximal
    return safe and len(tree.rows) == len(context.rows) and all(c.jacobian for c in context.equations.constraints)


def articulated_accelerations(
    context: Context,
    function: ModelFunction,
    outputs: Mapping[str, OutputElements],
    symbols: Symbols,
    tree: TreeDynamics,
    bias: Sequence[ca.SX],
) -> Kernel:
    """The kernel of the accelerations, and of the multipliers if `outputs` has them; bias: gamma of G vdot = gamma.

    Raises LoweringError if a pivot vanishes in every state.
    """
    names, rests, order = context.rows, tree.rests, list(tree.in_order())
    items: list[StepItem] = []
    for row in order:
        items += [NamedValue(f"pivot_{names[row]}", tree.bodies.eliminated[row].pivot), EarlyValue(rests[row])]
    checks, multipliers = [*tree.pivot_checks()], list[ca.SX]()
    joined = ""
    if bias:
        columns = [tree.bodies.forward(column) for column in _jacobian(context, symbols)]
        factors, multipliers = _multipliers(tree, columns, rests, bias)
        of_multipliers = context.multipliers
        items += [
            NamedValue(f"pivot_{of_multipliers[j]}", pivot)
            for j, pivot in zip(factors.order, factors.pivots, strict=True)
        ]
        checks += pivot_checks(symbols, factors, of_multipliers)
        joined = f"; then {', '.join(of_multipliers[j] for j in factors.order)}, fill-in {factors.fill}"
        for column, force in zip(columns, multipliers, strict=True):
            rests = {row: added(rest, multiplied(column[row], force)) for row, rest in rests.items()}
    vdot = tree.accelerations(rests)
    present = [value for value in (*vdot, *multipliers) if not value.is_zero()]
    finite = RequiredValue(Requirement.FINITE, balanced(present), ReturnCode.NOT_FINITE, "a result is not finite")
    results = {"vdot": vdot, "lam": multipliers}
    doc = f"articulated bodies: release {', '.join(names[row] for row in order)}{joined}"
    return context.kernel(
        function,
        outputs,
        symbols,
        Step("pivots", Source.FACTORISATION, doc, tuple(items)),
        Step(
            "solution",
            Source.FACTORISATION,
            "accelerations from the root to the leaves",
            tuple(item for name in outputs for item in stores(name, results[name])),
        ),
        Step("check", "", "check the pivots and that the result is finite", (*checks, finite)),
        method=" By articulated bodies, without M.",
    )


def _jacobian(context: Context, symbols: Symbols) -> list[Column]:
    """The rows of G."""
    numbers = {name: n for n, name in enumerate(context.rows)}
    return [{numbers[row]: symbols(f) for row, f in c.jacobian} for c in context.equations.constraints]


def _multipliers(
    tree: TreeDynamics, columns: Sequence[Column], rests: Column, bias: Sequence[ca.SX]
) -> tuple[Factorisation, list[ca.SX]]:
    """The factors of W^T D^-1 W, and the multipliers; columns: of W."""
    inverses = {row: of.inverse for row, of in tree.bodies.eliminated.items()}
    scaled = [{row: multiplied(x, inverses[row]) for row, x in of.items() if not x.is_zero()} for of in columns]
    entries: Entries = {
        (i, j): _product(scaled[i], columns[j])
        for i in range(len(columns))
        for j in range(i + 1)
        if i == j or any(not columns[j][row].is_zero() for row in scaled[i])
    }
    right = [subtracted(gamma, _product(of, rests)) for gamma, of in zip(bias, scaled, strict=True)]
    factors = factorise(pattern(len(columns), len(columns), set(entries), symmetric=True), entries)
    return factors, solve(factors, right)


def _product(a: Column, b: Column) -> ca.SX:
    return reduce(added, (multiplied(x, b[row]) for row, x in a.items()), ZERO)
