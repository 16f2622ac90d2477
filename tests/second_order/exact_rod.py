"""A geometrically exact rod in the plane, inextensible and without shear: a Galerkin method in its angle theta(s).

A second truth besides finite elements, and independent of the derivation: it knows neither a floating frame nor shape
functions of the deflection. Mass, length and bending stiffness are 1, so that times are in sqrt(m l^3/EI) and loads
in EI/l^2. The axis is r(s) = r0 + int_0^s (cos theta, sin theta) for 0 <= s <= 1, whatever the deflection, with the
angle theta = sum b_k P_k(2 s - 1) in Legendre polynomials. d'Alembert's principle with dr/db_k = int_0^s P_k (-sin
theta, cos theta) gives M(b) b'' + h(b, b') = 0. Errors fall exponentially with the number of polynomials.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.polynomial import Legendre
from scipy.integrate import solve_ivp
from scipy.optimize import root

NODES = 24
"""Gauss points along the rod; all polynomials that they interpolate are integrated exactly."""


@dataclass(frozen=True, eq=False)
class Motion:
    """Instants t (n,), and the positions (n, 2) of the left end, of the middle and of the right end of the rod."""

    t: np.ndarray
    left: np.ndarray
    middle: np.ndarray
    right: np.ndarray
    energy: np.ndarray


@dataclass(frozen=True, eq=False)
class ExactRod:
    """A rod of so many angles: free with its centre of mass at rest, pinned or clamped along e1 at its left end.

    load: a dead force (2,) on its right end, in EI/l^2.
    """

    support: Literal["free", "pinned", "clamped"]
    angles: int = 12
    load: tuple[float, float] = (0.0, 0.0)

    @cached_property
    def nodes(self) -> tuple[np.ndarray, np.ndarray]:
        """s and weights of the Gauss points."""
        x, w = np.polynomial.legendre.leggauss(NODES)
        return (x + 1) / 2, w / 2

    @cached_property
    def primitive(self) -> np.ndarray:
        """The matrix from values at the Gauss points to integrals from 0 to them, and to s = 1/2 and 1."""
        s, w = self.nodes
        result = np.zeros((NODES + 2, NODES))
        for p in (Legendre.basis(n, domain=[0, 1]) for n in range(NODES)):
            parts = p.integ(lbnd=0)(np.append(s, [0.5, 1.0]))
            result += np.outer(parts, p(s) * w) / (w @ p(s) ** 2)
        return result

    @cached_property
    def fields(self) -> tuple[np.ndarray, np.ndarray]:
        """The angles for unit b_k, and their derivatives by s, at the Gauss points: (angles, nodes)."""
        clamped = self.support == "clamped"
        basis = [Legendre.basis(n, domain=[0, 1]) for n in range(clamped, self.angles + clamped)]
        s = self.nodes[0]
        return np.array([p(s) - clamped * p(0.0) for p in basis]), np.array([p.deriv()(s) for p in basis])

    def positions(self, density: np.ndarray) -> np.ndarray:
        """Integrals of a density of the tangent (..., nodes): at the Gauss points, the middle, the right and left end.

        The centre of mass of a free rod is at the origin.
        """
        at = density @ self.primitive.T
        at = np.concatenate([at, np.zeros((*at.shape[:-1], 1))], axis=-1)
        return at - (at[..., :NODES] @ self.nodes[1])[..., None] if self.support == "free" else at

    def equations(self, b: np.ndarray, rates: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """M (angles, angles) and h (angles,)."""
        (value, slope), w = self.fields, self.nodes[1]
        theta, spin = b @ value, rates @ value
        normal, tangent = np.array([-np.sin(theta), np.cos(theta)]), np.array([np.cos(theta), np.sin(theta)])
        moved = self.positions(value[:, None] * normal)
        bias = self.positions(-(spin**2) * tangent)
        inertia, end = moved[..., :NODES] * w, moved[..., NODES + 1]
        mass = np.einsum("kan,lan->kl", inertia, moved[..., :NODES])
        force = np.einsum("kan,an->k", inertia, bias[..., :NODES])
        return mass, force + (slope * w) @ (b @ slope) - end @ np.array(self.load)

    def energy(self, b: np.ndarray, rates: np.ndarray) -> float:
        """Kinetic and strain energy, and the potential of the load, in EI/l."""
        mass, _ = self.equations(b, rates)
        _, _, end = self.points(b)
        return float(rates @ mass @ rates + self.nodes[1] @ (b @ self.fields[1]) ** 2) / 2 - float(end @ self.load)

    def points(self, b: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The left end, the middle and the right end (2,) of the rod."""
        theta = b @ self.fields[0]
        at = self.positions(np.array([np.cos(theta), np.sin(theta)]))
        return at[:, NODES + 2], at[:, NODES], at[:, NODES + 1]

    def struck(self, velocity: Legendre, times: np.ndarray, tolerance: float = 1e-10) -> Motion:
        """The motion from the straight rod along e1, whose points move across it with a velocity given over 0..1."""
        slopes = velocity.deriv()(self.nodes[0])
        rates = np.linalg.lstsq(self.fields[0].T, slopes, rcond=None)[0]
        return self.motion(np.zeros(self.angles), rates, times, tolerance)

    def motion(self, b: np.ndarray, rates: np.ndarray, times: np.ndarray, tolerance: float = 1e-10) -> Motion:
        """The motion from a state, by DOP853."""

        def derivative(_: float, y: np.ndarray) -> np.ndarray:
            mass, force = self.equations(*np.split(y, 2))
            return np.concatenate([y[self.angles :], -np.linalg.solve(mass, force)])

        found = solve_ivp(
            derivative,
            (times[0], times[-1]),
            np.concatenate([b, rates]),
            method="DOP853",
            t_eval=times,
            rtol=tolerance,
            atol=tolerance,
        )
        assert found.success, found.message
        states = [np.split(y, 2) for y in found.y.T]
        points = (np.array(at) for at in zip(*(self.points(b) for b, _ in states), strict=True))
        return Motion(times, *points, np.array([self.energy(*y) for y in states]))

    def at_rest(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The left end, the middle and the right end (2,) in equilibrium under the load."""
        still = np.zeros(self.angles)
        found = root(lambda b: self.equations(b, still)[1], still, tol=1e-12)
        assert found.success, found.message
        return self.points(found.x)
