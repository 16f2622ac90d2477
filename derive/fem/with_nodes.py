"""Numbers of nodes as indices: matrices in the order of the nodes, and sets and elements by indices of nodes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import csr_array

from derive.fem.keyword_mesh import KeywordMesh
from derive.fem.model import Indices
from derive.spec.model.mesh import Elements


@dataclass(frozen=True, eq=False)
class MatricesOfNodes:
    """Symmetric matrices whose rows are displacements of nodes: the number of the node and the direction, from 0, of
    each row."""

    node: Indices
    direction: Indices
    stiffness: csr_array
    mass: csr_array


def index_of(numbers: Indices, wanted: Indices) -> Indices:
    """The index of each wanted number among `numbers`, which need not be sorted; -1 where it is not among them."""
    order = np.argsort(numbers, kind="stable")
    at = np.minimum(np.searchsorted(numbers[order], wanted), len(numbers) - 1)
    result: Indices = np.where(numbers[order][at] == wanted, order[at], -1)
    return result


def in_order_of_nodes(matrices: MatricesOfNodes, numbers: Indices) -> tuple[csr_array, csr_array]:
    """Stiffness and mass with the three displacements of each node together, in the order of the nodes."""
    place = 3 * index_of(numbers, matrices.node) + matrices.direction
    stiffness, mass = (_moved(matrix, place) for matrix in (matrices.stiffness, matrices.mass))
    return stiffness, mass


def _moved(matrix: csr_array, place: Indices) -> csr_array:
    """The matrix with row i and column i at place[i]."""
    entries = matrix.tocoo()
    return csr_array((entries.data, (place[entries.row], place[entries.col])), shape=matrix.shape)


def mesh_of_nodes(mesh: KeywordMesh, numbers: Indices) -> dict[str, Any]:
    """The sets, elements and materials of a model whose nodes have these numbers; elements with other nodes are left
    out, and so are sets without any of them."""
    sets = {mesh.names.get(name, name): index_of(numbers, members) for name, members in mesh.sets.items()}
    elements = [Elements(block.kind, index_of(numbers, block.nodes), block.material) for block in mesh.elements]
    whole = [(block, (block.nodes >= 0).all(axis=1)) for block in elements]
    return {
        "node_sets": {name: nodes[nodes >= 0] for name, nodes in sets.items() if (nodes >= 0).any()},
        "elements": tuple(Elements(e.kind, e.nodes[kept], e.material) for e, kept in whole if kept.any()),
        "materials": mesh.materials,
    }


def nodes_of_elements(mesh: KeywordMesh) -> Indices:
    """The numbers of the nodes that elements have, in ascending order."""
    return np.unique(np.concatenate([np.zeros(0, np.int64), *(block.nodes.ravel() for block in mesh.elements)]))
