"""Elastic modes of a free body from its stiffness and mass matrices.

The stiffness matrix K of a free body is singular, so that the eigenvalue problem is solved for the shifted matrix
K + s M, which is regular even with nodes without mass. The solution includes the rigid motions; they are removed by
projection and not by their frequencies, because rounding errors make these small rather than zero.
"""

from __future__ import annotations

import numpy as np
import scipy.linalg
from scipy.sparse import csr_array, identity, kron, lil_array
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh, splu

from derive.errors import Problem, SpecError
from derive.reduction.arithmetic import Array, inner_products, symmetric_part
from derive.reduction.frames import from_centre_of_mass, projected_out, rigid_basis, rigid_fields
from derive.reduction.integrals import canonical_csr, csr_product, mass_products
from derive.spec.model.body import NodalBody

MAX_DENSE_SIZE = 900
"""The largest number of displacements for which the eigenvalue problem is solved with dense matrices."""

MASSLESS = 1e-9
"""A motion moves no mass if it has less than this part of the kinetic energy by the diagonal of the mass matrix."""

EXTRA_MODES = 4
"""Modes computed in addition to those requested, so that modes of equal frequency are not separated."""


def modal_stiffness(stiffness: csr_array | None, phi: Array) -> Array:
    """The modal stiffness Phi_i^T K Phi_j (N, N); zeros if there is no K, which `check_body` refuses."""
    if stiffness is None:
        return np.zeros((len(phi), len(phi)))
    flat = phi.reshape(len(phi), stiffness.shape[0])
    return symmetric_part(inner_products(flat, csr_product(canonical_csr(stiffness), np.ascontiguousarray(flat.T)).T))


def max_elastic_modes(mass: csr_array, rigid: int, rigid_sets: tuple[tuple[int, ...], ...] = ()) -> int:
    """The number of elastic modes of a body: three for each node with mass, minus the number of rigid motions.

    A rigid set of nodes with mass counts as six, or as five or three if its mass is on a line or in one node.
    """
    heavy = np.diff(canonical_csr(mass).indptr) > 0
    counts = [int(np.count_nonzero(heavy[list(nodes)])) for nodes in rigid_sets]
    lost = sum(3 * count - (0, 3, 5, 6)[min(count, 3)] for count in counts)
    return 3 * int(np.count_nonzero(heavy)) - lost - rigid


def elastic_modes(body: NodalBody, mass: csr_array, x: Array) -> tuple[Array, Array]:
    """The lowest elastic modes (N, nodes, 3) and their stiffness (N, N): up to EXTRA_MODES more than requested.

    Raises SpecError if K is indefinite, if K + s M is singular, or if the Lanczos iteration does not converge.
    """
    assert body.data.stiffness is not None and isinstance(body.modes, int)  # by check_body
    x = from_centre_of_mass(mass, x)
    basis = rigid_basis(mass, x)
    most = max_elastic_modes(mass, len(basis), body.rigid_sets)
    requested = min(body.modes + EXTRA_MODES, most)
    if not requested:
        return np.zeros((0, *x.shape)), np.zeros((0, 0))
    k, m = symmetric_matrix(body.data.stiffness), mass_of_displacements(mass)
    shift = 1e-2 * _lowest_quotient(k, mass, x, basis)
    count = requested + len(basis)
    sets = rigid_set_motions(x, body.rigid_sets) if body.rigid_sets else None
    phi = lowest_modes(k, m, shift, count, most, sets).T.reshape(-1, *x.shape)
    for _ in range(2):
        phi = projected_out(mass, basis, phi)
    values, combinations = np.linalg.eigh(symmetric_part(mass_products(mass, phi, phi)))
    elastic = combinations[:, values > 0.5].T  # after projection rigid motions have c8 = 0, elastic modes 1
    phi = (elastic @ phi.reshape(len(phi), -1)).reshape(-1, *x.shape)
    if len(phi) < body.modes:
        text = f"{body.modes} modes are too many: only {len(phi)} elastic modes move mass, since its matrix is singular"
        raise SpecError((Problem("body.modes", f"{text}; integrate it with more points, or request fewer modes"),))
    return phi, modal_stiffness(k, phi)


def symmetric_matrix(matrix: csr_array) -> csr_array:
    """The symmetric part of a sparse matrix."""
    return csr_array((matrix + matrix.T) / 2)


def mass_of_displacements(mass: csr_array) -> csr_array:
    """The matrix M = m (x) I3 of the displacements of nodes with the mass matrix m."""
    return csr_array(kron(mass, identity(3), format="csr"))


def lowest_modes(k: csr_array, m: csr_array, shift: float, count: int, most: int, motions: csr_array | None) -> Array:
    """The vibration modes (displacements, count) of lowest frequency, by the eigenvectors of K + shift M.

    most: the number of modes that there are. motions (displacements, coordinates): displacements u = T y that
    constraints leave, which have the matrices T^T K T and T^T M T; None if there are no constraints.
    """
    if motions is not None:
        k, m = csr_array(motions.T @ k @ motions), csr_array(motions.T @ m @ motions)
    dense = k.shape[0] <= MAX_DENSE_SIZE or 2 * count >= most
    vectors = (_dense_eigenvectors if dense else _sparse_eigenvectors)(k, m, shift, count)
    return vectors if motions is None else np.asarray(motions @ vectors)


