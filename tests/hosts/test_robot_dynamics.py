"""Mass matrices, bias and accelerations of robots in relative coordinates are those of Pinocchio, in many states."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from types import ModuleType
from typing import Any

import casadi as ca
import numpy as np
import pytest
from programs import package
from scipy.integrate import solve_ivp

from conftest import ROOT
from derive.derivation import derive
from derive.ir.interpreter import interpret
from derive.ir.model import Model
from derive.lowering.flat import lower as flat_lower
from derive.runtime.interpreted_scene import InterpretedScene

sys.path.append(str(ROOT / "bench"))
from interleaved import TimedCall
from long_chains import LongChain
from robot_comparison import Comparison
from robot_coordinates import RobotCoordinates
from robot_files import ROBOTS, has_robots, scene_of

pytestmark = pytest.mark.hosts

Array = np.ndarray
LIMIT = 1e-12
"""The largest difference, relative to the largest number of a state."""
STATES = 100
FUNCTIONS = ("mass", "force", "accel", "energy", "rates")
GRAVITY = (Fraction(0), Fraction(0), Fraction("-9.81"))
NUMERIC = {"sin": np.sin, "cos": np.cos, "sqrt": np.sqrt}


@pytest.fixture
def pin() -> ModuleType:
    return package("pinocchio")


@pytest.fixture
def few_functions(monkeypatch: pytest.MonkeyPatch) -> None:
    """Models have the functions of these tests; all take minutes for a humanoid."""
    every = flat_lower.functions_of

    def chosen(*arguments: Any) -> tuple[Any, ...]:
        return tuple(function for function in every(*arguments) if function.name in FUNCTIONS)

    monkeypatch.setattr(flat_lower, "functions_of", chosen)


class ComparedRobot:
    """A robot in both: the model of its scene, that of Pinocchio, and the map between their coordinates."""

    def __init__(self, pin: ModuleType, name: str, folder: Path, gravity: tuple[Fraction, ...] = GRAVITY) -> None:
        if not has_robots():
            pytest.skip("example-robot-data is missing: pip install tisserand[hosts]")
        path, scene = scene_of(name, folder, "relative")
        self.pin, self.other = pin, pin.buildModelFromUrdf(str(path))
        self.data = self.other.createData()
        equations = derive(replace(scene, gravity=gravity)).expanded()
        self.model: Model = flat_lower.lower(equations, explicit=True, requested=("inverse_dynamics",))
        elements = [
            [name for v in part for name in v.elements] for part in (self.model.coordinates, self.model.velocities)
        ]
        self.map = RobotCoordinates(pin, self.other, scene, *elements)

    def inputs(self, tau: Array) -> list[float]:
        """The inputs of the scene are the forces of the joints."""
        places = {name: joint.idx_v for name, joint in zip(self.other.names, self.other.joints, strict=True)}
        return [float(tau[places[variable.name.split("_", 1)[1]]]) for variable in self.model.inputs]

    def values(self, function: str, output: str, arguments: dict[str, Any]) -> Array:
        """The values (states, size) of a function of the model in all states at once."""
        kernel = self.model.kernel(function)
        given = {a.name: arguments[a.name] for a in kernel.arguments}
        found = interpret(kernel, given, functions=NUMERIC, check=False)[output]
        return np.array([np.broadcast_to(value, STATES) for value in found]).T

    def mass(self, values: Array) -> Array:
        """The mass matrix from its structural non-zeros."""
        size = self.other.nv
        result = np.zeros((size, size))
        i, j = zip(*self.model.pattern("mass", "M").entries, strict=True)
        result[i, j] = result[j, i] = values
        return result

    def mass_there(self, q: Array) -> Array:
        """The mass matrix of Pinocchio, of which it computes the upper triangle."""
        upper = np.triu(self.pin.crba(self.other, self.data, q))
        return np.asarray(upper + np.triu(upper, 1).T)


def relative(x: Array, y: Array) -> float:
    """The largest difference over the largest number of y."""
    return float(abs(x - y).max() / abs(y).max())


@pytest.mark.usefixtures("few_functions")
@pytest.mark.parametrize("name", ROBOTS)
def test_robots_in_relative_coordinates_move_as_those_of_pinocchio(name: str, pin: ModuleType, tmp_path: Path) -> None:
    """With v = B w: M is B^T M B there, the bias B^T (h + M Bdot w), and the accelerations B wdot + Bdot w.

    The forces that these accelerations need are those of the joints; a free base needs none.
    """
    robot = ComparedRobot(pin, name, tmp_path)
    states = robot.map.states(STATES)
    motions = [robot.map.motion(q, v, np.zeros_like(v)) for q, v, _ in states]
    q, v, without = (np.array(x) for x in zip(*motions, strict=True))
    u = np.array([robot.inputs(tau) for _, _, tau in states])
    arguments = {"t": 0.0, "q": list(q.T), "v": list(v.T), "u": list(u.T), "k": []}
    masses, forces, accelerations = (
        robot.values(*pair, arguments) for pair in (("mass", "M"), ("force", "h"), ("accel", "vdot"))
    )
    arguments |= {"vdot": list(accelerations.T), "u": list(np.zeros_like(u).T)}
    needed = robot.values("inverse_dynamics", "f", arguments)
    for s, (q_there, v_there, tau) in enumerate(states):
        B, M = robot.map.basis(q_there), robot.mass(masses[s])
        assert relative(B.T @ M @ B, robot.mass_there(q_there)) < LIMIT
        bias = B.T @ (forces[s] + M @ without[s]) + tau  # h has the inputs
        assert relative(bias, pin.nle(robot.other, robot.data, q_there, v_there)) < LIMIT
        rates = np.linalg.solve(B, accelerations[s] - without[s])
        assert relative(rates, pin.aba(robot.other, robot.data, q_there, v_there, tau)) < LIMIT
        assert abs(B.T @ needed[s] - tau).max() < LIMIT * abs(forces[s]).max()


@pytest.mark.usefixtures("few_functions")
def test_a_free_humanoid_keeps_its_energy(pin: ModuleType, tmp_path: Path) -> None:
    """Over 10 s without gravity and joint forces; its limbs turn several times."""
    robot = ComparedRobot(pin, "simple_humanoid", tmp_path, (Fraction(0),) * 3)
    ((q_there, v_there, _),) = robot.map.states(1)
    q, v, _ = robot.map.motion(q_there, v_there, np.zeros_like(v_there))
    symbols = {"q": ca.SX.sym("q", len(q)), "v": ca.SX.sym("v", len(v))}
    arguments = {name: [x[i] for i in range(x.numel())] for name, x in symbols.items()}
    arguments |= {"t": 0.0, "u": [0.0] * len(robot.model.inputs), "k": []}
    functions = {"sin": ca.sin, "cos": ca.cos, "sqrt": ca.sqrt}

    def compiled(*outputs: tuple[str, str]) -> ca.Function:
        found = []
        for name, output in outputs:
            kernel = robot.model.kernel(name)
            given = {a.name: arguments[a.name] for a in kernel.arguments}
            found += interpret(kernel, given, functions=functions, check=False)[output]
        return ca.Function("values", [*symbols.values()], [ca.vertcat(*found)])

    slope, energies = compiled(("rates", "qdot"), ("accel", "vdot")), compiled(("energy", "energy"))

    def derivative(t: float, y: Array) -> Array:
        return np.asarray(slope(*np.split(y, [len(q)]))).ravel()

    times, start = np.linspace(0, 10, 21), np.concatenate([q, v])
    path = solve_ivp(derivative, (0, 10), start, "DOP853", times, rtol=1e-10, atol=1e-12).y.T
    total = [float(ca.sum1(energies(*np.split(y, [len(q)])))) for y in path]
    assert abs(np.array(total) - total[0]).max() < 1e-8 * total[0]
    assert np.ptp(path[:, 7 : len(q)], axis=0).max() > 2 * np.pi


def test_bench_of_robots(pin: ModuleType) -> None:
    """Values agree with those of Pinocchio, or the script fails; times are not checked."""
    command = [sys.executable, str(ROOT / "bench/robots.py"), "--only", "chain_3", "--python", "--flags=-O1"]
    done = subprocess.run([*command, "--repeats", "1", "--json"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    rows = json.loads(done.stdout)["rows"]
    names = [row["name"].split(",")[0] for row in rows]
    assert set(names) == {"forward dynamics", "inverse dynamics", "mass matrix"}
    for row in rows:
        assert row["ours_ns"] > 0 and row["ratio"] == pytest.approx(row["ours_ns"] / row["peer_ns"])
    assert all(row["operations"] > 0 and row["text"] > 0 for row in rows if "batch" not in row["name"])


def test_long_chains_are_compared_with_code_by_hand(pin: ModuleType, tmp_path: Path) -> None:
    """Angles are in their order from the ground on, as of Pinocchio, whose accelerations stand for the C by hand."""
    chain = LongChain("chain_4", tmp_path, "-O1", "relative", 2)
    of = Comparison("chain_4", tmp_path, "-O1", "relative", 2)
    of.states = chain.states
    wanted = np.array([vdot for vdot, _, _ in of._truth()])
    native = InterpretedScene(chain.model)
    ours = [native.solve(0.0, *chain.map.motion(q, v, v)[:2], native.setup())[0] for q, v, _ in chain.states]
    chain.compare("accel", TimedCall("hand", "", 4), wanted)
    chain.compare("accel", TimedCall("ours", "", 4), np.array(ours))
    with pytest.raises(ArithmeticError, match=r"chain_4: accel of ours is off by 1.0e-10"):
        chain.compare("accel", TimedCall("ours", "", 4), np.array(ours) * (1 + 1e-10))


def test_the_bench_refuses_other_values(pin: ModuleType, tmp_path: Path) -> None:
    comparison = Comparison("chain_3", tmp_path, "-O1", "relative", 2)
    call, values = TimedCall("Pinocchio aba_local", "", 3), np.array([a for a, _, _ in comparison.truth])
    comparison.compare("accel", call, values)
    with pytest.raises(ArithmeticError, match=r"chain_3: accel of Pinocchio aba_local is off by 1.0e-11"):
        comparison.compare("accel", call, values * (1 + 1e-11))
