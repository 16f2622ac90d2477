"""Mechanisms in minimal coordinates, by Lagrange's equations: reference motions that share nothing with the package.

`Lagrangian` takes positions and rotations of bodies as expressions in a few coordinates. `OneDegree` takes them as
functions of one coordinate that is an angle; derivatives with respect to it are those of Fourier series, whose error is
that of rounding if the functions are smooth enough for `GRID` points.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp
from scipy.integrate import solve_ivp

GRID = 256
Array = np.ndarray


@dataclass(frozen=True)
class MovingBody:
    """A rigid body with its inertia tensor in its own axes, the position of its centre of mass, and its rotation."""

    mass: float
    inertia: Sequence[Sequence[float]]
    x: sp.Matrix
    R: sp.Matrix


def turned(axis: str, angle: sp.Expr) -> sp.Matrix:
    """The rotation about a coordinate axis."""
    k = "xyz".index(axis)
    i, j = (k + 1) % 3, (k + 2) % 3
    R = sp.eye(3)
    R[i, i] = R[j, j] = sp.cos(angle)
    R[j, i], R[i, j] = sp.sin(angle), -sp.sin(angle)
    return R


class Lagrangian:
    """M(q) qddot + h(q, qdot) = 0, with a potential V and a dissipation function, whose derivatives are forces."""

    def __init__(
        self,
        q: Sequence[sp.Symbol],
        bodies: Sequence[MovingBody],
        V: sp.Expr,
        dissipation: Callable[[sp.Matrix], sp.Expr] | None = None,
    ) -> None:
        coordinates, rates = sp.Matrix(q), sp.Matrix([sp.Symbol(f"{s.name}dot") for s in q])
        M = sp.zeros(len(q))
        for body in bodies:
            J = body.x.jacobian(coordinates)
            spin = sp.Matrix.hstack(*(_axial(body.R.T * body.R.diff(s)) for s in q))
            M += body.mass * J.T * J + spin.T * sp.Matrix(body.inertia) * spin
        T = (rates.T * M * rates)[0] / 2
        momentum = M * rates
        h = momentum.jacobian(coordinates) * rates - sp.Matrix([T]).jacobian(coordinates).T
        h += sp.Matrix([V]).jacobian(coordinates).T
        if dissipation is not None:
            h += sp.Matrix([dissipation(rates)]).jacobian(rates).T
        self.n = len(q)
        self._functions = sp.lambdify([*q, *rates], [M, h, T, V], modules="numpy", cse=True)

    def accelerations(self, q: Sequence[float], qdot: Sequence[float]) -> Array:
        """qddot (n,)."""
        M, h, *_ = self._functions(*q, *qdot)
        return -np.linalg.solve(np.array(M, float), np.array(h, float)[:, 0])

    def energy(self, q: Sequence[float], qdot: Sequence[float]) -> float:
        """T + V."""
        *_, T, V = self._functions(*q, *qdot)
        return float(T + V)

    def motion(self, q: Sequence[float], qdot: Sequence[float], times: Array, method: str = "DOP853") -> Array:
        """q and qdot at times (times, 2n), integrated with tolerances of 1e-12."""
        n = self.n

        def rates(t: float, y: Array) -> Array:
            return np.concatenate([y[n:], self.accelerations(y[:n], y[n:])])

        span, start = (0.0, float(times[-1])), [*q, *qdot]
        found = solve_ivp(rates, span, start, method, times, rtol=1e-12, atol=1e-13)
        assert found.success, found.message
        return np.asarray(found.y.T)


def _axial(W: sp.Matrix) -> sp.Matrix:
    return sp.Matrix([W[2, 1] - W[1, 2], W[0, 2] - W[2, 0], W[1, 0] - W[0, 1]]) / 2


@dataclass(frozen=True, eq=False)
class Path:
    """A body along the motion of a mechanism: centres of mass (GRID, 3) and rotations (GRID, 3, 3)."""

    mass: float
    inertia: Array
    x: Array
    R: Array


def grid() -> Array:
    """The values of the angle at which paths are known."""
    return np.arange(GRID) * 2 * np.pi / GRID


class OneDegree:
    """m(s) sddot + m'(s) sdot^2 / 2 + V'(s) = 0 for bodies whose motion depends on one angle s."""

    def __init__(self, bodies: Sequence[Path], gravity: Sequence[float]) -> None:
        mass, V = np.zeros(GRID), np.zeros(GRID)
        for body in bodies:
            velocity = _derivative(body.x)
            W = np.einsum("kji,kjl->kil", body.R, _derivative(body.R))
            spin = np.stack([W[:, 2, 1] - W[:, 1, 2], W[:, 0, 2] - W[:, 2, 0], W[:, 1, 0] - W[:, 0, 1]], axis=1) / 2
            mass += body.mass * (velocity**2).sum(axis=1) + np.einsum("ki,ij,kj->k", spin, body.inertia, spin)
            V -= body.mass * body.x @ np.array(gravity)
        self._mass, self._V = _Series(mass), _Series(V)

    def acceleration(self, s: float, sdot: float) -> float:
        """sddot."""
        return -(self._mass.slope(s) * sdot**2 / 2 + self._V.slope(s)) / self._mass(s)

    def energy(self, s: float, sdot: float) -> float:
        """T + V."""
        return self._mass(s) * sdot**2 / 2 + self._V(s)

    def motion(self, s: float, sdot: float, times: Array) -> Array:
        """s and sdot at times (times, 2)."""
        found = solve_ivp(
            lambda t, y: [y[1], self.acceleration(y[0], y[1])],
            (0, times[-1]),
            [s, sdot],
            "DOP853",
            times,
            rtol=1e-12,
            atol=1e-13,
        )
        return np.asarray(found.y.T)

    @cached_property
    def tail(self) -> float:
        """The size of the last coefficients of the series, relative to the largest: whether the grid is fine enough."""
        return max(self._mass.tail, self._V.tail)


class _Series:
    def __init__(self, values: Array) -> None:
        self._c = np.fft.rfft(values) / GRID
        self._c[1:] *= 2
        self._n = np.arange(len(self._c))
        self.tail = float(np.abs(self._c[-GRID // 8 :]).max() / np.abs(self._c).max())

    def __call__(self, s: float) -> float:
        return float((self._c * np.exp(1j * self._n * s)).sum().real)

    def slope(self, s: float) -> float:
        return float((1j * self._n * self._c * np.exp(1j * self._n * s)).sum().real)


def _derivative(values: Array) -> Array:
    """The derivative by the angle of values on the grid (GRID, ...)."""
    c = np.fft.fft(values, axis=0)
    n = np.fft.fftfreq(GRID, 1 / GRID)
    n[GRID // 2] = 0
    return np.real(np.fft.ifft(1j * n.reshape(-1, *[1] * (values.ndim - 1)) * c, axis=0))
