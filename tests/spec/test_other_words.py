"""Keys that engineers call by other words: the hint names the key that is meant."""

import json
from collections.abc import Iterator
from typing import Any

import pytest

import derive
from derive.spec.parsing.other_words import OTHER_CHOICES, OTHER_WORDS
from derive.spec.tables.json_schema import json_schema
from derive.spec.toml.read import parse

SCENE = """
name = "s"
[ground.markers]
o = [0, 0]
[bodies.rod]
mass = 1
length = 1
bending_stiffness = 1
[bodies.rod.markers]
left = -1
right = 1
[bodies.block]
mass = 1
inertia = 1
[bodies.block.markers]
a = [0, 0]
[joints.pin]
kind = "revolute"
between = ["ground.o", "rod.left"]
[drives.motor]
joint = "pin"
speed = 1
[springs.mount]
between = ["ground.o", "block.a"]
stiffness = 1
[forces.load]
at = "rod.right"
components = [0, 1]
[simulation]
duration = 1
output = 0.1
"""


@pytest.mark.parametrize(
    ("after", "key", "hint"),
    [
        ("[springs.mount]", "length", 'springs.mount.length: unknown key; did you mean "rest"?'),
        ("[springs.mount]", "L0", 'springs.mount.L0: unknown key; did you mean "rest"?'),
        ("[springs.mount]", "k", 'springs.mount.k: unknown key; did you mean "stiffness"?'),
        ("[springs.mount]", "damper", 'springs.mount.damper: unknown key; did you mean "damping"?'),
        ("[springs.mount]", "damping_constant", 'unknown key; did you mean "damping"?'),
        ("[drives.motor]", "angle", 'drives.motor.angle: unknown key; did you mean "motion"?'),
        ("[drives.motor]", "omega", 'drives.motor.omega: unknown key; did you mean "speed"?'),
        ("[joints.pin]", "type", 'joints.pin.type: unknown key; did you mean "kind"?'),
        ("[joints.pin]", "speed", "joints.pin.speed: this key belongs in the table [joints.pin.start]"),
        ("[forces.load]", "force", 'forces.load.force: unknown key; did you mean "components"?'),
        ("[bodies.rod]", "EI", 'bodies.rod.EI: unknown key; did you mean "bending_stiffness"?'),
        ("[bodies.rod]", "elements", 'bodies.rod.elements: unknown key; did you mean "pieces"?'),
        ("[bodies.rod]", "deflection", "bodies.rod.deflection: this key belongs in the table [bodies.rod.start]"),
        ("[bodies.block]", "J", 'bodies.block.J: unknown key; did you mean "inertia"?'),
        ("[bodies.block]", "position", "bodies.block.position: this key belongs in the table [bodies.block.start]"),
        ("[simulation]", "t_end", 'simulation.t_end: unknown key; did you mean "duration"?'),
        ("[simulation]", "dt", 'simulation.dt: unknown key; did you mean "output"?'),
    ],
)
def test_the_key_that_is_meant_is_named(after: str, key: str, hint: str) -> None:
    with pytest.raises(derive.SpecError) as error:
        parse(SCENE.replace(after, f"{after}\n{key} = 1"))
    assert hint in str(error.value)


def test_the_keys_that_are_meant_exist() -> None:
    assert not OTHER_WORDS.keys() - set(keys(json.loads(json_schema())))


def test_the_choices_that_are_meant_exist() -> None:
    assert not OTHER_CHOICES.keys() - set(choices(json.loads(json_schema())))


def keys(schema: Any) -> Iterator[str]:
    """All keys of all tables in a JSON schema."""
    if isinstance(schema, list):
        for item in schema:
            yield from keys(item)
    if isinstance(schema, dict):
        yield from schema.get("properties", {})
        for item in schema.values():
            yield from keys(item)


def choices(schema: Any) -> Iterator[str]:
    """All choices of all keys in a JSON schema."""
    if isinstance(schema, dict):
        yield from schema.get("enum", ())
    for item in schema.values() if isinstance(schema, dict) else schema if isinstance(schema, list) else ():
        yield from choices(item)
