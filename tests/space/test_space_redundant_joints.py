"""Redundant joints in space: a planar linkage of revolute joints moves as its closed form, without a switch."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import derive
from derive.pipeline import generate
from derive.simulation.constraints.closest_state import ClosestState, closest_state
from derive.simulation.errors import InextensibleBeam
from derive.simulation.prepared_run import PreparedRun
from derive.simulation.simulate import with_simulation
from derive.simulation.space import assembly
from derive.spec.toml.read import parse
from explicit_motion import moved

FOUR_BAR = """
name = "four_bar_in_space"
[scene]
gravity = [0, 0, -9.81]
[ground.markers]
a = { at = [0, 0, 0], rotation = { x = [1, 0, 0], z = [0, -1, 0] } }
d = { at = [1, 0, 0], rotation = { x = [1, 0, 0], z = [0, -1, 0] } }
[bodies.left]
mass = 1
centre = [0.5, 0, 0]
inertia = ["1/1200", "1/12", "1/12", 0, 0, 0]
markers.a = { at = [0, 0, 0], rotation = { x = [1, 0, 0], z = [0, -1, 0] } }
markers.b = { at = [1, 0, 0], rotation = { x = [1, 0, 0], z = [0, -1, 0] } }
[bodies.top]
mass = 1
centre = [0.5, 0, 0]
inertia = ["1/1200", "1/12", "1/12", 0, 0, 0]
markers.b = { at = [0, 0, 0], rotation = { x = [1, 0, 0], z = [0, -1, 0] } }
markers.c = { at = [1, 0, 0], rotation = { x = [1, 0, 0], z = [0, -1, 0] } }
start = { guess = true, position = [0.17, 0, 0.98], rotation = [1, 0, 0, 0] }
[bodies.right]
mass = 1
centre = [0.5, 0, 0]
inertia = ["1/1200", "1/12", "1/12", 0, 0, 0]
markers.d = { at = [0, 0, 0], rotation = { x = [1, 0, 0], z = [0, -1, 0] } }
markers.c = { at = [1, 0, 0], rotation = { x = [1, 0, 0], z = [0, -1, 0] } }
[joints.a]
kind = "revolute"
between = ["ground.a", "left.a"]
start = { angle = 1.4 }
[joints.b]
kind = "revolute"
between = ["left.b", "top.b"]
[joints.c]
kind = "revolute"
between = ["top.c", "right.c"]
[joints.d]
kind = "revolute"
between = ["ground.d", "right.d"]
start = { guess = true, angle = 1.4 }
[outputs.E]
kind = "energy"
[simulation]
duration = 0.4
output = 0.01
"""


def test_a_four_bar_of_revolute_joints_in_space_moves_as_its_closed_form() -> None:
    trajectory = PreparedRun(with_simulation(parse(FOUR_BAR)), complete=False).trajectory()
    assert trajectory.motion.native.nlambda == 5, "a joint of five rows on three velocities: three are redundant"
    assert trajectory.motion.native.proximal
    # three equal rods of 1 m: thetaddot = 1.2 g sin theta, from the upright
    law = solve_ivp(
        lambda t, y: [y[1], 1.2 * 9.81 * np.sin(y[0])],
        (0, trajectory.t[-1]),
        [np.pi / 2 - 1.4, 0.0],
        t_eval=trajectory.t,
        rtol=1e-11,
        atol=1e-12,
    )
    assert np.pi / 2 - trajectory["left_phi"] == pytest.approx(law.y[0], abs=1e-6)
    assert np.ptp(trajectory["E_total"]) < 1e-6 * np.ptp(trajectory["E_kinetic"])
    assert np.abs(trajectory.solution.drift).max() < 1e-9


def test_redundant_joints_may_be_refused() -> None:
    text = FOUR_BAR.replace("[scene]", '[scene]\nredundant = "error"')
    with pytest.raises(derive.TisserandError, match="redundant"):
        moved(parse(text))


def test_a_turned_four_bar_follows_its_drive() -> None:
    """The rotation rows of a driven parallelogram about a slanting axis are zero but for rounding, at any time."""
    turn = Rotation.from_rotvec(1.1 * np.array([1, 2, -3]) / np.sqrt(14))

    def turned(x: list[float]) -> list[float]:
        return [float(c) for c in turn.apply(x)]

    text = FOUR_BAR.replace("start = { angle = 1.4 }\n", "").replace(
        "[outputs.E]", '[drives.motor]\njoint = "a"\nmotion = "1.4 + t"\n[outputs.E]'
    )
    axes = "rotation = { x = [1, 0, 0], z = [0, -1, 0] } }"
    for name, x in (("a", 0), ("d", 1)):
        new = f"at = {turned([x, 0, 0])}, rotation = {{ x = {turned([1, 0, 0])}, z = {turned([0, -1, 0])} }} }}"
        text = text.replace(f"{name} = {{ at = [{x}, 0, 0], {axes}", f"{name} = {{ {new}", 1)
    guess = f"position = {turned([0.17, 0, 0.98])}, rotation = {turn.as_quat(scalar_first=True).tolist()}"
    scene = parse(text.replace("position = [0.17, 0, 0.98], rotation = [1, 0, 0, 0]", guess))
    model = generate(scene, backends=()).model
    assert model.proximal and model.start is not None
    right, top = (model.start.q[[c.name for c in model.coordinates].index(f"{name}_phi")] for name in ("right", "top"))
    assert right == pytest.approx(1.4, abs=1e-14) and np.cos(top + 1.4) == pytest.approx(1, abs=1e-14)
    assert model.start.v == pytest.approx([-1, 1], abs=1e-14)


DOOR = """
name = "door"
[scene]
gravity = [0, 1.4, -9.81]
[ground.markers]
lower = { at = [0.22, -0.318, 0.171], rotation = { axis = [1, 2, -3], angle = 1.1 } }
upper = { at = UPPER, rotation = { axis = [1, 2, -3], angle = 1.1 } }
[bodies.door]
mass = 0.8
centre = [0.3, 0.1, 0.05]
inertia = [0.02, 0.03, 0.025, 0, 0.001, 0]
markers = { lower = [0, 0, 0], upper = [0, 0, 0.7] }
[joints.hinge]
kind = "revolute"
between = ["ground.lower", "door.lower"]
start = { angle = 0.3 }
SECOND
[simulation]
duration = 0.4
output = 0.1
"""


def two_hinges(kind: str) -> tuple[str, str]:
    """A door on one hinge, and on a second one that continues it up to rounding errors."""
    axis = Rotation.from_rotvec(1.1 * np.array([1, 2, -3]) / np.sqrt(14)).as_matrix()[:, 2]
    text = DOOR.replace("UPPER", str((np.array([0.22, -0.318, 0.171]) + 0.7 * axis).tolist()))
    second = f'[joints.other]\nkind = "{kind}"\nbetween = ["ground.upper", "door.upper"]'
    return text.replace("SECOND", ""), text.replace("SECOND", second)


@pytest.mark.parametrize("kind", ["revolute", "point_on_line"])
def test_a_door_on_two_hinges_turns_as_on_one(kind: str) -> None:
    """The first hinge leaves an angle, whose factors in the second one are zero but for rounding errors."""
    one, two = (moved(parse(text)) for text in two_hinges(kind))
    assert np.ptp(one["door_phi"]) > 0.3
    assert np.allclose(two["door_phi"], one["door_phi"], rtol=0, atol=1e-8)
    (note,) = (note for note in two.notes if "redundant" in note)
    assert "other_x is implied by joints that eliminate coordinates" in note


def test_a_door_on_two_hinges_turns_on_without_gravity() -> None:
    """All that the second hinge demands of accelerations are rounding errors, and there are no forces beside them."""
    text = two_hinges("revolute")[1].replace("gravity = [0, 1.4, -9.81]", "").replace("angle = 0.3", "speed = 2")
    run = PreparedRun(parse(text), complete=False).trajectory()
    assert run["door_phi"] == pytest.approx(2 * run.t, abs=1e-9)


DRIVEN_DOOR = """
name = "door"
[ground.markers]
a = { at = [0.1, -0.2, 0.3], rotation = { axis = [1, 2, 3], angle = 0.7 } }
b = { at = [0.2973698990869, -0.235696249708938, 0.758007533443659], rotation = { axis = [1, 2, 3], angle = 0.7 } }
[bodies.door.markers]
a = { at = [0.1, 0.2, 0], rotation = { axis = [1, 1, 0], angle = 0.4 } }
b = { at = [0.23768017528244, 0.06231982471756, 0.46053049700144], rotation = { axis = [1, 1, ASKEW], angle = 0.4 } }
[bodies.loose]
mass = 1
inertia = [1, 1, 1, 0, 0, 0]
[joints.first]
kind = "revolute"
between = ["ground.a", "door.a"]
[joints.second]
kind = "revolute"
between = ["ground.b", "door.b"]
[drives.motor]
joint = "first"
motion = "MOTION"
"""
HANGING = """
[scene]
gravity = [0, 0, -9.81]
[bodies.bob]
mass = 1
inertia = [1, 1, 1, 0, 0, 0]
markers = { top = [0, 0.2, 0.1] }
[joints.ball]
kind = "spherical"
between = ["door.b", "bob.top"]
[simulation]
duration = 0.02
output = 0.01
"""
MOTIONS = (
    "0.1*(exp(-2*t) - 1)",
    "tanh(t) + log(1 + t^2) + abs(t) + min(t, 1) + max(t, 2) + atan2(t, 2)",
    "step(t, 0, 1) + exp(-t)",
)


def test_a_drive_that_was_beyond_all_numbers_long_before() -> None:
    """Its joint is met in every state; what is sought is a time at which it is not, and e^1000 is none."""
    run = PreparedRun(
        parse(f"{DRIVEN_DOOR.replace('ASKEW', '0').replace('MOTION', MOTIONS[0])}{HANGING}"), complete=False
    )
    assert np.isfinite(run.trajectory()["bob_e0"]).all()


def test_a_driven_door_whose_second_hinge_is_off_by_rounding_errors_without_gravity() -> None:
    """The errors turn with the door, so that they have accelerations."""
    door = (
        DRIVEN_DOOR.replace("ASKEW", "0").replace("MOTION", "0.2 + 0.5*t").replace("0.2973698990869", "0.29736989909")
    )
    run = PreparedRun(parse(door + HANGING.replace("gravity = [0, 0, -9.81]\n", "")), complete=False).trajectory()
    assert np.abs(run.solution.drift[:, 0]).max() < 1e-11


@pytest.mark.parametrize("motion", MOTIONS)
def test_a_joint_that_a_driven_one_implies(motion: str) -> None:
    """By any function of time; a joint about another axis is met by none."""
    door = DRIVEN_DOOR.replace("MOTION", motion)
    assert derive.lower(derive.derive(parse(door.replace("ASKEW", "0"))), explicit=True).kernels
    with pytest.raises(derive.SpecError, match="no coordinate can meet it"):
        derive.lower(derive.derive(parse(door.replace("ASKEW", "0.1"))), explicit=True)


def clamped(tables: str) -> derive.Trajectory:
    """The motion of a beam that is clamped at both ends."""
    rod = f"""
