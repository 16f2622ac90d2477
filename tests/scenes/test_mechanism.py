"""A mechanism keeps the equations of its bodies once for each kind, and is written out from there."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import derive
from derive.mechanics.multibody import kinds as module
from derive.model_lowering import lowered_form
from derive.spec.toml.read import parse

SCENES = Path(__file__).resolve().parents[2] / "scenes"

RODS = """
name = "rods"
ground.markers = { pin = [0, 0] }
[bodies.first]
length = 2
mass = 3
pieces = 4
markers = { left = -1, right = 1 }
[bodies.second]
length = { symbol = "b", default = 0.5 }
markers = { left = -1 }
[bodies.stiff]
ansatz = ["1", "xi", "xi^2"]
markers = { left = -1 }
[joints.hinge]
kind = "revolute"
between = ["ground.pin", "first.left"]
[joints.elbow]
kind = "revolute"
between = ["first.right", "second.left"]
"""


def test_equal_bodies_are_one_kind_whatever_their_numbers():
    mechanism = derive.derive(parse(RODS))
    kinds = {instance.name: instance.kind for instance in mechanism.instances}
    assert kinds == {"first_1": 0, "first_2": 0, "first_3": 0, "first_4": 0, "second": 0, "stiff": 1}
    assert [len(kind.motion.alpha) for kind in mechanism.kinds] == [2, 1]
    assert [j.joint.name for j in mechanism.joints] == ["hinge", "elbow", "first_cut_1", "first_cut_2", "first_cut_3"]
    assert mechanism.joints[1].joint.first == derive.MarkerRef("first_4", "right")
    assert str(mechanism).splitlines()[1] == "  kind 1 of body, 2 shapes: first_1, first_2, first_3, first_4, second"


def test_equations_are_derived_once_for_each_kind(monkeypatch: pytest.MonkeyPatch):
    calls = []
    derived = module.derive_body
    module._kind.cache_clear()
    monkeypatch.setattr(module, "derive_body", lambda body: calls.append(body) or derived(body))
    scene = derive.read(SCENES / "crank_slider_3.toml")
    rods = tuple(replace(b, pieces=9) if isinstance(b, derive.BeamBody) else b for b in scene.bodies)
    mechanism = derive.derive(replace(scene, bodies=rods))
    assert len(calls) == len(mechanism.kinds) < len(mechanism.instances) == 11


def test_what_a_joint_eliminates_has_its_reason():
    mechanism = derive.derive(derive.read(SCENES / "crank_slider_3.toml"))
    assert [e.what for e in mechanism.eliminated] == ["ground", "crank", "slider"]
    assert not mechanism.instance("crank").moves and len(mechanism.instance("slider").coordinates.rows) == 1
    text = str(mechanism)
    assert len(text) < 2000 and "crank: drive motor prescribes its motion" in text


@pytest.mark.parametrize("name", [pytest.param("four_bar", marks=pytest.mark.long), "crank_slider_3"])
def test_expansion_is_the_decision_of_the_lowering(name):
    """A mechanism keeps kinds and instances; the lowering, or who asks for it, writes out a row for each coordinate."""
    scene = derive.read(SCENES / f"{name}.toml")
    mechanism = derive.derive(scene)
    equations = mechanism.expanded()
    assert mechanism.rows == equations.rows and mechanism.coordinates == equations.coordinates
    numbered = [j.joint.name for j in mechanism.joints for _ in range(j.multipliers)]
    assert numbered == [constraint.of for constraint in equations.constraints]
    model = derive.lower(mechanism)
    assert model == derive.lower(equations)
    assert lowered_form(mechanism, model) is equations, "a mechanism is expanded once"
