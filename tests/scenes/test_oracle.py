"""Compiled C and generated Python against an oracle that knows positions and virtual work alone, in 50 digits.

States are random and meet no constraint. Numbers are compared with the largest of their kind.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from made import Made, close, in_zoo, parameters, state
from oracle import Oracle, Seen

from conftest import random_cases
from derive.simulation.compiled_scene import constraint_matrix, mass_matrix

ZOO = ("JOINTS", "REDUCED", "KEPT", "ACTIONS", "ELEMENTS", "FUNCTIONS", "LOADS")
SEED = 1
SEEDS = (SEED, *random_cases(SEED + 1, long=1, further=0))
FORMS = {"index3": "", "ggl": "_ggl", "index1": "_index1"}

KEPT = "KEPT"
"""The scene whose bodies keep their coordinates, which `test_scene_ways.py` compares with others."""
pytestmark = pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.long if name == KEPT else ()) for name in ZOO]
)


@cache
def oracle(name: str, seed: int) -> tuple[Made, np.ndarray, tuple[float, np.ndarray, np.ndarray], Seen]:
    made = in_zoo(name)
    native, p = made.native, parameters(made.native, seed)
    given = dict(zip(native.parameters, p, strict=True))
    t, q, v = state(native, seed)
    found = Oracle(made.spec, native.coordinates, native.multipliers, native.markers, given)
    return made, native.setup(p), (t, q, v), found.see(t, q, v)


@pytest.mark.parametrize("seed", SEEDS)
def test_mass_and_forces(name: str, seed: int) -> None:
    made, k, (t, q, v), seen = oracle(name, seed)
    close(mass_matrix(made.native, q, k), seen.M, 1e-14)
    close(made.native.force(t, q, v, k), seen.h, 1e-14)
    values, h = made.native.mass_force(t, q, v, k)
    close(made.native.mass_pattern.dense(values), seen.M, 1e-14)
    close(h, seen.h, 1e-14)


@pytest.mark.parametrize("seed", SEEDS)
def test_constraints_and_their_derivatives(name: str, seed: int) -> None:
    made, k, (t, q, v), seen = oracle(name, seed)
    close(made.native.constraints(t, q, k), seen.g, 1e-14)
    close(made.native.constraint_rates(t, q, v, k), seen.gdot, 1e-14)
    close(constraint_matrix(made.native, t, q, k), seen.G, 1e-14)
    close(made.native.constraint_bias(t, q, v, k), seen.gamma, 1e-14)


@pytest.mark.parametrize("seed", SEEDS)
def test_accelerations_and_multipliers(name: str, seed: int) -> None:
    made, k, (t, q, v), seen = oracle(name, seed)
    vdot, lam = made.native.solve(t, q, v, k)
    close(vdot, seen.vdot, 1e-12)
    close(lam, seen.lam, 1e-12)
    close(made.native.accel(t, q, v, k), seen.vdot, 1e-12)


@pytest.mark.parametrize("seed", SEEDS)
def test_energy_momentum_poses(name: str, seed: int) -> None:
    """Energy and momentum are those of bodies whose place depends on coordinates alone."""
    made, k, (t, q, v), seen = oracle(name, seed)
    close(made.native.energy(q, v, k), seen.energy, 1e-14)
    close(made.native.momentum(q, v, k), seen.momentum, 1e-14)
    close(made.native.poses(t, q, k), seen.poses, 1e-14)


@pytest.mark.parametrize("seed", SEEDS)
def test_markers_and_loads(name: str, seed: int) -> None:
    """The Jacobian has a column, and a load a row, for each coordinate of the scene."""
    made, k, (_, q, v), seen = oracle(name, seed)
    force = np.array([3.0, -2.0])
    for marker, (x, xdot, J) in seen.markers.items():
        found = made.native.marker(marker, q, v, k)
        close(found[0], x, 1e-14)
        close(found[1], xdot, 1e-14)
        close(made.native.marker_pattern(marker).dense(found[2]), J, 1e-14)
        close(made.native.load(marker, q, force, k), J.T @ force, 1e-14)


def test_corrections_are_the_smallest(name: str) -> None:
    """G dv = r, and M dv is a combination of the rows of G."""
    made, k, (t, q, _), seen = oracle(name, SEED)
    M, G = seen.M.astype(float), seen.G.astype(float)
    r = np.random.default_rng(0).normal(size=len(G))
    dv = made.native.project_velocity(t, q, k, r)
    inverse = np.linalg.solve(M, G.T)
    close(dv, inverse @ np.linalg.solve(G @ inverse, r), 1e-10)


@pytest.mark.parametrize("form", FORMS)
def test_residuals_and_iteration_matrices(name: str, form: str) -> None:
    """Residuals are put together from what the oracle says, their Jacobians from complex steps of the Python."""
    made, k, (t, q, v), seen = oracle(name, SEED)
    dae, residual = made.native.dae[form], made.python[f"residual{FORMS[form]}"]
    n, m = len(q), len(seen.g)
    rng = np.random.default_rng(0)
    a, lam, mu = rng.normal(size=n), rng.normal(size=m), rng.normal(size=m if form == "ggl" else 0)
    y, ydot = np.concatenate([q, v, lam, mu]), np.concatenate([rng.normal(size=n), a, 0 * lam, 0 * mu])
    G = seen.G
    expected = [ydot[:n] - v + (G.T @ mu if form == "ggl" else 0), seen.M @ a + seen.h - G.T @ lam]
    last = {"index3": [seen.g], "ggl": [seen.gdot, seen.g], "index1": [G @ a - seen.gamma]}[form]
    found = dae.residual(t, y, ydot, k)
    for part, block in zip(np.split(found, [n, 2 * n]), [*expected, np.concatenate(last)], strict=True):
        close(part, block, 1e-13)
    close(residual(t, y, ydot, k), found, 1e-13)
    cj, step = 2.3, 1e-30
    steps = 1j * step * np.eye(len(y))
    numeric = residual(t, y + steps, ydot + cj * steps, k).imag.T / step
    matrix = dae.pattern.dense(dae.jacobian(t, y, ydot, cj, k))
    scale = np.abs(numeric).max(axis=1, keepdims=True)
    assert np.max(np.abs(matrix - numeric) / scale) < 1e-12
    by_python = made.python[f"jacobian{FORMS[form]}"](t, y, ydot, cj, k)
    close(by_python, dae.jacobian(t, y, ydot, cj, k), 1e-12)


def test_python_is_the_same_and_takes_batches(name: str) -> None:
    """States in a 2 x 3 array, times in a column of 2: every function, member by member, as the C gives it."""
    made = in_zoo(name)
    native, python = made.native, made.python
    p = parameters(native, 0)
    k = native.setup(p)
    close(python["setup"](p), k, 1e-14)
    states = [[state(native, 3 * i + j) for j in range(3)] for i in range(2)]
    q, v = (np.array([[s[x] for s in row] for row in states]) for x in (1, 2))
    t = np.array([[0.3], [0.9]])
    r = np.random.default_rng(0).normal(size=native.nlambda)
    values, h = python["mass_force"](t, q, v, k)
    vdot, lam = python["solve"](t, q, v, k)
    batch = {
        "mass": (values, lambda t, q, v: native.mass(q, k)),
        "force": (h, lambda t, q, v: native.force(t, q, v, k)),
        "vdot": (vdot, lambda t, q, v: native.solve(t, q, v, k)[0]),
        "lam": (lam, lambda t, q, v: native.solve(t, q, v, k)[1]),
        "accel": (python["accel"](t, q, v, k), lambda t, q, v: native.accel(t, q, v, k)),
        "g": (python["constraints"](t, q, k), lambda t, q, v: native.constraints(t, q, k)),
        "gdot": (python["constraint_rates"](t, q, v, k), lambda t, q, v: native.constraint_rates(t, q, v, k)),
        "G": (python["constraint_jacobian"](t, q, k), lambda t, q, v: native.constraint_jacobian(t, q, k)),
        "gamma": (python["constraint_bias"](t, q, v, k), lambda t, q, v: native.constraint_bias(t, q, v, k)),
        "dv": (python["project_velocity"](t, q, k, r), lambda t, q, v: native.project_velocity(t, q, k, r)),
        "poses": (python["poses"](t, q, k), lambda t, q, v: native.poses(t, q, k).ravel()),
        "energy": (python["energy"](q, v, k), lambda t, q, v: native.energy(q, v, k)),
        "momentum": (python["momentum"](q, v, k), lambda t, q, v: native.momentum(q, v, k)),
        "rates": (python["rates"](q, v, k), lambda t, q, v: native.rates(q, v, k)),
    }
    for marker in native.markers:
        for i, found in enumerate(python[f"marker_{marker}"](q, v, k)):
            batch[f"{marker} {i}"] = (found, lambda t, q, v, marker=marker, i=i: native.marker(marker, q, v, k)[i])
    for what, (found, call) in batch.items():
        for i in range(2):
            for j in range(3):
                member = np.broadcast_to(found, (2, 3, found.shape[-1]))[i, j]  # what no state changes has no batch
                limit = 1e-12 if what in ("vdot", "lam", "accel", "dv") else 1e-14
                close(member, call(t[i, 0], q[i, j], v[i, j]), limit)


def test_batches_of_c_are_the_same_bit_for_bit(name: str) -> None:
    native = in_zoo(name).native
    k = native.setup()
    states = [state(native, seed) for seed in range(7)]
    q, v = (np.array([s[x] for s in states]) for x in (1, 2))
    for i in range(7):
        assert np.array_equal(native.mass_batch(q, k)[i], native.mass(q[i], k))
        assert np.array_equal(native.force_batch(0.7, q, v, k)[i], native.force(0.7, q[i], v[i], k))
        assert np.array_equal(native.accel_batch(0.7, q, v, k)[i], native.accel(0.7, q[i], v[i], k))