name = "clamped"
[ground.markers]
a = [0, 0, 0]
b = [1, 0, 0]
[bodies.rod]
length = 1
mass = 1
bending_stiffness = 20
rotary_inertia = 1e-4
ansatz = ["1", "xi", "xi^2", "xi^3", "xi^4", "xi^5"]
markers = {{ l = -1, r = 1 }}
{tables}
[joints.l]
kind = "fixed"
between = ["ground.a", "rod.l"]
[joints.r]
kind = "fixed"
between = ["ground.b", "rod.r"]
[simulation]
duration = 0.01
output = 0.01
"""
    return PreparedRun(with_simulation(parse(rod)), complete=False).trajectory()


def test_a_beam_that_is_clamped_at_both_ends_needs_the_table_that_the_message_names() -> None:
    axial = 'axial = { ansatz = ["xi"], stiffness = 1e5 }'
    torsion = 'torsion = { ansatz = ["xi"], stiffness = 5 }'
    only = "only with the tables axial and torsion, so that"
    with pytest.raises(InextensibleBeam, match=f"{only} l_x and r_x have no .*Give a beam the table that it lacks"):
        clamped(torsion)
    assert clamped(f"{axial}\n{torsion}").t[-1] == 0.01


def test_a_run_that_stops_where_joints_hold_a_beam_along_its_axis_is_at_no_dead_centre(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The chord between the joints is as long as the beam, which one of them bends: it would have to stretch.

    Its bent start is found in few iterations: before, steps towards the guess took more than 500.
    """
    iterations = itertools.count()

    def closest(*arguments: Any) -> ClosestState:
        assert next(iterations) < 100
        return closest_state(*arguments)

    monkeypatch.setattr(assembly, "closest_state", closest)
    rod: dict[str, Any] = {"length": 0.5, "mass": 0.3, "rotary_inertia": 4e-6, "bending_stiffness": 30}
    rod |= {"torsion": {"ansatz": ["xi"], "stiffness": 20}, "markers": {"left": -1, "right": 1}}
    turned = {"axis": [0, 1, 0], "angle": -0.6}
    scene = derive.spatial_scene(
        "bent",
        ground={"left": (0, 0, 0), "right": (0.4, 0, 0.3)},
        bodies={"rod": rod | {"start": {"guess": True, "position": [0.2, 0.05, 0.15], "rotation": turned}}},
        joints={
            "left": {"kind": "universal", "between": ["ground.left", "rod.left"]},
            "right": {"kind": "spherical", "between": ["ground.right", "rod.right"]},
        },
        simulation={"duration": 1e-3, "output": 1e-3},
    )
    with pytest.raises(InextensibleBeam, match=r"left_x, left_z, right_x and right_z have no .*Give a beam the table"):
        derive.simulate(scene)
