"""Makes solid_beam.npz: a slender free aluminium beam of solid elements, with its geometric stiffness matrices.

    python scenes/make_solid_beam.py

needs scikit-fem (`pip install 'tisserand[test]'`). The beam lies along e1 and is twice as wide along e2 as it is thick
along e3. It is meshed with quadratic bricks of 27 nodes. The arrays are those of block.npz without the stiffness
matrix, which modes that are given do not need, and K0omega and K0F, the latter for the node in the middle of each end.
K0t and K0r of a free body vanish and are left out. Poisson's ratio is zero, so that the beam bends as the theory of
beams assumes.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from geometric_stiffness import brick_mesh
from scipy.linalg import eigh
from scipy.sparse import coo_array, csr_array, kron
from skfem import Basis, ElementHex2, ElementVector, MeshHex
from skfem.models.elasticity import lame_parameters, linear_elasticity
from skfem.models.poisson import mass

from derive.reduction.mesh_stiffening import free_response, geometric_stiffness_tables
from derive.solids.stresses import SolidMesh
from derive.spec.model.mesh import NodeMesh

SIDES = (1.0, 0.02, 0.01)  # m
BRICKS = (24, 1, 1)
YOUNG, POISSON, DENSITY = 70e9, 0.0, 2700.0  # Pa, 1, kg/m^3
MODES = 8


class Beam(NamedTuple):
    """Nodes as in the basis; the mass matrix of the nodes, the stiffness matrix, and the elements."""

    positions: np.ndarray
    mass: csr_array
    stiffness: csr_array
    mesh: NodeMesh


def beam(
    sides: tuple[float, ...] = SIDES,
    bricks: tuple[int, ...] = BRICKS,
    left: float = -SIDES[0] / 2,
    poisson: float = POISSON,
) -> Beam:
    """The beam from x1 = left on, with its axis on that of x1."""
    starts = (left, -sides[1] / 2, -sides[2] / 2)
    axes = (np.linspace(a, a + side, n + 1) for a, side, n in zip(starts, sides, bricks, strict=True))
    mesh = MeshHex.init_tensor(*axes)
    scalar, vector = (Basis(mesh, element, intorder=5) for element in (ElementHex2(), ElementVector(ElementHex2())))
    m = csr_array(mass.assemble(scalar)) * DENSITY
    k = csr_array(linear_elasticity(*lame_parameters(YOUNG, poisson)).assemble(vector))
    return Beam(np.round(scalar.doflocs.T, 12), symmetric(m), symmetric(k), brick_mesh(vector, YOUNG, poisson))


def symmetric(matrix: csr_array) -> csr_array:
    """Without what rounding makes of entries that are the same, or zero."""
    result = csr_array((matrix + matrix.T) / 2)
    result.data[np.abs(result.data) < 1e-13 * np.abs(result.data).max()] = 0
    result.eliminate_zeros()
    return result


def lowest_modes(k: csr_array, m: csr_array, count: int, rigid: int = 6) -> tuple[np.ndarray, np.ndarray]:
    """The lowest elastic modes (count, displacements), orthonormal in the mass, and omega^2."""
    squares, vectors = eigh(k.toarray(), kron(m, np.eye(3)).toarray(), subset_by_index=(0, rigid + count - 1))
    modes = vectors.T[rigid:]
    signs = np.sign(
        modes[np.arange(count), np.argmax(np.abs(modes) > 0.6 * np.abs(modes).max(axis=1)[:, None], axis=1)]
    )
    return modes * signs[:, None], squares[rigid:]


def ends(positions: np.ndarray) -> list[int]:
    """The nodes in the middle of both ends."""
    middle = np.abs(positions[:, 1:]).max(axis=1) < 1e-9
    return [
        int(np.flatnonzero(middle & (positions[:, 0] == x))[0]) for x in (positions[:, 0].min(), positions[:, 0].max())
    ]


def arrays() -> dict[str, np.ndarray]:
    """What goes into the file."""
    made = beam()
    modes, squares = lowest_modes(made.stiffness, made.mass, MODES)
    phi = modes.reshape(MODES, -1, 3)
    row, col = coo_array(made.mass).coords
    return {
        "positions": made.positions,
        **{"mass_row": row, "mass_col": col, "mass_value": coo_array(made.mass).data},
        "modes": phi,
        "modal_stiffness": squares,
        **geometric_stiffness(made, phi),
    }


def geometric_stiffness(made: Beam, phi: np.ndarray) -> dict[str, np.ndarray]:
    """K0omega and K0F of modes (N, nodes, 3)."""
    tables = geometric_stiffness_tables(
        SolidMesh(made.mesh, made.positions), made.mass, phi, ends(made.positions), free_response(*made[:3])
    )
    return {name: tables[name] for name in ("K0omega", "K0F", "K0F_nodes")}


if __name__ == "__main__":
    np.savez_compressed(Path(__file__).with_name("solid_beam.npz"), **arrays())
