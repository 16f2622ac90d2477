"""The mesh in a file of nodes: elements, materials, and sets that markers and the interface name."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import derive
from derive.errors import SpecError
from derive.spec.files.mesh_arrays import mesh_arrays
from derive.spec.model.mesh import ElementKind
from spring_lattice import lattice

BRICKS = np.array([[i, i + 1, i + 3, i + 2, i + 4, i + 5, i + 7, i + 6] for i in range(0, 8, 4)])
MESH = {
    "node_numbers": np.arange(101, 113),
    "set_left": np.array([0, 1, 2, 3]),
    "set_right": np.array([8, 9, 10, 11]),
    "set_tip": np.array([11]),
    "elements_hex8": BRICKS,
    "elements_hex8_material": np.array([0, -1]),
    "materials": np.array([[210e3, 0.3, 7.85e-9]]),
}
MARKERS = {"left": {"set": "left"}, "end": {"set": "right", "motion": "rigid"}}


def body(**changed: Any) -> dict[str, Any]:
    """The table of a lattice of two bricks with a mesh, after changes of its arrays."""
    arrays = {**lattice(2), **MESH, **changed}
    return {"nodes": {key: array for key, array in arrays.items() if array is not None}, "units": "SI", "modes": 8}


def faults(**changed: Any) -> list[str]:
    """The faults of the lattice with changed arrays."""
    with pytest.raises(SpecError) as caught:
        derive.nodal_body("lattice", **body(**changed))
    return [problem.path + ": " + problem.message for problem in caught.value.problems]


def faults_of_scene(**keys: Any) -> list[str]:
    """The faults of a scene with the lattice and other keys of it."""
    with pytest.raises(SpecError) as caught:
        derive.spatial_scene("scene", bodies={"truss": {**body(), **keys}})
    return [problem.path + ": " + problem.message for problem in caught.value.problems]


def test_sets_are_nodes_of_markers_and_of_the_interface() -> None:
    keys = {"markers": MARKERS, "interface": ["left", "end"]}
    by_set = derive.spatial_scene("scene", bodies={"truss": {**body(), **keys}}).bodies[0]
    listed = {"left": {"nodes": [0, 1, 2, 3]}, "end": {"nodes": [8, 9, 10, 11], "motion": "rigid"}}
    by_numbers = derive.spatial_scene("scene", bodies={"truss": {**body(), **keys, "markers": listed}}).bodies[0]
    assert [marker.nodes for marker in by_set.markers] == [marker.nodes for marker in by_numbers.markers]
    assert by_set.body.rigid_sets == by_numbers.body.rigid_sets == ((8, 9, 10, 11),)
    assert by_set.body.interface_markers == by_numbers.body.interface_markers


def test_the_interface_of_a_body_alone_names_sets() -> None:
    alone = derive.nodal_body("lattice", **{**body(), "interface": ["left", "right"], "modes": 9})
    assert [(m.name, m.nodes) for m in alone.interface_markers] == [("left", (0, 1, 2, 3)), ("right", (8, 9, 10, 11))]
    assert alone.component_modes == "craig_bampton"
    assert derive.modal(alone).mass == pytest.approx(float(lattice(2)["mass"].sum()))
    both = derive.nodal_body("lattice", **{**body(), "interface": ["left", "tip"], "modes": 9, "markers": {"left": 3}})
    assert [marker.nodes for marker in both.interface_markers] == [(3,), (11,)]  # a marker comes before a set


def test_the_mesh_is_in_si_units_and_survives_a_file(tmp_path: Path) -> None:
    np.savez(tmp_path / "lattice.npz", **body()["nodes"])
    (tmp_path / "lattice.toml").write_text(
        'name = "lattice"\n[body]\nnodes = "lattice.npz"\nmodes = 8\n'
        'units = { length = "mm", mass = "t", time = "s" }\n'
    )
    read = derive.read(tmp_path / "lattice.toml")
    mesh = read.data.mesh  # type: ignore[union-attr]
    assert mesh is not None
    assert [(block.kind, block.material, block.nodes.tolist()) for block in mesh.elements] == [
        (ElementKind.HEX8, "", BRICKS[1:].tolist()),
        (ElementKind.HEX8, "0", BRICKS[:1].tolist()),
    ]
    steel = mesh.materials["0"]
    assert (steel.young, steel.poisson, steel.density) == pytest.approx((210e9, 0.3, 7850.0))
    again = derive.nodal_body("again", read.data, modes=8)  # type: ignore[union-attr]
    assert again.data.mesh is not None
    first, second = mesh_arrays(mesh), mesh_arrays(again.data.mesh)
    assert first.keys() == second.keys() == MESH.keys()
    assert all(np.array_equal(first[key], second[key]) for key in first)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"set_left": np.array([0, 12])}, "body.nodes.set_left: there is no node 12: the nodes are 0 to 11"),
        ({"set_left": np.array([[0, 1]])}, "body.nodes.set_left: the shape is (1, 2), and one index of each node is"),
        ({"set_left": np.array([0.5])}, "body.nodes.set_left: these are decimals; whole numbers are needed"),
        ({"elements_hex8": BRICKS[:, :6]}, "body.nodes.elements_hex8: the shape is (2, 6), and (2, 8) is needed"),
        ({"elements_hex8": BRICKS + 1}, "body.nodes.elements_hex8: there is no node 12: the nodes are 0 to 11"),
        ({"elements_hex8_material": np.array([0, 1])}, "body.nodes.elements_hex8_material: there is no material 1"),
        ({"elements_hex8_material": np.array([0])}, "body.nodes.elements_hex8_material: the shape is (1,), and (2,)"),
        ({"elements_hex8": None}, 'body.nodes.elements_hex8_material: there are no elements "elements_hex8" that'),
        ({"elements_hex9": BRICKS}, "body.nodes.elements_hex9: unknown key; did you mean"),
        ({"node_numbers": np.arange(3)}, "body.nodes.node_numbers: the shape is (3,), and (12,) is needed"),
        ({"materials": np.ones((1, 2))}, "body.nodes.materials: the shape is (1, 2), and (1, 3) is needed"),
    ],
)
def test_faults_of_arrays(changed: dict[str, Any], message: str) -> None:
    assert any(fault.startswith(message) for fault in faults(**changed)), faults(**changed)


@pytest.mark.parametrize(
    ("absent", "named"),
    [
        ({"elements_hex8_material"}, "elements_hex8_material"),
        ({"elements_hex8_material", "materials"}, "elements_hex8_material and materials"),
    ],
)
def test_an_array_that_stresses_of_elements_lack_is_named(absent: set[str], named: str) -> None:
    """A file with elements and materials was told to add elements with materials."""
    nodes = {key: array for key, array in body()["nodes"].items() if key not in absent}
    with pytest.raises(SpecError) as caught:
        derive.nodal_body("lattice", **{**body(), "nodes": nodes, "order": 2, "stress": True})
    told = {problem.path: problem.message for problem in caught.value.problems}
    assert told["body.order"].endswith(f"from which they are computed; the elements lack {named}")
    assert f"which the files lack; the elements lack {named}; add" in told["body.stress"]


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"markers": {"a": {"set": "lfet"}}}, 'bodies.truss.markers.a.set: the file has no set "lfet"; did you'),
        ({"markers": {"a": {"set": "tip"}}}, "bodies.truss.markers.a.set: the set tip has 1: a set needs three nodes"),
        ({"markers": {"a": {"set": "left", "node": 3}}}, "bodies.truss.markers.a: a marker is at a node, node"),
        ({"markers": {"a": {"set": "left", "weights": [1, 2, 1, 1]}}}, "bodies.truss.markers.a: the faces of"),
        (
            {"markers": {**MARKERS, "b": {"nodes": [7, 8, 9], "motion": "rigid"}}},
            "bodies.truss.markers.b.nodes: node 8 is in the rigid set end as well; make one rigid set of both",
        ),
        ({"interface": ["lift"]}, 'bodies.truss.interface[0]: the body has no marker and no set "lift"; did'),
        ({"interface": ["left", "right"], "modes": 5}, "bodies.truss.modes: 5 modes are too few for this interface"),
    ],
)  # fmt: skip
def test_faults_of_names_of_sets(keys: dict[str, Any], message: str) -> None:
    assert any(fault.startswith(message) for fault in faults_of_scene(**keys)), faults_of_scene(**keys)
