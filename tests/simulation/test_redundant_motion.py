"""Mechanisms whose constraints depend on each other: their motion is that without the dependent ones."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import derive
from derive.lowering.flat.lower import lower as lower_flat
from derive.lowering.instances.lower import lower_instances
from derive.runtime.interpreted_scene import InterpretedScene
from derive.simulation.compiled_scene import constraint_matrix, mass_matrix
from derive.simulation.errors import InextensibleBeam, SimulationError
from derive.simulation.prepared_run import PreparedRun
from derive.simulation.trajectory import Trajectory
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse

FOUR_BARS = (Path(__file__).parents[2] / "examples" / "four_bars.toml").read_text()
G = 9.81


def simulated(scene: Scene, integrator: str = "adaptive") -> Trajectory:
    """The motion, with the functions alone that explicit methods need."""
    return PreparedRun(scene, integrator, complete=False).trajectory()


def parsed(text: str) -> Scene:
    scene = parse(text)
    assert isinstance(scene, Scene)
    return scene


def energy(motion: Trajectory) -> np.ndarray:
    """The sum of all energies in each row, J."""
    native = motion.motion.native
    k = native.setup()
    return np.array([native.energy(q, v, k).sum() for q, v in zip(motion.q, motion.v, strict=True)])


ARM = """name = "arm"
[scene]
gravity = [0, -9.81]
[ground.markers]
o = [0, 0]
[bodies.arm]
mass = 1
inertia = 0.1
keep_coordinates = true
markers = { left = [-0.5, 0], right = [0.5, 0] }
start = { position = [0.5, 0] }
[bodies.rod]
ansatz = ["1", "xi", "xi^2"]
length = 1
mass = 1
bending_stiffness = 10
markers = { left = -1, right = 1 }
start = { position = [1.5, 0] }
[joints.bearing]
kind = "revolute"
between = ["ground.o", "arm.left"]
[joints.pin]
kind = "revolute"
between = ["arm.right", "rod.left"]
[outputs.at_pin]
kind = "reaction"
joint = "pin"
[outputs.at_bearing]
kind = "reaction"
joint = "bearing"
[simulation]
duration = 0.5
output = 0.05
"""
TWIN = '[joints.twin]\nkind = "revolute"\nbetween = ["arm.right", "rod.left"]\n'


def test_a_joint_that_is_there_twice_changes_nothing_but_its_reaction() -> None:
    """Each of the two carries half, and the run names them with the outputs that show their reactions."""
    one, two = simulated(parsed(ARM)), simulated(parsed(ARM + TWIN))
    assert two.q == pytest.approx(one.q, abs=1e-11) and two.v == pytest.approx(one.v, abs=1e-10)
    assert np.ptp(energy(two)) < 1e-6
    half = one.lam[:, 2:] / 2
    assert np.hstack([half, half]) == pytest.approx(two.lam[:, 2:], abs=1e-5 * np.abs(half).max())
    (note,) = (note for note in two.solution.notes if "redundant" in note)
    assert "twin_1 is implied by pin_1; twin_2 is implied by pin_2" in note
    assert "outputs at_pin_1 and at_pin_2 follow" in note and "at_bearing" not in note
    assert not any("redundant" in note for note in one.solution.notes)


def test_generalised_alpha_moves_a_joint_that_is_there_twice() -> None:
    """Step by step as the joint that is there once, by a proximal term in the iteration matrix."""
    one, two = (simulated(parsed(text), "generalised-alpha") for text in (ARM, ARM + TWIN))
    assert two.q == pytest.approx(one.q, abs=1e-10) and two.v == pytest.approx(one.v, abs=1e-8)
    assert np.hstack([one.lam[:, 2:] / 2] * 2) == pytest.approx(two.lam[:, 2:], abs=1e-5 * np.abs(one.lam).max())
    assert any("twin_1 is implied by pin_1" in note for note in two.solution.notes)


def test_generalised_alpha_passes_the_positions_in_which_all_rods_are_in_line() -> None:
    scene = four_bars(2)
    motion = simulated(scene, "generalised-alpha")
    assert motion["crank[1]_phi"] == pytest.approx(pendulum(2, motion.t, -1.0, 0.0), abs=2e-3)


@pytest.mark.parametrize("ida", ["ida", "c_ida"])
def test_ida_moves_a_joint_that_is_there_twice(ida: str) -> None:
    """By a proximal term in its iteration matrix."""
    beam = (
        'ansatz = ["1", "xi", "xi^2"]\n'
        + "length = 1\nmass = 1\nbending_stiffness = 10\nmarkers = { left = -1, right = 1 }"
    )
    assert beam in ARM
    rigid = ARM.replace(beam, 'mass = 1\ninertia = "1/12"\nmarkers = { left = [-0.5, 0], right = [0.5, 0] }')
    two, other = (simulated(parsed(rigid + TWIN), integrator) for integrator in (ida, "adaptive"))
    assert two.q == pytest.approx(other.q, abs=1e-7) and two.v == pytest.approx(other.v, abs=1e-6)
    assert two.lam == pytest.approx(other.lam, abs=1e-4 * np.abs(other.lam).max())
    assert two.solution.cost.steps < 1000
    assert any("twin_1 is implied by pin_1" in note for note in two.solution.notes)


@pytest.mark.long
@pytest.mark.parametrize("ida", ["ida", "c_ida"])
def test_ida_refuses_to_start_in_a_singular_position(ida: str) -> None:
    scene = four_bars(2, *IN_LINE, ("angle = -1.5707963267948966", "angle = -1.5707963267948966, spin = -4"))
    with pytest.raises(SimulationError, match=r"singular position(.|\n)*choose one of adaptive, dop853, gen"):
        simulated(scene, ida)


@pytest.mark.parametrize("integrator", ["adaptive", pytest.param("generalised-alpha", marks=pytest.mark.long)])
def test_a_joint_that_no_coordinate_can_meet_has_no_reaction(integrator: str) -> None:
    """The bearing leaves the arm its rotation alone."""
    text = ARM.replace("keep_coordinates = true\n", "")
    again = '[joints.again]\nkind = "revolute"\nbetween = ["ground.o", "arm.left"]\n'
    one, two = (simulated(parsed(of), integrator) for of in (text, text + again))
    assert two.q == pytest.approx(one.q, abs=1e-11)
    assert two.lam[:, -2:] == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("lower", [lower_flat, lower_instances])
def test_multipliers_have_the_least_norm(lower: object) -> None:
    """In the scaling of the diagonal of G M^-1 G^T; accelerations and projections are exact."""
    mechanism = derive.derive(parsed(ARM + TWIN))
    of = mechanism if lower is lower_instances else mechanism.expanded()
    native = InterpretedScene(lower(of, proximal=True))  # type: ignore[operator]
    k, random = native.setup(), np.random.default_rng(0)
    q, v = random.uniform(-1, 1, native.nq), random.uniform(-1, 1, native.nv)
    M, J = mass_matrix(native, q, k), constraint_matrix(native, 0.0, q, k)
    S = J @ np.linalg.solve(M, J.T)
    scale = np.sqrt(np.diag(S))
    right = native.constraint_bias(0.0, q, v, k) + J @ np.linalg.solve(M, native.force(0.0, q, v, k))
    lam = np.linalg.lstsq(S / np.outer(scale, scale), right / scale, rcond=1e-10)[0] / scale
    vdot, found = native.solve(0.0, q, v, k)
    exact = np.linalg.solve(M, J.T @ lam - native.force(0.0, q, v, k))
    assert vdot == pytest.approx(exact, rel=1e-12, abs=1e-12 * np.abs(exact).max())
    assert found == pytest.approx(lam, abs=1e-5 * np.abs(lam).max())
    assert J @ native.project_velocity(0.0, q, k, -J @ v) == pytest.approx(-J @ v, abs=1e-13)


def four_bars(count: int, *changes: tuple[str, str]) -> Scene:
    """The example with another number of linkages."""
    text = FOUR_BARS.replace("count = 41", f"count = {count + 1}").replace("count = 40", f"count = {count}")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return parsed(text)


def pendulum(count: int, times: np.ndarray, rate: float, angle: float = 0.0) -> np.ndarray:
    """The angle of all cranks, which stay parallel: couplers translate on circles of 1 m."""
    inertia, moment = (count + 1) / 3 + count, G * ((count + 1) / 2 + count)
    solution = solve_ivp(
        lambda t, y: (y[1], moment / inertia * np.sin(y[0])),
        (0, times[-1]),
        (angle, rate),
        method="DOP853",
        rtol=1e-13,
        atol=1e-13,
        t_eval=times,
    )
    return np.asarray(solution.y[0])


IN_LINE = (
    (
        'start = { position = ["i", 0.5], spin = -1 }',
        'start = { position = ["i + 0.5", 0], angle = -1.5707963267948966 }',
    ),
    ('start = { position = ["i + 0.5", 1] }', 'start = { position = ["i + 1.5", 0], angle = 0, spin = 0 }'),
)


HELD = """name = "held"
[ground.markers]
o = [0, 0]
p = [1, 0]
[bodies.rod]
length = 1
mass = 1
bending_stiffness = 20
FRAME
markers = { left = -1, right = 1, off = 0.5 }
start = { position = [0.5, 0] }
[joints.first]
kind = "revolute"
between = ["ground.o", "rod.left"]
[forces.load]
at = "rod.off"
components = [0, -10]
[simulation]
duration = 0.2
tolerance = 1e-11
output = 0.01
"""
PINNED = '[joints.second]\nkind = "revolute"\nbetween = ["ground.p", "rod.right"]\n'
ROLLER = """[bodies.roller]
mass = 1e-9
inertia = 1
markers = { pin = [0, 0] }
start = { position = [1, 0] }
[joints.guide]
kind = "translational"
between = ["ground.o", "roller.pin"]
[joints.second]
kind = "revolute"
between = ["rod.right", "roller.pin"]
"""


@pytest.mark.long
def test_a_beam_that_is_held_twice_along_its_axis_moves_as_on_a_roller() -> None:
    """In the chord frame, where deflections do not change the distance of its ends."""
    shapes = 'frame = "chord"\nansatz = ["1", "xi", "xi^2", "xi^3"]'
    pinned, rolling = (simulated(parsed(HELD.replace("FRAME", shapes) + joint)) for joint in (PINNED, ROLLER))
    amplitudes = [name for name in pinned.model.coordinates if "alpha" in name.name]
    assert len(amplitudes) == 2
    for name in amplitudes:
        assert pinned[name.name] == pytest.approx(rolling[name.name], abs=1e-10)
    assert np.abs(pinned[amplitudes[1].name]).max() > 1e-4
    assert any("second_1 is implied by first_1" in note for note in pinned.solution.notes)


def test_a_beam_that_its_joints_would_keep_straight_is_refused() -> None:
    """In the mean frame antisymmetric deflections change the distance of its ends to second order."""
    shapes = 'frame = "mean"\nansatz = ["1", "xi", "xi^2", "xi^3"]'
    for redundant in ("auto", "resolve"):
        with pytest.raises(InextensibleBeam):
            simulated(replace(parsed(HELD.replace("FRAME", shapes) + PINNED), redundant=redundant))


ALMOST = """[joints.almost]
kind = "revolute"
between = ["ground.beside", "arm.beside"]
"""


@pytest.mark.parametrize(
    ("lowering", "integrator"),
    [
        ("flat", "adaptive"),
        ("instances", "adaptive"),
        pytest.param("flat", "generalised-alpha", marks=pytest.mark.long),
    ],
)
def test_a_second_bearing_a_rounding_error_away_counts_as_redundant(lowering: str, integrator: str) -> None:
    """Its factors are 1e-16 m, and would stop the arm if constraints were compared with their own sizes alone."""
    text = ARM.replace("keep_coordinates = true\n", "").replace("[scene]", f'[scene]\nlowering = "{lowering}"')
    text = text.replace("o = [0, 0]", 'o = [0, 0]\nbeside = ["1e-16", 0]')
    text = text.replace("left = [-0.5, 0]", 'left = [-0.5, 0], beside = ["-0.5 + 1e-16", 0]')
    one, two = (simulated(parsed(of), integrator) for of in (text, text + ALMOST))
    assert two.model.proximal and np.ptp(one["arm_phi"]) > 0.5
    assert two.q == pytest.approx(one.q, abs=1e-9)
    assert two.lam[:, -2:] == pytest.approx(0, abs=1e-2)
