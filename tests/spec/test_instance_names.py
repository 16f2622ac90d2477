"""The names of instances in references, code and columns."""

from __future__ import annotations

import pytest
from test_instances import CHAIN

import derive
from derive.errors import SpecError
from derive.spec.as_tables import specification_tables
from derive.spec.model.instances import identifier, instance_name
from derive.spec.toml.read import parse
from explicit_motion import moved


def test_identifiers_are_names_without_brackets():
    assert identifier(instance_name("link", 3)) == "link_3"
    assert identifier(instance_name("link", 3), "left") == "link_3_left"
    assert identifier("tip", "") == "tip"


def test_code_and_columns_have_identifiers_and_texts_have_names():
    equations = derive.derive(parse(CHAIN)).expanded()
    assert equations.coordinates[5].q.name == "link_1_c1"
    assert equations.coordinates[5].doc.startswith("link[1]: ")
    assert [c.name for c in equations.constraints][2] == "weld_0_1"
    assert equations.constraints[2].doc == "link[0].right and link[1].left coincide along e1"
    assert [o.name for o in equations.outputs][:2] == ["tip_0_1", "tip_0_2"]
    assert [marker.name for marker in equations.markers][:2] == ["link_0_left", "link_0_right"]
    assert [pose.name for pose in equations.poses][1] == "link[1]"


@pytest.mark.long
def test_a_scene_moves_like_the_one_with_other_names():
    """The same scene with the names of the identifiers: the code is the same, and so is every digit."""

    def renamed(value):
        if isinstance(value, dict):
            return {identifier(key): renamed(item) for key, item in value.items()}
        if isinstance(value, list):
            return [renamed(item) for item in value]
        return identifier(value) if isinstance(value, str) else value

    tables = specification_tables(parse(CHAIN))
    plain = {section: renamed(table) if section != "simulation" else table for section, table in tables.items()}
    one, other = moved(parse(CHAIN)), moved(derive.scene(plain))
    assert one.q.tobytes() == other.q.tobytes()
    assert one.model.coordinates[3].name == other.model.coordinates[3].name == "link_0_alpha1"
    assert [*map(identifier, one.columns)] == [*other.columns]


def test_columns_have_the_names_of_instances() -> None:
    """Coordinates, rates, multipliers and outputs, in plots and conditions as well."""
    text = CHAIN.replace("[simulation]", '[plots.turn]\ny = ["link[2]_phi", "tip[3]_1"]\n[simulation]')
    motion = moved(parse(text), until="link[1]_phi < -0.001", duration=0.05)
    names = ["link[3]_alpha2", "link[0]_phidot", "lambda_weld[2]_turn", "lambda_hinge_1", "tip[1]_2", "reaction[0]_1"]
    assert set(names) <= set(motion.columns)
    assert not any("link_" in name for name in motion.columns)
    assert motion["link[1]_phi"][-1] == pytest.approx(-0.001) and motion.t[-1] < 0.05


def test_a_column_has_one_name() -> None:
    with pytest.raises(SpecError, match=r'there is no column "link_2_phi"; did you mean "link\[2\]_phi"'):
        parse(CHAIN.replace("[simulation]", '[plots.turn]\ny = ["link_2_phi"]\n[simulation]'))
