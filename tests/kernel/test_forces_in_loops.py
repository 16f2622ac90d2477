"""Forces in loops over instances: they differ in their numbers, and act on some of the bodies of a class."""

from __future__ import annotations

from dataclasses import replace

import pytest
from _pytest.mark import ParameterSet
from both_lowerings import check
from random_graphs import lowered

import derive
from derive.backends.model_files import emit
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse

DECK = """\
name = "deck"
[scene]
gravity = [0, -9.81]
[ground.markers]
left = [0, 0]
[bodies.stand]
count = {n}
markers = {{ foot = [0, 0], top = ["0.5*i", "1 + 0.1*i^2"] }}
[joints.stand]
count = {n}
kind = "weld"
between = ["ground.left", "stand[i].foot"]
[bodies.deck]
count = {n}
{mass}
length = 0.5
bending_stiffness = {EI}
markers = {{ a = -1, b = 1 }}
[joints.pin]
kind = "revolute"
between = ["ground.left", "deck[0].a"]
[joints.seam]
count = {n1}
kind = "revolute"
between = ["deck[i].b", "deck[i+1].a"]
"""
PARTS = {
    "cables to stands": """
[springs.cable]
count = {n}
between = ["stand[i].top", "deck[i].b"]
stiffness = "200/(1 + i)"
damping = 3
rest = "0.5 + 0.02*i"
[outputs.pull]
count = {n}
kind = "spring"
spring = "cable[i]"
""",
    "cables of equal numbers": """
[springs.cable]
count = {n}
between = ["stand[i].top", "deck[i].b"]
stiffness = 200
""",
    "some without a cable": """
[springs.cable]
count = {n1}
between = ["deck[i].b", "ground.left"]
stiffness = "200 + i"
rest = 0.5
[outputs.pull]
count = {n1}
kind = "spring"
spring = "cable[i]"
[outputs.energy]
kind = "energy"
""",
    "a gust on one body, torques on all": """
[inputs.gust]
value = 3
unit = "N"
[forces.gust]
at = "deck[2].b"
components = [{{ input = "gust" }}, "sin(3*t)"]
[forces.follower]
count = {n2}
at = "deck[i].a"
frame = "body"
components = [0, "1 + i"]
[torques.twist]
count = {n}
at = "deck[i].a"
value = "0.3*i + 1"
[outputs.place]
count = {n}
kind = "position"
marker = "deck[i].b"
""",
    "springs between bodies": """
[springs.stay]
count = {n2}
between = ["deck[i].a", "deck[i+2].b"]
stiffness = "50 + 20*i"
rest = 1.2
[springs.hinge]
count = {n1}
kind = "rotational"
between = ["deck[i].b", "deck[i+1].a"]
stiffness = "5 + i"
cubic = 2
[outputs.pull]
count = {n2}
kind = "spring"
spring = "stay[i]"
""",
}
PARTS["energies and powers"] = (
    PARTS["cables to stands"]
    + """
[forces.follower]
count = {n2}
at = "deck[i].a"
frame = "body"
components = [0, "1 + i"]
[outputs.energy]
kind = "energy"
[outputs.power]
kind = "power"
"""
)
MASSES = {"equal": "mass = 2", "tapered": 'mass = "2 + 0.3*i"'}
STIFFNESSES = {"number": "30", "parameter": '{ symbol = "EI", default = 30, unit = "N m^2" }'}


def long(*values: str) -> ParameterSet:
    """A case that runs with the long tests."""
    return pytest.param(*values, marks=pytest.mark.long)


def deck(parts: str, mass: str, stiffness: str, count: int = 4) -> Scene:
    counts = {"n": count, "n1": count - 1, "n2": count - 2}
    scene = parse((DECK + PARTS[parts]).format(mass=MASSES[mass], EI=STIFFNESSES[stiffness], **counts))
    assert isinstance(scene, Scene)
    return scene


@pytest.mark.parametrize(
    ("parts", "mass", "stiffness"),
    [
        long("cables to stands", "tapered", "parameter"),
        ("cables of equal numbers", "equal", "number"),
        ("a gust on one body, torques on all", "equal", "parameter"),
        ("energies and powers", "tapered", "parameter"),
        long("cables to stands", "equal", "number"),
        long("some without a cable", "tapered", "number"),
        long("springs between bodies", "tapered", "parameter"),
    ],
)
def test_loops_compute_what_straight_line_code_does(parts: str, mass: str, stiffness: str) -> None:
    made = lowered(deck(parts, mass, stiffness), "chain", 4, ports=True)
    assert made
    check(made)


@pytest.mark.parametrize(
    "parts",
    ["energies and powers", *(long(part) for part in ("a gust on one body, torques on all", "springs between bodies"))],
)
def test_text_does_not_grow_with_forces_that_differ(parts: str) -> None:
    """Bodies with other numbers, with a parameter in the scene, have one code, and so have their forces and outputs."""
    few, many = (lines(deck(parts, "tapered", "parameter", count)) for count in (7, 19))
    assert many < 1.05 * few


def lines(scene: Scene) -> int:
    """The number of lines of C of a scene in loops."""
    scene = replace(scene, lowering="instances")
    files = emit(derive.lower(derive.derive(scene)), scene, ("c",))
    return sum(file.text.count("\n") for file in files if str(file.path).endswith(".c"))
