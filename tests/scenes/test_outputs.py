"""Outputs and run-time inputs of scenes, against multipliers, finite differences, energy and statics."""

from __future__ import annotations

import numpy as np
import pytest

import derive
from conftest import QUICK
from derive.generated_models import generated
from derive.simulation.observables.default_plots import default_plots
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


def test_a_cantilever_under_a_tip_load():
    static = parse(
        """
name = "cantilever"
ground.markers = { wall = [0, 0] }
[bodies.beam]
mass = { symbol = "m", default = 2 }
length = 1.5
bending_stiffness = 1e7
pieces = 2
frame = "clamped"
markers = { root = -1, quarter = -0.5, tip = 1 }
[joints.clamp]
kind = "weld"
between = ["ground.wall", "beam.root"]
[forces.load]
at = "beam.tip"
components = [5, -40]
[outputs.moment]
kind = "bending_moment"
section = "beam.quarter"
[outputs.shear]
kind = "shear_force"
section = "beam.quarter"
[outputs.tension]
kind = "axial_force"
section = "beam.quarter"
[outputs.strain]
kind = "strain"
section = "beam.quarter"
height = 0.01
""".replace('frame = "clamped"\n', "")
    )
    native = compiled(static)
    k, zero = native.setup(), np.zeros(native.nv)
    matrix = native.dae["index3"]
    y = np.zeros(matrix.size)
    y[:3] = [0.375, 0, 0]
    names = list(native.coordinates)
    for name, value in {"beam_1_c1": 0.375, "beam_2_c1": 1.125}.items():
        y[names.index(name)] = value
    for _ in range(4):  # Newton's method; the stiff beam hardly bends
        full = np.zeros(matrix.size)
        J = matrix.pattern.dense(matrix.jacobian(0, y, full, 0.0, k))
        F = matrix.residual(0, y, full, k)
        y = y - np.linalg.lstsq(J, F, rcond=None)[0]
    lam = y[native.nq + native.nv :]
    out = dict(zip(native.outputs, native.evaluate_outputs(0, y[: native.nq], zero, zero, lam, k), strict=True))
    assert out["moment"] == pytest.approx(-40 * 1.125, rel=1e-5)
    assert out["moment_curvature"] == pytest.approx(-40 * 1.125, rel=1e-5)
    assert out["shear"] == pytest.approx(-40, rel=1e-5)
    assert out["tension"] == pytest.approx(5, rel=1e-3)
    assert out["strain"] == pytest.approx(0.01 * 40 * 1.125 / 1e7, rel=1e-5)


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


def test_the_jacobian_of_outputs_by_differences():
    spec = parse(DRIVEN)
    native = compiled(spec)
    assert native.inputs == ("turn", "turndot", "turnddot", "lift")
    sizes = (native.nq, native.nv, native.nv, native.nlambda, 4)
    rng = np.random.default_rng(3)
    x = rng.normal(size=sum(sizes)) * 0.3

    def values(x):
        q, v, vdot, lam, u = np.split(x, np.cumsum(sizes)[:-1])
        return native.evaluate_outputs(0.2, q, v, vdot, lam, native.with_inputs(native.setup(), u))

    h = 1e-6
    differences = np.array([(values(x + h * e) - values(x - h * e)) / (2 * h) for e in np.eye(len(x))]).T
    q, v, vdot, lam, u = np.split(x, np.cumsum(sizes)[:-1])
    k = native.with_inputs(native.setup(), u)
    exact = native.outputs_pattern.dense(native.outputs_jacobian(0.2, q, v, vdot, lam, k))
    np.testing.assert_allclose(exact, differences, rtol=1e-7, atol=1e-7 * np.abs(exact).max())
    assert np.abs(exact[:, -1]).max() == 0  # the force acts through the accelerations


def test_inputs_of_functions_of_python_and_of_the_specification_are_one():
    spec = parse(DRIVEN)
    known = moved(spec)
    inputs = {"turn": lambda t: (0.3 * t**2, 0.6 * t, 0.6), "lift": np.sin}
    for some in (inputs, {"lift": np.sin}):
        given = moved(spec, inputs=some)
        np.testing.assert_allclose(given.q, known.q, atol=1e-8)
        np.testing.assert_allclose(given["torque"], known["torque"], atol=1e-6)
        np.testing.assert_allclose(given["tip_2"], known["tip_2"], atol=1e-6)


