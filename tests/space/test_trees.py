"""Relative coordinates: which joints give them, and the same motion as in absolute coordinates."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest
from trees_of_bodies import KINDS, both, lowered, random_tree

import derive
from derive.errors import SpecError
from derive.export.fmi.variables import fmi_variables
from derive.mechanics.multibody.space.tree.plan import MOST_BODIES, trees
from derive.spec.model.spatial_scene import SpatialScene

LIMIT = 1e-13
"""The largest difference, relative to the largest number."""
INERTIA = [1, 1.2, 1.4, 0, 0, 0]


CASES = {0: KINDS[:4], 1: KINDS[4:], 3: KINDS, 5: ("spherical",) * 3}
SHORT = ((0, True), (1, False), (5, True))


@pytest.mark.parametrize(
    ("seed", "free"),
    [pytest.param(*of, marks=() if of in SHORT else pytest.mark.long) for of in product(CASES, (False, True))],
)
def test_same_motion_as_with_all_coordinates(seed: int, free: bool) -> None:
    """Poses, accelerations, energies, powers and reactions of a tree with every kind of joint, in any direction."""
    relative, absolute = both(random_tree(seed, CASES[seed], free), seed)
    assert relative.multipliers == 0 < absolute.multipliers
    assert relative.velocities == absolute.velocities - absolute.multipliers
    assert abs(relative.poses - absolute.poses).max() < LIMIT
    assert abs(relative.outputs - absolute.outputs).max() < LIMIT * abs(absolute.outputs).max()


def loop(**changes: Any) -> SpatialScene:
    """A four-bar linkage in the plane x, y with a spherical joint, and further keys of it."""
    o, e = [0, 0, 0], [1, 0, 0]
    bodies = {name: {"mass": 1, "inertia": INERTIA, "markers": {"o": o, "e": e}} for name in ("a", "b", "c")}
    between = {"j1": ["ground.o", "a.o"], "j2": ["a.e", "b.o"], "j3": ["b.e", "c.e"], "j4": ["ground.e", "c.o"]}
    kinds = {"j1": "revolute", "j2": "revolute", "j3": "spherical", "j4": "revolute"}
    joints = {name: {"kind": kinds[name], "between": ends} for name, ends in between.items()}
    for name, keys in changes.get("joints", {}).items():
        joints[name] |= keys
    others = {key: value for key, value in changes.items() if key != "joints"}
    return derive.spatial_scene("linkage", ground={"o": o, "e": e}, bodies=bodies, joints=joints, **others)


def constraints_of(scene: SpatialScene) -> set[str]:
    return {c.of for c in derive.derive(scene).expanded().constraints}


def test_the_joint_that_removes_least_closes_a_loop() -> None:
    """Unless the specification names another one; the fewest multipliers remain."""
    assert constraints_of(loop()) == {"j3"}
    assert constraints_of(loop(joints={"j2": {"closes_loop": True}})) == {"j2"}
    assert constraints_of(loop(joints={name: {"closes_loop": True} for name in ("j1", "j2")})) == {"j1", "j2"}
    assert constraints_of(loop(coordinates="absolute")) == {"j2", "j3"}


def test_a_ball_leaves_one_rotation() -> None:
    body = {"mass": 1, "inertia": INERTIA, "markers": {"o": [0, 0, 0]}}
    joints = {"ball": {"kind": "spherical", "between": ["ground.o", "a.o"]}}
    scene = derive.spatial_scene("ball", ground={"o": [0, 0, 0]}, bodies={"a": body}, joints=joints)
    (said,) = (out.reason for out in derive.derive(scene).eliminated if out.what == "a")
    assert "and only its rotation remains; this eliminates 3" in said


def test_bodies_that_hang_on_the_ground_or_on_drives_alone_are_no_trees() -> None:
    """A drive prescribes the motion of its body, unless a body hangs on another one behind it."""
    driven = loop(drives={"motor": {"joint": "j1", "speed": 2}})
    assert [link.body for link in trees(driven)] == []
    assert constraints_of(driven) == {"j3"}
    longer = replace(driven, joints=tuple(j for j in driven.joints if j.name != "j4"))
    equations = derive.derive(longer).expanded()
    assert [row.name for row in equations.rows][:2] == ["a_phi", "b_phi"]
    assert [c.shown for c in equations.constraints] == ["motor"]


def test_a_drive_in_a_tree_is_a_constraint_on_a_coordinate() -> None:
    """Its multiplier is its torque, as in absolute coordinates."""
    tables = random_tree(5, ("revolute", "revolute", "spherical"))
    tables["drives"] = {"motor": {"joint": "joint1", "motion": "0.3*sin(2*t)"}}
    tables["outputs"] = {"torque": {"kind": "drive", "drive": "motor"}, "energy": {"kind": "energy"}}
    relative, absolute = both(tables, 5, drive=("body1_phi", 0.0, 0.6))
    assert (relative.multipliers, absolute.multipliers) == (1, 1 + 5 + 5 + 3)
    assert abs(relative.outputs - absolute.outputs).max() < LIMIT * abs(absolute.outputs).max()


def test_automatic_choice() -> None:
    """Loops over instances and trees of very many bodies keep absolute coordinates."""
    assert {link.body for link in trees(loop())} == {"a", "b"}
    assert trees(loop(lowering="instances")) == ()
    body = {"mass": 1, "inertia": INERTIA, "markers": {"o": [0, 0, 0], "e": [1, 0, 0]}}

    def chain(n: int, **keys: str) -> SpatialScene:
        ends = {f"j{k}": [f"b{k - 1}.e" if k else "ground.o", f"b{k}.o"] for k in range(n)}
        joints = {name: {"kind": "revolute", "between": between} for name, between in ends.items()}
        bodies = {f"b{k}": body for k in range(n)}
        return derive.spatial_scene("chain", ground={"o": [0, 0, 0]}, bodies=bodies, joints=joints, **keys)

    assert len(trees(chain(MOST_BODIES))) == MOST_BODIES
    assert trees(chain(MOST_BODIES + 1)) == ()
    assert len(trees(chain(MOST_BODIES + 1, coordinates="relative"))) == MOST_BODIES + 1


def massless(**of_last: Any) -> dict[str, Any]:
    """Two revolute joints with a body without mass between them; keys of the body behind it."""
    axes = {"x": [0, 1, 0], "z": [1, 0, 0]}
    cross = {"markers": {"o": [0, 0, 0], "e": {"at": [0, 0, 0], "rotation": axes}}}
    last = {"markers": {"o": {"at": [0, 0, 1], "rotation": axes}}, **of_last}
    return {
        "name": "joint",
        "ground": {"markers": {"o": [0, 0, 0]}},
        "scene": {"gravity": [0, 0, -9.81]},
        "bodies": {"cross": cross, "last": last},
        "joints": {
            "first": {"kind": "revolute", "between": ["ground.o", "cross.o"]},
            "second": {"kind": "revolute", "between": ["cross.e", "last.o"]},
        },
        "outputs": {"a": {"kind": "acceleration", "marker": "last.o"}, "energy": {"kind": "energy"}},
    }


def test_a_body_without_mass_between_two_joints() -> None:
    """It makes the motion of one with next to no mass."""
    tables = massless(mass=2, inertia=INERTIA, centre=[0, 0.3, 0.2])
    light = {**tables["bodies"]["cross"], "mass": 1e-9, "inertia": [1e-9, 1e-9, 1e-9, 0, 0, 0]}
    every = [tables, {**tables, "bodies": {**tables["bodies"], "cross": light}}]
    q, v = np.array([0.4, 0.9]), np.array([1.0, -2.0])
    none, some = (lowered(derive.spatial_scene(of)).state(q, v).outputs for of in every)
    assert np.allclose(none, some, rtol=1e-8, atol=1e-8)


def test_bodies_without_mass_that_carry_none() -> None:
    """A line for each, with the joint that is singular."""
    with pytest.raises(SpecError, match="no drive prescribes the motion of this body"):
        derive.spatial_scene(massless())
    tables = massless(markers={"o": [0, 0, 1], "e": [0, 0, 2]})
    tables["bodies"]["end"] = {"markers": {"o": [0, 0, 0]}}
    tables["joints"]["third"] = {"kind": "fixed", "between": ["last.e", "end.o"]}
    with pytest.raises(SpecError, match="end moves and carries no mass, so that joint third is singular"):
        derive.derive(derive.spatial_scene(tables))
    tables["bodies"]["end"] |= {"mass": 1, "inertia": INERTIA}
    assert len(derive.derive(derive.spatial_scene(tables)).rows) == 2


def test_a_drive_of_a_joint_that_keeps_its_coordinate_has_a_multiplier_in_an_fmu() -> None:
    """The rotor of a turbine turns on a nacelle that moves: its export ended with an error of the program."""
    bodies = {
        "nacelle": {"mass": 2, "inertia": [1, 1, 1, 0, 0, 0], "markers": {"shaft": [0, 0, 0]}},
        "rotor": {"mass": 1, "inertia": [1, 1, 2, 0, 0, 0], "markers": {"shaft": [0, 0, 0]}},
    }
    turbine = derive.spatial_scene(
        "turbine",
        bodies=bodies,
        joints={"shaft": {"kind": "revolute", "between": ["nacelle.shaft", "rotor.shaft"]}},
        drives={"motor": {"joint": "shaft", "speed": 6}},
    )
    names = [variable.name for variable in fmi_variables(derive.host_model(turbine))]
    assert names[-1] == "shaft.lambda[1]"
