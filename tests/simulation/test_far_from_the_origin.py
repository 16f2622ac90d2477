"""Mechanisms far from the origin, where constraints are differences of large positions and can be met less exactly."""

from __future__ import annotations

import os
from dataclasses import replace
from importlib.util import find_spec

import numpy as np
import pytest
from double import Body, Condition, Double, Pin, Slide
from mechanisms import CRANK, ROD, crank_slider, pushed_crank

from derive.runtime.integrators.compilation import LibraryMissing
from derive.simulation.constraints.neighbouring_states import neighbouring_states
from derive.simulation.constraints.projection import check_drift
from derive.simulation.constraints.redundancy import check_constraints
from derive.simulation.errors import DriftTooLarge, SingularConfiguration
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse
from explicit_motion import moved

NONE = np.zeros(0)
EARTH = 7e6
"""m: about the distance of a satellite from the centre of the Earth."""


def double_pendulum(x: float) -> Scene:
    """A rigid rod and a beam that hang from (x, 0) and begin to move from an inclined position, in SI units."""
    scene = parse(
        f"""
name = "far"
[scene]
gravity = [0, -9.81]
[ground.markers]
o = [{x}, 0]
[bodies.a]
mass = 1
inertia = 0.1
keep_coordinates = true
markers = {{ p = [-0.5, 0], q = [0.5, 0] }}
start = {{ position = [{x + 0.4}, 0.3], angle = 0.6, guess = true }}
[bodies.b]
mass = 1
length = 1
bending_stiffness = 100
markers = {{ p = -1, q = 1 }}
start = {{ position = [{x + 1.2}, 0.9], angle = 0.6, guess = true }}
[joints.j1]
kind = "revolute"
between = ["ground.o", "a.p"]
[joints.j2]
kind = "revolute"
between = ["a.q", "b.p"]
[simulation]
duration = 0.3
output = 0.1
tolerance = 1e-7
"""
    )
    assert isinstance(scene, Scene)
    return scene


@pytest.mark.parametrize(
    ("integrator", "step"),
    [
        ("adaptive", None),
        ("dop853", None),
        pytest.param("rk45", None, marks=pytest.mark.long),
        pytest.param("ida", None, marks=pytest.mark.long),
        ("c_ida", None),
        ("rk4", 1e-3),
        ("generalised-alpha", 1e-2),
    ],
)
def test_a_mechanism_moves_alike_wherever_it_is(integrator: str, step: float | None) -> None:
    """Positions are rounded to 1e-9 m there. Absolute tolerances are not below that: otherwise Newton's method of IDA
    would not converge; nor are those of the generalised-alpha method a part of the position, 7e-5 m."""
    if integrator == "ida" and not find_spec("sksundae") and not os.environ.get("CI"):
        pytest.skip("no scikit-sundae")
    try:
        near, far = (moved(double_pendulum(x), integrator=integrator, step=step, tolerance=1e-9) for x in (0.0, EARTH))
    except LibraryMissing as error:
        if os.environ.get("CI"):
            raise
        pytest.skip(str(error).splitlines()[0])
    limit = 3e-7
    assert far.q[:, 2] == pytest.approx(near.q[:, 2], abs=limit)
    assert far.q[:, 0] - EARTH == pytest.approx(near.q[:, 0], abs=limit)
    assert far.solution.drift[:, 0].max() < 1e-8
    noted = "tolerance: 1e-09 -> 1.4e-08 absolute, as coordinates of up to 7e+06 are rounded to 9e-10"
    notes = [[text for text in run.solution.notes if "step: 0.01 s is too coarse" not in text] for run in (near, far)]
    assert notes == [[], [] if step else [noted]]  # 10 ms are coarse for the beams, which both runs say
    assert len(near.solution.notes) == (integrator == "generalised-alpha")


