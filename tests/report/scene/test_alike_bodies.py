"""Bodies that are alike are shown once; what one of them alone bears is shown for this one."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

import derive
from conftest import ROOT
from derive.mechanics.multibody.mechanism import Mechanism
from derive.mechanics.symbols import Family, identity
from derive.report.document.page import TableBlock
from derive.report.notation.expressions import notation
from derive.report.sections.alike_bodies import EquationsShownOnce, shown_once
from derive.report.sections.alike_joints import ConstraintsShownOnce, constraints_once
from derive.report.sections.instance_rows import enumeration_of_instances
from derive.report.sections.instance_values import value_blocks
from derive.spec.model.beam_parts import BeamDamping
from derive.spec.toml.read import parse


def once(scene: derive.Scene) -> EquationsShownOnce:
    mechanism = derive.derive(scene)
    assert isinstance(mechanism, Mechanism)
    return shown_once(mechanism)


def rod(**more: object) -> derive.Scene:
    """A heavy rod in four pieces that hangs from a pin."""
    return derive.scene(
        "rod",
        ground={"pin": [0, 0]},
        gravity=[0, "-9.81"],
        bodies={"rod": {"length": 1, "pieces": 4, "markers": {"left": -1, "right": 1}}},
        joints={"pin": {"kind": "revolute", "between": ["ground.pin", "rod.left"]}},
        **more,
    )


def test_beams_of_one_kind_are_shown_once() -> None:
    result = once(derive.read(ROOT / "scenes" / "four_bar.toml"))
    assert result.alike == {"crank": ("coupler", "rocker")}
    assert {identity(row.v).owner for row in result.equations.rows} == {"crank"}


def test_bodies_that_keep_other_coordinates_are_not_alike() -> None:
    """K1 to K7 are of three kinds; joints eliminate coordinates of some."""
    scene = derive.read(ROOT / "examples" / "andrews_squeezer.toml")
    assert once(scene).alike == {"K2": ("K4", "K6"), "K5": ("K7",)}


def test_a_piece_that_bears_a_force_is_shown() -> None:
    assert once(rod()).alike == {"rod_1": ("rod_2", "rod_3", "rod_4")}
    force = {"tip": {"at": "rod.right", "components": [1, 0]}}
    result = once(rod(forces=force))
    assert result.alike == {"rod_1": ("rod_2", "rod_3")}
    rows = {row.name: identity(row.v).owner for row in result.equations.rows}
    assert {rows[term.row] for term in result.equations.terms if "tip" in term.name} == {"rod_4"}


def test_damped_pieces_are_alike() -> None:
    """Damping couples each piece with all others, which makes all rows differ."""
    scene = rod()
    damped = replace(scene.bodies[0], beam=replace(scene.bodies[0].beam, damping=BeamDamping(ratio=Fraction(1, 100))))
    assert once(replace(scene, bodies=(damped,))).alike == {"rod_1": ("rod_2", "rod_3", "rod_4")}


def test_the_sections_that_constraints_name_are_defined() -> None:
    """The sections of a body that is left out are defined, unless a body that is shown has the same."""
    mechanism = derive.derive(derive.read(ROOT / "scenes" / "crank_slider_3.toml"))
    assert isinstance(mechanism, Mechanism)
    points = {str(d.symbol) for d in shown_once(mechanism).equations.definitions if identity(d.symbol).point}
    assert {"rod_1_left_s_1", "rod_1_cut_right_s_1", "rod_2_cut_left_s_1", "rod_3_right_s_1"} <= points
    assert not {"rod_2_cut_right_s_1", "rod_3_cut_left_s_1"} & points


CHAIN = (ROOT / "examples" / "chain_100.toml").read_text()


def chain(count: int, mass: str = "0.05") -> derive.Scene:
    text = CHAIN.replace("count = 100", f"count = {count}").replace("count = 99", f"count = {count - 1}")
    scene = parse(text.replace("mass = 0.05", f"mass = {mass}"))
    assert isinstance(scene, derive.Scene)
    return scene


def constraints(scene: derive.Scene) -> ConstraintsShownOnce:
    mechanism = derive.derive(scene)
    assert isinstance(mechanism, Mechanism)
    return constraints_once(mechanism.expanded().constraints, (i.name for i in mechanism.instances))


def test_constants_that_are_the_same_are_shown_once() -> None:
    result = once(chain(4))
    assert {identity(c.symbol).owner for c in result.equations.coefficients} == {"link[0]", ""}
    assert not result.values and result.equations.mass.shape == (5, 5)


def test_constants_that_differ_have_their_values() -> None:
    result = once(chain(4, '"0.05*(i + 1)"'))
    (mass,) = (symbol for symbol in result.values if identity(symbol).family is Family.MASS)
    assert {owner: float(c.value) for owner, c in result.values[mass].items()} == {
        f"link[{i}]": pytest.approx(0.05 * (i + 1)) for i in (1, 2, 3)
    }
    (few,) = value_blocks(result, notation(result.equations))
    assert isinstance(few, TableBlock) and len(few.head) == 6  # the integral, four bodies and the unit
    (many,) = value_blocks(once(chain(8, '"0.05*(i + 1)"')), notation(result.equations))
    assert isinstance(many, TableBlock)
    assert [row[0].text for row in many.rows] == [(f"link[{i}]",) for i in range(8)]


def test_joints_of_one_form_are_shown_once() -> None:
    result = constraints(chain(5))
    assert result.alike == {"weld[0]": ("weld[1]", "weld[2]", "weld[3]")}
    assert [c.of for c in result.constraints] == ["hinge", "hinge", "weld[0]", "weld[0]", "weld[0]"]


def test_a_joint_with_its_bodies_reversed_is_shown() -> None:
    """Its constraints have the opposite sign."""
    scene = chain(4)
    last = scene.joints[-1]
    reversed_joint = replace(last, first=last.second, second=last.first)
    result = constraints(replace(scene, joints=(*scene.joints[:-1], reversed_joint)))
    assert result.alike == {"weld[0]": ("weld[1]",)} and result.constraints[-1].of == "weld[2]"


def test_names_of_successive_instances_are_one_text() -> None:
    names = [*(f"link[{i}]" for i in range(1, 5)), "rod", "link[7]", "link[8]", "arm[0]"]
    assert enumeration_of_instances(names) == "link[1] to link[4], rod, link[7], link[8] and arm[0]"
    assert enumeration_of_instances(["rod"]) == "rod" and enumeration_of_instances([]) == ""
