"""The part of the static response of a body to loads at markers, to its spin and its modes' inertia that these miss.

The response of all nodes, with inertia relief, less what the modes can represent of it: their response to the same
loads. This is the difference of the methods of mode acceleration and of mode displacement of structural
dynamics. Free modes miss the deformation near the loads; Craig-Bampton modes miss that of the inertia alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, identity

from derive.reduction.arithmetic import Array, symmetric_part
from derive.reduction.body import prepare
from derive.reduction.component_modes import inertia_relief
from derive.reduction.eigen import mass_of_displacements, rigid_set_motions, symmetric_matrix
from derive.reduction.frames import from_centre_of_mass, projected_out, rigid_basis
from derive.reduction.integrals import mass_products
from derive.reduction.interface import marker_motions
from derive.spec.model.body import NodalBody
from derive.spec.model.node_markers import InterfaceMarker

SPIN = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""The entries of a symmetric tensor."""


@dataclass(frozen=True, eq=False)
class MissedResponses:
    """The inner products of the fields that the modes miss, for each unit of the loads.

    The loads are the forces, N, and moments, N m, of each marker, the accelerations of the modes, and the entries of
    `SPIN` in the accelerations per distance of points that turn with the body, 1/s^2. mass, energy (loads, loads): with
    respect to the mass, and twice the strain energy. stiffness (N, N): of the modes.
    """

    mass: Array
    energy: Array
    stiffness: Array

    @staticmethod
    def of_spin(omega: Array) -> Array:
        """The last of the loads (6,) for an angular velocity (3,) in the axes of the body, rad/s."""
        centripetal = np.outer(omega, omega) - omega @ omega * np.eye(len(omega))
        return np.array([centripetal[entry] for entry in SPIN])


def missed_responses(body: NodalBody, markers: Sequence[InterfaceMarker]) -> MissedResponses:
    """The responses that the modes of a body with a stiffness matrix miss. Raises SpecError, see `prepare`."""
    assert body.data.stiffness is not None
    known = prepare(body)
    x = from_centre_of_mass(known.mass, known.shapes.x)
    k, m, basis = symmetric_matrix(body.data.stiffness), mass_of_displacements(known.mass), rigid_basis(known.mass, x)
    coordinates = rigid_set_motions(x, body.rigid_sets) if body.rigid_sets else csr_array(identity(x.size))
    modes = known.shapes.phi.reshape(len(known.shapes.phi), -1)
    turned = np.zeros((len(SPIN), *x.shape))
    for field, (i, j) in zip(turned, SPIN, strict=True):
        field[:, i] += x[:, j]
        field[:, j] += x[:, i] * (i != j)
    inertia = -np.asarray((m @ np.concatenate([modes, turned.reshape(len(turned), -1)]).T).T)
    loads = np.concatenate([*(marker_motions(body, x, marker, 1.0) for marker in markers), inertia])
    responses = inertia_relief(k, m, coordinates, basis.reshape(len(basis), -1))(loads)
    forces = np.asarray((k @ modes.T).T)
    responses -= np.linalg.solve(known.shapes.stiffness, forces @ responses.T).T @ modes
    fields = projected_out(known.mass, basis, responses.reshape(len(responses), *x.shape))
    energy = symmetric_part(responses @ np.asarray(k @ responses.T))
    return MissedResponses(mass_products(known.mass, fields, fields), energy, known.shapes.stiffness)
