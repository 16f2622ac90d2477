"""Makes block.npz: a free aluminium block by finite elements, as any finite-element program could give it.

    python scenes/make_block.py

needs scikit-fem (`pip install 'tisserand[test]'`). The block has three different sides along e1, e2, e3 and its first
corner in the origin. It is meshed with quadratic bricks of 27 nodes, with a consistent mass matrix. The file holds what
`[body] nodes = "block.npz"` reads, in SI units:

    positions (nodes, 3)                       of all nodes, those on edges, on faces and inside of bricks among them
    mass_row, mass_col, mass_value             the matrix m of M = m (x) I3, int rho f_a f_b of the shape functions
    stiffness_row, stiffness_col, ..._value    the stiffness matrix, the three displacements of a node together
    modes (N, nodes, 3), modal_stiffness (N,)  the lowest elastic modes, orthonormal in the mass, and omega^2

The modes could be left out, to be computed from the matrices. They are here because the last digits of computed modes
differ between machines, while numbers in a file give the same code everywhere. For the same reason the file is kept
beside this script: the same versions of scikit-fem, NumPy and SciPy on the same machine make the same bytes.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import coo_array, csr_array
from skfem import Basis, ElementHex2, ElementVector, MeshHex
from skfem.models.elasticity import lame_parameters, linear_elasticity
from skfem.models.poisson import mass

SIDES = (0.4, 0.1, 0.06)  # m
BRICKS = (8, 2, 1)
YOUNG, POISSON, DENSITY = 70e9, 0.33, 2700.0  # Pa, 1, kg/m^3
MODES = 12


class Block(NamedTuple):
    """Nodes sorted by x1, x2, x3; the scalar mass matrix; the stiffness, the displacements of a node together."""

    positions: np.ndarray
    mass: csr_array
    stiffness: csr_array


def mesh_block() -> Block:
    """Assemble the block."""
    scalar, vector, order = bases()
    triples = (3 * order[:, None] + np.arange(3)).ravel()
    m = csr_array(mass.assemble(scalar))[order][:, order] * DENSITY
    k = csr_array(linear_elasticity(*lame_parameters(YOUNG, POISSON)).assemble(vector))[triples][:, triples]
    return Block(np.round(scalar.doflocs.T[order], 12), symmetric(m), symmetric(k))


def bases() -> tuple[Basis, Basis, np.ndarray]:
    """The bases of the mesh for numbers and for displacements, and the sorted order of their nodes."""
    mesh = MeshHex.init_tensor(*(np.linspace(0, side, n + 1) for side, n in zip(SIDES, BRICKS, strict=True)))
    scalar = Basis(mesh, ElementHex2(), intorder=5)
    vector = Basis(mesh, ElementVector(ElementHex2()), intorder=5)
    assert np.array_equal(np.repeat(scalar.doflocs, 3, axis=1), vector.doflocs), "displacements of a node are together"
    return scalar, vector, np.lexsort(np.round(scalar.doflocs[::-1], 9))


def symmetric(matrix: csr_array) -> csr_array:
    """Without what rounding makes of entries that are the same, or zero."""
    largest = np.abs(matrix.data).max()
    found = csr_array((matrix + matrix.T) / 2)
    found.data[np.abs(found.data) < 1e-13 * largest] = 0
    found.eliminate_zeros()
    return found


def elastic_modes(block: Block) -> tuple[np.ndarray, np.ndarray]:
    """The lowest elastic modes (MODES, nodes, 3), and omega^2. This mesh is small: all of K and M at once."""
    full = np.kron(block.mass.toarray(), np.eye(3))
    squares, vectors = eigh(block.stiffness.toarray(), full, subset_by_index=(0, 6 + MODES - 1))
    assert squares[5] < 1e-6 * squares[6], "six rigid motions"
    modes = vectors.T[6:].reshape(MODES, -1, 3)
    signs = np.sign(modes.reshape(MODES, -1)[:, :3].sum(axis=1))  # of the displacements of the first corner
    return modes * signs[:, None, None], squares[6:]


def arrays() -> dict[str, np.ndarray]:
    """What goes into the file."""
    block = mesh_block()
    modes, squares = elastic_modes(block)
    matrices = {"mass": coo_array(block.mass), "stiffness": coo_array(block.stiffness)}
    entries = {
        f"{name}_{part}": values
        for name, matrix in matrices.items()
        for part, values in zip(("row", "col", "value"), (*matrix.coords, matrix.data), strict=True)
    }
    return {
        "positions": block.positions,
        **entries,
        "modes": modes,
        "modal_stiffness": squares,
    }


if __name__ == "__main__":
    np.savez_compressed(Path(__file__).with_name("block.npz"), **arrays())
