"""A cantilever of solid elements beside the beam in space with the same data: mesh, modes, and what theory adds.

The beam lies along e1, is wide along e2 and thin along e3, and has quadratic bricks of 27 nodes, two over its width.
"""

from __future__ import annotations

import sys
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial.legendre import Legendre, leggauss
from scipy.linalg import eigh, null_space
from scipy.sparse import csr_array, kron
from scipy.sparse.linalg import eigsh
from skfem import Basis, BilinearForm, ElementQuad2, LinearForm, MeshQuad, condense
from skfem import solve as solved
from skfem.helpers import dot, grad

import derive
import derive.spec.model.mesh as mesh_data
from clamped_response import clamped_response
from conftest import ROOT
from derive.reduction.body import prepare
from derive.reduction.frame_points import modal_frames
from derive.reduction.frames import rigid_fields
from derive.reduction.mesh_stiffening import geometric_stiffness_tables
from derive.solids.stresses import SolidMesh

sys.path.insert(0, str(ROOT / "scenes"))
import make_solid_beam as solid_beam

LENGTH, WIDTH, THICKNESS = 1.0, 0.06, 0.015
BRICKS = (24, 2, 1)
YOUNG, DENSITY = 70e9, 2700.0
AREA = WIDTH * THICKNESS
MASS = DENSITY * AREA * LENGTH
SOFT, STIFF = YOUNG * WIDTH * THICKNESS**3 / 12, YOUNG * THICKNESS * WIDTH**3 / 12
ABOUT_AXIS = MASS * (WIDTH**2 + THICKNESS**2) / 12
UNIT = float(np.sqrt(SOFT / (MASS * LENGTH**3)))
"""The unit of frequencies in the soft plane, rad/s; in the stiff one it is WIDTH/THICKNESS times as large."""


def shear_modulus(poisson: float) -> float:
    return YOUNG / (2 + 2 * poisson)


@cache
def torsion_constant() -> float:
    """The constant of Saint-Venant of the section with the shape functions of the mesh, by its warping function.

    Two quadratic elements over the width are 5 % stiffer in torsion than the section.
    """
    sides = (np.linspace(-side / 2, side / 2, n + 1) for side, n in zip((WIDTH, THICKNESS), BRICKS[1:], strict=True))
    section = Basis(MeshQuad.init_tensor(*sides), ElementQuad2(), intorder=6)
    stiffness = BilinearForm(lambda u, v, _: dot(grad(u), grad(v))).assemble(section)
    load = LinearForm(lambda v, w: w.x[1] * grad(v)[0] - w.x[0] * grad(v)[1]).assemble(section)
    warping = solved(*condense(stiffness, load, D=np.array([0])))
    return float(WIDTH * THICKNESS * (WIDTH**2 + THICKNESS**2) / 12 - warping @ (stiffness @ warping))


class Mesh(NamedTuple):
    """The solid with its elements and nodes, and the mass matrix of its displacements beside that of its nodes."""

    elements: mesh_data.NodeMesh
    positions: np.ndarray
    node_mass: csr_array
    mass: csr_array
    stiffness: csr_array

    def section(self, x: float) -> list[int]:
        """The nodes of a section."""
        return [int(node) for node in np.flatnonzero(np.abs(self.positions[:, 0] - x) < 1e-9)]

    def weights(self, nodes: list[int]) -> list[float]:
        """Weights of the nodes of a section that integrate over it, by Simpson's rule in each brick."""
        result = np.ones(len(nodes))
        for axis, side, n in ((1, WIDTH, BRICKS[1]), (2, THICKNESS, BRICKS[2])):
            rule = np.ones(2 * n + 1)
            rule[1::2], rule[2:-1:2] = 4, 2
            result *= rule[np.rint((self.positions[nodes, axis] / side + 0.5) * 2 * n).astype(int)]
        return [float(w) for w in result]


@cache
def mesh(poisson: float) -> Mesh:
    beam = solid_beam.beam((LENGTH, WIDTH, THICKNESS), BRICKS, left=0.0, poisson=poisson)
    mass = csr_array(kron(beam.mass, np.eye(3)))
    return Mesh(beam.mesh, beam.positions, beam.mass, mass, beam.stiffness)


class Held(NamedTuple):
    """A body of component modes that is held at the mean motion of its root: frequencies, rad/s, and compliances.

    sway: the displacement of the tip along e2 and e3 for unit forces there, m/N.
    """

    thin: np.ndarray
    wide: np.ndarray
    torsion: np.ndarray
    sway: np.ndarray


