"""Whole turns that the iteration of an assembly has made: they are taken back, unless a constraint counts them."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from derive.roles import Role
from derive.simulation.space.assembly import _unwound


@pytest.mark.parametrize("counted", [False, True])
def test_whole_turns_are_taken_back(counted: bool) -> None:
    """An angle and a quaternion that the iteration has taken around; a screw knows its turns, and keeps them."""

    def constraints(t: float, q: Any, k: Any) -> Any:
        return np.array([q[0] - 0.3 - 4 * np.pi if counted else np.sin(q[0] - 0.3)])

    native = SimpleNamespace(nq=5, nv=4, roles=(Role.ROTATION, *[Role.QUATERNION] * 4), constraints=constraints)
    assembler: Any = SimpleNamespace(native=native, t=0.0, k=np.zeros(0), missed=lambda soft, q: (np.zeros(0), None))
    q = _unwound(assembler, native, (), np.array([0, 1, 0, 0, 0.0]), np.array([0.3 + 4 * np.pi, -0.6, 0, -0.8, 0]))
    assert q[0] == pytest.approx(0.3 + 4 * np.pi * counted, abs=1e-12)
    assert q[1:].tolist() == [0.6, 0, 0.8, 0]
