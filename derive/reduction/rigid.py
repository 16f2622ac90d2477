"""The six rigid fields: translations and the infinitesimal rotations (18)."""

from __future__ import annotations

import math

import numpy as np
from scipy.sparse import csr_array

from derive.reduction.arithmetic import Array, product
from derive.reduction.mass import products

LINE = 1e-9
"""A rotation whose radius of gyration is below this part of the size of the body has no inertia."""


def rigid_fields(x: Array) -> Array:
    """The translations and the infinitesimal rotations of some nodes, (6, nodes, 3)."""
    axes = np.eye(3)
    translations = [np.broadcast_to(e, x.shape) for e in axes]
    return np.array([*translations, *(np.cross(e, x) for e in axes)])


def rigid_basis(mass: csr_array, x: Array) -> Array:
    """Fields orthonormal in the mass that span the rigid motions: six, or fewer where the mass lies on a line.

    `x` is measured from the centre of mass; rotations are about the principal axes.
    """
    from derive.reduction.arithmetic import eigh

    fields = rigid_fields(x)
    values, axes = eigh(products(mass, fields[3:], fields[3:]))
    rotations = product(axes, fields[3:])
    kept = [
        *fields[:3],
        *(rotation for rotation, value in zip(rotations, values, strict=True) if value > LINE**2 * values[-1]),
    ]
    basis: list[Array] = []
    for field in kept:
        for _ in range(2):  # once more, for what rounding left
            field = without(mass, np.array(basis).reshape(-1, *x.shape), field[None])[0]  # noqa: PLW2901
        basis.append(field / math.sqrt(float(products(mass, field[None], field[None])[0, 0])))
    return np.array(basis)


def without(mass: csr_array, basis: Array, fields: Array) -> Array:
    """P fields, P = 1 - R R^T M: fields without what they share with an orthonormal basis R."""
    if not len(basis) or not len(fields):
        return fields
    return fields - product(products(mass, fields, basis), basis)
