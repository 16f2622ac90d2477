"""Checks of the generated code of a body in space by a cloud of point masses, at first and at second order."""

from __future__ import annotations

from typing import Any

import mpmath
import numpy as np
from numpy.typing import NDArray

import derive
from conftest import QUICK
from derive import Model
from derive.backends.c.source import CBackend
from derive.backends.python.backend import PythonBackend
from derive.runtime.compiled_model import Native

GRAVITY = (0.7, -0.3, -9.81)
STEP = 1e-40
"""Of derivatives by complex steps."""
Array = NDArray[np.float64]
Vector = list[Any]


def gravity() -> tuple[Any, ...]:
    found = derive.symbolic_body("g", 1, gravity=list(GRAVITY)).gravity
    assert found is not None
    return found


def turned(e: Vector, r: Vector) -> Vector:
    """e r e* / |e|^2."""
    x = times(times(e, [mpmath.mpf(0), *r]), [e[0], -e[1], -e[2], -e[3]])
    norm = sum(a * a for a in e)
    return [a / norm for a in x[1:]]


def times(a: Vector, b: Vector) -> Vector:
    """The product of quaternions."""
    return [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]


class CloudCode:
    """The functions of a model in C and in Python, with its constants for the parameters p."""

    def __init__(self, model: Model, p: Array | None = None) -> None:
        self.native: Native = derive.load(CBackend().files(model, "test"), QUICK)
        self.python: dict[str, Any] = {}
        exec(PythonBackend().files(model, "test")[0].text, self.python)
        self.k = self.native.setup() if p is None else self.native.setup(p)
        self.dense = self.python["dense"]

    def check_rows(self, q: Array, v: Array, a: Array, rows: Array, size: Array, bound: float) -> None:
        """M a + h in both languages, and what accelerations leave of the equations of motion."""
        native, python, k = self.native, self.python, self.k
        values, h = native.mass_force(0.0, q, v, k)
        mass = self.dense(python["MASS"], values)
        assert np.array_equal(mass, mass.T)
        assert np.max(np.abs(mass @ a + h - rows) / size) < bound
        by_python = self.dense(python["MASS"], python["mass"](q, k)) @ a + python["force"](0.0, q, v, k)
        assert np.max(np.abs(by_python - rows) / size) < bound
        solved = native.accel(0.0, q, v, k)
        assert np.max(np.abs(mass @ solved + h)) < 1e-12 * np.linalg.cond(mass) * np.max(np.abs(h))

    def check_jacobian(self, q: Array, v: Array, a: Array) -> None:
        """The iteration matrix by complex steps of the residual in Python."""
        y, ydot, cj = np.concatenate([q, v]), np.concatenate([self.native.rates(q, v, self.k), a]), 2.3
        steps = 1j * STEP * np.eye(len(y))
        numeric = self.python["residual"](0.0, y + steps, ydot + cj * steps, self.k).imag.T / STEP
        matrix = self.dense(self.python["JACOBIAN"], self.native.jacobian(0.0, y, ydot, cj, self.k))
        assert np.max(np.abs(matrix - numeric) / np.abs(numeric).max(axis=1, keepdims=True)) < 1e-12

    def check_marker(self, name: str, q: Array, v: Array, place: Vector) -> None:
        """The place of a marker, its velocity as the derivative by time, its Jacobian, and loads by virtual work."""
        native, python, k = self.native, self.python, self.k
        x, xdot, jacobian = native.marker(name, q, v, k)
        assert np.allclose(x, [float(z) for z in place], rtol=1e-14, atol=1e-14)
        moved = python[f"marker_{name}"](q + 1j * STEP * native.rates(q, v, k), v, k)[0]
        assert np.allclose(moved.imag / STEP, xdot, rtol=1e-12)
        dense = self.dense(native.marker_pattern(name), jacobian)
        assert np.allclose(dense @ v, xdot, rtol=1e-13, atol=1e-13)
        force = np.array([3.0, -2.0, 0.7])
        assert np.allclose(native.load(name, q, force, k), dense.T @ force, rtol=1e-13, atol=1e-13)
        assert np.allclose(python[f"load_{name}"](q, force, k), dense.T @ force, rtol=1e-13, atol=1e-13)
        for e, f in zip(python[f"marker_{name}"](q, v, k), (x, xdot, jacobian), strict=True):
            assert np.allclose(e, f, rtol=1e-13, atol=1e-14)

    def check_balances(self, q: Array, v: Array, a: Array, damped: float, masses: Array, places: Array) -> None:
        """v . (M vdot + h) less what damping takes is d/dt (T + U + V); gravity alone changes the momenta."""
        native, python, k = self.native, self.python, self.k
        qdot = native.rates(q, v, k)
        residual = native.residual(0.0, np.concatenate([q, v]), np.concatenate([qdot, a]), k)
        change = python["energy"](q + 1j * STEP * qdot, v + 1j * STEP * a, k).imag.sum() / STEP
        assert np.isclose(v @ residual[len(q) :] - damped, change, rtol=1e-11)
        free = native.accel(0.0, q, v, k)
        drift = python["momentum"](q + 1j * STEP * qdot, v + 1j * STEP * free, k).imag / STEP
        weight = np.outer(masses, GRAVITY)
        expected = np.concatenate([weight.sum(axis=0), np.cross(places, weight).sum(axis=0)])
        assert np.max(np.abs(drift - expected)) < 1e-9 * np.max(np.abs(free))


def check_lowerings(flat: CloudCode, loops: CloudCode, q: Array, v: Array, a: Array, bound: float) -> None:
    """Both lowerings agree relative to the largest value; accelerations as far as the mass matrix is conditioned."""
    y, ydot = np.concatenate([q, v]), np.concatenate([flat.native.rates(q, v, flat.k), a])

    def results(of: CloudCode) -> dict[str, Array]:
        native, k = of.native, of.k
        return {
            "mass": of.dense(native.mass_pattern, native.mass(q, k)),
            "force": native.force(0.0, q, v, k),
            "energy": native.energy(q, v, k),
            "momentum": native.momentum(q, v, k),
            "residual": native.residual(0.0, y, ydot, k),
            "jacobian": of.dense(native.jacobian_pattern, native.jacobian(0.0, y, ydot, 2.3, k)),
            "accel": native.accel(0.0, q, v, k),
        }

    of_flat, of_loops = results(flat), results(loops)
    condition = np.linalg.cond(of_flat["mass"])
    for name, values in of_flat.items():
        limit = max(bound, 1e-15 * condition) if name == "accel" else bound
        assert np.max(np.abs(values - of_loops[name])) < limit * np.max(np.abs(values)), name
