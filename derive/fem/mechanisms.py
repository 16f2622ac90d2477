"""Motions without strain besides the six rigid ones: parts that nothing connects, and hinges."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import connected_components

from derive.errors import Problem
from derive.fem.model import Array, Indices
from derive.fem.node_names import node_list
from derive.short_text import counted
from derive.spec.model.mesh import Elements
from derive.spec.model.node_data import NodeData

HINGE = 1e-3
"""Elements on both sides of a hinge turn against each other by more than this part of the largest rotation."""


def loose_parts(stiffness: csr_array, numbers: Indices) -> Problem | None:
    """The fault of a stiffness (3n, 3n) that does not connect all nodes, whose numbers in the program are given."""
    entries = coo_array(stiffness)
    near = entries.data != 0
    n = len(numbers)
    graph = csr_array((np.ones(near.sum()), (entries.row[near] // 3, entries.col[near] // 3)), shape=(n, n))
    count, part = connected_components(graph, directed=False)
    if count == 1:
        return None
    sizes = np.bincount(part)
    smaller = np.argsort(-sizes, kind="stable")[1:]
    parts = [f"{counted(int(sizes[i]), 'node')} ({node_list(numbers[part == i])})" for i in smaller[:3].tolist()]
    more = f" and {count - 4} more" if count > 4 else ""
    text = f"the stiffness does not connect all nodes: {', '.join(parts)}{more} move against the others"
    return Problem("", f"{text}; merge the nodes of parts that touch, or leave loose ones out")


def hinge(motions: Array, data: NodeData, numbers: Indices) -> Problem:
    """The fault of motions (count, nodes, 3) without strain in nodes that the stiffness connects."""
    nodes = _hinge_nodes(motions, data.positions, data.mesh.elements if data.mesh else ())
    where = "about the nodes"
    if not nodes.size:
        sizes = np.linalg.norm(motions, axis=2).max(axis=0)
        nodes, where = np.argsort(-sizes, kind="stable")[:8], "above all of the nodes"
    free = f"{counted(len(motions), 'motion')} without strain besides the six rigid ones"
    text = f"the stiffness leaves {free}, {where} {node_list(numbers[nodes])}"
    return Problem("", f"{text}: parts that share only a node or an edge turn about it; connect them by faces")


def _hinge_nodes(motions: Array, x: Array, elements: tuple[Elements, ...]) -> Indices:
    """Nodes of elements that rotate differently in one of the motions."""
    least = np.full((len(motions), len(x), 3), np.inf)
    most = -least
    for block in elements:
        own = x[block.nodes] - x[block.nodes].mean(axis=1, keepdims=True)
        inverse = np.linalg.pinv(np.einsum("eni,enj->eij", own, own))
        for i, motion in enumerate(motions):
            gradient = np.einsum("eij,enj,enk->eik", inverse, own, motion[block.nodes])
            turns = np.stack([gradient[:, a, b] - gradient[:, b, a] for a, b in ((1, 2), (2, 0), (0, 1))], axis=1) / 2
            spread = np.repeat(turns[:, None], block.nodes.shape[1], axis=1)
            np.minimum.at(least[i], block.nodes, spread)
            np.maximum.at(most[i], block.nodes, spread)
    inside = np.isfinite(least).all(axis=(0, 2))
    spreads = np.where(inside[None, :, None], most - least, 0.0).max(axis=(0, 2), initial=0.0)
    largest = np.abs(most[:, inside]).max(initial=0.0)
    result: Indices = np.flatnonzero(spreads > HINGE * largest)
    return result
