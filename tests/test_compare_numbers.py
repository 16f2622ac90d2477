"""The numbers that `tisserand compare` prints."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from derive.cli import compare
from derive.roles import Role


def test_zeros_have_no_sign() -> None:
    """A force that vanishes is 0, whichever sign its sum of products has."""
    pattern = SimpleNamespace(entries=((0, 0),), rows=1, cols=1, full_nnz=1)
    values = np.array([-0.0]), np.array([-0.0])
    native: Any = SimpleNamespace(name="n", nq=1, nv=1, coordinates=("s",), velocities=("sdot",), mass_pattern=pattern)
    native.roles, native.setup, native.mass_force = (Role.ROTATION,), lambda: None, lambda *_: values
    assert "-0" not in compare._show(native, compare._evaluate(native))
