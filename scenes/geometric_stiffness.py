"""The block of make_block.py with the geometric stiffness of its modes, which Tisserand computes from the mesh.

    python scenes/geometric_stiffness.py stiffened_block.npz

needs scikit-fem (`pip install 'tisserand[test]'`). A body that bends also moves along its axis, to second order in its
deflection, because it resists stretching; loads along the axis then do work on the bending. This is what the matrices
K0 describe, by which a body stiffens under spin. `derive.reduction.mesh_stiffening` computes them from the stresses of
unit loads. A file with the mesh and the stiffness needs no such matrices; this one has them because it has the modes
as well, and the last digits of computed modes depend on the machine.

The file that the script writes holds the arrays of block.npz and these matrices, K0F for the nodes of MARKERS; the key
`nodes` of a specification reads it.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from skfem import Basis

from derive.reduction.mesh_stiffening import free_response, geometric_stiffness_tables
from derive.solids.element_shapes import element_shape
from derive.solids.stresses import SolidMesh
from derive.spec.model.mesh import ElementKind, Elements, Material, NodeMesh

MARKERS = (0, 127, 247)  # of block.toml


def brick_mesh(basis: Basis, young: float, poisson: float) -> NodeMesh:
    """The mesh of bricks of 27 nodes of a basis of displacements of scikit-fem, with the nodes of the basis."""
    places = 2 * basis.elem.elem.doflocs - 1
    order = [int(np.abs(places - node).sum(axis=1).argmin()) for node in element_shape(ElementKind.HEX27).nodes]
    nodes = basis.element_dofs[::3].T[:, order] // 3
    elements = Elements(ElementKind.HEX27, nodes.astype(np.int64), "solid")
    return NodeMesh((elements,), {"solid": Material("solid", young, poisson)})


def stiffened_block() -> dict[str, np.ndarray]:
    """The arrays of the block with its geometric stiffness matrices."""
    import make_block as block

    made, arrays = block.mesh_block(), block.arrays()
    _, basis, order = block.bases()
    unsorted = brick_mesh(basis, block.YOUNG, block.POISSON)
    elements = [replace(e, nodes=np.argsort(order)[e.nodes]) for e in unsorted.elements]
    solid = SolidMesh(replace(unsorted, elements=tuple(elements)), made.positions)
    return arrays | geometric_stiffness_tables(solid, made.mass, arrays["modes"], MARKERS, free_response(*made))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python scenes/geometric_stiffness.py FILE.npz")
    np.savez_compressed(Path(sys.argv[1]), **stiffened_block())
