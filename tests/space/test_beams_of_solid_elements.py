"""Beams in space beside finite-element solids of the same data; what parts them is what theory says.

A beam of 1 m by 60 mm by 15 mm is meshed with quadratic bricks, which stiffen its bending by 2e-4 in the first mode and
1.7e-3 in the second. The beam in space has the stiffnesses of its section; its torsional stiffness is that of the
section as the mesh has it. Shear and rotary inertia of bending, which it leaves out, are those of Timoshenko's beam.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
import solid_cantilever as solid
from scipy.linalg import eigh

import derive
from conftest import QUICK
from derive.backends.python.backend import PythonBackend
from derive.generated_models import generated
from derive.simulation.linear.linearisation import Linearisation, linearise
from derive.simulation.scene_start import steady_motion_of
from derive.study.stability.eigenvalues import eigenvalues

BERNOULLI = np.array([3.5160, 22.0345])
"""The first frequencies of a cantilever over sqrt(EI/(m l^3))."""
HUB = {"rotation": {"z": [0, 1, 0], "x": [1, 0, 0]}}
"""A frame whose z is along e2, about which the hub turns: lag is in the soft plane, flap in the stiff one."""


@cache
def beam() -> Callable[..., tuple[Linearisation, np.ndarray, float]]:
    """The beam in space on a hub, for its parameters: linearised about its motion, where its tip is, and its spin."""
    rod: dict[str, Any] = {
        "length": solid.LENGTH,
        "mass": solid.MASS,
        "bending_stiffness": solid.STIFF,
        "lateral": {"bending_stiffness": solid.SOFT},
        "torsion": {"ansatz": ["xi", "xi^2", "xi^3"], "stiffness": {"symbol": "GJ", "default": 1}},
        "rotary_inertia": solid.ABOUT_AXIS,
        "ansatz": [f"xi^{n}" for n in range(6)],
        "frame": {"kind": "tangent", "at": -1},
        "order": 2,
        "markers": {"root": -1, "tip": 1},
    }
    scene = derive.spatial_scene(
        "beam",
        start="steady",
        parameters={"P": {"default": 0, "unit": "N"}, "F": {"default": 0, "unit": "N"}},
        ground={"axis": {"at": (0, 0, 0), **HUB}},
        bodies={"hub": {"markers": {"shaft": {"at": (0, 0, 0), **HUB}, "root": (0, 0, 0)}}, "beam": rod},
        joints={
            "shaft": {"kind": "revolute", "between": ["ground.axis", "hub.shaft"]},
            "clamp": {"kind": "fixed", "between": ["hub.root", "beam.root"]},
        },
        drives={"motor": {"joint": "shaft", "speed": {"symbol": "mu", "default": 0, "unit": "rad/s"}}},
        forces={"end": {"at": "beam.tip", "force": [0, "-P", "F"]}},
        outputs={"tip": {"kind": "position", "marker": "beam.tip"}},
    )
    native = derive.load_scene(generated(scene)[1], QUICK)

    def at(**values: float) -> tuple[Linearisation, np.ndarray, float]:
        k = native.setup(values)
        steady = steady_motion_of(scene, native, k)
        still = np.zeros(native.nv)
        tip = native.evaluate_outputs(0.0, steady.q, still, still, np.zeros(native.nlambda), k)
        return linearise(native, k, 0.0, steady.q, steady.v, steady.axes), tip, steady.spin

    return at


def frequencies(**values: float) -> np.ndarray:
    linear, _, spin = beam()(**values)
    return np.sort(eigenvalues(linear.A, spin).frequencies)


@pytest.mark.long
def test_frequencies_and_compliances_of_component_modes() -> None:
    """Ten vibration modes beside the static ones, held by the mean motion of the root, with a Poisson ratio of 0.3.

    The solid is 2.7e-3 and 1.7e-2 below the beam in its wide plane, and 2.7e-3 more compliant, for shear; torsion is
    2.6e-3 lower, since the mean motion holds the root with less than its section. No other frequency is below those.
    """
    held = solid.component_modes("craig_bampton", 16, 0.3)
    twist = solid.shear_modulus(0.3) * solid.torsion_constant()
    own = frequencies(GJ=twist)
    assert own[0] / solid.UNIT == pytest.approx(BERNOULLI[0], rel=1e-4)
    assert own[:3] == pytest.approx([held.thin[0], held.wide[0], held.thin[1]], rel=6e-3)
    assert np.abs(own / held.torsion[0] - 1).min() == pytest.approx(2.6e-3, abs=3e-4)
    for plane, stiffness, side, of in (
        (0, solid.STIFF, solid.WIDTH, held.wide),
        (1, solid.SOFT, solid.THICKNESS, held.thin),
    ):
        exact, compliance = solid.timoshenko(stiffness, side, 0.3)
        unit = np.sqrt(stiffness / solid.MASS)
        assert of[:2] == pytest.approx(exact[:2], rel=2.5e-3) and of[0] == pytest.approx(exact[0], rel=3e-4)
        assert held.sway[plane] == pytest.approx(compliance, rel=4e-4)
        sway = beam()(GJ=twist, **{"PF"[plane]: 1.0})[1][plane + 1]
        assert abs(sway) == pytest.approx(solid.LENGTH**3 / (3 * stiffness), rel=1e-6)
        if plane == 0:
            assert of[:2] / unit / BERNOULLI - 1 == pytest.approx([-2.7e-3, -1.73e-2], rel=0.05)
            assert held.sway[0] / abs(sway) - 1 == pytest.approx(2.7e-3, rel=0.05)


@cache
def module() -> dict[str, Any]:
    names: dict[str, Any] = {}
    equations = derive.derive_modal(solid.clamped(16), None, "loops")
    exec(PythonBackend().files(derive.lower(equations), "clamped")[0].text, names)
    return names


def of_solid(spin: float) -> np.ndarray:
    """The frequencies of the clamped solid whose frame turns about e2; the plane of the spin has those of lag."""
    names, body = module(), solid.clamped(16)
    k = names["setup"](np.array(names["DEFAULTS"]))
    v = np.concatenate([[0, 0, 0, 0, spin, 0], np.zeros(body.modes)])

    def forces(alpha: np.ndarray) -> np.ndarray:
        return names["force"](0.0, np.concatenate([[0, 0, 0, 1, 0, 0, 0], alpha]), v, k)[6:]

    still = forces(np.zeros(body.modes))
    stiffness = np.array([forces(e) - still for e in np.eye(body.modes)])
    return np.sqrt(eigh((stiffness + stiffness.T) / 2, body.c8, eigvals_only=True))


@pytest.mark.long
def test_a_rotating_solid_stiffens_as_the_beam_in_lag_and_in_flap() -> None:
    """Up to twice the lowest frequency: lag to 2e-3, flap as much lower as at rest, which is shear."""
    twist = solid.shear_modulus(0.0) * solid.torsion_constant()
    at_rest = of_solid(0.0)[1] / frequencies(GJ=twist)[1] - 1
    assert at_rest == pytest.approx(-2.3e-3, abs=2e-4)
    for spin, limit in ((4, 3e-4), (8, 2.2e-3)):
        lag, flap = of_solid(spin * solid.UNIT)[:2]
        own = frequencies(GJ=twist, mu=spin * solid.UNIT)
        assert lag / own[0] - 1 == pytest.approx(0, abs=limit)
        assert flap / own[1] - 1 == pytest.approx(at_rest, abs=5e-4)
        assert lag / solid.UNIT > 1.1 * BERNOULLI[0]  # a body of first order has lost its stability here


@pytest.mark.long
def test_lateral_buckling_of_a_solid_and_of_the_beam() -> None:
    """The solid buckles at 4.013 sqrt(EI GJ)/l^2 with the warping that its root restrains: 2.3 % more.

    Its geometric stiffness is that of the straight beam. The beam in space deflects in the plane of the load before it
    buckles, by which the load is 1/(1 - EI/EI_3) times as large, a 15th more here; its root warps.
    """
    body, twist = solid.clamped(16), solid.shear_modulus(0.0) * solid.torsion_constant()
    size = np.sqrt(solid.SOFT * twist) / solid.LENGTH**2
    second = body.points[0].second
    assert second is not None
    load = 1 / eigh(-second[:, :, 1], body.stiffness, eigvals_only=True)[-1] / size
    gamma = (solid.WIDTH * solid.THICKNESS) ** 3 / 144  # of a thin rectangle
    restrained = solid.lateral_buckling(float(np.sqrt(solid.YOUNG * gamma / twist)) / solid.LENGTH)
    free = solid.lateral_buckling(0.0)
    assert free == pytest.approx(4.0126, abs=1e-4)
    assert load == pytest.approx(restrained, rel=4e-3) and load > 1.02 * free
    lost = free / (1 - solid.SOFT / solid.STIFF)

    def grows(part: float) -> bool:
        linear, _, _ = beam()(GJ=twist, P=part * lost * size)
        return bool(np.linalg.eigvals(linear.A).real.max() > 1e-3 * solid.UNIT)

    assert not grows(0.998) and grows(1.01)
