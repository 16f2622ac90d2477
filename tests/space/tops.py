"""Rotations in closed form: the free asymmetric body of Euler, and the symmetric top in gravity.

Both are Jacobi's elliptic functions of time, in 30 digits; the angles of precession are quadratures, by the rule of
Gauss with 24 points on pieces that are short compared with the periods. Rotations are those of body axes, R = Rz(phi)
Rx(theta) Rz(psi) about the axes of the turning frame. The errors are below 1e-14.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import mpmath
import numpy as np

DIGITS = 30
Real = Any
Rotation = np.ndarray


def euler_rotation(phi: Real, theta: Real, psi: Real) -> Rotation:
    """Rz(phi) Rx(theta) Rz(psi)."""
    return _about_z(phi) @ _about_x(theta) @ _about_z(psi)


def _about_z(a: Real) -> Rotation:
    c, s = float(mpmath.cos(a)), float(mpmath.sin(a))
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def _about_x(a: Real) -> Rotation:
    c, s = float(mpmath.cos(a)), float(mpmath.sin(a))
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def integrals(f: Callable[[Real], Sequence[Real]], times: Sequence[float], piece: Real) -> list[list[Real]]:
    """The integrals of the functions f from 0 to each of the times, over pieces of at most that length."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    result, total, start = [], [mpmath.mpf(0)] * len(f(mpmath.mpf(0))), mpmath.mpf(0)
    for time in times:
        end = mpmath.mpf(time)
        count = max(1, int(mpmath.ceil((end - start) / piece)))
        for i in range(count if end > start else 0):
            width = (end - start) / count
            middle = start + (i + mpmath.mpf("0.5")) * width
            for node, weight in zip(nodes, weights, strict=True):
                values = f(middle + width / 2 * mpmath.mpf(node))
                total = [a + width / 2 * mpmath.mpf(weight) * b for a, b in zip(total, values, strict=True)]
        result.append(total)
        start = end
    return result


@dataclass(frozen=True)
class EulerBody:
    """A free body with the principal moments of inertia I1 < I2 < I3, which turns with omega at t = 0, not rotated.

    |L|^2 > 2 T I2: the angular momentum L circles about the third axis, along which omega is positive.
    """

    inertia: tuple[float, float, float]
    omega: tuple[float, float, float]

    @cached_property
    def _constants(self) -> tuple[Real, ...]:
        I1, I2, I3 = map(mpmath.mpf, self.inertia)
        w = [mpmath.mpf(x) for x in self.omega]
        twice_T = sum(i * x * x for i, x in zip((I1, I2, I3), w, strict=True))
        L2 = sum((i * x) ** 2 for i, x in zip((I1, I2, I3), w, strict=True))
        assert I1 < I2 < I3 and twice_T * I2 < L2 and w[2] > 0
        sizes = [
            mpmath.sqrt((twice_T * I3 - L2) / (I1 * (I3 - I1))),
            mpmath.sqrt((twice_T * I3 - L2) / (I2 * (I3 - I2))),
            mpmath.sqrt((L2 - twice_T * I1) / (I3 * (I3 - I1))),
        ]
        rate = mpmath.sqrt((I3 - I2) * (L2 - twice_T * I1) / (I1 * I2 * I3))
        m = (I2 - I1) * (twice_T * I3 - L2) / ((I3 - I2) * (L2 - twice_T * I1))
        phase = mpmath.ellipf(mpmath.atan2(w[1] / sizes[1], w[0] / sizes[0]), m)
        return (*sizes, rate, m, phase, mpmath.sqrt(L2))

    def angular_velocity(self, t: Real) -> list[Real]:
        """omega in the axes of the body."""
        with mpmath.workdps(DIGITS):
            a1, a2, a3, rate, m, phase, _ = self._constants
            u = rate * mpmath.mpf(t) + phase
            return [a * mpmath.ellipfun(name, u, m=m) for a, name in ((a1, "cn"), (a2, "sn"), (a3, "dn"))]

    def rotations(self, times: Sequence[float]) -> list[Rotation]:
        """The rotation of the body at increasing times."""
        with mpmath.workdps(DIGITS):
            rate, L = self._constants[3], self._constants[6]

            def precession(t: Real) -> list[Real]:
                w1, w2, _ = self.angular_velocity(t)
                I1, I2, _ = self.inertia
                return [L * (I1 * w1 * w1 + I2 * w2 * w2) / ((I1 * w1) ** 2 + (I2 * w2) ** 2)]

            first = euler_rotation(*self._angles(mpmath.mpf(0), mpmath.mpf(0)))
            phis = integrals(precession, times, 1 / rate)
            return [first.T @ euler_rotation(*self._angles(t, phi)) for t, (phi,) in zip(times, phis, strict=True)]

    def _angles(self, t: Real, phi: Real) -> tuple[Real, Real, Real]:
        """Euler's angles to the axis of the angular momentum."""
        l1, l2, l3 = (i * w for i, w in zip(self.inertia, self.angular_velocity(t), strict=True))
        return phi, mpmath.atan2(mpmath.hypot(l1, l2), l3), mpmath.atan2(l1, l2)


