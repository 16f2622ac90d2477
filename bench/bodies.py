"""Spatial bodies with any number of modes for the benchmarks of scale and of batches, and states for them.

`dense` is a cloud of point masses with random modes, for which no integral vanishes. `beam` bends in a plane and has
orthonormal polynomials as modes: c2, C4, c6 and c7 vanish, and C5_ij, c8, K are diagonal in i and j.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial.legendre import legval
from numpy.typing import NDArray

from derive.mechanics.bodies.modal_body import ModalBody

Array = NDArray[np.float64]


def dense(n: int) -> ModalBody:
    """A cloud of point masses with n random modes, and with positive definite c8 and stiffness."""
    rng = np.random.default_rng(n)
    count = max(20, n)
    masses = rng.uniform(0.5, 1.5, count) / count
    return _body("dense", masses, rng.uniform(-1, 1, (count, 3)), rng.uniform(-1, 1, (n, count, 3)))


def beam(n: int) -> ModalBody:
    """Point masses at Gauss points of a line, so that integrals of polynomials are exact up to rounding errors."""
    x, weights = np.polynomial.legendre.leggauss(n + 4)
    positions, modes = np.zeros((len(x), 3)), np.zeros((n, len(x), 3))
    positions[:, 0] = x
    for i in range(n):
        modes[i, :, 1] = np.sqrt(2 * i + 5) * legval(x, np.eye(i + 3)[i + 2])
    return _body("beam", weights / 2, positions, modes)


def _body(name: str, masses: Array, x: Array, modes: Array) -> ModalBody:
    """A body with the integrals of the appendix as sums over point masses at x (count, 3), modes (n, count, 3)."""
    n = len(modes)
    fields = np.concatenate([x[None], modes])
    moments = np.einsum("k,pka,qkb->pqab", masses, fields, fields, optimize=True)
    moments[np.abs(moments) < 1e-12] = 0.0
    trace = np.trace(moments, axis1=2, axis2=3)
    tensors = trace[..., None, None] * np.eye(3) - moments
    axial = np.stack([moments[..., b, c] - moments[..., c, b] for b, c in ((1, 2), (2, 0), (0, 1))], axis=-1)
    first = np.einsum("k,pka->pa", masses, fields)
    first[np.abs(first) < 1e-12] = 0.0
    c8 = trace[1:, 1:]
    return ModalBody(
        name=f"{name}{n}",
        doc=f"{name} body with {n} modes",
        origin="",
        mass=float(masses.sum()),
        c1=first[0],
        c2=first[1:],
        C3=tensors[0, 0],
        C4=tensors[1:, 0],
        C5=tensors[1:, 1:],
        c6=axial[0, 1:],
        c7=axial[1:, 1:],
        c8=c8,
        stiffness=50 * c8,
        damping=np.zeros((n, n)),
    )


BODIES = {"dense": dense, "beam": beam}


def states(n: int, count: int) -> dict[str, Array]:
    """Random q, v, y = [q; v] and ydot with `count` rows: rotated, slightly deformed, in motion."""
    rng = np.random.default_rng(1000 + n)
    q = rng.uniform(-1, 1, (count, 7 + n))
    q[:, 3:7] /= np.linalg.norm(q[:, 3:7], axis=1, keepdims=True)
    q[:, 7:] *= 0.1 / max(1, n)
    v, rates = rng.uniform(-1, 1, (count, 6 + n)), rng.uniform(-1, 1, (count, 13 + 2 * n))
    return {"q": q, "v": v, "y": np.hstack([q, v]), "ydot": rates}
