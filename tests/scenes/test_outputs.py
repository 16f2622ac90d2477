"""Outputs of scenes, against multipliers, finite differences, energy and statics."""

from __future__ import annotations

import numpy as np
import pytest

import derive
from conftest import QUICK
from derive.generated_models import generated
from derive.spec.model.body import DisplacementOrder
from derive.spec.toml.read import parse
from explicit_motion import moved

CRANK = """
name = "sensed"
ground.markers = { o = [0, 0], wall = [0.9, 0.1] }
scene.gravity = [0, -9.81]
[bodies.crank]
mass = 0.7
inertia = 0.02
centre = [0.1, 0.03]
markers = { hub = [0.02, 0], pin = [0.2, 0.01] }
start = { angle = 0.5, spin = 2 }
KEEP
[bodies.rod]
mass = 0.4
length = 0.6
bending_stiffness = { symbol = "EI", default = 20 }
ansatz = ["1", "xi", "xi^2", "xi^3"]
markers = { left = -1, middle = 0, right = 1 }
start = { position = [0.4, 0.3], angle = 0.4, guess = true }
[joints.bearing]
kind = "revolute"
between = ["ground.o", "crank.hub"]
[joints.elbow]
kind = "revolute"
between = ["crank.pin", "rod.left"]
[springs.s]
between = ["ground.wall", "rod.right"]
stiffness = 30
damping = 0.5
rest = 0.3
[springs.t]
kind = "rotational"
between = ["ground.o", "crank.hub"]
stiffness = 2
damping = 0.1
[forces.push]
at = "crank.pin"
components = ["2*sin(3*t)", 1]
[torques.twist]
at = "rod.middle"
against = "crank.hub"
value = "0.3*t"
[outputs.hold]
kind = "reaction"
joint = "bearing"
[outputs.pin]
kind = "reaction"
joint = "elbow"
[outputs.energy]
kind = "energy"
[outputs.power]
kind = "power"
[outputs.x]
kind = "position"
marker = "rod.right"
frame = "crank.pin"
[outputs.v]
kind = "velocity"
marker = "rod.right"
frame = "crank.pin"
[outputs.a]
kind = "acceleration"
marker = "rod.right"
frame = "crank.pin"
[outputs.w]
kind = "angular_velocity"
marker = "rod.right"
frame = "crank.pin"
[outputs.far]
kind = "distance"
between = ["ground.wall", "rod.right"]
[outputs.line]
kind = "angle"
between = ["crank.pin", "rod.right"]
frame = "crank.pin"
[outputs.pull]
kind = "spring"
spring = "s"
[outputs.tension]
kind = "axial_force"
section = "rod.left"
[outputs.shear]
kind = "shear_force"
section = "rod.left"
[outputs.moment]
kind = "bending_moment"
section = "rod.left"
[outputs.tension_r]
kind = "axial_force"
section = "rod.right"
[outputs.shear_r]
kind = "shear_force"
section = "rod.right"
EXTRA
[simulation]
duration = 0.04
output = 1e-4
tolerance = 1e-11
"""

DRIVE = """
[drives.motor]
joint = "bearing"
motion = "0.5 + 2*t - 0.7*t^3"
[outputs.motor_torque]
kind = "drive"
drive = "motor"
"""


def scene(*, keep: bool = False, driven: bool = False, terms: str = "") -> derive.Scene:
    shapes = 'ansatz = ["1", "xi", "xi^2", "xi^3"]'
    order = f'{shapes}\norder = 2\nterms = "{terms}"' if terms else shapes
    text = (
        CRANK.replace(shapes, order)
        .replace("KEEP", "keep_coordinates = true" if keep else "")
        .replace("EXTRA", DRIVE if driven else "")
    )
    return parse(text.replace("EXTRA", ""))


RUNS = {
    "free": {"driven": False},
    "driven": {"driven": True},
    "driven, truncated second order": {"driven": True, "terms": "truncated"},
    "free, full second order": {"driven": False, "terms": "full"},
}


@pytest.fixture(
    scope="module",
    params=[pytest.param(run, id=name, marks=pytest.mark.long if "full" in name else ()) for name, run in RUNS.items()],
)
def run(request):
    return moved(scene(**request.param))


def compiled(spec):
    return derive.load_scene(generated(spec)[1], QUICK)


def rate(run, name):
    """The time derivative of a column by differences of fourth order, in the inner rows."""
    y, h = run[name], run.t[1] - run.t[0]
    return (y[:-4] - 8 * y[1:-3] + 8 * y[3:-1] - y[4:]) / (12 * h)