@dataclass(frozen=True)
class SymmetricTop:
    """A top with a fixed point: moments of inertia A about it and C about its axis, weight times distance mgl.

    It starts inclined by theta, phi = psi = 0, with these rates of Euler's angles.
    """

    A: float
    C: float
    mgl: float
    theta: float
    phidot: float = 0.0
    thetadot: float = 0.0
    psidot: float = 0.0

    @cached_property
    def _constants(self) -> tuple[Real, ...]:
        A, C, mgl, theta = map(mpmath.mpf, (self.A, self.C, self.mgl, self.theta))
        u, s = mpmath.cos(theta), mpmath.sin(theta)
        phidot, thetadot, psidot = map(mpmath.mpf, (self.phidot, self.thetadot, self.psidot))
        spin = psidot + phidot * u
        a, b = C * spin / A, (A * phidot * s * s + C * spin * u) / A
        beta = 2 * mgl / A
        alpha = phidot**2 * s**2 + thetadot**2 + beta * u
        return a, b, alpha, beta, spin, u

    @cached_property
    def nutation(self) -> tuple[Real, Real, Real]:
        """The least and the largest u = cos theta, and the third root of du/dt = 0."""
        with mpmath.workdps(DIGITS + 20):
            a, b, alpha, beta, _, _ = self._constants
            cubic = [beta, -(alpha + a * a), 2 * a * b - beta, alpha - b * b]
            roots = sorted(mpmath.re(x) for x in mpmath.polyroots(cubic, maxsteps=500, extraprec=400))
            return roots[0], roots[1], roots[2]

    def inclination(self, t: Real) -> Real:
        """cos theta."""
        with mpmath.workdps(DIGITS):
            low, high, third = self.nutation
            beta, u = self._constants[3], self._constants[5]
            rate, m = mpmath.sqrt(beta * (third - low)) / 2, (high - low) / (third - low)
            part = min(max((u - low) / (high - low), mpmath.mpf(0)), mpmath.mpf(1)) if high > low else mpmath.mpf(0)
            phase = mpmath.ellipf(mpmath.asin(mpmath.sqrt(part)), m)
            if self.thetadot > 0:
                phase = -phase
            return low + (high - low) * mpmath.ellipfun("sn", rate * mpmath.mpf(t) + phase, m=m) ** 2

    def angles(self, times: Sequence[float]) -> list[tuple[Real, Real, Real]]:
        """phi, theta, psi at increasing times."""
        with mpmath.workdps(DIGITS):
            a, b, _, beta, spin, _ = self._constants
            low, _, third = self.nutation

            def rates(t: Real) -> list[Real]:
                u = self.inclination(t)
                precession = (b - a * u) / (1 - u * u)
                return [precession, spin - u * precession]

            piece = 1 / (mpmath.sqrt(beta * (third - low)) / 2)
            found = integrals(rates, times, piece / 2)
            return [(phi, mpmath.acos(self.inclination(t)), psi) for t, (phi, psi) in zip(times, found, strict=True)]

    def rotations(self, times: Sequence[float]) -> list[Rotation]:
        """The rotation of the body, whose axis is its third one, at increasing times."""
        return [euler_rotation(*angles) for angles in self.angles(times)]


def steady_precession(A: float, C: float, mgl: float, theta: float, spin: float) -> tuple[Real, Real]:
    """The two rates of precession at which theta is constant: A cos(theta) p^2 - C spin p + mgl = 0."""
    with mpmath.workdps(DIGITS):
        k = mpmath.mpf(A) * mpmath.cos(theta)
        root = mpmath.sqrt((mpmath.mpf(C) * spin) ** 2 - 4 * k * mgl)
        return (C * spin - root) / (2 * k), (C * spin + root) / (2 * k)
