"""Rigid motion kept out of the modes: the mean frame (17), (19), a frame at a node (16), or the modes as given."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from derive.reduction.arithmetic import Array, cholesky, eigh, forward, gram, product, symmetric, total
from derive.reduction.mass import products, weighted
from derive.reduction.rigid import rigid_basis, without
from derive.spec.model.body import BodyFrame

FLAT = 1e-6
"""Neighbours are enough for a rotation if their least moment about the node is not below this part of the largest."""


@dataclass(frozen=True, eq=False)
class Shapes:
    """Positions relative to O (nodes, 3), modes (N, nodes, 3) and modal stiffness (N, N); `origin` describes O."""

    x: Array
    phi: Array
    stiffness: Array
    origin: str
    around: tuple[int, ...] = ()


def centre(mass: csr_array, x: Array) -> Array:
    """The centre of mass."""
    return np.asarray(total(weighted(mass, x[None])[0]) / total(mass.data))


def centred(mass: csr_array, x: Array) -> Array:
    """Positions from the centre of mass; once more, for what rounding left."""
    x = x - centre(mass, x)
    return np.asarray(x - centre(mass, x))


def in_frame(mass: csr_array, x: Array, phi: Array, stiffness: Array, frame: BodyFrame) -> Shapes:
    """Modes in a frame. Strain energy stays as it is, since each mode loses a rigid motion and nothing else."""
    if frame.kind == "mean":
        x = centred(mass, x)
        basis = rigid_basis(mass, x)
        for _ in range(2):
            phi = without(mass, basis, phi)
        return Shapes(x, phi, stiffness, "the centre of mass of the undeformed body")
    if frame.kind == "point":
        node = 0 if frame.node is None else frame.node
        around = frame.around or neighbours(x, node)
        x = x - x[node]
        for _ in range(2):
            phi = _without_motion_of_node(x, phi, node, around)
        return Shapes(x, phi, stiffness, f"node {node} of the undeformed body", around)
    return Shapes(x, phi, stiffness, "the origin of the node positions")


def neighbours(x: Array, node: int) -> tuple[int, ...]:
    """The nearest nodes to a node that are enough to see a rotation of it: not on one line with it; fewest first."""
    distance = total(((x - x[node]) ** 2).T)
    order = [int(i) for i in np.lexsort((np.arange(len(x)), distance)) if distance[i] > 0]
    for count in range(2, len(order) + 1):
        if holds(x, node, tuple(order[:count])):
            return tuple(order[:count])
    return tuple(order)


def holds(x: Array, node: int, around: tuple[int, ...]) -> bool:
    """Whether the displacements of some nodes about a node determine a rotation."""
    values, _ = eigh(_inertia(x[list(around)] - x[node]))
    return bool(values[0] > FLAT * values[-1])


def _inertia(arms: Array) -> Array:
    second = gram(np.ascontiguousarray(arms.T), np.ascontiguousarray(arms.T))
    return np.asarray((second[0, 0] + second[1, 1] + second[2, 2]) * np.eye(3) - second)


def _without_motion_of_node(x: Array, phi: Array, node: int, around: tuple[int, ...]) -> Array:
    """Modes without the rigid motion of the node and of the nodes around it.

    The rotation is the least-squares fit of a rigid rotation to the displacements of the nodes around the node.
    """
    arms = x[list(around)] - x[node]
    phi = phi - phi[:, node : node + 1]
    values, axes = eigh(_inertia(arms))
    moments = np.array([total(np.cross(arms, mode[list(around)])) for mode in phi]).reshape(len(phi), 3)
    rotations = product(product(moments, axes.T) / values, axes)
    return np.asarray(phi - np.cross(rotations[:, None], x[None] - x[node]))


def orthonormal(mass: csr_array, phi: Array, stiffness: Array) -> tuple[Array, Array]:
    """Modes combined so that c8 is the unit matrix and the stiffness diagonal, with the diagonal, ascending."""
    for _ in range(2):  # once more, for what rounding left
        lower = cholesky(symmetric(products(mass, phi, phi)))
        if lower is None:
            raise ValueError("modes are dependent")  # refused before, with their combination
        phi = forward(lower, phi)
        stiffness = symmetric(forward(lower, forward(lower, stiffness).T))
    values, vectors = eigh(stiffness)
    return product(vectors, phi), values


def with_signs(phi: Array) -> Array:
    """Modes with their signs fixed: the first component (by node, then axis) of at least 0.6 of the largest is > 0.

    The largest itself would not do: in a symmetric body it comes twice, and rounding picks one of them.
    """
    flat = np.ascontiguousarray(phi).reshape(len(phi), -1)
    first = np.argmax(np.abs(flat) >= 0.6 * np.abs(flat).max(axis=1, initial=0.0)[:, None], axis=1)
    signs = np.copysign(1.0, flat[np.arange(len(flat)), first])
    return np.asarray(phi * signs[:, None, None] + 0.0)
