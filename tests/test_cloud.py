"""Bodies in space against an oracle that knows no mechanics but x = c + Q (X + u).

A cloud of point masses is moved along a path with given rates and accelerations; x(t) is differentiated numerically in
50 digits and projected on the virtual displacements, which are differences of positions as well.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import mpmath
import numpy as np
import pytest

import derive
from conftest import QUICK
from derive import ModalBody, Model, NodalBody
from derive.backends.c.source import CBackend
from derive.backends.python.backend import PythonBackend
from derive.mechanics.bodies.spatial_body import parameters
from derive.mechanics.bodies.spatial_tables import symbolic_tables
from derive.runtime.compiled_model import Native

SHAPES = [pytest.param(n, marks=pytest.mark.long if n in (1, 3) else ()) for n in (0, 1, 3, 5)]
KINDS = ("numbers flat", "numbers loops", "parameters flat", "parameters loops")
FEW = [
    *((0, kind) for kind in ("numbers flat", "numbers loops")),
    (5, "numbers loops"),
    (1, "parameters flat"),
    (5, "parameters loops"),
]
"""No shapes, as many as are more than a vector, and all kinds; straight-line code of many modes is long."""
CASES = [
    pytest.param(n, kind, marks=() if (n, kind) in FEW else pytest.mark.long) for n in (0, 1, 3, 5) for kind in KINDS
]
POINTS = 10
GRAVITY = (0.7, -0.3, -9.81)
MASS_DAMPING, STIFFNESS_DAMPING = 0.1, 0.01


@dataclass(frozen=True)
class Cloud:
    masses: np.ndarray
    positions: np.ndarray
    modes: np.ndarray
    stiffness: np.ndarray


@cache
def cloud(n: int) -> Cloud:
    rng = np.random.default_rng(n)
    root = rng.uniform(-1, 1, (n, n))
    return Cloud(
        rng.uniform(0.1, 2, POINTS),
        rng.uniform(-1, 1, (POINTS, 3)),
        rng.uniform(-1, 1, (n, POINTS, 3)),
        root @ root.T * 50,
    )


def nodal(c: Cloud, frame: str = "given") -> NodalBody:
    """The cloud, damped, with two markers."""
    nodes = {"positions": c.positions, "mass": c.masses}
    if len(c.modes):
        nodes |= {"modes": c.modes, "modal_stiffness": c.stiffness}
    as_they_are = {"orthonormal": False} if len(c.modes) and frame == "given" else {}
    return derive.nodal_body(
        "cloud",
        nodes,
        units="SI",
        frame=frame,
        modes=len(c.modes),
        damping={"mass": MASS_DAMPING, "stiffness": STIFFNESS_DAMPING},
        markers={"first": 0, "last": 9},
        **as_they_are,
    )


def body(c: Cloud) -> ModalBody:
    """The cloud as numbers."""
    return derive.modal(nodal(c))


def gravity() -> tuple[Any, ...]:
    found = derive.symbolic_body("g", 1, gravity=list(GRAVITY)).gravity
    assert found is not None
    return found


@cache
def model(n: int, kind: str) -> Model:
    what, lowering = kind.split()
    if what == "numbers":
        equations = derive.derive_modal(body(cloud(n)), gravity(), lowering)
    else:
        spec = derive.symbolic_body("cloud", n, frame="given", damping=True, gravity=list(GRAVITY), lowering=lowering)
        equations = derive.derive(spec)
    return derive.lower(equations)


@cache
def compiled(n: int, kind: str) -> Native:
    return derive.load(CBackend().files(model(n, kind), "test"), QUICK)


@cache
def module(n: int, kind: str) -> dict[str, Any]:
    names: dict[str, Any] = {}
    exec(PythonBackend().files(model(n, kind), "test")[0].text, names)
    return names


def given(n: int, kind: str) -> np.ndarray:
    """The parameters p of the cloud: its integrals, where the model has them as parameters."""
    if kind == "numbers flat":
        return np.zeros(0)
    spec = derive.symbolic_body("cloud", n, frame="given", damping=True)
    tables = derive.derive_modal(body(cloud(n))).tables if kind == "numbers loops" else symbolic_tables(spec)
    return parameters(body(cloud(n)), tables)


def state(n: int, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(100 * n + seed)
    e = rng.normal(size=4)
    q = np.concatenate([rng.uniform(-2, 2, 3), e / np.linalg.norm(e), rng.uniform(-0.5, 0.5, n)])
    return q, rng.uniform(-2, 2, 6 + n), rng.uniform(-3, 3, 6 + n)


# ---- the oracle, in mpmath

Vector = list[Any]


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


def place(n: int, k: int, c: Vector, e: Vector, alpha: Vector) -> Vector:
    """x of point k, (1)."""
    body = cloud(n)
    r = [
        mpmath.mpf(body.positions[k, a]) + sum(alpha[i] * mpmath.mpf(body.modes[i, k, a]) for i in range(n))
        for a in range(3)
    ]
    return [a + b for a, b in zip(c, turned(e, r), strict=True)]


def damping_matrix(n: int) -> np.ndarray:
    """Proportional to the mass of the modes without their rigid motion, which is found by least squares here."""
    c = cloud(n)
    root = np.sqrt(c.masses)[:, None]
    turns = [np.cross(axis, c.positions) for axis in np.eye(3)]
    rigid = np.array([*(np.tile(axis, (POINTS, 1)) for axis in np.eye(3)), *turns])
    weighted, fields = ((root * f).reshape(len(f), 3 * POINTS) for f in (rigid, c.modes))
    rest = fields - np.linalg.lstsq(weighted.T, fields.T, rcond=None)[0].T @ weighted
    return MASS_DAMPING * rest @ rest.T + STIFFNESS_DAMPING * c.stiffness


def oracle(n: int, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows of the equations of motion and, for each, the sum of the magnitudes of what was added."""
    body = cloud(n)
    with mpmath.workdps(50):
        q_, v_, a_ = ([mpmath.mpf(float(x)) for x in values] for values in (q, v, a))
        e = q_[3:7]
        half = mpmath.mpf(1) / 2
        edot = [half * x for x in times(e, [0, *v_[3:6]])]
        eddot = [half * (x + y) for x, y in zip(times(edot, [0, *v_[3:6]]), times(e, [0, *a_[3:6]]), strict=True)]

        def path(t: Any, s0: Vector, s1: Vector, s2: Vector) -> Vector:
            return [x + t * y + t * t * z / 2 for x, y, z in zip(s0, s1, s2, strict=True)]

        def at(t: Any, k: int) -> Vector:
            c, alpha = path(t, q_[:3], v_[:3], a_[:3]), path(t, q_[7:], v_[6:], a_[6:])
            return place(n, k, c, path(t, e, edot, eddot), alpha)

        def varied(s: Any, row: int, k: int) -> Vector:
            c, alpha = list(q_[:3]), list(q_[7:])
            turn: Vector = [mpmath.mpf(1), 0, 0, 0]
            if row < 3:
                c[row] += s
            elif row < 6:
                turn[row - 2] = s / 2
            else:
                alpha[row - 6] += s
            return place(n, k, c, times(e, turn), alpha)

        h = mpmath.mpf(10) ** -12
        rows = [mpmath.mpf(0)] * (6 + n)
        sizes = [mpmath.mpf(0)] * (6 + n)
        for k in range(POINTS):
            before, now, after = at(-h, k), at(mpmath.mpf(0), k), at(h, k)
            falling = map(mpmath.mpf, GRAVITY)
            acceleration = [(x - 2 * y + z) / h**2 - g for x, y, z, g in zip(before, now, after, falling, strict=True)]
            for row in range(6 + n):
                ahead, behind = varied(h, row, k), varied(-h, row, k)
                for x, y, z in zip(acceleration, ahead, behind, strict=True):
                    power = mpmath.mpf(body.masses[k]) * x * (y - z) / (2 * h)
                    rows[row] += power
                    sizes[row] += abs(power)
        damping = damping_matrix(n)
        for i in range(n):
            for j in range(n):
                force = mpmath.mpf(body.stiffness[i, j]) * q_[7 + j] + mpmath.mpf(damping[i, j]) * v_[6 + j]
                rows[6 + i] += force
                sizes[6 + i] += abs(force)
    return np.array([float(x) for x in rows]), np.array([float(x) for x in sizes])


