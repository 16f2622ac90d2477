"""Functions on request, against other functions of the same models and differences of these, in C and interpreted."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike

import derive
from beams import run_module
from conftest import QUICK, ROOT
from derive.backends.model_files import explicit_files
from derive.cli.main import main
from derive.function_names import OF_MODELS, ON_REQUEST
from derive.ir.interpreter import interpret
from derive.notes.requested_notes import requested_notes
from derive.runtime.compiler import CompilerError
from derive.spec.toml.read import parse

Array = np.ndarray

PLANE = """
name = "plane"
scene.gravity = [0, { symbol = "gy", default = -9.81 }]
ground.markers = { o = [0, 0], far = [3, 1] }
[bodies.rod]
ansatz = ["1", "xi", "xi^2", "xi^3"]
frame = "mean"
order = 2
mass = { symbol = "m", default = 1.3 }
length = 1.2
bending_stiffness = { symbol = "EI", default = 7 }
markers = { left = -1, right = 1 }
[bodies.block]
mass = 2
inertia = { symbol = "J", default = 0.4 }
markers = { pin = [0.1, -0.2], far = [0.3, 0.1] }
[joints.hinge]
kind = "revolute"
between = ["rod.right", "block.pin"]
[inputs.push]
value = "5"
[forces.push]
at = "block.far"
components = [{ input = "push" }, 1]
[springs.mount]
between = ["ground.far", "block.far"]
stiffness = { symbol = "ks", default = 30 }
damping = 2
rest = 0.4
[outputs.spin]
kind = "angular_velocity"
marker = "rod.right"
"""
SPACE = """
name = "space"
scene.gravity = [0, 1, { symbol = "gz", default = -9.81 }]
[ground.markers]
base = { at = [0, 0.3, 0], rotation = { axis = [1, 2, 3], angle = 0.7 } }
[bodies.arm]
mass = { symbol = "m", default = 1.3 }
centre = [{ symbol = "c", default = 0.2 }, 0.1, 0]
inertia = [0.3, 0.4, 0.5, { symbol = "Jxy", default = 0.02 }, 0, 0.01]
markers.root = [0, 0, 0.1]
markers.tip = { at = [0.8, 0, 0], rotation = { axis = [0, 1, 1], angle = -0.4 } }
[bodies.boom]
mass = 0.7
length = 1.1
bending_stiffness = { symbol = "EI", default = 40 }
rotary_inertia = 1e-3
[bodies.boom.markers]
left = -1
end = { at = 1, rotation = { axis = [1, 0, 1], angle = 1.1 } }
[joints.hinge]
kind = "revolute"
between = ["ground.base", "arm.root"]
[joints.ball]
kind = "spherical"
between = ["arm.tip", "boom.left"]
[inputs.turn]
value = "5"
[torques.turn]
on = "arm.tip"
torque = [{ input = "turn" }, 0, 1]
frame = "body"
[outputs.spin]
kind = "angular_velocity"
marker = "boom.end"
"""
CARRIED = """
name = "carried"
ground.markers = { o = [0, 0] }
[bodies.crank]
mass = 1
inertia = 0.1
markers = { o = [0, 0], pin = [0.5, 0] }
[bodies.rod]
mass = 2
inertia = 0.3
markers = { pin = [-0.4, 0] }
[bodies.loose]
mass = 3
inertia = 0.2
markers = { tip = [1, 0] }
[joints.bearing]
kind = "revolute"
between = ["ground.o", "crank.o"]
[joints.pin]
kind = "revolute"
between = ["crank.pin", "rod.pin"]
[drives.motor]
joint = "bearing"
motion = "3*t"
"""
TREE = """
name = "tree"
[scene]
gravity = [1, 0, { symbol = "gz", default = -9.81 }]
coordinates = "relative"
[ground.markers]
base = { at = [0, 0.3, 0], rotation = { axis = [1, 2, 3], angle = 0.7 } }
[bodies.first]
mass = { symbol = "m", default = 1.3 }
centre = [0.2, 0.1, 0]
inertia = [0.3, 0.4, 0.5, 0.02, 0, 0.01]
markers.root = [0, 0, 0.1]
markers.tip = { at = [0.8, 0, 0], rotation = { axis = [0, 1, 1], angle = -0.4 } }
[bodies.second]
mass = 0.7
inertia = [0.2, 0.3, 0.25, 0, 0, 0]
markers.root = { at = [0, 0.3, 0], rotation = { axis = [1, 0, 1], angle = 1.1 } }
markers.tip = [0.2, 0, 0.1]
[bodies.third]
mass = 0.4
inertia = [0.1, 0.2, 0.15, 0, 0, 0]
markers.root = [0.3, 0, 0.1]
[joints.hinge]
kind = "JOINT"
between = ["ground.base", "first.root"]
[joints.guide]
kind = "cylindrical"
between = ["first.tip", "second.root"]
[joints.last]
kind = "universal"
between = ["second.tip", "third.root"]
"""
BALLS = TREE.replace("JOINT", "revolute").replace("cylindrical", "spherical").replace("tree", "balls")
BALLS += """
[bodies.free]
mass = 1
inertia = [0.1, 0.2, 0.15, 0, 0, 0]
markers.tip = [0.3, 0, 0.1]
[bodies.hanging]
mass = 0.6
inertia = [0.2, 0.2, 0.15, 0, 0, 0]
markers.root = [0.3, 0.2, 0.1]
[joints.pin]
kind = "revolute"
between = ["free.tip", "hanging.root"]
"""
LEAN = ("lean",)
"""The specifications that are lowered without derivatives, where trees of bodies with quaternions have recursions."""
SPECS: dict[str, Callable[[], Any]] = {
    "tree": lambda: parse(TREE.replace("JOINT", "prismatic")),
    "balls": lambda: parse(BALLS),
    "lean": lambda: parse(BALLS.replace("balls", "lean")),
    "plane": lambda: parse(PLANE),
    "space": lambda: parse(SPACE),
    "carried": lambda: parse(CARRIED),
    "beam": lambda: derive.read(ROOT / "scenes" / "free_beam_point.toml"),
    "body": lambda: derive.symbolic_body("body", 2, frame="given", lowering="flat"),
}
EVERY = [pytest.param(name, marks=pytest.mark.long) if name == "balls" else name for name in SPECS]


@cache
def made(name: str) -> tuple[derive.Model, Any, Any]:
    """The model of a specification with all functions, its C, and the names of its Python."""
    spec = SPECS[name]()
    lean = name in LEAN
    model = derive.lower(derive.derive(spec), sensitivities=not lean, explicit=lean, functions="all")
    files = explicit_files(model, spec) if lean else derive.model_files(model, spec)
    load = derive.load_scene if model.is_scene else derive.load
    return model, load(files, QUICK), {} if lean else run_module(files)


class State:
    """A random state of a model, with its constants."""

    def __init__(self, name: str) -> None:
        self.model, self.native, self.python = made(name)
        n, rng = self.native, np.random.default_rng(7)
        self.p = n.defaults * rng.uniform(0.8, 1.2, n.np)
        self.k = n.setup(self.p)
        self.u = rng.uniform(-1, 1, len(self.model.inputs))
        if self.u.size:
            self.k = n.with_inputs(self.k, self.u)
        self.t, self.q, self.v = 0.3, rng.uniform(-1, 1, n.nq), rng.uniform(-2, 2, n.nv)
        self.vdot = rng.uniform(-5, 5, n.nv)
        for i, name_of in enumerate(n.coordinates):
            if name_of.endswith("e0"):
                self.q[i : i + 4] /= np.linalg.norm(self.q[i : i + 4])
            if "alpha" in name_of:
                self.q[i] *= 0.1

    def dense(self, name: str, values: ArrayLike) -> Array:
        return np.asarray(self.native.patterns[name].dense(values))


def close(a: ArrayLike, b: ArrayLike, limit: float = 1e-12) -> None:
    a, b = np.asarray(a), np.asarray(b)
    assert a.shape == b.shape
    assert abs(a - b).max(initial=0.0) <= limit * max(1.0, abs(b).max(initial=0.0))


@pytest.mark.parametrize("name", EVERY)
def test_inverse_dynamics_and_gravity_compensation_are_the_rows(name: str) -> None:
    s = State(name)
    values, h = s.native.mass_force(s.t, s.q, s.v, s.k)
    close(s.native.inverse_dynamics(s.t, s.q, s.v, s.vdot, s.k), s.native.mass_pattern.dense(values) @ s.vdot + h)
    still = s.native.force(s.t, s.q, np.zeros(s.native.nv), s.k)
    close(s.native.gravity_compensation(s.t, s.q, s.k), still)


@pytest.mark.parametrize("name", EVERY)
def test_the_centre_of_mass_moves_with_the_momentum(name: str) -> None:
    """Its velocity is the momentum over the mass, its Jacobian times v, and the rate of its position."""
    s, h = State(name), 1e-6
    x, xdot, jacobian, mass = s.native.centre_of_mass(s.q, s.v, s.k)
    close(xdot * mass, s.native.momentum(s.q, s.v, s.k)[: len(x)])
    close(s.dense("centre_of_mass", jacobian) @ s.v, xdot)
    qdot = s.native.rates(s.q, s.v, s.k)
    ahead, behind = (s.native.centre_of_mass(s.q + step * qdot, s.v, s.k)[0] for step in (h, -h))
    close((ahead - behind) / (2 * h), xdot, 1e-8)


@pytest.mark.parametrize("name", EVERY)
def test_centroidal_momentum_is_momentum_about_the_centre(name: str) -> None:
    s = State(name)
    x = s.native.centre_of_mass(s.q, s.v, s.k)[0]
    d, whole = len(x), s.native.momentum(s.q, s.v, s.k)
    momentum, A = s.native.centroidal_momentum(s.q, s.v, s.k)
    close(momentum[:d], whole[:d])
    of_centre = np.cross([*x, 0][:3], [*whole[:d], 0][:3])[-len(whole[d:]) :]
    close(momentum[d:], whole[d:] - of_centre)
    close(s.dense("centroidal_momentum", A) @ s.v, momentum)


def test_bodies_that_a_drive_moves_are_left_out() -> None:
    """The rod hangs on a driven crank: mass and momentum are those of the loose body alone, as a line says."""
    s = State("carried")
    loose = [s.native.velocities.index(f"loose_{name}dot") for name in ("c1", "c2", "phi")]
    _, xdot, _, mass = s.native.centre_of_mass(s.q, s.v, s.k)
    assert mass == 3.0
    close(xdot, s.v[loose[:2]])
    close(s.native.centroidal_momentum(s.q, s.v, s.k)[0], [3, 3, 0.2] * s.v[loose])
    assert any("rod in energy, momentum" in out.what for out in s.model.eliminated)


@pytest.mark.parametrize(("name", "marker"), [("plane", "rod_right"), ("space", "boom_end")])
def test_marker_frames_turn_as_outputs_say(name: str, marker: str) -> None:
    """The output of the angular velocity is derived from the motion of the frame, and the Jacobian is that by v."""
    s = State(name)
    omega, jacobian = s.native.rotation(marker, s.q, s.v, s.k)
    zero = np.zeros(s.native.nv), np.zeros(s.native.nlambda)
    close(omega, s.native.evaluate_outputs(s.t, s.q, s.v, *zero, s.k))
    close(s.dense(f"rotation_{marker}", jacobian) @ s.v, omega)


@pytest.mark.parametrize("name", ["plane", "space"])
def test_c_python_and_the_interpreter_agree(name: str) -> None:
    s = State(name)
    n = s.native
    own = {"t": s.t, "q": s.q, "v": s.v, "vdot": s.vdot, "u": s.u, "k": s.k[: n.nk - len(s.u)]}
    kernels = {name: name for of in OF_MODELS for name in (of, f"{of}_jacobian")}
    kernels |= {f"rotation_{m}": f"rotation_{m}" for m in n.markers}
    kernels |= {f"jacobian_of_rotation_{m}": f"rotation_jacobian_{m}" for m in n.markers}
    for name_of, compiled in kernels.items():
        kernel = s.model.kernel(name_of)
        arguments = {a.name: own[a.name] for a in kernel.arguments}
        result = interpret(kernel, arguments)
        interpreted = np.concatenate([np.ravel(result[o.name]).astype(float) for o in kernel.outputs])
        python = s.python[name_of](*arguments.values())
        assert np.array_equal(np.hstack(python), interpreted)
        vectors = [*(x for a, x in arguments.items() if a not in ("t", "u", "k")), s.k]
        c = n._compiled[compiled].results(tuple(vectors), *([s.t] if "t" in arguments else []))
        close(np.concatenate(c), interpreted, 1e-15)


def test_functions_are_there_on_request_alone() -> None:
    spec = parse(PLANE)
    model = derive.lower(derive.derive(spec), functions=["centre_of_mass"])
    assert model.requested == ("centre_of_mass",)
    native = derive.load_scene(derive.model_files(model, spec), QUICK)
    q, v, k = np.zeros(native.nq), np.zeros(native.nv), native.setup()
    assert native.centre_of_mass(q, v, k)[3] == pytest.approx(3.3)
    with pytest.raises(CompilerError, match="plane has no inverse_dynamics; generate it with functions"):
        native.inverse_dynamics(0.0, q, v, v, k)
    with pytest.raises(CompilerError, match="has no centre_of_mass_jacobian; generate it with functions and sens"):
        native.centre_of_mass_jacobian(q, v, k)
    with pytest.raises(derive.UnknownNameError, match="centre_of_mas"):
        derive.lower(derive.derive(spec), functions="centre_of_mas")


def test_loops_refuse_them() -> None:
    text = PLANE.replace("scene.gravity", 'scene.lowering = "instances"\nscene.gravity')
    with pytest.raises(derive.SpecError, match="loops over instances have no inverse_dynamics"):
        derive.lower(derive.derive(parse(text)), functions="inverse_dynamics")
    with pytest.raises(derive.SpecError, match="loops have no inverse_dynamics and gravity_compensation"):
        body = derive.symbolic_body("body", 2, frame="given", lowering="loops")
        derive.lower(derive.derive(body), functions=ON_REQUEST[:2])


def test_a_line_says_which_functions_a_model_cannot_have() -> None:
    beam = derive.read(ROOT / "scenes" / "free_beam_mean.toml")
    model = derive.lower(derive.derive(beam), functions="all")
    assert list(requested_notes(model)) == ["no marker_rotations: markers of a body alone are points"]
    loose, joints = CARRIED.index("[bodies.loose]"), CARRIED.index("[joints.bearing]")
    driven = parse(CARRIED[:loose] + CARRIED[joints:])
    notes = list(requested_notes(derive.lower(derive.derive(driven), functions="all")))
    reason = "there are no bodies with coordinates that no drive moves"
    assert notes[:2] == [f"no centre_of_mass: {reason}", f"no centroidal_momentum: {reason}"]


def test_the_command_builds_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = str(ROOT / "scenes" / "free_beam_mean.toml")
    assert main(["build", spec, "--functions", "centre_of_mass,marker_rotations", "--out", str(tmp_path)]) == 0
    assert "no marker_rotations: markers of a body alone are points" in capsys.readouterr().out
    header = (tmp_path / "free_beam_mean" / "free_beam_mean.h").read_text()
    assert "int free_beam_mean_centre_of_mass(" in header and "int free_beam_mean_inverse_dynamics(" not in header
    with pytest.raises(SystemExit) as stopped:
        main(["build", spec, "--functions", "inverse"])
    assert stopped.value.code == 2
    assert "unknown: 'inverse'; did you mean inverse_dynamics?" in capsys.readouterr().err
