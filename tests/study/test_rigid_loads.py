"""Distributed loads of beams that are rigid in a model: forces at the mean points of the loads."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import derive
from derive.errors import SpecError
from derive.simulation.observables.beams import beam_bodies
from derive.spec.model.scene import Scene
from derive.spec.model.specification import AnyScene
from derive.spec.set_values import with_values
from derive.spec.toml.read import parse
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.measurement import compiled, motion
from derive.study.accuracy.models import model_scene
from derive.study.choice.written_specification import chosen_specification
from explicit_motion import moved

RIGID, POLYNOMIALS = LadderModel(Shapes.RIGID), LadderModel(Shapes.POLYNOMIALS, 2)

LOADED = """
name = "loaded"
[bodies.rod]
length = 2
mass = 3
bending_stiffness = 100
markers = { left = -1, middle = 0, right = 1 }
start = { angle = 0.5 }
[bodies.rod.loads]
wind = { force = ["1 + xi", "3*xi^2"], time = "1 + t" }
twist = { force = [0, "2*xi"], frame = "body", time = 0.5 }
[outputs]
place = { kind = "position", marker = "rod.right" }
[simulation]
duration = 0.5
output = 0.05
[plots.place]
y = ["place_2"]
"""


def loaded(time: str = '"1 + t"') -> Scene:
    scene = parse(LOADED.replace('"1 + t"', time))
    assert isinstance(scene, Scene)
    return scene


def test_a_rigid_rod_carries_its_loads() -> None:
    """Newton's law at t = 0: two forces of 2 N, and the moments of the loads about the centre, one of them a couple."""
    of = compiled(loaded(), RIGID, monitored=False)
    acceleration = of.native.accel(0.0, of.start.q, np.zeros(of.native.nv), of.k)
    wind = -np.sin(0.5) * 2 / 3  # of int x (1 + xi) dx across the axis; 3 xi^2 is symmetric
    twist = 0.5 * 4 / 3  # int xi 2 xi dx
    assert acceleration[:3] == pytest.approx([2 / 3, 2 / 3, (wind + twist) / (3 * 2**2 / 12)], rel=1e-12)


def test_a_rigid_rod_with_loads_moves_as_a_stiff_beam_does() -> None:
    """A beam that bends by 1e-6 of its length, to which first order adds nothing."""
    scene = loaded()
    (rod,) = beam_bodies(scene)
    stiff = replace(scene, bodies=(replace(rod, beam=replace(rod.beam, bending_stiffness=Fraction(10**6))),))
    runs = [motion(compiled(stiff, model, monitored=False), 1e-8)["place_2"] for model in (RIGID, POLYNOMIALS)]
    assert runs[0] == pytest.approx(runs[1], abs=2e-6) and np.ptp(runs[0]) > 0.1


def test_what_is_written_of_a_rigid_rod_has_forces_for_its_loads(tmp_path: Path) -> None:
    written = chosen_specification(LOADED, tmp_path / "a.toml", tmp_path / "b.toml", loaded(), RIGID, 1e-8)
    chosen = parse(written.text)
    assert isinstance(chosen, Scene) and "loads" not in written.text
    assert {force.name for force in chosen.forces} == {
        "rod_wind_1_1a",
        "rod_wind_1_2a",
        "rod_twist_1_2a",
        "rod_twist_1_2b",
    }
    told, direct = (moved(one, tolerance=1e-8)["place_2"] for one in (chosen, model_scene(loaded(), RIGID)))
    assert told == pytest.approx(direct, rel=1e-9)


def test_a_load_that_follows_an_input_is_not_that_of_a_rigid_rod() -> None:
    scene = parse(LOADED.replace('time = "1 + t"', 'time = { input = "gust" }') + "[inputs.gust]\nvalue = 1\n")
    assert isinstance(scene, Scene)
    with pytest.raises(
        SpecError, match="it cannot have its loads: the factor of the load wind is an input, and no force"
    ):
        model_scene(scene, RIGID)


BLADE: dict[str, object] = {"count": 2, "length": 1, "mass": 1, "bending_stiffness": 9, "markers": {"tip": 1}}


@pytest.mark.parametrize("force", [[1, 0], [1, 0, 0]], ids=["in the plane", "in space"])
def test_loads_of_beams_with_instances_have_names_as_forces_of_rigid_bodies(force: list[int]) -> None:
    """Names with brackets are those of instances, and three blades of a turbine had no rigid model."""
    loads = {"loads": {"wind": {"force": force}}}
    if len(force) == 2:
        mill: AnyScene = derive.scene("mill", bodies={"blade": BLADE | loads})
    else:
        mill = derive.spatial_scene("mill", bodies={"blade": BLADE | {"rotary_inertia": 1e-3} | loads})
    rigid, _ = with_values(model_scene(mill, RIGID), {"bodies.blade[1].mass": "2"})
    assert [force.name for force in rigid.forces] == ["blade_0_wind_1_1a", "blade_1_wind_1_1a"]