def rigid_set_motions(x: Array, rigid_sets: tuple[tuple[int, ...], ...]) -> csr_array:
    """T (3 nodes, coordinates): displacements of the nodes x whose sets move as rigid bodies, as a rigid RBE2 element.

    The coordinates are the displacements of the other nodes, in their order, and then for each set the displacement of
    its centre and its rotation times its size.
    """
    in_sets = {node for nodes in rigid_sets for node in nodes}
    others = [node for node in range(len(x)) if node not in in_sets]
    result = lil_array((3 * len(x), 3 * len(others) + 6 * len(rigid_sets)))
    for column, node in enumerate(others):
        for k in range(3):
            result[3 * node + k, 3 * column + k] = 1.0
    for column, nodes in enumerate(rigid_sets):
        levers = x[list(nodes)] - x[list(nodes)].mean(axis=0)
        fields = rigid_fields(levers / np.abs(levers).max())
        start = 3 * len(others) + 6 * column
        for field, node in ((field, node) for field in range(6) for node in range(len(nodes))):
            for k in range(3):
                result[3 * nodes[node] + k, start + field] = fields[field, node, k]
    return csr_array(result)


def _lowest_quotient(k: csr_array, mass: csr_array, x: Array, basis: Array) -> float:
    """An estimate of the lowest omega^2 (1/s^2): the least Rayleigh quotient of displacements quadratic in position."""
    pairs = [(a, b) for a in range(3) for b in range(a, 3)]
    axes = np.eye(3)
    fields = np.array([np.multiply.outer(x[:, a] * x[:, b], e) for a, b in pairs for e in axes])
    fields = projected_out(mass, basis, fields)
    norms = np.diag(mass_products(mass, fields, fields))
    fields = fields[norms > 1e-12 * norms.max(initial=0.0)]
    energies = np.diag(modal_stiffness(k, fields))
    quotients = energies / np.diag(mass_products(mass, fields, fields))
    positive = quotients[quotients > 0]
    if positive.size:
        return float(positive.min())
    return float(np.abs(k.diagonal()).sum() / mass.diagonal().sum()) or 1.0


def _dense_eigenvectors(k: csr_array, m: csr_array, shift: float, count: int) -> Array:
    """The eigenvectors (size, count) of the lowest eigenvalues, from (K + shift M)^-1 M with dense matrices.

    There are fewer if the mass matrix is singular.
    """
    full = (k + shift * m).toarray()
    try:
        lower = np.linalg.cholesky(full)
    except np.linalg.LinAlgError:
        values, vectors = np.linalg.eigh(full)
        raise SpecError((_indefinite(float(values[0]), vectors[:, 0], values[-1], k, m),)) from None
    half = scipy.linalg.solve_triangular(lower, m.toarray(), lower=True)
    inverse = scipy.linalg.solve_triangular(lower, half.T, lower=True)
    _, vectors = np.linalg.eigh(symmetric_part(inverse))
    modes = scipy.linalg.solve_triangular(lower, vectors[:, ::-1][:, :count], lower=True, trans="T")
    squares, sizes = np.einsum("ni,ni->i", modes, m @ modes), np.einsum("n,ni->i", m.diagonal(), modes**2)
    moving = squares > MASSLESS * sizes
    return np.asarray(modes[:, moving] / np.sqrt(squares[moving]))


def _sparse_eigenvectors(k: csr_array, m: csr_array, shift: float, count: int) -> Array:
    """The eigenvectors of `_dense_eigenvectors` with sparse matrices, by the Lanczos method.

    A fixed initial vector makes the result reproducible.
    """
    shifted = (k + shift * m).tocsc()
    try:
        factors = splu(shifted, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError:
        raise SpecError((_unconstrained_node(k, m),)) from None
    pivots = factors.U.diagonal()
    if np.array_equal(factors.perm_r, factors.perm_c) and np.any(pivots <= 0):
        message = "the stiffness has a negative eigenvalue: the body is unstable at rest; check its sign and symmetry"
        raise SpecError((Problem("body.nodes", f"{message} ({np.count_nonzero(pivots <= 0)} pivots are negative)"),))
    start = factors.solve(m @ ((np.arange(len(pivots)) * 0.6180339887498949) % 1 - 0.5))
    solve = LinearOperator(k.shape, matvec=factors.solve, dtype=np.float64)
    try:
        _, vectors = eigsh(k, k=count, M=m, sigma=-shift, OPinv=solve, v0=start, which="LM")
    except ArpackNoConvergence as error:
        converged = len(error.eigenvalues)
        message = f"only {converged} of {count} modes (6 of them rigid) were computed from K and M; request fewer modes"
        raise SpecError((Problem("body.modes", message),)) from None
    return np.asarray(vectors)


def _indefinite(value: float, vector: Array, largest: float, k: csr_array, m: csr_array) -> Problem:
    """The fault of an indefinite K + shift M with the lowest eigenvalue `value` and its vector."""
    if value > -1e-12 * float(largest):
        return _unconstrained_node(k, m, int(np.argmax(np.abs(vector))) // 3)
    message = f"the stiffness has a negative eigenvalue ({value:.3g}): check its sign and symmetry"
    return Problem("body.nodes", message)


def _unconstrained_node(k: csr_array, m: csr_array, node: int | None = None) -> Problem:
    """The fault of a singular K + shift M: a node without mass and stiffness."""
    if node is None:
        bare = np.flatnonzero((np.abs(k).sum(axis=1) + np.abs(m).sum(axis=1)) == 0)
        node = int(bare[0]) // 3 if bare.size else None
    which = "some node" if node is None else f"node {node}"
    message = f"{which} has neither mass nor stiffness in some direction; remove it or connect it to its neighbours"
    return Problem("body.nodes", message)
