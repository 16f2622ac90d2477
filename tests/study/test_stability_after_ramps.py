"""Stability about the steady motions that ramps of drives, loads and inputs lead to."""

from __future__ import annotations

from pathlib import Path

import pytest
from test_stability_of_models import CANTILEVER, COLUMN, EULER, FIRST, SECOND, polynomials

from derive.simulation.linear.settled_functions import settled_functions
from derive.spec.model.scene import Scene
from derive.spec.model.time_function import depends_on_time, value_at
from derive.spec.toml.read import parse
from derive.study.stability.model_path import model_path
from derive.study.stability.parameter import ParameterRange, studied

RAMPS = {
    "speed": 'speed = "Omega*step(t, 0, 0.3)"',
    "motion": 'motion = "Omega*piecewise(t < 0.3, 0.3*((t/0.3)^6 - 3*(t/0.3)^5 + 2.5*(t/0.3)^4), t - 0.15)"',
    "table": 'speed = "Omega*ramp(t)"',
    "constant": 'speed = "Omega"',
}


def driven(drive: str, parameter: str, more: str = "") -> str:
    """The rotating cantilever with another drive."""
    text = CANTILEVER.read_text()
    constant = next(line for line in text.splitlines() if line.startswith("speed ="))
    return f"{text.replace(constant, drive)}\n[parameters]\n{parameter} = {{ default = 0.4 }}\n{more}"


@pytest.mark.parametrize(
    "ramp", ["speed", *(pytest.param(of, marks=pytest.mark.long) for of in RAMPS if of != "speed")]
)
def test_a_ramp_is_linearised_about_the_steady_motion_that_it_leads_to(tmp_path: Path, ramp: str) -> None:
    (tmp_path / "ramp.csv").write_text("t,w\n0,0\n0.1,0.3\n1,1\n")
    table = '[tables]\nramp = { file = "ramp.csv", x = "t", y = "w" }\n' if ramp == "table" else ""
    scene = parse(driven(RAMPS[ramp], "Omega", table), str(tmp_path / "ramp.toml"))
    assert isinstance(scene, Scene)
    parameter = studied(scene, ParameterRange("Omega", 0, 10, 3))
    made = model_path(parameter, polynomials(2, FIRST, "tangent"))
    assert made.loss == pytest.approx(3.532732, rel=1e-6)
    assert [point.eigenvalues.spin for point in made.points if point.eigenvalues] == pytest.approx([0, 5, 10])
    if ramp == "constant":
        assert parameter.motion.endswith("at each value, in axes that rotate along")
    else:
        key, time = "motion" if ramp == "motion" else "speed", 1 if ramp == "table" else 0.3
        text = f"with drives.motor.{key} as from t = {time:g} s on, when nothing changes any more"
        assert parameter.motion.endswith(text)


def test_loads_and_inputs_that_come_to_rest_have_their_last_values() -> None:
    """Euler's load of a column, applied smoothly, as a function and as an input."""
    text, losses = COLUMN.read_text(), []
    for load in ('["-P", 0]', '["-P*step(t, 0, 0.5)", 0]', '[{ input = "press" }, 0]'):
        press = '[inputs.press]\nvalue = "-P*step(t, 0, 0.5)"\n' if "input" in load else ""
        scene = parse(text.replace('["-P", 0]', load) + press)
        assert isinstance(scene, Scene)
        losses.append(model_path(studied(scene, ParameterRange("P", 0, 30, 4)), polynomials(1, SECOND)).loss)
    assert losses[0] is not None and EULER < losses[0] < 1.3 * EULER
    assert losses[1:] == pytest.approx([losses[0]] * 2, rel=1e-9)


def test_a_drive_that_stops_stays_where_it_is() -> None:
    scene = parse(driven('motion = "turn*step(t, 0, 0.3)"', "turn"))
    assert isinstance(scene, Scene)
    functions = settled_functions([scene, scene])
    (drive,) = functions.scene(scene).drives
    assert functions.settled == ("drives.motor.motion",) and functions.stopping == {"motor"}
    assert drive.motion is not None and not depends_on_time(drive.motion)
    assert value_at(drive.motion, 0.0) == 0.4
