"""The KKT matrix [M, -G^T; -G, 0] of a mechanism: its pattern, its elimination order, and kernels that solve it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress

import casadi as ca
import numpy as np

from derive.algebra import sp
from derive.ir.expressions import Number
from derive.ir.kernel import Kernel
from derive.ir.model import Kkt
from derive.ir.patterns import Pattern, pattern
from derive.ir.statements import Requirement, ReturnCode
from derive.lowering.elimination_orders import EliminationRule, coordinates_first, fill_in, work
from derive.lowering.flat.accelerations import balanced
from derive.lowering.flat.body_functions import pivot_checks
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import Context, Input, KktSolution, stores
from derive.lowering.flat.graph import LoweringError
from derive.lowering.flat.joint_turns import JointTurns, axis_checks, joint_turns, rows_of_bodies, turn_text
from derive.lowering.flat.schedule import EarlyValue, NamedValue, RequiredValue, Step, StepItem
from derive.lowering.ldlt import Factorisation, backward, factorise, forward, solve
from derive.lowering.model_functions import ModelFunction, OutputElements
from derive.lowering.paired_elimination import Pair, PairedElimination, forest_of_pairs, left_by_pairs, rows_of
from derive.lowering.proximal import LEAST, PROXIMAL, REFINEMENTS
from derive.lowering.redundancy import Dependence, dependences, redundancy_text
from derive.lowering.relative_rotations import RelativeElimination
from derive.mechanics.terms import SpatialPose
from derive.roles import Source


def _jacobian(context: Context) -> dict[tuple[int, int], sp.Expr]:
    """The factors in G by row and column."""
    column = {name: j for j, name in enumerate(context.rows)}
    every = enumerate(context.equations.constraints)
    return {(i, column[row]): factor for i, c in every for row, factor in c.jacobian}


def jacobian_pattern(context: Context) -> Pattern:
    """The sparsity pattern of G."""
    return pattern(len(context.multipliers), len(context.rows), set(_jacobian(context)))


def jacobian_entries(context: Context, symbols: Symbols) -> dict[tuple[int, int], ca.SX]:
    """The entries of G by row and column."""
    return {entry: symbols(factor) for entry, factor in _jacobian(context).items()}


def kkt_pattern(context: Context) -> Pattern:
    """The pattern of the lower triangle of [M, -G^T; -G, 0], without the zero diagonal of the multipliers."""
    n = len(context.rows)
    entries = set(context.mass_pattern().entries) | {(n + i, j) for i, j in jacobian_pattern(context).entries}
    size = n + len(context.multipliers)
    return pattern(size, size, entries, symmetric=True)


def kkt(context: Context) -> Kkt:
    """The structure of the KKT matrix: its pattern, elimination order and fill-in."""
    shape = kkt_pattern(context)
    pairs = kkt_pairs(context, shape)
    together = rows_of(pairs)
    order = (*together, *kkt_order(context, left_by_pairs(shape, pairs)[0], together))
    joints = joint_turns(context, context.symbols(context.t, context.q))
    relative = tuple(m for turn in joints.turns for m in turn.multipliers) if joints else ()
    return Kkt(shape, order, fill_in(shape, order), relative)


def kkt_order(context: Context, shape: Pattern, without: Sequence[int] = ()) -> tuple[int, ...]:
    """The elimination order of the KKT matrix with the pattern `shape`, without some rows."""
    n = len(context.rows)
    order = coordinates_first(shape, n) if context.proximal else context.elimination.order(shape, n)
    return tuple(row for row in order if row not in without)


def kkt_pairs(context: Context, shape: Pattern) -> tuple[Pair, ...]:
    """The pairs of the KKT matrix of a mechanism in space that are eliminated beforehand; none if that takes longer."""
    in_space = any(isinstance(pose, SpatialPose) for pose in context.equations.poses)
    if not in_space or context.proximal or context.elimination is not EliminationRule.SAFE:
        return ()
    n = len(context.rows)
    pairs = forest_of_pairs(
        shape, n, ((n + i, j) for (i, j), factor in _jacobian(context).items() if factor.is_Rational)
    )
    left, products = left_by_pairs(shape, pairs)
    together, with_coordinates = rows_of(pairs), {i for i, j in left.entries if i >= n > j}
    if not {*range(n, shape.rows)} <= {*together} | with_coordinates:
        return ()  # the pairs imply a constraint, which the order without them reports
    faster = products + work(left, kkt_order(context, left, together)) < work(shape, kkt_order(context, shape))
    return pairs if faster else ()


def kkt_entries(context: Context, symbols: Symbols) -> dict[tuple[int, int], ca.SX]:
    """The entries of the lower triangle of the KKT matrix by row and column."""
    n = len(context.rows)
    entries = {(i, j): symbols(context.equations.mass[i, j]) for i, j in context.mass_pattern().entries}
    return entries | {(n + i, j): -symbols.divisor(factor) for (i, j), factor in _jacobian(context).items()}


def kkt_factors(context: Context, symbols: Symbols) -> Factorisation:
    """The factorisation of the KKT matrix in its elimination order, behind that of pairs."""
    shape, entries = kkt_pattern(context), kkt_entries(context, symbols)
    return _factors(context, symbols, shape, entries, PairedElimination(entries, kkt_pairs(context, shape)).pairs)


def _factors(
    context: Context,
    symbols: Symbols,
    shape: Pattern,
    entries: dict[tuple[int, int], ca.SX],
    pairs: Sequence[Pair],
    turns: Sequence[int] = (),
) -> Factorisation:
    """The factorisation of what pairs and the rows `turns` leave; entries: those that are left."""
    left = left_by_pairs(shape, pairs)[0] if pairs else shape
    if turns:
        left = pattern(shape.rows, shape.cols, set(entries), symmetric=True)
    together = [*turns, *rows_of(pairs)]
    terms = [symbols.number(x) if context.proximal else None for x in (PROXIMAL, LEAST)]
    return factorise(left, entries, kkt_order(context, left, together), len(context.rows), *terms)


def _refined(
    context: Context, symbols: Symbols, factors: Factorisation, right: list[ca.SX], solution: list[ca.SX]
) -> list[ca.SX]:
    """The solution of the system with the KKT matrix after the refinement that a proximal term needs."""
    scales = zip(factors.order, factors.scales, strict=True)
    weights = {j: symbols.number(PROXIMAL) * scale for j, scale in scales if j >= factors.coordinates}
    for _ in range(REFINEMENTS if context.proximal else 0):
        solution = solve(factors, [r + weights[j] * solution[j] if j in weights else r for j, r in enumerate(right)])
    return solution


class DependentConstraints(LoweringError):
    """Constraints that others imply in every state, so that their multipliers have no unique value."""


def by_factors(
    context: Context,
    function: ModelFunction,
    outputs: Mapping[str, OutputElements],
    symbols: Symbols,
    right: list[ca.SX],
    inputs: tuple[Input, ...] = (),
) -> Kernel:
    """A kernel that solves a system with the KKT matrix and the right-hand side `right`, and checks the pivots.

    Raises LoweringError if a pivot vanishes in every state: DependentConstraints if constraints are redundant.
    """

    def made(solution: KktSolution) -> Kernel:
        kernel = _kernel(context, function, outputs, symbols, solution, inputs)
        if symbols is context.symbols_of_accelerations:
            context.solutions[symbols] = solution
        return kernel

    idle = not context.proximal and any(not c.jacobian for c in context.equations.constraints)
    kept = context.solutions.get(symbols)
    try:
        if idle:
            raise LoweringError("a constraint has no coordinates")
        if kept:
            return made(kept)
        if joints := joint_turns(context, symbols):
            with suppress(LoweringError):  # where a constraint would keep none of its coordinates
                return made(_with_pivots(context, symbols, right, joints))
        return made(_with_pivots(context, symbols, right, None))
    except LoweringError:  # of a pivot, or of a division by it
        if redundant := _redundant(context, symbols):
            raise DependentConstraints(redundancy_text(redundant)) from None
        raise


def _kernel(
    context: Context,
    function: ModelFunction,
    outputs: Mapping[str, OutputElements],
    symbols: Symbols,
    solution: KktSolution,
    inputs: tuple[Input, ...],
) -> Kernel:
    """The kernel with a solution. Raises LoweringError if it divides by zero in every state."""
    results, start = [], 0
    for name, elements in outputs.items():
        results.append(stores(name, solution.values[start : start + len(elements.names)]))
        start += len(elements.names)
    present = [value for value in solution.values[:start] if not value.is_zero()]
    finite = RequiredValue(Requirement.FINITE, balanced(present), ReturnCode.NOT_FINITE, "a result is not finite")
    return context.kernel(
        function,
        outputs,
        symbols,
        Step("pivots", Source.FACTORISATION, solution.text, solution.pivots),
        Step(
            "solution",
            Source.FACTORISATION,
            "forward, diagonal and back substitution",
            tuple(item for items in results for item in items),
        ),
        Step("check", "", "check the pivots and that the result is finite", (*solution.checks, finite)),
        inputs=inputs,
    )


def _redundant(context: Context, symbols: Symbols) -> tuple[Dependence, ...]:
    """The constraints that others imply in a random state, with random values of the parameters."""
    entries = jacobian_entries(context, symbols)
    function = ca.Function("G", [ca.vertcat(*symbols.inputs)], [ca.vertcat(*entries.values())])
    numbers = np.random.default_rng(0).uniform(0.5, 1.5, len(symbols.inputs))
    values = [
        float(leaf.value) if isinstance(leaf, Number) else number
        for leaf, number in zip(symbols.leaves, numbers, strict=True)
    ]
    G = np.zeros((len(context.multipliers), len(context.rows)))
    for (i, j), value in zip(entries, function(values).full().ravel(), strict=True):
        G[i, j] = value
    norms = np.linalg.norm(G, axis=1, keepdims=True)
    G /= np.where(norms > 0.0, norms, 1.0)
    return dependences(G, int(np.linalg.matrix_rank(G, 1e-9)), context.multipliers)


def _with_pivots(context: Context, symbols: Symbols, right: list[ca.SX], joints: JointTurns | None) -> KktSolution:
    """The solution of the system, with relative rotations at some joints. Raises LoweringError.

    The right-hand sides are eliminated beside the pivots, since each pivot waits for the division before; and all
    checks come last, since compilers move nothing across their branches.
    """
    shape, entries, names = kkt_pattern(context), kkt_entries(context, symbols), (*context.rows, *context.multipliers)
    if joints:
        joints.inertial.change(entries)
        shape = pattern(shape.rows, shape.cols, set(entries), symmetric=True)
        right = joints.inertial.forward(right)
    turning = {row for turn in joints.turns for row in turn.turning} if joints else set()
    constant = [pair for pair in kkt_pairs(context, shape) if pair.coordinate not in turning]
    pairs = PairedElimination(entries, constant, rows_of_bodies(context))
    right = pairs.forward(right)
    relative = RelativeElimination(entries, joints.turns if joints else ())
    right = relative.forward(right)
    factors = _factors(context, symbols, shape, entries, pairs.pairs, relative.gone)
    eliminated = forward(factors, right)
    reduced = _refined(context, symbols, factors, right, backward(factors, eliminated))
    turned = relative.backward(eliminated, {row: reduced[row] for row in factors.order})
    in_pairs = rows_of(pairs.pairs)
    solution = pairs.backward(eliminated, {row: x for row, x in enumerate(turned) if row not in in_pairs})
    solution = joints.inertial.backward(solution) if joints else solution
    items: list[StepItem] = []
    for j, pivot in zip(factors.order, factors.pivots, strict=True):
        items += [NamedValue(f"pivot_{names[j]}", pivot), EarlyValue(eliminated[j])]
    checks = (*pivot_checks(symbols, factors, names), *axis_checks(symbols, relative, names))
    order = ", ".join(
        [
            *(f"{names[p.coordinate]} with {names[p.multiplier]}" for p in pairs.pairs),
            *(turn_text(step.turn, names) for step in relative.steps),
            *(names[j] for j in factors.order),
        ]
    )
    term = f"; pivots of multipliers with a proximal term, refined {REFINEMENTS} times" if context.proximal else ""
    return KktSolution(tuple(items), solution, checks, f"eliminate {order}; fill-in {factors.fill}{term}")
