"""The motion of a marker at a set of nodes: their weighted mean displacement, and the rotation that fits them best.

Faces of elements weigh the nodes of a set that covers them: the mean is that over their area, and the rotation fits the
displacements of all of it. Other nodes have the weights that are given, or equal ones.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol

import numpy as np

from derive.reduction.arithmetic import Array
from derive.solids.face_areas import area_products
from derive.spec.model.body import NodalBody


class MarkerNodes(Protocol):
    """The nodes of a marker, and their weights, if they are given."""

    @property
    def nodes(self) -> tuple[int, ...]:
        """The nodes."""
        ...

    @property
    def weights(self) -> tuple[Fraction, ...]:
        """A weight for each node, or none."""
        ...


@dataclass(frozen=True, eq=False)
class MarkerMotion:
    """The motion of a marker as sums over its nodes.

    nodes (n,). weights (n,): those of displacements, with the sum 1. centre (3,): the weighted mean position. levers
    (n, 3): positions relative to it. arms (n, 3): weighted levers, of which moments of displacements are made. by_area:
    whether faces of elements weigh the nodes.
    """

    nodes: list[int]
    weights: Array
    centre: Array
    levers: Array
    arms: Array
    by_area: bool = False

    @property
    def inertia(self) -> Array:
        """The tensor of inertia (3, 3) of the weights."""
        products = np.einsum("ak,al->kl", self.levers, self.arms)
        return np.asarray(np.trace(products) * np.eye(3) - (products + products.T) / 2)

    def displacement(self, fields: Array) -> Array:
        """The displacements (..., 3) of the marker by those of its nodes, (..., n, 3)."""
        return np.asarray(np.einsum("a,...ak->...k", self.weights, fields))

    def rotation(self, fields: Array) -> Array:
        """The rotations (fields, 3) that fit displacements (fields, n, 3) of the nodes best."""
        moments = np.cross(self.arms[None], fields).sum(axis=1)
        return np.asarray(np.linalg.solve(self.inertia, moments.T).T)

    def second_rotation(self, fields: Array, second: Iterable[Array]) -> Array:
        """The rotations s_ij (N, N, 3) of second order that fit sum a_i Phi_i + 1/2 sum a_i a_j Psi_ij best.

        fields (N, n, 3) are Phi; second are Psi, (N, N, 3) for each node. The rotation R of the vector
        sum a_i theta_i + 1/2 sum a_i a_j s_ij turns levers r such that the weighted squares of r + u - R r are least.
        Then the sum of w (R r) x (r + u) vanishes, in any frame, and its part of second order determines s_ij:

            J s_ij = sum w {r x (Psi_ij - theta_i x (theta_j x r)) + 2 (theta_i x r) x Phi_j},

        made symmetric in i and j. The arms take the place of w r.
        """
        theta = self.rotation(fields)
        moments = np.zeros((len(theta), *theta.shape))
        for lever, arm, phi, psi in zip(self.levers, self.arms, fields.swapaxes(0, 1), second, strict=True):
            curved = psi - np.cross(theta[:, None], np.cross(theta, lever))
            moments += np.cross(arm, curved) + 2 * np.cross(np.cross(theta, arm)[:, None], phi)
        both = (moments + moments.swapaxes(0, 1)) / 2
        return np.asarray(np.linalg.solve(self.inertia, both.reshape(-1, 3).T).T.reshape(both.shape))


def marker_motion(body: NodalBody, marker: MarkerNodes, x: Array) -> MarkerMotion:
    """The motion of a marker of a body whose nodes are at x (nodes, 3)."""
    products = _area(body, marker, x)
    if products is None:
        given = np.array([float(w) for w in marker.weights] or [1.0] * len(marker.nodes))
        return _motion(marker.nodes, x, np.diag(given / given.sum()), by_area=False)
    return _motion(marker.nodes, x, products / products.sum(), by_area=True)


def equal_motion(nodes: Sequence[int], x: Array) -> MarkerMotion:
    """The motion of a set of nodes with equal weights."""
    return _motion(nodes, x, np.eye(len(nodes)) / len(nodes), by_area=False)


def _motion(of: Sequence[int], x: Array, products: Array, by_area: bool) -> MarkerMotion:
    nodes = list(of)
    weights = products.sum(axis=0)
    centre = weights @ x[nodes]
    levers = x[nodes] - centre
    return MarkerMotion(nodes, weights, centre, levers, products @ levers, by_area)


def _area(body: NodalBody, marker: MarkerNodes, x: Array) -> Array | None:
    """The products of the shape functions over the faces of a set that is free to deform and has no weights."""
    mesh = body.data.mesh
    if mesh is None or marker.weights or len(marker.nodes) == 1 or tuple(marker.nodes) in body.rigid_sets:
        return None
    return area_products(mesh.elements, x, marker.nodes)
