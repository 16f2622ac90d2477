"""The functions of bodies in straight-line code: M, h, accelerations, energies, markers, first-order form."""

from __future__ import annotations

from fractions import Fraction

import casadi as ca

from derive.algebra import sp
from derive.ir.kernel import Kernel
from derive.ir.patterns import pattern
from derive.ir.statements import Requirement, ReturnCode
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import Context, array_input, define, stores
from derive.lowering.flat.quadratic_inertia import quadratic_inertias
from derive.lowering.flat.schedule import OutputValue, RequiredValue, Step
from derive.lowering.flat.trees.tree_dynamics import force_values, mass_values
from derive.lowering.ldlt import VANISHING, Factorisation
from derive.lowering.model_functions import ModelFunction, OutputElements
from derive.mechanics.equations import Equations
from derive.mechanics.symbols import state_rate


def mass(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of the mass matrix M(q)."""
    has_trees = bool(context.equations.trees)  # whose links have motions, from which M reads nothing
    symbols = context.symbols(context.t, context.q, context.v) if has_trees else context.symbols(context.q)
    symbols.fixed.update(quadratic_inertias(context, symbols))
    symbols.values.update(symbols.fixed)
    return context.kernel(function, {"M": _mass_elements(context)}, symbols, _mass_step(context, symbols))


def force(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of the forces h(t, q, v)."""
    symbols = context.symbols(context.t, context.q, context.v)
    return context.kernel(function, {"h": _force_elements(context)}, symbols, _force_step(context, symbols))


def mass_force(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of M and h together."""
    symbols = context.symbols(context.t, context.q, context.v)
    outputs = {"M": _mass_elements(context), "h": _force_elements(context)}
    entries, forces = context.mass_pattern().entries, force_values(context, symbols)
    values, has_trees = mass_values(context, symbols), bool(context.equations.trees)
    steps = []
    # From the last row to the first: the last rows are cheap, and compilers keep their values in registers.
    for row in reversed(range(len(context.rows))):
        h = OutputValue("h", row, forces[row])
        own = [index for index, entry in enumerate(entries) if entry[0 if has_trees else 1] == row]
        part = (OutputValue("M", index, values[index]) for index in (reversed(own) if has_trees else own))
        text = f"force and {'row' if has_trees else 'column'} of M of {context.rows[row]}"
        steps.append(Step(context.rows[row], "(15)", text, (h, *part)))
    return context.kernel(function, outputs, symbols, *steps)


def pivot_checks(symbols: Symbols, factors: Factorisation, names: tuple[str, ...]) -> tuple[RequiredValue, ...]:
    """The checks that each pivot differs from zero: positive for a coordinate, negative for a multiplier."""
    margin = symbols.number(VANISHING)
    result = []
    for pivot, scale, j in zip(factors.pivots, factors.scales, factors.order, strict=True):
        if j in factors.idle:
            continue
        above = pivot if pivot is scale else pivot - margin * scale
        text = f"the pivot of {names[j]} vanished"
        result.append(
            RequiredValue(Requirement.POSITIVE, above if j < factors.coordinates else -above, ReturnCode.PIVOT, text)
        )
    return tuple(result)


def energy(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of the kinetic and strain energies, and of the potential of gravity if there is gravity."""
    symbols = context.symbols(context.q, context.v)
    eq = context.equations
    twice = (sp.expand(2 * e) for e in (eq.kinetic_energy, eq.strain_energy))  # so that 1/2 is applied once
    values = [symbols.number(Fraction(1, 2)) * symbols(e) for e in twice]
    weight = eq.weight_energy is not None
    values += [symbols(eq.weight_energy)] if weight else []
    return context.kernel(
        function,
        {"energy": OutputElements(("kinetic", "strain", *(["gravity"] if weight else [])))},
        symbols,
        Step("energy", "(22)", "1/2 int rho xdot . xdot and the strain energy", stores("energy", values)),
    )


def momentum(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of the linear momentum, and of the angular momentum about the inertial origin."""
    symbols = context.symbols(context.q, context.v)
    eq = context.equations
    values = [symbols(p) for p in (*eq.linear_momentum, *eq.angular_momentum)]
    return context.kernel(
        function,
        {"momentum": OutputElements(momentum_names(eq))},
        symbols,
        Step("momentum", "(1)", "int rho xdot and int rho x x xdot", stores("momentum", values)),
    )


def momentum_names(equations: Equations) -> tuple[str, ...]:
    """The names of the components of linear and angular momentum."""
    linear = (f"linear_{k}" for k, _ in enumerate(equations.linear_momentum, 1))
    angular = tuple(f"angular_{k}" for k, _ in enumerate(equations.angular_momentum, 1))
    return *linear, *(angular if len(angular) > 1 else ("angular",))


def rates(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of qdot."""
    symbols = context.symbols(context.q, context.v)
    values = [symbols(rate) for rate in context.equations.rates]
    return context.kernel(
        function,
        {"qdot": OutputElements(tuple(f"{n}_t" for n in context.names))},
        symbols,
        Step("rates", "(1)", "from Qdot = Q (omega x)", stores("qdot", values)),
    )


def marker(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of the position, the velocity and the Jacobian d(velocity)/dv of a marker."""
    point = context.equations.marker(function.variant)
    symbols = context.symbols(context.q, context.v)
    named = define(symbols, tuple(d for d in point.definitions if not d.zero))
    matrix = point.jacobian
    rows, cols = matrix.shape
    axes = range(1, rows + 1)
    shape = pattern(rows, cols, {(i, j) for i in range(rows) for j in range(cols) if matrix[i, j] != 0})
    labels = tuple(f"d x{i + 1}dot / d {context.rates[j]}" for i, j in shape.entries)
    items = (
        *stores("x", [symbols(e) for e in point.position]),
        *stores("xdot", [symbols(e) for e in point.velocity]),
        *stores("jacobian", [symbols(matrix[i, j]) for i, j in shape.entries]),
    )
    return context.kernel(
        function,
        {
            "x": OutputElements(tuple(f"x{k}" for k in axes)),
            "xdot": OutputElements(tuple(f"x{k}dot" for k in axes)),
            "jacobian": OutputElements(labels, shape),
        },
        symbols,
        Step("r", "(14)", "X + u and its time derivative at the marker, in the body frame", named),
        Step("marker", "(1)", "x = c + Q r, its time derivative and its Jacobian", items),
    )


def load(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of the generalised forces of a force at a marker."""
    point = context.equations.marker(function.variant)
    force = array_input("F", point.force, "force at the marker, in the inertial frame [N]")
    symbols = context.symbols(context.q, force)
    rotated = define(symbols, point.force_definitions)
    named = define(symbols, tuple(d for d in point.definitions if not d.zero))
    return context.kernel(
        function,
        {"f": OutputElements(tuple(f"f[{n}]" for n in context.rows))},
        symbols,
        Step("F", "(10)", "the force in the body frame", rotated),
        Step("r", "(1)", "the marker in the body frame", named),
        Step("f", "(10)", "virtual work of the force", stores("f", [symbols(e) for e in point.load])),
        inputs=(force,),
    )


def residual(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of the residual F(t, y, ydot) of the first-order form."""
    symbols, rows = _first_order(context)
    return context.kernel(
        function,
        {"F": OutputElements(context.names + context.rates)},
        symbols,
        Step("residual", "(15)", "kinematics, then the equations of motion", stores("F", rows)),
    )


def jacobian(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of the iteration matrix dF/dy + cj dF/dydot, whose pattern always contains the diagonal."""
    symbols, rows = _first_order(context)
    y, ydot = (ca.vertcat(*symbols.values_of(argument.symbols)) for argument in (context.y, context.ydot))
    (cj,) = symbols.values_of(context.cj.symbols)
    matrix = ca.jacobian(ca.vertcat(*rows), y) + cj * ca.jacobian(ca.vertcat(*rows), ydot)
    diagonal = {(i, i) for i in range(len(rows))}
    shape = pattern(len(rows), len(rows), diagonal | set(zip(*matrix.sparsity().get_triplet(), strict=True)))
    states = context.y.elements
    labels = tuple(f"d F[{states[i]}] / d {states[j]}" for i, j in shape.entries)
    return context.kernel(
        function,
        {"jac": OutputElements(labels, shape)},
        symbols,
        Step(
            "jacobian", "(15)", "derivatives of the residual", stores("jac", [matrix[i, j] for i, j in shape.entries])
        ),
    )


def _first_order(context: Context) -> tuple[Symbols, list[ca.SX]]:
    """The rows of the residual, and the symbols in terms of which CasADi differentiates them."""
    symbols = context.symbols(context.y, context.ydot, context.cj)
    eq = context.equations
    pairs = zip(eq.coordinates, eq.rates, strict=True)
    kinematic = [symbols(state_rate(c.q)) - symbols(rate) for c, rate in pairs]
    return symbols, kinematic + [symbols(eq.sum_of(row.name)) for row in eq.rows]


def _mass_elements(context: Context) -> OutputElements:
    """The elements of M."""
    shape = context.mass_pattern()
    return OutputElements(tuple(f"M[{context.rows[i]}, {context.rows[j]}]" for i, j in shape.entries), shape)


def _force_elements(context: Context) -> OutputElements:
    """The elements of h."""
    return OutputElements(tuple(f"h[{n}]" for n in context.rows))


def _mass_step(context: Context, symbols: Symbols) -> Step:
    """The step that computes M."""
    entries, items = context.mass_pattern().entries, stores("M", mass_values(context, symbols))
    if context.equations.trees:  # row by row from the leaves on, as momenta pass to the root
        items = tuple(items[k] for k in sorted(range(len(items)), key=entries.__getitem__, reverse=True))
    return Step("M", "(15)", "factors of the accelerations", items)


def _force_step(context: Context, symbols: Symbols) -> Step:
    """The step that computes h."""
    values = force_values(context, symbols)
    return Step("h", "(15)", "centrifugal, Coriolis and elastic terms", stores("h", values))
