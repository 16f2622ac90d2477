"""Gears and screws in space: generated code against the oracle, in minimal coordinates and as constraints."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from space_kernels import disagreements, space_model

from derive.derivation import derive
from derive.errors import SpecError
from derive.model_lowering import lower
from derive.simulation.prepared_run import PreparedRun
from derive.simulation.trajectory import Trajectory
from derive.spec.as_tables import specification_tables
from derive.spec.construction.scenes import spatial_scene
from derive.spec.toml.read import parse

SCENE = """
name = "space_gears"
[scene]
gravity = [0.3, 0.5, -9.81]
[ground.markers]
a = { at = [0.1, 0, 0], rotation = { angles = [0.2, 0.5, -0.1], sequence = "xyz" } }
b = { at = [0.5, 0.2, 0.1], rotation = { axis = [1, 1, 0], angle = 0.3 } }
[bodies.wheel]
mass = 1.2
centre = [0.2, 0.01, 0]
inertia = [1e-2, 4e-2, 4e-2, 1e-3, 0, 2e-3]
markers = { hub = { at = [0, 0.02, 0], rotation = { angles = [0.4, 0, 0.3], sequence = "zxz" } } }
WHEEL
[bodies.pinion]
mass = 0.5
centre = [0.01, 0.02, 0.03]
inertia = [1e-2, 2e-2, 2.5e-2, 1e-3, 0, -2e-3]
markers = { hub = [0.1, 0, 0] }
PINION
[joints.first]
kind = "FIRST"
between = ["ground.a", "wheel.hub"]
MOVED
[joints.second]
kind = "SECOND"
between = ["pinion.hub", "ground.b"]
[gears.mesh]
joints = ["first", "second"]
ratio = "RATIO"
[simulation]
duration = 0.6
output = 0.01
tolerance = 1e-10
"""
OUTPUTS = """
[outputs.E]
kind = "energy"
[outputs.one]
kind = "joint"
joint = "first"
[outputs.two]
kind = "joint"
joint = "second"
[outputs.R]
kind = "reaction"
joint = "first"
[outputs.S]
kind = "reaction"
joint = "second"
[outputs.tip]
kind = "position"
marker = "pinion.hub"
"""
KEEP = "keep_coordinates = true"
PITCH = "pitch = -0.05"


def text(
    first: str = "revolute", second: str = "revolute", ratio: str = "-3/2", keep: str = "", start: str = ""
) -> str:
    """The scene with these kinds of joints; the bodies whose names `keep` contains keep their own coordinates."""
    moved = f"start = {{ {start or 'speed = 12'} }}"
    result = SCENE.replace("WHEEL", KEEP if "wheel" in keep else "").replace("PINION", KEEP if "pinion" in keep else "")
    for kind, place in ((first, "FIRST"), (second, "SECOND")):
        result = result.replace(f'"{place}"', f'"{kind}"' + (f"\n{PITCH}" if kind == "screw" else ""))
    return result.replace("RATIO", ratio).replace("MOVED", moved)


@cache
def run(of: str) -> Trajectory:
    return PreparedRun(parse(of + OUTPUTS), complete=False).trajectory()


ARM = """
[bodies.arm]
mass = 0.4
inertia = [1e-2, 2e-2, 2.5e-2, 0, 0, 0]
markers = { root = { at = [-0.1, 0, 0.05], rotation = { axis = [1, 2, 0], angle = 0.5 } } }
[joints.shoulder]
kind = "revolute"
between = ["wheel.hub", "arm.root"]
"""
"""A body on the wheel, whose rotation is eliminated relative to the wheel's: the gear has to leave this one."""
CASES = {
    "coordinates": (text(), 1),
    "a coordinate and a rotation": (text(keep="pinion"), 6),
    "a rotation and a coordinate": (text(keep="wheel", ratio="1.37"), 6),
    "a wheel that carries an arm": (text(keep="pinion") + ARM, 6),
    "two rotations": (text(keep="wheel pinion"), 11),
    "rack and pinion": (text(second="prismatic", ratio="0.07", keep="wheel"), 6),
    "pinion and rack": (text(first="prismatic", ratio="-14.5", keep="pinion", start="speed = 1"), 6),
    "screws": (text("screw", "screw"), 1),
    "screws that keep coordinates": (text("screw", "screw", keep="wheel pinion"), 11),
    "cylindrical and planar": (text("cylindrical", "planar", keep="pinion", start="guess = true"), 4),
    "two rotations of planar joints": (text("planar", "planar", keep="wheel pinion", start="guess = true"), 7),
}


