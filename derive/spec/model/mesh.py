"""The mesh of a finite-element body as frozen data: its solid elements, their materials, and sets of nodes."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING

from derive.short_text import record_text

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class ElementKind(Enum):
    """The shapes of solid elements; their nodes are in the order of VTK, to which readers convert."""

    TET4 = "tet4"
    TET10 = "tet10"
    HEX8 = "hex8"
    HEX20 = "hex20"
    HEX27 = "hex27"
    WEDGE6 = "wedge6"
    WEDGE15 = "wedge15"

    @property
    def node_count(self) -> int:
        """The number of nodes of an element."""
        return int(self.value.lstrip("tehxwdg"))


@dataclass(frozen=True)
class Material:
    """An isotropic elastic material; None where the file does not give a number."""

    name: str
    young: float | None = None
    poisson: float | None = None
    density: float | None = None


@dataclass(frozen=True, eq=False)
class Elements:
    """A block of elements of one kind and one material.

    nodes (elements, nodes of an element): indices of nodes, in the order of VTK. material: its name, "" if unknown.
    """

    kind: ElementKind
    nodes: NDArray[np.int64]
    material: str = ""
    __repr__ = record_text


@dataclass(frozen=True, eq=False)
class NodeMesh:
    """The mesh of a body of nodes: its elements, their materials, and named sets.

    elements: blocks of elements. materials: those of the elements by name. node_sets: indices of nodes, from 0, by the
    names of sets. node_numbers (n,): the numbers of the nodes in the finite-element program; None if not given.
    """

    elements: tuple[Elements, ...] = ()
    materials: dict[str, Material] = field(default_factory=dict)
    node_sets: dict[str, NDArray[np.int64]] = field(default_factory=dict)
    node_numbers: NDArray[np.int64] | None = None
    __repr__ = record_text

    @property
    def is_elastic(self) -> bool:
        """Whether there are elements, and all of them have Young's modulus and Poisson's ratio."""
        known = (self.materials.get(block.material, Material("")) for block in self.elements)
        return bool(self.elements) and all(None not in (own.young, own.poisson) for own in known)
