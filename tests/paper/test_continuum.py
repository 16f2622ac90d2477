"""(2), (3), (7) and (10)-(13) for a brick: fields that are polynomials with free or odd numbers, integrated exactly.

Nothing is assumed to be in equilibrium: stress, motion, acceleration and virtual displacement have nothing to do with
each other unless a test says so.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product

import sympy as sp
from sympy import Expr, Matrix, Rational

from . import printed, printed_continuum

X = sp.symbols("X1:4")
AT = Matrix(X)
BRICK = ((Rational(-1), Rational(1)), (Rational(0), Rational(1)), (Rational(1), Rational(3)))
RHO, MU, LAMDA = Rational(7, 3), Rational(5), Rational(3, 2)

EDGES = (Matrix([1, 0, 0]), Matrix([0, 1, 0]), Matrix([0, 0, 1]))


def numbers(seed: int) -> Callable[[], Rational]:
    """Small numbers without order, none of them zero."""
    state = seed

    def following() -> Rational:
        nonlocal state
        state = (state * 137 + 59) % 1009
        return Rational(state % 19 - 9 or 10, 4)

    return following


def field(seed: int, degree: int = 2) -> Matrix:
    """A vector field, polynomial in X."""
    number = numbers(seed)
    monomials = [a**i * b**j * c**k for i, j, k in product(range(degree + 1), repeat=3) if i + j + k <= degree
                 for a, b, c in [X]]  # fmt: skip
    return Matrix([sum(number() * monomial for monomial in monomials) for _ in range(3)])


def gradient(u: Matrix) -> Matrix:
    """nabla u: the entry (i, j) is the derivative of u_j by X_i."""
    return Matrix(3, 3, lambda i, j: sp.diff(u[j], X[i]))


def stress(seed: int) -> Matrix:
    """A symmetric tensor, linear in X."""
    a, b = field(seed, 1), field(seed + 1, 1)
    return Matrix([[a[0], a[1], a[2]], [a[1], b[0], b[1]], [a[2], b[1], b[2]]])


# A rotation with rational entries.
Q = Matrix([[2, -1, 2], [2, 2, -1], [-1, 2, 2]]) / 3
U, XDDOT, DELTA_X = field(11), field(23), field(31, 1)
PLACE = printed_continuum.position_1(Matrix([1, 2, 3]), Q, AT, U)
F = printed.deformation_4(Q, gradient(U))
DELTA_F = gradient(DELTA_X).T
T = stress(41)


def volume(integrand: Expr) -> Expr:
    for x, (low, high) in zip(X, BRICK, strict=True):
        integrand = sp.Poly(sp.expand(integrand), x).integrate(x)
        integrand = integrand.eval(high) - integrand.eval(low)
        integrand = integrand.as_expr() if isinstance(integrand, sp.Poly) else integrand
    return integrand


def surface(integrand: Callable[[Matrix], Expr]) -> Expr:
    """Over the six faces of the brick; the integrand takes the outward normal."""
    total = sp.S.Zero
    for axis, ends in enumerate(BRICK):
        for end, sign in zip(ends, (-1, 1), strict=True):
            on_face = sp.expand(integrand(sign * EDGES[axis])).subs(X[axis], end)
            # The volume of a brick of the length one along this axis.
            total += volume(on_face) / (ends[1] - ends[0])
    return total


def delta_E() -> Matrix:
    """The variation of (9)."""
    step = sp.Symbol("step")
    return printed.green_lagrange_9(F + step * DELTA_F).diff(step).subs(step, 0)


def test_difference_of_1_is_2() -> None:
    """The equality holds between any two points, near or far."""
    dX = Matrix(sp.symbols("dX1:4"))
    there = dict(zip(X, AT + dX, strict=True))
    moved = PLACE.xreplace(there) - PLACE
    assert (moved - printed_continuum.difference_2(Q, dX, U.xreplace(there), U)).expand() == sp.zeros(3, 1)


def test_2_is_3_with_4_for_near_points() -> None:
    dX, step = Matrix(sp.symbols("dX1:4")), sp.Symbol("step")
    there = dict(zip(X, AT + step * dX, strict=True))
    moved = printed_continuum.difference_2(Q, step * dX, U.xreplace(there), U)
    line = printed_continuum.line_element_3(printed.deformation_4(Q, gradient(U)), dX)
    assert (moved.diff(step).subs(step, 0) - line).expand() == sp.zeros(3, 1)


def test_12_is_the_force_of_the_cauchy_stress() -> None:
    """The second Piola-Kirchhoff stress is the T with sigma = F . T . F^c / det F; sigma acts on the deformed area."""
    G = Matrix(3, 3, sp.symbols("F1:4(1:4)"))
    t = sp.symbols("T1:7")
    S = Matrix([[t[0], t[1], t[2]], [t[1], t[3], t[4]], [t[2], t[4], t[5]]])
    for a, b in ((0, 1), (1, 2), (2, 0)):
        area, deformed = EDGES[a].cross(EDGES[b]), (G * EDGES[a]).cross(G * EDGES[b])
        force = G * S * (G.T * deformed) / G.det()
        load = printed_continuum.load_12(S, G, area)  # an area of one
        assert (force - load).applyfunc(sp.cancel) == sp.zeros(3, 1)


def test_7_is_the_balance_of_momentum_of_a_brick() -> None:
    """Integrated, (7) leaves the load on the faces and the body force less the mass times acceleration."""
    b = field(53, 1)
    residual = printed_continuum.momentum_7(T, F, RHO, b, XDDOT, X)
    for e in EDGES:
        forces = surface(lambda n, e=e: printed_continuum.load_12(T, F, n).dot(e)) + volume(RHO * b.dot(e))
        assert volume(residual.dot(e)) == forces - volume(RHO * XDDOT.dot(e)) != 0


def test_10_is_7_without_b_times_a_virtual_displacement() -> None:
    residual = printed_continuum.momentum_7(T, F, RHO, sp.zeros(3, 1), XDDOT, X)
    assert sp.expand(printed_continuum.virtual_work_10(T, F, RHO, XDDOT, DELTA_X, X) - residual.dot(DELTA_X)) == 0


def test_11_is_10_by_the_divergence_theorem() -> None:
    """The stress balances nothing: the left sides differ by their sign and by the work on the surface."""
    before = volume(printed_continuum.virtual_work_10(T, F, RHO, XDDOT, DELTA_X, X))
    inside = volume(printed_continuum.volume_11(T, delta_E(), RHO, XDDOT, DELTA_X))
    outside = surface(lambda n: printed_continuum.surface_11(T, F, n, DELTA_X))
    assert inside - outside == -before
    assert 0 not in (before, inside, outside)


def test_the_surface_term_of_11_is_the_work_of_12() -> None:
    for n in EDGES:
        work = printed_continuum.load_12(T, F, n).dot(DELTA_X)
        assert sp.expand(printed_continuum.surface_11(T, F, n, DELTA_X) - work) == 0


def test_13_is_11_with_the_stress_8_and_a_free_surface() -> None:
    E = printed.green_lagrange_9(F)
    inside = printed_continuum.volume_11(printed_continuum.stress_8(E, MU, LAMDA), delta_E(), RHO, XDDOT, DELTA_X)
    assert sp.expand(inside - printed_continuum.volume_13(E, delta_E(), MU, LAMDA, RHO, XDDOT, DELTA_X)) == 0


def test_the_first_term_of_13_is_the_variation_of_the_strain_energy() -> None:
    """The strain energy is mu E : E + lambda/2 tr(E)^2 per volume, varied along x + step delta x."""
    step = sp.Symbol("step")
    E = printed.green_lagrange_9(F + step * DELTA_F)
    energy = MU * (E * E).trace() + LAMDA / 2 * E.trace() ** 2
    none = sp.zeros(3, 1)
    first = printed_continuum.volume_13(E.subs(step, 0), delta_E(), MU, LAMDA, RHO, none, DELTA_X)
    assert sp.expand(energy.diff(step).subs(step, 0) - first) == 0
