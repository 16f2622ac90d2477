"""The printed equations are right once their dots are restored, and each printed term is needed.

Two hands, one result: `printed` is what the paper says, `brute_force` is derived without it. The brute force
is itself held against Lagrange's equations and the laws of momentum and energy, so that it can
judge the package.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cache

import pytest
import sympy
from sympy import Expr, Matrix, Symbol, cos, sin

from . import brute_force, printed
from .printed import PrintedTerm, a0, a1, a2, a3, xi

LEGENDRE_6 = tuple(sympy.legendre(k, xi) for k in range(2, 8))

SYSTEMS = {
    "33": (printed.EQUATION_33, printed.POINT_SHAPES),
    "41": (printed.EQUATION_41, printed.MEAN_SHAPES),
}

brute_force_rows = cache(brute_force.rows)


def disagreeing_rows(terms: Iterable[PrintedTerm], shapes: tuple[Expr, ...]) -> list[str]:
    """The rows in which the printed terms and the brute force differ."""
    terms = tuple(terms)
    derived = brute_force_rows(shapes)
    assert tuple(derived) == printed.ROWS
    return [row for row in derived if sympy.expand(printed.row_sum(terms, row) - derived[row]) != 0]


# (33) and (41)


@pytest.mark.parametrize("number", SYSTEMS)
def test_printed_rows_equal_brute_force(number: str) -> None:
    terms, shapes = SYSTEMS[number]
    assert {term.row for term in terms} == set(printed.ROWS)
    assert disagreeing_rows(terms, shapes) == []


SINGLE_TERMS = [
    pytest.param(terms, shapes, k, id=f"({number}) {term.row}: {term.expr}")
    for number, (terms, shapes) in SYSTEMS.items()
    for k, term in enumerate(terms)
]


@pytest.mark.parametrize(("terms", "shapes", "k"), SINGLE_TERMS)
def test_each_printed_term_is_needed(terms: tuple[PrintedTerm, ...], shapes: tuple[Expr, ...], k: int) -> None:
    without = terms[:k] + terms[k + 1 :]
    assert disagreeing_rows(without, shapes) == [terms[k].row]


@pytest.mark.parametrize(("terms", "shapes", "k"), SINGLE_TERMS)
def test_each_printed_sign_is_needed(terms: tuple[PrintedTerm, ...], shapes: tuple[Expr, ...], k: int) -> None:
    turned = (*terms[:k], replace(terms[k], expr=-terms[k].expr), *terms[k + 1 :])
    assert disagreeing_rows(turned, shapes) == [terms[k].row]


def test_shapes_of_the_other_conditions_do_not_fit() -> None:
    assert disagreeing_rows(printed.EQUATION_33, printed.MEAN_SHAPES)
    assert disagreeing_rows(printed.EQUATION_41, printed.POINT_SHAPES)


# The brute force itself

SHAPE_SETS = [
    pytest.param(printed.POINT_SHAPES, id="point"),
    pytest.param(printed.MEAN_SHAPES, id="mean"),
    pytest.param((xi, xi**2 - 2 * xi + 3), id="neither"),
    pytest.param(LEGENDRE_6, id="six"),
]


@pytest.mark.parametrize("shapes", SHAPE_SETS)
def test_brute_force_meets_lagrange(shapes: tuple[Expr, ...]) -> None:
    n = len(shapes)
    kinetic, strain = brute_force.kinetic_energy(shapes), brute_force.strain_energy(shapes)
    for q in brute_force.coordinates(n):
        momentum = sympy.diff(kinetic, brute_force.rate(q))
        lagrange = brute_force.time_derivative(momentum, n) - sympy.diff(kinetic, q) + sympy.diff(strain, q)
        assert brute_force.expanded(lagrange - brute_force_rows(shapes)[q.name]) == 0


@pytest.mark.parametrize("shapes", SHAPE_SETS)
def test_brute_force_meets_the_momentum_laws(shapes: tuple[Expr, ...]) -> None:
    """Virtual translation and rotation about the inertial origin give the rates of the momenta."""
    n, derived = len(shapes), brute_force_rows(shapes)
    p1, p2 = (brute_force.time_derivative(p, n) for p in brute_force.linear_momentum(shapes))
    spin = brute_force.time_derivative(brute_force.angular_momentum(shapes), n)
    moment = printed.c1 * derived["c2"] - printed.c2 * derived["c1"] + derived["phi"]
    assert brute_force.expanded(p1 - derived["c1"]) == 0
    assert brute_force.expanded(p2 - derived["c2"]) == 0
    assert brute_force.expanded(spin - moment) == 0


@pytest.mark.parametrize("shapes", SHAPE_SETS)
def test_brute_force_meets_the_energy_law(shapes: tuple[Expr, ...]) -> None:
    n, derived = len(shapes), brute_force_rows(shapes)
    energy = brute_force.kinetic_energy(shapes) + brute_force.strain_energy(shapes)
    power = sympy.Add(*(derived[q.name] * brute_force.rate(q) for q in brute_force.coordinates(n)))
    assert brute_force.expanded(brute_force.time_derivative(energy, n) - power) == 0


def test_marker_is_the_material_point() -> None:
    """The position follows from (1) with (23)-(26), in the printed rotation; its velocity from the chain rule."""
    shapes = printed.MEAN_SHAPES
    for xi0 in (-1, 0, sympy.Rational(1, 3), 1):
        tip = brute_force.marker(shapes, xi0)
        v = printed.displacement_30(*shapes).subs(xi, xi0)
        x = Matrix([printed.c1, printed.c2, 0]) + printed.ROTATION_26 * Matrix([xi0 * printed.l / 2, v, 0])
        assert (Matrix(tip.position) - x[:2, :]).expand() == sympy.zeros(2, 1)
        for position, velocity in zip(tip.position, tip.velocity, strict=True):
            assert sympy.expand(brute_force.time_derivative(position, 2) - velocity) == 0
    # And a number, so that not everything hangs on symbols: a straight beam that spins about a fixed center.
    still = {"c1": 0, "c2": 0, "c1dot": 0, "c2dot": 0, "phi": 0, "phidot": 3, "l": 10}
    still |= {"alpha1": 0, "alpha2": 0, "alpha1dot": 0, "alpha2dot": 0}
    tip = brute_force.marker(shapes, 1)
    assert [e.subs(still) for e in (*tip.position, *tip.velocity)] == [5, 0, 0, 15]


def test_brute_force_refuses_what_is_no_polynomial() -> None:
    with pytest.raises(ValueError, match="not a polynomial"):
        brute_force.kinetic_energy((sin(xi),))


# (22), (26)


@pytest.mark.parametrize("shapes", SHAPE_SETS)
def test_22_is_the_energy_of_curvature(shapes: tuple[Expr, ...]) -> None:
    v = brute_force.lateral_displacement(shapes)
    assert sympy.expand(printed.strain_energy_22(v) - brute_force.strain_energy(shapes)) == 0


def test_22_of_a_uniform_curvature() -> None:
    """v = kappa x^2 / 2 with x = xi l / 2 has 1/2 EI kappa^2 l, known without any integration."""
    kappa = Symbol("kappa")
    v = kappa * (xi * printed.l / 2) ** 2 / 2
    assert sympy.expand(printed.strain_energy_22(v) - printed.EI * kappa**2 * printed.l / 2) == 0


def test_26_turns_the_axis_of_the_beam() -> None:
    """The printed dyads, applied to e1, e2, e3; the turn is positive about e3."""
    Q = printed.ROTATION_26
    e = [sympy.eye(3)[:, k] for k in range(3)]
    c, s = cos(printed.phi), sin(printed.phi)
    dyads = (e[0] * e[0].T + e[1] * e[1].T) * c + (e[1] * e[0].T - e[0] * e[1].T) * s + e[2] * e[2].T
    assert dyads == Q
    assert Q.subs(printed.phi, sympy.pi / 2) * e[0] == e[1]
    assert (Q.T * Q).applyfunc(brute_force.expanded) == sympy.eye(3)


# (28)-(32) and (34)-(40): the conditions applied to (21)


def coefficients_where_zero(conditions: Sequence[Expr]) -> dict[Symbol, Expr]:
    (solution,) = sympy.solve(list(conditions), [a0, a1], dict=True)
    return dict(solution)


def shapes_left(conditions: Sequence[Expr]) -> tuple[Expr, ...]:
    """The shape functions of a2 and a3 in (21) under the conditions, scaled to 1 at the end xi = 1."""
    v = sympy.expand(printed.DISPLACEMENT_21.subs(coefficients_where_zero(conditions)))
    shapes = [v.coeff(a2), v.coeff(a3)]
    assert sympy.expand(v - a2 * shapes[0] - a3 * shapes[1]) == 0
    return tuple(sympy.expand(shape / shape.subs(xi, 1)) for shape in shapes)


def test_28_and_29_say_that_the_middle_neither_moves_nor_turns() -> None:
    v = printed.DISPLACEMENT_21
    assert sympy.expand(v.subs(xi, 0) - printed.CONDITION_28) == 0
    assert sympy.expand(sympy.diff(v, xi).subs(xi, 0) - printed.CONDITION_29) == 0


def test_31_and_32_are_what_28_and_29_leave() -> None:
    assert shapes_left([printed.CONDITION_28, printed.CONDITION_29]) == printed.POINT_SHAPES


def test_35_and_37_are_34_and_36_of_21() -> None:
    """They agree up to the factors 2/3 and 2/15, which a condition may lose; brute force gives the same integrals."""
    v = printed.DISPLACEMENT_21
    for integral, integrand, condition, factor in (
        (printed.mean_displacement_34(v), v, printed.CONDITION_35, sympy.Rational(2, 3)),
        (printed.mean_rotation_36(v), xi * v, printed.CONDITION_37, sympy.Rational(2, 15)),
    ):
        assert sympy.expand(integral - factor * condition) == 0
        assert sympy.expand(integral - brute_force.integral(integrand)) == 0


def test_39_and_40_are_what_35_and_37_leave() -> None:
    expected = tuple(sympy.expand(shape) for shape in printed.MEAN_SHAPES)
    assert shapes_left([printed.CONDITION_35, printed.CONDITION_37]) == expected
    assert expected == (sympy.legendre(2, xi), sympy.legendre(3, xi))


def test_30_has_no_rigid_motion_left() -> None:
    """(30), the same line as (38), meets the conditions of its own frame, and not those of the other."""
    point, mean = (printed.displacement_30(*shapes) for shapes in (printed.POINT_SHAPES, printed.MEAN_SHAPES))
    for v, at_rest in ((point, True), (mean, False)):
        middle = (v.subs(xi, 0), sympy.diff(v, xi).subs(xi, 0))
        average = (printed.mean_displacement_34(v), printed.mean_rotation_36(v))
        assert all((sympy.expand(e) == 0) is at_rest for e in middle)
        assert all((sympy.expand(e) == 0) is not at_rest for e in average)


# (4), (5), (6), (9) in three dimensions, by differentiation of (1)

ANGLES = sympy.symbols("psi theta chi")
ANGLE_RATES = sympy.symbols("psidot thetadot chidot")
ANGLE_ACCELERATIONS = sympy.symbols("psiddot thetaddot chiddot")


def vector(name: str) -> Matrix:
    return Matrix(sympy.symbols(f"{name}1:4"))


def general_rotation() -> Matrix:
    """Three elementary turns, about e3, e1 and e3."""
    psi, theta, chi = ANGLES

    def about_3(angle: Symbol) -> Matrix:
        return Matrix([[cos(angle), -sin(angle), 0], [sin(angle), cos(angle), 0], [0, 0, 1]])

    about_1 = Matrix([[1, 0, 0], [0, cos(theta), -sin(theta)], [0, sin(theta), cos(theta)]])
    return about_3(psi) * about_1 * about_3(chi)


def expanded(matrix: Matrix) -> Matrix:
    """Expanded, without squares (and so without higher powers) of the sines: a normal form."""

    def without_squares(entry: Expr) -> Expr:
        entry = sympy.expand(entry)
        while squares := [p for p in entry.atoms(sympy.Pow) if isinstance(p.base, sin) and p.exp > 1]:
            lowered = {p: (1 - cos(p.base.args[0]) ** 2) * p.base ** (p.exp - 2) for p in squares}
            entry = sympy.expand(entry.xreplace(lowered))
        return entry

    return matrix.applyfunc(without_squares)


def differential(tensor: Matrix, flow: dict[Symbol, Expr]) -> Matrix:
    return tensor.applyfunc(lambda entry: brute_force.differential(entry, flow))


def axial_vector(skew: Matrix) -> Matrix:
    """p with skew . v = p x v, as defined under (6)."""
    assert expanded(skew + skew.T) == sympy.zeros(3, 3)
    p = Matrix([skew[2, 1], skew[0, 2], skew[1, 0]])
    v = vector("anyv")
    assert expanded(skew * v - p.cross(v)) == sympy.zeros(3, 1)
    return p


def flow(names: str, changes: str) -> dict[Symbol, Expr]:
    """c -> cdot and so on for the three components."""
    return dict(zip(vector(names), vector(changes), strict=True))


TIME = (
    dict(zip((*ANGLES, *ANGLE_RATES), (*ANGLE_RATES, *ANGLE_ACCELERATIONS), strict=True))
    | flow("c", "cdot")
    | flow("cdot", "cddot")
    | flow("u", "udot")
    | flow("udot", "uddot")
)


def motion_1(Q: Matrix) -> Matrix:
    return vector("c") + Q * (vector("X") + vector("u"))


def test_5_is_the_second_derivative_of_1() -> None:
    Q = general_rotation()
    # omega from Q^c . Qdot; brought to normal form first, which keeps the products below short.
    omega = axial_vector(expanded(Q.T * differential(Q, TIME)))
    omegadot = differential(omega, TIME)
    derived = differential(differential(motion_1(Q), TIME), TIME)
    stated = printed.acceleration_5(
        vector("cddot"), Q, omega, omegadot, vector("X") + vector("u"), vector("udot"), vector("uddot")
    )
    assert expanded(derived - stated) == sympy.zeros(3, 1)


def test_6_is_the_variation_of_1() -> None:
    Q = general_rotation()
    variation = (
        dict(zip(ANGLES, sympy.symbols("delta_psi delta_theta delta_chi"), strict=True))
        | flow("c", "delta_c")
        | flow("u", "delta_u")
    )
    delta_pi = axial_vector(expanded(Q.T * differential(Q, variation)))
    derived = differential(motion_1(Q), variation)
    stated = printed.virtual_displacement_6(
        vector("delta_c"), Q, delta_pi, vector("X") + vector("u"), vector("delta_u")
    )
    assert expanded(derived - stated) == sympy.zeros(3, 1)


def test_5_of_a_point_on_a_turntable() -> None:
    """Numbers known by heart: centripetal, Euler and Coriolis acceleration at radius 2, spin 3."""
    e1, e3, zero, Q = Matrix([1, 0, 0]), Matrix([0, 0, 1]), sympy.zeros(3, 1), sympy.eye(3)
    assert printed.acceleration_5(zero, Q, 3 * e3, zero, 2 * e1, zero, zero) == Matrix([-18, 0, 0])
    assert printed.acceleration_5(zero, Q, zero, 5 * e3, 2 * e1, zero, zero) == Matrix([0, 10, 0])
    assert printed.acceleration_5(zero, Q, 3 * e3, zero, zero, e1, zero) == Matrix([0, 6, 0])


def stretched_body() -> tuple[Matrix, Matrix, Matrix]:
    """The map X -> x of (1) with a displacement field of constant and linear gradient, nabla u, and Q."""
    X = vector("X")
    linear, quadratic = (Matrix(3, 3, sympy.symbols(f"{name}1:4(1:4)")) for name in "gh")
    u = linear * X + quadratic * Matrix([X[1] * X[2], X[2] * X[0], X[0] ** 2])
    nabla_u = Matrix(3, 3, lambda i, j: sympy.diff(u[j], X[i]))
    Q = general_rotation()
    return vector("c") + Q * (X + u), nabla_u, Q


def test_4_is_the_gradient_of_1() -> None:
    x, nabla_u, Q = stretched_body()
    dX = vector("dX")
    dx = differential(x, flow("X", "dX"))
    assert expanded(dx - printed.deformation_4(Q, nabla_u) * dX) == sympy.zeros(3, 1)


def test_9_is_the_stretch_of_line_elements() -> None:
    """dx . dx - dX . dX = 2 dX . E . dX for any line element; E is symmetric and blind to the rotation."""
    x, nabla_u, Q = stretched_body()
    dX = vector("dX")
    # A rotation does not change a length: the left side is taken from the unturned body.
    F = printed.deformation_4(Q, nabla_u)
    E = expanded(printed.green_lagrange_9(F))
    unturned = dict.fromkeys(ANGLES, 0)
    dx = differential(x.subs(unturned), flow("X", "dX"))
    stretch = dx.dot(dx) - dX.dot(dX)
    assert sympy.expand(stretch - 2 * (dX.T * E * dX)[0]) == 0
    assert E.T == E
    assert E.atoms(sin, cos) == set()
