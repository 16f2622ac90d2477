"""The motion of a marker at a set of nodes: their weighted mean displacement, and the rotation that fits them best."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from typing import Protocol

import numpy as np

from derive.reduction.arithmetic import Array


class MarkerNodes(Protocol):
    """The nodes of a marker, and their weights, which are equal if there are none."""

    @property
    def nodes(self) -> tuple[int, ...]:
        """The nodes."""
        ...

    @property
    def weights(self) -> tuple[Fraction, ...]:
        """A weight for each node, or none."""
        ...


def set_weights(marker: MarkerNodes) -> Array:
    """The weights of the nodes of a marker, whose sum is 1."""
    given = np.array([float(w) for w in marker.weights] or [1.0] * len(marker.nodes))
    return np.asarray(given / given.sum())


def fitted_rotations(weights: Array, levers: Array, fields: Array) -> Array:
    """The rotations (n, 3) that fit displacements (n, nodes, 3) of nodes with these levers from their centre best."""
    moments = np.einsum("a,nak->nk", weights, np.cross(levers[None], fields))
    return np.asarray(np.linalg.solve(inertia_of_set(weights, levers), moments.T).T)


def fitted_second_rotations(weights: Array, levers: Array, fields: Array, second: Iterable[Array]) -> Array:
    """The rotations s_ij (n, n, 3) of second order that fit displacements sum a_i Phi_i + 1/2 sum a_i a_j Psi_ij best.

    fields (n, nodes, 3) are Phi; second are Psi, (n, n, 3) for each node. The rotation R of the vector
    sum a_i theta_i + 1/2 sum a_i a_j s_ij turns levers r such that the weighted squares of r + u - R r are least. Then
    the sum of w (R r) x (r + u) vanishes, in any frame, and its part of second order determines s_ij:

        J s_ij = sum w {r x (Psi_ij - theta_i x (theta_j x r)) + 2 (theta_i x r) x Phi_j}, made symmetric in i and j.
    """
    theta = fitted_rotations(weights, levers, fields)
    moments = np.zeros((len(theta), *theta.shape))
    for w, r, phi, psi in zip(weights, levers, fields.swapaxes(0, 1), second, strict=True):
        turned = np.cross(theta, r)
        curved = psi - np.cross(theta[:, None], turned)
        moments += w * (np.cross(r, curved) + 2 * np.cross(turned[:, None], phi))
    both = (moments + moments.swapaxes(0, 1)) / 2
    return np.asarray(np.linalg.solve(inertia_of_set(weights, levers), both.reshape(-1, 3).T).T.reshape(both.shape))


def inertia_of_set(weights: Array, levers: Array) -> Array:
    """The tensor of inertia (3, 3) of the weights at their levers."""
    return np.asarray(np.einsum("a,akl->kl", weights, _moments(levers)))


def _moments(levers: Array) -> Array:
    """The tensors (r . r) I - r r of some vectors (n, 3)."""
    squares = np.einsum("ak,ak->a", levers, levers)
    return np.asarray(squares[:, None, None] * np.eye(3) - np.einsum("ak,al->akl", levers, levers))
