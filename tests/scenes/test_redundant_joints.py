"""Joints that impose a constraint more often than once: twin joints, and beams that are held along their axes."""

from __future__ import annotations

import pytest
from made import make

import derive
from derive.errors import SpecError
from derive.lowering.flat.graph import LoweringError
from derive.simulation.errors import InextensibleBeam
from derive.spec.toml.read import parse

RIGID = "[bodies.rod]\nmass = 1\ninertia = 1\nmarkers = { a = [-0.5, 0], b = [0.5, 0] }\n"
BEAM = "[bodies.rod]\nlength = 1\nmass = 1\nmarkers = { a = -1, b = 1 }\nstart = { position = [0.5, 0] }\n"
REFUSED = '[scene]\nredundant = "error"\n'


def scene(body: str, second: str) -> object:
    """A rod with a revolute joint to the ground and a second joint."""
    first = '[joints.first]\nkind = "revolute"\nbetween = ["ground.o", "rod.a"]\n'
    return parse(f'name = "rod"\n[ground.markers]\no = [0, 0]\np = [1, 0]\n{body}{first}[joints.second]\n{second}')


TWIN = 'kind = "revolute"\nbetween = ["ground.o", "rod.a"]\n'


@pytest.mark.parametrize("body", [BEAM, f"{RIGID}keep_coordinates = true\n"])
def test_two_identical_revolute_joints_are_redundant(body: str) -> None:
    """For the beam a pivot is the difference of equal expressions, for the rigid body a number."""
    twice = derive.derive(scene(f"{REFUSED}{body}", TWIN))
    with pytest.raises(LoweringError) as error:
        derive.lower(twice)
    assert str(error.value).startswith(
        "2 of the constraints are redundant:\n"
        "  second_1 is implied by first_1\n  second_2 is implied by first_2\nTheir multipliers have no unique value."
    )
    assert derive.lower(derive.derive(scene(body, TWIN))).proximal


def test_a_joint_that_eliminated_coordinates_meet_is_redundant() -> None:
    """The first joint leaves the rod its rotation alone, about the marker that the second joint holds as well."""
    with pytest.raises(SpecError) as error:
        derive.derive(scene(f"{REFUSED}{RIGID}", TWIN)).expanded()
    assert [p.path for p in error.value.problems] == ["joints.second"] * 2
    assert all("redundant: other joints and drives meet it in every state" in p.message for p in error.value.problems)


def test_a_beam_between_two_revolute_joints_cannot_stretch() -> None:
    """To first order, a beam that bends keeps its length: both joints hold it along its axis."""
    made = make(scene(BEAM, 'kind = "revolute"\nbetween = ["ground.p", "rod.b"]\n'))
    with pytest.raises(
        InextensibleBeam,
        match=r"it stretches only with a table axial.* first_1 and second_1 .* roller.* frame = .chord.",
    ):
        made.start()


def test_a_translational_joint_acts_as_a_roller() -> None:
    """The message on the beam that cannot stretch gives this advice."""
    roller = "[bodies.roller]\nmass = 0.1\ninertia = 1\nmarkers = { pin = [0, 0] }\nstart = { position = [1, 0] }\n"
    guide = 'kind = "translational"\nbetween = ["ground.o", "roller.pin"]\n'
    pin = '[joints.third]\nkind = "revolute"\nbetween = ["rod.b", "roller.pin"]\n'
    _, start = make(scene(f"{BEAM}{roller}", f"{guide}{pin}")).start()
    assert start.position_error < 1e-14 and not start.deformed
