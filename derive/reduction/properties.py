"""Mass, centre of mass, inertia and natural frequencies of a finite-element body, in which errors of units show."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from derive.reduction.arithmetic import Array, symmetric_part
from derive.reduction.body import prepare
from derive.reduction.frames import centre_of_mass, from_centre_of_mass, projected_out, rigid_basis
from derive.reduction.integrals import shape_integrals
from derive.spec.model.body import NodalBody


@dataclass(frozen=True, eq=False)
class BodyProperties:
    """Properties of a free undeformed body, in SI units.

    centre (3,): the centre of mass in the coordinates of the nodes. inertia (3, 3): about the centre of mass, in the
    axes of the nodes. frequencies (N,): the natural frequencies of the free body with its N modes, Hz, ascending.
    """

    mass: float
    centre: Array
    inertia: Array
    frequencies: Array


def body_properties(body: NodalBody) -> BodyProperties:
    """The properties of a body, computed from its mass matrix and its modes. Raises SpecError as `reduce` does.

    The frequencies are those of K V = omega^2 c8 V, where c8 is that of the modes without their rigid-body motion, so
    that they are the same in every frame.
    """
    prepared = prepare(body)
    mass, x = prepared.mass, from_centre_of_mass(prepared.mass, prepared.raw.x)
    elastic = projected_out(mass, rigid_basis(mass, x), prepared.shapes.phi)
    integrals = shape_integrals(mass, x, elastic)
    count = len(elastic)
    squares = eigh(prepared.shapes.stiffness, symmetric_part(integrals.c8), eigvals_only=True) if count else np.zeros(0)
    return BodyProperties(
        mass=integrals.mass,
        centre=centre_of_mass(mass, prepared.raw.x),
        inertia=integrals.C3,
        frequencies=np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi),
    )
