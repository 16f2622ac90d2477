"""The tables of C by hand for chains in space: rows of 8 numbers, 3 translations, 0, 3 rotations, 0."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from space_scenes import Array, RigidLink

from derive.mechanics.multibody.space.flexible import ReducedBody


def rigid_tables(links: Sequence[RigidLink]) -> Array:
    """Compliances at the handles, inertia and its inverse, handles, 1/mass of each body."""
    return np.concatenate([_rigid(link) for link in links])


def flexible_tables(links: Sequence[ReducedBody]) -> Array:
    """The integrals, the modes at the handles and the constant compliances of each body, in its mean frame."""
    return np.concatenate([_flexible(link) for link in links])


def _rigid(link: RigidLink) -> Array:
    inverse = np.linalg.inv(link.inertia)
    compliance = np.zeros((6, 6))
    compliance[:3, :3], compliance[3:, 3:] = np.eye(3) / link.mass, inverse
    left, right = (_moved(at) for at in (link.left, link.right))
    pairs = ((left, left), (left, right), (right, right))
    parts = [_rows(a @ compliance @ b.T) for a, b in pairs]
    tensors = [_padded(x) for x in (link.inertia, inverse)]
    return np.concatenate([*parts, *tensors, [*link.left, 0, *link.right, 0, 1 / link.mass, 0, 0, 0]])


def _flexible(link: ReducedBody) -> Array:
    body = link.body
    assert np.allclose(body.c8, np.eye(body.modes)), "modes are orthonormal"
    stiffness = np.diag(body.stiffness)
    frames = link.frames
    handles = [np.vstack([f.point.shapes.T, f.twists.T]) for f in frames]
    rigid = np.zeros((6, 6))
    rigid[:3, :3] = np.eye(3) / body.mass
    left, right = handles
    parts = [_rows(a @ b.T + rigid) for a, b in ((left, left), (left, right), (right, right))]
    c7 = body.c7.transpose(0, 2, 1)  # the factors of alpha_j and alphaddot_i in the coupling, by j, component, i
    c4, c5 = (np.stack([t[..., a, b] for a, b in TENSOR], axis=-1) for t in map(_symmetric, (body.C4, body.C5)))
    integrals = [c7.ravel(), c4.T.ravel(), c5.transpose(0, 2, 1).ravel()]
    modes = [*(_rows(h.T) for h in handles), *(h.ravel() for h in handles), stiffness]
    places = [[*f.point.position, 0] for f in frames]
    inertia = [body.C3[a, b] for a, b in TENSOR]
    return np.concatenate([*parts, *integrals, *modes, *places, inertia, [1 / body.mass, 0]])


def free_tables(link: ReducedBody) -> Array:
    """The parameters of handwritten_body.c in the mean frame, where modes are orthonormal."""
    body = link.body
    i, j = np.triu_indices(body.modes)
    a, b = np.triu_indices(3)
    above = i < j
    C4, C5 = map(_symmetric, (body.C4, body.C5))
    parts = [body.C3[a, b], C4[:, a, b], C5[i, j][:, a, b], body.c7[i[above], j[above]], np.diag(body.stiffness)]
    return np.concatenate([[body.mass], *(part.ravel() for part in parts)])


TENSOR = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
"""The entries of a symmetric tensor in the order of the tables."""


def _moved(at: Array) -> Array:
    """The motion of a handle by the motion of the centre of mass."""
    x, y, z = at
    result = np.eye(6)
    result[:3, 3:] = [[0, z, -y], [-z, 0, x], [y, -x, 0]]
    return result


def _symmetric(tensors: Array) -> Array:
    return (tensors + tensors.swapaxes(-1, -2)) / 2


def _rows(matrix: Array) -> Array:
    result = np.zeros((len(matrix), 8))
    result[:, :3], result[:, 4:7] = matrix[:, :3], matrix[:, 3:]
    return result.ravel()


def _padded(matrix: Array) -> Array:
    return np.hstack([matrix, np.zeros((len(matrix), 1))]).ravel()
