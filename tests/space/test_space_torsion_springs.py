"""Rotational springs of joints over several turns, and those that cannot count turns."""

from __future__ import annotations

import re

import numpy as np
import pytest
from space_kernels import disagreements, space_model

from derive.simulation.prepared_run import PreparedRun
from derive.simulation.space.half_turns import HalfTurn
from derive.spec.toml.read import parse

WHEEL = """
name = "wheel"
[ground.markers]
o = { at = [0.1, 0, 0], rotation = { angles = [0.2, 0.5, -0.1], sequence = "xyz" } }
[bodies.wheel]
mass = 2
inertia = [0.3, 0.3, 0.5, 0, 0, 0]
markers = { hub = [0, 0, 0] }
KEEP
[joints.axle]
KIND
between = ["ground.o", "wheel.hub"]
START
[springs.coil]
kind = "rotational"
between = BETWEEN
stiffness = 2
damping = DAMPING
rest = REST
[outputs.E]
kind = "energy"
[outputs.P]
kind = "power"
[simulation]
duration = 1.5
output = 0.05
tolerance = 1e-11
"""
FORWARDS, BACKWARDS = '["ground.o", "wheel.hub"]', '["wheel.hub", "ground.o"]'
PITCH = 0.8


def wheel(kind: str = "revolute", between: str = FORWARDS, keep: bool = False, start: float = 5.0, **more: str) -> str:
    values = {"DAMPING": "0", "REST": "0", **more}
    kind = f'kind = "{kind}"' + (f"\npitch = {PITCH}" if kind == "screw" else "")
    text = WHEEL.replace("BETWEEN", between).replace("KIND", kind)
    text = text.replace("START", f"start = {{ angle = {start}, speed = 0 }}")
    for name, value in values.items():
        text = text.replace(name, value)
    return text.replace("KEEP", "keep_coordinates = true" if keep else "")


@pytest.mark.parametrize(("between", "sign"), [(FORWARDS, 1), (BACKWARDS, -1)])
def test_a_coil_counts_the_turns_of_its_joint(between: str, sign: int) -> None:
    """From 5 rad, beyond half a turn, it swings with k and J about its rest, which is beyond a turn."""
    run = PreparedRun(parse(wheel(between=between, REST="7.5")), complete=False).trajectory()
    rest = 7.5 * sign
    expected = rest + (5.0 - rest) * np.cos(np.sqrt(2 / 0.5) * run.t)
    assert run["wheel_phi"] == pytest.approx(expected, abs=1e-8)
    assert run["E_total"] == pytest.approx(2 * (5.0 - rest) ** 2 / 2, rel=1e-8)


def test_its_damper_takes_what_the_energy_loses() -> None:
    run = PreparedRun(parse(wheel(DAMPING="0.3")), complete=False).trajectory()
    assert run["P_dissipated"] == pytest.approx(-0.3 * run["wheel_phidot"] ** 2, abs=1e-12)
    b, w = 0.3 / 2 / 0.5, 2 / 0.5
    d = np.sqrt(w - b * b)
    expected = 5.0 * np.exp(-b * run.t) * (np.cos(d * run.t) + b / d * np.sin(d * run.t))
    assert run["wheel_phi"] == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize("keep", [False, True])
def test_a_thread_counts_turns_by_its_displacement(keep: bool) -> None:
    """Also where it is a constraint of bodies that keep their coordinates."""
    lead = PITCH / (2 * np.pi)
    text = wheel("screw", keep=keep)
    if keep:  # the displacement counts the turns at the start
        text = text.replace("start = { angle = 5.0, speed = 0 }", "")
        start = 'rotation = { angles = [0, 0, 5.0], sequence = "xyz" }, velocity = [0, 0, 0]'
        text = text.replace('rotation = { angles = [0.2, 0.5, -0.1], sequence = "xyz" } ', "rotation = [1, 0, 0, 0] ")
        text = text.replace(
            "keep_coordinates = true",
            f"keep_coordinates = true\nstart = {{ position = [0.1, 0, {5.0 * lead}], {start} }}",
        )
    run = PreparedRun(
        parse(text + '[outputs.z]\nkind = "position"\nmarker = "wheel.hub"\n'), complete=False
    ).trajectory()
    assert run.motion.native.nlambda == (5 if keep else 0)
    turned = 5.0 * np.cos(np.sqrt(2 / (0.5 + 2 * lead**2)) * run.t)
    if keep:
        assert run["z_3"] == pytest.approx(lead * turned, abs=1e-7)
    else:
        assert run["wheel_phi"] == pytest.approx(turned, abs=1e-7)


