"""Mechanisms of rigid bodies by hand in NumPy, with the methods of a compiled scene: what the numerics is tested on.

Coordinates of a body are c1, c2, phi, its origin is its centre of mass, q and v have the same size.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from derive.ir.patterns import Pattern, pattern
from derive.roles import Role
from derive.runtime.native_call import ModelError

Array = NDArray[np.float64]
Point = tuple[float, float]
Time = Callable[[float], float]
Motion = tuple[Time, Time, Time]


@dataclass(frozen=True)
class Body:
    """A rigid body: kg, kg m^2."""

    name: str
    mass: float
    inertia: float


@dataclass(frozen=True)
class Pin:
    """Two points coincide; a body None is the ground."""

    name: str
    first: str | None
    at_first: Point
    second: str | None
    at_second: Point
    components: tuple[int, ...] = (0, 1)


@dataclass(frozen=True)
class Turn:
    """The rotation of the second body against the first is a function of time: its value and two derivatives."""

    name: str
    first: str | None
    second: str
    motion: Motion


@dataclass(frozen=True)
class Slide:
    """The coordinate c1 or c2 of a body is a function of time."""

    name: str
    body: str
    component: int
    motion: Motion


Condition = Pin | Turn | Slide


def steady(speed: float, offset: float = 0.0) -> Motion:
    """speed t + offset, with its derivatives."""
    return lambda t: speed * t + offset, lambda t: speed, lambda t: 0.0


class Double:
    """The contract of a compiled scene, for rigid bodies."""

    def __init__(self, bodies: tuple[Body, ...], conditions: tuple[Condition, ...], gravity: Point = (0.0, 0.0)):
        self.name, self.bodies = "double", tuple(b.name for b in bodies)
        self.conditions, self.gravity = conditions, gravity
        self.diagonal = np.array([m for b in bodies for m in (b.mass, b.mass, b.inertia)])
        self.nq = self.nv = len(self.diagonal)
        self.nk, self.proximal = 0, False
        self.roles = (Role.TRANSLATION, Role.TRANSLATION, Role.ROTATION) * len(self.bodies)
        self.coordinates = tuple(f"{b}_{c}" for b in self.bodies for c in ("c1", "c2", "phi"))
        self.rates = tuple(f"{c}_dot" for c in self.coordinates)
        self.multipliers = tuple(n for c in conditions for n in _names(c))
        self.drives = tuple(n for c in conditions if not isinstance(c, Pin) for n in _names(c))
        self.nlambda = len(self.multipliers)
        self.mass_pattern = pattern(self.nv, self.nv, {(i, i) for i in range(self.nv)}, symmetric=True)
        everywhere = {(i, j) for i in range(self.nlambda) for j in range(self.nq)}
        self.constraint_pattern: Pattern = pattern(self.nlambda, self.nq, everywhere)

    def setup(self, p: object = None) -> Array:
        return np.zeros(0)

    def mass(self, q: Array, k: Array) -> Array:
        return self.diagonal.copy()

    def force(self, t: float, q: Array, v: Array, k: Array) -> Array:
        return -self.diagonal * np.array([*self.gravity, 0.0] * len(self.bodies))

    def energy(self, q: Array, v: Array, k: Array) -> Array:
        potential = -sum(
            self.diagonal[3 * i] * (self.gravity[0] * q[3 * i] + self.gravity[1] * q[3 * i + 1])
            for i in range(len(self.bodies))
        )
        return np.array([0.5 * v @ (self.diagonal * v), 0.0, potential])

    def poses(self, t: float, q: Array, k: Array) -> Array:
        return np.reshape(q, (-1, 3)).copy()

    def constraints(self, t: float, q: Array, k: Array) -> Array:
        return np.concatenate([self._value(c, t, q) for c in self.conditions])

    def constraint_rates(self, t: float, q: Array, v: Array, k: Array) -> Array:
        return self._full(q) @ v + self._rate_of_time(t)

    def constraint_jacobian(self, t: float, q: Array, k: Array) -> Array:
        return self._full(q).T.ravel()

    def constraint_bias(self, t: float, q: Array, v: Array, k: Array) -> Array:
        return np.concatenate([self._bias(c, t, q, v) for c in self.conditions])

    def solve(self, t: float, q: Array, v: Array, k: Array) -> tuple[Array, Array]:
        found = self._kkt(q, -self.force(t, q, v, k), self.constraint_bias(t, q, v, k))
        return found[: self.nv], -found[self.nv :]

    def accel(self, t: float, q: Array, v: Array, k: Array) -> Array:
        return self.solve(t, q, v, k)[0]

    def project_velocity(self, t: float, q: Array, k: Array, r: Array) -> Array:
        return self._kkt(q, np.zeros(self.nv), r)[: self.nv]

    def _kkt(self, q: Array, upper: Array, lower: Array) -> Array:
        g = self._full(q)
        kkt = np.block([[np.diag(self.diagonal), g.T], [g, np.zeros((self.nlambda, self.nlambda))]])
        if not np.all(np.isfinite(kkt)):
            raise ModelError("double_solve", 2)
        if np.linalg.cond(kkt) > 1e13:
            raise ModelError("double_solve", 1)
        found = np.linalg.solve(kkt, np.concatenate([upper, lower]))
        if not np.all(np.isfinite(found)):
            raise ModelError("double_solve", 2)
        return found

    def _full(self, q: Array) -> Array:
        return np.vstack([self._gradient(c, q) for c in self.conditions])

    def _rate_of_time(self, t: float) -> Array:
        return np.concatenate([np.zeros(len(_names(c))) if isinstance(c, Pin) else [-c.motion[1](t)]
                               for c in self.conditions])  # fmt: skip

    def _value(self, c: Condition, t: float, q: Array) -> Array:
        if isinstance(c, Pin):
            apart = self._place(c.second, c.at_second, q)[0] - self._place(c.first, c.at_first, q)[0]
            return apart[list(c.components)]
        return self._gradient(c, q) @ q - c.motion[0](t)

    def _gradient(self, c: Condition, q: Array) -> Array:
        if isinstance(c, Pin):
            return (self._place(c.second, c.at_second, q)[1] - self._place(c.first, c.at_first, q)[1])[
                list(c.components)
            ]
        row = np.zeros((1, self.nq))
        if isinstance(c, Slide):
            row[0, 3 * self.bodies.index(c.body) + c.component] = 1.0
            return row
        row[0, 3 * self.bodies.index(c.second) + 2] = 1.0
        if c.first is not None:
            row[0, 3 * self.bodies.index(c.first) + 2] = -1.0
        return row

    def _bias(self, c: Condition, t: float, q: Array, v: Array) -> Array:
        if not isinstance(c, Pin):
            return np.array([c.motion[2](t)])
        total = np.zeros(2)
        for sign, body, at in ((1.0, c.second, c.at_second), (-1.0, c.first, c.at_first)):
            if body is not None:
                i = 3 * self.bodies.index(body)
                total += sign * v[i + 2] ** 2 * (self._place(body, at, q)[0] - q[i : i + 2])
        return total[list(c.components)]

    def _place(self, body: str | None, at: Point, q: Array) -> tuple[Array, Array]:
        jacobian = np.zeros((2, self.nq))
        if body is None:
            return np.array(at), jacobian
        i = 3 * self.bodies.index(body)
        c, s = np.cos(q[i + 2]), np.sin(q[i + 2])
        arm = np.array([c * at[0] - s * at[1], s * at[0] + c * at[1]])
        jacobian[:, i : i + 2] = np.eye(2)
        jacobian[:, i + 2] = [-arm[1], arm[0]]
        return q[i : i + 2] + arm, jacobian


def _names(c: Condition) -> tuple[str, ...]:
    return tuple(f"{c.name}_{i + 1}" for i in c.components) if isinstance(c, Pin) else (c.name,)
