"""The surface of a mesh of solid elements of all kinds: the boundary of their volume."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from derive.simulation.observables.body_surface import Surface
from derive.simulation.observables.mesh_surface import coarsened, mesh_surface
from derive.solids.element_shapes import element_shape
from derive.spec.model.mesh import ElementKind, Elements

TETRAHEDRON = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
HEXAHEDRON = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
WEDGE = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)]
CORNERS = {"tet": (TETRAHEDRON, 1 / 6), "hex": (HEXAHEDRON, 1.0), "wed": (WEDGE, 0.5)}


def element(kind: ElementKind) -> tuple[np.ndarray, Elements, float]:
    """The nodes of an element of a kind, the element, and its volume."""
    corners, volume = CORNERS[kind.value[:3]]
    x = np.array(corners, dtype=float)
    shape = element_shape(kind)
    x = np.array([*x, *((x[i] + x[j]) / 2 for i, j in shape.edges)])
    x = np.concatenate([x, (1 + shape.nodes[len(x) :]) / 2])  # in faces and inside
    return x, Elements(kind, np.arange(len(x))[None]), volume


def enclosed(x: np.ndarray, shown: Surface) -> float:
    """The volume within faces whose normals point outwards."""
    return sum(
        float(np.linalg.det(x[[face[0], face[i], face[i + 1]]])) / 6
        for face in shown.faces
        for i in range(1, len(face) - 1)
    )


@pytest.mark.parametrize("kind", ElementKind)
def test_the_surface_of_one_element_encloses_its_volume(kind: ElementKind) -> None:
    x, one, volume = element(kind)
    assert one.nodes.shape[1] == kind.node_count
    shown = mesh_surface((one,))
    assert enclosed(x, shown) == pytest.approx(volume)
    assert shown.nodes == list(range(min(len(x), 20)))  # without those within faces
    assert enclosed(x, mesh_surface((one,), middles=False)) == pytest.approx(volume)
    assert len(shown.nodes) - len(shown.edges) + len(shown.faces) == 2


def test_faces_between_elements_are_not_shown() -> None:
    """A ring of eight bricks has a hole, which a hull of its nodes closes."""
    counts = (4, 4, 2)
    number = {key: i for i, key in enumerate(product(*map(range, counts)))}
    cells = [(i, j) for i, j in product(range(3), repeat=2) if (i, j) != (1, 1)]
    nodes = [[number[i + a, j + b, c] for a, b, c in HEXAHEDRON] for i, j in cells]
    x = np.array(list(number), dtype=float)
    shown = mesh_surface(
        (Elements(ElementKind.HEX8, np.array(nodes[:3])), Elements(ElementKind.HEX8, np.array(nodes[3:])))
    )
    assert len(shown.faces) == 2 * 8 + 12 + 4
    assert enclosed(x, shown) == pytest.approx(8.0)
    assert len(shown.nodes) - len(shown.edges) + len(shown.faces) == 0  # as a torus


def test_kinds_share_faces() -> None:
    """Two wedges on a brick: the faces between them are not on the surface, whatever the order of their nodes."""
    x = np.array([*HEXAHEDRON, (0, 0, 2), (1, 0, 2), (1, 1, 2), (0, 1, 2)], dtype=float)
    brick = Elements(ElementKind.HEX8, np.array([range(8)]))
    wedges = Elements(ElementKind.WEDGE6, np.array([[4, 5, 6, 8, 9, 10], [4, 6, 7, 8, 10, 11]]))
    shown = mesh_surface((brick, wedges))
    inside = [face for face in shown.faces if set(face) == {4, 6, 8, 10}]
    assert inside == []
    assert enclosed(x, shown) == pytest.approx(2.0)


def test_a_coarser_surface_encloses_about_the_same_volume() -> None:
    """The nodes of a fine cube that are left are some of its own; its faces have no double corners."""
    counts = (13, 13, 13)
    number = {key: i for i, key in enumerate(product(*map(range, counts)))}
    cells = product(range(12), repeat=3)
    nodes = [[number[i + a, j + b, k + c] for a, b, c in HEXAHEDRON] for i, j, k in cells]
    x = np.array(list(number), dtype=float)
    whole = mesh_surface((Elements(ElementKind.HEX8, np.array(nodes)),))
    assert len(whole.nodes) == 13**3 - 11**3
    shown = coarsened(whole, x, 200)
    assert 60 < len(shown.nodes) <= 200 and {*shown.nodes} <= {*whole.nodes}
    assert all(len({*face}) == len(face) for face in shown.faces)
    assert enclosed(x, shown) == pytest.approx(12.0**3, rel=0.25)
    assert coarsened(whole, x, 5000) == whole
