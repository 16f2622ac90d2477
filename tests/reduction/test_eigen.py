"""Elastic modes from K and M: those of the full problem, whatever is on the way."""

from __future__ import annotations

from dataclasses import replace

import bodies_of_nodes as bodies
import numpy as np
import pytest
import scipy.linalg
from scipy.sparse import csr_array, diags_array, kron

from derive.reduction import eigen, reduce
from derive.reduction.body import prepare
from derive.spec.model.node_data import NodeData


def full_problem(data: NodeData) -> np.ndarray:
    """omega^2 of all modes, the displacements of nodes without mass condensed."""
    k, m = data.stiffness.toarray(), np.kron(data.mass.toarray(), np.eye(3))
    heavy = np.flatnonzero(np.diag(m) > 0)
    light = np.flatnonzero(np.diag(m) == 0)
    condensed = k[np.ix_(heavy, heavy)]
    if light.size:
        across = k[np.ix_(heavy, light)]
        condensed = condensed - across @ np.linalg.solve(k[np.ix_(light, light)], across.T)
    return scipy.linalg.eigvalsh(condensed, m[np.ix_(heavy, heavy)])[6:]


@pytest.mark.parametrize("dense", [True, False])
@pytest.mark.parametrize("kind", ["lumped", "consistent", "massless"])
def test_modes_are_those_of_the_full_problem(dense: bool, kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    data = bodies.truss((5, 4, 3), seed=3)
    if kind == "consistent":
        data = bodies.consistent(data)
    if kind == "massless":
        masses = data.mass.diagonal()
        masses[::3] = 0
        data = replace(data, mass=csr_array(diags_array(masses)))
    monkeypatch.setattr(eigen, "MAX_DENSE_SIZE", 10_000 if dense else 0)
    body = bodies.nodal(data, modes=7)
    assert np.allclose(np.diag(reduce(body).stiffness), full_problem(data)[:7], rtol=1e-9)
    phi = prepare(body).shapes.phi.reshape(7, -1)
    k, m = data.stiffness, kron(data.mass, np.eye(3))
    forces = k @ phi.T - (m @ phi.T) * full_problem(data)[:7]
    assert np.abs(forces).max() < 1e-7 * np.abs(k @ phi.T).max()


def test_all_modes_there_are() -> None:
    data = bodies.truss((2, 2, 2), seed=1)
    found = reduce(bodies.nodal(data, modes=18))
    assert np.allclose(np.diag(found.stiffness), full_problem(data), rtol=1e-9)


@pytest.mark.parametrize("dense", [True, False])
def test_a_mode_without_stiffness_is_not_a_rigid_motion(dense: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two boxes hinged on an edge: the hinge has no frequency, and is found by projection all the same."""
    monkeypatch.setattr(eigen, "MAX_DENSE_SIZE", 10_000 if dense else 0)
    data = bodies.hinge()
    found = reduce(bodies.nodal(data, modes=5))
    assert found.stiffness[0, 0] < 1e-9 * found.stiffness[1, 1]
    assert np.allclose(np.diag(found.stiffness)[1:], full_problem(data)[1:5], rtol=1e-8)


def test_signs_and_start_do_not_depend_on_chance() -> None:
    body = bodies.nodal(bodies.truss((5, 4, 3), seed=3), modes=6)
    phi = prepare(body).shapes.phi
    k = body.data.stiffness
    noise = np.random.default_rng(0).uniform(-1e-12, 1e-12, k.nnz) * np.abs(k.data).max()
    shaken = k.copy()
    shaken.data = k.data + noise
    other = prepare(replace(body, data=replace(body.data, stiffness=csr_array((shaken + shaken.T) / 2)))).shapes.phi
    assert np.allclose(phi, other, rtol=0, atol=1e-6 * np.abs(phi).max())
    symmetric = bodies.nodal(bodies.truss(), modes=6)
    first = prepare(symmetric).shapes.phi
    masses = symmetric.data.mass.diagonal() * (1 + np.random.default_rng(1).uniform(-1e-11, 1e-11, 24))
    again = prepare(replace(symmetric, data=replace(symmetric.data, mass=csr_array(diags_array(masses))))).shapes.phi
    assert np.allclose(first, again, rtol=0, atol=1e-6)
