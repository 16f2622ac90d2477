"""Damping of beams: every free mode decays with its ratio, whatever the frame, and parameters are what numbers are."""

from __future__ import annotations

import numpy as np
import pytest
from made import close, make
from scipy.linalg import eigvals

from derive.spec.set_values import with_values
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

FRAMES = ['"mean"', '"point"', '{ kind = "point", at = 0.5 }', '"chord"', '{ kind = "tangent", at = -1 }']


def frames(*few: int) -> pytest.MarkDecorator:
    """All frames, of which some are long."""
    marks = [() if i in few else pytest.mark.long for i in range(len(FRAMES))]
    return pytest.mark.parametrize("frame", [pytest.param(f, marks=m) for f, m in zip(FRAMES, marks, strict=True)])


def matrices(more: str, p: list[float] | None = None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """M, B and K of a rod at rest in its reference configuration, where M has no part of its rigid motion.

    The translations and the rotation follow from the amplitudes, since a free body is at rest on average.
    """
    made = make(parse(ROD.format(more=more)), complete=True)
    native, k = made.native, made.native.setup(p)
    rest = np.zeros(2 * native.nq)
    dae, n = native.dae["index3"], native.nq
    still, moving = (dae.pattern.dense(dae.jacobian(0.0, rest, rest, cj, k)) for cj in (0.0, 1.0))
    M, B, K = (moving - still)[n:, n:], still[n:, n:], still[n:, :n]
    assert not B[:3].any() and not B[:, :3].any(), "damping does no work on rigid motion"
    rigid, a = slice(0, 3), slice(3, n)
    return M[a, a] - M[a, rigid] @ np.linalg.solve(M[rigid, rigid], M[rigid, a]), B[a, a], K[a, a]


@frames(0, 4)
def test_a_ratio_is_that_of_every_free_mode(frame: str) -> None:
    """The ratio is the real part over the magnitude of the eigenvalues -r w +- i w sqrt(1 - r^2)."""
    M, B, K = matrices(f"frame = {frame}\ndamping = {{ ratio = 0.03 }}", [1.1, 0.8, 3.0])
    n = len(K)
    zero, one = np.zeros((n, n)), np.eye(n)
    found = eigvals(np.block([[zero, one], [-K, -B]]), np.block([[one, zero], [zero, M]]))
    np.testing.assert_allclose(-found.real / np.abs(found), 0.03, rtol=1e-8)
    np.testing.assert_allclose(np.sort(np.abs(found))[::2], np.sqrt(np.sort(eigvals(K, M).real)), rtol=1e-8)


@frames(2)
def test_proportional_damping(frame: str) -> None:
    M, B, K = matrices(f"frame = {frame}\ndamping = {{ mass = 0.2, stiffness = 1e-3 }}")
    close(B, 0.2 * M + 1e-3 * K, 1e-14)


def test_no_damping_is_no_term() -> None:
    _, B, _ = matrices("")
    assert not B.any()


@pytest.mark.parametrize(
    ("numbers", "symbols", "values"),
    [
        ("ratio = 0.03", 'ratio = { symbol = "zeta", default = 0.5 }', [0.03]),
        (
            "mass = 0.2, stiffness = 1e-3",
            'mass = { symbol = "a", default = 9 }, stiffness = { symbol = "b", default = 8 }',
            [0.2, 1e-3],
        ),
    ],
)
def test_damping_may_be_parameters(numbers: str, symbols: str, values: list[float]) -> None:
    """Numbers give the same matrices as parameters whose defaults are others."""
    _, expected, _ = matrices(f"damping = {{ {numbers} }}", [1.1, 0.8, 3.0])
    _, found, _ = matrices(f"damping = {{ {symbols} }}", [1.1, 0.8, 3.0, *values])
    close(found, expected, 1e-14)
    _, undamped, _ = matrices(f"damping = {{ {symbols} }}", [1.1, 0.8, 3.0, *(0.0 for _ in values)])
    assert not undamped.any()


def test_a_ratio_that_is_set_becomes_a_parameter() -> None:
    scene = parse(ROD.format(more="damping = { ratio = 0.01 }"))
    changed, (value,) = with_values(scene, {"bodies.rod.damping.ratio": "0.03"})
    assert str(value) == "bodies.rod.damping.ratio: 0.01 -> 0.03, the parameter rod_damping_ratio"
    native = make(changed).native
    assert dict(zip(native.parameters, native.defaults, strict=True))["rod_damping_ratio"] == 0.03


def test_plots_may_cut_a_rod_with_a_ratio() -> None:
    plot = '[plots.bent]\ny = "rod_alpha1"\ncut = "rod"\npieces = [1, 2]\n[simulation]\nduration = 1\noutput = 0.1\n'
    assert parse(ROD.format(more="damping = { ratio = 0.01 }") + plot).plots[0].pieces == (1, 2)
