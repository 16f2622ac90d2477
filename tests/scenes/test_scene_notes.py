"""Bodies that no joint and no spring connects with the ground are noted."""

from __future__ import annotations

import pytest

import derive
from derive.notes.scene_notes import scene_notes
from explicit_motion import moved

BODY = {"mass": 1, "inertia": 1, "markers": {"a": [0, 0], "b": [1, 0]}}
HINGE = {"kind": "revolute", "between": ["ground.o", "one.a"]}
PIN = {"kind": "revolute", "between": ["two.b", "three.a"]}
TIE = {"between": ["one.b", "two.a"], "stiffness": 1}


@pytest.mark.parametrize(
    ("more", "notes"),
    [
        (
            {"joints": {"hinge": HINGE, "pin": PIN}},
            ["two, three: no joint and no spring connects them with the ground"],
        ),
        ({"joints": {"hinge": HINGE}}, ["two: no joint and no spring connects it", "three: no joint and no spring"]),
        ({"joints": {"hinge": HINGE, "pin": PIN}, "springs": {"tie": TIE}}, []),
        ({"joints": {"pin": PIN}}, ["one: no joint", "two, three: no joint"]),
        ({}, ["one: no joint", "two: no joint", "three: no joint"]),
        ({"ground": {}}, []),
    ],
)
def test_groups_of_bodies_without_the_ground(more: dict, notes: list[str]) -> None:
    """A joint may have been left out; a scene without joints and points of the ground is one of free bodies."""
    bodies = dict.fromkeys(("one", "two", "three"), BODY)
    made = scene_notes(derive.scene("loose", **{"ground": {"o": [0, 0]}, "bodies": bodies, **more}))
    assert len(made) == len(notes) and all(map(str.startswith, made, notes))


def test_they_fall_where_there_is_gravity() -> None:
    (note,) = scene_notes(derive.scene("falling", gravity=[0, -9.81], ground={"o": [0, 0]}, bodies={"one": BODY}))
    assert note.endswith("so it falls freely; add a joint if this is not intended")
    assert (
        note
        in moved(
            derive.scene("falling", gravity=[0, -9.81], ground={"o": [0, 0]}, bodies={"one": BODY}),
            duration=0.1,
            output=0.1,
        ).notes
    )
