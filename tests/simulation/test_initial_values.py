"""Initial values: what is given is kept, the rest adapts, rounding is corrected, contradictions are errors."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from compiled import Compiled, compiled

from derive.cli.main import main
from derive.errors import SpecError
from derive.simulation.compiled_scene import constraint_matrix, mass_matrix
from derive.simulation.initial.initial_state import InitialState, initial_state
from derive.spec.toml.read import parse

GROUND = "[ground.markers]\na = [0, 0]\nb = [1, 0]\n"
PINNED = """
[bodies.rod]
mass = 1
inertia = "1/12"
markers = { top = [-0.5, 0], end = [0.5, 0] }
{rod}
[joints.pin]
kind = "revolute"
between = ["ground.a", "rod.top"]
{pin}
"""


def pinned(rod: str = "", pin: str = "") -> str:
    """A rod of 1 m and 1 kg on a pin at its end."""
    return GROUND + PINNED.replace("{rod}", rod).replace("{pin}", pin)


@cache
def made(text: str) -> Compiled:
    return compiled(parse(f'name = "begin"\n{text}'))


def start(text: str) -> InitialState:
    scene = made(text)
    return initial_state(scene.scene, scene.native, scene.k)


def values(text: str) -> dict[str, tuple[float, float]]:
    """Coordinates with their rates, by name."""
    state = start(text)
    return dict(zip(made(text).native.coordinates, zip(state.q, state.v, strict=True), strict=True))


KEPT = pytest.mark.parametrize("keep", ["", "keep_coordinates = true\n"], ids=["eliminated", "kept"])


@KEPT
def test_a_spin_that_is_given_is_kept(keep: str) -> None:
    """The closest velocity in the metric of the mass would be a quarter of it."""
    found = values(pinned(f"{keep}start = {{ spin = 5 }}"))
    assert found["rod_phi"][1] == pytest.approx(5.0, rel=1e-13)
    if keep:
        assert (found["rod_c1"][1], found["rod_c2"][1]) == pytest.approx((0.0, 2.5), abs=1e-12)


@KEPT
def test_what_is_not_given_follows_from_what_is(keep: str) -> None:
    found = values(pinned(f"{keep}start = {{ position = [0.3, 0.4], velocity = [-0.8, 0.6] }}"))
    assert found["rod_phi"] == pytest.approx((np.arctan2(0.4, 0.3), 2.0), rel=1e-12)


@KEPT
def test_a_joint_begins_at_its_angle_and_speed(keep: str) -> None:
    found = values(pinned(keep, "start = { angle = 0.3, speed = -2 }"))
    assert found["rod_phi"] == pytest.approx((0.3, -2.0), rel=1e-13)


def slider(start: str) -> str:
    return (
        GROUND + "[bodies.car]\nmass = 1\ninertia = 1\nkeep_coordinates = true\nmarkers = { p = [0.2, 0] }\n"
        '[joints.rail]\nkind = "translational"\nbetween = ["ground.b", "car.p"]\naxis = [3, 4]\n' + start
    )


def test_a_translational_joint_begins_at_its_displacement_and_speed() -> None:
    found = values(slider("start = { displacement = 0.5, speed = 10 }"))
    assert (found["car_c1"], found["car_c2"]) == (
        pytest.approx((1 + 0.3 - 0.2, 6.0), rel=1e-12),
        pytest.approx((0.4, 8.0), rel=1e-12),
    )


FLEXIBLE = """
[bodies.beam]
mass = 1
length = 2
bending_stiffness = 10
ansatz = ["1", "xi", "xi^2", "xi^3", "xi^4"]
{body}
markers = { left = -1, quarter = "1/2", right = 1 }
"""


def test_a_joint_of_a_beam_begins_at_the_angle_of_the_section() -> None:
    """The section at the left end rotates against the axis by dw/dx = -2 * 0.02 / 1 m."""
    text = GROUND + FLEXIBLE.replace("{body}", 'start = { deflection = "0.02*xi^2" }')
    text += '[joints.pin]\nkind = "revolute"\nbetween = ["ground.a", "beam.left"]\nstart = { angle = 0.5 }\n'
    state, native = start(text), made(text).native
    slope = [name for name in native.coordinates if name == "beam_phi"]
    assert state.q[native.coordinates.index(slope[0])] == pytest.approx(0.5 + 0.04, rel=1e-12)


# ---- independence of the coordinates ----


CHAIN = """
[bodies.one]
mass = 2
inertia = 0.3
centre = [0.1, 0.05]
markers = { a = [-0.5, 0], b = [0.5, 0.1] }
{one}
[bodies.two]
mass = 1
inertia = 0.1
markers = { a = [-0.4, 0], b = [0.4, 0] }
{two}
[bodies.car]
mass = 3
inertia = 0.2
markers = { p = [0, 0] }
{car}
[joints.first]
kind = "revolute"
between = ["ground.a", "one.a"]
{first}
[joints.second]
kind = "revolute"
between = ["one.b", "two.a"]
[joints.rail]
kind = "translational"
between = ["ground.b", "car.p"]
axis = [1, 2]
"""
STARTS = {
    "spin and a guess": {"one": "{ angle = 0.4, spin = 2 }", "two": "{ position = [1.2, 0.9], guess = true }"},
    "a velocity": {"two": "{ position = [0.6, 0.7], velocity = [1, -0.5] }", "car": "{ velocity = [1, 2] }"},
    "a joint": {"first": "{ angle = -0.7, speed = 3 }", "car": "{ position = [1.5, 1] }"},
    "a drive": {"drive": '[drives.motor]\njoint = "first"\nspeed = 3\noffset = 0.4\n', "two": "{ angle = 0.2 }"},
    "guesses alone": {"one": "{ position = [0.5, 0.5], spin = 3, guess = true }", "car": "{ angle = 1, guess = true }"},
}  # fmt: skip


def chain(starts: dict[str, str], keep: bool) -> str:
    text = GROUND + CHAIN
    for name in ("one", "two", "car", "first"):
        lines = f"start = {starts[name]}\n" if name in starts else ""
        text = text.replace(f"{{{name}}}", lines + ("keep_coordinates = true\n" if keep and name != "first" else ""))
    return text + starts.get("drive", "")


@pytest.mark.parametrize(
    "starts",
    [
        pytest.param(starts, id=name, marks=pytest.mark.long if name in ("a joint", "guesses alone") else ())
        for name, starts in STARTS.items()
    ],
)
def test_the_state_does_not_depend_on_the_coordinates_that_are_kept(starts: dict[str, str]) -> None:
    found = []
    for keep in (False, True):
        text = chain(starts, keep)
        state, scene = start(text), made(text)
        ahead = scene.native.poses(1e-3, state.q + 1e-3 * state.v, scene.k)
        behind = scene.native.poses(-1e-3, state.q - 1e-3 * state.v, scene.k)
        found.append((scene.native.nq, scene.native.poses(0.0, state.q, scene.k), (ahead - behind) / 2e-3))
    reduced, full = found
    assert reduced[0] == (2 if "drive" in starts else 5) and full[0] == 9
    assert reduced[1] == pytest.approx(full[1], abs=1e-10)
    assert reduced[2] == pytest.approx(full[2], abs=1e-5 * max(1, np.abs(full[2]).max() ** 3))  # chords of circles


def test_what_is_not_given_moves_with_the_least_kinetic_energy() -> None:
    """Kelvin: the momentum M v is a combination of constraint reactions and of what prescribes the given velocity."""
    text = chain({"one": "{ angle = 0.4, spin = 2 }"}, keep=True)
    state, scene = start(text), made(text)
    momentum = mass_matrix(scene.native, state.q, scene.k) @ state.v
    spin = np.array([name == "one_phi" for name in scene.native.coordinates], dtype=float)
    rows = np.vstack([constraint_matrix(scene.native, 0.0, state.q, scene.k), spin])
    rest = momentum - rows.T @ np.linalg.lstsq(rows.T, momentum, rcond=None)[0]
    assert np.abs(rest).max() < 1e-12 * np.abs(momentum).max()
    assert spin @ state.v == pytest.approx(2.0, rel=1e-13)


# ---- contradictions ----


def test_rounding_is_corrected_and_told() -> None:
    """Two angles that differ by 0.1 mrad: the correction is half of that to either side."""
    state = start(pinned("start = { angle = 0.3001 }", "start = { angle = 0.3 }"))
    assert state.q == pytest.approx([0.30005], rel=1e-12)
    assert [(value.name, value.specified, value.value) for value in state.corrections] == [
        ("bodies.rod.start.angle", 0.3001, pytest.approx(0.30005, rel=1e-12)),
        ("joints.pin.start.angle", 0.3, pytest.approx(0.30005, rel=1e-12)),
    ]
    assert state.notes[0].startswith("bodies.rod.start.angle: 0.3001 rad -> 0.30005 rad")
    assert not start(pinned("start = { angle = 0.3 }", "start = { angle = 0.3 }")).notes


@pytest.mark.parametrize(("difference", "refused"), [(1.9e-3, False), (2.1e-3, True)])
def test_a_contradiction_beyond_rounding_is_an_error(difference: float, refused: bool) -> None:
    """1e-3 rad to either side is the limit; of a length, 1e-3 of the size of the scene."""
    text = pinned(f"start = {{ angle = {0.3 + difference} }}", "start = { angle = 0.3 }")
    if not refused:
        assert len(start(text).corrections) == 2
        return
    with pytest.raises(SpecError) as error:
        start(text)
    assert [problem.path for problem in error.value.problems] == ["bodies.rod.start.angle", "joints.pin.start.angle"]
    assert "0.3021 rad contradicts joints.pin.start.angle; the nearest" in str(error.value)


@pytest.mark.parametrize(("excess", "refused"), [(0.9e-3, False), (1.1e-3, True)])
def test_the_limit_of_lengths_is_a_part_of_the_size_of_the_scene(excess: float, refused: bool) -> None:
    """The markers span 1000 m, and the centre of the rod is that part too far from the pin."""
    text = pinned(f"start = {{ position = [{0.5 + 1000 * excess}, 0], angle = 0 }}").replace(
        "b = [1, 0]", "b = [1000, 0]"
    )
    if refused:
        with pytest.raises(SpecError, match=r"bodies\.rod\.start\.position: component 1: .* contradicts the joint pin"):
            start(text)
    else:
        assert start(text).corrections[0].value == pytest.approx(0.5, rel=1e-6)


@pytest.mark.parametrize(("excess", "refused"), [(2e-3, False), (5e-3, True)])
def test_velocities_that_contradict_each_other(excess: float, refused: bool) -> None:
    """The limit is 1e-3 of the largest velocity: of 5 rad/s, and of as much times the size of the scene, 1.5 m."""
    text = pinned(f"start = {{ velocity = [0, {2.5 * (1 + excess)}], spin = 5 }}")
    if refused:
        with pytest.raises(SpecError, match=r"(?s)rod\.start\.velocity: component 2.*rod\.start\.spin: 5 rad/s contra"):
            start(text)
    else:
        assert {value.name for value in start(text).corrections} == {
            "bodies.rod.start.velocity (component 2)",
            "bodies.rod.start.spin",
        }


def test_a_drive_wins_over_a_value_next_to_it_and_refuses_others() -> None:
    drive = '[drives.motor]\njoint = "pin"\nspeed = 4\noffset = 0.2\nstart = {{ angle = {} }}\n'
    bob = "[bodies.bob]\nmass = 1\ninertia = 1\nmarkers = { p = [0, 0] }\n"
    bob += '[joints.bob]\nkind = "revolute"\nbetween = ["rod.end", "bob.p"]\n'
    near, far = (pinned() + bob + drive.format(angle) for angle in (0.2003, 0.3))
    assert [(v.name, v.value) for v in start(near).corrections] == [("drives.motor.start.angle", pytest.approx(0.2))]
    with pytest.raises(SpecError, match=r"drives\.motor\.start\.angle: 0\.3 rad contradicts the drive motor"):
        start(far)


def test_contradictions_are_told_with_their_lines_and_nothing_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    spec = tmp_path / "begin.toml"
    text = pinned("start = { angle = 0.5 }", "start = { angle = 0.3 }")
    spec.write_text(f'name = "begin"\n{text}[simulation]\nduration = 1\noutput = 0.1\n')
    assert main(["simulate", str(spec), "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr()
    assert f"{spec}:10: bodies.rod.start.angle: 0.5 rad contradicts" in said.err
    assert f"{spec}:14: joints.pin.start.angle: 0.3 rad contradicts" in said.err
    assert said.out == "" and not (tmp_path / "out").exists()


# ---- first guesses ----


@pytest.mark.parametrize("side", [1, -1])
def test_a_guess_chooses_between_two_ways_of_closing(side: int) -> None:
    """Two bars of 1 m over a base of 1 m: an equilateral triangle, up or down, from values that are far off."""
    bar = "[bodies.{0}]\nmass = 1\ninertia = 1\nmarkers = {{ f = [-0.5, 0], h = [0.5, 0] }}\n"
    bar += "start = {{ angle = {1}, guess = true }}\n"
    joint = '[joints.{0}]\nkind = "revolute"\nbetween = ["{1}", "{2}"]\n'
    text = GROUND + bar.format("one", 0.6 * side) + bar.format("two", 2.5 * side)
    text += joint.format("p", "ground.a", "one.f") + joint.format("q", "ground.b", "two.f")
    text += joint.format("r", "one.h", "two.h") + "[bodies.weight]\nmass = 1\ninertia = 1\n"
    found = values(text)
    assert (found["one_phi"][0], found["two_phi"][0]) == pytest.approx((side * np.pi / 3, side * 2 * np.pi / 3))
    assert not start(text).corrections