def test_batches_share_the_inputs():
    spec = parse(DRIVEN)
    native = compiled(spec)
    rng = np.random.default_rng(5)
    k = native.with_inputs(native.setup(), [0.3, 0.2, 0.1, 2.0])
    q, v = rng.normal(size=(2, 5, native.nq)) * 0.1
    one = np.array([native.accel(0.0, a, b, k) for a, b in zip(q, v, strict=True)])
    np.testing.assert_array_equal(native.accel_batch(0.0, q, v, k), one)


def refused(text: str) -> str:
    with pytest.raises(derive.SpecError) as caught:
        parse(text)
    return str(caught.value)


def test_wrong_ports_are_refused():
    assert 'there is no input "lft"; did you mean "lift"?' in refused(
        DRIVEN.replace('{ input = "lift" }', '{ input = "lft" }')
    )
    unused = refused(DRIVEN.replace('[0, { input = "lift" }]', "[0, 1]"))
    assert "inputs.lift: no force, torque, load or drive uses it" in unused
    unknown = refused(DRIVEN.replace('drive = "motor"', 'drive = "moto"'))
    assert 'there is no drive "moto"; did you mean "motor"?' in unknown
    assert "the body crank is no beam" in refused(
        DRIVEN.replace('kind = "acceleration"\nmarker = "rod.right"', 'kind = "curvature"\nsection = "crank.pin"')
    )
    message = refused(DRIVEN.replace('kind = "acceleration"', 'kind = "jerk"'))
    assert 'the output is one of "position", "velocity"' in message
    assert "a acceleration output has no joint" not in message
    taken = refused(DRIVEN.replace("[outputs.torque]", "[outputs.rod_phi]"))
    assert 'outputs.rod_phi: "rod_phi" is taken: it is a coordinate of the body rod; choose another name' in taken
    assert "there is no body" in refused(DRIVEN.replace('marker = "rod.right"', 'marker = "rood.right"'))


def test_an_input_without_a_value_needs_one_in_a_simulation():
    spec = parse(DRIVEN.replace('value = "sin(t)"\n', ""))
    with pytest.raises(derive.SpecError, match=r"inputs\.lift: a simulation needs its value"):
        moved(spec)
    with pytest.raises(derive.UnknownNameError, match='there is no input of driven "lit"; did you mean "lift"'):
        moved(spec, inputs={"lit": np.sin})


def shown(text: str) -> dict[str, tuple[str, ...]]:
    """The columns of the default plots of a scene."""
    scene = parse(text)
    return {plot.name: plot.quantity.y for plot in default_plots(scene, derive.lower(derive.derive(scene)))}


def test_outputs_that_no_plot_shows_have_plots_of_their_own():
    assert shown(DRIVEN + '[plots.all]\ny = ["tip_1", "rod_phi"]\n') == {"torque": ("torque",)}


@pytest.mark.parametrize(
    ("plot", "expected"),
    [
        ('bow]\ndeflection = "rod.right"\nchord = ["ground.o", "rod.left"]\ndivided_by = 0.6', {}),
        ('bend]\ndeflection = "rod.right"\nchord = ["ground.o", "rod.left"]', {"bend_output": ("bend",)}),
        ('bend]\ny = ["rod_phi"]', {"bend_output": ("bend",)}),
    ],
    ids=["the same deflection", "its name, another deflection", "its name, a column"],
)
def test_an_output_is_plotted_unless_a_plot_shows_it_whatever_their_names(plot, expected):
    outputs = '[outputs.bend]\nkind = "deflection"\nmarker = "rod.right"\nchord = ["ground.o", "rod.left"]\n'
    text = DRIVEN.split("[outputs.tip]", maxsplit=1)[0] + f"{outputs}divided_by = 0.6\n[plots.{plot}\n"
    assert shown(text) == expected


