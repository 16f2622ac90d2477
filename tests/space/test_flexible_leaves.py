"""Flexible bodies on trees of rigid ones: the same accelerations as by the KKT matrix, by fewer operations."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from leaves_on_trees import both_ways, random_leaves
from trees_of_bodies import Table

import derive
from derive.lowering.flat.constraints import COMPARED_WITH_OTHERS
from explicit_motion import moved

LIMIT = 1e-12
"""The largest difference, relative to the largest number."""
TWO = ("revolute", "universal")


def assert_equal(tables: Table, seed: int = 0) -> None:
    ours, by_factors = both_ways(tables, seed)
    for a, b in ((ours.vdot, by_factors.vdot), (ours.multipliers, by_factors.multipliers)):
        assert abs(a - b).max() < LIMIT * abs(b).max()


@pytest.mark.parametrize(
    ("seed", "joints", "free", "beam"),
    [
        pytest.param(0, ("revolute",), False, {}, marks=pytest.mark.long),
        (1, ("fixed",), False, {"order": 2}),
        (2, ("spherical", "universal"), True, {}),
        pytest.param(3, ("cylindrical",), False, {"frame": "chord"}, marks=pytest.mark.long),
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


@pytest.mark.long
def test_leaves_of_many_rows_have_the_accelerations_of_the_kkt_matrix() -> None:
    """A scene of more rows and multipliers than those of which the lowering compares both ways."""
    tables = random_leaves(0, TWO, ("revolute",) * 8)
    ours, by_factors = both_ways(tables)
    assert len(ours.vdot) + len(ours.multipliers) > COMPARED_WITH_OTHERS
    for a, b in ((ours.vdot, by_factors.vdot), (ours.multipliers, by_factors.multipliers)):
        assert abs(a - b).max() < LIMIT * abs(b).max()
    assert ours.operations < by_factors.operations


@pytest.mark.long
def test_energy_of_a_boom_is_conserved() -> None:
    """Four rigid links and a lance of second order at their end: fewer operations than with the KKT matrix."""
    axis = {"z": [0, 1, 0], "x": [1, 0, 0]}
    ends = {"o": {"at": [0, 0, 0], "rotation": axis}, "e": {"at": [0.5, 0, 0.1], "rotation": axis}}
    link = {"mass": 2, "inertia": [0.1, 0.2, 0.2, 0, 0, 0], "markers": ends}
    lance = {"length": 1, "mass": 0.8, "rotary_inertia": 1e-4, "ansatz": ["1", "xi", "xi^2"], "order": 2}
    lance |= {"bending_stiffness": 30, "lateral": {"bending_stiffness": 20}}
    lance |= {"markers": {"o": {"at": -1, "rotation": axis}, "e": 1}}
    names = ["ground", *(f"link{k}" for k in range(4)), "lance"]
    pairs = {f"joint{k}": [f"{a}.{'e' if k else 'o'}", f"{b}.o"] for k, (a, b) in enumerate(pairwise(names))}
    tables: Table = {
        "name": "boom",
        "scene": {"gravity": [0, 0, -9.81]},
        "ground": {"markers": {"o": [0, 0, 0]}},
        "bodies": {**dict.fromkeys(names[1:-1], link), "lance": lance},
        "joints": {name: {"kind": "revolute", "between": between} for name, between in pairs.items()},
        "simulation": {"duration": 0.3, "output": 0.03, "tolerance": 1e-10},
    }
    tables["joints"]["joint0"]["start"] = {"speed": 4}
    ours, by_factors = both_ways(tables)
    assert ours.operations < by_factors.operations
    run = moved(derive.spatial_scene(tables))
    energies = np.array([run.motion.native.energy(q, v, run.motion.k) for q, v in zip(run.q, run.v, strict=True)])
    assert np.ptp(energies[:, 1]) > 1e-3, "the lance deforms"
    assert np.ptp(energies.sum(axis=1)) < 1e-7 * np.ptp(energies[:, 0])
