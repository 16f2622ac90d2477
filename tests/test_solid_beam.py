"""A slender beam of solid elements under spin: against the planar beam of second order, and a rotating cantilever.

The solid beams have Poisson's ratio 0 and are 100 times as long as thick and 50 times as long as wide. They differ from
Euler-Bernoulli beams by shear and rotary inertia, which lower the first two frequencies by 1e-4 and 7e-4 (thick), 1e-3
and 3e-3 (wide), by the mesh of quadratic bricks, which raises them by about as much, and by the number of modes. Limits
are a little above the largest differences.
"""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh

import derive
from clamped_response import clamped_response
from conftest import ROOT
from derive import ModalBody
from derive.backends.c.source import CBackend
from derive.backends.python.backend import PythonBackend
from derive.reduction.mesh_stiffening import geometric_stiffness_tables
from derive.simulation.errors import MassMatrixNotDefinite
from derive.solids.stresses import IntegratedMesh
from free_block import drifts, march

sys.path.insert(0, str(ROOT / "scenes"))
import make_solid_beam as solid_beam

FLAPWISE = {2: 4.1373, 4: 5.5850, 6: 7.3603, 8: 9.2568, 10: 11.2023}
"""Lowest flapwise frequency of a cantilever at spins about its root, both over sqrt(EI/(m l^3)): Hamza-cherif and
Houmat, ICAS 24 (2004), table 2. An inextensible beam has chordwise^2 = flapwise^2 - spin^2."""
GREENHILL, EULER = 7.8373, np.pi**2 / 4
"""m g l^2/EI of a column that buckles under its weight, and P l^2/EI of one under a force at its tip."""
MASS = solid_beam.DENSITY * np.prod(solid_beam.SIDES)
WIDTH, THICKNESS = solid_beam.SIDES[1:]


def unit(side: float) -> float:
    """sqrt(EI/(m l^3)) of bending along a side of the section, rad/s."""
    area = WIDTH * THICKNESS
    return float(np.sqrt(solid_beam.YOUNG * area * side**2 / 12 / MASS))


@cache
def free_body(order: int) -> ModalBody:
    nodes = str(ROOT / "scenes/solid_beam.npz")
    return derive.modal(derive.nodal_body("free", nodes, units="SI", order=order, markers={"tip": 392}))


@cache
def clamped_body(order: int) -> ModalBody:
    """Modes clamped at the left end, where the body frame is; the mesh is coarser than that of the file."""
    beam = solid_beam.beam(bricks=(16, 1, 1), left=0.0)
    fixed = np.flatnonzero(np.repeat(beam.positions[:, 0] == 0, 3))
    moving = np.setdiff1d(np.arange(beam.stiffness.shape[0]), fixed)
    full = np.kron(beam.mass.toarray(), np.eye(3))
    k = beam.stiffness.toarray()
    squares, vectors = eigh(k[np.ix_(moving, moving)], full[np.ix_(moving, moving)], subset_by_index=(0, 9))
    modes = np.zeros((10, len(k)))
    modes[:, moving] = vectors.T
    phi, tip = modes.reshape(10, -1, 3), solid_beam.ends(beam.positions)[1:]
    respond = clamped_response(beam.stiffness, fixed)
    arrays = {
        "positions": beam.positions,
        "mass": beam.mass,
        "modes": phi,
        "modal_stiffness": squares,
        **geometric_stiffness_tables(IntegratedMesh(beam.mesh, beam.positions), beam.mass, phi, tip, respond),
    }
    keys = {"units": "SI", "frame": "given", "orthonormal": False, "markers": {"tip": tip[0]}}
    return derive.modal(derive.nodal_body("clamped", arrays, order=order, **keys))


def python_module(equations: Any) -> dict[str, Any]:
    names: dict[str, Any] = {}
    exec(PythonBackend().files(derive.lower(equations), "test")[0].text, names)
    return names


@cache
def solid_module(kind: str, order: int) -> dict[str, Any]:
    body = {"free": free_body, "clamped": clamped_body}[kind](order)
    return python_module(derive.derive_modal(body, None, "loops"))


def modal_forces(kind: str, order: int, alpha: np.ndarray, omega: np.ndarray) -> np.ndarray:
    """The rows of the amplitudes at unit attitude and with a given angular velocity, all accelerations zero."""
    module = solid_module(kind, order)
    q = np.concatenate([[0, 0, 0, 1, 0, 0, 0], alpha])
    v = np.concatenate([[0, 0, 0], omega, 0 * alpha])
    return module["force"](0.0, q, v, module["setup"](np.array(module["DEFAULTS"])))[6:]


