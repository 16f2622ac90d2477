"""Mass, centre of mass, inertia and natural frequencies that `build` prints of a finite-element body."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import coo_array, eye_array, kron
from scipy.sparse.linalg import eigsh

import derive
from conftest import ROOT
from derive.cli.main import main
from derive.reduction import body_properties
from derive.spec.model.body import BodyFrame, NodalBody

SIDES, MASS = np.array([0.4, 0.1, 0.06]), 2700 * 0.4 * 0.1 * 0.06


def block() -> NodalBody:
    body = derive.read(ROOT / "scenes/block.toml")
    assert isinstance(body, NodalBody)
    return body


def frequencies() -> np.ndarray:
    """The lowest elastic frequencies of the block, Hz, from its finite-element matrices."""
    data = np.load(ROOT / "scenes/block.npz")
    K, M = (
        coo_array((data[f"{name}_value"], (data[f"{name}_row"], data[f"{name}_col"]))) for name in ("stiffness", "mass")
    )
    squares = eigsh(K.tocsc(), 14, kron(M, eye_array(3)).tocsc(), sigma=-1e6, return_eigenvectors=False)
    return np.sqrt(np.sort(squares)[6:]) / (2 * np.pi)


def test_the_block() -> None:
    found = body_properties(block())
    assert found.mass == pytest.approx(MASS, rel=1e-9)
    np.testing.assert_allclose(found.centre, SIDES / 2, rtol=1e-9)
    moments = MASS / 12 * (np.sum(SIDES**2) - SIDES**2)
    np.testing.assert_allclose(found.inertia, np.diag(moments), atol=1e-9 * moments.max())
    np.testing.assert_allclose(found.frequencies, frequencies(), rtol=1e-6)


def test_they_do_not_depend_on_the_frame() -> None:
    """The modes of a frame at a node contain rigid-body motion, which does not vibrate."""
    in_mean = body_properties(block())
    at_node = body_properties(replace(block(), frame=BodyFrame("point", 127), orthonormal=False))
    np.testing.assert_allclose(at_node.frequencies, in_mean.frequencies, rtol=1e-9)
    np.testing.assert_allclose(at_node.centre, in_mean.centre, rtol=1e-9)


def test_build_prints_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["build", str(ROOT / "scenes/block.toml"), "--out", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    assert "  mass 6.48 kg; centre of mass at (0.2, 0.05, 0.03) m\n" in printed
    assert "J11, J22, J33 = 0.007344, 0.08834, 0.0918 kg m^2; J12, J13, J23 = 0, 0, 0 kg m^2\n" in printed
    frequencies = "1834, 2749, 3277.7, 4581.5, 6128.9, 6339.8 Hz and 2 more"
    assert f"natural frequencies of the free body by its modes: {frequencies}\n" in printed
