"""Specifications in manifests: the instances of a table are one entry, from which each of them follows."""

from __future__ import annotations

import json
import re
from typing import Any

import pytest

from derive.backends.merged_instances import merged_instances
from derive.backends.model_files import specification
from derive.spec.toml.read import parse

TAPER = """
name = "taper"
ground.markers = { hook = [0, 0] }
[bodies.first]
mass = 1
inertia = 0.1
markers = { right = [0.1, 0] }
[bodies.link]
count = 4
mass = "0.1*(i + 1)"
inertia = "0.01*(i + 1)^2"
markers = { left = [0, 0], right = ["0.1*(i + 1)", 0] }
[joints.hinge]
kind = "revolute"
between = ["ground.hook", "first.right"]
[joints.pin]
count = 3
kind = "revolute"
between = ["link[i].right", "link[i+1].left"]
[forces.push]
count = 4
at = "link[i].right"
components = [0, "i*t"]
[springs.coil]
kind = "rotational"
count = 2
between = ["link[i+2].right", "link[0].left"]
stiffness = "2^i"
[simulation]
duration = 1
output = 0.1
"""


def expanded(value: Any, i: int, first: int) -> Any:
    """A value of instance i of an entry whose first instance has the index `first`."""
    if isinstance(value, dict):
        if value.keys() == {"each"}:
            return value["each"][i - first]
        return {key: expanded(item, i, first) for key, item in value.items()}
    if isinstance(value, list):
        return [expanded(item, i, first) for item in value]
    if isinstance(value, str):
        return re.sub(r"\[i([+-]\d+)?\]", lambda match: f"[{i + int(match[1] or 0)}]", value)
    return value


def every_instance(entry: dict[str, Any]) -> list[dict[str, Any]]:
    if "i" not in entry:
        return [entry]
    first, last = entry["i"]
    rest = {key: value for key, value in entry.items() if key != "i"}
    return [expanded(rest, i, first) for i in range(first, last + 1)]


def test_all_instances_follow_from_their_entry() -> None:
    data = specification(parse(TAPER))
    merged = merged_instances(data)
    bodies, joints, forces = (merged[section] for section in ("bodies", "joints", "forces"))
    assert isinstance(bodies, list) and [body["name"] for body in bodies] == ["first", "link[i]"]
    assert isinstance(joints, list) and joints[1]["second"] == {"body": "link[i+1]", "marker": "left"}
    assert bodies[1]["mass"] == {"each": ["1/10", "1/5", "3/10", "2/5"]} and isinstance(forces, list)
    for section, value in merged.items():
        named = section in ("bodies", "joints", "forces", "springs")
        entries: Any = value
        again = [one for entry in entries for one in every_instance(entry)] if named else value
        assert again == data[section]


@pytest.mark.parametrize("section", ["bodies", "joints", "springs"])
def test_only_numbers_grow_with_their_number(section: str) -> None:
    few = merged_instances(specification(parse(TAPER)))
    text = TAPER
    for count, other in ((4, 40), (3, 39), (2, 20)):
        text = text.replace(f"count = {count}\n", f"count = {other}\n")
    many = merged_instances(specification(parse(text)))
    numbers = re.compile(r'"each": \[[^\]]*\]')
    texts = [numbers.sub("", json.dumps(of[section])) for of in (few, many)]
    assert abs(len(texts[1]) - len(texts[0])) <= 10


def test_instances_of_different_keys_stay_apart() -> None:
    data = {"bodies": [{"name": "a[0]", "x": 1}, {"name": "a[1]", "x": 1, "y": 2}, {"name": "a[2]", "x": 3, "y": 2}]}
    merged = merged_instances(data)
    assert merged["bodies"] == [
        {"name": "a[0]", "x": 1},
        {"name": "a[i]", "i": [1, 2], "x": {"each": [1, 3]}, "y": 2},
    ]
