"""The tables of a model: variables, structural facts and look-up tables that those of the derivation become."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from derive.algebra import sp
from derive.ir.model import Variable, Zero
from derive.lowering.flat.casadi_symbols import table_name
from derive.mechanics.symbols import identity
from derive.mechanics.terms import (
    Constraint,
    Coordinate,
    Eliminated,
    EquationOfMotion,
    InputSymbol,
    MarkerEquations,
    OutputEquation,
    ParameterSymbol,
)
from derive.roles import Role
from derive.spec.model.time_function import Spline


def symbol_variable(symbol: sp.Symbol, doc: str, unit: str, role: Role | None = None) -> Variable:
    """A coordinate or a velocity with its name for people."""
    return Variable(str(symbol), doc, unit, role=role, shown=identity(symbol).shown)


def coordinate_variables(coordinates: Iterable[Coordinate]) -> tuple[Variable, ...]:
    """The coordinates q."""
    return tuple(symbol_variable(c.q, c.doc, c.unit, c.role) for c in coordinates)


def velocity_variables(rows: Iterable[EquationOfMotion]) -> tuple[Variable, ...]:
    """The velocities v."""
    return tuple(symbol_variable(row.v, row.doc, row.unit) for row in rows)


def parameter_variables(parameters: Iterable[ParameterSymbol]) -> tuple[Variable, ...]:
    """The parameters with their defaults."""
    return tuple(Variable(str(p.symbol), p.doc, p.unit, p.default) for p in parameters)


def port_variables(ports: Iterable[InputSymbol | OutputEquation]) -> tuple[Variable, ...]:
    """The inputs, or the components of outputs."""
    return tuple(Variable(port.name, port.doc, port.unit, shown=port.shown) for port in ports)


def marker_variables(markers: Iterable[MarkerEquations]) -> tuple[Variable, ...]:
    """The markers, whose positions are lengths."""
    return tuple(Variable(m.name, m.doc, "m", shown=m.shown) for m in markers)


def multiplier_variables(constraints: Iterable[Constraint]) -> tuple[Variable, ...]:
    """The multipliers of constraints, which are forces or moments."""
    return tuple(Variable(c.name, c.doc, c.force_unit, shown=c.shown) for c in constraints)


def eliminated_parts(eliminated: Iterable[Eliminated]) -> tuple[Zero, ...]:
    """The coordinates and constraints that are eliminated, with the reasons."""
    return tuple(Zero(of.what, of.reason) for of in eliminated)


def named_splines(model: str, splines: Iterable[Spline]) -> tuple[Spline, ...]:
    """The tables of values with the names of their functions in the generated code."""
    return tuple(replace(of, name=table_name(model, of.name)) for of in splines)
