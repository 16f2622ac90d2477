"""Static equilibrium by Newton's method: closed forms of statics, stability, and loads that nothing balances."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from compiled import Compiled, compiled

from derive.simulation import equilibrium as module
from derive.simulation.equilibrium import Equilibrium, Stability, equilibrium
from derive.simulation.errors import NoEquilibrium
from derive.spec.toml.read import parse

G, LENGTH, MASS, EI = 9.81, 2.0, 0.5, 50.0
GRAVITY = f"[scene]\ngravity = [0, -{G}]\n"
ROD = f"[bodies.rod]\nmass = {MASS}\ninertia = {MASS * LENGTH**2 / 12}\nmarkers = {{ top = [{-LENGTH / 2}, 0] }}\n"
EI_LINE = f"bending_stiffness = {EI}\n"
BEAM = (
    f'[bodies.beam]\nframe = "mean"\nansatz = ["1", "xi", "xi^2", "xi^3", "xi^4"]\nmass = {MASS}\nlength = {LENGTH}\n'
    f"{EI_LINE}markers = {{ root = -1, tip = 1 }}\n"
)


def joint(kind: str, second: str) -> str:
    return f'[ground.markers]\na = [0, 0]\n[joints.a]\nkind = "{kind}"\nbetween = ["ground.a", "{second}"]\n'


@cache
def made(text: str) -> Compiled:
    return compiled(parse(f'name = "statics"\n{text}'), complete=True)


def found(text: str, *guess: float) -> Equilibrium:
    scene = made(text)
    q = np.zeros(scene.native.nq)
    q[: len(guess)] = guess
    return equilibrium(scene.native, scene.k, q)


@pytest.mark.parametrize("angle", [0.0, 1.0, 1.57, 3.5])
def test_a_pendulum_comes_to_hang_from_any_angle(angle: float) -> None:
    """Its eigenvalue is the square of its natural frequency, 3 g/(2 l)."""
    result = found(GRAVITY + ROD + joint("revolute", "rod.top"), angle)
    assert np.cos(result.q[0] + np.pi / 2) == pytest.approx(1.0, abs=1e-12)
    assert result.eigenvalues == pytest.approx([1.5 * G / LENGTH], rel=1e-12)
    assert result.stability is Stability.STABLE and result.residual < 1e-12 * result.load


def test_a_beam_that_stretches_swings_down_in_few_iterations() -> None:
    """A finite rotation must not stretch it, or its axial stiffness would keep each step below .03 rad."""
    pieces = BEAM.replace(EI_LINE, f'{EI_LINE}pieces = 2\naxial = {{ ansatz = ["xi"], stiffness = 1e6 }}\n')
    result = found(GRAVITY + pieces + joint("revolute", "beam.root"), LENGTH / 4, 0, 0, 0, 0, 0, 0, 3 * LENGTH / 4)
    assert result.stability is Stability.STABLE and result.load_steps == 1 and result.iterations < 30


def test_an_inverted_pendulum_is_an_unstable_equilibrium() -> None:
    result = found(GRAVITY + ROD + joint("revolute", "rod.top"), np.pi / 2)
    assert result.q == pytest.approx([np.pi / 2], abs=1e-12)
    assert result.eigenvalues == pytest.approx([-1.5 * G / LENGTH], rel=1e-12)
    assert result.stability is Stability.UNSTABLE and result.softest == ("rod_phi",)


def test_a_cantilever_bends_under_its_weight() -> None:
    """The quartic is exact: the tip falls by q l^4/(8 EI) along a weight of q l; the clamp carries q l and q l^2/2."""
    weight = 1e-3 * G
    result = found(GRAVITY.replace(f"{G}", f"{weight}") + BEAM + joint("weld", "beam.root"), LENGTH / 2)
    scene = made(GRAVITY.replace(f"{G}", f"{weight}") + BEAM + joint("weld", "beam.root"))
    tip, _, _ = scene.native.marker("beam_tip", result.q, np.zeros(scene.native.nv), scene.k)
    assert tip[1] == pytest.approx(-MASS * weight * LENGTH**3 / (8 * EI), rel=1e-6)
    assert result.lam[1:] == pytest.approx([MASS * weight, MASS * weight * LENGTH / 2], rel=1e-6)
    assert result.stability is Stability.STABLE
    assert np.sqrt(result.eigenvalues[0] * MASS * LENGTH**3 / EI) == pytest.approx(3.5160, abs=2e-3)


def test_a_free_beam_is_in_neutral_equilibrium() -> None:
    result = found(BEAM)
    assert result.stability is Stability.NEUTRAL
    assert np.abs(result.eigenvalues[:3]).max() < 1e-9 * result.eigenvalues[3]


def test_a_load_that_nothing_balances_is_named() -> None:
    with pytest.raises(NoEquilibrium, match="loads keep moving beam_c2"):
        found(GRAVITY + BEAM)


def test_loads_are_applied_in_steps_where_one_does_not_converge(monkeypatch: pytest.MonkeyPatch) -> None:
    """With few iterations allowed, the whole weight cannot be balanced at once, but its quarters can."""
    text = GRAVITY + ROD + joint("revolute", "rod.top")
    at_once = found(text, -0.2)
    monkeypatch.setattr(module, "ITERATIONS", at_once.iterations - 1)
    in_steps = found(text, -0.2)
    assert at_once.load_steps == 1 < in_steps.load_steps
    assert in_steps.q == pytest.approx(at_once.q, abs=1e-12)
