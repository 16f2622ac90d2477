"""Damping of beams: every mode decays with its ratio, and proportional damping is that of c8 and K."""

from __future__ import annotations

import numpy as np
import pytest
from made import close, make
from scipy.linalg import eigvals

from derive.errors import SpecError
from derive.spec.toml.read import parse

ROD = """
name = "damped"
ground.markers = {{ left = [-0.7, 0] }}
[bodies.rod]
mass = {{ symbol = "m", default = 1.3 }}
length = {{ symbol = "l", default = 1.4 }}
bending_stiffness = {{ symbol = "EI", default = 7 }}
ansatz = ["1", "xi", "xi^2", "xi^3", "xi^4", "xi^5"]
{more}
markers = {{ left = -1 }}
start = {{ velocity = [0, 1] }}
"""


def matrices(more: str, p: list[float] | None = None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """c8, B and K of the amplitudes, from the residual of the beam at rest in its reference configuration."""
    made = make(parse(ROD.format(more=more)))
    native, k = made.native, made.native.setup(p)
    rest = np.zeros(2 * native.nq)
    dae, n = native.dae["index3"], native.nq
    still, moving = (dae.pattern.dense(dae.jacobian(0.0, rest, rest, cj, k)) for cj in (0.0, 1.0))
    block, a = slice(n + 3, 2 * n), slice(3, n)
    return (moving - still)[block, n:][:, a], still[block, n:][:, a], still[block, :n][:, a]


@pytest.mark.parametrize("frame", ['"mean"', '"point"', '{ kind = "tangent", at = -1 }'])
def test_a_ratio_is_that_of_every_mode(frame: str) -> None:
    """Of the eigenvalues -r w +- i w sqrt(1 - r^2) the real part over the magnitude is the ratio."""
    c8, B, K = matrices(f"frame = {frame}\ndamping = {{ ratio = 0.03 }}", [1.1, 0.8, 3.0])
    n = len(K)
    zero, one = np.zeros((n, n)), np.eye(n)
    found = eigvals(np.block([[zero, one], [-K, -B]]), np.block([[one, zero], [zero, c8]]))
    np.testing.assert_allclose(-found.real / np.abs(found), 0.03, rtol=1e-8)
    np.testing.assert_allclose(np.sort(np.abs(found))[::2], np.sqrt(np.sort(eigvals(K, c8).real)), rtol=1e-8)


def test_proportional_damping() -> None:
    c8, B, K = matrices('frame = "point"\ndamping = { mass = 0.2, stiffness = 1e-3 }')
    close(B, 0.2 * c8 + 1e-3 * K, 1e-14)


def test_no_damping_is_no_term() -> None:
    _, B, _ = matrices("")
    assert not B.any()


def test_a_ratio_is_refused_where_a_rod_is_cut() -> None:
    with pytest.raises(SpecError, match="a damping ratio is that of the modes of a beam in one piece"):
        parse(ROD.format(more="damping = { ratio = 0.01 }\npieces = 2"))
