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
from cloud_checks import GRAVITY, CloudCode, Vector, check_lowerings, gravity, times, turned
from derive import ModalBody, Model, NodalBody
from derive.mechanics.bodies.spatial_body import parameters
from derive.mechanics.bodies.spatial_tables import symbolic_tables

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
def code(n: int, kind: str) -> CloudCode:
    return CloudCode(model(n, kind), given(n, kind))


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


def place(n: int, k: int, c: Vector, e: Vector, alpha: Vector) -> Vector:
    """x of point k, (1)."""
    body = cloud(n)
    r = [
        mpmath.mpf(body.positions[k, a]) + sum(alpha[i] * mpmath.mpf(body.modes[i, k, a]) for i in range(n))
        for a in range(3)
    ]
    return [a + b for a, b in zip(c, turned(e, r), strict=True)]


def places(n: int, q: np.ndarray) -> list[Vector]:
    """x of all points."""
    with mpmath.workdps(30):
        parts = [[mpmath.mpf(float(z)) for z in part] for part in (q[:3], q[3:7], q[7:])]
        return [place(n, k, *parts) for k in range(POINTS)]


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
    of = code(n, kind)
    for seed in range(3):
        q, v, a = state(n, seed)
        expected, size = expected_rows(n, seed)
        of.check_rows(q, v, a, expected, size, 1e-12)
        qdot = of.native.rates(q, v, of.k)
        residual = of.native.residual(0.0, np.concatenate([q, v]), np.concatenate([qdot, a]), of.k)
        assert np.max(np.abs(residual[: 7 + n])) < 1e-14
        assert np.max(np.abs(residual[7 + n :] - expected) / size) < 1e-12


@pytest.mark.parametrize("kind", ["numbers flat", "numbers loops"])
@pytest.mark.parametrize("n", SHAPES)
def test_jacobian_markers_and_loads(n: int, kind: str) -> None:
    of, (q, v, a) = code(n, kind), state(n, 5)
    of.check_jacobian(q, v, a)
    for name, node in (("first", 0), ("last", 9)):
        of.check_marker(name, q, v, places(n, q)[node])


@pytest.mark.parametrize("kind", ["numbers flat", "numbers loops"])
@pytest.mark.parametrize("n", SHAPES)
def test_power_balance_and_momentum(n: int, kind: str) -> None:
    of, (q, v, a) = code(n, kind), state(n, 9)
    points = np.array(places(n, q), dtype=float)
    of.check_balances(q, v, a, v[6:] @ damping_matrix(n) @ v[6:], cloud(n).masses, points)


@pytest.mark.parametrize(
    ("n", "what"),
    [
        pytest.param(n, what, marks=() if n in (0, 5) and what == "numbers" else pytest.mark.long)
        for n in (0, 1, 3, 5)
        for what in ("numbers", "parameters")
    ],
)
def test_both_lowerings_give_the_same(n: int, what: str) -> None:
    for seed in range(3):
        check_lowerings(code(n, f"{what} flat"), code(n, f"{what} loops"), *state(n, seed), bound=1e-14)
