"""Beams of second order against the Lagrangian of the same displacement field, which knows no shape integrals."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import pytest
import sympy as sp

import derive
from derive.mechanics.bodies.beam_functions import BeamFunction, rational
from derive.mechanics.bodies.displacement_fields import stretching_shapes
from derive.mechanics.bodies.reference_conditions import assumed_shapes
from derive.mechanics.equations import Equations
from derive.spec.model.beam import PlanarBeam

DIGITS = 50
xi = sp.Symbol("xi")
MASS, LENGTH, BENDING = sp.Rational(13, 10), sp.Rational(7, 5), sp.Rational(9, 4)
GRAVITY = (sp.Rational(3, 10), sp.Rational(-98, 10))
FRAMES = {
    "mean": ["1", "xi", "xi^2", "xi^3"],
    "point": ["1", "xi", "xi^2", "xi^3"],
    "chord": ["1", "xi", "xi^2", "xi^3"],
    "tangent": ["1", "xi", "xi^2", "xi^3"],
    "given": ["xi^2", "xi^3"],
}
STATES = [
    [sp.Rational((37 * k + 11 * n) % 23 - 11, 17 + 3 * k) for n in range(3)] for k in range(1, 8)
]  # q, v, a of each coordinate: any numbers will do


AXIAL, PRELOAD = sp.Rational(900), sp.Rational(-7, 4)
STRETCHING = {"axial": {"ansatz": ["xi + xi^2/3"], "stiffness": str(AXIAL), "preload": str(PRELOAD)}}


def beam(frame: str, terms: str | None, order: int = 2, **axial: Any) -> PlanarBeam:
    """A beam with numbers for its constants and a marker at its right end."""
    kind = {"kind": "tangent", "at": -1} if frame == "tangent" else frame
    return derive.planar_beam(
        "beam",
        ansatz=FRAMES[frame],
        frame=kind,
        mass=str(MASS),
        length=str(LENGTH),
        bending_stiffness=str(BENDING),
        gravity=[str(g) for g in GRAVITY],
        markers={"tip": 1},
        order=order,
        terms=terms,
        **axial,
    )


def expanded(spec: PlanarBeam) -> Equations:
    """The expanded equations of motion, row by row."""
    return derive.derive(spec).expanded()


class Field:
    """x = c + Q (X + u) of a beam as a function of the coordinates, integrated as it stands."""

    def __init__(self, frame: str, terms: str, **axial: Any) -> None:
        spec = beam(frame, terms, **axial)
        equations = expanded(spec)
        self.q = [c.q for c in equations.coordinates]
        self.v = [row.v for row in equations.rows]
        self.a = [row.a for row in equations.rows]
        shapes, stretching = assumed_shapes(spec.deflection), stretching_shapes(spec)
        lateral = sp.Add(*(a * _expression(s) for a, s in zip(self.q[3:], shapes, strict=False)))
        stretch = sp.Add(*(a * _expression(s) for a, s in zip(self.q[3 + len(shapes) :], stretching, strict=True)))
        along = -(sp.Poly(lateral, xi).diff(xi) ** 2)
        along = along.integrate(xi) * sp.Poly(1 / LENGTH, xi)
        ends = along.eval(-1), along.eval(1)
        constant = {
            "mean": _integral(along) / 2,
            "point": along.eval(0),
            "tangent": ends[0],
            "given": along.eval(0),
            "chord": (ends[0] + ends[1]) / 2,
        }[frame]
        self.u = (along.as_expr() - constant + stretch, lateral)
        self.stretches = bool(stretching)
        self.truncated = terms == "truncated"

    @cached_property
    def energies(self) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
        """T, the strain energy and the potential of gravity, kept through second order if the model is truncated."""
        phi, phidot = self.q[2], self.v[2]
        cos, sin = sp.cos(phi), sp.sin(phi)
        r1, r2 = xi * LENGTH / 2 + self.u[0], self.u[1]
        rates = [sum(sp.diff(r, a) * v for a, v in zip(self.q[3:], self.v[3:], strict=True)) for r in (r1, r2)]
        seen = sp.symbols("seen1:3")  # Q^T cdot
        velocity = seen[0] - phidot * r2 + rates[0], seen[1] + phidot * r1 + rates[1]
        kinetic = _integral(sp.Poly(sp.expand(velocity[0] ** 2 + velocity[1] ** 2), xi)) * MASS / 4
        centre = [_integral(sp.Poly(sp.expand(r), xi)) / 2 for r in (r1, r2)]
        if self.truncated:
            kinetic, centre = self._through_second_order(kinetic), list(map(self._through_second_order, centre))
        c1dot, c2dot = self.v[:2]
        kinetic = kinetic.xreplace({seen[0]: cos * c1dot + sin * c2dot, seen[1]: cos * c2dot - sin * c1dot})
        x = self.q[0] + cos * centre[0] - sin * centre[1], self.q[1] + sin * centre[0] + cos * centre[1]
        curvature = sp.Poly(self.u[1], xi).diff(xi).diff(xi)
        strain = _integral(curvature**2) * BENDING * 4 / LENGTH**3
        if self.stretches:
            slopes = [sp.Poly(u, xi).diff(xi) * (2 / LENGTH) for u in self.u]
            membrane = slopes[0] + slopes[1] ** 2 / 2
            strain += _integral(membrane**2) * AXIAL * LENGTH / 4 + _integral(membrane) * PRELOAD * LENGTH / 2
        return kinetic, strain, -MASS * (GRAVITY[0] * x[0] + GRAVITY[1] * x[1])

    def _through_second_order(self, expr: sp.Expr) -> sp.Expr:
        small = (*self.q[3:], *self.v[3:])
        kept = ((powers, c) for powers, c in sp.Poly(expr, *small).terms() if sum(powers) <= 2)
        return sp.Add(*(c * sp.Mul(*(s**n for s, n in zip(small, powers, strict=True))) for powers, c in kept))

    def residuals(self) -> list[sp.Expr]:
        """d/dt dL/dv - dL/dq at the state, in decimals."""
        kinetic, strain, weight = self.energies
        lagrangian, result = kinetic - strain - weight, []
        for q, v in zip(self.q, self.v, strict=True):
            momentum = sp.diff(lagrangian, v)
            rate = sp.Add(*(sp.diff(momentum, p) * w for p, w in zip(self.q, self.v, strict=True)))
            rate += sp.Add(*(sp.diff(momentum, w) * b for w, b in zip(self.v, self.a, strict=True)))
            result.append(self.at_state(rate - sp.diff(lagrangian, q)))
        return result

    def at_state(self, expr: sp.Expr) -> sp.Expr:
        """An expression at the state, in decimals."""
        values = {s: STATES[k][n] for n, of in enumerate((self.q, self.v, self.a)) for k, s in enumerate(of)}
        return expr.xreplace(values).evalf(DIGITS)


def _expression(shape: BeamFunction) -> sp.Expr:
    """A polynomial shape as an expression in xi."""
    return sp.Add(*(rational(c) * xi**n for n, c in enumerate(shape.coefficients)))


def _integral(polynomial: sp.Poly) -> sp.Expr:
    """Over -1 <= xi <= 1."""
    primitive = polynomial.integrate(xi)
    return sp.expand(primitive.eval(1) - primitive.eval(-1))


def at_state(equations: Equations, expr: sp.Expr) -> sp.Expr:
    """An expression at the state, in decimals."""
    of = ([c.q for c in equations.coordinates], [r.v for r in equations.rows], [r.a for r in equations.rows])
    values = {s: STATES[k][n] for n, symbols in enumerate(of) for k, s in enumerate(symbols)}
    return equations.substituted(expr).xreplace(values).evalf(DIGITS)


def close(found: sp.Expr, expected: sp.Expr) -> bool:
    """Equal but for the rounding of the decimals."""
    return bool(abs(found - expected) <= 10 ** (8 - DIGITS) * max(1, abs(expected)))


CASES = [(frame, "truncated") for frame in FRAMES] + [(frame, "full") for frame in FRAMES]
SLOW = (
    *((frame, "full") for frame in FRAMES if frame != "mean"),
    *((frame, "truncated") for frame in ("chord", "tangent")),  # with a stretch, they are below
)


@pytest.mark.parametrize(
    ("frame", "terms"), [pytest.param(*case, marks=pytest.mark.long if case in SLOW else ()) for case in CASES]
)
def test_equations_energies_and_momenta_are_those_of_the_lagrangian_of_the_field(frame: str, terms: str) -> None:
    compare(expanded(beam(frame, terms)), Field(frame, terms))


@pytest.mark.parametrize(
    ("frame", "terms"),
    [
        ("tangent", "truncated"),
        *(pytest.param(*case, marks=pytest.mark.long) for case in (("chord", "truncated"), ("mean", "full"))),
    ],
)
def test_a_beam_that_stretches_has_the_strain_of_second_order(frame: str, terms: str) -> None:
    """The strain energy is that of u' + v'^2/2, with the axial force at rest; kinetic energy and momenta as before."""
    compare(expanded(beam(frame, terms, **STRETCHING)), Field(frame, terms, **STRETCHING))


def compare(equations: Equations, field: Field) -> None:
    """Equations, energies and momenta at the state."""
    for row, expected in zip(equations.rows, field.residuals(), strict=True):
        assert close(at_state(equations, equations.sum_of(row.name)), expected), row.name
    energies = (equations.kinetic_energy, equations.strain_energy, equations.weight_energy)
    for energy, expected in zip(energies, field.energies, strict=True):
        assert close(at_state(equations, energy), field.at_state(expected))
    kinetic = field.energies[0]
    linear = [kinetic.diff(v) for v in field.v[:2]]
    angular = kinetic.diff(field.v[2]) + field.q[0] * linear[1] - field.q[1] * linear[0]  # about the inertial origin
    momenta = (*equations.linear_momentum, *equations.angular_momentum)
    for momentum, expected in zip(momenta, (*linear, angular), strict=True):
        assert close(at_state(equations, momentum), field.at_state(expected))


@pytest.mark.parametrize("frame", [pytest.param(f, marks=() if f == "mean" else pytest.mark.long) for f in FRAMES])
def test_truncated_and_full_differ_from_second_order_on(frame: str) -> None:
    """The rows of the shapes differ from second order on; the others keep its terms, and differ from third order on."""
    truncated, full = (expanded(beam(frame, terms)) for terms in ("truncated", "full"))
    small = [c.q for c in truncated.coordinates[3:]] + [s for row in truncated.rows[3:] for s in (row.v, row.a)]
    for k, row in enumerate(truncated.rows):
        difference = sp.Poly(sp.expand(full.row(row.name) - truncated.row(row.name)), *small)
        lowest = min(sum(powers) for powers in difference.monoms())
        assert difference.is_zero or lowest >= (3 if k < 3 else 2), row.name


def test_the_spin_stiffens_each_mode_of_the_mean_frame() -> None:
    """(41) with (n (n + 1)/2 - 1) phidot^2 added for the Legendre polynomial P_n: 2, 5, 9, ...; first order has -1."""
    shapes = 5
    equations = derive.derive(derive.planar_beam("beam", ansatz=[f"xi^{n}" for n in range(shapes + 2)], order=2))
    form = equations.expanded()
    m, spin = form.coefficients[0].value, form.rows[2].v
    for k in range(1, shapes + 1):
        n = k + 1
        row, coordinate = form.row(f"alpha{k}"), form.coordinates[2 + k].q
        inertia = row.coeff(form.rows[2 + k].a)
        assert inertia == m / (2 * n + 1)
        assert row.coeff(spin, 2) == inertia * (sp.Rational(n * (n + 1), 2) - 1) * coordinate
    assert form.mass == sp.diag(*form.mass.diagonal())
