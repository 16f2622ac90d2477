"""Equilibrium of solid elements at large displacements: Green strains, the law of Hooke, and the method of Newton."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import block_array, coo_array, csr_array, kron
from scipy.sparse.linalg import splu

from derive.solids.stresses import IntegratedMesh, element_points, hooke

PLACES = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
"""Where the components of a symmetric tensor are in a vector of six."""


@dataclass(frozen=True, eq=False)
class Held:
    """Elements that are held by B u = 0, with the mass matrix (nodes, nodes); `rows` is B, (conditions, 3 nodes)."""

    solid: IntegratedMesh
    rows: csr_array
    mass: csr_array

    def displacements(self, forces: np.ndarray, spin: tuple[float, ...] = (0, 0, 0)) -> np.ndarray:
        """The displacements (nodes, 3) under dead forces (nodes, 3), N, in a frame that spins about the origin."""
        x, size = self.solid.x.ravel(), self.solid.x.size
        turn = np.cross(np.eye(3), spin)
        pull = csr_array(kron(self.mass, turn.T @ turn))
        u = np.zeros(size)
        for _ in range(20):
            inner, tangent = self.resistance(u.reshape(-1, 3))
            scale = tangent.diagonal().max()
            matrix = block_array([[tangent - pull, scale * self.rows.T], [scale * self.rows, None]]).tocsc()
            rest = forces.ravel() + pull @ (x + u) - inner
            step, _ = np.split(splu(matrix).solve(np.append(rest, -scale * (self.rows @ u))), [size])
            u += step
            if np.abs(step).max() < 1e-12 * max(np.abs(u).max(), 1e-9):
                return u.reshape(-1, 3)
        raise ArithmeticError("Newton's method does not converge")

    def resistance(self, u: np.ndarray) -> tuple[np.ndarray, csr_array]:
        """The inner forces of displacements u (nodes, 3), and their derivative."""
        force, matrix = np.zeros(u.size), csr_array((u.size, u.size))
        for part in element_points(self.solid):
            count = part.nodes.shape[1]
            (gradients,) = part.displacement_gradients(u[None])
            moved = np.eye(3) + gradients  # F_mk
            strain = (gradients + np.swapaxes(gradients, -1, -2) @ gradients / 2) + 0.0
            stress = hooke(strain, part.lame)[..., PLACES]
            w = part.volumes
            # d E_kl = sym (F_mk grad_l) for the displacement of a node along m
            db = np.einsum("epmk,epnl->epnmkl", moved, part.gradients)
            ds = hooke(db, part.lame)[..., PLACES]
            inner = np.einsum("ep,epkl,epnmkl->enm", w, stress, db, optimize=True)
            k = np.einsum("ep,epnmkl,epajkl->enmaj", w, db, ds, optimize=True)
            geometric = np.einsum("ep,epkl,epnk,epal->ena", w, stress, part.gradients, part.gradients, optimize=True)
            k += np.einsum("ena,mj->enmaj", geometric, np.eye(3))
            places = (3 * part.nodes[:, :, None] + np.arange(3)).reshape(len(k), -1)
            np.add.at(force, places, inner.reshape(len(k), -1))
            rows = np.repeat(places, 3 * count, axis=1).ravel(), np.tile(places, (1, 3 * count)).ravel()
            matrix = matrix + csr_array(coo_array((k.ravel(), rows), shape=matrix.shape))
        return force, csr_array(matrix)


def nodes_held(x: np.ndarray, nodes: list[int], motion: str) -> csr_array:
    """B for a set of nodes that do not move, "rigid", or neither move nor turn in the mean, "mean"."""
    places = (3 * np.array(nodes)[:, None] + np.arange(3)).ravel()
    rows = np.eye(len(places))
    if motion == "mean":
        levers = x[nodes] - x[nodes].mean(axis=0)
        mean = np.tile(np.eye(3), len(nodes))
        rows = np.concatenate([mean, np.concatenate([np.cross(r, np.eye(3)).T for r in levers], axis=1)])
    result = np.zeros((len(rows), x.size))
    result[:, places] = rows
    return csr_array(result)
