"""Where the ends of a spring coincide, its force has no direction: functions that need it return code 2."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import made
import numpy as np
import pytest

import derive
from derive.runtime.native_call import ModelError
from explicit_motion import moved

SCENE = """
name = "block_at_spring"

[ground.markers]
a = [0.25, 0.5]
b = [2, 0]

[bodies.block]
mass = 2
inertia = 0.3
markers = { p = [0.5, 0] }

[springs.stiff]
between = ["ground.a", "block.p"]
stiffness = 30
damping = 0.5
rest = 0.1

[springs.soft]                       # no length at rest and no damping: linear in the coordinates
between = ["ground.b", "block.p"]
stiffness = 3
"""
APART, COINCIDENT = np.array([0.1, 0.2, 0.3]), np.array([-0.25, 0.5, 0.0])
V = np.array([0.4, -0.5, 0.6])


@cache
def scene() -> made.Made:
    return made.make(made.parse(SCENE, "block_at_spring.toml"), complete=True)


def calls(native: Any, k: np.ndarray) -> dict[str, Callable[[np.ndarray], Any]]:
    """The functions that need the direction of the spring, of q."""

    def y(q: np.ndarray, size: int) -> np.ndarray:
        return np.concatenate([q, V, np.zeros(size - 6)])

    functions: dict[str, Callable[[np.ndarray], Any]] = {
        "force": lambda q: native.force(0.0, q, V, k),
        "mass_force": lambda q: native.mass_force(0.0, q, V, k),
        "accel": lambda q: native.accel(0.0, q, V, k),
        "solve": lambda q: native.solve(0.0, q, V, k),
    }
    for name, form in native.dae.items():
        n = form.size
        functions[f"residual {name}"] = lambda q, form=form, n=n: form.residual(0.0, y(q, n), y(q, n), k)
        functions[f"jacobian {name}"] = lambda q, form=form, n=n: form.jacobian(0.0, y(q, n), y(q, n), 1.0, k)
    return functions


def test_functions_that_need_the_direction_return_2() -> None:
    native = scene().native
    for name, call in calls(native, native.setup()).items():
        assert np.all(np.isfinite(np.hstack(call(APART)))), name
        with pytest.raises(ModelError) as caught:
            call(COINCIDENT)
        assert caught.value.code == 2, name


def test_other_functions_do_not_need_it() -> None:
    """The energy of a spring has a kink there, but a value."""
    native = scene().native
    k = native.setup()
    assert np.all(np.isfinite(native.mass(COINCIDENT, k)))
    distance = np.hypot(0.25 - 2.0, 0.5)
    expected = 0.5 * 30 * 0.1**2 + 0.5 * 3 * distance**2
    assert native.energy(COINCIDENT, V, k)[1] == pytest.approx(expected, rel=1e-14)


def test_of_a_batch_only_the_state_itself_fails() -> None:
    native = scene().native
    k = native.setup()
    q, v = np.array([APART, COINCIDENT, APART]), np.array([V, V, V])
    with pytest.raises(ModelError, match="force_batch returned 2"):
        native.force_batch(0.0, q, v, k)
    found = native.accel_batch(0.0, q, v, k, check=False)
    assert np.array_equal(np.isnan(found).all(axis=1), [False, True, False])
    assert np.array_equal(found[0], native.accel(0.0, APART, V, k))


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_generated_python_says_which_spring_it_is() -> None:
    names = scene().python
    k = names["setup"](names["DEFAULTS"])
    with pytest.raises(names["ModelError"], match="the ends of spring stiff coincide") as caught:
        names["force"](0.0, COINCIDENT, V, k)
    assert caught.value.code == 2
    both = names["force"](0.0, np.array([APART, COINCIDENT]), V, k)
    assert np.array_equal(np.isnan(both).all(axis=1), [False, True])


OSCILLATOR = """
name = "oscillator"
ground.markers = { wall = [0.5, 0.25] }
[bodies.mass]
mass = 2
inertia = 1
markers = { centre = [0, 0] }
[joints.guide]
kind = "translational"
between = ["ground.wall", "mass.centre"]
axis = AXIS
start = { displacement = START }
[springs.spring]
between = ["ground.wall", "mass.centre"]
stiffness = 200
damping = DAMPING
rest = 1
[outputs.length]
kind = "distance"
between = ["ground.wall", "mass.centre"]
[outputs.pull]
kind = "spring"
spring = "spring"
[outputs.energy]
kind = "energy"
[simulation]
duration = 0.5
output = 0.01
tolerance = 1e-11
"""


def oscillator(axis: str, start: float, damping: float) -> derive.Trajectory:
    text = OSCILLATOR.replace("AXIS", axis).replace("START", str(start)).replace("DAMPING", str(damping))
    return moved(made.parse(text))


@pytest.mark.parametrize("axis", ["[1, 0]", "[0, 1]", "[3, 4]"])
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("damping", [0, 8])
def test_a_spring_along_its_guide_is_an_oscillator_on_either_side(axis: str, side: int, damping: float) -> None:
    """Where the guide is along an axis, the length is the magnitude of one component, and no root."""
    found = oscillator(axis, 1.2 * side, damping)
    decay, t = damping / 4, found.t
    omega = np.sqrt(100 - decay**2)
    extension = 0.2 * np.exp(-decay * t) * (np.cos(omega * t) + decay / omega * np.sin(omega * t))
    np.testing.assert_allclose(found["mass_s"], side * (1 + extension), rtol=0, atol=1e-9)
    np.testing.assert_allclose(found["length"], 1 + extension, rtol=0, atol=1e-9)
    pull = np.hypot(found["pull_1"], found["pull_2"])
    rate = side * found["mass_sdot"]
    np.testing.assert_allclose(pull, np.abs(200 * extension + damping * rate), rtol=0, atol=1e-6)
    np.testing.assert_allclose(found["energy_strain"], 100 * extension**2, rtol=0, atol=1e-8)


def test_the_force_changes_its_direction_where_the_ends_of_such_a_spring_pass_each_other() -> None:
    """The spring starts 2 m too long, at 3 m: it presses at the wall, from either side, and is as long at the turn."""
    found = oscillator("[1, 0]", 3.0, 0)
    assert found["mass_s"].min() == pytest.approx(-3, abs=0.05)
    np.testing.assert_allclose(found["energy_total"], 400, rtol=1e-6)
    np.testing.assert_allclose(
        found["pull_1"], -200 * np.sign(found["mass_s"]) * (np.abs(found["mass_s"]) - 1), rtol=1e-9
    )
