"""`--to exudyn`: in Exudyn the models move as in Tisserand, alone and connected to bodies of Exudyn."""

from __future__ import annotations

import ctypes
import sys
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from exudyn_systems import LADEN, MODELS, added, compiled, exported, host_of, solved
from host_models import PUSHED, STEERED
from programs import package, run

import derive
from conftest import ROOT
from derive.errors import SpecError
from derive.spec.toml.read import parse

pytestmark = pytest.mark.hosts


@pytest.fixture(scope="module")
def exu() -> ModuleType:
    module = package("exudyn")
    module.config.printToConsole = False
    return module


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("exudyn")


@pytest.mark.parametrize("name", MODELS)
def test_the_sample_moves_as_tisserand_has_it(name: str, folder: Path) -> None:
    """The sample itself demands 1e-4 of the largest coordinate and velocity; a wrong library fails it."""
    _, library = exported(name, folder)
    sample = folder / f"{name}-exudyn/sample.py"
    text = run(sys.executable, sample, library)
    assert "largest difference from Tisserand" in text


def state(name: str, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """q and v near the start."""
    host, rng = host_of(name), np.random.default_rng(seed)
    q, v = (np.array([x.start for x in part]) for part in (host.coordinates, host.velocities))
    q, v = q + 0.05 * rng.standard_normal(q.size), v + rng.standard_normal(v.size)
    for i in quaternions(name):
        q[i : i + 4] /= np.linalg.norm(q[i : i + 4])
    return q, v


def quaternions(name: str) -> list[int]:
    """The positions of quaternions in q."""
    return [i for i, x in enumerate(host_of(name).coordinates) if x.name.endswith("e0")]


@pytest.mark.parametrize("name", MODELS)
def test_user_functions_are_the_equations_of_the_model(name: str, exu: ModuleType, folder: Path) -> None:
    """M xddot = f + G^T lambda with the second derivative of the constraints zero has the accelerations of the C."""
    host, (q, v) = host_of(name), state(name, 1)
    native = derive.load(host.files)
    k = native.setup()
    if host.inputs:
        k = native.with_inputs(k, host.constant_inputs)
    _, body = added(exu, name, folder, q=q, v=v)
    xdot, t = native.rates(q, v, k), 0.2
    f, M = body._force(None, t, 0, q, xdot).copy(), body._mass(None, t, 0, q, xdot).copy()
    G = body._constraint_jacobian(None, t, 0, q, xdot, False).copy()
    body.set_state(t, q, xdot)
    xddot = body._accelerations_of(t).copy()
    left = np.linalg.lstsq(G.T, M @ xddot - f, rcond=None)
    assert np.max(np.abs(G.T @ left[0] - (M @ xddot - f))) < 1e-10 * np.max(np.abs(f))
    h = 1e-6

    def rates(by: float) -> np.ndarray:
        at = q + by * xdot + by**2 / 2 * xddot
        return body._constraints(None, t + by, 0, at, xdot + by * xddot, True).copy()

    second = (rates(h) - rates(-h)) / (2 * h)
    assert np.max(np.abs(second)) < 1e-6 * np.max(np.abs(G)) * np.max(np.abs(xddot))
    direct = native.accel(t, q, v, k)
    if quaternions(name):  # the accelerations in space, through those of the quaternion
        ends = [body_velocities(body, q + s * h * xdot, xdot + s * h * xddot) for s in (-1, 1)]
        assert np.allclose((ends[1] - ends[0]) / (2 * h), direct, rtol=1e-7, atol=1e-5 * np.max(np.abs(direct)))
    else:
        # `accel`, and `solve`, from which the others come, may eliminate in different orders
        assert np.max(np.abs(xddot - direct)) <= 1e-13 * np.max(np.abs(direct))


def body_velocities(body: Any, x: np.ndarray, xdot: np.ndarray) -> np.ndarray:
    body.set_state(0.0, x, xdot)
    return np.array(body._velocities_of())


@pytest.mark.parametrize("name", ["pushed", "steered", "double_pendulum", "crank_slider_3"])
def test_jacobian_is_that_of_the_force(name: str, exu: ModuleType, folder: Path) -> None:
    (q, v), h = state(name, 2), 1e-6
    _, body = added(exu, name, folder, q=q, v=v)
    by_position, by_velocity = (body._jacobian(None, 0.1, 0, q, v, *f).copy() for f in ((1, 0), (0, 1)))
    for j, unit in enumerate(np.eye(q.size)):
        for matrix, dq, dv in ((by_position, h * unit, 0 * unit), (by_velocity, 0 * unit, h * unit)):
            ends = [body._force(None, 0.1, 0, q + s * dq, v + s * dv).copy() for s in (-1, 1)]
            slope = (ends[0] - ends[1]) / (2 * h)
            rounding = 1e-15 * np.max(np.abs(ends)) / h
            assert np.max(np.abs(matrix[:, j] - slope)) < 1e-6 * np.max(np.abs(matrix)) + 10 * rounding


def test_a_model_of_the_same_name_lends_no_functions(exu: ModuleType, tmp_path: Path) -> None:
    """The library of another one is open for all to see in this process."""
    masses = []
    for mass in ("0.5", "2.0"):
        host = derive.host_model(
            parse(PUSHED.replace('"pushed"', '"pushed_twin"').replace("mass = 0.5", f"mass = {mass}"))
        )
        module, library = compiled(host, tmp_path / mass)
        body = module.add(exu.SystemContainer().AddSystem(), library)
        native = derive.load(host.files)
        q, v = (np.array([x.start for x in part]) for part in (host.coordinates, host.velocities))
        M = native.mass_pattern.dense(native.mass(q, native.with_inputs(native.setup(), host.constant_inputs)))
        masses.append((body._mass(None, 0.0, 0, q, v).copy(), M))
        ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)
    assert all(np.allclose(*pair, rtol=1e-14) for pair in masses) and not np.allclose(masses[0][1], masses[1][1])


