"""Rigid motions (18), and the frames that remove them from the modes: mean frame (17), (19), frame at a node (16)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from derive.reduction.arithmetic import (
    Array,
    cholesky,
    eigh,
    forward_substitution,
    inner_products,
    matrix_product,
    pairwise_sum,
    symmetric_part,
)
from derive.reduction.integrals import mass_products, mass_times
from derive.spec.model.body import BodyFrame

ROTARY_INERTIA = 1e-9
"""A rotation has no inertia if its radius of gyration is below this fraction of the largest one."""

COLLINEAR = 1e-6
"""Nodes are collinear with a node if their least moment of inertia about it is below this fraction of the largest."""


@dataclass(frozen=True, eq=False)
class ModeShapes:
    """Mode shapes in a body frame with the origin O.

    x: positions relative to O (nodes, 3), m. phi: modes (N, nodes, 3). stiffness: modal stiffness (N, N). origin: O in
    words. around: the nodes whose mean rotation the frame follows, if it is attached to a node.
    """

    x: Array
    phi: Array
    stiffness: Array
    origin: str
    around: tuple[int, ...] = ()


def rigid_fields(x: Array) -> Array:
    """The three translations and the three infinitesimal rotations (18) of nodes at x (nodes, 3), as (6, nodes, 3)."""
    axes = np.eye(3)
    translations = [np.broadcast_to(e, x.shape) for e in axes]
    return np.array([*translations, *(np.cross(e, x) for e in axes)])


def rigid_basis(mass: csr_array, x: Array) -> Array:
    """An M-orthonormal basis (6, nodes, 3) of the rigid motions; fewer than 6 if all mass lies on one line.

    x (nodes, 3): positions relative to the centre of mass. The rotations are those about the principal axes.
    """
    fields = rigid_fields(x)
    values, axes = eigh(mass_products(mass, fields[3:], fields[3:]))
    rotations = matrix_product(axes, fields[3:])
    with_inertia = [
        *fields[:3],
        *(
            rotation
            for rotation, value in zip(rotations, values, strict=True)
            if value > ROTARY_INERTIA**2 * values[-1]
        ),
    ]
    basis: list[Array] = []
    for field in with_inertia:
        for _ in range(2):  # the second pass removes rounding errors
            field = projected_out(mass, np.array(basis).reshape(-1, *x.shape), field[None])[0]  # noqa: PLW2901
        basis.append(field / math.sqrt(float(mass_products(mass, field[None], field[None])[0, 0])))
    return np.array(basis)


def projected_out(mass: csr_array, basis: Array, fields: Array) -> Array:
    """The projections (1 - R R^T M) f of fields f (F, nodes, 3), for an M-orthonormal basis R (R, nodes, 3)."""
    if not len(basis) or not len(fields):
        return fields
    return fields - matrix_product(mass_products(mass, fields, basis), basis)


def centre_of_mass(mass: csr_array, x: Array) -> Array:
    """The centre of mass (3,) of nodes at x (nodes, 3)."""
    return np.asarray(pairwise_sum(mass_times(mass, x[None])[0]) / pairwise_sum(mass.data))


def from_centre_of_mass(mass: csr_array, x: Array) -> Array:
    """Positions (nodes, 3) relative to the centre of mass, subtracted twice to remove rounding errors."""
    x = x - centre_of_mass(mass, x)
    return np.asarray(x - centre_of_mass(mass, x))


def modes_in_frame(mass: csr_array, x: Array, phi: Array, stiffness: Array, frame: BodyFrame) -> ModeShapes:
    """The modes in the body frame that is specified.

    x (nodes, 3), phi (N, nodes, 3), stiffness (N, N): positions, modes and modal stiffness in the frame of the data.
    The stiffness does not change, because the modes lose only rigid motions, which have no strain energy.
    """
    if frame.kind == "mean":
        x = from_centre_of_mass(mass, x)
        basis = rigid_basis(mass, x)
        for _ in range(2):
            phi = projected_out(mass, basis, phi)
        return ModeShapes(x, phi, stiffness, "the centre of mass of the undeformed body")
    if frame.kind == "point":
        node = 0 if frame.node is None else frame.node
        around = frame.around or nearest_nodes(x, node)
        x = x - x[node]
        for _ in range(2):
            phi = _without_motion_of_node(x, phi, node, around)
        return ModeShapes(x, phi, stiffness, f"node {node} of the undeformed body", around)
    return ModeShapes(x, phi, stiffness, "the origin of the node positions")


def nearest_nodes(x: Array, node: int) -> tuple[int, ...]:
    """The fewest nearest nodes whose displacements determine a rotation about a node; all if they are collinear."""
    distance = pairwise_sum(((x - x[node]) ** 2).T)
    order = [int(i) for i in np.lexsort((np.arange(len(x)), distance)) if distance[i] > 0]
    for count in range(2, len(order) + 1):
        if determine_rotation(x, node, tuple(order[:count])):
            return tuple(order[:count])
    return tuple(order)


def determine_rotation(x: Array, node: int, around: tuple[int, ...]) -> bool:
    """Whether the displacements of nodes determine a rotation about a node: they are not collinear with it."""
    values, _ = eigh(inertia_of_points(x[list(around)] - x[node]))
    return bool(values[0] > COLLINEAR * values[-1])


def inertia_of_points(arms: Array) -> Array:
    """The inertia tensor (3, 3) of unit masses at arms (n, 3)."""
    second = inner_products(np.ascontiguousarray(arms.T), np.ascontiguousarray(arms.T))
    return np.asarray((second[0, 0] + second[1, 1] + second[2, 2]) * np.eye(3) - second)


def _without_motion_of_node(x: Array, phi: Array, node: int, around: tuple[int, ...]) -> Array:
    """Modes without the rigid motion of a node and of the nodes around it.

    The rotation is the least-squares fit of a rigid rotation to the displacements of the nodes around the node.
    """
    arms = x[list(around)] - x[node]
    phi = phi - phi[:, node : node + 1]
    values, axes = eigh(inertia_of_points(arms))
    moments = np.array([pairwise_sum(np.cross(arms, mode[list(around)])) for mode in phi]).reshape(len(phi), 3)
    rotations = matrix_product(matrix_product(moments, axes.T) / values, axes)
    return np.asarray(phi - np.cross(rotations[:, None], x[None] - x[node]))


def orthonormal_modes(mass: csr_array, phi: Array, stiffness: Array) -> tuple[Array, Array]:
    """Linear combinations of modes with unit c8 and diagonal stiffness, and the diagonal (N,), ascending."""
    for _ in range(2):  # the second pass removes rounding errors
        lower = cholesky(symmetric_part(mass_products(mass, phi, phi)))
        if lower is None:
            raise ValueError("modes are dependent")  # check_modes reports them first, with their combination
        phi = forward_substitution(lower, phi)
        stiffness = symmetric_part(forward_substitution(lower, forward_substitution(lower, stiffness).T))
    values, vectors = eigh(stiffness)
    return matrix_product(vectors, phi), values


def with_fixed_signs(phi: Array) -> Array:
    """Modes with definite signs: the first component (by node, then axis) above 0.6 of the largest one is positive.

    The sign of the largest component is not suitable: in a symmetric body two components have the same size, and
    rounding errors decide between them.
    """
    flat = np.ascontiguousarray(phi).reshape(len(phi), -1)
    first = np.argmax(np.abs(flat) >= 0.6 * np.abs(flat).max(axis=1, initial=0.0)[:, None], axis=1)
    signs = np.copysign(1.0, flat[np.arange(len(flat)), first])
    return np.asarray(phi * signs[:, None, None] + 0.0)