def test_beyond_half_a_turn_nothing_is_made_up() -> None:
    """A body that keeps its coordinates does not count turns: it turns freely up to pi, and then there is an error."""
    text = wheel(keep=True, start=3.0, REST="4").replace("speed = 0", "speed = 1")
    w = np.sqrt(2 / 0.5)
    reached = next(t for t in np.arange(0, 1.5, 0.05) if 4 - np.cos(w * t) + np.sin(w * t) / w > np.pi)
    with pytest.raises(HalfTurn, match=f"springs.coil: by t = {re.escape(f'{reached:g}')} s its markers turn by more"):
        PreparedRun(parse(text), complete=False).trajectory()


def test_a_start_beyond_half_a_turn_is_not_another_angle() -> None:
    text = wheel(keep=True, start=5.0)
    with pytest.raises(HalfTurn, match=r"springs.coil: at the start, by 5 rad, its markers turn by more than half a"):
        PreparedRun(parse(text), complete=False).trajectory()


@pytest.mark.parametrize(("between", "sign"), [(FORWARDS, 1), (BACKWARDS, -1)])
def test_a_drive_counts_turns_of_bodies_that_keep_their_coordinates(between: str, sign: int) -> None:
    """From the second to the fourth turn; the stiffness, the rest and the potential are those of all of them."""
    drive = '[drives.motor]\njoint = "axle"\nmotion = "8 + 12*t"\n'
    text = wheel(between=between, keep=True, REST="1.5").replace("start = { angle = 5.0, speed = 0 }", "")
    text += f'[outputs.M]\nkind = "drive"\ndrive = "motor"\n{drive}'
    run = PreparedRun(parse(text), complete=False).trajectory()
    assert run.motion.native.nlambda == 6
    turned = sign * (8 + 12 * run.t)
    assert run["M"] == pytest.approx(sign * 2 * (turned - 1.5), rel=1e-9)
    assert run["E_strain"] == pytest.approx((turned - 1.5) ** 2, rel=1e-9)


def test_below_half_a_turn_and_across_zero_it_runs_in_coarse_rows() -> None:
    """Between two rows it turns by more than pi, from one side to the other, without passing pi; a note says so."""
    text = wheel(keep=True, start=2.9).replace("output = 0.05", "output = 1.5")
    run = PreparedRun(parse(text), complete=False).trajectory()
    assert len(run.t) == 2 and run["E_total"][1] == pytest.approx(run["E_total"][0], rel=1e-8)
    assert "springs.coil: nothing counts the turns of its markers, and rows" in "".join(run.notes)
    fine = PreparedRun(parse(wheel(keep=True, start=2.9)), complete=False).trajectory()
    assert "springs.coil" not in "".join(fine.notes)


@pytest.mark.parametrize("kind", ["revolute", "cylindrical", "screw", "planar", "driven"])
def test_kernels_agree_with_the_oracle(kind: str, tmp_path) -> None:  # type: ignore[no-untyped-def]
    path, drive = tmp_path / "scene.toml", '[drives.motor]\njoint = "axle"\nmotion = "8 + 12*t"\n'
    keep, driven = kind in ("screw", "driven"), kind == "driven"
    text = wheel("revolute" if driven else kind, BACKWARDS, keep=keep, DAMPING="0.3", REST="1").replace("start =", "#")
    text += drive if driven else ""
    path.write_text(text)
    assert disagreements(space_model(path, complete=False), 3) == []
