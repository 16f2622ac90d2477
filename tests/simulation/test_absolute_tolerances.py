"""Absolute tolerances of a scene: those of lengths are in proportion to its size, those of rotations are not."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from derive.roles import Role
from derive.simulation.integration.tolerances import absolute_tolerances

BODY = (Role.TRANSLATION,) * 3 + (Role.QUATERNION,) * 4


def test_angular_velocities_of_each_body_in_space_have_the_tolerance_of_angles() -> None:
    native: Any = SimpleNamespace(nq=15, nv=13, roles=(*BODY, Role.AMPLITUDE, *BODY))
    allowed = absolute_tolerances(native, 1e-6, 0.1, np.zeros(15))
    body, rates = [1e-7] * 3 + [1e-6] * 4, [1e-7] * 3 + [1e-6] * 3
    np.testing.assert_allclose(allowed, [*body, 1e-7, *body, *rates, 1e-7, *rates], rtol=1e-12)
