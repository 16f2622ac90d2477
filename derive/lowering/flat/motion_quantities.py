"""Quantities of a motion in straight-line code: inverse dynamics, centre of mass, momentum, rotations of markers.

Each has vectors, and at most one matrix, the derivative of one of them by v. With sensitivities there are the
derivatives of the vectors with respect to the arguments, the parameters and the inputs as well.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import casadi as ca

from derive.algebra import sp
from derive.ir.kernel import Kernel
from derive.ir.patterns import pattern
from derive.lowering.flat.body_functions import momentum_names
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import Context, stores
from derive.lowering.flat.schedule import Step
from derive.lowering.flat.sensitivities import by_parameters_and_inputs
from derive.lowering.flat.trees.momentum import momenta
from derive.lowering.flat.trees.tree_dynamics import tree_dynamics
from derive.lowering.model_functions import FunctionKind, ModelFunction, OutputElements
from derive.lowering.requested_functions import DIFFERENTIATED, JACOBIANS, has_mass
from derive.mechanics.equations import Equations
from derive.mechanics.symbols import local
from derive.mechanics.terms import ModelConstant

RECIPROCAL = local("mass_reciprocal")
"""The constant 1/mass of all bodies together."""
DIFFERENTIATED_BY = {jacobian: kind for kind, jacobian in JACOBIANS.items()}
"""The kinds whose derivatives functions have."""
PLANE = 2
"""The dimension of the plane, where an angular momentum has one component."""


@dataclass(frozen=True)
class Quantities:
    """The results of a function: the description of its section, its vectors, and a matrix as a derivative by v.

    vectors: the names of the elements and the values of each, by the names of outputs. matrix: the name of the output,
    and that of the vector whose derivative it is; both are empty if there is none.
    """

    doc: str
    vectors: Mapping[str, tuple[Sequence[str], Sequence[ca.SX]]]
    matrix: tuple[str, str] = ("", "")


def with_mass_reciprocal(equations: Equations) -> Equations:
    """The equations with `RECIPROCAL` as a further constant, if they have the mass of bodies."""
    if not has_mass(equations):
        return equations
    mass = equations.mass_moments[0].xreplace({c.symbol: c.value for c in equations.coefficients})
    reciprocal = ModelConstant(RECIPROCAL, 1 / mass, "", "1 / mass of all bodies", "1/kg")
    return replace(equations, coefficients=(*equations.coefficients, reciprocal))


def requested_function(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of a function."""
    symbols = _symbols(context)
    of = QUANTITIES[function.kind](context, symbols, function.variant)
    outputs = {name: OutputElements(tuple(names)) for name, (names, _) in of.vectors.items()}
    items = {name: stores(name, list(values)) for name, (_, values) in of.vectors.items()}
    matrix, vector = of.matrix
    if matrix:
        names, values = of.vectors[vector]
        velocities = ca.vertcat(*symbols.values_of(context.v.symbols))
        outputs[matrix], entries = _matrix(ca.jacobian(ca.vertcat(*values), velocities), names, context.rates)
        items[matrix] = stores(matrix, entries)
    step = Step(function.kind.value, "", of.doc, tuple(item for name in function.outputs for item in items[name]))
    return context.kernel(function, outputs, symbols, step)


