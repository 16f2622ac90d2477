"""The generated Python of a scene against the compiled C, to 1e-14 of what is added up on the way to each number."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from corpus.commands import Finding
from corpus.summed_terms import summed_terms, worst
from derive.backends.python.backend import PythonBackend

TOLERANCE = 1e-14
SOLVED = 1e-10
"""The tolerance of solutions of linear systems, which lose digits to the condition of the matrix."""
SHARED = 1e-4
"""The tolerance of the reactions of redundant joints, which lose nine digits; see `derive.lowering.proximal`."""


def disagreements(run: Any, native: Any, k: np.ndarray, state: Any) -> Iterator[Finding]:
    """The functions whose results differ."""
    source = next(file for file in PythonBackend().files(run.complete_model, "") if file.path.endswith(".py"))
    module: dict[str, Any] = {"__name__": "generated"}
    exec(compile(source.text, source.path, "exec"), module)
    t, q, v = state.t, state.q, state.v
    vdot, lam = native.solve(t, q, v, k)
    own = np.array(k)  # the constants without their build, which this Python is no part of
    calls = {
        "setup": ((native.defaults,), native.setup()),
        "mass": ((q, own), native.mass(q, k)),
        "force": ((t, q, v, own), native.force(t, q, v, k)),
        "energy": ((q, v, own), native.energy(q, v, k)),
        "momentum": ((q, v, own), native.momentum(q, v, k)),
        "poses": ((t, q, own), native.poses(t, q, k)),
        "constraints": ((t, q, own), native.constraints(t, q, k)),
        "constraint_jacobian": ((t, q, own), native.constraint_jacobian(t, q, k)),
        "constraint_bias": ((t, q, v, own), native.constraint_bias(t, q, v, k)),
        "outputs": ((t, q, v, vdot, lam, own), native.evaluate_outputs(t, q, v, vdot, lam, k)),
    }
    for name, (arguments, by_c) in calls.items():
        by_python = np.ravel(module[name](*arguments))
        if by_python.shape != np.ravel(by_c).shape:
            sizes = f"{by_python.shape} {np.shape(by_c)}"
            yield Finding("physics", f"{name}: C and Python have results of other sizes", sizes)
            continue
        apart = worst(by_python, by_c, summed_terms(run.complete_model, name, *arguments)) if by_python.size else 0.0
        if not apart <= TOLERANCE:
            yield Finding("physics", f"{name}: C and Python differ", f"{apart:.2g} of the summed terms")
    solved = [np.ravel(part) for part in module["solve"](t, q, v, own)]
    size = max(0.1, np.max(np.abs([*vdot, *lam]), initial=0.0))
    tolerances = SOLVED, SHARED if native.proximal else SOLVED
    for by_python, by_c, tolerance in zip(solved, (vdot, lam), tolerances, strict=True):
        if not np.max(np.abs(by_python - by_c), initial=0.0) <= tolerance * size:
            yield Finding("physics", "solve: C and Python differ", f"{by_python} {by_c}")
