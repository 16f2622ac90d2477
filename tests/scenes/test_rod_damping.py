"""Damping of rods in pieces: that of the whole rod, however it is cut, and none of rigid motion.

All is computed by the generated Python, which needs no compiler; `test_oracle` compares it with the C.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigvals, null_space

import derive
from beams import run_module
from derive.generated_models import generated
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse

UNIT = {"mass": 1, "length": 1, "bending_stiffness": 1, "markers": {"root": -1, "tip": 1}}
SUPPORTS: dict[str, dict[str, Any]] = {
    "free": {},
    "clamped": {"wall": {"kind": "weld", "between": ["ground.wall", "rod.root"]}},
    "pinned": {
        "wall": {"kind": "revolute", "between": ["ground.wall", "rod.root"]},
        "pin": {"kind": "revolute", "between": ["roller.pin", "rod.tip"]},
        "guide": {"kind": "translational", "between": ["ground.wall", "roller.pin"]},
    },
}
STRETCHING: dict[str, Any] = {"order": 2, "axial": {"ansatz": ["xi", "xi^2", "xi^3"], "stiffness": 50}}


def rod(pieces: int, damping: dict[str, Any] | None, support: str = "free", shapes: int = 4, **more: Any) -> Scene:
    ansatz = ["1", "xi", *(f"xi^{n}" for n in range(2, shapes + 2))]
    beam = {**UNIT, "ansatz": ansatz, "pieces": pieces, "damping": damping, **more}
    roller = {"mass": 1, "inertia": 1, "markers": {"pin": [0, 0]}}
    bodies = {"rod": beam} | ({"roller": roller} if support == "pinned" else {})
    return derive.scene("rod", ground={"wall": [0, 0]}, bodies=bodies, joints=SUPPORTS[support])


def python(scene: Scene) -> dict[str, Any]:
    """The names of the generated Python."""
    return run_module(generated(scene)[1])


def ratios(scene: Scene, count: int) -> np.ndarray:
    """The damping ratios of the lowest modes that are no rigid motion, about the undeformed rod.

    Where the frames of its pieces are does not matter to the matrices of a straight rod.
    """
    names = python(scene)
    n, m, k = len(names["COORDINATES"]), len(names["MULTIPLIERS"]), names["setup"](names["DEFAULTS"])
    rest = np.zeros(2 * n + m)
    still, moving = (names["dense"](names["JACOBIAN"], names["jacobian"](0.0, rest, rest, cj, k)) for cj in (0.0, 1.0))
    K, B, G = np.split(still[n : 2 * n], [n, 2 * n], axis=1)
    free = null_space(G.T) if m else np.eye(n)
    M, B, K = (free.T @ matrix @ free for matrix in ((moving - still)[n : 2 * n, n : 2 * n], B, K))
    zero, one = np.zeros_like(M), np.eye(len(M))
    values = eigvals(np.block([[zero, one], [-K, -B]]), np.block([[one, zero], [zero, M]]))
    values = values[(np.abs(values) > 1e-2) & (values.imag >= 0)]
    values = values[np.argsort(np.abs(values))]
    return (-values.real / np.abs(values))[:count]


@pytest.mark.parametrize(
    ("pieces", "frame"),
    [(3, "mean"), pytest.param(2, "chord", marks=pytest.mark.long), (2, {"kind": "tangent", "at": -1})],
)
def test_a_ratio_is_that_of_all_free_modes_of_the_whole_rod(pieces: int, frame: Any) -> None:
    found = ratios(rod(pieces, {"ratio": 0.03}, shapes=3, frame=frame), 99)
    assert len(found) == 3 * pieces
    np.testing.assert_allclose(found, 0.03, rtol=1e-6)


def test_a_ratio_is_that_of_stretching_as_well() -> None:
    of_bending, of_stretching = {"symbol": "EI", "default": 1}, {"symbol": "EA", "default": 50}
    symbols = {"bending_stiffness": of_bending, "axial": {**STRETCHING["axial"], "stiffness": of_stretching}}
    found = ratios(rod(2, {"ratio": 0.03}, shapes=2, **STRETCHING | symbols), 99)
    assert len(found) == 2 * (2 + 3)
    np.testing.assert_allclose(found, 0.03, rtol=1e-6)


@pytest.mark.long
@pytest.mark.parametrize(
    ("support", "damping"),
    [("clamped", {"ratio": 0.02}), pytest.param("pinned", {"mass": 0.3}, marks=pytest.mark.long)],
)
def test_damping_does_not_depend_on_the_number_of_pieces(damping: dict[str, float], support: str) -> None:
    of_one, of_three = (ratios(rod(pieces, damping, support, shapes), 2) for pieces, shapes in ((1, 7), (3, 4)))
    np.testing.assert_allclose(of_one, of_three, rtol=0.002)
    if support == "clamped":
        assert of_three[0] == pytest.approx(0.072 * 0.02, rel=0.01), "what docs/theory.md states"


@pytest.mark.long
def test_the_factor_of_the_mass_against_a_closed_form() -> None:
    """mass/(2 omega) times the part of the kinetic energy that is not that of a rigid motion.

    The first mode of a clamped beam has the mean 2 s/b, and the mean 2/b^2 of x times it.
    """
    b, s, c = 1.8751040687, 0.7340955138, 0.3
    mean, moment = 2 * s / b, 2 / b**2
    rigid = mean**2 + 12 * (moment - mean / 2) ** 2
    for pieces in (1, 3):
        assert ratios(rod(pieces, {"mass": c}, "clamped"), 1) == pytest.approx(c / (2 * b**2) * (1 - rigid), rel=1e-3)


def test_rigid_motion_is_not_damped() -> None:
    """In any configuration forces are those without damping while the amplitudes do not change; else they are not."""
    rng = np.random.default_rng(0)
    forces = []
    for damping in (
        {
            "ratio": 0.1,
        },
        {"mass": 0.3, "stiffness": 0.1},
        None,
    ):
        names = python(rod(3, damping, shapes=2))
        forces.append((names, names["setup"](names["DEFAULTS"])))
    velocities = rng.normal(size=len(names["COORDINATES"]))
    q = 0.3 * rng.normal(size=len(velocities))
    still = np.where(["alpha" in name for name in names["COORDINATES"]], 0.0, velocities)
    of_still, of_moving = (np.array([names["force"](0.0, q, v, k) for names, k in forces]) for v in (still, velocities))
    assert np.array_equal(of_still[0], of_still[2]) and np.array_equal(of_still[1], of_still[2])
    assert min(np.abs(of_moving[i] - of_moving[2]).max() for i in (0, 1)) > 0.05


TUMBLING = """
name = "tumbling"
scene.gravity = [0, -9.81]
[bodies.rod]
pieces = 3
mass = 0.8
length = 1.1
bending_stiffness = {{ symbol = "EI", default = 4 }}
ansatz = ["1", "xi", "xi^2", "xi^3"]
damping = {damping}
markers = {{ root = -1, tip = 1 }}
masses.head = {{ at = 1, mass = 0.1, inertia = 1e-3 }}
[forces.pull]
at = "rod.tip"
components = [3, 2]
[outputs]
energy = {{ kind = "energy" }}
power = {{ kind = "power" }}
"""


@pytest.mark.parametrize(
    "damping",
    [
        '{ ratio = { symbol = "zeta", default = 0.1 } }',
        pytest.param("{ mass = 3, stiffness = 1e-3 }", marks=pytest.mark.long),
    ],
)
def test_the_energy_changes_by_the_powers(damping: str) -> None:
    """d(energy)/dt = power of the load + dissipation, for rates that the welds allow, in any configuration."""
    names = python(parse(TUMBLING.format(damping=damping)))
    k, rng = names["setup"](names["DEFAULTS"]), np.random.default_rng(1)
    n, step = len(names["COORDINATES"]), 1e-30
    q = 0.2 * rng.normal(size=n)
    G = names["dense"](names["CONSTRAINT_JACOBIAN"], names["constraint_jacobian"](0.0, q, k))
    free = null_space(G)
    v = free @ rng.normal(size=free.shape[1])
    vdot, lam = names["solve"](0.0, q, v, k)
    outputs = names["outputs"](0.0, q + 1j * step * v, v + 1j * step * vdot, vdot, lam, k)
    gained, (loads, _, lost) = outputs[3].imag / step, outputs[4:].real
    assert lost < -0.1
    assert gained == pytest.approx(loads + lost, rel=1e-11)
