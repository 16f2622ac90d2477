"""The stability of integrators on the undamped oscillator qddot = -omega^2 q, from their coefficients.

A step of length h multiplies its states by a matrix that depends on y = omega h alone. For a Runge-Kutta method with
the coefficients A, b the eigenvalues are R(+-iy), R(z) = 1 + z b^T (1 - z A)^-1 1 (Hairer & Wanner, Solving Ordinary
Differential Equations II, IV.2); for a BDF they are roots of its characteristic polynomial; for the generalised-alpha
method those of a 3 x 3 matrix (Arnold & Bruels 2007).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.integrate import DOP853, RK45
from scipy.optimize import brentq

from derive.runtime.native_call import Matrix, Vector

Growth = Callable[[float], float]
"""The spectral radius of a step as a function of y = omega h."""

GRID = np.linspace(0.0, 20.0, 2001)[1:]
"""The y at which growth is evaluated first."""

VISIBLE = 1e-9
"""Growth per step above this counts: eigenvalues that are double have an error of the root of that of rounding."""

RK4_STAGES: tuple[Matrix, Vector] = (np.diag([0.5, 0.5, 1.0], -1), np.array([1, 2, 2, 1]) / 6)
"""The coefficients A and b of the classical Runge-Kutta method."""


def runge_kutta(A: Matrix, b: Vector) -> Growth:
    """The growth of an explicit Runge-Kutta method with the coefficients A (s, s) and weights b (s,)."""
    coefficients, powers = [1.0], np.ones(len(b))
    for _ in b:
        coefficients.append(float(b @ powers))
        powers = A @ powers
    return lambda y: float(abs(np.polynomial.polynomial.polyval(1j * y, coefficients)))


def classical() -> Growth:
    """The growth of the classical Runge-Kutta method of order 4."""
    return runge_kutta(*RK4_STAGES)


def dormand_prince_8() -> Growth:
    """The growth of the method of Dormand and Prince of order 8, with the coefficients of SciPy."""
    stages = DOP853.n_stages
    return runge_kutta(DOP853.A[:stages, :stages], DOP853.B)


def dormand_prince_5() -> Growth:
    """The growth of the method of Dormand and Prince of order 5, with the coefficients of SciPy."""
    stages = RK45.n_stages
    return runge_kutta(np.pad(RK45.A, ((0, 0), (0, stages - RK45.A.shape[1]))), RK45.B)


def generalised_alpha(rho: float) -> Growth:
    """The growth of the generalised-alpha method with the spectral radius `rho`; it is the trapezoidal rule for 1."""
    alpha_m, alpha_f = (2 * rho - 1) / (rho + 1), rho / (rho + 1)
    gamma = 0.5 + alpha_f - alpha_m
    beta = (gamma + 0.5) ** 2 / 4

    def growth(y: float) -> float:
        # of [q, h v, h^2 a]; (1 - alpha_m) a_1 + alpha_m a_0 = -omega^2 [(1 - alpha_f) q_1 + alpha_f q_0]
        after = np.array([[1, 0, -beta], [0, 1, -gamma], [y**2 * (1 - alpha_f), 0, 1 - alpha_m]])
        before = np.array([[1, 1, 0.5 - beta], [0, 1, 1 - gamma], [-(y**2) * alpha_f, 0, -alpha_m]])
        return float(np.abs(np.linalg.eigvals(np.linalg.solve(after, before))).max())

    return growth


def bdf(order: int) -> Growth:
    """The growth of the backward differentiation formula of an order, with constant steps."""
    differences = [np.polynomial.polynomial.polypow([1, -1], j) / j for j in range(1, order + 1)]
    sums = np.zeros(order + 1, dtype=complex)  # of the powers of 1/z
    for difference in differences:
        sums[: len(difference)] += difference

    def growth(y: float) -> float:
        shifted = sums.copy()
        shifted[0] -= 1j * y
        return float(np.abs(np.roots(shifted)).max())

    return growth


def step_limit(growth: Growth) -> float:
    """The largest y = omega h up to which no step grows; infinite if no step does, 0 if the smallest ones do."""
    sizes = np.array([growth(y) for y in GRID]) - 1 - VISIBLE
    if not np.any(sizes > 0):
        return float("inf")
    first = int(np.argmax(sizes > 0))
    if first == 0:
        return 0.0
    return float(brentq(lambda y: growth(y) - 1 - VISIBLE, GRID[first - 1], GRID[first], xtol=1e-12))


def last_growth(growth: Growth) -> float:
    """The largest y at which steps grow, of methods that are stable beyond it; 0 if no step does."""
    growing = [y for y in GRID if growth(y) > 1 + VISIBLE]
    return float(growing[-1]) if growing else 0.0
