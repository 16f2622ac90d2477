"""The generalised-alpha method in space: its order, damping, quaternions and constraints that hold, its formulas."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import fsolve
from scipy.spatial.transform import Rotation
from test_space_modes import HANGING as HANGING_BODY
from test_space_motions import KEPT, NUTATING, top_scene
from toolchain import run

from conftest import ROOT
from derive.generated_models import generated
from derive.runtime.integrators.c_integrator import Integration
from derive.runtime.integrators.compilation import program
from derive.runtime.integrators.generalised_alpha import GeneralisedAlpha
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import constraint_matrix, mass_matrix
from derive.simulation.scene_start import state_of
from derive.spec.model.specification import AnyScene
from derive.spec.toml.read import parse
from explicit_motion import moved

EXACT = 1e-13
"""The tolerance of Newton's method: rounding errors of its steps would otherwise hide the order of the method."""


@cache
def host_of(text: str) -> tuple[AnyScene, GeneralisedAlpha]:
    """The method, compiled with the model of a scene."""
    scene = parse(text)
    assert isinstance(scene, AnyScene)
    return scene, GeneralisedAlpha(generated(scene)[1], ["-O1"])


def integrated(text: str, duration: float, steps: int, rows: int = 1, **options: float) -> Integration:
    """The motion of a scene from its initial state."""
    scene, host = host_of(text)
    state = state_of(scene, host.native)
    chosen = {"tolerance": EXACT, **options}
    return host.run(state.q, state.v, step=duration / steps, steps=steps, every=steps // rows, **chosen)


def quaternions(native: NativeScene, q: Vector, body: str) -> Vector:
    """The quaternion (rows, 4) of a body."""
    first = native.coordinates.index(f"{body}_e0")
    return q[:, first : first + 4]


TOP = top_scene(NUTATING, 0.5, KEPT)
"""The heavy symmetric top, with all coordinates and three constraints."""


@pytest.mark.parametrize(
    ("extra", "rho"),
    [
        pytest.param("", 0.0, id="minimal"),
        pytest.param(KEPT, 0.8, id="constrained"),
        pytest.param("", 0.8, id="minimal, little damping", marks=pytest.mark.long),
        pytest.param(KEPT, 0.0, id="constrained, much damping", marks=pytest.mark.long),
    ],
)
def test_order_is_two_on_the_heavy_symmetric_top(rho: float, extra: str) -> None:
    """Its attitude is that of the closed form to the square of the step; so are the forces of its joint."""
    text = top_scene(NUTATING, 0.5, extra)
    exact, errors = NUTATING.rotations([0.5])[0], []
    native = host_of(text)[1].native
    reference = integrated(text, 0.5, 20000, rho=rho) if extra else None
    for steps in (1000, 2000):
        found = integrated(text, 0.5, steps, rho=rho)
        R = Rotation.from_quat(quaternions(native, found.q, "top")[-1], scalar_first=True).as_matrix()
        errors.append([np.abs(R - exact).max()])
        if reference is not None:
            errors[-1].append(np.abs(found.lam[-1] - reference.lam[-1]).max())
            assert np.abs(native.constraints(0.5, found.q[-1], native.setup())).max() < EXACT
    assert errors[-1][0] < 5e-5
    assert np.log2(np.divide(*errors)) == pytest.approx(2.0, abs=0.1)


def test_newtons_method_knows_how_rotation_vectors_turn_a_body() -> None:
    """Steps of 0.6 rad take few iterations: without the tangent operator twice as many."""
    counts = integrated(TOP, 0.5, 20).counts
    assert counts["steps"] == 20 and counts["residuals"] < 200


@pytest.mark.parametrize(
    ("example", "duration", "steps", "error"),
    [
        pytest.param("spatial_crank_slider_rigid", 0.5, 1000, 6e-5, marks=pytest.mark.long),
        pytest.param("spatial_crank_slider", 0.02, 2000, 1e-6, marks=pytest.mark.long),
    ],
)
def test_order_is_two_on_slider_cranks(example: str, duration: float, steps: int, error: float) -> None:
    """Of rigid bodies, and with a finite-element rod; joints are met to rounding."""
    text = (ROOT / "examples" / f"{example}.toml").read_text()
    folder = str(ROOT / "examples")
    text = text.replace('nodes = "', f'nodes = "{folder}/')
    scene, host = host_of(text)
    expected = moved(scene, duration=duration, output=duration, tolerance=1e-12).motion.q[-1]
    errors = []
    for count in (steps, 2 * steps):
        found = integrated(text, duration, count)
        errors.append(np.abs(found.q[-1] - expected).max())
        assert np.abs(host.native.constraints(duration, found.q[-1], host.native.setup())).max() < EXACT
    assert errors[0] < error and np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize(
    "keep",
    [
        pytest.param("", id="minimal", marks=pytest.mark.long),
        pytest.param("keep_coordinates = true", id="constrained"),
    ],
)
def test_damping_of_what_the_step_cannot_follow(keep: str) -> None:
    """A hanging body that swings by 10 microradians in a gravity so strong that a step takes 60 periods.

    Its amplitude falls by the factor rho per step, its energy by rho^2; with rho = 1 nothing is lost.
    """
    strong = HANGING_BODY.replace("-9.81", "-1e5").replace("KEEP", keep)
    text = strong.replace("rotation = [1, 0, 0, 0]", "rotation = { axis = [1, 0, 0], angle = 1e-5 }")
    native = host_of(text)[1].native
    left = {}
    for rho in (0.0, 0.5, 1.0):
        found = integrated(text, 20.0, 20, 20, rho=rho, tolerance=1e-11)
        left[rho] = 2 * np.linalg.norm(quaternions(native, found.q, "body")[:, 1:], axis=1) / 1e-5
    assert left[1.0][10] > 0.99
    assert 0.5**10 < left[0.5][10] < 100 * 0.5**10
    assert left[0.5][20] < 1000 * 0.5**20
    assert left[0.0][5] < 1e-3


@pytest.mark.long
def test_quaternions_and_constraints_after_many_steps() -> None:
    """1e4 steps, 40 turns: lengths are 1 and joints are met to rounding, in each row."""
    native, found = host_of(TOP)[1].native, integrated(TOP, 10.0, 10_000, 1000)
    k = native.setup()
    assert np.abs(np.linalg.norm(quaternions(native, found.q, "top"), axis=1) - 1).max() < 4e-16
    assert max(np.abs(native.constraints(0.0, q, k)).max() for q in found.q) < EXACT


@dataclass(frozen=True)
class LieGroupStep:
    """A step of a free rigid body with constraints: q (7,), v (6,), vdot (6,), lambda, and the auxiliary a (6,)."""

    q: Vector
    v: Vector
    vdot: Vector
    lam: Vector
    a: Vector

    def next(self, native: NativeScene, h: float, rho: float) -> LieGroupStep:
        """The next step, of length h (s), by the formulas of Bruels and Cardona, solved by differences."""
        k = native.setup()
        alpha_m, alpha_f = (2 * rho - 1) / (rho + 1), rho / (rho + 1)
        gamma = 0.5 + alpha_f - alpha_m
        beta = (gamma + 0.5) ** 2 / 4

        def after(unknown: Vector) -> LieGroupStep:
            vdot, lam = unknown[:6], unknown[6:]
            a = ((1 - alpha_f) * vdot + alpha_f * self.vdot - alpha_m * self.a) / (1 - alpha_m)
            x = h * self.v + h * h * ((0.5 - beta) * self.a + beta * a)
            turned = Rotation.from_quat(self.q[3:], scalar_first=True) * Rotation.from_rotvec(x[3:])
            q = np.concatenate([self.q[:3] + x[:3], turned.as_quat(scalar_first=True)])
            return LieGroupStep(q, self.v + h * ((1 - gamma) * self.a + gamma * a), vdot, lam, a)

        def missed(unknown: Vector) -> Vector:
            to = after(unknown)
            M, G = mass_matrix(native, to.q, k), constraint_matrix(native, 0.0, to.q, k)
            balance = M @ to.vdot + native.force(0.0, to.q, to.v, k) - G.T @ to.lam
            return np.concatenate([balance, native.constraints(0.0, to.q, k) / h**2])

        return after(fsolve(missed, np.concatenate([self.vdot, self.lam]), xtol=1e-10))


def test_its_formulas_are_those_of_a_lie_group() -> None:
    """The C code against a transcription without a Newton matrix, whose rotations are those of SciPy."""
    scene, host = host_of(TOP)
    native, state, h, rho = host.native, state_of(scene, host.native), 5e-3, 0.7
    found = host.run(state.q, state.v, step=h, steps=12, rho=rho, tolerance=EXACT, consistent=0.0)
    vdot, lam = native.solve(0.0, state.q, state.v, native.setup())
    step = LieGroupStep(state.q, state.v, vdot, lam, vdot)
    for q, v, lam in zip(found.q[1:], found.v[1:], found.lam[1:], strict=True):
        step = step.next(native, h, rho)
        assert np.abs(step.q * np.sign(step.q[3]) - q * np.sign(q[3])).max() < 1e-9
        assert np.abs(step.v - v).max() < 1e-7
        assert np.abs(step.lam - lam).max() < 1e-6 * np.abs(lam).max()


def test_the_program_in_c_takes_the_same_steps(tmp_path: Path) -> None:
    """The embedded program of the host templates, and the function that Python calls."""
    scene, host = host_of(TOP)
    state = state_of(scene, host.native)
    made = program(generated(scene)[1], tmp_path / "top", ["alpha"], ["-O1"])
    start = tmp_path / "start.txt"
    start.write_text(" ".join(f"{x:.17g}" for x in [*state.q, *state.v]))
    run(made, "alpha", start, "0.1", "0.01", "1e-3", tmp_path / "out.bin")
    rows = np.fromfile(tmp_path / "out.bin").reshape(11, -1)
    found = host.run(state.q, state.v, step=1e-3, steps=100, every=10)
    assert rows[:, 1:] == pytest.approx(np.hstack([found.q, found.v, found.lam]), rel=1e-10, abs=1e-10)
