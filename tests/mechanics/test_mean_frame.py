"""Any modes in the mean frame: conditions met, strain energy kept, couplings gone, and still the same moving points."""

from __future__ import annotations

import numpy as np
import pytest

import derive
import test_cloud
from conftest import QUICK
from derive.backends.c.source import CBackend
from derive.reduction.body import prepare
from mean_frame import residuals, rigid_fields, to_mean_frame


@pytest.mark.parametrize("n", [1, 3, 5])
def test_conditions_are_met_and_modes_orthonormal(n: int) -> None:
    c = test_cloud.cloud(n)
    before = residuals(c.masses, c.positions, c.modes)
    x, modes, stiffness = to_mean_frame(c.masses, c.positions, c.modes, c.stiffness)
    assert max(before) > 0.1 and max(residuals(c.masses, x, modes)) < 1e-13
    assert np.allclose(c.masses @ x, 0, atol=1e-13)
    assert np.allclose(np.einsum("n,ink,jnk->ij", c.masses, modes, modes), np.eye(n), atol=1e-12)
    assert np.count_nonzero(stiffness - np.diag(np.diag(stiffness))) == 0
    assert np.all(np.diff(np.diag(stiffness)) >= 0)


def test_strain_energy_is_kept() -> None:
    """The new modes are combinations of the old ones and rigid fields; the same deformation has the same energy."""
    c = test_cloud.cloud(3)
    x, modes, stiffness = to_mean_frame(c.masses, c.positions, c.modes, c.stiffness)
    basis = np.concatenate([c.modes.reshape(3, -1), rigid_fields(x).reshape(6, -1)])
    for mode, energy in zip(modes.reshape(3, -1), np.diag(stiffness), strict=True):
        weights, rest, _, _ = np.linalg.lstsq(basis.T, mode, rcond=None)
        assert np.all(rest < 1e-20)
        assert np.isclose(weights[:3] @ c.stiffness @ weights[:3], energy, rtol=1e-10)


def test_a_rigid_body_is_centred_alone() -> None:
    c = test_cloud.cloud(0)
    x, modes, stiffness = to_mean_frame(c.masses, c.positions, c.modes, c.stiffness)
    assert np.allclose(c.masses @ x, 0, atol=1e-13) and modes.shape == (0, test_cloud.POINTS, 3) and stiffness.size == 0


def test_a_rigid_mode_is_named() -> None:
    c = test_cloud.cloud(3)
    turn = rigid_fields(c.positions)[4]
    modes = np.array([c.modes[0], turn + 2 * c.modes[0], c.modes[1]])
    with pytest.raises(ValueError, match=r"rigid motion is left in the modes.* mode 1 .* mode 2; remove one of them"):
        to_mean_frame(c.masses, c.positions, modes, np.eye(3))


@pytest.mark.parametrize("n", [1, 3, pytest.param(5, marks=pytest.mark.long)])
def test_couplings_vanish_and_the_points_move_as_they_must(n: int, monkeypatch: pytest.MonkeyPatch) -> None:
    c = test_cloud.cloud(n)
    spec = test_cloud.nodal(c, "mean")
    body = derive.modal(spec)
    model = derive.lower(derive.derive_modal(body, test_cloud.gravity(), "flat"))
    given = test_cloud.model(n, "numbers flat").pattern("mass", "M")
    pattern = model.pattern("mass", "M")
    size = 6 + n
    assert given.full_nnz == size**2 - 6  # all but the coupling of the translations
    coupling = {(i, j) for i, j in pattern.entries if i >= 6 and 3 <= j < 6}
    # translations and shapes stand alone, J is full, and rotation meets shapes through c7 alone
    assert pattern.full_nnz == 3 + 9 + n + 2 * len(coupling)
    assert len(coupling) == (0 if n == 1 else 3 * n)
    reasons = " ".join(zero.reason for zero in model.zeros)
    assert "condition (17)" in reasons and ("condition (19)" in reasons) == (n == 1)
    shapes = prepare(spec).shapes
    x, modes, stiffness = shapes.x, shapes.phi, shapes.stiffness
    monkeypatch.setattr(test_cloud, "damping_matrix", lambda _: body.damping)
    monkeypatch.setattr(test_cloud, "cloud", lambda _: test_cloud.Cloud(c.masses, x, modes, stiffness))
    native = derive.load(CBackend().files(model, "test"), QUICK)
    k = native.setup(np.zeros(0))
    for seed in range(2):
        q, v, a = test_cloud.state(n, seed)
        expected, magnitude = test_cloud.oracle(n, q, v, a)
        residual = native.residual(0.0, np.concatenate([q, v]), np.concatenate([native.rates(q, v, k), a]), k)
        assert np.max(np.abs(residual[7 + n :] - expected) / magnitude) < 1e-12
