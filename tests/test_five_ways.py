"""One number, five ways: SymPy, the interpreter, CasADi, the generated Python and the compiled C.

The reference is SymPy, evaluated to 40 digits by mpmath. An error is measured against the sum of the magnitudes of
what is added up: a number that cancels cannot be better than its parts.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from typing import Any

import casadi as ca
import mpmath
import numpy as np
import pytest
import sympy as sp

import beams
from derive.ir.expressions import Number
from derive.ir.interpreter import interpret
from derive.lowering.flat.context import Context

TOLERANCE = 1e-14
FEW = [*((frame, 2) for frame in beams.FRAMES), ("mean", 1), ("point", 5)]
"""Every frame, the smallest number of shapes, and many that nothing decouples."""
CASES = [
    pytest.param(frame, n, marks=() if (frame, n) in FEW else pytest.mark.long)
    for frame in beams.FRAMES
    for n in (1, 2, 5, 8)
]
P = np.array([1.3, 0.7, 2.1])


@dataclass(frozen=True)
class Magnitude:
    """The sum of the magnitudes of all that is added up on the way to a number."""

    value: float

    def _binary(self, other: Any, combine: Callable[[float, float], float]) -> Magnitude:
        return Magnitude(combine(self.value, other.value))

    def __add__(self, other: Any) -> Magnitude:
        return self._binary(other, float.__add__)

    __sub__ = __add__

    def __mul__(self, other: Any) -> Magnitude:
        return self._binary(other, float.__mul__)

    def __truediv__(self, other: Any) -> Magnitude:
        return self._binary(other, float.__truediv__)

    def __neg__(self) -> Magnitude:
        return self


def magnitudes(values: Iterable[float]) -> list[Magnitude]:
    return [Magnitude(abs(float(x))) for x in values]


def one(_: Any) -> Magnitude:
    return Magnitude(1.0)


def kernel_of(frame: str, n: int, name: str, arguments: dict[str, Any], **options: Any) -> list[Any]:
    """All outputs of a kernel, one after the other, by the interpreter."""
    kernel = beams.made(frame, n).model.kernel(name)
    given = {a.name: arguments[a.name] for a in kernel.arguments}
    outputs = interpret(kernel, given, **options)
    return [value for output in kernel.outputs for value in outputs[output.name]]


def scales(frame: str, n: int, name: str, arguments: dict[str, Any]) -> np.ndarray:
    """The magnitudes behind each output of a kernel."""
    given = {k: Magnitude(abs(x)) if np.isscalar(x) else magnitudes(x) for k, x in arguments.items()}
    options: dict[str, Any] = {"number": lambda x: Magnitude(abs(float(x))), "functions": {"sin": one, "cos": one}}
    return np.array([m.value for m in kernel_of(frame, n, name, given, check=False, **options)])


@cache
def functions_by_sympy(frame: str, n: int) -> dict[str, Callable[..., list[Any]]]:
    """M, h, energies, momenta, markers and the residual of the derivation as functions of q, v, a, p by mpmath."""
    eq = beams.made(frame, n).equations
    kernels = beams.made(frame, n).model
    symbols = [c.q for c in eq.coordinates] + [row.v for row in eq.rows] + [row.a for row in eq.rows]
    symbols += [p.symbol for p in eq.parameters]
    defined = [(c.symbol, c.value) for c in eq.coefficients] + [(d.symbol, d.expr) for d in eq.definitions]

    def function(expressions: Iterable[sp.Expr], local: Iterable[Any] = ()) -> Callable[..., list[Any]]:
        lines = defined + [(d.symbol, d.expr) for d in local]  # assigned before the results, in this order
        made: Callable[..., list[Any]] = sp.lambdify(symbols, list(expressions), "mpmath", cse=lambda e: (lines, e))
        return made

    result = {
        "mass": function(eq.mass[i, j] for i, j in kernels.pattern("mass", "M").entries),
        "force": function(eq.force),
        "energy": function([eq.kinetic_energy, eq.strain_energy]),
        "momentum": function([*eq.linear_momentum, *eq.angular_momentum]),
        "residual": function(eq.sum_of(row.name) for row in eq.rows),
    }
    for marker in eq.markers:
        pattern = kernels.pattern(f"marker_{marker.name}", "jacobian")
        jacobian = [marker.jacobian[i, j] for i, j in pattern.entries]
        motion = [*marker.position, *marker.velocity, *jacobian]
        result[f"marker_{marker.name}"] = function(motion, marker.definitions)
    return result


def equations_by_sympy(frame: str, n: int, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> dict[str, np.ndarray]:
    """The values of `functions_by_sympy` to 40 digits."""
    with mpmath.workdps(40):
        values = [mpmath.mpf(float(x)) for x in (*q, *v, *a, *P)]
        found = {name: function(*values) for name, function in functions_by_sympy(frame, n).items()}
        found["residual"] = [mpmath.mpf(0)] * len(v) + found["residual"]  # the test takes qdot = v
    return {name: np.array(numbers, dtype=object) for name, numbers in found.items()}


def mass_and_force_by_casadi(frame: str, n: int, q: np.ndarray, v: np.ndarray, k: np.ndarray) -> np.ndarray:
    """M and h from the derivation straight through CasADi, past graph, schedule and interpreter."""
    made = beams.made(frame, n)
    context = Context(made.equations)
    symbols = context.symbols(context.q, context.v)
    entries = made.model.pattern("mass", "M").entries
    outputs = [symbols(made.equations.mass[i, j]) for i, j in entries] + [symbols(h) for h in made.equations.force]
    function = ca.Function("both", [ca.vertcat(*symbols.inputs)], [ca.vertcat(*outputs)])
    named = dict(zip((c.name for c in made.model.constants), k, strict=True))
    named |= dict(zip(context.names, q, strict=True)) | dict(zip(context.rates, v, strict=True))
    unused = 0.0  # a coefficient that no kernel reads is not in k
    leaves = [float(x.value) if isinstance(x, Number) else named.get(x.name, unused) for x in symbols.leaves]
    return np.array(function(leaves)).ravel()


def worst(found: Iterable[float], reference: np.ndarray, scale: np.ndarray) -> float:
    """The largest error in units of its scale; where the scale is zero, both must be."""
    error = np.array([float(abs(mpmath.mpf(float(x)) - r)) for x, r in zip(found, reference, strict=True)])
    assert np.all(error[scale == 0] == 0)
    return float(np.max(error[scale > 0] / scale[scale > 0], initial=0.0))


@pytest.mark.parametrize(("frame", "n"), CASES)
def test_all_ways_agree(frame: str, n: int) -> None:
    native, module = beams.native(frame, n), beams.module(frame, n)
    k = native.setup(P)
    assert np.array_equal(k, module["setup"](P))
    assert np.array_equal(k, kernel_of(frame, n, "setup", {"p": P}))
    q, v = beams.state(n, 0)
    a = np.random.default_rng(0).uniform(-9, 9, n + 3)
    y, ydot = np.concatenate([q, v]), np.concatenate([v, a])
    reference = equations_by_sympy(frame, n, q, v, a)
    arguments = {"t": 0.0, "q": q, "v": v, "k": k, "y": y, "ydot": ydot}
    python_arguments = {"residual": (0.0, y, ydot, k), "force": (0.0, q, v, k), "mass": (q, k)}
    c_results = {
        "mass": native.mass(q, k),
        "force": native.force(0.0, q, v, k),
        "energy": native.energy(q, v, k),
        "momentum": native.momentum(q, v, k),
        "residual": native.residual(0.0, y, ydot, k),
        **{f"marker_{m}": np.concatenate(native.marker(m, q, v, k)) for m in native.markers},
    }
    by_casadi = mass_and_force_by_casadi(frame, n, q, v, k)
    both = [*reference["mass"], *reference["force"]]
    both_scale = np.concatenate([scales(frame, n, name, arguments) for name in ("mass", "force")])
    assert worst(by_casadi, np.array(both, dtype=object), both_scale) < TOLERANCE
    assert worst(np.concatenate(native.mass_force(0.0, q, v, k)), np.array(both, dtype=object), both_scale) < TOLERANCE
    for name, expected in reference.items():
        scale = scales(frame, n, name, arguments)
        of_python = module[name](*python_arguments.get(name, (q, v, k)))
        flat = np.concatenate(of_python) if isinstance(of_python, tuple) else of_python
        assert worst(kernel_of(frame, n, name, arguments), expected, scale) < TOLERANCE, name
        assert worst(flat, expected, scale) < TOLERANCE, name
        assert worst(c_results[name], expected, scale) < TOLERANCE, name


@pytest.mark.parametrize(("frame", "n"), CASES)
def test_accelerations_solve_the_equations(frame: str, n: int) -> None:
    """The interpreter in 60 digits gives the exact solution; doubles agree up to the condition of M."""
    native, module = beams.native(frame, n), beams.module(frame, n)
    k = native.setup(P)
    q, v = beams.state(n, 0)
    with mpmath.workdps(60):
        high: dict[str, Any] = {
            "number": lambda x: mpmath.mpf(x.numerator) / x.denominator,
            "functions": {"sin": mpmath.sin, "cos": mpmath.cos},
            "check": False,
        }
        p60, q60, v60 = ([mpmath.mpf(float(x)) for x in values] for values in (P, q, v))
        k60 = kernel_of(frame, n, "setup", {"p": p60}, **high)
        state60 = {"t": mpmath.mpf(0), "q": q60, "v": v60, "k": k60}
        a60 = kernel_of(frame, n, "accel", state60, **high)
        y60 = {"t": mpmath.mpf(0), "y": q60 + v60, "ydot": v60 + a60, "k": k60}
        residual = kernel_of(frame, n, "residual", y60, **high)
        force = kernel_of(frame, n, "force", state60, **high)
        assert max(map(abs, residual)) < mpmath.mpf(10) ** -40 * max(map(abs, force))
    a = np.array([float(x) for x in a60])
    condition = np.linalg.cond(module["dense"](module["MASS"], native.mass(q, k)))
    for found in (native.accel(0.0, q, v, k), module["accel"](0.0, q, v, k)):
        assert np.max(np.abs(found - a)) < TOLERANCE * max(10.0, condition) * np.max(np.abs(a))


@pytest.mark.parametrize(("frame", "n"), CASES)
def test_jacobian_is_the_derivative_of_the_residual(frame: str, n: int) -> None:
    """dF/dy + cj dF/dydot by complex steps, which do not cancel; no entry outside of the pattern."""
    native, module = beams.native(frame, n), beams.module(frame, n)
    k = native.setup(P)
    size, cj, step = 2 * (n + 3), 3.7, 1e-40
    rng = np.random.default_rng(n)
    y, ydot = np.concatenate(beams.state(n)), rng.uniform(-5, 5, size)
    steps = 1j * step * np.eye(size)
    numeric = module["residual"](0.0, y + steps, ydot + cj * steps, k).imag.T / step
    values = native.jacobian(0.0, y, ydot, cj, k)
    matrix = module["dense"](module["JACOBIAN"], values)
    scale = np.abs(numeric).max(axis=1, keepdims=True)
    assert np.max(np.abs(matrix - numeric) / scale) < 1e-13
    assert np.allclose(module["jacobian"](0.0, y, ydot, cj, k), values, rtol=1e-13, atol=0)
    assert {(i, i) for i in range(size)} <= set(native.jacobian_pattern.entries)


@pytest.mark.parametrize(("frame", "n"), CASES)
def test_power_balance(frame: str, n: int) -> None:
    """v . (M vdot + h) = d/dt (T + U) at any state and any acceleration."""
    native, module = beams.native(frame, n), beams.module(frame, n)
    k = native.setup(P)
    q, v = beams.state(n, 7)
    a = np.random.default_rng(n).uniform(-9, 9, n + 3)
    power = v @ native.residual(0.0, np.concatenate([q, v]), np.concatenate([v, a]), k)[n + 3 :]
    step = 1e-40
    change = module["energy"](q + 1j * step * v, v + 1j * step * a, k).imag.sum() / step
    assert math.isclose(power, change, rel_tol=1e-12)
