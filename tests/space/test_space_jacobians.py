"""Iteration matrices of random scenes in space against differences of the oracle's equations of motion."""

from __future__ import annotations

from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest
from decimal_vectors import Array, array, floats, number, precise, zeros
from random_scenes import random_scene
from space_kernels import SpaceModel, random_state, space_model

APART = Decimal(10) ** -9
"""The step of differences of the oracle, whose own errors are of the order 1e-26; theirs are below 1e-16."""
LIMIT = 1e-11


def residuals(model: SpaceModel, t: float, q: Array, v: Array, a: Array, lam: Array) -> Array:
    """The derivatives (nv + nlambda, 2 nv) of [M a + h - G^T lambda; G a - gamma] by small motions and velocities."""
    columns, n = model.oracle.columns, len(v)
    with precise():
        state, rates, vdot, multipliers = columns.state(q), array(v), array(a), array(lam)
        result = []
        for j in range(2 * n):
            unit, ends = zeros(n), []
            unit[j % n] = Decimal(1)
            for s in (APART, -APART):
                moved = columns.moved(state, unit, s) if j < n else state
                seen = model.oracle.see_state(number(t), moved, rates + s * unit if j >= n else rates)
                rows = [seen.rows.index(name) for name in model.native.multipliers]
                G = seen.G[rows].reshape(len(rows), n)
                ends.append(np.concatenate([seen.M @ vdot + seen.h - G.T @ multipliers, G @ vdot - seen.gamma[rows]]))
            result.append((ends[0] - ends[1]) / (2 * APART))
        return floats(result).T


@pytest.mark.long
@pytest.mark.parametrize("seed", [15, 25, 103, 105, 71])
def test_iteration_matrices(seed: int, tmp_path: Path) -> None:
    """Of index 1, the derivatives of all functions by which accelerations and constraints depend on the state."""
    model = space_model(random_scene(seed, tmp_path))
    native = model.native
    t, q, v = random_state(native, seed)
    k, rng = model.constants(t), np.random.default_rng(seed)
    a, lam = rng.normal(size=native.nv), rng.normal(size=native.nlambda)
    form = native.dae["index1"]
    y = np.concatenate([q, v, lam])
    ydot = np.concatenate([native.rates(q, v, k), a, np.zeros(native.nlambda)])
    J = form.pattern.dense(form.jacobian(t, y, ydot, 0.0, k))[native.nq :]
    motions = np.column_stack([native.rates(q, unit, k) for unit in np.eye(native.nv)])
    found = np.hstack([J[:, : native.nq] @ motions, J[:, native.nq : native.nq + native.nv]])
    expected = residuals(model, t, q, v, a, lam)
    scale = np.maximum(np.abs(expected).max(axis=1, keepdims=True), 1e-3 * np.abs(expected).max())
    assert np.abs((found - expected) / scale).max() < LIMIT
