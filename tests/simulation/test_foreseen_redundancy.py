"""Joints of which more constraints follow than there are velocities are redundant, and resolved at once."""

from __future__ import annotations

from pathlib import Path

import pytest

import derive
from conftest import ROOT
from derive.lowering.redundancy import Dependence
from derive.simulation.errors import RedundantConstraints
from derive.simulation.prepared_run import PreparedRun
from derive.simulation.redundant_joints import excess_constraints, with_redundant_joints
from derive.spec.model.scene import Scene
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene
from derive.spec.toml.read import parse, read

ARM = """name = "arm"
[ground.markers]
o = [0, 0]
[bodies.rod]
length = 1
mass = 1
bending_stiffness = 10
ansatz = ["1", "xi", "xi^2", "xi^3"]
pieces = 2
markers = { left = -1, right = 1 }
start = { position = [0.5, 0] }
[joints.pin]
kind = "revolute"
between = ["ground.o", "rod.left"]
[simulation]
duration = 0.01
output = 0.005
"""
DRIVEN = """[drives.motor]
joint = "pin"
motion = "0.1*t^2"
"""


def arm(twins: int) -> Scene:
    """An arm whose bearing is there several times more; each of them has two constraints."""
    pins = (f'[joints.twin_{k}]\nkind = "revolute"\nbetween = ["ground.o", "rod.left"]\n' for k in range(twins))
    scene = parse(ARM + "".join(pins) + DRIVEN)
    assert isinstance(scene, Scene)
    return scene


# 3 + 2 * 2 velocities of the rod, whose pieces keep 3 constraints for their weld, 2 of each pin and 1 of the drive
EXCESS = {0: 3 - 7, 1: 5 - 7, 3: 9 - 7}


@pytest.mark.parametrize(("twins", "excess"), EXCESS.items())
def test_the_model_that_is_certain_is_the_first(twins: int, excess: int) -> None:
    """It is the only one unless it fails; then the error is that of the model without a proximal term."""
    scene, tried = arm(twins), list[str]()

    def fails(given: AnyScene) -> None:
        tried.append(given.redundant)
        if given.redundant == "resolve":
            raise RedundantConstraints((Dependence("resolved", ()),))
        raise RedundantConstraints((Dependence("plain", ()),))

    assert excess_constraints(scene) == excess
    with pytest.raises(RedundantConstraints, match="plain is implied"):
        with_redundant_joints(scene, fails)
    assert tried == (["resolve", "auto"] if excess > 0 else ["auto", "resolve"])
    assert with_redundant_joints(scene, lambda given: given.redundant) == ("resolve" if excess > 0 else "auto")


TABLE = """name = "table"
[scene]
gravity = [0, -9.81]
[ground.markers]
{feet}
[bodies.top]
mass = 2
inertia = 0.3
markers = {{ {ends} }}
start = {{ position = [0.54, 0.84], guess = true }}
{legs}
[simulation]
duration = 0.01
output = 0.005
"""
LEG = """[bodies.leg_{k}]
mass = 1
inertia = 0.1
centre = [0.5, 0]
markers = {{ foot = [0, 0], end = [1, 0] }}
start = {{ angle = 1 }}
[joints.foot_{k}]
kind = "revolute"
between = ["ground.foot_{k}", "leg_{k}.foot"]
[joints.end_{k}]
kind = "revolute"
between = ["leg_{k}.end", "top.end_{k}"]
"""


def table(legs: int) -> Scene:
    """A table on parallel legs: each adds a velocity and two constraints, and the third is redundant already."""
    feet = "\n".join(f"foot_{k} = [{0.3 * k:.1f}, 0]" for k in range(legs))
    ends = ", ".join(f"end_{k} = [{0.3 * k:.1f}, 0]" for k in range(legs))
    scene = parse(TABLE.format(feet=feet, ends=ends, legs="".join(LEG.format(k=k) for k in range(legs))))
    assert isinstance(scene, Scene)
    return scene


@pytest.mark.parametrize(
    ("legs", "tried"), [pytest.param(3, ["auto", "resolve"], marks=pytest.mark.long), (4, ["resolve"])]
)
def test_a_run_says_the_same(legs: int, tried: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """Whether the redundancy is foreseen or found in the initial state, the bits and the notes are the same."""
    made = list[str]()
    generate = PreparedRun._generate

    def counted(run: PreparedRun, scene: AnyScene) -> None:
        made.append(scene.redundant)
        generate(run, scene)

    monkeypatch.setattr(PreparedRun, "_generate", counted)
    one = PreparedRun(table(legs), complete=False).trajectory()
    assert made == tried
    monkeypatch.setattr("derive.simulation.redundant_joints.excess_constraints", lambda scene: 0)
    other = PreparedRun(table(legs), complete=False).trajectory()
    assert made[len(tried) :] == ["auto", "resolve"]
    assert one.q.tobytes() == other.q.tobytes() and one.lam.tobytes() == other.lam.tobytes()
    assert one.solution.notes == other.solution.notes and "is implied by" in "".join(one.solution.notes)


SPECIFICATIONS = [*sorted((ROOT / "scenes").glob("*.toml")), *sorted((ROOT / "examples").glob("*.toml"))]


@pytest.mark.parametrize("path", [path for path in SPECIFICATIONS if "100" not in path.name], ids=lambda p: p.stem)
def test_excess_constraints_are_those_of_the_model(path: Path) -> None:
    scene = read(path)
    excess = excess_constraints(scene) if isinstance(scene, Scene | SpatialScene) else None
    if isinstance(scene, Scene | SpatialScene) and excess is not None:
        mechanism = derive.derive(scene)
        assert excess == sum(joint.multipliers for joint in mechanism.joints) - len(mechanism.rows)
