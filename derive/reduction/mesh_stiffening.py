"""Geometric stiffness matrices of modes from the mesh: the stresses of unit loads, and their work on the modes.

For each unit load of `second_order`:

1. the static displacement of the linear body. A free body is not held by any support; inertia forces of a rigid
   acceleration balance its load (inertia relief), which is the support that the mean frame needs: there K0t and K0r
   vanish. The conditions of other frames replace it, as `second_order` describes;
2. the stress sigma of that displacement at the points of integration;
3. the matrix K0_ij = int sigma : (grad Phi_i^T grad Phi_j) of the modes.

The loads are -M a of the acceleration fields e_k (K0t), e_k x X (K0r) and omega x (omega x X) for the products of omega
(K0omega), and unit forces at nodes (K0F).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.sparse import csr_array, identity

from derive.reduction.arithmetic import Array
from derive.reduction.component_modes import inertia_relief
from derive.reduction.eigen import mass_of_displacements, rigid_set_motions, symmetric_matrix
from derive.reduction.frames import ModeShapes, from_centre_of_mass, rigid_basis
from derive.solids.stress_work import stress_work
from derive.solids.stresses import IntegratedMesh, strain_energies
from derive.spec.model.mesh import ElementKind, SolidMesh

OMEGA_PRODUCTS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))
"""The axes of the products w1^2, w2^2, w3^2, w1 w2, w2 w3, w1 w3 of K0omega."""

LOADS_AT_ONCE = 60
"""Unit loads whose displacements are in memory at a time."""


ZERO_ENERGY = 1e-9
"""The strain energy of a mode without stiffness, relative to the largest."""

Response = Callable[[Array], Array]
"""The static displacements (L, displacements) of a body under loads (L, displacements)."""


def free_response(
    x: Array, mass: csr_array, stiffness: csr_array, rigid_sets: tuple[tuple[int, ...], ...] = ()
) -> Response:
    """The response of a free body with inertia relief, up to a rigid displacement. Raises SpecError.

    x (nodes, 3), m; mass (nodes, nodes); stiffness (3 nodes, 3 nodes). rigid_sets: sets of nodes that move as rigid
    bodies, whose reactions are a part of the response.
    """
    coordinates = rigid_set_motions(x, rigid_sets) if rigid_sets else csr_array(identity(x.size))
    basis = rigid_basis(mass, from_centre_of_mass(mass, x))
    return inertia_relief(
        symmetric_matrix(stiffness), mass_of_displacements(mass), coordinates, basis.reshape(len(basis), -1)
    )


def integrated_mesh(mesh: SolidMesh, shapes: ModeShapes) -> IntegratedMesh:
    """The elements of a body with modes, with the points of integration of its stiffness.

    Those of bricks of 20 nodes are the eight or the 27 with which the modes have a strain energy nearer to that by the
    stiffness.
    """
    reduced, full = (IntegratedMesh(mesh, shapes.x, every) for every in (False, True))
    if not len(shapes.phi) or all(block.kind is not ElementKind.HEX20 for block in mesh.elements):
        return reduced
    return min(reduced, full, key=lambda solid: float(np.abs(strain_energy_ratios(solid, shapes) - 1).sum()))


def strain_energy_ratios(solid: IntegratedMesh, shapes: ModeShapes) -> Array:
    """The strain energy (N,) of each mode by the elements, relative to that by the stiffness of the body."""
    energies = np.diag(shapes.stiffness) / 2
    least = ZERO_ENERGY * energies.max(initial=1.0)
    return np.asarray(strain_energies(solid, shapes.phi) / np.maximum(energies, least))


def geometric_stiffness_tables(
    solid: IntegratedMesh, mass: csr_array, phi: Array, nodes: Sequence[int], respond: Response
) -> dict[str, Array]:
    """K0t, K0r (3, N, N), K0omega (6, N, N), K0F (K, 3, N, N) and K0F_nodes (K,) of modes phi (N, nodes, 3).

    mass (nodes, nodes). nodes: those of K0F.
    """
    x, m, axes = solid.x, mass_of_displacements(mass), np.eye(3)

    def of_loads(loads: Array) -> Array:
        return stress_work(solid, respond(loads).reshape(len(loads), *x.shape), phi)

    def of_accelerations(fields: list[Array]) -> Array:
        return of_loads(np.array([-(m @ field.ravel()) for field in fields]))

    places = [3 * node + axis for node in nodes for axis in range(3)]
    pulled = np.zeros((len(places), len(phi), len(phi)))
    for first in range(0, len(places), LOADS_AT_ONCE):
        own = places[first : first + LOADS_AT_ONCE]
        forces = np.zeros((len(own), x.size))
        forces[np.arange(len(own)), own] = 1.0
        pulled[first : first + len(own)] = of_loads(forces)
    return {
        "K0t": of_accelerations([np.tile(axis, (len(x), 1)) for axis in axes]),
        "K0r": of_accelerations([np.cross(axis, x) for axis in axes]),
        "K0omega": of_accelerations([spin_acceleration(x, *pair) for pair in OMEGA_PRODUCTS]),
        "K0F": pulled.reshape(len(nodes), 3, len(phi), len(phi)),
        "K0F_nodes": np.array(nodes, dtype=np.int64),
    }


def spin_acceleration(x: Array, a: int, b: int) -> Array:
    """The factor (nodes, 3) of omega_a omega_b in the accelerations omega x (omega x X) at x (nodes, 3)."""
    axes = np.eye(3)
    both = np.cross(axes[a], np.cross(axes[b], x)), np.cross(axes[b], np.cross(axes[a], x))
    return np.asarray(both[0] if a == b else both[0] + both[1])
