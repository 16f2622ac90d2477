"""What a finite-element program knows of a part: its mesh, its sets of nodes, and its matrices."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


class ElementKind(Enum):
    """The shapes of solid elements; nodes are in the order of VTK, and readers convert to it."""

    TET4 = "tet4"
    TET10 = "tet10"
    HEX8 = "hex8"
    HEX20 = "hex20"
    WEDGE6 = "wedge6"
    WEDGE15 = "wedge15"

    @property
    def node_count(self) -> int:
        """The number of nodes of an element."""
        return int(self.value.lstrip("abcdefghijklmnopqrstuvwxyz"))


@dataclass(frozen=True, eq=False)
class Elements:
    """A block of elements of one kind and one material.

    nodes (elements, nodes of an element): indices of nodes in `positions` of the model, in the order of VTK.
    """

    kind: ElementKind
    nodes: Indices
    material: str = ""


@dataclass(frozen=True)
class Material:
    """An isotropic elastic material in the units of its file; None where the file does not say."""

    name: str
    young: float | None = None
    poisson: float | None = None
    density: float | None = None


@dataclass(frozen=True, eq=False)
class FiniteElementModel:
    """A part in the units of its file.

    node_numbers (n,): the numbers of the nodes in the program. positions (n, 3). stiffness, mass (3n, 3n): the matrices
    with adjacent displacements of a node, both of their halves filled; None if the program wrote none. node_sets:
    indices of nodes by the names of sets. materials: by name. frequencies (modes,), Hz in the time unit of the file,
    and modes (modes, n, 3): those that the program computed, None if it wrote none. notes: sentences on what is not read
    and what the reader decided.
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
    notes: tuple[str, ...] = ()