def test_inputs_parameters_and_outputs(exu: ModuleType, folder: Path) -> None:
    """A force that follows a function of Python, with another stiffness: the outputs of a sensor are those of ours."""
    duration = 0.2
    mbs, body = added(exu, "pushed", folder, parameters={"EI": 20.0}, inputs={"push": lambda t: 0.3 * np.cos(6 * t)})
    sensor = body.add_sensor(mbs)
    mbs.Assemble()
    solved(exu, mbs, duration, 4000)
    own = derive.simulate(parse(PUSHED.replace("default = 10", "default = 20")), duration=duration, tolerance=1e-10)
    outputs = np.array(mbs.GetSensorStoredData(sensor))[-1, 1:]
    expected = np.array([own[name][-1] for name in exported("pushed", folder)[0].OUTPUTS])
    assert np.allclose(outputs, expected, rtol=0, atol=1e-4 * np.max(np.abs(expected)))


def test_a_prescribed_motion(exu: ModuleType, folder: Path) -> None:
    """Its three values are a function; Exudyn does not know the initial accelerations that it brings."""
    duration, a = 0.1, 0.5

    def angle(t: float) -> tuple[float, float, float]:
        return a * (1 + np.sin(4 * t)) + 3 * t**2, 4 * a * np.cos(4 * t) + 6 * t, 6 - 16 * a * np.sin(4 * t)

    mbs, body = added(exu, "steered", folder, inputs={"angle": angle})
    mbs.Assemble()
    body.set_initial_accelerations(mbs)
    solved(exu, mbs, duration, 2000, keep_accelerations=True)
    q, v = body.state(mbs)
    own = derive.simulate(parse(STEERED), duration=duration, tolerance=1e-10, inputs={"side": lambda t: 0.0})
    assert np.allclose(q, own.q[-1], rtol=0, atol=1e-5) and np.allclose(v, own.v[-1], rtol=0, atol=1e-4)
    assert body.outputs(mbs)[0] == pytest.approx(own["torque"][-1], rel=1e-3)


