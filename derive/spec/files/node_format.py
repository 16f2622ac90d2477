"""The arrays of a body of nodes and the units of their files; all other modules use SI units."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from derive.spec.model.mesh import ElementKind

FILES = {
    "positions": "Positions of the nodes, (nodes, 3).",
    "mass": "The mass of each node, or the consistent mass matrix.",
    "stiffness": "The stiffness matrix, (3 nodes, 3 nodes), with adjacent displacements of a node.",
    "modes": "The modes as columns, (3 nodes, modes).",
    "modal_stiffness": "The stiffness of the modes, (modes, modes) or its diagonal.",
    "K0t": "Geometric stiffness of the modes under unit accelerations along e1, e2, e3, (3, modes, modes).",
    "K0r": "Geometric stiffness of the modes under unit angular accelerations, (3, modes, modes).",
    "K0omega": "Geometric stiffness of the modes under spin, the factors of w1^2, w2^2, w3^2, w1 w2, w2 w3, w1 w3, "
    "(6, modes, modes).",
    "K0F": "Geometric stiffness of the modes under unit forces along e1, e2, e3 at the nodes K0F_nodes, "
    "(K0F_nodes, 3, modes, modes).",
    "K0F_nodes": "The numbers of these nodes, counted from 0.",
    "moments": "In place of the mass, the integrals of products of the fields 1, x, y, z and the components of the "
    "modes over the mass of the body, (4 + 3 modes, 4 + 3 modes).",
}
"""The arrays of a body, each a MatrixMarket file where `nodes` is a table; more than two indices are rows, stacked."""

SET = "set_"
ELEMENTS = "elements_"
MATERIAL = "_material"
MESH = {
    "node_numbers": "The numbers of the nodes in the program that made the mesh, (nodes,).",
    f"{SET}NAME": "The nodes of the set NAME, counted from 0, to which `set` and `interface` refer.",
    **{
        f"{ELEMENTS}{kind.value}": "The nodes of elements, counted from 0 and in the order of VTK, "
        f"(elements, {kind.node_count})."
        for kind in ElementKind
    },
    f"{ELEMENTS}KIND{MATERIAL}": "The material of each of these elements, counted from 0, or -1, (elements,).",
    "materials": "Young's modulus, Poisson's ratio and density of each material, (materials, 3).",
}
"""The arrays of the mesh of a body, which pictures and stresses need; none of them is required."""


def is_of_mesh(key: str) -> bool:
    """Whether an array is one of the mesh."""
    elements = key.removeprefix(ELEMENTS).removesuffix(MATERIAL) if key.startswith(ELEMENTS) else None
    if elements is not None:
        return any(elements == kind.value for kind in ElementKind)
    return key in ("node_numbers", "materials") or (key.startswith(SET) and len(key) > len(SET))


def holds_indices(key: str) -> bool:
    """Whether an array holds whole numbers: rows, columns, nodes or elements."""
    return key.endswith(("_row", "_col", "_nodes")) or (is_of_mesh(key) and key != "materials")


LENGTHS = {"m": Fraction(1), "cm": Fraction(1, 100), "mm": Fraction(1, 1000), "in": Fraction("0.0254")}
MASSES = {
    "kg": Fraction(1),
    "g": Fraction(1, 1000),
    "t": Fraction(1000),
    "lbf s^2/in": Fraction("0.45359237") * Fraction("9.80665") / Fraction("0.0254"),
}
TIMES = {"s": Fraction(1), "ms": Fraction(1, 1000)}


class Units(NamedTuple):
    """The units of a file in SI units, exactly."""

    length: Fraction = Fraction(1)
    mass: Fraction = Fraction(1)
    time: Fraction = Fraction(1)

    @property
    def stiffness(self) -> Fraction:
        """The unit of stiffness, mass per time squared: N/mm for millimetres, tonnes and seconds."""
        return self.mass / self.time**2

    @property
    def geometric_stiffness(self) -> dict[str, Fraction]:
        """The units of geometric stiffness matrices, by their names: of stiffness divided by those of their loads."""
        return {"K0t": self.mass / self.length, "K0r": self.mass, "K0omega": self.mass, "K0F": 1 / self.length}