def requested_derivatives(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of the derivatives of the vectors of a function by its arguments, the parameters and the inputs."""
    symbols, kind = _symbols(context), DIFFERENTIATED_BY[function.kind]
    of = QUANTITIES[kind](context, symbols, function.variant)
    rows = [row for output in DIFFERENTIATED[kind] for row in zip(*of.vectors[output], strict=True)]
    values = [value for _, value in rows]
    state = [s for name in function.arguments if name in ("q", "v", "vdot") for s in context.inputs[name].symbols]
    by_state = ca.jacobian(ca.vertcat(*values), ca.vertcat(*symbols.values_of(state)))
    columns = [*(s.name for s in state), *(str(p.symbol) for p in context.equations.parameters), *context.u.elements]
    matrix = ca.horzcat(by_state, by_parameters_and_inputs(context, symbols, values))
    elements, entries = _matrix(matrix, [name for name, _ in rows], columns)
    step = Step("jacobian", "", f"derivatives of {kind.value}", stores("jac", entries))
    return context.kernel(function, {"jac": elements}, symbols, step)


def _symbols(context: Context) -> Symbols:
    return context.symbols(context.t, context.q, context.v, context.vdot)


def _matrix(matrix: ca.SX, rows: Sequence[str], columns: Sequence[str]) -> tuple[OutputElements, list[ca.SX]]:
    """The elements and the values of the entries of a matrix of derivatives that are no structural zeros."""
    shape = pattern(*matrix.shape, set(zip(*matrix.sparsity().get_triplet(), strict=True)))
    labels = tuple(f"d {rows[i]} / d {columns[j]}" for i, j in shape.entries)
    return OutputElements(labels, shape), [matrix[i, j] for i, j in shape.entries]


def _inverse_dynamics(context: Context, symbols: Symbols, _: str) -> Quantities:
    """The rows of the equations of motion; those of trees by the recursion of Newton and Euler, without M."""
    eq, tree = context.equations, tree_dynamics(context, symbols)
    known = tree.forces(symbols.values_of(context.vdot.symbols)) if tree else {}
    rows = [known[n] if n in known else symbols(eq.sum_of(row.name)) for n, row in enumerate(eq.rows)]
    return Quantities("the rows of the equations of motion", {"f": (_force_names(context), rows)})


def _gravity_compensation(context: Context, symbols: Symbols, _: str) -> Quantities:
    velocities = ca.vertcat(*symbols.values_of(context.v.symbols))
    rows = ca.vertcat(*(symbols(h) for h in context.force_rows))
    still = ca.substitute(rows, velocities, ca.SX.zeros(velocities.shape))
    values = [still[i] for i in range(len(context.rows))]
    return Quantities("the forces h without velocities", {"f": (_force_names(context), values)})


def _force_names(context: Context) -> list[str]:
    return [f"f[{name}]" for name in context.rows]


def _centre_of_mass(context: Context, symbols: Symbols, _: str) -> Quantities:
    mass, centre = _mass_and_centre(context, symbols)
    momentum = _of_tree(context, symbols) or [symbols(p) for p in context.equations.linear_momentum]
    velocity = [p * symbols(RECIPROCAL) for p in momentum[: len(centre)]]
    vectors = {
        "x": ([f"x{k}" for k, _ in enumerate(centre, 1)], centre),
        "xdot": ([f"x{k}dot" for k, _ in enumerate(centre, 1)], velocity),
        "m_total": (["m_total"], [mass]),
    }
    return Quantities("int rho x and int rho xdot, divided by the mass", vectors, ("jacobian", "xdot"))


def _mass_and_centre(context: Context, symbols: Symbols) -> tuple[ca.SX, list[ca.SX]]:
    mass, *moments = (symbols(moment) for moment in context.equations.mass_moments)
    return mass, [moment * symbols(RECIPROCAL) for moment in moments]


def _centroidal_momentum(context: Context, symbols: Symbols, _: str) -> Quantities:
    eq = context.equations
    values = _of_tree(context, symbols) or [symbols(e) for e in (*eq.linear_momentum, *_about_centre(eq))]
    vectors = {"momentum": (momentum_names(context.equations), values)}
    return Quantities("int rho xdot and int rho (x - centre) x xdot", vectors, ("A", "momentum"))


def _of_tree(context: Context, symbols: Symbols) -> list[ca.SX]:
    """The linear and angular momentum about the centre of mass, if all bodies are in trees; otherwise nothing."""
    eq = context.equations
    if not eq.trees or sp.expand(eq.mass_moments[0] - sp.Add(*(body.mass for body in eq.trees))) != 0:
        return []
    of_rows = momenta(eq.trees, symbols, _mass_and_centre(context, symbols)[1])
    columns = [(*of_rows[row.name][0], *of_rows[row.name][1]) for row in eq.rows]
    velocities = symbols.values_of(row.v for row in eq.rows)
    return [sum((column[i] * v for column, v in zip(columns, velocities, strict=True)), ca.SX(0)) for i in range(6)]


def _about_centre(equations: Equations) -> Iterator[sp.Expr]:
    """The angular momentum about the centre of mass; the motion of the origin of a single body cancels out of it."""
    mass, *moments = equations.mass_moments
    p = equations.linear_momentum
    planes = ((0, 1),) if len(moments) == PLANE else ((1, 2), (2, 0), (0, 1))
    for about_origin, (i, j) in zip(equations.angular_momentum, planes, strict=True):
        of_centre = moments[i] * p[j] - moments[j] * p[i]
        if mass.is_Symbol:
            yield sp.expand(about_origin - of_centre / mass).xreplace({1 / mass: RECIPROCAL})
        else:
            yield about_origin - RECIPROCAL * of_centre


def _rotation(context: Context, symbols: Symbols, marker: str) -> Quantities:
    omega = [symbols(e) for e in context.equations.marker(marker).angular_velocity or ()]
    names = [f"omega{k}" for k, _ in enumerate(omega, 1)] if len(omega) > 1 else ["omega"]
    return Quantities("the angular velocity of the marker frame", {"omega": (names, omega)}, ("jacobian", "omega"))


QUANTITIES: Mapping[FunctionKind, Callable[[Context, Symbols, str], Quantities]] = {
    FunctionKind.INVERSE_DYNAMICS: _inverse_dynamics,
    FunctionKind.GRAVITY_COMPENSATION: _gravity_compensation,
    FunctionKind.CENTRE_OF_MASS: _centre_of_mass,
    FunctionKind.CENTROIDAL_MOMENTUM: _centroidal_momentum,
    FunctionKind.ROTATION: _rotation,
}
"""The quantities of each function."""