def test_reactions_of_eliminated_joints_are_the_multipliers(run):
    driven = "motor" in run.columns
    order = next(body.beam.order for body in run.spec.bodies if body.name == "rod")
    terms = {DisplacementOrder.TRUNCATED: "truncated", DisplacementOrder.FULL: "full"}.get(order, "")
    state = compiled(scene(keep=True, driven=driven, terms=terms))
    assert len(state.multipliers) > run.lam.shape[1]
    k = state.setup()
    for i in (0, 40, 130):
        t, q, v = run.t[i], *matched(run, i, state)
        _, lam = state.solve(t, q, v, k)
        values = dict(zip(state.multipliers, lam, strict=True))
        found = {name: run[name][i] for name in run.columns}
        for axis in "12":
            assert found[f"hold_{axis}"] == pytest.approx(values[f"bearing_{axis}"], rel=1e-9, abs=1e-9)
            assert found[f"pin_{axis}"] == pytest.approx(values[f"elbow_{axis}"], rel=1e-9, abs=1e-9)
        torque = values["motor"] if driven else 0.0
        assert found["hold_torque"] == pytest.approx(torque, rel=1e-9, abs=1e-9)
        if driven:
            assert found["motor_torque"] == pytest.approx(torque, rel=1e-9)


def matched(run, i, state):
    """The state of a row in the coordinates of a model that keeps all."""
    native, k = run.motion.native, run.motion.k
    poses = dict(zip(native.bodies, native.poses(run.t[i], run.q[i], k), strict=True))
    own = {name: (q, v) for name, q, v in zip(native.coordinates, run.q[i], run.v[i], strict=True)}
    crank = poses["crank"]
    spin = own["crank_phi"][1] if "crank_phi" in own else 2 - 2.1 * run.t[i] ** 2
    cosine, sine = np.cos(crank[2]), np.sin(crank[2])
    centre = np.array([0.1, 0.03])  # the origin of a body with all coordinates is its centre of mass
    lever = np.array([[cosine, -sine], [sine, cosine]]) @ (centre - [0.02, 0])
    own |= {"crank_c1": (lever[0], -spin * lever[1]), "crank_c2": (lever[1], spin * lever[0])}
    own |= {"crank_phi": (crank[2], spin)}
    q, v = zip(*(own[name] for name in state.coordinates), strict=True)
    return np.array(q), np.array(v)


def test_powers_are_the_rate_of_the_energy(run):
    total = run["power_loads"] + run["power_drives"] + run["power_dissipated"]
    np.testing.assert_allclose(rate(run, "energy_total"), total[2:-2], rtol=1e-5, atol=1e-5)
    assert np.all(run["power_dissipated"] <= 0) and np.any(run["power_dissipated"] < -1e-3)


def test_motion_in_a_moving_frame(run):
    for axis in "12":
        np.testing.assert_allclose(rate(run, f"x_{axis}"), run[f"v_{axis}"][2:-2], rtol=1e-5, atol=1e-5)
        np.testing.assert_allclose(rate(run, f"v_{axis}"), run[f"a_{axis}"][2:-2], rtol=1e-4, atol=1e-3)
    assert not np.allclose(run["w"], 0)
    np.testing.assert_allclose(run["line"], np.arctan2(run["x_2"], run["x_1"]), atol=1e-12)


def test_spring_force_has_the_size_of_its_law(run):
    along = np.gradient(run["far"], run.t, edge_order=2)
    law = 30 * (run["far"] - 0.3) + 0.5 * along
    size = np.hypot(run["pull_1"], run["pull_2"])
    np.testing.assert_allclose(size[1:-1], np.abs(law)[1:-1], rtol=1e-3, atol=2e-3)


def test_section_forces_at_the_ends_are_what_acts_there(run):
    np.testing.assert_allclose(np.hypot(run["tension"], run["shear"]), np.hypot(run["pin_1"], run["pin_2"]), rtol=1e-9)
    np.testing.assert_allclose(run["moment"], 0, atol=1e-8)
    pull = np.hypot(run["pull_1"], run["pull_2"])  # the spring alone acts at the right end
    np.testing.assert_allclose(np.hypot(run["tension_r"], run["shear_r"]), pull, rtol=1e-9)
    assert np.abs(run["shear_r"]).max() > 0.1


DRIVEN = """
name = "driven"
ground.markers = { o = [0, 0] }
scene.gravity = [0, -9.81]
[bodies.crank]
mass = 0.7
inertia = 0.02
centre = [0.1, 0.03]
markers = { hub = [0, 0], pin = [0.2, 0] }
[bodies.rod]
mass = 0.4
length = 0.6
bending_stiffness = 20
ansatz = ["1", "xi", "xi^2", "xi^3"]
markers = { left = -1, right = 1 }
start = { position = [0.5, 0], guess = true }
[joints.bearing]
kind = "revolute"
between = ["ground.o", "crank.hub"]
[joints.elbow]
kind = "revolute"
between = ["crank.pin", "rod.left"]
[drives.motor]
joint = "bearing"
motion = { input = "turn" }
[forces.tip]
at = "rod.right"
components = [0, { input = "lift" }]
[inputs.turn]
unit = "rad"
value = "0.3*t^2"
[inputs.lift]
unit = "N"
value = "sin(t)"
[outputs.tip]
kind = "acceleration"
marker = "rod.right"
[outputs.torque]
kind = "drive"
drive = "motor"
[simulation]
duration = 0.5
output = 0.05
"""
