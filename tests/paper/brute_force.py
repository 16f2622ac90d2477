"""The planar free beam once more, by the shortest way, with nothing of the package or of the print.

The position of every material point is written out in inertial components, differentiated by time and by
the generalized coordinates, and integrated over the beam. No rotation tensor, no angular velocity, no shape
integral: an error in those cannot be repeated here. Any number of shapes, each a polynomial in xi.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy
from sympy import QQ, Expr, Symbol, cos, sin
from sympy.polys.rings import PolyRing

m, l, EI, xi = sympy.symbols("m l EI xi")  # noqa: E741 - the paper's letters
c1, c2, phi = sympy.symbols("c1 c2 phi")

Vector = tuple[Expr, Expr]


@dataclass(frozen=True)
class Marker:
    """Inertial position and velocity of one material point."""

    position: Vector
    velocity: Vector


def coordinates(n: int) -> tuple[Symbol, ...]:
    """c1, c2, phi, alpha1, ..., alphan."""
    return (c1, c2, phi, *alphas(n))


def alphas(n: int) -> tuple[Symbol, ...]:
    return tuple(Symbol(f"alpha{i}") for i in range(1, n + 1))


def rate(q: Symbol) -> Symbol:
    return Symbol(f"{q.name}dot")


def acceleration(q: Symbol) -> Symbol:
    return Symbol(f"{q.name}ddot")


def time_derivative(expr: Expr, n: int) -> Expr:
    """The chain rule for an expression in the coordinates and their rates."""
    flow = {q: rate(q) for q in coordinates(n)} | {rate(q): acceleration(q) for q in coordinates(n)}
    return differential(expr, flow)


def differential(expr: Expr, flow: Mapping[Symbol, Expr]) -> Expr:
    """The change of an expression when each symbol s changes by flow[s]."""
    return sympy.Add(*(sympy.diff(expr, s) * ds for s, ds in flow.items()))


def expanded(expr: Expr) -> Expr:
    """Expanded, with sin(phi)^2 = 1 - cos(phi)^2: equal expressions then have a difference of zero."""
    return sympy.expand(sympy.expand(expr).subs(sin(phi) ** 2, 1 - cos(phi) ** 2))


def integral(expr: Expr) -> Expr:
    """The integral of a polynomial in xi from -1 to 1: 2/(k + 1) for an even power k, 0 for an odd one."""
    symbols = sorted(expr.free_symbols - {xi, phi}, key=str)
    polynomials = PolyRing((xi, cos(phi), sin(phi), *symbols), QQ)
    try:
        terms = polynomials.from_expr(expr).terms()
    except ValueError:
        raise ValueError(f"not a polynomial in xi: {expr}") from None
    of_even_powers: defaultdict[tuple[int, ...], Any] = defaultdict(lambda: QQ(0))
    for (power, *others), factor in terms:
        if power % 2 == 0:
            of_even_powers[0, *others] += QQ(2, power + 1) * factor
    return expanded(polynomials.from_dict(of_even_powers).as_expr())


def lateral_displacement(shapes: Sequence[Expr]) -> Expr:
    return sympy.Add(*(alpha * shape for alpha, shape in zip(alphas(len(shapes)), shapes, strict=True)))


def position(shapes: Sequence[Expr]) -> Vector:
    """x = c + Q (X + u) with (23)-(26): the point (xi l / 2, v) turned by phi and moved by c."""
    along, across = xi * l / 2, lateral_displacement(shapes)
    return (
        c1 + along * cos(phi) - across * sin(phi),
        c2 + along * sin(phi) + across * cos(phi),
    )


def velocity(shapes: Sequence[Expr]) -> Vector:
    x1, x2 = position(shapes)
    return time_derivative(x1, len(shapes)), time_derivative(x2, len(shapes))


def rows(shapes: Sequence[Expr]) -> dict[str, Expr]:
    """The coefficient of each virtual displacement: inertia and strain energy, zero for a free beam.

    A piece d xi of the uniform beam has the mass m/2 d xi.
    """
    n = len(shapes)
    x = position(shapes)
    xddot = [time_derivative(xdot, n) for xdot in velocity(shapes)]
    strain = strain_energy(shapes)
    result = {}
    for q in coordinates(n):
        work = sympy.Add(*(xddot_k * sympy.diff(x_k, q) for xddot_k, x_k in zip(xddot, x, strict=True)))
        result[q.name] = expanded(m / 2 * integral(work) + sympy.diff(strain, q))
    return result


def strain_energy(shapes: Sequence[Expr]) -> Expr:
    """1/2 EI times the integral of the squared curvature over the length, not taken from (22)."""
    per_length = 2 / l  # d xi / dx, as x = xi l / 2
    second = sympy.diff(lateral_displacement(shapes), xi, 2)  # the curvature is that times per_length^2
    return expanded(EI / 2 * integral(second**2) * per_length**3)


def kinetic_energy(shapes: Sequence[Expr]) -> Expr:
    v1, v2 = velocity(shapes)
    return expanded(m / 4 * integral(v1**2 + v2**2))


def linear_momentum(shapes: Sequence[Expr]) -> Vector:
    v1, v2 = velocity(shapes)
    return expanded(m / 2 * integral(v1)), expanded(m / 2 * integral(v2))


def angular_momentum(shapes: Sequence[Expr]) -> Expr:
    """About the inertial origin, along e3."""
    (x1, x2), (v1, v2) = position(shapes), velocity(shapes)
    return expanded(m / 2 * integral(x1 * v2 - x2 * v1))


def marker(shapes: Sequence[Expr], xi0: Expr | int) -> Marker:
    """The material point at xi = xi0."""
    x1, x2 = (expanded(x.subs(xi, xi0)) for x in position(shapes))
    v1, v2 = (expanded(v.subs(xi, xi0)) for v in velocity(shapes))
    return Marker((x1, x2), (v1, v2))