@pytest.mark.parametrize("integrator", ["adaptive", "dop853", "ida", "c_ida"])
def test_a_small_mechanism_moves_as_exactly_as_a_large_one(integrator: str) -> None:
    """A block on a spring, s = a cos(omega t), with a of 1 m or of 1 micrometre: relative errors are alike."""
    if integrator == "ida" and not find_spec("sksundae") and not os.environ.get("CI"):
        pytest.skip("no scikit-sundae")
    errors = []
    for size in (1.0, 1e-6):
        try:
            found = moved(block_on_a_spring(size), integrator=integrator)
        except LibraryMissing as error:
            if os.environ.get("CI"):
                raise
            pytest.skip(str(error).splitlines()[0])
        errors.append(np.abs(found["block_s"] / size - np.cos(2 * found.t)).max())
    assert errors[0] < 1e-5 and errors[1] < 3 * errors[0] + 1e-7


def block_on_a_spring(size: float) -> Scene:
    """A block of 1 kg on a guide, which starts at `size` (m), with a spring of 4 N/m."""
    scene = parse(
        f"""
name = "swing"
ground.markers = {{ o = [0, 0] }}
[bodies.block]
mass = 1
inertia = 1
markers = {{ m = [0, 0] }}
start = {{ position = [{size}, 0] }}
[joints.guide]
kind = "translational"
between = ["ground.o", "block.m"]
[springs.s]
kind = "bushing"
between = ["ground.o", "block.m"]
stiffness_x = 4
[simulation]
duration = 10
output = 1
tolerance = 1e-7
"""
    )
    assert isinstance(scene, Scene)
    return scene


def shifted(model: Double, q: np.ndarray, x: float) -> tuple[Double, np.ndarray]:
    """A mechanism and its configuration, moved by x along e1."""
    conditions: list[Condition] = []
    for c in model.conditions:
        if isinstance(c, Pin) and c.first is None:
            conditions.append(replace(c, at_first=(c.at_first[0] + x, c.at_first[1])))
        elif isinstance(c, Slide):
            position, *rates = c.motion
            conditions.append(replace(c, motion=(lambda t, f=position: f(t) + x, *rates)))
        else:
            conditions.append(c)
    bodies = tuple(Body(name, *model.diagonal[3 * i + 1 : 3 * i + 3]) for i, name in enumerate(model.bodies))
    return Double(bodies, tuple(conditions)), q + x * np.tile([1, 0, 0], len(bodies))


def test_a_dead_centre_is_no_redundancy_wherever_it_is() -> None:
    """Neighbouring states are as far away as the mechanism is large, not as its coordinates are."""
    model, q, _ = pushed_crank(CRANK + ROD, -1.0)
    far, q_far = shifted(model, q, EARTH)
    with pytest.raises(SingularConfiguration, match="dead centre"):
        check_constraints(far, NONE, 0.0, q_far)
    model, q, _ = pushed_crank(CRANK + ROD - 1e-3, -1.0)
    far, q_far = shifted(model, q, EARTH)
    check_constraints(far, NONE, 0.0, q_far)


@pytest.mark.parametrize(
    ("x", "off", "raised"), [(0, 2e-9, True), (0, 0.5e-9, False), (EARTH, 1e-8, False), (EARTH, 1e-7, True)]
)
def test_the_tolerance_of_drift_allows_for_rounding(x: float, off: float, raised: bool) -> None:
    """Beside the tolerance of 1e-9 m, 9 units in the last place of the largest coordinate."""
    model, q, v = crank_slider(speed=0.0, angle=0.5)
    far, q = shifted(model, q, x)
    q[1] += off
    if raised:
        with pytest.raises(DriftTooLarge, match="position of constraint"):
            check_drift(far, NONE, 0.0, q, 0 * v, 1e-9)
    else:
        assert check_drift(far, NONE, 0.0, q, 0 * v, 1e-9).position == pytest.approx(off, rel=0.3)


def test_neighbouring_states_are_as_near_wherever_the_mechanism_is() -> None:
    """Their distance is a part of the arms of the mechanism, which its drive has moved after the same time."""
    model, q, _ = pushed_crank(CRANK + ROD - 0.05, -1.0)
    far, q_far = shifted(model, q, EARTH)
    near = [*neighbouring_states(model, NONE, 0.0, q)]
    assert len(near) > 1 and max(abs(t) for t, _ in near) > 0
    for (t, state), (t_far, state_far) in zip(near, neighbouring_states(far, NONE, 0.0, q_far), strict=True):
        assert t_far == t
        assert state_far - q_far == pytest.approx(state - q, abs=1e-6)
