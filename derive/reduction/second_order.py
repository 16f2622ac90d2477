"""Geometric stiffening: second-order displacement fields of a body in space from geometric stiffness matrices.

**Fields.** A body that deforms by u = sum a_i Phi_i stretches to second order, and its large stiffness against
stretching displaces it further: u = sum a_i Phi_i + 1/2 sum a_i a_j Psi_ij, where Psi_ij is the static response of the
linear body to the stresses that the quadratic part of the strain, sym(grad Phi_i^T grad Phi_j), would cause. A beam
gets shorter when it bends. With the same virtual work from x = c + Q (X + u), and T through second order in the
amplitudes, Psi_ij enters the equations of motion through two moments alone,

    S_ij = int rho Psi_ij                  (c9_ij of the derivation)
    G_ij = int rho X (x) Psi_ij            (its axial part int rho X x Psi_ij is c10_ij; its symmetric part is added to
                                            C5_ij, as P_ij = (tr G_ij) I - sym G_ij)

and through its values at material points. Both are symmetric in i and j, without any other condition: each choice
of them has a kinetic energy and hence a symmetric M, conserves energy and momenta, and a part of them is a model of its
own kind (with zeros for the others), if a less accurate one.

**Geometric stiffness.** Finite-element programs give the same data as geometric stiffness matrices. The inertia load
of a rigid motion is -rho (a + omegadot x X + omega x (omega x X)), with a the acceleration of O less gravity, in the
body frame. Let sigma_f be the stress of the linear body under a load f, and K0_ij = int sigma_f : (grad Phi_i^T grad
Phi_j). Since Psi_ij is the response to the quadratic strain, the theorem of Betti gives -K0_ij = int f . Psi_ij, and

    K0t_k     load -rho e_k                          int rho Psi_ij . e_k                       = S_ij . e_k
    K0r_k     load -rho e_k x X                      int rho Psi_ij . (e_k x X)                 = c10_ij . e_k
    K0omega   load -rho omega x (omega x X)          int rho Psi_ij . (omega x (omega x X))     = -omega . P_ij omega
    K0F_k     unit force e_k at a node               -Psi_ij . e_k at the node

so that the row of alpha_i contains sum_j (K + sum_k K0t_k a_k + sum_k K0r_k omegadot_k + sum_m K0omega_m Omega_m
+ sum K0F_k F_k)_ij a_j, with Omega = (w1^2, w2^2, w3^2, w1 w2, w2 w3, w1 w3) and F the forces at nodes.

These are the names of the standard input data of Wallrapp (Mech. Struct. Mach. 22, 1994, 283-304; Wallrapp and
Schwertassek, Int. J. Numer. Meth. Eng. 32, 1991, 1833-1850). A SID contains K0t as the first order of Ct, K0r in that
of Cr, K0omega in that of Oe, and -K0F as that of phi. Some programs write K0t and K0F with the other sign. The sign
here is that of a stiffness: of a column that stands on its foot and points along e_k, K0t_k is negative (an
acceleration a_k > 0, or gravity along -e_k, compresses it), and K0F_k of its tip is positive (a pull stiffens it).

**Frames.** The matrices belong to the supports under which the stresses were computed, and the conditions of the body
frame replace these: the new frame moves against the old one by s_i and theta_i for each a_i, and by s_ij and theta_ij
to second order, so that Phi'_i = Phi_i - s_i + theta_i x X and

    Psi'_ij = Psi_ij + theta_i x Phi'_j + theta_j x Phi'_i - 1/2 {theta_i x (theta_j x X) + theta_j x (theta_i x X)}
              - s_ij + theta_ij x X

with s_ij and theta_ij from the conditions of the frame on Psi'_ij: (17) and (19) in the mean frame, where S and c10
vanish; no displacement of the node and no mean rotation of its neighbours in the frame of a node. All of this is done
on the moments.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_array

from derive.errors import Problem
from derive.reduction.arithmetic import Array, cholesky, eigh, forward_substitution, matrix_product, pairwise_sum
from derive.reduction.frames import ModeShapes, inertia_of_points, nearest_nodes
from derive.reduction.integrals import (
    Integrals,
    antisymmetric,
    mass_products,
    mass_times,
    omega_tensors,
    second_moments,
)
from derive.spec.model.body import BodyFrame, NodalBody
from derive.spec.model.node_data import NodeData

ASYMMETRY = 1e-6
"""The largest asymmetry of a geometric stiffness matrix, relative to its largest entry."""


@dataclass(frozen=True, eq=False)
class SecondOrderFields:
    """The moments and the nodal values of the second-order fields Psi_ij that the equations of motion need.

    S (N, N, 3) = int rho Psi_ij; G (N, N, 3, 3) = int rho X (x) Psi_ij; `points`: Psi_ij (N, N, 3) by nodes.
    """

    S: Array
    G: Array
    points: Mapping[int, Array]

    @property
    def axial(self) -> Array:
        """The moments int rho X x Psi_ij, (N, N, 3)."""
        return np.stack([self.G[..., a, b] - self.G[..., b, a] for a, b in ((1, 2), (2, 0), (0, 1))], axis=-1)

    @property
    def inertia(self) -> Array:
        """The tensors P_ij = int rho {(X . Psi_ij) I - sym X Psi_ij}, (N, N, 3, 3)."""
        trace = self.G[..., 0, 0] + self.G[..., 1, 1] + self.G[..., 2, 2]
        return np.asarray(trace[..., None, None] * np.eye(3) - _symmetric(self.G))


def fields_of(data: NodeData, count: int) -> SecondOrderFields:
    """The fields of the first `count` modes from their geometric stiffness matrices; what is not given is zero."""

    def matrices(given: Array | None, number: int) -> Array:
        if given is None:
            return np.zeros((count, count, number))
        kept = given[..., :count, :count]
        return np.ascontiguousarray(np.moveaxis((kept + np.swapaxes(kept, -1, -2)) / 2, -3, -1))

    inertia = omega_tensors(matrices(data.K0omega, 6))
    trace = inertia[..., 0, 0] + inertia[..., 1, 1] + inertia[..., 2, 2]
    symmetric = trace[..., None, None] / 2 * np.eye(3) - inertia
    nodes = () if data.K0F_nodes is None or data.K0F is None else tuple(zip(data.K0F_nodes, data.K0F, strict=True))
    return SecondOrderFields(
        S=matrices(data.K0t, 3),
        G=symmetric + antisymmetric(matrices(data.K0r, 3)),
        points={int(node): -matrices(k0, 3) for node, k0 in nodes},
    )


def in_frame(
    fields: SecondOrderFields, mass: csr_array, raw: ModeShapes, shapes: ModeShapes, frame: BodyFrame
) -> SecondOrderFields:
    """The fields in the body frame. raw, shapes: the modes as given, and the same modes in that frame.

    The origin of the frame moves G; a frame with conditions changes Psi_ij as the description of this module says.
    """
    x, phi = shapes.x, shapes.phi
    offset = raw.x[0] - x[0]
    moments = second_moments(mass, np.concatenate([x[None], phi]))[0]
    c1, *c2 = (pairwise_sum(field) for field in mass_times(mass, np.concatenate([x[None], phi])))
    result = SecondOrderFields(
        fields.S,
        fields.G - offset[:, None] * fields.S[..., None, :],
        {n: psi + 0.0 for n, psi in fields.points.items()},
    )
    if frame.kind == "given":
        return result
    theta = _rotations(x, phi - raw.phi)
    result = SecondOrderFields(
        S=result.S + _of_rotations(theta, np.array(c2), c1),
        G=result.G + np.stack([_of_rotations(theta, moments[1:, a], moments[0, a]) for a in range(3)], axis=-2),
        points={n: psi + _of_rotations(theta, phi[:, n], x[n]) for n, psi in result.points.items()},
    )
    if frame.kind == "mean":
        turned = -_solved(_tensor_of(moments[0]), result.axial)
        moved = -(result.S + np.cross(turned, c1)) / pairwise_sum(mass.data)
    else:
        assert frame.node is not None
        arms = x[list(shapes.around)]
        turns = [np.cross(x[n], result.points[n] - result.points[frame.node]) for n in shapes.around]
        turned = -_solved(inertia_of_points(arms), pairwise_sum(np.array(turns)))
        moved = -result.points[frame.node]
    return SecondOrderFields(
        S=result.S + moved * pairwise_sum(mass.data) + np.cross(turned, c1),
        G=result.G + c1[:, None] * moved[..., None, :] + np.cross(turned[..., None, :], moments[0]),
        points={n: psi + moved + np.cross(turned, x[n]) for n, psi in result.points.items()},
    )


def combined(fields: SecondOrderFields, weights: Array) -> SecondOrderFields:
    """The fields of other modes, sum_i weights_ki Phi_i for each k; weights (N, N)."""

    def both(table: Array) -> Array:
        once = matrix_product(weights, table)
        return np.swapaxes(matrix_product(weights, np.swapaxes(once, 0, 1)), 0, 1)

    return _each_table(fields, both)


def without_rounding(fields: SecondOrderFields) -> SecondOrderFields:
    """The fields made symmetric in the modes to the last bit."""
    return _each_table(fields, lambda table: np.ascontiguousarray((table + np.swapaxes(table, 0, 1)) / 2))


def _each_table(fields: SecondOrderFields, change: Callable[[Array], Array]) -> SecondOrderFields:
    """The fields with each of their tables changed in the same way."""
    return SecondOrderFields(change(fields.S), change(fields.G), {n: change(psi) for n, psi in fields.points.items()})


def with_second_order(integrals: Integrals, fields: SecondOrderFields | None) -> Integrals:
    """The shape integrals with those of the second-order fields, if there are any."""
    if fields is None:
        return integrals
    return replace(integrals, S5=integrals.S5 + fields.inertia, c9=fields.S, c10=fields.axial)


def weights_of(mass: csr_array, phi: Array, of: Array) -> Array:
    """The weights (N, N) with which modes phi (N, nodes, 3) are combinations of independent modes `of`."""
    lower = cholesky(mass_products(mass, of, of))
    if lower is None:
        raise ValueError("modes are dependent")  # check_modes reports them first, with their combination
    inverse = forward_substitution(lower, np.eye(len(of)))
    return matrix_product(matrix_product(mass_products(mass, phi, of), inverse.T), inverse)


def stiffening_faults(body: NodalBody) -> list[Problem]:
    """Faults of geometric stiffness matrices: their shapes, their symmetry, and nodes without K0F that need one."""
    data = body.data
    count = 0 if data.modes is None else len(data.modes)
    forces = 0 if data.K0F_nodes is None else len(data.K0F_nodes)
    expected: dict[str, tuple[int, ...]] = {
        "K0t": (3, count, count),
        "K0r": (3, count, count),
        "K0omega": (6, count, count),
        "K0F": (forces, 3, count, count),
    }
    result = []
    for name, shape in expected.items():
        k0 = getattr(data, name)
        if k0 is None:
            continue
        if k0.shape != shape:
            result.append(Problem("body.nodes", f"{name} of {count} modes is {shape}, not {k0.shape}"))
        elif not np.all(np.isfinite(k0)):
            result.append(Problem("body.nodes", f"{name} contains values that are not finite"))
        elif np.abs(k0 - np.swapaxes(k0, -1, -2)).max(initial=0.0) > ASYMMETRY * np.abs(k0).max(initial=0.0):
            result.append(Problem("body.nodes", f"{name} is not symmetric in the modes"))
    known = set() if data.K0F_nodes is None else {int(node) for node in data.K0F_nodes}
    for path, node in _needed(body):
        if node not in known:
            message = f"K0F of node {node} is missing, and with it the displacement of second order there"
            result.append(Problem(path, f"{message}; add it with the node to K0F and K0F_nodes, or write order = 1"))
    return result


def _needed(body: NodalBody) -> Iterator[tuple[str, int]]:
    """The nodes whose displacements matter: markers, and those that a frame is attached to; each with its key."""
    for marker in body.markers:
        yield f"body.markers.{marker.name}", marker.node
    if body.frame.kind == "point" and body.frame.node is not None:
        around = body.frame.around or nearest_nodes(body.data.positions, body.frame.node)
        yield from (("body.frame", node) for node in (body.frame.node, *around))


def _rotations(x: Array, rigid: Array) -> Array:
    """The rotations theta_i (N, 3) of rigid displacements (N, nodes, 3) of nodes at x, by least squares."""
    arms = x - pairwise_sum(x) / len(x)
    moments = np.array([pairwise_sum(np.cross(arms, field)) for field in rigid]).reshape(len(rigid), 3)
    return _solved(inertia_of_points(arms), moments)


def _of_rotations(theta: Array, shapes: Array, position: Array) -> Array:
    """The terms theta_i x Phi_j + theta_j x Phi_i - 1/2 {theta_i x (theta_j x X) + theta_j x (theta_i x X)}, (N, N, 3).

    theta (N, 3); shapes (N, 3): the values of the modes Phi, or their moments; position (3,): the same of X.
    """
    first, second = theta[:, None], theta[None]
    turned = np.cross(first, shapes[None]) - np.cross(first, np.cross(second, position)) / 2
    return np.asarray(turned + np.swapaxes(turned, 0, 1))


def _solved(tensor: Array, vectors: Array) -> Array:
    """The products of the inverse of a symmetric tensor (3, 3) with vectors (..., 3)."""
    values, axes = eigh(tensor)
    inverse = matrix_product((axes / values[:, None]).T, axes)
    return np.asarray(matrix_product(vectors.reshape(-1, 3), inverse).reshape(vectors.shape))


def _tensor_of(second: Array) -> Array:
    """The tensor of inertia (tr m) I - m of a second moment m (3, 3)."""
    return np.asarray((second[0, 0] + second[1, 1] + second[2, 2]) * np.eye(3) - second)


def _symmetric(tensors: Array) -> Array:
    """The symmetric parts of tensors (..., 3, 3)."""
    return np.asarray((tensors + np.swapaxes(tensors, -1, -2)) / 2)
