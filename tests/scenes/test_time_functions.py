"""Tables of values, breaks and parameters of functions of time: interpreter, Python and C, and what integrators do."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import mpmath
import numpy as np
import pytest
from made import Made, close, in_zoo, make, parameters, state
from oracle import Oracle
from scipy.interpolate import CubicSpline

import derive
from conftest import QUICK
from derive.ir.interpreter import interpret
from derive.runtime.loading import load_scene
from derive.spec.files.splines import cubic_spline
from derive.spec.model.scene_functions import breaks
from derive.spec.set_values import with_values
from derive.spec.toml.read import parse
from explicit_motion import moved

STRICT = (*QUICK, "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror")

PUSHED = """
name = "pushed"
ground.markers = {{ origin = [0, 0] }}
{more}
[bodies.block]
mass = 2
inertia = 1
markers = {{ middle = [0, 0] }}
[joints.guide]
kind = "translational"
between = ["ground.origin", "block.middle"]
[forces.push]
at = "block.middle"
components = ["{force}", 0]
[simulation]
duration = 3
output = 0.5
tolerance = 1e-10
"""

TABLES = """
name = "tables"
ground.markers = { origin = [0, 0], far = [2, 0] }
[parameters]
speed = { default = 0.8 }
[tables]
load = { file = "load.csv", x = "t", y = "F" }
lift = { file = "load.csv", x = "t", y = "z" }
[bodies.arm]
mass = 1
inertia = 0.2
markers = { hub = [0, 0], tip = [1, 0] }
[bodies.rod]
mass = 2
inertia = 0.1
markers = { left = [-0.5, 0], right = [0.5, 0] }
[joints.axle]
kind = "revolute"
between = ["ground.origin", "arm.hub"]
[joints.pin]
kind = "revolute"
between = ["arm.tip", "rod.left"]
[drives.motor]
joint = "pin"
motion = "lift(speed*t + 0.1)"
[forces.push]
at = "rod.right"
components = ["2*load(t) - load(3*t)", "load(t)*sin(t)"]
"""

ROWS = [(0.0, 1.0, 0.0), (0.4, 2.5, 0.1), (0.5, -1.0, 0.3), (1.1, 0.3, 0.2), (1.7, 0.2, -0.4), (2.4, 4.0, 0.5)]


@cache
def tables() -> Made:
    with TemporaryDirectory() as folder:
        lines = ["t,F,z", *(",".join(map(str, row)) for row in ROWS)]
        (Path(folder) / "load.csv").write_text("\n".join(lines) + "\n")
        return make(parse(TABLES, str(Path(folder) / "tables.toml")), complete=True)


@pytest.mark.parametrize("count", [2, 3, 4, 5, 40])
def test_a_spline_is_that_of_scipy(count: int) -> None:
    rng = np.random.default_rng(count)
    x, y = np.sort(rng.uniform(-3, 10, count)), rng.normal(size=count)
    spline, exact = cubic_spline("s", x.tolist(), y.tolist()), CubicSpline(x, y)
    inside = rng.uniform(x[0], x[-1], 50)
    for order in range(4):
        close([spline(float(z), order) for z in inside], exact(inside, order), 1e-13)
    assert (spline(x[0] - 1), spline(x[-1] + 1)) == (y[0], pytest.approx(y[-1], rel=1e-14))
    assert spline(x[0] - 1, 1) == spline(x[-1] + 1, 1) == spline(x[-1] + 1, 2) == 0


@pytest.mark.parametrize("seed", [1, 2])
def test_tables_in_c_and_python_are_those_of_the_oracle(seed: int) -> None:
    made = tables()
    native, p = made.native, parameters(made.native, seed)
    k, (t, q, v) = native.setup(p), state(native, seed)
    seen = Oracle(
        made.spec, native.coordinates, native.multipliers, (), dict(zip(native.parameters, p, strict=True))
    ).see(t, q, v)
    close(native.force(t, q, v, k), seen.h, 1e-14)
    close(made.python["force"](t, q, v, k), seen.h, 1e-14)
    close(native.accel(t, q, v, k), seen.vdot, 1e-12)
    close(made.python["accel"](t, q, v, k), seen.vdot, 1e-12)
    assert np.array_equal(native.force_batch(t, q[None], v[None], k)[0], native.force(t, q, v, k))
    times = np.array([-1.0, 0.0, 0.5, 1.3, 2.4, 9.0])
    many = made.python["force"](times, np.tile(q, (6, 1)), np.tile(v, (6, 1)), k)
    close(many, [native.force(time, q, v, k) for time in times], 1e-14)


@pytest.mark.parametrize("name", ["tables", "FUNCTIONS"])
def test_the_interpreter_agrees_in_many_digits(name: str) -> None:
    made = tables() if name == "tables" else in_zoo(name)
    native, kernel = made.native, made.model.kernel("force")
    k, (t, q, v) = native.setup(), state(native, 3)
    functions = {f: getattr(mpmath, f) for f in ("sin", "cos", "sqrt", "exp", "log", "tanh", "atan2")}
    splines = {spline.name: spline for spline in made.model.splines}
    exact = interpret(
        kernel,
        {"t": mpmath.mpf(t), **{n: [mpmath.mpf(float(e)) for e in x] for n, x in (("q", q), ("v", v), ("k", k))}},
        number=lambda x: mpmath.mpf(x.numerator) / x.denominator,
        functions=functions,
        tables=splines,
    )
    close(native.force(t, q, v, k), exact["h"], 1e-14)
    plain = interpret(kernel, {"t": t, "q": q, "v": v, "k": k}, tables=splines)
    close(native.force(t, q, v, k), plain["h"], 1e-14)


def test_strict_compilers_accept_every_function() -> None:
    for made in (tables(), in_zoo("FUNCTIONS")):
        load_scene(made.files, STRICT)


def test_functions_that_jump_are_integrated_exactly_between_their_breaks() -> None:
    """F = 4 N until 1 s, -2 N until 2 s, then 2 N: velocities and positions in closed form, in few steps."""
    scene = parse(PUSHED.format(more="", force="piecewise(t < 1, 4, t < 2, -2, 2)"))
    assert breaks(scene) == (1.0, 2.0)
    found = moved(scene)
    np.testing.assert_allclose(found["block_sdot"], [0, 1, 2, 1.5, 1, 1.5, 2], atol=1e-12)
    np.testing.assert_allclose(found["block_s"], [0, 0.25, 1, 1.875, 2.5, 3.125, 4], atol=1e-12)
    assert found.solution.cost.steps < 30  # 12; without the breaks 65, with stages beyond them 100


@pytest.mark.parametrize(
    ("force", "times"),
    [
        ("step(t, 0.3, 0.9)", (0.3, 0.9)),
        ("abs(2*t - 1) + max(t/4, 0.5) - min(1 - t, t, 0.4)", (0.4, 0.5, 0.6, 2.0)),
        ("max(sin(t), cos(t)) + abs(t^2 - 2)", (np.pi / 4, np.sqrt(2))),
        ("abs(sin(2*pi*t))", (0.5, 1.0, 1.5, 2.0, 2.5)),
        ("max(1 - exp(-t), 0.75, 0)", (np.log(4),)),
        ("abs(t^2) + min(0, t^2 - 2*t + 1) + 0*max(log(t - 5), 1)", ()),  # touching, at an end, without a value
    ],
)
def test_breaks_of_functions(force: str, times: tuple[float, ...]) -> None:
    """Within rounding errors; of 3 s."""
    assert breaks(parse(PUSHED.format(more="", force=force))) == pytest.approx(times, rel=1e-14)


def test_functions_with_kinks_are_integrated_exactly_between_them() -> None:
    """2 x'' = max(t^2 - 1, 0): polynomials, which methods of high order integrate exactly if they stop at 1 s."""
    found = moved(parse(PUSHED.format(more="", force="max(t^2 - 1, 0)")))
    late = np.maximum(found.t, 1)
    np.testing.assert_allclose(found["block_sdot"], (late**3 / 3 - late + 2 / 3) / 2, rtol=0, atol=1e-13)
    assert found["block_s"][-1] == pytest.approx(2, abs=1e-13)
    assert found.solution.cost.steps < 30


def test_breaks_depend_on_parameters() -> None:
    more = "[parameters]\nT1 = { default = 0.5, unit = 's' }\nF1 = { default = 3, unit = 'N' }"
    scene = parse(PUSHED.format(more=more, force="F1*piecewise(t < T1, 1, t < 3*T1, 2, 0)"))
    assert breaks(scene) == (0.5, 1.5) and breaks(scene, {"T1": 0.25}) == (0.25, 0.75)
    assert derive.validated(scene) == scene
    changed, (change,) = with_values(scene, {"T1": "0.25"})
    assert breaks(changed) == (0.25, 0.75) and str(change) == "parameters.T1: 0.5 s -> 0.25, the parameter T1"
    # 2 x'' = 3 until T1 and 6 until 3 T1: the speed is 1.5 T1 + 3 * 2 T1.
    assert moved(scene)["block_sdot"][-1] == pytest.approx(7.5 * 0.5, rel=1e-9)
    assert moved(changed)["block_sdot"][-1] == pytest.approx(7.5 * 0.25, rel=1e-9)


def test_a_smooth_step_has_its_integral() -> None:
    """The step is from 0 to 1 between 0.5 s and 1.5 s: 2 x'' = 6 step; its integral is half of its width."""
    found = moved(parse(PUSHED.format(more="", force="6*step(t, 0.5, 1.5)")))
    np.testing.assert_allclose(found["block_sdot"][[0, 1, 3, 6]], [0, 0, 1.5, 6], atol=1e-10)