def test_a_mass_of_exudyn_at_a_point(exu: ModuleType, folder: Path) -> None:
    """The rod of Tisserand with a mass of Exudyn at its tip moves as one scene of both."""
    items, duration = exu.itemInterface, 0.2
    mbs, body = added(exu, "pushed", folder, points=("rod_tip",))
    tip = body.points["rod_tip"]
    ball = mbs.AddNode(items.NodePoint2D(referenceCoordinates=position(mbs, tip), initialVelocities=velocity(mbs, tip)))
    mass = mbs.AddObject(items.ObjectMassPoint2D(mass=0.2, nodeNumber=ball))
    weight = mbs.AddMarker(items.MarkerBodyMass(bodyNumber=mass))
    mbs.AddLoad(items.LoadMassProportional(markerNumber=weight, loadVector=[0, -9.81, 0]))
    markers = [mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=number)) for number in (tip.body, mass)]
    joint = mbs.AddObject(items.ObjectJointRevolute2D(markerNumbers=markers))
    mbs.Assemble()
    solved(exu, mbs, duration, 4000)
    q, v = body.state(mbs)
    held = {"push": lambda t: 0.3}
    own = derive.simulate(parse(LADEN), duration=duration, tolerance=1e-10, inputs=held)
    n = q.size
    assert np.allclose(q, own.q[-1, :n], rtol=0, atol=1e-6) and np.allclose(v, own.v[-1, :n], rtol=0, atol=1e-4)
    force = mbs.GetObjectOutput(joint, exu.OutputVariableType.Force)
    reaction = [own[name][-1] for name in ("lambda_pin_1", "lambda_pin_2")]
    assert np.allclose(np.abs(force[:2]), np.abs(reaction), rtol=2e-3)


def position(mbs: Any, point: Any) -> list[float]:
    return list(mbs.GetNode(point.node)["referenceCoordinates"])


def velocity(mbs: Any, point: Any) -> list[float]:
    return list(mbs.GetNode(point.node)["initialVelocities"])


def test_a_failure_of_the_model_ends_the_run(exu: ModuleType, folder: Path) -> None:
    """Results are NaN where the C returns a code: Exudyn shortens its steps and stops with its own error."""
    mbs, body = added(exu, "double_pendulum", folder)
    force = body._force_of
    body._force_of = lambda t: force(t) * (1.0 if t <= 0.1 else np.nan)
    mbs.Assemble()
    with pytest.raises(exu.SolverError):
        solved(exu, mbs, 0.2, 200)


def test_what_is_refused(exu: ModuleType, folder: Path) -> None:
    for given, message in (
        ({"parameters": {"EA": 1.0}}, "pushed has no EA; it has EI"),
        ({"inputs": {"pull": lambda t: 0.0}}, "pushed has no pull; it has push"),
        ({"points": ("rod.tip",)}, "pushed has no rod.tip; it has rod_root, rod_tip"),
        ({"parameters": {"EI": np.inf}}, "pushed does not accept the parameters"),
    ):
        with pytest.raises(ValueError, match=message):
            added(exu, "pushed", folder, **given)
    spec = replace(derive.read(ROOT / "scenes/block.toml"), lowering="loops")
    with pytest.raises(SpecError, match="straight-line code"):
        derive.exported(spec, "exudyn")


def test_the_page_states_the_version_that_is_tried() -> None:
    assert f"Tried with Exudyn {version('exudyn')}" in (ROOT / "docs/hosts.md").read_text()


def test_outputs_in_space(exu: ModuleType, folder: Path) -> None:
    """Positions and reactions; the latter have the multipliers of Exudyn: those of joints, before those of lengths."""
    duration = 0.04
    mbs, body = added(exu, "kept", folder)
    mbs.Assemble()
    body.set_initial_accelerations(mbs)
    solved(exu, mbs, duration, 2000, keep_accelerations=True)
    own = derive.simulate(MODELS["kept"](), duration=duration, tolerance=1e-10)
    assert len(quaternions("kept")) == 3 and own.motion.native.nlambda == 17
    names = exported("kept", folder)[0].OUTPUTS
    expected = np.array([own[name][-1] for name in names])
    assert names[-1] == "hub_torque3"
    assert np.allclose(body.outputs(mbs), expected, rtol=0, atol=2e-3 * max(abs(expected)))
