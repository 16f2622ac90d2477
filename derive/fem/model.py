"""A part as a finite-element program knows it: its mesh, its sets of nodes, its matrices, and its modes."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from derive.spec.model.mesh import ElementKind, Elements, Material

__all__ = ["Array", "ElementKind", "Elements", "FiniteElementModel", "Indices", "Material"]

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class FiniteElementModel:
    """A part in the units of its file.

    node_numbers (n,): the numbers of the nodes in the program. positions (n, 3). stiffness, mass (3n, 3n): the matrices
    with adjacent displacements of a node, both of their halves filled; None if there are none. node_sets: indices of
    nodes by the names of sets. materials: by name. frequencies (modes,), in Hz if the unit of time is the second, and
    modes (modes, n, 3): those that the program computed, if any. modal_stiffness (modes, modes): that of the modes, of
    a part without a stiffness matrix. moments, stiffening, modal_damping: those of a part without a mass matrix, see
    `NodeData` and `Damping`. notes: sentences on what is not read and what the reader decided.
    """

    name: str
    node_numbers: Indices
    positions: Array
    stiffness: csr_array | None = None
    mass: csr_array | None = None
    node_sets: dict[str, Indices] = field(default_factory=dict)
    elements: tuple[Elements, ...] = ()
    materials: dict[str, Material] = field(default_factory=dict)
    frequencies: Array | None = None
    modes: Array | None = None
    modal_stiffness: Array | None = None
    moments: Array | None = None
    stiffening: dict[str, Array] = field(default_factory=dict)
    modal_damping: Array | None = None
    notes: tuple[str, ...] = ()
