"""Clouds of masses with second-order fields Psi_ij, and the geometric stiffness matrices that say the same."""

from __future__ import annotations

from dataclasses import replace

import bodies_of_nodes as bodies
import numpy as np

from derive.spec.model.body import BodyFrame, DisplacementOrder, NodalBody
from derive.spec.model.node_data import NodeData
from derive.spec.model.node_markers import NodeMarker

OMEGA_PRODUCTS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))


def fields(n: int, points: int, seed: int = 7) -> np.ndarray:
    """Psi (N, N, points, 3), symmetric in the modes."""
    psi = np.random.default_rng(seed).uniform(-1, 1, (n, n, points, 3))
    return (psi + psi.swapaxes(0, 1)) / 2


def with_stiffness(data: NodeData, psi: np.ndarray, nodes: tuple[int, ...] | None = None) -> NodeData:
    """The data with K0 of these fields: minus the work of each unit load on Psi_ij; K0F at some nodes, or at all."""
    mass, x, axes = data.mass.toarray(), data.positions, np.eye(3)

    def work(load: np.ndarray) -> np.ndarray:
        """-int f . Psi_ij of the inertia load f = -rho `load`."""
        return np.einsum("ab,ak,ijbk->ij", mass, load, psi)

    def centrifugal(a: int, b: int) -> np.ndarray:
        both = np.cross(axes[a], np.cross(axes[b], x)) + np.cross(axes[b], np.cross(axes[a], x))
        return both / 2 if a == b else both

    nodes = tuple(range(len(x))) if nodes is None else nodes
    return replace(
        data,
        K0t=np.array([work(np.broadcast_to(e, x.shape)) for e in axes]),
        K0r=np.array([work(np.cross(e, x)) for e in axes]),
        K0omega=np.array([work(centrifugal(a, b)) for a, b in OMEGA_PRODUCTS]),
        K0F=-np.moveaxis(psi[:, :, list(nodes)], (2, 3), (0, 1)),
        K0F_nodes=np.array(nodes),
    )


def stiffened(
    n: int, frame: BodyFrame = bodies.MEAN, points: int = 10, full: bool = False, **changes
) -> tuple[NodalBody, np.ndarray]:
    """A cloud with second-order fields, all of its nodes markers, and its fields as given."""
    data = bodies.cloud(n, points)
    if full:
        data = bodies.consistent(data)
    psi = fields(n, points)
    markers = tuple(NodeMarker(f"at{k}", k) for k in range(points))
    body = bodies.nodal(with_stiffness(data, psi), frame, markers=markers, order=DisplacementOrder.TRUNCATED, **changes)
    return body, psi
