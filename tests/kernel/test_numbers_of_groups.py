"""Outputs in loops over instances whose numbers differ from body to body."""

from __future__ import annotations

import numpy as np

import derive
from derive.backends.model_files import emit
from derive.runtime.compiler import RUN_FLAGS
from derive.runtime.loading import load_scene
from derive.spec.toml.read import parse

TAPER = """\
name = "taper"
[scene]
lowering = "instances"
[bodies.link]
count = 3
mass = 1
length = "0.5 - 0.05*i"
bending_stiffness = 10
markers = { left = -1, right = 1 }
[outputs.gap]
count = 2
kind = "distance"
between = ["link[i].left", "link[i+1].right"]
"""


def test_outputs_of_bodies_of_different_lengths() -> None:
    scene = parse(TAPER)
    native = load_scene(emit(derive.lower(derive.derive(scene)), scene, ("c",)), RUN_FLAGS)
    q, zero = np.zeros(native.nq), np.zeros(native.nv)
    gaps = native.evaluate_outputs(0.0, q, zero, zero, np.zeros(0), native.setup())
    np.testing.assert_allclose(gaps, [(0.5 + 0.45) / 2, (0.45 + 0.4) / 2], rtol=1e-15)
