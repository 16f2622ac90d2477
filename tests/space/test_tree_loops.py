"""Trees of rigid bodies in loops over their links: the values of straight-line code in text that does not grow."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from derive.backends.c.source import CBackend
from derive.derivation import derive
from derive.errors import SpecError
from derive.ir.interpreter import interpret
from derive.ir.model import Model
from derive.ir.statements import ForEach, inside
from derive.lowering.model_functions import functions_of
from derive.lowering.trees.choice import chosen
from derive.lowering.trees.functions import FUNCTIONS
from derive.lowering.trees.tree_context import TreeContext
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from derive.model_lowering import lower
from derive.pipeline import model_files
from derive.runtime.loading import load
from derive.spec.toml.read import parse

HEAD = """
name = "tree"
[scene]
gravity = [1, 0.5, -9.81]
coordinates = "relative"
lowering = "{lowering}"
[ground.markers]
o = {{ at = [0.1, 0.2, 0.3], rotation = {{ x = [1, 0, 0], z = [0, 0.6, 0.8] }} }}
"""
BODY = """
[bodies.{name}]
mass = {mass}
centre = [{centre}, 0.02, 0.1]
inertia = [0.4, 0.5, 0.3, 0.01, 0.02, -0.015]
[bodies.{name}.markers]
a = {{ at = [0.1, 0, {centre}], rotation = {{ x = [0, 1, 0], z = [1, 0, 0] }} }}
b = {{ at = [0, -0.1, 0.5], rotation = {{ x = [1, 0, 0], z = [0, 0.6, 0.8] }} }}
"""
JOINT = '[joints.{name}]\nkind = "{kind}"\nbetween = ["{first}", "{second}"]\n'
LOADS = """
[inputs.drive]
value = 0
[torques.driven]
joint = "j1"
value = { input = "drive" }
[torques.constant]
joint = "j4"
value = 1.5
[forces.in_time]
joint = "j2"
value = "3*sin(t)"
[springs.hinge]
kind = "rotational"
stiffness = 2
rest = 0.3
damping = 0.4
between = ["b1.a", "b0.b"]
[springs.slide]
kind = "bushing"
stiffness = [0, 0, 7, 0, 0, 0]
damping = [0, 0, 0.7, 0, 0, 0]
between = ["b2.b", "b1.b"]
[forces.push]
at = "b6.a"
force = [1, "2*t", 3]
[forces.thrust]
at = "b4.b"
force = [1, 0.5, 2]
frame = "body"
[torques.wheel]
on = "b4.a"
against = "b1.b"
torque = [0.1, { input = "drive" }, "t"]
frame = "body"
[springs.rope]
kind = "linear"
between = ["ground.o", "b6.b"]
stiffness = 30
rest = 1
damping = 2
[springs.cord]
kind = "linear"
between = ["b3.a", "b6.a"]
stiffness = 20
rest = 0.2
damping = 1
[springs.band]
kind = "linear"
between = ["b5.a", "b2.b"]
stiffness = 25
damping = 3
rest = 0.1
[springs.damper]
kind = "linear"
between = ["b4.a", "ground.o"]
stiffness = 0
damping = 3
[springs.coil]
kind = "rotational"
between = ["b2.a", "b6.a"]
stiffness = 4
damping = 0.5
rest = 0.1
[springs.cross]
kind = "rotational"
between = ["b0.a", "b3.a"]
stiffness = 3
[springs.mount]
kind = "bushing"
between = ["b4.b", "ground.o"]
stiffness = [5, 6, 7, 0, 3, 2]
damping = [0.5, 0, 0.7, 0, 0.3, 0.2]
[outputs.angle]
kind = "joint"
joint = "j1"
[outputs.speed]
kind = "joint_speed"
joint = "j2"
"""


THREAD = ('"revolute"', '"screw"\npitch = 0.3')
THRUST = '[forces.thrust]\njoint = "j0"\nvalue = 3\n'
"""A force along a thread, whose coordinate is an angle."""


def _body(name: str, number: int) -> str:
    return BODY.format(name=name, mass=1 + 0.3 * (number % 3), centre=0.1 + 0.01 * (number % 4))


def _chain(count: int, lowering: str = "instances") -> str:
    parts = [HEAD.format(lowering=lowering)]
    for k in range(count):
        first = "ground.o" if k == 0 else f"b{k - 1}.b"
        parts += [_body(f"b{k}", k), JOINT.format(name=f"j{k}", kind="revolute", first=first, second=f"b{k}.a")]
    return "".join(parts)


def _tree(lowering: str, free: bool) -> str:
    """A tree with a joint of each kind, a body that is fixed to another one, loads, and outputs of joints."""
    joints = [("b0.b", "b1.a", "revolute"), ("b1.b", "b2.b", "prismatic"), ("b3.a", "b0.a", "universal")]
    joints += [("b3.b", "b4.a", "cylindrical"), ("b0.a", "b5.a", 'screw"\npitch = 0.3 # "'), ("b5.b", "b6.b", "planar")]
    parts = [HEAD.format(lowering=lowering), *(_body(f"b{k}", k) for k in range(7))]
    parts += [] if free else [JOINT.format(name="j0", kind="revolute", first="ground.o", second="b0.a")]
    parts += [
        JOINT.format(name=f"j{n}", kind=kind, first=first, second=second)
        for n, (first, second, kind) in enumerate(joints, 1)
    ]
    return "".join(parts) + LOADS


@cache
def _model(text: str) -> Model:
    return lower(derive(parse(text)), explicit=True)


def _mechanism(text: str) -> SpatialMechanism:
    mechanism = derive(parse(text))
    assert isinstance(mechanism, SpatialMechanism)
    return mechanism


def _state(model: Model) -> dict[str, Any]:
    rng = np.random.default_rng(3)
    names = [c.name for c in model.coordinates]
    q, v, u = (rng.uniform(-1, 1, len(of)) for of in (names, model.velocities, model.inputs))
    if "b0_e0" in names:
        first = names.index("b0_e0")
        q[first : first + 4] /= np.linalg.norm(q[first : first + 4])
    y, ydot = np.concatenate([q, v]), rng.uniform(-1, 1, len(q) + len(v))
    given: dict[str, Any] = {"q": q, "v": v, "u": u, "y": y, "ydot": ydot, "vdot": v, "r": [], "lam": [], "k": []}
    return {"t": 0.7, **{name: list(value) for name, value in given.items()}}


def _differences(first: Model, second: Model) -> dict[str, float]:
    """The differences of the outputs of the functions of a state, relative to the largest value of each."""
    result: dict[str, float] = {}
    state = _state(first)
    for kernel in first.kernels:
        if kernel.name == "setup" or not {a.name for a in kernel.arguments} <= {*state}:
            continue
        wanted, found = (interpret(m.kernel(kernel.name), state) for m in (first, second))
        for name, want in wanted.items():
            a, b = np.array(want, float), np.array(found[name], float)
            assert a.shape == b.shape, (kernel.name, name)
            if a.size:
                result[f"{kernel.name} {name}"] = np.max(np.abs(a - b)) / max(np.max(np.abs(a)), 1e-300)
    return result


@pytest.mark.parametrize("free", [True, pytest.param(False, marks=pytest.mark.long)])
def test_loops_over_links_have_the_values_of_straight_line_code(free: bool) -> None:
    """All functions for explicit integration of a tree with every kind of joint and load."""
    loops, flat = (_model(_tree(lowering, free)) for lowering in ("instances", "flat"))
    assert loops.pattern("mass", "M") == flat.pattern("mass", "M")
    found = _differences(loops, flat)
    assert {"mass M", "accel vdot", "force h", "energy energy", "poses pose", "outputs out"} <= {*found}
    assert {name: error for name, error in found.items() if error > 1e-13} == {}


def test_residuals_and_functions_on_request_are_those_of_straight_line_code() -> None:
    """The recursion of Newton and Euler for given accelerations is M vdot + h, also without velocities."""
    texts = (_chain(3, lowering) for lowering in ("instances", "flat"))
    loops, flat = (lower(derive(parse(text)), functions="all") for text in texts)
    found = _differences(loops, flat)
    assert {"residual F", "inverse_dynamics f", "gravity_compensation f", "centre_of_mass x"} <= {*found}
    assert max(found.values()) < 1e-13


def test_statements_do_not_grow_with_the_number_of_links() -> None:
    """A chain of nine links has the statements of one of six, with other bounds and longer tables."""
    assert _statements(6) == _statements(9)


def _statements(count: int) -> list[int]:
    """The statements of the accelerations, the mass matrix and the forces of a chain."""
    context = TreeContext(_mechanism(_chain(count)))
    known = (f for f in functions_of(context.known.context.equations) if f.name in ("accel", "mass", "force"))
    kernels = [FUNCTIONS[function.kind](context, function) for function in known]
    return [len(k.statements) + sum(len([*inside(s)]) for s in k.statements if isinstance(s, ForEach)) for k in kernels]


def test_compiled_loops_have_the_values_of_the_interpreter() -> None:
    """C, with vectors over links and their batch, computes what the interpreter does."""
    model = _model(_tree("instances", True))
    state, of = _state(model), load(CBackend().files(model, "test"))
    q, v, k = np.array(state["q"]), np.array(state["v"]), of.setup([])
    wanted = interpret(model.kernel("accel"), {**state, "u": [0.0]})["vdot"]
    assert of.accel(0.7, q, v, k) == pytest.approx(wanted, rel=1e-12, abs=1e-12)
    assert of.accel_batch(0.7, [q] * 9, [v] * 9, k) == pytest.approx(np.array([wanted] * 9), rel=1e-12, abs=1e-12)


def test_what_loops_over_links_do_not_have_is_refused_by_name() -> None:
    """Forces along threads: all of them at once, with what to write instead."""
    text = _chain(3).replace(*THREAD) + THRUST + THRUST.replace("thrust", "pull").replace("j0", "j1")
    with pytest.raises(SpecError) as error:
        _model(text)
    assert [p.message.split(": ")[-1] for p in error.value.problems] == ['write lowering = "flat"'] * 2
    assert "pull" in str(error.value)
    assert "thrust" in str(error.value)


def test_long_chains_are_looped_over_their_links_without_being_asked() -> None:
    """Fourteen links take less time in loops; five, and a scene that loops do not have, stay in straight-line code.

    With derivatives, which come column by column, it takes more links until the compiler would be the slower one.
    """
    scenes = [_mechanism(_chain(count, "auto")) for count in (14, 5)]
    scenes.append(_mechanism(_chain(14, "auto").replace(*THREAD) + THRUST))
    assert [chosen(mechanism, explicit=True)[0] for mechanism in scenes] == [True, False, False]
    assert chosen(scenes[0], explicit=False)[1].startswith("unrolled, since derivatives in loops")
    assert chosen(scenes[2], explicit=True)[1].endswith("and thrust is one")
    seen = _mechanism(_chain(14, "auto") + '[outputs.height]\nkind = "position"\nmarker = "b3.b"\n')
    assert chosen(seen, explicit=True) == (
        False,
        "unrolled, since outputs in loops over links are motions of joints, and height is another one",
    )
    assert chosen(_mechanism(_chain(20, "auto")), explicit=False)[0]
    assert lower(scenes[0], explicit=True).lowering == "instances"


def test_forms_without_constraints_have_one_text_in_c_and_in_python() -> None:
    """The functions of the reduced forms call those of index 3."""
    scene = parse(_chain(2))
    texts = {file.path.rsplit(".")[-1]: file.text for file in model_files(lower(derive(scene)), scene)}
    assert texts["c"].count("return tree_jacobian(t, y, ydot, cj, k, jac);") == 2
    assert texts["py"].count("return jacobian(t, y, ydot, cj, k)\n") == 2
    assert texts["py"].count("return residual(t, y, ydot, k)\n") == 2
