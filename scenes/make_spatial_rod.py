"""Makes examples/spatial_rod.npz: a slender steel rod by finite elements, the rod of spatial_crank_slider.toml.

    python scenes/make_spatial_rod.py

needs scikit-fem (`pip install 'tisserand[test]'`). The rod of 0.3 m, 8 mm by 4 mm, is meshed along e1 with quadratic
bricks. The file holds nodes, mass, stiffness, and the lowest elastic modes with theirs, in SI units; the first nine
nodes are the section at the left end, and the last nine that at the right end.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import coo_array, csr_array
from skfem import Basis, ElementHex2, ElementVector, MeshHex
from skfem.models.elasticity import lame_parameters, linear_elasticity
from skfem.models.poisson import mass

SIDES = (0.3, 0.008, 0.004)  # m
BRICKS = 6
YOUNG, POISSON, DENSITY = 210e9, 0.3, 7850.0  # Pa, 1, kg/m^3
MODES = 6


def arrays() -> dict[str, np.ndarray]:
    """The arrays of the file."""
    lines = (np.linspace(0, side, n + 1) for side, n in zip(SIDES, (BRICKS, 1, 1), strict=True))
    mesh = MeshHex.init_tensor(*lines)
    scalar, vector = Basis(mesh, ElementHex2(), intorder=5), Basis(mesh, ElementVector(ElementHex2()), intorder=5)
    order = np.lexsort(np.round(scalar.doflocs[::-1], 9))
    triples = (3 * order[:, None] + np.arange(3)).ravel()
    m = csr_array(mass.assemble(scalar))[order][:, order] * DENSITY
    m = csr_array((m + m.T) / 2)
    k = csr_array(linear_elasticity(*lame_parameters(YOUNG, POISSON)).assemble(vector))[triples][:, triples]
    full = np.kron(m.toarray(), np.eye(3))
    k = csr_array((k + k.T) / 2)
    squares, vectors = eigh(k.toarray(), full, subset_by_index=(0, 6 + MODES - 1))
    modes = vectors.T[6:].reshape(MODES, -1, 3)
    signs = np.sign(modes[np.arange(MODES), 0, np.abs(modes[:, 0]).argmax(axis=1)])
    entries, stiff = coo_array(m), coo_array(k)
    return {
        "positions": np.round(scalar.doflocs.T[order], 12),
        "mass_row": entries.row.astype(np.int32),
        "mass_col": entries.col.astype(np.int32),
        "mass_value": entries.data,
        "stiffness_row": stiff.row.astype(np.int32),
        "stiffness_col": stiff.col.astype(np.int32),
        "stiffness_value": stiff.data,
        "modes": modes * signs[:, None, None],
        "modal_stiffness": squares[6:],
    }


if __name__ == "__main__":
    np.savez_compressed(Path(__file__).parents[1] / "examples/spatial_rod.npz", **arrays())
