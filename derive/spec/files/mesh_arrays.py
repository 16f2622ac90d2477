"""The mesh of a body of nodes as arrays, and back from arrays, none of which is trusted."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from derive.errors import quoted
from derive.spec.files.node_format import ELEMENTS, MATERIAL, SET, Units, is_of_mesh
from derive.spec.model.mesh import ElementKind, Elements, Material, NodeMesh
from derive.spec.parsing.faults import Faults
from derive.spec.parsing.values import WrongValueError

Array = Any
NODES = ("body", "nodes")


def mesh_arrays(mesh: NodeMesh | None) -> dict[str, Array]:
    """The arrays of a mesh by the names that they have in files."""
    if mesh is None:
        return {}
    result: dict[str, Array] = {f"{SET}{name}": nodes for name, nodes in mesh.node_sets.items()}
    if mesh.node_numbers is not None:
        result["node_numbers"] = mesh.node_numbers
    whole = {name: row for name, m in mesh.materials.items() if None not in (row := (m.young, m.poisson, m.density))}
    number = {name: i for i, name in enumerate(whole)}
    if whole:
        result["materials"] = np.array(list(whole.values()), dtype=np.float64)
    for kind in ElementKind:
        blocks = [block for block in mesh.elements if block.kind is kind]
        if blocks:
            result[f"{ELEMENTS}{kind.value}"] = np.concatenate([block.nodes for block in blocks])
            materials = [np.full(len(block.nodes), number.get(block.material, -1)) for block in blocks]
            if whole:
                result[f"{ELEMENTS}{kind.value}{MATERIAL}"] = np.concatenate(materials)
    return result


def mesh_of(arrays: Mapping[str, Array | None], n: int, units: Units, faults: Faults) -> NodeMesh | None:
    """The mesh of n nodes in SI units, if there are arrays of one; `faults` takes those of the arrays.

    Materials have numbers instead of names.
    """
    own = {key: array for key, array in arrays.items() if is_of_mesh(key) and array is not None}
    if not own:
        return None
    before = len(faults)
    materials, sets, elements = [], {}, []
    numbers = None
    for key, array in own.items():
        with faults.at(*NODES, key):
            if key == "materials":
                materials = _materials(array, units)
            elif key == "node_numbers":
                _shaped(array, (n,))
                numbers = array
            elif key.startswith(SET):
                if array.ndim != 1:
                    raise WrongValueError(f"the shape is {array.shape}, and one index of each node is needed: (count,)")
                sets[key.removeprefix(SET)] = _indices(array, n, "node")
    for kind in ElementKind:
        name = f"{ELEMENTS}{kind.value}"
        if name in own:
            elements += _elements(kind, own[name], own.get(f"{name}{MATERIAL}"), n, len(materials), faults)
        elif f"{name}{MATERIAL}" in own:
            with faults.at(*NODES, f"{name}{MATERIAL}"):
                raise WrongValueError(f"there are no elements {quoted(name)} that these materials belong to")
    if len(faults) > before:
        return None
    return NodeMesh(tuple(elements), {material.name: material for material in materials}, sets, numbers)


def set_sizes(arrays: Mapping[str, Array | None]) -> dict[str, int]:
    """How many nodes each set has, by its name."""
    return {
        key.removeprefix(SET): int(np.size(array))
        for key, array in arrays.items()
        if key.startswith(SET) and is_of_mesh(key) and array is not None
    }


def arrays_elements_lack(arrays: Mapping[str, Array | None]) -> list[str]:
    """The names of the arrays that give the elements their materials and are missing; none without elements."""
    elements = [name for kind in ElementKind if arrays.get(name := f"{ELEMENTS}{kind.value}") is not None]
    needed = [*(f"{name}{MATERIAL}" for name in elements), *(["materials"] if elements else [])]
    return [name for name in needed if arrays.get(name) is None]


def _materials(array: Array, units: Units) -> list[Material]:
    _shaped(array, (len(array), 3) if array.ndim else (0, 3))
    pressure, density = units.stiffness / units.length, units.mass / units.length**3
    return [
        Material(str(i), young * float(pressure), poisson, rho * float(density))
        for i, (young, poisson, rho) in enumerate(array.tolist())
    ]


def _elements(
    kind: ElementKind, nodes: Array, material: Array | None, n: int, materials: int, faults: Faults
) -> list[Elements]:
    """The blocks of elements of one kind, one of each material."""
    name = f"{ELEMENTS}{kind.value}"
    with faults.at(*NODES, name):
        _shaped(nodes, (len(nodes) if nodes.ndim else 0, kind.node_count))
        _indices(nodes, n, "node")
        if material is None:
            return [Elements(kind, nodes)]
        with faults.at(*NODES, f"{name}{MATERIAL}"):
            _shaped(material, (len(nodes),))
            known = material[material >= 0]
            _indices(known, materials, "material")
            return [
                Elements(kind, nodes[material == number], str(number) if number >= 0 else "")
                for number in np.unique(material).tolist()
            ]
    return []


def _shaped(array: Array, shape: tuple[int, ...]) -> None:
    if array.shape != shape:
        raise WrongValueError(f"the shape is {array.shape}, and {shape} is needed")


def _indices(array: Array, count: int, noun: str) -> NDArray[np.int64]:
    bad = (array < 0) | (array >= count)
    if bad.any():
        which = int(array[bad].ravel()[0])
        raise WrongValueError(f"there is no {noun} {which}: the {noun}s are 0 to {count - 1}")
    result: NDArray[np.int64] = array
    return result