def frequencies(kind: str, bending: int, axis: int, spin: float, order: int = 2) -> np.ndarray:
    """Natural frequencies squared over (EI/(m l^3)) of bending along an axis, 1 or 2, at a steady spin about an axis.

    The body frame is held at the spin; its motion couples with bending to second order alone.
    """
    body = {"free": free_body, "clamped": clamped_body}[kind](order)
    size, n = unit(solid_beam.SIDES[bending]), body.modes
    omega = spin * size * np.eye(3)[axis]
    still = modal_forces(kind, order, np.zeros(n), omega)
    stiffness = np.array([modal_forces(kind, order, e, omega) - still for e in np.eye(n)]).T
    assert np.allclose(stiffness, stiffness.T, atol=1e-9 * np.abs(stiffness).max())
    tip = body.points[-1].shapes
    modes = np.flatnonzero(np.abs(tip).argmax(axis=1) == bending)
    return eigh(stiffness[np.ix_(modes, modes)], body.c8[np.ix_(modes, modes)], eigvals_only=True) / size**2


@cache
def planar() -> dict[str, Any]:
    ansatz = [f"xi^{k}" if k else "1" for k in range(10)]
    beam = derive.planar_beam("beam", ansatz=ansatz, mass=1, length=1, bending_stiffness=1, order=2)
    return python_module(derive.derive(beam))


def planar_frequencies(spin: float) -> np.ndarray:
    """The frequencies of the planar beam of second order with P2 .. P9."""
    module, v = planar(), np.zeros(11)
    k, v[2] = module["setup"](np.array(module["DEFAULTS"])), spin
    columns = [module["force"](0.0, np.concatenate([[0, 0, 0], e]), v, k)[3:] for e in np.eye(8)]
    mass = module["dense"](module["MASS"], module["mass"](np.zeros(11), k))[3:, 3:]
    return eigh(np.array(columns).T, mass, eigvals_only=True)


@pytest.mark.parametrize("spin", [0.0, 10.0, 20.0, 26.83, 40.0, 60.0])
def test_a_free_beam_stiffens_as_the_planar_beam_of_second_order(spin: float) -> None:
    """Bending in the plane of the spin, on the thin and on the wide side."""
    expected = np.sqrt(planar_frequencies(spin)[:2])
    thin = np.sqrt(frequencies("free", bending=2, axis=1, spin=spin)[:2])
    wide = np.sqrt(frequencies("free", bending=1, axis=2, spin=spin)[:2])
    assert np.all(np.abs(thin / expected - 1) < [3e-4, 1.4e-3]), thin / expected - 1
    assert np.all(np.abs(wide / expected - 1) < [1.1e-3, 1.3e-2]), wide / expected - 1  # three modes, to spin 60


def test_a_free_beam_of_first_order_softens() -> None:
    """omega^2 - spin^2 as in (41), lost above the lowest frequency; that of second order stays positive."""
    still = frequencies("free", 2, 1, 0.0, order=1)
    for spin in (10.0, 30.0):
        assert frequencies("free", 2, 1, spin, order=1) == pytest.approx(still - spin**2, rel=1e-9)
    assert frequencies("free", 2, 1, 30.0, order=1)[0] < -390
    for bending, axis in ((1, 1), (1, 2), (2, 1), (2, 2), (1, 0), (2, 0)):
        lowest = [frequencies("free", bending, axis, spin)[0] for spin in (0.0, 10.0, 20.0)]
        assert lowest[0] > 499 and (axis == 0 or lowest[0] < lowest[1] < lowest[2]), (bending, axis, lowest)


@pytest.mark.parametrize("spin", FLAPWISE)
@pytest.mark.parametrize("bending", [1, 2])
def test_a_clamped_beam_is_the_rotating_cantilever(bending: int, spin: int) -> None:
    """Largest differences: flapwise 9.1e-4 and chordwise 4.6e-3 at spin 10, of the four or five modes; below 5.5e-4 and
    9.5e-4 up to spin 4, of the mesh and the section."""
    flapwise = float(np.sqrt(frequencies("clamped", bending, bending, spin)[0]))
    chordwise = float(np.sqrt(frequencies("clamped", bending, 3 - bending, spin)[0]))
    expected = FLAPWISE[spin]
    assert flapwise == pytest.approx(expected, rel=6e-4 if spin <= 4 else 1e-3)
    assert chordwise == pytest.approx(np.sqrt(expected**2 - spin**2), rel=1e-3 if spin <= 4 else 5e-3)
    assert flapwise**2 - chordwise**2 == pytest.approx(spin**2, rel=4e-4)


