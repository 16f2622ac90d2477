"""Geometric stiffness matrices of modes from the mesh, by the displacements of second order of all its nodes.

1. The quadratic part of the strain of modes, sym(grad Phi_i^T grad Phi_j), would cause stresses in the elements.
2. Psi_ij is the static displacement of the linear body under minus these stresses. A free body is not held by any
   support, and its mean displacement and rotation vanish: this is the mean frame, in which K0t and K0r vanish. The
   conditions of other frames replace it, as `second_order` describes.
   A rigid set of nodes that turns by theta moves its nodes by 1/2 theta x (theta x r) to second order, and so Psi_ij is
   a rigid motion of the set and the symmetric part of theta_i x (theta_j x r), which is given.
3. The geometric stiffness under a load is minus its work on Psi_ij. By the theorem of Betti this is int sigma : (grad
   Phi_i^T grad Phi_j) with the stress sigma of the load, balanced by the inertia forces of a rigid acceleration, and
   the work of the reactions of rigid sets on the given part of Psi_ij.

The loads are -M a of the acceleration fields e_k (K0t), e_k x X (K0r) and omega x (omega x X) for the products of omega
(K0omega), and unit forces at nodes (K0F). There is a static solution for each pair of modes, for any number of nodes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.sparse import csr_array, identity

from derive.reduction.arithmetic import Array
from derive.reduction.component_modes import inertia_relief
from derive.reduction.eigen import mass_of_displacements, rigid_set_motions, symmetric_matrix
from derive.reduction.frames import ModeShapes, from_centre_of_mass, rigid_basis
from derive.reduction.marker_motion import equal_motion
from derive.solids.quadratic_strains import quadratic_loads
from derive.solids.stresses import IntegratedMesh, strain_energies
from derive.spec.model.mesh import ElementKind, NodeMesh

OMEGA_PRODUCTS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))
"""The axes of the products w1^2, w2^2, w3^2, w1 w2, w2 w3, w1 w3 of K0omega."""

PAIRS_AT_ONCE = 60
"""Pairs of modes whose displacements are in memory at a time."""


ZERO_ENERGY = 1e-9
"""The strain energy of a mode without stiffness, relative to the largest."""

Response = Callable[[Array, Array, Array], Array]
"""The displacements (L, displacements) of second order of pairs of modes, both (L, nodes, 3), from their loads."""


def free_response(
    x: Array, mass: csr_array, stiffness: csr_array, rigid_sets: tuple[tuple[int, ...], ...] = ()
) -> Response:
    """The response of a free body with inertia relief, without mean displacement and rotation. Raises SpecError.

    x (nodes, 3), m; mass (nodes, nodes); stiffness (3 nodes, 3 nodes). rigid_sets: sets of nodes that move as rigid
    bodies in all modes, by finite rotations, and whose reactions are a part of the response.
    """
    coordinates = rigid_set_motions(x, rigid_sets) if rigid_sets else csr_array(identity(x.size))
    basis = rigid_basis(mass, from_centre_of_mass(mass, x))
    flat, m = basis.reshape(len(basis), -1), mass_of_displacements(mass)
    k = symmetric_matrix(stiffness)
    relieved = inertia_relief(k, m, coordinates, flat)

    def respond(loads: Array, first: Array, second: Array) -> Array:
        given = turned_sets(x, rigid_sets, first, second)
        found = given + relieved(loads - given @ k)
        return np.asarray(found - (found @ (m @ flat.T)) @ flat)

    return respond


def turned_sets(x: Array, rigid_sets: tuple[tuple[int, ...], ...], first: Array, second: Array) -> Array:
    """The symmetric parts of theta_i x (theta_j x r) of rigid sets, (L, displacements), which vanish at other nodes.

    theta_i and theta_j are the rotations of a set in the modes first and second, both (L, nodes, 3).
    """
    result = np.zeros_like(first)
    for nodes in map(list, rigid_sets):
        motion = equal_motion(nodes, x)
        one, two = (motion.rotation(of[:, nodes])[:, None] for of in (first, second))
        levers = motion.levers
        result[:, nodes] = (np.cross(one, np.cross(two, levers)) + np.cross(two, np.cross(one, levers))) / 2
    return result.reshape(len(first), -1)


def integrated_mesh(mesh: NodeMesh, shapes: ModeShapes) -> IntegratedMesh:
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
    x, m, axes, count = solid.x, mass_of_displacements(mass), np.eye(3), len(phi)
    fields = [np.tile(axis, (len(x), 1)) for axis in axes]
    fields += [np.cross(axis, x) for axis in axes]
    fields += [spin_acceleration(x, *pair) for pair in OMEGA_PRODUCTS]
    inertia = np.array([m @ field.ravel() for field in fields])
    work = np.zeros((len(fields) + 3 * len(nodes), count, count))
    first, second = np.triu_indices(count)
    for start in range(0, len(first), PAIRS_AT_ONCE):
        i, j = (each[start : start + PAIRS_AT_ONCE] for each in (first, second))
        psi = respond(quadratic_loads(solid, phi, i, j).reshape(len(i), -1), phi[i], phi[j])
        at_nodes = psi.reshape(len(i), -1, 3)[:, list(nodes)].reshape(len(i), -1)
        work[:, i, j] = work[:, j, i] = np.concatenate([inertia @ psi.T, -at_nodes.T])
    return {
        "K0t": work[:3],
        "K0r": work[3:6],
        "K0omega": work[6:12],
        "K0F": work[12:].reshape(len(nodes), 3, count, count),
        "K0F_nodes": np.array(nodes, dtype=np.int64),
    }


def spin_acceleration(x: Array, a: int, b: int) -> Array:
    """The factor (nodes, 3) of omega_a omega_b in the accelerations omega x (omega x X) at x (nodes, 3)."""
    axes = np.eye(3)
    both = np.cross(axes[a], np.cross(axes[b], x)), np.cross(axes[b], np.cross(axes[a], x))
    return np.asarray(both[0] if a == b else both[0] + both[1])
