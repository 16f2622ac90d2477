"""Geometric stiffness of the modes of a solid body, from its mesh with scikit-fem; here for the block of make_block.py.

    python scenes/geometric_stiffness.py stiffened_block.npz

needs scikit-fem (`pip install 'tisserand[test]'`). A body that bends also moves along its axis, to second order in its
deflection, because it resists stretching; loads along the axis then do work on the bending. This is what the matrices
K0 describe, by which a body stiffens under spin. The steps, for each unit load:

1. the static displacement of the linear body under the load. A free body is not held by any support; its load is
   balanced by the inertia forces of a rigid acceleration (inertia relief), which is what the mean frame needs: there
   K0t and K0r vanish. A body whose modes are clamped has the loads on its clamped nodes carried by the clamps;
2. the stress sigma of that displacement, at the points of integration;
3. the matrix K0_ij = int sigma : (grad Phi_i^T grad Phi_j) of the modes Phi_i.

The loads are -rho e_k (K0t), -rho e_k x X (K0r) and -rho omega x (omega x X) for the products of omega (K0omega), which
are the inertia forces of unit accelerations, and unit forces at nodes (K0F). The file that the script writes holds the
arrays of block.npz and these matrices, K0F for the nodes of MARKERS; the key `nodes` of a specification reads it.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.sparse import block_array, csr_array
from scipy.sparse.linalg import splu
from skfem import Basis, LinearForm
from skfem.helpers import dot, eye, sym_grad, trace
from skfem.models.elasticity import lame_parameters, linear_elasticity

AXES = np.eye(3)
OMEGA_PRODUCTS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))
MARKERS = (0, 127, 247)  # of block.toml

Field = Callable[[np.ndarray], np.ndarray]
Solve = Callable[[np.ndarray], np.ndarray]


class Solid(NamedTuple):
    """A linear elastic body: the basis of its displacements, the three of a node together, and its material."""

    basis: Basis
    young: float
    poisson: float
    density: float


def matrices(solid: Solid, modes: np.ndarray, nodes: Sequence[int], solve: Solve) -> dict[str, np.ndarray]:
    """K0t, K0r, K0omega, K0F and K0F_nodes of modes (N, displacements), in SI units.

    nodes: those of K0F, by their place in the basis. solve: the displacement due to a load, see `free` and `clamped`.
    """
    fine = Basis(solid.basis.mesh, solid.basis.elem, intorder=7)  # the integrand has twice the degree of the stiffness
    gradients = [fine.interpolate(mode).grad for mode in modes]

    def of_field(field: Field) -> np.ndarray:
        form = LinearForm(lambda v, w: -solid.density * dot(field(w.x), v))
        return of_load(form.assemble(fine))

    def of_load(load: np.ndarray) -> np.ndarray:
        return stressed(fine, stress(solid, fine, solve(load)), gradients)

    def force(node: int, k: int) -> np.ndarray:
        return np.bincount([3 * node + k], minlength=solid.basis.N).astype(float)

    return {
        "K0t": np.array([of_field(translation(k)) for k in range(3)]),
        "K0r": np.array([of_field(rotation(k)) for k in range(3)]),
        "K0omega": np.array([of_field(spin(a, b)) for a, b in OMEGA_PRODUCTS]),
        "K0F": np.array([[of_load(force(node, k)) for k in range(3)] for node in nodes]),
        "K0F_nodes": np.array(nodes, dtype=np.int64),
    }


def translation(k: int) -> Field:
    """The acceleration field e_k."""
    return lambda x: AXES[k].reshape(3, *(1,) * (x.ndim - 1)) + 0 * x


def rotation(k: int) -> Field:
    """The acceleration field e_k x X."""
    return lambda x: np.cross(AXES[k], x, axisb=0, axisc=0)


def spin(a: int, b: int) -> Field:
    """The factor of omega_a omega_b in the acceleration field omega x (omega x X)."""
    first, second = rotation(a), rotation(b)
    return lambda x: first(first(x)) if a == b else first(second(x)) + second(first(x))


def stress(solid: Solid, basis: Basis, displacement: np.ndarray) -> np.ndarray:
    """The stress (3, 3, elements, points) of a displacement, by the law of Hooke."""
    lam, mu = lame_parameters(solid.young, solid.poisson)
    strain = sym_grad(basis.interpolate(displacement))
    return np.asarray(2 * mu * strain + lam * eye(trace(strain), 3))


def stressed(basis: Basis, sigma: np.ndarray, gradients: Sequence[np.ndarray]) -> np.ndarray:
    """The integrals (N, N) of sigma : (grad Phi_i^T grad Phi_j), with gradients[i][m, k] = d Phi_i,m / d x_k."""
    pulled = [np.einsum("kl...,ml...->mk...", sigma, g) * basis.dx for g in gradients]
    result = np.array([[np.vdot(p, g) for g in gradients] for p in pulled])
    return (result + result.T) / 2


def clamped(stiffness: csr_array, fixed: np.ndarray) -> Solve:
    """The static response of a body with some displacements held; loads on these have no effect."""
    moving = np.setdiff1d(np.arange(stiffness.shape[0]), fixed)
    factors = splu(stiffness[moving][:, moving].tocsc())

    def solve(load: np.ndarray) -> np.ndarray:
        result = np.zeros(len(load))
        result[moving] = factors.solve(load[moving])
        return result

    return solve


def free(stiffness: csr_array, mass: csr_array, positions: np.ndarray) -> Solve:
    """The static response of a free body to a load with inertia relief, without mean displacement and rotation.

    mass: of all displacements; positions (nodes, 3). The multipliers of the conditions int rho u = 0 and
    int rho X x u = 0 are the rigid acceleration whose inertia forces balance the load.
    """
    rigid = np.array([*(np.tile(e, len(positions)) for e in AXES), *(np.cross(e, positions).ravel() for e in AXES)])
    conditions = mass @ rigid.T
    border = csr_array(conditions * (abs(stiffness).max() / np.abs(conditions).max()))
    factors = splu(block_array([[stiffness, border], [border.T, None]], format="csc"))
    return lambda load: factors.solve(np.concatenate([load, np.zeros(6)]))[: len(load)]


def stiffened_block() -> dict[str, np.ndarray]:
    """The arrays of the block with its geometric stiffness matrices."""
    import make_block as block
    from skfem import ElementHex2, ElementVector, MeshHex

    arrays = block.arrays()
    sides = (np.linspace(0, side, n + 1) for side, n in zip(block.SIDES, block.BRICKS, strict=True))
    basis = Basis(MeshHex.init_tensor(*sides), ElementVector(ElementHex2()), intorder=5)
    solid = Solid(basis, block.YOUNG, block.POISSON, block.DENSITY)
    positions = basis.doflocs[:, ::3].T
    order = np.lexsort(np.round(positions.T[::-1], 9))  # the file has the nodes sorted
    place = np.argsort(order)
    modes = arrays["modes"][:, place].reshape(len(arrays["modes"]), -1)
    stiffness = csr_array(linear_elasticity(*lame_parameters(solid.young, solid.poisson)).assemble(basis))
    entries = (arrays["mass_value"], (order[arrays["mass_row"]], order[arrays["mass_col"]]))
    scalar = csr_array(entries, shape=(len(order),) * 2)
    mass = csr_array(np.kron(scalar.toarray(), np.eye(3)))
    geometric = matrices(solid, modes, [int(order[node]) for node in MARKERS], free(stiffness, mass, positions))
    return arrays | geometric | {"K0F_nodes": np.array(MARKERS)}


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python scenes/geometric_stiffness.py FILE.npz")
    np.savez_compressed(Path(sys.argv[1]), **stiffened_block())
