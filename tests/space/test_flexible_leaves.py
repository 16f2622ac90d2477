"""Flexible bodies on trees of rigid ones: the same accelerations as by the KKT matrix, by fewer operations."""

from __future__ import annotations

from typing import Any

import pytest
from leaves_on_trees import Solved, both_ways, random_leaves
from trees_of_bodies import Table

LIMIT = 1e-12
"""The largest difference, relative to the largest number."""
TWO = ("revolute", "universal")


def assert_equal(tables: Table, seed: int = 0) -> tuple[Solved, Solved]:
    ours, by_factors = both_ways(tables, seed)
    for a, b in ((ours.vdot, by_factors.vdot), (ours.multipliers, by_factors.multipliers)):
        assert abs(a - b).max() < LIMIT * abs(b).max()
    return ours, by_factors


@pytest.mark.parametrize(
    ("seed", "joints", "free", "beam"),
    [
        (0, ("revolute",), False, {}),
        (1, ("fixed",), False, {"order": 2}),
        (2, ("spherical", "universal"), True, {}),
        (3, ("cylindrical",), False, {"frame": "chord"}),
        (5, ("prismatic",), False, {"frame": "point", "order": 2}),
    ],
)
def test_leaves_add_their_inertia_to_the_body_that_carries_them(
    seed: int, joints: tuple[str, ...], free: bool, beam: dict[str, Any]
) -> None:
    """Whatever the joint, the frame and the order of the beam are."""
    assert_equal(random_leaves(seed, TWO, joints, free, **beam), seed)


def test_flexible_bodies_between_bodies_of_trees() -> None:
    """A beam that two joints hold, one that hangs on it, loops, a drive, springs, and a rigid body beside the tree."""
    tables = random_leaves(10, ("revolute", "revolute"), ("revolute", "revolute"))
    mass = {"mass": 1, "inertia": [1, 1, 1, 0, 0, 0], "markers": {"o": [0, 0, 0.1]}}
    tables["bodies"] |= {"beam3": tables["bodies"]["beam1"], "ball": mass}
    tables["joints"] |= {
        "held": {"kind": "spherical", "between": ["body1.o", "beam1.right"]},
        "on_beam": {"kind": "universal", "between": ["beam2.right", "beam3.left"]},
        "hook": {"kind": "revolute", "between": ["beam3.right", "ball.o"]},
        "rod": {"kind": "distance", "between": ["ground.far", "beam2.right"], "distance": 1},
    }
    tables["springs"]["soft"] = {"kind": "linear", "between": ["beam2.right", "body1.o"], "stiffness": 3, "rest": 1}
    tables["drives"] = {"motor": {"joint": "to_beam2", "motion": "0.3*sin(2*t)"}}
    assert_equal(tables)


def test_gears_between_flexible_bodies_and_trees() -> None:
    """A gear acts on the rotations of joints, and a drive of a tree on a coordinate."""
    tables = random_leaves(10, ("revolute", "revolute"), ("revolute",))
    tables["gears"] = {"pair": {"joints": ["to_beam1", "joint1"], "ratio": -2}}
    tables["drives"] = {"motor": {"joint": "joint2", "motion": "0.3*sin(2*t)"}}
    assert_equal(tables)
