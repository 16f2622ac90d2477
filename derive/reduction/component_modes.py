"""Component modes of a body that joints hold: Craig-Bampton modes, and attachment modes with inertia relief.

**Craig-Bampton** (AIAA J. 6, 1968, 1313-1319). The markers of the interface have c displacements and rotations B u.

* Static modes: the displacements due to a unit motion of each marker while the others are held and nothing else is
  loaded, K u = B^T lambda, B u = e_k. Six combinations of them are the rigid motions; c - 6 are left.
* Vibration modes: the natural modes of the body that is held at its interface, B u = 0.

**Attachment modes** with inertia relief (Rubin, AIAA J. 13, 1975, 995-1006): the displacements due to a unit force or
moment at each motion of a marker, balanced by the inertia forces of a rigid acceleration, K u = (1 - M R R^T) B^T e_k,
with R the orthonormal rigid motions. They are c, since a free body has no rigid response to balanced loads. The modes
of vibration beside them are those of the free body, and attachment modes are made orthogonal to these.

Both are brought to the mean frame by Phi = (1 - R R^T M) C, which changes no strain energy, and are then combined to
orthonormal modes with a diagonal stiffness. Strain energy tells what such a mode is made of: static modes are
K-orthogonal to the vibration modes of both kinds, so that the energy of a combination is the sum of two parts.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import scipy.linalg
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import SuperLU, splu

from derive.errors import Problem, SpecError
from derive.reduction.arithmetic import Array, symmetric_part
from derive.reduction.eigen import (
    EXTRA_MODES,
    elastic_modes,
    lowest_modes,
    mass_of_displacements,
    max_elastic_modes,
    modal_stiffness,
    symmetric_matrix,
)
from derive.reduction.frames import from_centre_of_mass, orthonormal_modes, projected_out, rigid_basis
from derive.reduction.integrals import mass_products
from derive.reduction.interface import RIGID_MOTIONS, HeldInterface, interface_of
from derive.spec.model.body import NodalBody
from derive.spec.model.node_markers import InterfaceMarker

SINGULAR = 1e-14
"""A stiffness is singular if a pivot is below this part of the largest."""

INDEPENDENT = 1e-12
"""The least eigenvalue of c8 of normalised modes that do not depend on each other."""

ModeKind = Literal["static", "vibration"]


@dataclass(frozen=True, eq=False)
class ComponentModes:
    """The static modes (S, nodes, 3) of an interface and the vibration modes (V, nodes, 3) beside them."""

    static: Array
    vibration: Array


def static_mode_count(kind: str, markers: tuple[InterfaceMarker, ...]) -> int:
    """The number of static modes that an interface has."""
    rigid = RIGID_MOTIONS if kind == "craig_bampton" else 0
    return max(sum(marker.motions for marker in markers) - rigid, 0)


def component_modes(body: NodalBody, mass: csr_array, x: Array) -> ComponentModes:
    """The component modes of a body in the mean frame. Raises SpecError if its interface does not hold it.

    mass: the canonical mass matrix. x (nodes, 3).
    """
    assert body.data.stiffness is not None and isinstance(body.modes, int)  # by check_body
    x = from_centre_of_mass(mass, x)
    interface, basis = interface_of(body, x), rigid_basis(mass, x)
    k, m = symmetric_matrix(body.data.stiffness), mass_of_displacements(mass)
    count = body.modes - static_mode_count(str(body.component_modes), body.interface_markers)
    if body.component_modes == "craig_bampton":
        static, vibration = _static_modes(k, interface), _held_modes(k, m, interface, body, count)
    else:
        loads = interface.motions.toarray()
        static = inertia_relief(k, m, interface.coordinates, basis.reshape(len(basis), -1))(loads)
        vibration = _free_modes(body, mass, x, count).reshape(count, x.size)
    static, vibration = (fields.reshape(len(fields), *x.shape) for fields in (static, vibration))
    for _ in range(2):
        static, vibration = (projected_out(mass, basis, fields) for fields in (static, vibration))
        if body.component_modes == "attachment":
            static = projected_out(mass, vibration, static)
    return ComponentModes(_normalised(mass, static), _normalised(mass, vibration))


def independent_modes(modes: ComponentModes, mass: csr_array, stiffness: csr_array) -> tuple[Array, Array]:
    """All component modes (N, nodes, 3) and their stiffness (N, N). Raises SpecError if they are dependent."""
    phi = np.concatenate([modes.static, modes.vibration])
    least = float(np.linalg.eigvalsh(symmetric_part(mass_products(mass, phi, phi)))[0])
    if least < INDEPENDENT:
        text = f"static and vibration modes of the interface depend on each other (least eigenvalue of c8 {least:.1e})"
        raise SpecError((Problem("body.modes", f"{text}; ask for fewer modes"),))
    return phi, modal_stiffness(symmetric_matrix(stiffness), phi)


def mode_kinds(modes: ComponentModes, phi: Array, stiffness: csr_array) -> tuple[ModeKind, ...]:
    """Whether the modes phi (N, nodes, 3), combinations of component modes, have more energy in static ones."""
    flat, vibration = (fields.reshape(len(fields), 3 * fields.shape[1]) for fields in (phi, modes.vibration))
    k = symmetric_matrix(stiffness)
    forces = (k @ vibration.T).T
    energies = np.einsum("vn,vn->v", vibration, forces)
    shares = np.sum((flat @ forces.T) ** 2 / energies, axis=1) / np.einsum("in,in->i", flat, (k @ flat.T).T)
    return tuple("vibration" if share > 1 / 2 else "static" for share in shares)


def _static_modes(k: csr_array, interface: HeldInterface) -> Array:
    """The static modes (c - 6, displacements): combinations of unit motions that are orthogonal to the rigid ones."""
    held = interface.held
    factors = _factorised(csc_array(held.T @ k @ held))
    constraint = interface.unit - held @ factors.solve(np.asarray(held.T @ (k @ interface.unit)))
    _, _, combinations = np.linalg.svd(interface.rigid.T)
    return np.asarray(combinations[RIGID_MOTIONS:] @ constraint.T)


def _held_modes(k: csr_array, m: csr_array, interface: HeldInterface, body: NodalBody, count: int) -> Array:
    """The vibration modes (count, displacements) of lowest frequency of the body that is held at its interface."""
    if not count:
        return np.zeros((0, k.shape[0]))
    most = max_elastic_modes(body.data.mass, len(interface.motions.indptr) - 1, body.rigid_sets)
    return lowest_modes(k, m, 0.0, min(count + EXTRA_MODES, most), most, interface.held).T[:count]


def inertia_relief(k: csr_array, m: csr_array, coordinates: csr_array, basis: Array) -> Callable[[Array], Array]:
    """The responses (L, displacements) to loads (L, displacements) on the nodes, as a function of these.

    Inertia forces of rigid motions balance the loads. coordinates (displacements, n): those that rigid sets leave.
    basis (6, displacements): the orthonormal rigid motions. Six coordinates are held, whose reactions vanish, since the
    loads are balanced. Raises SpecError if the stiffness is singular beyond the six rigid motions.
    """
    rigid = splu(csc_array(coordinates.T @ coordinates)).solve(np.asarray(coordinates.T @ basis.T))
    _, _, order = scipy.linalg.qr(rigid.T, mode="economic", pivoting=True)
    moving = np.sort(order[RIGID_MOTIONS:])
    own = csc_array(coordinates[:, moving])
    factors = _factorised(csc_array(own.T @ k @ own))

    def responses(loads: Array) -> Array:
        balanced = loads - (loads @ basis.T) @ (m @ basis.T).T
        return np.asarray(own @ factors.solve(np.asarray(own.T @ balanced.T))).T

    return responses


def _free_modes(body: NodalBody, mass: csr_array, x: Array, count: int) -> Array:
    """The natural modes (count, nodes, 3) of the free body of lowest frequency, orthonormal."""
    if not count:
        return np.zeros((0, *x.shape))
    return orthonormal_modes(mass, *elastic_modes(replace(body, modes=count), mass, x))[0][:count]


def _factorised(matrix: csc_array) -> SuperLU:
    """The factors of the stiffness of a held body. Raises SpecError if it is singular."""
    try:
        factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        pivots = np.abs(factors.U.diagonal())
    except RuntimeError:
        pivots = np.zeros(1)
    if not pivots.min() > SINGULAR * pivots.max():
        text = "a part of the body moves without stiffness while its interface is held; look for parts that are loose"
        raise SpecError((Problem("body.interface", text),))
    return factors


def _normalised(mass: csr_array, phi: Array) -> Array:
    """Modes with c8_ii = 1."""
    if not len(phi):
        return phi
    return np.asarray(phi / np.sqrt(np.diag(mass_products(mass, phi, phi)))[:, None, None])
