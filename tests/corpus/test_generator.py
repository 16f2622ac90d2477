"""The scenes of the corpus are valid, the same from a seed, and use whatever a specification may contain."""

from __future__ import annotations

import subprocess
import sys
from collections import Counter
from functools import cache
from pathlib import Path

import pytest

import derive
from corpus.commands import other_integrator
from corpus.features import all_features, features
from corpus.generator import corpus_scene, spatial_schema
from corpus.time_functions import unknown_functions
from derive import FORCES, JOINTS
from derive.extensions import Key, KeyType
from derive.mechanics.multibody.forces.rotational_spring import RotationalSpring
from derive.mechanics.multibody.joints.revolute import Revolute
from derive.mechanics.multibody.outputs.marker_motion import Distance
from derive.mechanics.multibody.outputs.registry import OUTPUTS
from derive.simulation.integration.registry import INTEGRATORS
from derive.spec.tables.json_schema import schema_of
from derive.spec.tables.specification import specification_table

CORPUS = 2000
"""The seeds 0 to 1999 are the corpus."""

EVERY = all_features(schema_of(specification_table()))
NOT_USED = {
    "NodalTable.nodes as object": "MatrixMarket files: tests/spec/test_node_tables.py",
    **dict.fromkeys(
        ("NodalTable.stress", "NodalTable.stress = true", "NodalTable.stress = false"),
        "no file of the corpus has elements: tests/solids",
    ),
    "SceneTable.start = steady": "few scenes have a steady motion: tests/space/test_steady_rotation.py",
    **dict.fromkeys(
        (
            name
            for name in all_features(schema_of(specification_table()))
            if "AxesTable" in name or "AnglesTable" in name
        ),
        "rotations by axes and by three angles: tests/space/test_rotation_forms.py",
    ),
    **dict.fromkeys(
        (name for name in all_features(schema_of(specification_table())) if "ModeSelectionTable" in name),
        "modes that an error selects: tests/reduction/test_mode_selection.py",
    ),
}
"""The features of specifications that no scene of the corpus uses, with the reasons."""


NOT_IN_SPACE = (
    ".count",  # instances: tests/spec/test_instances.py
    ".lowering",
    "sequence",  # tests/space/test_rotation_forms.py
    "FlexibleTable.frame",  # those of bodies alone, which the corpus has
    "FlexibleTable.order",
    "FlexibleTable.orthonormal",
    "SpatialStartTable",
    "SpatialOutputTable.kind = stress",  # no body of the corpus has elements: tests/solids/test_stress_of_runs.py
    "SpatialSceneTable.start = equilibrium",
    "SpatialInitialValuesTable.guess = false",
    "SpatialBeamStartTable.guess = false",
    "SpatialJointStartTable.guess = false",
    "SpatialJointTable.closes_loop = false",
    "NodeFrameTable.motion",
    "FlexibleTable.loads",  # tests/space/test_nodal_loads.py
    "FlexibleTable.stress",  # the block has no elements: tests/solids/test_stress_of_runs.py
    "NodeFrameTable.set",  # tests/spec/test_node_meshes.py
    "visuals",  # tests/space/test_visuals.py
)
"""Parts of the names of features that no scene in space of the corpus has."""


@cache
def used(count: int = CORPUS) -> Counter[str]:
    """The number of scenes in which each feature occurs."""
    schema, result = schema_of(specification_table()), Counter[str]()
    for seed in range(count):
        result.update({*features(corpus_scene(seed).written, schema)})
    return result


@pytest.mark.long
def test_the_corpus_uses_every_key_word_and_form() -> None:
    every = all_features(schema_of(specification_table()))
    assert {*used()} <= every
    assert every - {*used()} == {*NOT_USED} & every


IN_SPACE = (2000, 2250)
"""Seeds of scenes in space."""


def test_scenes_in_space_use_every_key() -> None:
    """Keys and words, in one form of numbers at least."""
    schema = spatial_schema()
    tables = (
        "Spatial",
        "FlexibleTable",
        "FrameMarkerTable",
        "NodeFrameTable",
        "GearTable",
        "AxesTable",
        "AnglesTable",
        "InputTable",
    )
    every = {name for name in all_features(schema) if name.startswith(tables) and " as " not in name}
    found = {name for seed in range(*IN_SPACE) for name in features(corpus_scene(seed).written, schema)}
    missing = {name for name in every - found if not any(part in name for part in NOT_IN_SPACE)}
    assert missing == set()


def test_scenes_in_space_run_with_every_integrator_and_start_in_steady_rotations() -> None:
    assert {other_integrator(seed) for seed in range(*IN_SPACE)} == {*INTEGRATORS} - {"adaptive", "scipy"}
    steady = [
        scene for scene in map(corpus_scene, range(*IN_SPACE)) if "steady" in scene.tables.get("scene", {}).values()
    ]
    assert len(steady) > 10 and all("velocity" in b["start"] for s in steady for b in s.tables["bodies"].values())


def test_the_corpus_calls_every_function_of_time() -> None:
    assert unknown_functions() == []


def test_scenes_have_one_to_six_bodies_open_and_closed() -> None:
    scenes = [corpus_scene(seed) for seed in range(300)]
    assert {len(scene.tables["bodies"]) for scene in scenes if "bodies" in scene.tables} >= {1, 2, 3, 4, 5, 6}
    linkages = Counter(scene.linkage for scene in scenes)
    assert {"tree", "free", "prescribed", "four_bar", "crank_slider", "beam", "body"} <= {*linkages}


@pytest.mark.parametrize("seed", [*range(60), 354, 466, *range(2000, 2020)])
def test_scenes_are_valid(seed: int, tmp_path: Path) -> None:
    derive.read(corpus_scene(seed).write(tmp_path))


def test_a_seed_is_the_same_scene_in_any_process() -> None:
    code = "from corpus.generator import corpus_scene; print(''.join(corpus_scene(s).text for s in range(20)))"
    environment = {"PYTHONHASHSEED": "7", "PYTHONPATH": str(Path(__file__).parents[1])}
    other = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment)
    assert other.stdout == "".join(corpus_scene(seed).text for seed in range(20)) + "\n"


class Likewise(Distance):
    """An output that no one knows."""


class Hinge(Revolute):
    """A joint that no one knows."""


class Coil(RotationalSpring):
    """A spring that no one knows."""

    keys = (*RotationalSpring.keys, Key("twist", KeyType.QUANTITY, "N m", "A key of its own."))


def test_what_is_registered_enters_by_itself() -> None:
    registered = ((OUTPUTS, "toy_output", Likewise()), (JOINTS, "toy_joint", Hinge()), (FORCES, "toy_coil", Coil()))
    for registry, name, member in registered:
        registry.register(name, member)
    try:
        texts = [corpus_scene(seed).text for seed in range(150)]
    finally:
        for registry, name, _ in registered:
            registry.unregister(name)
    for name in ("toy_output", "toy_joint", "toy_coil", "twist"):
        assert any(f'"{name}"' in text or f"{name} =" in text for text in texts), name
