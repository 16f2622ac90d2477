"""The JSON schema accepts what is right, and refuses what an editor can see to be wrong."""

import json
import tomllib
from pathlib import Path

import pytest
from example_scenes import EVERYTHING, SMALL, small
from json_schema import problems

from derive.spec.tables.json_schema import json_schema, schema_of
from derive.spec.tables.spatial_scene import spatial_specification_table

SCENES = Path(__file__).parents[2] / "scenes"
SCHEMA = json.loads(json_schema())


def found(text):
    return list(problems(tomllib.loads(text), SCHEMA, SCHEMA))


@pytest.mark.parametrize(
    "path", [*sorted(SCENES.glob("*.toml")), SCENES / "../examples/chain_100.toml"], ids=lambda path: path.stem
)
def test_the_schema_accepts_the_scenes(path):
    assert found(path.read_text()) == []


@pytest.mark.parametrize("text", [EVERYTHING, SMALL], ids=["everything", "small"])
def test_the_schema_accepts_what_is_read(text):
    assert found(text) == []


@pytest.mark.parametrize(
    "text",
    [
        'name = "s"\n',
        'name = "s"\n[scene]\n',
        'name = "s"\n[bodies]\n',
        'name = "s"\n[beam]\n[bodies.b]\n',
        'name = "s"\n[beam]\n[joints]\n',
        small(("mass = 1", "mass = -1")),
        small(("mass = 1", "mas = 1")),
        small(("mass = 1", "pieces = 2")),
        small(("length = 1", "length = 1\ninertia = 1")),
        small(("a = [0, 0]", "a = [0, 0, 0]")),
        small(("a = [0, 0]", "a = 0")),
        small(("left = -1", "left = -2")),
        small(("left = -1", "left = [0, 0]")),
        small(("[bodies.bar]", '[bodies."a bar"]')),
        small(("[joints.pin]", '[joints."p.n"]')),
        small(('kind = "revolute"', 'kind = "revolut"')),
        small(('kind = "revolute"', "")),
        small(('["ground.o", "bar.a"]', '["ground.o"]')),
        small(('["ground.o", "bar.a"]', '["ground", "bar.a"]')),
        small(more="[simulation]\nduration = 1\n"),
        small(more="[simulation]\nduration = 1\noutput = 0\n"),
        small(more="[drives.d]\nspeed = 1\n"),
        small(more='[plots.p]\ndeflection = "rod.left"\n'),
    ],
)
def test_the_schema_refuses(text):
    assert found(text)


def test_every_section_of_a_scene_in_space_is_known():
    """Gears are in space alone; they need bodies as well."""
    assert set(schema_of(spatial_specification_table())["properties"]) <= set(SCHEMA["properties"])
    mesh = '[gears.mesh]\njoints = ["sun", "planet"]\nratio = "-20/37"\n'
    text = f'name = "s"\n{mesh}[bodies.b]\nmass = 1\ninertia = [1, 1, 1, 0, 0, 0]\n'
    assert found(text) == []
    assert found(text.replace("ratio", "ratios")) and found(f'name = "s"\n[beam]\n{mesh}')


def test_a_scene_is_one_of_three():
    assert SCHEMA["oneOf"] == [{"required": ["beam"]}, {"required": ["body"]}, {"required": ["bodies"]}]
    assert set(SCHEMA["dependentRequired"]) == {*SCHEMA["properties"]} - {
        "name",
        "beam",
        "body",
        "bodies",
        "simulation",
        "plots",
    }


def test_a_default_is_what_a_file_may_say():
    assert SCHEMA["$defs"]["LoadTable"]["properties"]["time"]["default"] == 1
