"""What the structure of a scene's equations costs, before any number is known."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from derive.ir.model import Output
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.constraints import accelerations, jacobian_entries, kkt_factors, kkt_pattern
from derive.lowering.flat.context import Context, stores
from derive.lowering.flat.functions import force
from derive.lowering.flat.schedule import Step
from derive.lowering.ldlt import Factorisation
from derive.mechanics.equations import Equations


@dataclass(frozen=True)
class Counts:
    """Counts of one scene; non-zeros are structural, of both triangles.

    `fill` is what LDL^T adds to one triangle. `flops` are operations of LDL^T alone, were each non-zero a number that
    is known at run time only; `factorise` are those that are left of it in the generated code, where what depends on
    parameters alone is known before. `force` and `accel` are operations of these kernels, a sine counting as one.
    """

    coordinates: int
    multipliers: int
    mass: int
    kkt: int
    fill: int
    flops: int
    factorise: int
    force: int
    accel: int


def counts(equations: Equations) -> Counts:
    """Count."""
    context = Context(equations)
    factors = kkt_factors(context, context.symbols(context.t, context.q))
    return Counts(
        coordinates=len(context.rows),
        multipliers=len(context.multipliers),
        mass=context.mass_pattern().full_nnz,
        kkt=kkt_pattern(context).full_nnz,
        fill=factors.fill,
        flops=flops(factors),
        factorise=_generated(context),
        force=force(context).operations,
        accel=accelerations(context).operations,
    )


def flops(factors: Factorisation) -> int:
    """Divisions, products and sums of LDL^T: a column with c entries below the pivot takes 1 + c + c (c + 1)."""
    below = (len(column) for column in factors.lower.values())
    return sum(1 + c + c * (c + 1) for c in below)


def _generated(context: Context) -> int:
    """Operations of a kernel that computes L and D, less those of one that computes the entries of M and G alone."""
    symbols = context.symbols(context.t, context.q)
    values = [symbols(context.equations.mass[entry]) for entry in context.mass_pattern().entries]
    values += jacobian_entries(context, symbols).values()
    entries = _operations(context, symbols, values)
    symbols = context.symbols(context.t, context.q)
    factors = kkt_factors(context, symbols)
    values = [*factors.pivots, *factors.inverses, *(x for column in factors.lower.values() for _, x in column)]
    return _operations(context, symbols, values) - entries


def _operations(context: Context, symbols: Symbols, values: list[ca.SX]) -> int:
    output = Output("A", tuple(f"A{k}" for k in range(len(values))), "values")
    step = Step("A", "", "values", stores("A", values))
    return context.kernel("values", "Values.", (context.t, context.q, context.k), (output,), symbols, step).operations