SIMILAR = (
    "coordinates",
    "screws",
    "a rotation and a coordinate",
    "pinion and rack",
    "screws that keep coordinates",
    "two rotations of planar joints",
)
"""Cases with nothing that the others have not, in another order, or that runs below cover."""


@pytest.mark.parametrize(
    "case", [pytest.param(case, marks=pytest.mark.long if case in SIMILAR else ()) for case in CASES]
)
def test_generated_code_is_that_of_the_oracle(case: str, tmp_path: Path) -> None:
    of, constraints = CASES[case]
    path = tmp_path / "scene.toml"
    path.write_text(of)
    model = space_model(path, complete=case == "a coordinate and a rotation")
    assert model.native.nlambda == constraints
    assert disagreements(model, 1) == [] and disagreements(model, 2) == []


@pytest.mark.parametrize(
    "case", ["cylindrical and planar", *(pytest.param(c, marks=pytest.mark.long) for c in ("two rotations", "screws"))]
)
def test_loops_over_bodies_are_those_of_the_oracle(case: str, tmp_path: Path) -> None:
    """Explicit functions in C, of two rotations all of them and the Python as well."""
    of, _ = CASES[case]
    path = tmp_path / "scene.toml"
    path.write_text(of.replace("[scene]", '[scene]\nlowering = "instances"'))
    model = space_model(path, complete=case == "two rotations")
    assert disagreements(model, 1) == [] and disagreements(model, 2) == []


SAME = (
    "tip_1",
    "tip_2",
    "tip_3",
    *(f"{joint}_{k}" for joint in "RS" for k in (1, 2, 3, "torque1", "torque2", "torque3")),
)


@pytest.mark.parametrize("keep", ["pinion", pytest.param("wheel pinion", marks=pytest.mark.long)])
@pytest.mark.parametrize(
    "kinds", [("screw", "prismatic"), pytest.param(("revolute", "revolute"), marks=pytest.mark.long)]
)
def test_minimal_coordinates_and_constraints_are_one_motion(kinds: tuple[str, str], keep: str) -> None:
    """With the reactions of the joints; the wheel turns more than once."""
    ratio = "-3/2" if kinds[1] == "revolute" else "0.01"
    minimal, kept = run(text(*kinds, ratio)), run(text(*kinds, ratio, keep=keep))
    assert minimal["one"][-1] > 2 * np.pi
    assert minimal["two"] == pytest.approx(float(eval(ratio)) * minimal["one"], abs=1e-12)
    assert kept.motion.native.nlambda > minimal.motion.native.nlambda == 1
    for name in SAME:
        assert minimal[name] == pytest.approx(kept[name], abs=3e-6 * max(1.0, np.abs(kept[name]).max())), name
    for trajectory in (minimal, kept):
        assert np.ptp(trajectory["E_total"]) < 1e-7 * np.ptp(trajectory["E_kinetic"])


def test_a_ratio_that_is_a_parameter_is_written_back() -> None:
    """It has no unit, and none is written."""
    scene = parse(text().replace('"-3/2"', '{ symbol = "r", default = 2.0 }'))
    assert spatial_scene(specification_tables(scene)) == scene


