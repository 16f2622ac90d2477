"""`--to sundials`: its programs have the motion, the events and the sensitivities of simulations."""

from __future__ import annotations

import re
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from host_models import EVERYWHERE, LINKAGE, LINKS, PUSHED, STEERED
from programs import run
from test_cmake import configured, ctest

import derive
from conftest import ROOT
from derive.export.host_model import host_model
from derive.export.interface import exported_files
from derive.export.registry import INTERFACES
from derive.simulation.constraints.projection import project
from derive.simulation.integration.scipy_methods import integrate
from derive.spec.toml.read import parse

pytestmark = pytest.mark.hosts

SPECS = {
    "linkage": lambda: parse(LINKAGE),
    "pushed": lambda: parse(PUSHED),
    "steered": lambda: parse(STEERED),
    "spinning_beam": lambda: derive.read(ROOT / "scenes/spinning_beam.toml"),
    "crank_slider_3": lambda: derive.read(ROOT / "scenes/crank_slider_3.toml"),
    **{name: partial(parse, text) for name, text in (EVERYWHERE | LINKS).items()},
}


def built(spec: Any, folder: Path) -> Path:
    """The folder of the programs, which have passed their own comparison with the motion of Tisserand."""
    made = exported_files(host_model(spec, sensitivities=True), "sundials", INTERFACES["sundials"])
    derive.write(made, folder)
    flags = "-DCMAKE_C_FLAGS=-Wall -Wextra -Wshadow -Werror"
    return configured(folder / f"{spec.name}-sundials", folder / "build", flags)


def redundant() -> Any:
    """A pendulum whose joint is there twice, so that IDA needs a proximal term."""
    twin = '[joints.twin]\nkind = "revolute"\nbetween = ["ground.pivot", "rod.root"]\n'
    return parse(PUSHED.replace('"pushed"', '"redundant"') + twin)


@pytest.mark.parametrize("name", [*SPECS, "redundant"])
def test_all_programs_have_the_motion_of_a_simulation(name: str, tmp_path: Path) -> None:
    said = ctest(built((SPECS | {"redundant": redundant})[name](), tmp_path))
    for method in ("CVODE", "CVODES", "ARKODE", "IDA"):
        assert re.search(rf"{name}, {method}: [1-9]\d* steps; largest difference", said)


@cache
def linkage_states(**values: float) -> np.ndarray:
    """The last state of the reference motion, from the start nearest to that of the defaults."""
    spec = parse(LINKAGE)
    model = host_model(spec)
    native: Any = derive.load_scene(model.files)
    k = native.with_inputs(native.setup(**{n: x for n, x in values.items() if n != "push"}), [values.get("push", 2.0)])
    q, v = (np.array([x.start for x in part]) for part in (model.coordinates, model.velocities))
    q, v = project(native, k, 0.0, q, v)
    found = integrate(native, k, q, v, np.array([0.0, 0.3]), tolerance=1e-11)
    return np.concatenate([found.q[-1], found.v[-1]])


def test_sensitivities_are_those_of_another_integrator(tmp_path: Path) -> None:
    """Sensitivities of the linkage to its constraints, stiffness and input are compared with differences by SciPy."""
    folder = built(SPECS["linkage"](), tmp_path)
    said = run(folder / "sample_cvodes")
    sizes = {name: float(x) for name, x in re.findall(r"d y / d (\w+): up to (\S+);", said)}
    assert sizes.keys() == {"distance", "m", "l", "EI", "push"}
    for name, default in (("distance", 1.2), ("l", 1.0), ("EI", 200.0), ("push", 2.0)):
        h = 1e-5 * default
        difference = (linkage_states(**{name: default + h}) - linkage_states(**{name: default - h})) / (2 * h)
        assert sizes[name] == pytest.approx(np.abs(difference).max(), rel=2e-4)


def test_events_are_those_of_a_simulation(tmp_path: Path) -> None:
    """The times at which the slider turns round."""
    spec = parse(LINKAGE.replace("duration = 3", "duration = 30"))
    folder = built(spec, tmp_path)
    times = [float(x) for x in re.findall(r"event at t = (\S+) s", run(folder / "sample_cvode"))]
    held = derive.simulate(spec, duration=3.0, output=2e-4)
    column = next(
        i for i, name in enumerate(derive.load_scene(host_model(spec).files).velocities) if name == "slider_sdot"
    )
    speed, t = held.solution.v[:, column], held.solution.t
    turns = np.flatnonzero(speed[:-1] * speed[1:] < 0)
    expected = t[turns] - speed[turns] * (t[turns + 1] - t[turns]) / (speed[turns + 1] - speed[turns])
    assert len(times) == len(expected) >= 2
    assert np.abs(np.array(times) - expected).max() < 1e-5


def test_the_version_is_the_one_that_is_stated() -> None:
    header = Path("/usr/include/sundials/sundials_config.h").read_text()
    (found,) = re.findall(r'#define SUNDIALS_VERSION "(\d+)', header)
    assert f"SUNDIALS {found}." in (ROOT / "docs/hosts.md").read_text()
