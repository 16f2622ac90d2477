"""Geometric stiffness of meshes: from the second-order fields themselves, and from the stresses of unit loads."""

from __future__ import annotations

import sys
from functools import cache

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse import csr_array
from skfem import Basis, BilinearForm, ElementHex2, ElementVector, MeshHex
from skfem.helpers import dot, eye, sym_grad, trace
from skfem.models.elasticity import lame_parameters, linear_elasticity

import derive
from clamped_response import clamped_response
from conftest import ROOT
from derive.reduction.mesh_stiffening import OMEGA_PRODUCTS, free_response, geometric_stiffness_tables
from derive.solids.stresses import IntegratedMesh

sys.path.insert(0, str(ROOT / "scenes"))
import make_solid_beam as solid_beam
from geometric_stiffness import brick_mesh, stiffened_block

NODES = (3, 40)
NAMES = ("K0t", "K0r", "K0omega", "K0F")


class Problem:
    """A bar with a crooked mesh: its modes, and the solutions of static problems."""

    def __init__(self, fixed: bool) -> None:
        mesh = MeshHex.init_tensor(np.linspace(0, 0.5, 4), np.linspace(0, 0.11, 2), np.linspace(0, 0.07, 2))
        mesh = mesh.translated((0.02, -0.04, 0.01))
        points = mesh.p + 0.01 * np.random.default_rng(3).uniform(-1, 1, mesh.p.shape)
        self.basis = basis = Basis(MeshHex(points, mesh.t), ElementVector(ElementHex2()), intorder=7)
        self.x = basis.doflocs[:, ::3].T
        self.k = csr_array(linear_elasticity(*lame_parameters(3e9, 0.3)).assemble(basis))
        self.m = csr_array(BilinearForm(lambda u, v, w: 900.0 * dot(u, v)).assemble(basis))
        held = np.flatnonzero(np.repeat(self.x[:, 0] < 0.035, 3)) if fixed else np.array([], dtype=int)
        moving = np.setdiff1d(np.arange(basis.N), held)
        k, m = (a.toarray()[np.ix_(moving, moving)] for a in (self.k, self.m))
        first = 0 if fixed else 6
        self.modes = np.zeros((3, basis.N))
        self.squares, vectors = eigh(k, m, subset_by_index=(first, first + 2))
        self.modes[:, moving] = vectors.T
        self.scalar = csr_array(self.m[::3][:, ::3])
        self.solve = clamped_response(self.k, held) if fixed else free_response(self.x, self.scalar, self.k)

    @property
    def k0(self) -> dict[str, np.ndarray]:
        phi = self.modes.reshape(3, -1, 3)
        mesh = brick_mesh(self.basis, 3e9, 0.3)
        return geometric_stiffness_tables(IntegratedMesh(mesh, self.x), self.scalar, phi, NODES, self.solve)

    def stressed(self, load: np.ndarray) -> np.ndarray:
        """The integrals of sigma : (grad Phi_i^T grad Phi_j) with the stress of the static response to a load."""
        lam, mu = lame_parameters(3e9, 0.3)
        basis = self.basis
        gradients = [basis.interpolate(mode).grad for mode in self.modes]
        still = np.zeros((1, *self.x.shape))
        strain = sym_grad(basis.interpolate(self.solve(load[None], still, still)[0]))
        sigma = np.asarray(2 * mu * strain + lam * eye(trace(strain), 3))
        pulled = [np.einsum("kl...,ml...->mk...", sigma, g) * basis.dx for g in gradients]
        return np.array([[np.vdot(p, g) for g in gradients] for p in pulled])


@cache
def problem(fixed: bool) -> Problem:
    return Problem(fixed)


@pytest.mark.parametrize("fixed", [True, False])
def test_second_order_fields_do_the_work_of_the_stresses_of_unit_loads(fixed: bool) -> None:
    """The theorem of Betti in the same finite elements: to rounding."""
    of = problem(fixed)
    k0, axes = of.k0, np.eye(3)

    def accelerated(field: np.ndarray) -> np.ndarray:
        return of.stressed(-(of.m @ field.ravel()))

    def spin(a: int, b: int) -> np.ndarray:
        both = np.cross(axes[a], np.cross(axes[b], of.x)) + np.cross(axes[b], np.cross(axes[a], of.x))
        return both / 2 if a == b else both

    units = np.eye(of.x.size)
    expected = {
        "K0t": np.array([accelerated(np.tile(e, (len(of.x), 1))) for e in axes]),
        "K0r": np.array([accelerated(np.cross(e, of.x)) for e in axes]),
        "K0omega": np.array([accelerated(spin(a, b)) for a, b in OMEGA_PRODUCTS]),
        "K0F": np.array([[of.stressed(units[3 * node + k]) for k in range(3)] for node in NODES]),
    }
    for name in NAMES:
        size = np.abs(expected["K0omega" if name != "K0F" else name]).max()
        assert np.abs(k0[name] - expected[name]).max() < 1e-8 * size, name
    assert (np.abs(k0["K0t"]).max() > 0.1) == (np.abs(k0["K0r"]).max() > 0.001) == fixed


def test_a_free_body_needs_no_condition_of_the_mean_frame() -> None:
    """Inertia relief is the mean frame: its conditions change nothing of the second-order fields."""
    of = problem(False)
    arrays = {"positions": of.x, "mass": of.scalar, "modes": of.modes.reshape(3, -1, 3), "modal_stiffness": of.squares}
    keys = {"units": "SI", "orthonormal": False, "markers": {"end": NODES[1]}}
    given, mean = (derive.modal(derive.nodal_body("b", arrays | of.k0, frame=f, **keys)) for f in ("given", "mean"))
    assert np.allclose(given.points[0].second, mean.points[0].second, atol=1e-7 * np.abs(mean.points[0].second).max())
    assert np.allclose(given.C5, mean.C5, atol=1e-7 * np.abs(mean.C5).max())


def test_the_block_stiffens() -> None:
    """Its mirror planes leave as many integrals as without; spin about e2 and e3 stiffens, about e1 hardly."""
    arrays = stiffened_block()
    one, two = (derive.modal(derive.nodal_body("block", arrays, units="SI", modes=4, order=n)) for n in (1, 2))
    names = {name for name, why in one.zeros.items() if why.startswith("mirror")}
    assert names and names <= set(two.zeros) and not two.c9.any() and not two.c10.any()
    geometric = np.array([np.diag(-(two.C5 - one.C5)[..., k, k]) for k in range(3)])
    assert np.all(geometric[1:, :2] > 1.5) and np.all(np.abs(geometric[0]) < 0.3 * geometric[1:].max())
    assert np.allclose(geometric, np.array([np.diag(k)[:4] for k in arrays["K0omega"][:3]]), atol=1e-9)


def test_the_kept_file_is_what_the_script_makes() -> None:
    """The matrices of the modes in solid_beam.npz; the modes depend on the machine in their last digits."""
    kept = np.load(ROOT / "scenes/solid_beam.npz")
    beam = solid_beam.beam()
    assert np.array_equal(kept["positions"], beam.positions)
    modes = kept["modes"].reshape(len(kept["modes"]), -1)
    stiffness = np.einsum("ia,ia->i", modes, (beam.stiffness @ modes.T).T)
    assert np.allclose(stiffness, kept["modal_stiffness"], rtol=1e-6)
    made = solid_beam.geometric_stiffness(beam, kept["modes"])
    for name in ("K0omega", "K0F", "K0F_nodes"):
        assert np.allclose(kept[name], made[name], rtol=0, atol=1e-7 * np.abs(made[name]).max()), name
