"""Elastic modes of a free body from its stiffness and mass matrices.

The stiffness of a free body is singular, so that it is shifted by a little of the mass; nodes without mass do no harm
to that. The rigid motions come out with the elastic modes and are taken away by projection: a frequency that is "not
zero" says nothing, rounding leaves the rigid ones anywhere near it.
"""

from __future__ import annotations

import numpy as np
import scipy.linalg
from scipy.sparse import csr_array, identity, kron
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh, splu

from derive.errors import Problem, SpecError
from derive.reduction.arithmetic import Array, gram, symmetric
from derive.reduction.frames import centred
from derive.reduction.mass import canonical, products, times
from derive.reduction.rigid import rigid_basis, without
from derive.spec.model.body import NodalBody

DENSE = 900
"""Up to so many displacements the eigenvalue problem is solved with full matrices."""

SPARE = 4
"""Modes computed in addition to those requested, so that modes of equal frequency are not separated."""


def modal_stiffness(stiffness: csr_array | None, phi: Array) -> Array:
    """Phi_i^T K Phi_j; zeros without K, which is refused elsewhere."""
    if stiffness is None:
        return np.zeros((len(phi), len(phi)))
    flat = phi.reshape(len(phi), stiffness.shape[0])
    return symmetric(gram(flat, times(canonical(stiffness), np.ascontiguousarray(flat.T)).T))


def most_modes(mass: csr_array, rigid: int) -> int:
    """How many elastic modes a body has: three for each node with mass, less the rigid motions."""
    return 3 * int(np.count_nonzero(np.diff(canonical(mass).indptr))) - rigid


def elastic_modes(body: NodalBody, mass: csr_array, x: Array) -> tuple[Array, Array]:
    """The lowest elastic modes, a few more than requested if there are more, and their stiffness."""
    assert body.data.stiffness is not None and body.modes is not None  # by check_body
    x = centred(mass, x)
    basis = rigid_basis(mass, x)
    size = 3 * len(x)
    most = most_modes(mass, len(basis))
    wanted = min(body.modes + SPARE, most)
    if not wanted:
        return np.zeros((0, *x.shape)), np.zeros((0, 0))
    k = csr_array((body.data.stiffness + body.data.stiffness.T) / 2)
    m = csr_array(kron(mass, identity(3), format="csr"))
    shift = 1e-2 * _scale(k, mass, x, basis)
    count = wanted + len(basis)
    solve = _dense if size <= DENSE or 2 * count >= most else _sparse
    vectors = solve(k, m, shift, count)
    phi = vectors.T.reshape(-1, *x.shape)
    for _ in range(2):
        phi = without(mass, basis, phi)
    values, combinations = np.linalg.eigh(symmetric(products(mass, phi, phi)))
    keep = combinations[:, values > 0.5].T  # rigid motions are left with nothing, elastic ones with 1
    phi = (keep @ phi.reshape(len(phi), -1)).reshape(-1, *x.shape)
    return phi, modal_stiffness(k, phi)


def _scale(k: csr_array, mass: csr_array, x: Array, basis: Array) -> float:
    """A stiffness over mass near that of the lowest elastic mode, from displacements quadratic in the position."""
    pairs = [(a, b) for a in range(3) for b in range(a, 3)]
    axes = np.eye(3)
    fields = np.array([np.multiply.outer(x[:, a] * x[:, b], e) for a, b in pairs for e in axes])
    fields = without(mass, basis, fields)
    norms = np.diag(products(mass, fields, fields))
    fields = fields[norms > 1e-12 * norms.max(initial=0.0)]
    energies = np.diag(modal_stiffness(k, fields))
    quotients = energies / np.diag(products(mass, fields, fields))
    positive = quotients[quotients > 0]
    if positive.size:
        return float(positive.min())
    return float(np.abs(k.diagonal()).sum() / mass.diagonal().sum()) or 1.0


def _dense(k: csr_array, m: csr_array, shift: float, count: int) -> Array:
    """Vectors of the lowest eigenvalues, from (K + shift M)^-1 M with full matrices."""
    full = (k + shift * m).toarray()
    try:
        lower = np.linalg.cholesky(full)
    except np.linalg.LinAlgError:
        values, vectors = np.linalg.eigh(full)
        raise SpecError((_indefinite(float(values[0]), vectors[:, 0], values[-1], k, m),)) from None
    half = scipy.linalg.solve_triangular(lower, m.toarray(), lower=True)
    inverse = scipy.linalg.solve_triangular(lower, half.T, lower=True)
    _, vectors = np.linalg.eigh(symmetric(inverse))
    modes = scipy.linalg.solve_triangular(lower, vectors[:, ::-1][:, :count], lower=True, trans="T")
    return np.asarray(modes / np.sqrt(np.einsum("ni,ni->i", modes, m @ modes)))


def _sparse(k: csr_array, m: csr_array, shift: float, count: int) -> Array:
    """The same with sparse matrices: Lanczos from a start that is always the same."""
    shifted = (k + shift * m).tocsc()
    try:
        factors = splu(shifted, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError:
        raise SpecError((_loose(k, m),)) from None
    pivots = factors.U.diagonal()
    if np.array_equal(factors.perm_r, factors.perm_c) and np.any(pivots <= 0):
        message = (
            "the stiffness has a negative eigenvalue: a body at rest would not stay so; check its sign and symmetry"
        )
        raise SpecError((Problem("body.nodes", f"{message} ({np.count_nonzero(pivots <= 0)} pivots are negative)"),))
    start = factors.solve(m @ ((np.arange(len(pivots)) * 0.6180339887498949) % 1 - 0.5))
    solve = LinearOperator(k.shape, matvec=factors.solve, dtype=np.float64)
    try:
        _, vectors = eigsh(k, k=count, M=m, sigma=-shift, OPinv=solve, v0=start, which="LM")
    except ArpackNoConvergence as error:
        converged = len(error.eigenvalues)
        message = f"only {converged} of {count} modes (6 of them rigid) were found from K and M; ask for fewer modes"
        raise SpecError((Problem("body.modes", message),)) from None
    return np.asarray(vectors)


def _indefinite(value: float, vector: Array, largest: float, k: csr_array, m: csr_array) -> Problem:
    if value > -1e-12 * float(largest):
        return _loose(k, m, int(np.argmax(np.abs(vector))) // 3)
    message = f"the stiffness has a negative eigenvalue ({value:.3g}): check its sign and symmetry"
    return Problem("body.nodes", message)


def _loose(k: csr_array, m: csr_array, node: int | None = None) -> Problem:
    """What is wrong where K + shift M is singular."""
    if node is None:
        bare = np.flatnonzero((np.abs(k).sum(axis=1) + np.abs(m).sum(axis=1)) == 0)
        node = int(bare[0]) // 3 if bare.size else None
    which = "some node" if node is None else f"node {node}"
    message = f"{which} has neither mass nor stiffness in some direction; leave it out or tie it to its neighbours"
    return Problem("body.nodes", message)
