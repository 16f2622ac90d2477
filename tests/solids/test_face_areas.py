"""Sets of nodes on faces of elements are weighed by area: markers have the mean motion of the surface."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
import scipy.linalg
from assembled import assembled
from grid_meshes import box_mesh
from scipy.sparse import csr_array, identity

import derive
from derive.reduction.interface import interface_of
from derive.reduction.marker_motion import marker_motion
from derive.solids.face_areas import area_products
from derive.solids.stresses import IntegratedMesh
from derive.spec.model.body import NodalBody
from derive.spec.model.mesh import ElementKind, NodeMesh
from derive.spec.model.node_data import NodeData
from derive.spec.model.node_markers import InterfaceMarker

SIDES = (0.3, 0.1, 0.06)  # m


def on_end(x: np.ndarray) -> np.ndarray:
    return np.flatnonzero(np.abs(x[:, 0] - SIDES[0]) < 1e-9)


@pytest.mark.parametrize("kind", ElementKind)
def test_means_over_an_area_are_exact(kind: ElementKind) -> None:
    """Products of fields that the shape functions contain have their integrals over the face, for every element."""
    x, mesh = box_mesh(kind, SIDES, (2, 2, 3), crooked=0.2)
    own = on_end(x)
    products = area_products(mesh.elements, x, tuple(own.tolist()))
    assert products is not None
    y, z = (x[own, 1], x[own, 2])
    b, c = SIDES[1:]
    degree = 1 if kind.node_count in (4, 6, 8) else 2
    for i, j in product(range(degree + 1), repeat=2):
        if i + j <= degree:
            integral = b ** (i + 2) / (i + 2) * c ** (j + 1) / (j + 1)
            assert y @ products @ (y**i * z**j) == pytest.approx(integral, rel=1e-12), (i, j)


def test_sets_that_are_no_surface_have_no_area() -> None:
    x, mesh = box_mesh(ElementKind.HEX8, SIDES, (4, 2, 2))
    own = on_end(x).tolist()
    inside = int(np.flatnonzero((np.abs(x - np.array(SIDES) * (0.75, 0.5, 0.5)) < 1e-9).all(axis=1))[0])
    assert area_products(mesh.elements, x, (*own[:4], own[-1])) is None
    assert area_products(mesh.elements, x, (*own, inside)) is None


def test_a_set_that_turns_as_a_rigid_body_turns_its_marker_alike() -> None:
    """Two rotations as modes, whose displacements of second order are those of a finite rotation, leave none of it."""
    x, mesh = box_mesh(ElementKind.HEX20, SIDES, (2, 2, 1), crooked=0.2)
    own = tuple(on_end(x).tolist())
    data = NodeData(x, csr_array(identity(len(x))), None, None, None, "", mesh=mesh)
    motion = marker_motion(derive.nodal_body("bar", data, modes=0), InterfaceMarker("end", own), x)
    assert motion.by_area and motion.centre == pytest.approx([SIDES[0], SIDES[1] / 2, SIDES[2] / 2])
    theta = np.array([[0.3, 0.1, -0.2], [-0.5, 0.4, 0.1]])
    fields = np.cross(theta[:, None], motion.levers) + np.array([1.0, 2.0, 3.0])
    turned = np.cross(theta[:, None, None], np.cross(theta[:, None], motion.levers)[None])
    assert motion.rotation(fields) == pytest.approx(theta, abs=1e-12)
    second = motion.second_rotation(fields, np.moveaxis((turned + np.swapaxes(turned, 0, 1)) / 2, 2, 0))
    assert np.abs(second).max() < 1e-12


def held_frequency(counts: tuple[int, int, int], weights: bool) -> float:
    """The first frequency (Hz) of a bar of bricks with 20 nodes that is held at the mean motion of its end."""
    x, mesh = box_mesh(ElementKind.HEX20, SIDES, counts)
    mass, stiffness = assembled(IntegratedMesh(mesh, x, full=True))
    nodes = on_end(x)
    full = NodeMesh(mesh.elements, mesh.materials, {"end": nodes})
    data = NodeData(x, mass, stiffness, None, None, "", mesh=full)
    marker = {"end": {"nodes": nodes.tolist(), "weights": [1] * len(nodes)} if weights else {"set": "end"}}
    body = derive.spatial_scene(
        "bar", bodies={"bar": {"nodes": data, "units": "SI", "interface": ["end"], "modes": 1, "markers": marker}}
    ).bodies[0]
    assert isinstance(body.body, NodalBody)
    held = interface_of(body.body, x - x.mean(axis=0)).held.toarray()
    k, m = held.T @ stiffness.toarray() @ held, held.T @ np.kron(mass.toarray(), np.eye(3)) @ held
    return float(np.sqrt(scipy.linalg.eigh(k, m, eigvals_only=True, subset_by_index=[0, 0])[0]) / (2 * np.pi))


def test_coarse_meshes_are_held_as_fine_ones_are() -> None:
    """Equal weights hold less of the area where a mesh is fine at edges, as quadratic faces are at their rims."""
    fine = held_frequency((6, 4, 3), weights=False)
    by_area, equal = (held_frequency((3, 2, 1), weights) for weights in (False, True))
    assert abs(by_area / fine - 1) < 0.3 * abs(equal / fine - 1)
