"""Bodies that are alike are shown once; what one of them alone bears is shown for this one."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import derive
from conftest import ROOT
from derive.mechanics.multibody.mechanism import Mechanism
from derive.mechanics.symbols import identity
from derive.report.sections.alike_bodies import EquationsShownOnce, shown_once
from derive.spec.model.beam_parts import BeamDamping


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