PLANETS = """
name = "planets"
[scene]
gravity = [0, 0, -9.81]
[ground.markers]
o = { at = [0, 0, 0], rotation = { axis = [0, 1, 0], angle = 0.4 } }
[bodies.carrier]
mass = 1
inertia = [0.02, 0.02, 0.03, 0, 0, 0]
markers = { hub = [0, 0, 0], pin = { at = [0.3, 0, 0], rotation = { axis = [0, 0, 1], angle = 0.7 } } }
[bodies.sun]
mass = 1
inertia = [0.01, 0.01, 0.015, 0, 0, 0]
markers = { hub = [0, 0, 0] }
keep_coordinates = true
[bodies.planet]
mass = 0.5
inertia = [0.002, 0.002, 0.004, 0, 0, 0]
markers = { hub = [0, 0, 0] }
[joints.bearing]
kind = "revolute"
between = ["ground.o", "carrier.hub"]
start = { speed = 3 }
[joints.sun]
kind = "revolute"
between = ["carrier.hub", "sun.hub"]
start = { angle = 0.3, speed = -20 }
[joints.planet]
kind = "revolute"
between = ["carrier.pin", "planet.hub"]
[gears.mesh]
joints = ["sun", "planet"]
ratio = "-21/10"
[outputs.E]
kind = "energy"
[outputs.sun]
kind = "angular_velocity"
marker = "sun.hub"
[outputs.planet]
kind = "angular_velocity"
marker = "planet.hub"
[outputs.carrier]
kind = "angular_velocity"
marker = "carrier.hub"
[outputs.phi]
kind = "joint"
joint = "sun"
[outputs.psi]
kind = "joint"
joint = "planet"
[simulation]
duration = 1
output = 0.01
tolerance = 1e-9
"""


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('joints = ["sun", "planet"]', 'joints = ["sun", "sun"]', "these are the same"),
        ('joints = ["sun", "planet"]', 'joints = ["sun", "planets"]', 'no joint "planets"; did you mean "planet"'),
        ('ratio = "-21/10"', "ratio = 0", "a number is needed that is not zero"),
        ('ratio = "-21/10"', "", "ratio"),
        ('ratio = "-21/10"', 'ratio = "-21/10"\noffsets = 1', 'did you mean "offset"'),
        ('"revolute"\nbetween = ["carrier.pin"', '"spherical"\nbetween = ["carrier.pin"', "which a gear could couple"),
        ('[gears.mesh]', '[gears.a]\njoints = ["planet", "sun"]\nratio = 1\n[gears.mesh]', "leave one of the gears"),
        ('[gears.mesh]', '[gears.sun_x]', "is taken"),
        ('joint = "planet"\n[sim', 'joint = "moon"\n[sim', 'no joint "moon"'),
    ],
)  # fmt: skip
def test_faults_of_gears(old: str, new: str, message: str) -> None:
    assert old in PLANETS
    with pytest.raises(SpecError, match=message):
        parse(PLANETS.replace(old, new))


ABSOLUTE = '[scene]\ncoordinates = "absolute"'


def test_two_rotations_that_count_no_turns_need_numbers_of_teeth() -> None:
    for ratio in ('"-100003/10"', '{ symbol = "r", default = -2.1 }'):
        with pytest.raises(SpecError, match=r"gears\.mesh\.ratio.*numbers of teeth"):
            lower(derive(parse(PLANETS.replace('"-21/10"', ratio).replace("[scene]", ABSOLUTE))))


def test_ratios_and_pitches_are_parameters() -> None:
    of = text("screw", "revolute").replace(PITCH, 'pitch = { symbol = "p", default = -0.05 }')
    of = of.replace('"-3/2"', '{ symbol = "r", default = -1.5 }')
    numbers, symbols = run(text("screw", "revolute")), run(of)
    assert symbols["tip_3"] == pytest.approx(numbers["tip_3"], abs=1e-12)
    assert set(symbols.motion.native.parameters) == {"p", "r"}
