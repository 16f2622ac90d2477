"""Forms of the equations of scenes without constraints: one text in C, that of index 3, which the others call."""

from __future__ import annotations

import numpy as np

import derive
from derive.backends.c.source import CBackend

PENDULUM = {
    "name": "pendulum",
    "scene": {"gravity": [0, -9.81]},
    "ground": {"markers": {"o": [0, 0]}},
    "bodies": {"rod": {"mass": 2, "inertia": 0.1, "markers": {"top": [0, 0.5]}}},
    "joints": {"pin": {"kind": "revolute", "between": ["ground.o", "rod.top"]}},
}


def test_forms_without_constraints_have_one_text() -> None:
    scene = derive.scene(PENDULUM)
    model = derive.lower(derive.derive(scene))
    assert not model.multipliers
    source = next(file.text for file in CBackend().files(model, "a test") if str(file.path).endswith(".c"))
    calls = {name: source.count(f"return pendulum_{name}(") for name in ("residual", "jacobian", "accel")}
    assert calls == {"residual": 2, "jacobian": 2, "accel": 1}
    native = derive.load_scene(derive.model_files(model, scene))
    k, q, v = native.setup(), [0.3], [0.2]
    assert np.array_equal(native.solve(0.0, q, v, k)[0], native.accel(0.0, q, v, k))
