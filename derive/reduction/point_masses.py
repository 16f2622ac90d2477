"""Bodies that are given by the moments of their fields, as standard input data are, and not by masses at nodes.

The equations contain a body through integrals of products of the fields 1, x, y, z and the components of the modes
alone. Point masses with these integrals stand for such a body: as many as there are independent fields, behind its
nodes, which have no mass. A body of second order in which the deformation changes the inertia has moments that belong
to no distribution of mass; some of the point masses then count negatively.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import block_diag, csr_array

from derive.reduction.arithmetic import Array
from derive.reduction.integrals import Integrals, integrals_of
from derive.spec.model.node_data import NodeData

FIRST_MODE = 4
"""The row of the first mode among the moments, behind 1, x, y and z."""

ROUNDING = 1e-15

INDEPENDENT = 1e-13
"""Fields depend on each other if an eigenvalue of their moments, relative to their sizes, is below this."""


def with_point_masses(data: NodeData) -> NodeData:
    """The data of a body that is given by moments, with point masses behind its nodes that have these moments."""
    if data.moments is None or data.modes is None:
        return data
    fields, mass = _point_masses(data.moments)
    x, modes = fields[:, 1:FIRST_MODE], fields[:, FIRST_MODE:].reshape(len(fields), -1, 3).transpose(1, 0, 2)
    n = len(data.positions)
    return replace(
        data,
        positions=np.concatenate([data.positions, x]),
        modes=np.concatenate([data.modes, modes], axis=1),
        mass=csr_array(block_diag([csr_array((n, n)), csr_array(mass)])),
    )


def _point_masses(moments: Array) -> tuple[Array, Array]:
    """Fields F (points, fields), of which the first is 1, and a matrix m (points, points) with F^T m F = moments.

    With the eigenvectors of the moments, A^T D A = moments for a diagonal D of signs. A reflection that makes the first
    column of A constant makes points of it, whose masses are equal if all signs are positive.
    """
    sizes = np.sqrt(np.abs(np.diag(moments)))
    sizes[sizes == 0] = 1.0
    values, vectors = np.linalg.eigh(moments / np.multiply.outer(sizes, sizes))
    kept = np.abs(values) > INDEPENDENT * np.abs(values).max()
    roots = (np.sqrt(np.abs(values[kept])) * vectors[:, kept]).T * sizes
    signs = np.sign(values[kept])
    length = float(np.linalg.norm(roots[:, 0]))
    wanted = np.full(len(roots), length / np.sqrt(len(roots)))
    normal = roots[:, 0] - wanted
    size = float(normal @ normal)
    reflection = np.eye(len(roots)) - (2 / size if size else 0.0) * np.multiply.outer(normal, normal)
    mass = (reflection * signs) @ reflection.T * (wanted[0] ** 2)
    if (signs > 0).all():
        mass = np.diag(np.full(len(roots), wanted[0] ** 2))
    fields = reflection @ roots / wanted[0]
    fields[:, 0] = 1.0
    return fields, mass


def integrals_of_moments(moments: Array, modes: int) -> Integrals:
    """The shape integrals of a body in the frame of its data, whose modes are the first ones as they stand."""
    count = FIRST_MODE + 3 * modes
    linear = moments[0, 1:count].reshape(-1, 3)
    second = moments[1:count, 1:count].reshape(1 + modes, 3, 1 + modes, 3).transpose(0, 2, 1, 3)
    result = integrals_of(float(moments[0, 0]), linear, second)
    sizes = np.sqrt(np.abs(np.diag(result.c8)))
    rounding = np.abs(result.c8) <= ROUNDING * np.multiply.outer(sizes, sizes)  # of sums of three numbers
    return replace(result, c8=np.where(rounding, 0.0, result.c8))
