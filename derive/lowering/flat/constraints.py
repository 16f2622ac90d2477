"""The functions of a mechanism: constraints, and accelerations and multipliers from the KKT matrix.

The system [M, -G^T; -G, 0] [vdot; lambda] = [-h; -gamma] is M vdot + h = G^T lambda with G vdot = gamma.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress

import casadi as ca

from derive.ir.analysis import operations
from derive.ir.kernel import Kernel
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import Context, array_input, stores
from derive.lowering.flat.graph import LoweringError
from derive.lowering.flat.kkt_matrix import by_factors, jacobian_entries, jacobian_pattern
from derive.lowering.flat.schedule import Step
from derive.lowering.flat.trees.accelerations import articulated_accelerations, by_articulated_bodies
from derive.lowering.flat.trees.tree_dynamics import tree_dynamics
from derive.lowering.model_functions import ModelFunction, OutputElements
from derive.mechanics.symbols import local


def constraints(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of the constraints g(t, q)."""
    symbols = context.symbols(context.t, context.q)
    values = [symbols(c.position) for c in context.equations.constraints]
    return context.kernel(
        function,
        {"g": OutputElements(context.multipliers)},
        symbols,
        Step("g", "(1)", "point of body 2 minus point of body 1, from x = c + Q r", stores("g", values)),
    )


def constraint_rates(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of the time derivatives gdot = G v + dg/dt of the constraints."""
    symbols = context.symbols(context.t, context.q, context.v)
    values = [symbols(c.rate) for c in context.equations.constraints]
    return context.kernel(
        function,
        {"gdot": OutputElements(context.multipliers)},
        symbols,
        Step("gdot", "(1)", "velocity of the point of body 2 minus that of body 1", stores("gdot", values)),
    )


def constraint_jacobian(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of the constraint Jacobian G(t, q) = d gdot / dv."""
    symbols = context.symbols(context.t, context.q)
    shape = jacobian_pattern(context)
    values = jacobian_entries(context, symbols)
    labels = tuple(f"G[{context.multipliers[i]}, {context.rows[j]}]" for i, j in shape.entries)
    return context.kernel(
        function,
        {"G": OutputElements(labels, shape)},
        symbols,
        Step(
            "G", "(6)", "factors of the generalised velocities", stores("G", [values[entry] for entry in shape.entries])
        ),
    )


def constraint_bias(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of the right-hand side gamma of the constraints on accelerations, G vdot = gamma."""
    symbols = context.symbols(context.t, context.q, context.v)
    return context.kernel(
        function,
        {"gamma": OutputElements(context.multipliers)},
        symbols,
        Step("gamma", "(5)", "centrifugal, Coriolis and prescribed parts", stores("gamma", _bias(context, symbols))),
    )


def accelerations_and_multipliers(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of vdot and lambda."""
    outputs = {"vdot": OutputElements(context.accelerations), "lam": OutputElements(context.multipliers)}
    return _solved(context, function, outputs)


def accelerations(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of vdot alone, for integrators of first-order equations."""
    return _solved(context, function, {"vdot": OutputElements(context.accelerations)})


COMPARED = 20
"""The largest number of rows and multipliers of trees for which both ways to accelerations are lowered and compared.

With more of them, articulated bodies take fewer operations but in models that consist of loops.
"""
COMPARED_WITH_OTHERS = 100
"""The largest number of rows and multipliers for which both ways are compared where other bodies are joined to trees.

With more of them lowering takes its time.
"""


def _solved(context: Context, function: ModelFunction, outputs: Mapping[str, OutputElements]) -> Kernel:
    """The kernel of the accelerations, by articulated bodies or by the factors of the KKT matrix: the cheaper one."""
    symbols = context.symbols_of_accelerations
    tree = tree_dynamics(context, symbols)
    candidates = []
    if tree and by_articulated_bodies(context, tree):
        most = COMPARED if len(tree.rows) == len(context.rows) else COMPARED_WITH_OTHERS
        with suppress(LoweringError):  # where constraints are redundant in every state
            candidates.append(articulated_accelerations(context, function, outputs, symbols, tree))
            if len(context.rows) + len(context.multipliers) > most:
                return candidates[0]
    candidates.append(by_factors(context, function, outputs, symbols, right_hand_side(context, symbols)))
    return min(candidates, key=lambda kernel: sum(map(operations, kernel.statements)))


def right_hand_side(context: Context, symbols: Symbols) -> list[ca.SX]:
    """The right-hand side [-h; -gamma] of the KKT matrix."""
    return [-symbols(h) for h in context.force_rows] + [-gamma for gamma in _bias(context, symbols)]


def project_velocity(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of the smallest dv, in the metric of M, with G dv = r."""
    changes = (local(f"r_{name}") for name in context.multipliers)
    prescribed = array_input("r", changes, "prescribed change of gdot")
    symbols = context.symbols(context.t, context.q, prescribed)
    right = [ca.SX(0) for _ in context.rows]
    right += [-value for value in symbols.values_of(prescribed.symbols)]
    return by_factors(context, function, {"dv": OutputElements(context.rates)}, symbols, right, (prescribed,))


def poses(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of the positions and rotation angles of all body frames, including bodies without coordinates."""
    symbols = context.symbols(context.t, context.q)
    every = context.equations.poses
    values = [symbols(e) for pose in every for _, e in pose.parts]
    labels = tuple(f"{pose.name}.{label}" for pose in every for label, _ in pose.parts)
    return context.kernel(
        function,
        {"pose": OutputElements(labels)},
        symbols,
        Step("poses", "(1)", "bodies in the order of the specification", stores("pose", values)),
    )


def _bias(context: Context, symbols: Symbols) -> list[ca.SX]:
    """The right-hand side gamma of the constraints on accelerations."""
    return [-symbols(c.bias) for c in context.equations.constraints]
