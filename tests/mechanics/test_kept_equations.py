"""Equations of bodies are kept in a process, where studies derive many mechanisms of the same bodies."""

from __future__ import annotations

import pytest

import derive
from derive.mechanics.motion.body_motion import Motion
from derive.mechanics.motion.kinematics import MovingFrame
from derive.mechanics.multibody import instances, kinds
from derive.mechanics.multibody.mechanism import Mechanism
from derive.spec.toml.read import parse

SCENE = """
name = "pair"
ground.markers = {{ o = [0, 0] }}
[bodies.first]
mass = {mass}
length = 1
bending_stiffness = 1
markers = {{ left = -1, right = 1 }}
start = {{ position = [0.5, 0] }}
[bodies.second]
mass = 1
inertia = 0.1
markers = {{ left = [-1, 0], right = [1, 0] }}
start = {{ position = [2, 0] }}
[joints.pin]
kind = "revolute"
between = ["ground.o", "first.left"]
[joints.elbow]
kind = "revolute"
between = ["first.right", "second.left"]
"""


def pair(mass: str = "1") -> Mechanism:
    scene = parse(SCENE.format(mass=mass))
    result = derive.derive(scene)
    assert isinstance(result, Mechanism)
    return result


def test_a_body_that_has_not_changed_is_not_derived_again() -> None:
    one, other = pair(), pair("3")
    assert all(first is second for first, second in zip(one.kinds, other.kinds, strict=True))
    one.expanded()
    before = instances._equations.cache_info()
    other.expanded()
    after = instances._equations.cache_info()
    assert after.hits - before.hits == 1 and after.misses - before.misses == 1  # the mass of the first has changed


def test_equations_that_are_kept_are_those_that_would_be_derived() -> None:
    kept = [pair(mass).expanded() for mass in ("1", "3", "1")]
    kinds._kind.cache_clear()
    instances._equations.cache_clear()
    fresh = [pair("1").expanded(), pair("3").expanded()]
    assert kept[0] == kept[2] == fresh[0] and kept[1] == fresh[1] != fresh[0]
    assert [c.value for c in kept[0].coefficients] != [c.value for c in kept[1].coefficients]


def test_kinematics_and_virtual_work_are_derived_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both forms of the equations of all beams follow from one derivation, whatever their modes and integrals."""

    def rows(n: int, frame: str) -> int:
        shapes = ["1", "xi", *(f"xi^{k}" for k in range(2, n + 2))]
        beam = derive.planar_beam("beam", ansatz=shapes, frame=frame, markers={"tip": 1}, gravity=[0, -9.81])
        return len(derive.derive(beam).expanded().rows)

    assert rows(2, "mean") == 5

    def again(*_: object) -> None:
        raise AssertionError("the kinematics or the virtual work is derived again")

    for owner, name in ((MovingFrame, "dot"), (Motion, "product")):
        monkeypatch.setattr(owner, name, again)
    assert rows(4, "point") == 7