def test_a_scene_without_outputs_and_plots_shows_its_coordinates():
    assert shown(DRIVEN.split("[outputs.tip]", maxsplit=1)[0]) == {
        "angles": ("rod_phi",),
        "positions": ("rod_c1", "rod_c2"),
        "deformations": ("rod_alpha1", "rod_alpha2"),
    }


def test_the_python_module_has_the_same_inputs_and_outputs():
    spec = parse(DRIVEN)
    files = generated(spec)[1]
    (source,) = (file.text for file in files if file.path.endswith(".py"))
    module = {}
    exec(compile(source, "driven.py", "exec"), module)
    native = derive.load_scene(files, QUICK)
    rng = np.random.default_rng(7)
    q, v, u = rng.normal(size=native.nq) * 0.1, rng.normal(size=native.nv), rng.normal(size=4)
    k, constants = native.with_inputs(native.setup(), u), module["setup"](native.defaults)
    vdot, lam = native.solve(0.2, q, v, k)
    np.testing.assert_array_equal(module["accel"](0.2, q, v, u, constants), vdot)
    arguments = (0.2, q, v, vdot, lam)
    np.testing.assert_array_equal(module["outputs"](*arguments, u, constants), native.evaluate_outputs(*arguments, k))
    np.testing.assert_array_equal(
        module["outputs_jacobian"](*arguments, u, constants), native.outputs_jacobian(*arguments, k)
    )


def test_a_driven_slider_needs_the_force_that_accelerates_it():
    text = """
name = "slide"
ground.markers = { o = [0, 0] }
scene.gravity = [0, -9.81]
[bodies.block]
mass = 2
inertia = 1
centre = [0.3, 0.2]
markers = { hook = [0.1, 0] }
[joints.guide]
kind = "translational"
between = ["ground.o", "block.hook"]
axis = [3, 4]
[drives.push]
joint = "guide"
motion = "0.5*t^2"
[bodies.free]
mass = 1
inertia = 1
[outputs.force]
kind = "drive"
drive = "push"
[outputs.hold]
kind = "reaction"
joint = "guide"
[simulation]
duration = 0.2
output = 0.1
"""
    run = moved(parse(text))
    np.testing.assert_allclose(run["force"], 2 * 1.0 + 2 * 9.81 * 0.8, rtol=1e-12)
    force = 2 * np.array([0.6, 0.8 + 9.81])  # mass times acceleration, less the weight; at the centre of mass
    np.testing.assert_allclose([run["hold_1"][-1], run["hold_2"][-1]], force, rtol=1e-12)
    lever = np.array([0.2, 0.2])  # from the hook, about which the torque is
    np.testing.assert_allclose(run["hold_torque"], lever[0] * force[1] - lever[1] * force[0], rtol=1e-12)


def test_an_angle_of_whole_radians_is_one_like_any_other() -> None:
    """cos(1) is no exact number, and no symbol is in it."""

    def position(angle: str) -> np.ndarray:
        spec = parse(f"""
name = "slide"
ground.markers = {{ o = [0, 0] }}
[bodies.sledge]
mass = 1
inertia = 0.1
markers = {{ foot = [0, 0], tip = [0.5, 0.2] }}
[joints.guide]
kind = "translational"
between = ["ground.o", "sledge.foot"]
angle = {angle}
[drives.pull]
joint = "guide"
motion = "0.3 + t"
[bodies.bob]
mass = 1
inertia = 0.1
markers = {{ pivot = [0.1, 0] }}
[joints.pin]
kind = "revolute"
between = ["sledge.tip", "bob.pivot"]
[outputs.at]
kind = "position"
marker = "bob.pivot"
frame = "sledge.foot"
""")
        native = compiled(spec)
        q, v, k = np.array([0.4]), np.array([-0.7]), native.setup()
        vdot, lam = native.solve(0.2, q, v, k)
        return native.evaluate_outputs(0.2, q, v, vdot, lam, k)

    assert position("-1") == pytest.approx(position("-1.0000000001"), abs=1e-9)
    assert np.abs(position("-1")).min() > 0.01
