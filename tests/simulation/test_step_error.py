"""The note on a step of the generalised-alpha method that is too coarse: it has the true error, else it is silent."""

from __future__ import annotations

import re
from functools import cache

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive.runtime.integrators.compilation import klu
from derive.simulation.errors import SimulationError
from derive.simulation.integration.step_error import ALLOWED

try:
    klu()
except derive.TisserandError as missing:
    pytest.skip(str(missing).splitlines()[0], allow_module_level=True)

END = 2.0  # s


@cache
def pendulum() -> derive.AnyScene:
    """A rigid pendulum that falls from the level position, in 1.1 s once to and fro."""
    return derive.scene(
        "pendulum",
        gravity=(0, -10),
        bodies={"rod": {"mass": 1, "inertia": 0.02, "markers": {"end": [-0.4, 0]}, "start": {"position": [0.4, 0]}}},
        ground={"o": (0, 0)},
        joints={"pin": {"kind": "revolute", "between": ["ground.o", "rod.end"]}},
    )


@cache
def run(integrator: str, step: float | None = None, output: float = 0.5, until: str = "") -> derive.Trajectory:
    more = {"until": until} if until else {}
    return derive.simulate(pendulum(), duration=END, output=output, integrator=integrator, step=step, **more)


def noted(found: derive.Trajectory) -> str:
    return "\n".join(text for text in found.notes if "too coarse" in text)


@pytest.mark.parametrize(("step", "output"), [(0.04, 0.5), (None, 0.5), (0.05, 0.05)])
def test_the_error_is_the_true_one(step: float | None, output: float) -> None:
    """A step as long as the rows are apart is compared with a shorter one."""
    found, exact = run("generalised-alpha", step, output), run("adaptive", None, output)
    text = noted(found)
    name, percent = re.search(r"too coarse: (\w+) is wrong by about ([\d.]+) %", text).groups()
    true = np.abs(found[name] - exact[name]).max() / np.abs(exact[name] - exact[name][0]).max()
    assert true > ALLOWED and float(percent) / 100 == pytest.approx(true, rel=0.2), text
    assert ("twice" if step == output else "half") in text


def test_the_step_that_is_proposed_is_fine_enough() -> None:
    text = noted(run("generalised-alpha"))
    proposed = float(re.search(r"--step ([\d.e-]+)", text).group(1))
    found, exact = run("generalised-alpha", proposed), run("adaptive")
    assert np.abs(found["rod_phi"] - exact["rod_phi"]).max() < 1.2 * ALLOWED * np.abs(exact["rod_phi"]).max()
    assert not noted(run("generalised-alpha", proposed / 2))


def test_runs_that_end_early_and_the_rows_are_those_without_the_note() -> None:
    """The second run has no condition: it follows the rows of the first."""
    stopped = run("generalised-alpha", 0.05, 0.1, until="rod_phi < -1")
    assert "met at t" in stopped.notes[-1] and noted(stopped)
    whole = run("generalised-alpha", 0.05, 0.1)
    rows = len(stopped.t) - 1
    assert np.array_equal(stopped.q[:rows], whole.q[:rows])
    assert whole.solution.cost.steps == 40


def test_a_default_step_that_fails_proposes_another_one() -> None:
    beams = derive.read(ROOT / "scenes/double_pendulum.toml")
    with pytest.raises(SimulationError, match=r"shorter steps than 1 s may pass, such as --step 0\.1;"):
        derive.simulate(beams, duration=20, output=10, integrator="generalised-alpha")
