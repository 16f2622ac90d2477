"""Outputs of rotations in space, none of which is singular."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from space_kernels import SpaceModel, space_model
from test_space_marker_outputs import column, evaluated

SWUNG = """
name = "swung"
[ground.markers]
o = [0, 0, 0]
[bodies.bob]
mass = 1
inertia = [1, 2, 3, 0, 0, 0]
markers = { m = [0, 0, 0], n = [2, 0, 0] }
[outputs.r]
kind = "rotation"
marker = "bob.m"
[outputs.a]
kind = "angle"
between = ["bob.m", "bob.n"]
"""


@cache
def swung(folder: Path) -> SpaceModel:
    path = folder / "swung.toml"
    path.write_text(SWUNG)
    return space_model(path)


STEPS = 1e-6 * np.array([0, 0, 0, 0.3, -0.5, 0.7, 0.2])


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1.0, np.pi - 1e-9, np.pi, np.pi + 1e-3, 6.0])
@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 0, 1), (0.6, 0, -0.8), (-1 / 3, 2 / 3, 2 / 3)])
def test_no_rotation_is_singular(
    tmp_path_factory: pytest.TempPathFactory, angle: float, axis: tuple[float, ...]
) -> None:
    """Also none, and half a turn, where the vector changes its sign; derivatives are numbers everywhere."""
    of = swung(tmp_path_factory.getbasetemp())
    native, n = of.native, np.array(axis)
    q = np.concatenate([[0, 0, 0, np.cos(angle / 2)], np.sin(angle / 2) * n])
    values = evaluated(of, 0.0, q, np.zeros(6), np.zeros(6))
    expected = angle * n if angle <= np.pi else (angle - 2 * np.pi) * n
    found = column(values, "r")
    if angle == np.pi:
        found *= np.sign(found @ expected)
    assert found == pytest.approx(expected, abs=1e-15 + 4e-16 * np.pi)
    x = 1 - (1 - np.cos(angle)) * (1 - n[0] ** 2)  # x of the body along x
    assert np.cos(values["a"]) == pytest.approx(x, abs=1e-14)
    rest = (np.zeros(6), np.zeros(6), np.zeros(0), native.setup())
    jacobian = native.outputs_pattern.dense(native.outputs_jacobian(0.0, q, *rest))
    assert np.all(np.isfinite(jacobian))
    if abs(angle - np.pi) > 1e-5:
        step = STEPS - (STEPS @ q) * q  # of unit quaternions
        ends = [native.evaluate_outputs(0.0, q + s * step, *rest)[:3] for s in (1, -1)]
        assert jacobian[:3, :7] @ step == pytest.approx((ends[0] - ends[1]) / 2, abs=1e-12)
