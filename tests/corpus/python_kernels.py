"""The generated Python of a scene against the compiled C, to 1e-14 of what is added up on the way to each number."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from corpus.commands import Finding

TOLERANCE = 1e-14
SOLVED = 1e-10
"""What is solved for loses digits to the condition of the matrix."""


def disagreements(files: Sequence[Any], native: Any, k: np.ndarray, state: Any) -> Iterator[Finding]:
    """The functions whose results differ."""
    source = next(file for file in files if file.path.endswith(".py"))
    module: dict[str, Any] = {"__name__": "generated"}
    exec(compile(source.text, source.path, "exec"), module)
    t, q, v = state.t, state.q, state.v
    inputs = (k,)
    calls = {
        "mass": (module["mass"](q, *inputs), native.mass(q, k)),
        "force": (module["force"](t, q, v, *inputs), native.force(t, q, v, k)),
        "energy": (module["energy"](q, v, *inputs), native.energy(q, v, k)),
        "momentum": (module["momentum"](q, v, *inputs), native.momentum(q, v, k)),
        "poses": (module["poses"](t, q, *inputs), native.poses(t, q, k).ravel()),
        "constraints": (module["constraints"](t, q, *inputs), native.constraints(t, q, k)),
        "constraint_jacobian": (module["constraint_jacobian"](t, q, *inputs), native.constraint_jacobian(t, q, k)),
        "constraint_bias": (module["constraint_bias"](t, q, v, *inputs), native.constraint_bias(t, q, v, k)),
    }
    for name, (by_python, by_c) in calls.items():
        yield from _differs(name, by_python, by_c, TOLERANCE)
    vdot, lam = native.solve(t, q, v, k)
    by_python = module["solve"](t, q, v, k)
    yield from _differs(
        "solve", np.concatenate([np.ravel(part) for part in by_python]), np.concatenate([vdot, lam]), SOLVED
    )
    outputs = native.evaluate_outputs(t, q, v, vdot, lam, k)
    yield from _differs("outputs", module["outputs"](t, q, v, vdot, lam, k), outputs, TOLERANCE)


def _differs(name: str, by_python: Any, by_c: Any, limit: float) -> Iterator[Finding]:
    by_python, by_c = np.ravel(by_python), np.ravel(by_c)
    if by_python.shape != by_c.shape:
        yield Finding("physics", f"{name}: C and Python have results of other sizes", f"{by_python.shape} {by_c.shape}")
    elif by_c.size and not np.max(np.abs(by_python - by_c)) <= limit * max(0.1, np.max(np.abs(by_c))):
        yield Finding(
            "physics", f"{name}: C and Python differ", f"{np.max(np.abs(by_python - by_c))} of {np.max(np.abs(by_c))}"
        )
