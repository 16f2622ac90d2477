"""`derive.simulate`: named columns, integrators by name, and errors that say what is known."""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive.simulation.integration.integrator import Integrator, Settings
from derive.simulation.integration.solution import Cost, Solution
from derive.spec.model.scene import Scene

END = 0.5  # s


def pendulum() -> Scene:
    scene = derive.read(ROOT / "scenes/double_pendulum.toml")
    assert isinstance(scene, Scene)
    return scene


@cache
def trajectory(integrator: str = "dop853", step: float | None = None) -> derive.Trajectory:
    return derive.simulate(pendulum(), duration=END, output=0.03, integrator=integrator, step=step)


def test_columns_have_names_units_and_values() -> None:
    found = trajectory()
    assert found.columns[0] == "t" and len(set(found.columns)) == len(found.columns) == len(found)
    assert found.t[0] == 0 and found.t[1] == 0.03 and found.t[-1] == END  # also where it is no multiple of the output
    names = found.model.coordinates
    assert np.array_equal(np.stack([found[x.name] for x in names], axis=1), found.q)
    assert np.array_equal(np.stack([found[x.name] for x in found.model.velocities], axis=1), found.v)
    assert np.array_equal(np.stack([found[f"lambda_{x.name}"] for x in found.model.multipliers], axis=1), found.lam)
    assert {x.name: found.units[x.name] for x in names} == {x.name: x.unit for x in names}
    assert found.units["t"] == "s"
    with pytest.raises(
        derive.UnknownNameError, match=rf"no column of double_pendulum \"{names[0].name}x\"; did you mean"
    ):
        found[names[0].name + "x"]
    assert found.get("nothing") is None and names[0].name in found


