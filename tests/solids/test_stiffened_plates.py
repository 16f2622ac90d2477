"""Plates that are stiffened by stresses in their plane: a spinning disc, and a free plate that is pulled."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from assembled import assembled
from grid_meshes import STEEL, box_mesh
from scipy.linalg import eigh

import derive
from derive.mechanics.bodies.modal_body import ModalBody
from derive.solids.stresses import IntegratedMesh
from derive.spec.files.mesh_arrays import mesh_arrays
from derive.spec.model.mesh import ElementKind

THICKNESS, RADIUS = 0.01, 1.0
BENDING = STEEL.young * THICKNESS**3 / 12 / (1 - STEEL.poisson**2)
PER_AREA = STEEL.density * THICKNESS


@cache
def disc() -> ModalBody:
    """A free disc of radius 1 m, whose elements are those of a square: circles are images of squares."""
    x, mesh = box_mesh(ElementKind.HEX20, (2, 2, THICKNESS), (8, 8, 1))
    u, v = (x[:, :2] - 1).T
    x[:, 0], x[:, 1] = u * np.sqrt(1 - v**2 / 2), v * np.sqrt(1 - u**2 / 2)
    m, k = assembled(IntegratedMesh(mesh, x))
    arrays = {"positions": x, "mass": m, "stiffness": k, **mesh_arrays(mesh)}
    return derive.modal(derive.nodal_body("disc", arrays, units="SI", modes=14, order=2))


@pytest.mark.parametrize("squared", [1.0, 10.0])
def test_a_spinning_disc(squared: float) -> None:
    """Its frequencies with 2 and 3 nodal diameters and with a nodal circle, between bounds for n diameters, s circles.

    H. Lamb and R. V. Southwell (Proc. R. Soc. A 99, 1921, 272): a disc without bending stiffness at the spin W has the
    frequencies omega^2 = W^2 {(n + 2 s)(n + 2 s + 2)(3 + nu) - n^2 (1 + 3 nu)}/8, with shapes r^n cos n phi if s = 0.
    Their sum with the squares at rest (A. W. Leissa, Vibration of plates, 1969: 5.358, 12.439 and 9.003) is a lower
    bound, and Rayleigh's quotient of r^n cos n phi an upper one. W^2 is `squared` times the first square at rest.
    """
    body, unit, nu = disc(), BENDING / PER_AREA / RADIUS**4, STEEL.poisson
    spin = squared * 5.358**2 * unit
    found = eigh(body.stiffness - spin * body.C5[..., 2, 2], body.c8, eigvals_only=True)
    for n, s, at_rest, modes in ((2, 0, 5.358, (0, 1)), (0, 1, 9.003, (2,)), (3, 0, 12.439, (3, 4))):
        membrane = spin * ((n + 2 * s) * (n + 2 * s + 2) * (3 + nu) - n**2 * (1 + 3 * nu)) / 8
        rayleigh = 4 * n**2 * (n**2 - 1) * (1 - nu) * unit + membrane if n else 1.03 * (at_rest**2 * unit + membrane)
        for squares in found[list(modes)]:
            assert 0.999 * (at_rest**2 * unit + membrane) < squares < rayleigh, (n, s)


SIDE, PULL = 1.0, 6e4  # m, N/m


def pulled_plate(pull: float) -> np.ndarray:
    """The first six frequencies of a free square plate in a scene, pulled at two edges, Hz."""
    x, mesh = box_mesh(ElementKind.HEX20, (SIDE, SIDE, THICKNESS), (6, 6, 1))
    x = x - np.array([SIDE, SIDE, THICKNESS]) / 2
    m, k = assembled(IntegratedMesh(mesh, x))
    arrays = {"positions": x, "mass": m, "stiffness": k, **mesh_arrays(mesh)}
    strain = np.array([1, -STEEL.poisson, -STEEL.poisson]) / (STEEL.young * THICKNESS)  # by 1 N/m along e1
    forces = (k @ (x * strain).ravel()).reshape(-1, 3)
    loaded = np.flatnonzero(np.abs(forces[:, 0]) > 1e-9)
    assert np.allclose(np.abs(x[loaded, 0]), SIDE / 2)
    edges = {"nodes": loaded.tolist(), "forces": [[pull * f, 0, 0] for f in forces[loaded, 0].tolist()]}
    plate = {"nodes": arrays, "units": "SI", "modes": 5, "order": 2, "loads": {"edges": edges}}
    scene = derive.spatial_scene("pulled", bodies={"plate": plate})
    return np.sort(derive.modes(scene, at=0).frequencies)[-6:]


def ritz(pull: float) -> np.ndarray:
    """The first six frequencies of the thin plate, Hz, with products of Legendre polynomials in both directions."""
    s, weights = np.polynomial.legendre.leggauss(12)
    polynomials = [np.polynomial.Legendre.basis(n) for n in range(9)]
    at = np.array([[f.deriv(d)(s) * (2 / SIDE) ** d for f in polynomials] for d in range(3)])
    one = np.einsum("aip,bjp,p->abij", at, at, weights * SIDE / 2)
    both = np.einsum("acij,bdkl->abcdikjl", one, one).reshape(3, 3, 3, 3, 81, 81)  # derivatives along x, y; of each
    nu = STEEL.poisson
    stiffness = both[2, 0, 2, 0] + both[0, 2, 0, 2] + nu * (both[2, 0, 0, 2] + both[0, 2, 2, 0])
    stiffness = BENDING * (stiffness + 2 * (1 - nu) * both[1, 1, 1, 1]) + pull * both[1, 0, 1, 0]
    squares = eigh(stiffness, PER_AREA * both[0, 0, 0, 0], eigvals_only=True)
    moving = squares[squares > 1e-6 * squares[10]]
    return np.sqrt(moving[:6]) / (2 * np.pi)


@pytest.mark.long
def test_a_pulled_plate() -> None:
    """Forces of fixed direction at two edges turn the plate back as well, which is its slowest motion."""
    loose, pulled = ritz(0), ritz(PULL)
    # A. W. Leissa, J. Sound Vib. 31 (1973) 257: upper bounds
    published = np.array([13.489, 19.789, 24.432]) * np.sqrt(BENDING / PER_AREA) / (2 * np.pi)
    assert np.all(loose[:3] < published) and loose[:3] == pytest.approx(published, rel=0.011)
    assert pulled_plate(PULL) == pytest.approx(pulled, rel=8e-3)