@cache
def expected_rows(n: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    return oracle(n, *state(n, seed))


@pytest.mark.parametrize(("n", "kind"), CASES)
def test_generated_code_is_the_oracle(n: int, kind: str) -> None:
    native, python = compiled(n, kind), module(n, kind)
    k = native.setup(given(n, kind))
    for seed in range(3):
        q, v, a = state(n, seed)
        expected, size = expected_rows(n, seed)
        values, h = native.mass_force(0.0, q, v, k)
        mass = python["dense"](python["MASS"], values)
        assert np.max(np.abs(mass @ a + h - expected) / size) < 1e-12
        by_python = python["dense"](python["MASS"], python["mass"](q, k)) @ a + python["force"](0.0, q, v, k)
        assert np.max(np.abs(by_python - expected) / size) < 1e-12
        qdot = native.rates(q, v, k)
        y, ydot = np.concatenate([q, v]), np.concatenate([qdot, a])
        residual = native.residual(0.0, y, ydot, k)
        assert np.max(np.abs(residual[: 7 + n])) < 1e-14
        assert np.max(np.abs(residual[7 + n :] - expected) / size) < 1e-12
        solved = native.accel(0.0, q, v, k)
        left = np.abs(mass @ solved + h)
        assert np.max(left) < 1e-12 * np.linalg.cond(mass) * np.max(np.abs(h))


@pytest.mark.parametrize("kind", ["numbers flat", "numbers loops"])
@pytest.mark.parametrize("n", SHAPES)
def test_jacobian_markers_and_loads(n: int, kind: str) -> None:
    native, python = compiled(n, kind), module(n, kind)
    k = native.setup()
    q, v, a = state(n, 5)
    y, ydot = np.concatenate([q, v]), np.concatenate([native.rates(q, v, k), a])
    size, cj, step = len(y), 2.3, 1e-40
    steps = 1j * step * np.eye(size)
    numeric_values = python["residual"](0.0, y + steps, ydot + cj * steps, k).imag.T / step
    matrix = python["dense"](python["JACOBIAN"], native.jacobian(0.0, y, ydot, cj, k))
    scale = np.abs(numeric_values).max(axis=1, keepdims=True)
    assert np.max(np.abs(matrix - numeric_values) / scale) < 1e-12
    force = np.array([3.0, -2.0, 0.7])
    for name, node in (("first", 0), ("last", 9)):
        x, xdot, jacobian = native.marker(name, q, v, k)
        with mpmath.workdps(30):
            expected = place(n, node, *([mpmath.mpf(float(z)) for z in part] for part in (q[:3], q[3:7], q[7:])))
        assert np.allclose(x, [float(z) for z in expected], rtol=1e-14, atol=1e-14)
        dense = python["dense"](native.marker_pattern(name), jacobian)
        assert np.allclose(dense @ v, xdot, rtol=1e-13, atol=1e-13)
        assert np.allclose(native.load(name, q, force, k), dense.T @ force, rtol=1e-13, atol=1e-13)
        assert np.allclose(python[f"load_{name}"](q, force, k), dense.T @ force, rtol=1e-13, atol=1e-13)
        by_python = python[f"marker_{name}"](q, v, k)
        assert all(
            np.allclose(e, f, rtol=1e-13, atol=1e-14) for e, f in zip(by_python, (x, xdot, jacobian), strict=True)
        )


@pytest.mark.parametrize("kind", ["numbers flat", "numbers loops"])
@pytest.mark.parametrize("n", SHAPES)
def test_power_balance_and_momentum(n: int, kind: str) -> None:
    """v . (M vdot + h) less what damping takes is d/dt (T + U + V); gravity alone changes the momenta."""
    native, python = compiled(n, kind), module(n, kind)
    k = native.setup()
    q, v, a = state(n, 9)
    qdot = native.rates(q, v, k)
    power = v @ native.residual(0.0, np.concatenate([q, v]), np.concatenate([qdot, a]), k)[7 + n :]
    power -= v[6:] @ damping_matrix(n) @ v[6:]
    step = 1e-40
    change = python["energy"](q + 1j * step * qdot, v + 1j * step * a, k).imag.sum() / step
    assert np.isclose(power, change, rtol=1e-11)
    free = native.accel(0.0, q, v, k)
    drift = python["momentum"](q + 1j * step * qdot, v + 1j * step * free, k).imag / step
    c = cloud(n)
    with mpmath.workdps(30):
        parts = [[mpmath.mpf(float(z)) for z in part] for part in (q[:3], q[3:7], q[7:])]
        points = np.array([[float(z) for z in place(n, node, *parts)] for node in range(POINTS)])
    weight = np.outer(c.masses, GRAVITY)
    expected = np.concatenate([weight.sum(axis=0), np.cross(points, weight).sum(axis=0)])
    assert np.max(np.abs(drift - expected)) < 1e-9 * np.max(np.abs(free))


@pytest.mark.parametrize(
    ("n", "what"),
    [
        pytest.param(n, what, marks=() if n in (0, 5) and what == "numbers" else pytest.mark.long)
        for n in (0, 1, 3, 5)
        for what in ("numbers", "parameters")
    ],
)
def test_both_lowerings_give_the_same(n: int, what: str) -> None:
    """They agree to 1e-14 of the largest value; accelerations as far as the mass matrix is conditioned."""
    flat, loops = compiled(n, f"{what} flat"), compiled(n, f"{what} loops")
    dense = module(n, f"{what} flat")["dense"]
    kf, kt = flat.setup(given(n, f"{what} flat")), loops.setup(given(n, f"{what} loops"))
    for seed in range(3):
        q, v, a = state(n, seed)
        y, ydot = np.concatenate([q, v]), np.concatenate([flat.rates(q, v, kf), a])

        calls = {
            "mass": lambda native, k, q=q: dense(native.mass_pattern, native.mass(q, k)),
            "force": lambda native, k, q=q, v=v: native.force(0.0, q, v, k),
            "energy": lambda native, k, q=q, v=v: native.energy(q, v, k),
            "momentum": lambda native, k, q=q, v=v: native.momentum(q, v, k),
            "residual": lambda native, k, y=y, ydot=ydot: native.residual(0.0, y, ydot, k),
            "jacobian": lambda native, k, y=y, ydot=ydot: dense(
                native.jacobian_pattern, native.jacobian(0.0, y, ydot, 2.3, k)
            ),
            "accel": lambda native, k, q=q, v=v: native.accel(0.0, q, v, k),
        }
        condition = np.linalg.cond(dense(flat.mass_pattern, flat.mass(q, kf)))
        for name, call in calls.items():
            one, other = call(flat, kf), call(loops, kt)
            limit = 1e-15 * condition if name == "accel" else 1e-14
            assert np.max(np.abs(one - other)) < limit * np.max(np.abs(one)), name
