"""Derivatives of functions on request against differences."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from test_requested_functions import EVERY, LEAN, Array, State, close

CALLS = {
    "inverse_dynamics": ("t", "q", "v", "vdot", "k"),
    "gravity_compensation": ("t", "q", "k"),
    "centre_of_mass": ("q", "v", "k"),
    "centroidal_momentum": ("q", "v", "k"),
}


@pytest.mark.parametrize("name", [name for name in EVERY if name not in LEAN])
def test_derivatives_are_those_of_differences(name: str) -> None:
    """By all arguments, the parameters and the inputs."""
    s, h = State(name), 1e-5
    for function, arguments in CALLS.items():
        given = {"t": s.t, "q": s.q, "v": s.v, "vdot": s.vdot, "p": s.p, "u": s.u}

        def value(changed: dict[str, Any], function: str = function, arguments: Any = arguments) -> Array:
            k = s.native.setup(changed["p"])
            k = s.native.with_inputs(k, changed["u"]) if s.u.size else k
            result = getattr(s.native, function)(*((changed | {"k": k})[a] for a in arguments))
            if isinstance(result, tuple):
                return np.concatenate(result[:2]) if function == "centre_of_mass" else result[0]
            return np.asarray(result)

        columns = []
        for argument in (*(a for a in arguments if a in ("q", "v", "vdot")), "p", "u"):
            for i, x in enumerate(given[argument]):
                size = h * max(1.0, abs(x))
                ends = (
                    given | {argument: given[argument] + step * np.eye(len(given[argument]))[i]}
                    for step in (size, -size)
                )
                ahead, behind = map(value, ends)
                columns.append((ahead - behind) / (2 * size))
        jac = getattr(s.native, f"{function}_jacobian")(*({**given, "k": s.k}[a] for a in arguments))
        close(s.dense(f"{function}_jacobian", jac), np.column_stack(columns), 1e-7)


def test_derivatives_of_rotations_are_those_of_differences() -> None:
    s, h = State("space"), 1e-6
    jac = s.dense("rotation_jacobian_boom_end", s.native.rotation_jacobian("boom_end", s.q, s.v, s.k))
    for i in range(s.native.nq):
        step = h * np.eye(s.native.nq)[i]
        ahead, behind = (s.native.rotation("boom_end", s.q + d, s.v, s.k)[0] for d in (step, -step))
        close(jac[:, i], (ahead - behind) / (2 * h), 1e-8)