def test_pandas_has_the_same_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pandas itself is no dependency: a stand-in receives what it would."""
    found = trajectory()
    stand_in = SimpleNamespace(Index=lambda values, name: (name, values), DataFrame=lambda data, index: (data, index))
    monkeypatch.setitem(sys.modules, "pandas", stand_in)
    data, (name, index) = found.to_pandas()
    assert (*data,) == found.columns[1:] and name == "t" and index is found.t
    assert all(data[column] is found[column] for column in data)
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(derive.TisserandError, match="pip install pandas"):
        found.to_pandas()


@pytest.mark.parametrize(
    ("integrator", "step", "tolerance"),
    [
        ("adaptive", None, 1e-8),
        ("rk45", None, 1e-6),
        ("rk4", 5e-4, 1e-6),
        ("generalised-alpha", 1e-3, 2e-3),
        ("c_ida", None, 1e-5),
    ],
)
def test_integrators_agree(integrator: str, step: float | None, tolerance: float) -> None:
    try:
        found = trajectory(integrator, step)
    except derive.TisserandError as error:
        if "was not found. Install it" in str(error):
            pytest.skip(str(error).splitlines()[0])
        raise
    assert np.array_equal(found.t, trajectory().t)
    assert np.max(np.abs(found.q - trajectory().q)) < tolerance
    assert np.max(found.solution.drift) < 1e-9 and found.solution.cost.steps > 0


def test_an_unknown_integrator_names_the_known_ones() -> None:
    known = "adaptive, dop853, scipy, rk45, ida, rk4, generalised-alpha, c_ida"
    with pytest.raises(derive.UnknownNameError, match=f'no integrator "dop85"; did .* "dop853"[?] known: {known}'):
        derive.simulate(pendulum(), integrator="dop85")


def test_an_integrator_from_outside() -> None:
    """Euler steps between rows, written here, are an integrator as good as any other."""

    def euler(files: Sequence[derive.File]) -> Integrator:
        native = derive.load_scene(files)

        def integrate(k: np.ndarray, q: np.ndarray, v: np.ndarray, times: np.ndarray, settings: Settings) -> Solution:
            states = [(q, v)]
            for t, interval in zip(times, np.diff(times), strict=False):
                q, v = q + interval * v, v + interval * native.accel(t, q, v, k)
                states.append((q, v))
            qs, vs = (np.array(x) for x in zip(*states, strict=True))
            lam = np.array([native.solve(t, *state, k)[1] for t, state in zip(times, states, strict=True)])
            return Solution(times, qs, vs, lam, np.zeros((len(times), 2)), np.zeros((len(times), 2)), Cost(0, 0, 0.0))

        return Integrator(native, integrate)

    derive.INTEGRATORS.register("euler", euler)
    try:
        found = derive.simulate(pendulum(), duration=2e-3, output=1e-4, integrator="euler")
        exact = derive.simulate(pendulum(), duration=2e-3, output=1e-4)
        assert 1e-9 < np.max(np.abs(found.q - exact.q)) < 1e-3
    finally:
        derive.INTEGRATORS.unregister("euler")


def test_a_scene_without_simulation_needs_duration_and_output() -> None:
    scene = replace(pendulum(), simulation=None)
    with pytest.raises(derive.SpecError, match="simulation: this table is missing"):
        derive.simulate(scene, duration=1.0)
    assert len(derive.simulate(scene, duration=2e-3, output=1e-3).t) == 3


@pytest.mark.parametrize("given", [{"duration": -1.0}, {"output": 0.0}, {"tolerance": 2.0}, {"duration": 1e9}])
def test_what_is_given_instead_is_checked_as_a_file_is(given: dict[str, float]) -> None:
    with pytest.raises(derive.SpecError, match="simulation"):
        derive.simulate(pendulum(), **{"duration": END, "output": 0.03} | given)


def test_a_step_is_refused_where_it_means_nothing() -> None:
    with pytest.raises(derive.SimulationError, match="dop853 chooses its own steps"):
        trajectory("dop853", step=1e-3)


def test_what_is_not_meant_is_a_type_error() -> None:
    """The path of a specification in place of it, and the reverse; a specification in place of its files."""
    path, scene = "scenes/double_pendulum.toml", pendulum()
    for function in (derive.derive, derive.simulate, derive.modes, derive.host_model):
        with pytest.raises(TypeError, match=r"not str; read .* with derive\.read"):
            function(path)  # type: ignore[operator]  # the mistake under test
    with pytest.raises(TypeError, match="the path of a TOML file is needed, not Scene; it is a specification already"):
        derive.read(scene)  # type: ignore[arg-type]
    for load in (derive.load, derive.load_scene):
        for wrong in (scene, path):
            with pytest.raises(TypeError, match=r"files that derive\.model_files\(.*\) returns are needed, not"):
                load(wrong)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"the equations that derive\.derive\(spec\) returns are needed, not Scene"):
        derive.lower(scene)  # type: ignore[arg-type]


def test_a_step_beyond_the_stability_limit_of_rk4_is_named() -> None:
    """A note where the run ends all the same, and in the error where it does not."""
    stiff = {"mass": 1, "length": 1, "bending_stiffness": 2000, "markers": {"left": -1}, "start": {"spin": 1}}
    hinge = {"kind": "revolute", "between": ["ground.hook", "rod.left"]}
    scene = derive.scene("stiff_rod", ground={"hook": [0, 0]}, bodies={"rod": stiff}, joints={"hinge": hinge})
    text = r"step: 0.01 s is above the stability limit of rk4, 0.00\d+ s in the initial state"
    (note,) = derive.simulate(scene, duration=0.01, output=0.01, integrator="rk4", step=0.01).solution.notes
    assert re.match(text, note)
    with pytest.raises(derive.SimulationError, match=text):
        derive.simulate(scene, duration=1, output=0.01, integrator="rk4", step=0.01)


def test_a_step_that_does_not_divide_the_rows_is_shortened_with_a_note() -> None:
    """Rows every 0.03 s and 0.02 s at the end: 0.008 s becomes 0.0075 s; 0.02/3 s is what it is shortened to there.

    It is above the stability limit of the pendulum as well.
    """
    *notes, unstable = derive.simulate(
        pendulum(), duration=0.08, output=0.03, integrator="rk4", step=0.008
    ).solution.notes
    assert [note.split(":")[1].split(" s ->")[0] for note in notes] == [" 0.008", " 0.008"]
    assert unstable.startswith("step: 0.0075 s is above the stability limit of rk4, 0.00662 s")
    assert "-> 0.0075 s between rows that are 0.03 s apart" in notes[0]
    assert "-> 0.00666667 s between rows that are 0.02 s apart" in notes[1]
    assert derive.simulate(pendulum(), duration=0.006, output=0.003, integrator="rk4", step=0.001).solution.notes == ()


def test_a_step_of_rk4_that_is_too_long_for_the_motion_is_named() -> None:
    """Two rods at rest have no frequency that limits the step, but a torque soon turns one by radians in each step."""
    rod = {"mass": 1, "inertia": 0.1, "centre": [0.5, 0], "markers": {"left": [0, 0], "right": [1, 0]}}
    pin = {"kind": "revolute"}
    joints = {"hinge": {**pin, "between": ["ground.o", "a.left"]}, "elbow": {**pin, "between": ["a.right", "b.left"]}}
    torque = {"push": {"at": "b.right", "value": 10000}}
    scene = derive.scene("whirl", ground={"o": [0, 0]}, bodies={"a": rod, "b": rod}, joints=joints, torques=torque)
    with pytest.raises(derive.SimulationError, match=r"a step shorter than 0\.01 s may pass, such as --step 0\.001;"):
        derive.simulate(scene, duration=0.05, output=0.05, integrator="rk4", step=0.01)
    assert derive.simulate(scene, duration=0.05, output=0.05, integrator="rk4", step=0.001).solution.notes == ()
