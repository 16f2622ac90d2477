"""Names of an instance of a table that has code of its own, since it differs from the others."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import derive
from derive.runtime.loading import load_scene
from derive.spec.model.beam_parts import Marker
from derive.spec.toml.read import parse

SCENE = """
name = "own"
ground.markers = { hook = [0, 0] }
scene.lowering = "instances"
[bodies.link]
count = 3
mass = 0.1
length = 0.2
bending_stiffness = 10
markers = { left = -1, right = 1 }
start = { position = ["0.1 + 0.2*i", 0] }
[joints.hinge]
kind = "revolute"
between = ["ground.hook", "link[0].left"]
[joints.weld]
count = 2
kind = "weld"
between = ["link[i].right", "link[i+1].left"]
"""


def test_markers_keep_the_name_of_the_instance() -> None:
    """The first link has a marker that the others do not have; Python names all as C does."""
    spec = parse(SCENE)
    first = spec.bodies[0]
    marked = replace(first, beam=replace(first.beam, markers=(*first.beam.markers, Marker("middle", Fraction(0)))))
    scene = replace(spec, bodies=(marked, *spec.bodies[1:]))
    model = derive.lower(derive.derive(scene))
    assert model.lowering == "instances"
    native = load_scene(derive.model_files(model, scene))
    ends = {f"link[{k}]_{end}" for k in range(3) for end in ("left", "right")}
    assert set(native.markers) == {*ends, "link[0]_middle"}
