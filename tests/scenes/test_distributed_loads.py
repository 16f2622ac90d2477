"""Distributed loads against the bending of a cantilever, and section forces under them."""

from __future__ import annotations

import pytest

from derive.errors import SpecError
from derive.spec.toml.read import parse
from explicit_motion import moved

CANTILEVER = """
name = "cantilever"
ground.markers = {{ wall = [0, 0] }}
[scene]
start = "equilibrium"
[bodies.rod]
frame = {{ kind = "tangent", at = -1 }}
ansatz = ["1", "xi", "xi^2", "xi^3", "xi^4", "xi^5"]
mass = 1
length = {{ symbol = "l", default = {length} }}
bending_stiffness = {bending}
markers = {{ root = -1, middle = 0, tip = 1 }}
[bodies.rod.loads.q]
force = {force}
{more}
[joints.clamp]
kind = "fixed"
between = ["ground.wall", "rod.root"]
[outputs]
tip = {{ kind = "position", marker = "rod.tip" }}
root_moment = {{ kind = "bending_moment", section = "rod.root" }}
middle_moment = {{ kind = "bending_moment", section = "rod.middle" }}
middle_shear = {{ kind = "shear_force", section = "rod.middle" }}
[simulation]
duration = 1e-3
output = 1e-3
"""

LENGTH, BENDING, Q = 2.0, 5000.0, 3.0


def cantilever(force: str, more: str = "") -> dict[str, float]:
    """The outputs at rest."""
    scene = parse(CANTILEVER.format(length=LENGTH, bending=BENDING, force=force, more=more))
    found = moved(scene)
    return {name: found[name][0] for name in found.columns}


@pytest.mark.parametrize("frame", [pytest.param("inertial", marks=pytest.mark.long), "body"])
def test_a_uniform_load_bends_a_cantilever_by_q_l4_over_8_ei(frame: str) -> None:
    at = cantilever(f"[0, {Q}]", f'frame = "{frame}"')
    assert at["tip_2"] == pytest.approx(Q * LENGTH**4 / (8 * BENDING), rel=1e-6)
    for end, distance in (("root", LENGTH), ("middle", LENGTH / 2)):
        moment = Q * distance**2 / 2
        assert at[f"{end}_moment"] == pytest.approx(moment, rel=1e-5)
        assert at[f"{end}_moment_curvature"] == pytest.approx(moment, rel=1e-5)
    assert abs(at["middle_shear"]) == pytest.approx(Q * LENGTH / 2, rel=1e-5)


def test_the_factor_of_a_load_may_be_a_run_time_input_that_nothing_else_uses() -> None:
    at = cantilever("[0, 1]", f'time = {{ input = "u" }}\n[inputs.u]\nvalue = {Q}')
    assert at["tip_2"] == pytest.approx(cantilever(f"[0, {Q}]")["tip_2"], rel=1e-9)
    with pytest.raises(SpecError, match=r'bodies.rod.loads.q.time: there is no input "v"; the inputs are u'):
        cantilever("[0, 1]", 'time = { input = "v" }\n[inputs.u]')


def test_a_triangular_load_that_grows_towards_the_tip() -> None:
    """q (1 + xi)/2 bends the tip by 11 q l^4/(120 EI), and the moment at the wall is q l^2/3."""
    at = cantilever(f'[0, "{Q}*(1 + xi)/2"]')
    assert at["tip_2"] == pytest.approx(11 * Q * LENGTH**4 / (120 * BENDING), rel=1e-6)
    assert at["root_moment"] == pytest.approx(Q * LENGTH**2 / 3, rel=1e-5)


def test_loads_that_mean_nothing_are_refused() -> None:
    with pytest.raises(SpecError, match="both components of the load are zero"):
        cantilever("[0, 0]")
    with pytest.raises(SpecError, match=r'bodies.rod.loads.q.force.1.: column 1 of "t": "t" is unknown here'):
        cantilever('[0, "t"]')
    with pytest.raises(SpecError, match=r'bodies.rod.loads.q.tine: unknown key; did you mean "time"'):
        cantilever("[0, 1]", "tine = 3")
    with pytest.raises(SpecError, match='`frame` is one of "inertial", "body"'):
        cantilever("[0, 1]", 'frame = "world"')