@cache
def component_modes(kind: str, modes: int, poisson: float) -> Held:
    """The solid reduced to component modes of both end sections, by the marker frames that joints of a scene use."""
    own = mesh(poisson)
    root, tip = own.section(0.0), own.section(LENGTH)
    data = {"positions": own.positions, "mass": own.node_mass, "stiffness": own.stiffness}
    markers = {
        "root": {"nodes": root, "weights": own.weights(root)},
        "tip": {"nodes": tip, "weights": own.weights(tip)},
    }
    body = {"nodes": data, "units": "SI", "modes": modes, "component_modes": kind, "markers": markers}
    body |= {} if kind == "free" else {"interface": ["root", "tip"]}
    flexible = derive.spatial_scene("solid", bodies={"beam": body}).bodies[0]
    shapes = prepare(flexible.body).shapes
    rigid = rigid_fields(shapes.x)
    root_frame, tip_frame = modal_frames(flexible)

    def displaced(point: np.ndarray) -> np.ndarray:
        return np.array([np.eye(3)[k] if k < 3 else np.cross(np.eye(3)[k - 3], point) for k in range(6)])

    turned = np.vstack([np.zeros((3, 3)), np.eye(3)])
    at_root = np.vstack([displaced(root_frame.point.position), root_frame.point.shapes])
    held = np.hstack([at_root, np.vstack([turned, root_frame.twists])])
    free = null_space(held.T).T
    fields = np.concatenate([rigid, shapes.phi]).reshape(6 + modes, -1)
    elastic = np.zeros((6 + modes,) * 2)
    elastic[6:, 6:] = shapes.stiffness
    k, m = free @ elastic @ free.T, free @ (fields @ (own.mass @ fields.T)) @ free.T
    at_tip = free @ np.vstack([displaced(tip_frame.point.position), tip_frame.point.shapes])
    twist = free @ np.vstack([turned, tip_frame.twists])
    squares, vectors = eigh(k, m)
    size = np.abs(np.hstack([at_tip[:, 1:], WIDTH * twist[:, :1]]).T @ vectors).argmax(axis=0)
    wide, thin, torsion = (np.sqrt(squares[size == k]) for k in range(3))
    sway = np.array([row @ np.linalg.solve(k, row) for row in at_tip.T[1:]])
    return Held(thin, wide, torsion, sway)


@cache
def clamped(modes: int) -> derive.ModalBody:
    """The solid without Poisson's effect, clamped in its root section, with geometric stiffness of its lowest modes."""
    own = mesh(0.0)
    fixed = np.flatnonzero(np.repeat(np.abs(own.positions[:, 0]) < 1e-9, 3))
    moving = np.setdiff1d(np.arange(own.stiffness.shape[0]), fixed)
    k, m = (matrix[moving][:, moving].tocsc() for matrix in (own.stiffness, own.mass))
    squares, vectors = eigsh(k, modes, m, sigma=0, v0=np.ones(len(moving)))
    lowest, shapes = np.argsort(squares), np.zeros((modes, own.stiffness.shape[0]))
    shapes[:, moving] = vectors.T[lowest]
    tip = min(own.section(LENGTH), key=lambda node: float(np.abs(own.positions[node, 1:]).sum()))
    phi, respond = shapes.reshape(modes, -1, 3), clamped_response(own.stiffness, fixed)
    arrays = {
        "positions": own.positions,
        "mass": own.node_mass,
        "modes": phi,
        "modal_stiffness": squares[lowest],
        **geometric_stiffness_tables(SolidMesh(own.elements, own.positions), own.node_mass, phi, [tip], respond),
    }
    keys: dict[str, Any] = {"units": "SI", "frame": "given", "orthonormal": False, "markers": {"tip": tip}}
    return derive.modal(derive.nodal_body("clamped", arrays, **keys))


def polynomials(count: int, clamp: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Points and weights on the unit interval, and x^clamp P_i (count, points) with its derivatives."""
    points, weights = leggauss(40)
    x = (points + 1) / 2
    base = np.array([Legendre.basis(i)(points) for i in range(count)])
    slope = 2 * np.array([Legendre.basis(i).deriv()(points) if i else 0 * points for i in range(count)])
    power, of_power = x**clamp, clamp * x ** (clamp - 1)
    return x, weights / 2, base * power, slope * power + base * of_power


def timoshenko(bending: float, side: float, poisson: float) -> tuple[np.ndarray, float]:
    """Frequencies (rad/s) and tip compliance (m/N) of the cantilever with shear and rotary inertia, by Ritz.

    The coefficient of shear of a rectangle is that of Cowper.
    """
    shear = 10 * (1 + poisson) / (12 + 11 * poisson) * shear_modulus(poisson) * AREA
    _, weights, w, slope = polynomials(14, 1)

    def inner(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return (a * weights) @ b.T

    coupled = -shear * inner(slope, w)
    turned = bending / LENGTH * inner(slope, slope) + shear * LENGTH * inner(w, w)
    stiffness = np.block([[shear / LENGTH * inner(slope, slope), coupled], [coupled.T, turned]])
    mass = np.kron(np.diag([MASS, MASS * side**2 / 12]), inner(w, w))
    return np.sqrt(eigh(stiffness, mass, eigvals_only=True)), LENGTH**3 / (3 * bending) + LENGTH / shear


def lateral_buckling(warping: float) -> float:
    """The load of lateral buckling over sqrt(EI GJ)/l^2 of a cantilever whose root does not warp.

    warping: sqrt(E Gamma/(GJ))/l. The deflection in the plane of the load is left out, as in buckling analyses by
    geometric stiffness.
    """
    x, weights, twist, slope = polynomials(24, 2 if warping else 1)
    second = np.zeros_like(slope)
    if warping:
        for i in range(len(slope)):
            p = Legendre.basis(i)
            second[i] = (
                2 * p(2 * x - 1) + 8 * x * p.deriv()(2 * x - 1) + (4 * x**2 * p.deriv(2)(2 * x - 1) if i > 1 else 0)
            )
    stiffness = (slope * weights) @ slope.T + warping**2 * (second * weights) @ second.T
    load = (twist * weights * (1 - x) ** 2) @ twist.T
    return float(1 / np.sqrt(eigh(load, stiffness, eigvals_only=True)[-1]))
