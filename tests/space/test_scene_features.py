"""Random scenes in space have all that the registries and the specification offer, and the oracle knows all of it."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest
from random_scenes import random_writer
from relative_motion import REMOVED
from scene_features import NOT_IN_EQUATIONS, TABLES, Feature, features, keys_of_tables, possible, spring_types
from space_kernels import RANDOM_SEEDS
from space_oracle import SpaceOracle
from written_functions import WrittenFunctions
from written_scene import tables

from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS, SpatialJointType
from derive.registry import Registry
from derive.spec.parsing.time_expression import FUNCTIONS, WHOLE


@cache
def drawn() -> frozenset[Feature]:
    """The features of all random scenes that are compared."""
    return frozenset().union(*(features(tables(random_writer(seed).text())) for seed in RANDOM_SEEDS))


def test_random_scenes_have_all_features() -> None:
    assert len(RANDOM_SEEDS) >= 100
    assert sorted(possible() - drawn()) == []


def test_what_is_left_out_is_there() -> None:
    """Each feature that has no effect on the equations is a key or a choice of one."""
    known = {(table, key.name) for table, key in keys_of_tables()}
    assert {feature[:2] for feature in NOT_IN_EQUATIONS} <= known | {("scene", "lowering"), ("scene", "start")}
    assert {table for table, _ in known} >= {*TABLES}


def test_the_oracle_knows_the_kinds() -> None:
    assert {*REMOVED, "distance", "general"} == {*SPATIAL_JOINTS}
    spring = '[bodies.a]\n[ground.markers]\no = [0, 0, 0]\n[springs.s]\nkind = "{}"\nbetween = ["ground.o", "ground.o"]'
    for kind, _ in spring_types():
        oracle = SpaceOracle(tables(spring.format(kind)), ["a_c1"])
        assert len(oracle.elements()) == (6 if kind == "bushing" else 1)
    with pytest.raises(NotImplementedError, match="twist"):
        SpaceOracle(tables(spring.format("twist")), ["a_c1"]).elements()
    functions = WrittenFunctions({}, {}, Path())
    operands = {"step": "(t, 0, 2)", "atan2": "(t, 1)", "piecewise": "(t < 1, 1, 2)"}
    for name in FUNCTIONS:
        if name not in WHOLE:
            functions(f"{name}{operands.get(name, '(t)')}", tables("x = 0.5")["x"])
    with pytest.raises(NotImplementedError, match="floor"):
        functions("floor(t)", tables("x = 0.5")["x"])


def test_a_new_joint_is_a_feature(monkeypatch: pytest.MonkeyPatch) -> None:
    """A joint that the registry gains is needed in random scenes, and then in the oracle."""
    kinds = {**dict(SPATIAL_JOINTS.items()), "twisted": SpatialJointType("the frames are twisted", ("x", "rz"))}
    monkeypatch.setattr("scene_features.SPATIAL_JOINTS", Registry("joint in space", kinds))
    assert {("joint", "kind", "twisted"), ("flexible body", "joint", "twisted")} <= possible() - drawn()
