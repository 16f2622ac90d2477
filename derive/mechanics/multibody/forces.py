"""Forces, torques, springs and dampers at material points: their virtual work as terms of the rows."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from derive.mechanics.equations import Definition, Row, Term
from derive.mechanics.multibody.constraints import link
from derive.mechanics.multibody.point_motion import PointMotion
from derive.mechanics.multibody.time_functions import function, rounded
from derive.mechanics.symbols import Symbol, element
from derive.spec.model.scene import Force, Spring, Torque


@dataclass(frozen=True)
class Action:
    """Terms on the left-hand side of the rows, what they are made of, and the potential of a spring."""

    terms: tuple[Term, ...]
    definitions: tuple[Definition, ...] = ()
    potential: sp.Expr = sp.S.Zero


def force(of: Force, at: PointMotion, rows: tuple[Row, ...]) -> Action:
    """A force with components that are functions of t."""
    definitions: list[Definition] = []
    values = []
    for k, component in enumerate(of.components, 1):
        values.append(_named(element(of.name, "", k), function(component), f"force {of.name} along e{k}", definitions))
    return Action(_force_terms(f"force {of.name}", at, sp.Matrix(values), rows), tuple(definitions))


def torque(of: Torque, at: PointMotion, against: PointMotion | None, rows: tuple[Row, ...]) -> Action:
    """A torque about e3 that is a function of t, with its reaction."""
    definitions: list[Definition] = []
    value = _named(element(of.name, "torque"), function(of.value), f"torque {of.name}", definitions)
    terms = _torque_terms(f"torque {of.name}", at, value, rows)
    if against is not None:
        terms += _torque_terms(f"torque {of.name}", against, -value, rows)
    return Action(terms, tuple(definitions))


def spring(
    of: Spring,
    first: PointMotion,
    second: PointMotion,
    constants: tuple[sp.Expr, sp.Expr, sp.Expr],
    rows: tuple[Row, ...],
) -> Action:
    """A spring with a damper; `constants` are stiffness, damping and rest, as numbers or coefficients."""
    stiffness, damping, rest = constants
    name, between = f"spring {of.name}", link(first, second)
    if of.kind == "rotational":
        angle, rate, _ = between.turned
        moment = sp.expand(stiffness * (angle - rest) + damping * rate)
        terms = _torque_terms(name, second, -moment, rows) + _torque_terms(name, first, moment, rows)
        return Action(terms, (), sp.expand(stiffness * (angle - rest) ** 2) / 2)
    apart, rate_apart, _ = between.apart
    definitions: list[Definition] = []

    def define(expr: sp.Expr, doc: str, what: str, *components: int) -> sp.Expr:
        if expr.is_number:
            return rounded(expr)
        symbol = element(of.name, what, *components)
        definitions.append(Definition(symbol, expr, of.name, "(10)", f"{doc} of spring {of.name}"))
        return symbol

    vector = sp.Matrix([define(sp.expand(apart[k]), f"vector along e{k + 1}", "apart", k + 1) for k in range(2)])
    if rest == 0 and damping == 0:  # linear, without a square root
        pull, potential = stiffness * vector, stiffness * vector.dot(vector) / 2
    else:
        length = define(sp.sqrt(vector.dot(vector)), "length", "length")
        tension = stiffness * (length - rest)
        potential = stiffness * (length - rest) ** 2 / 2
        if damping != 0:
            rate = define(sp.expand(vector.dot(rate_apart)) / length, "rate of the length", "rate")
            tension += damping * rate
        pull = define(tension / length, "tension over length", "pull") * vector
    terms = _force_terms(name, second, -pull, rows) + _force_terms(name, first, pull, rows)
    return Action(terms, tuple(definitions), sp.expand(potential))


def _named(symbol: Symbol, value: sp.Expr, doc: str, definitions: list[Definition]) -> sp.Expr:
    """A number as it is; else a definition."""
    if value.is_Rational:
        return value
    definitions.append(Definition(symbol, value, symbol.name, "(10)", doc))
    return symbol


def _force_terms(name: str, at: PointMotion, force_on: sp.Matrix, rows: tuple[Row, ...]) -> tuple[Term, ...]:
    """The virtual work of a force: its product with the columns of the Jacobian of the point."""
    work = sp.expand(force_on.dot(at.acceleration))
    return _terms(name, work, rows)


def _torque_terms(name: str, at: PointMotion, moment: sp.Expr, rows: tuple[Row, ...]) -> tuple[Term, ...]:
    return _terms(name, sp.expand(moment * at.spin_rate), rows)


def _terms(name: str, work: sp.Expr, rows: tuple[Row, ...]) -> tuple[Term, ...]:
    present = work.free_symbols
    factors = ((row, work.coeff(row.a)) for row in rows if row.a in present)
    return tuple(Term(row.name, name, "(10)", -factor) for row, factor in factors if factor != 0)