def test_a_column_buckles_under_its_weight_and_under_a_force() -> None:
    """K0t and K0F have the sign of a stiffness. One mode is .5 and 7.8 % off, five are 9e-4 and 1.1e-3."""
    body, size = clamped_body(2), unit(THICKNESS) ** 2
    names = python_module(derive.derive_modal(body, None, "loops"))
    k = names["setup"](np.array(names["DEFAULTS"]))
    tip = body.points[0]
    modes = np.flatnonzero(np.abs(tip.shapes).argmax(axis=1) == 2)

    def critical(geometric: np.ndarray) -> float:
        of_modes = np.ix_(modes, modes)
        return float(1 / eigh(-geometric[of_modes], body.stiffness[of_modes], eigvals_only=True)[-1])

    def load(alpha: np.ndarray) -> np.ndarray:
        q = np.concatenate([[0, 0, 0, 1, 0, 0, 0], alpha])
        return names["load_tip"](q, np.array([-1.0, 0, 0]), k)[6:]

    compressed = np.array([load(np.zeros(body.modes)) - load(e) for e in np.eye(body.modes)])
    assert critical(compressed) / (MASS * size) == pytest.approx(EULER, rel=1.5e-3)
    standing = body.c9[:, :, 0]  # K0t_1, of an acceleration upwards or of gravity downwards
    assert critical(standing) / size == pytest.approx(GREENHILL, rel=1.5e-3)


@pytest.mark.long
def test_a_run_conserves_energy_and_momenta() -> None:
    """Spun twice as fast as a body of first order withstands, bent by 2 % of its length: 12 turns.

    The change of the energy is 3.7e-8, and 1.3e-9 with half the step.
    """
    model = derive.lower(derive.derive_modal(free_body(2)))
    native = derive.load(CBackend().files(model, "test"), ("-std=c99", "-O0", "-ffp-contract=off"))
    k, spin = native.setup(), 45 * unit(THICKNESS)
    q = np.concatenate([[0.1, -0.2, 0.3, 1, 0, 0, 0], [0.008, 0.002, 0.0, 0, 0, 0, 0, 0]])
    v = np.concatenate([[1.0, -2.0, 3.0], [20.0, spin, 5.0], np.zeros(8)])
    steps = 2400
    qs, vs = march(native, k, q, v, 12 * 2 * np.pi / spin / steps, steps, every=40)
    assert drifts(native, k, qs, vs).max() < 2e-7
    first = qs[:, 7]
    assert np.abs(first).max() < 0.02 and np.count_nonzero(np.diff(np.sign(first))) > 10  # it oscillates


def test_second_order_costs_five_operations() -> None:
    """In the mean frame only C5 changes, of which fewer entries are equal: M and h of eight modes."""
    operations = [derive.lower(derive.derive_modal(free_body(n))).kernel("mass_force").operations for n in (1, 2)]
    assert operations == [449, 454]


def test_a_model_of_another_order_is_refused() -> None:
    symbolic = derive.symbolic_body("any", 8)
    assert derive.parameters(free_body(1), symbolic)[0] == pytest.approx(MASS)
    with pytest.raises(ValueError, match="free is a body of second order in the amplitudes, and the model is not"):
        derive.parameters(free_body(2), symbolic)


def test_a_body_that_bends_too_far_is_named(tmp_path: Path) -> None:
    """The truncated kinetic energy is indefinite at a deflection of length/3; the message has the remedy."""
    (tmp_path / "solid_beam.npz").symlink_to(ROOT / "scenes/solid_beam.npz")
    text = (ROOT / "scenes/solid_beam.toml").read_text()
    start = "[body.start]\nangular_velocity = [0, 100, 0]\namplitudes = [0.18]\n[simulation]\nduration = 1e-3\n"
    (tmp_path / "far.toml").write_text(f"{text}\n{start}output = 1e-3\n")
    with pytest.raises(MassMatrixNotDefinite, match=r"deforms too far .* leave \d+ % of .* order = 1 leaves out"):
        derive.simulate(derive.read(tmp_path / "far.toml"))
