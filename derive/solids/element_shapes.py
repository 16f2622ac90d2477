"""Solid elements: their shape functions, the points at which stresses are computed, and what nodes have of these.

The shape functions of a kind are the polynomials with the monomials of its table that are 1 at one node and 0 at the
others, so that a table of nodes and of exponents is all that a kind needs. Nodes are in the order of VTK.

Stresses at nodes are computed as CalculiX does: a polynomial is fitted to the stresses at the points of integration,
and evaluated at the nodes. What several elements have at a node is averaged.

**Points** are those of the stiffness in CalculiX, with which the stresses of unit loads do the work of the second-order
displacements to rounding. Bricks of 20 nodes have eight (reduced integration, C3D20R), or 27 (full, C3D20), and those
of 27 nodes 64, which integrate products of a stress and two gradients exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np
from numpy.typing import NDArray

from derive.spec.model.mesh import ElementKind

Array = NDArray[np.float64]
Exponents = tuple[tuple[int, ...], ...]

CUBE = ((-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1))
CUBE_EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
CUBE_FACES = ((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7))
TETRAHEDRON = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
TETRAHEDRON_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
TETRAHEDRON_FACES = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))
WEDGE = ((0, 0, -1), (1, 0, -1), (0, 1, -1), (0, 0, 1), (1, 0, 1), (0, 1, 1))
WEDGE_EDGES = ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5))
WEDGE_FACES = ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5))

TRIANGLE_POINTS = ((1 / 6, 1 / 6), (2 / 3, 1 / 6), (1 / 6, 2 / 3))
NEAR, FAR = (5 - 5**0.5) / 20, (5 + 3 * 5**0.5) / 20
"""The coordinates of the four points of a tetrahedron that integrate quadratic functions."""

Rule = tuple[Array, Array]
"""Points (P, 3) in the coordinates of an element, and their weights (P,)."""


@dataclass(frozen=True, eq=False)
class ElementShape:
    """A kind of element in its own coordinates.

    corners: the number of its corners, which are its first nodes. faces: by their corners, with normals that point
    outwards. edges: those with a node in the middle, which follow the corners. nodes (n, 3). points (P, 3), weights
    (P,): the rule of integration. values (P, n), gradients (P, n, 3): of the shape functions at the points.
    extrapolation (n, P): the factors of values at the points in those at the nodes. vtk: the number of its cell type.
    """

    corners: int
    faces: tuple[tuple[int, ...], ...]
    edges: tuple[tuple[int, ...], ...]
    nodes: Array
    points: Array
    weights: Array
    values: Array
    gradients: Array
    extrapolation: Array
    vtk: int


@cache
def element_shape(kind: ElementKind, full: bool = False) -> ElementShape:
    """The tables of a kind of element. full: whether bricks of 20 nodes have 27 points of integration."""
    corners, every_edge, faces = _solid(kind)
    edges = every_edge if kind.node_count > len(corners) else ()
    nodes = np.array([*corners, *_middles(corners, edges)], dtype=np.float64)
    if kind is ElementKind.HEX27:
        nodes = np.concatenate([nodes, [np.mean([CUBE[i] for i in face], axis=0) for face in CUBE_FACES], [[0, 0, 0]]])
    exponents, (points, weights), fit, vtk = _tables(kind, full)
    coefficients = _coefficients(exponents, nodes)
    values = monomials(exponents, points) @ coefficients
    gradients = np.stack([monomials(exponents, points, axis) @ coefficients for axis in range(3)], axis=-1)
    extrapolation = monomials(fit, nodes) @ np.linalg.pinv(monomials(fit, points))
    return ElementShape(len(corners), faces, edges, nodes, points, weights, values, gradients, extrapolation, vtk)


def shape_functions(kind: ElementKind, at: Array, derived: int | None = None) -> Array:
    """The shape functions (P, n) of a kind at points (P, 3), or their derivatives along an axis."""
    exponents = _tables(kind, full=False)[0]
    return np.asarray(monomials(exponents, at, derived) @ _coefficients(exponents, element_shape(kind).nodes))


def _coefficients(exponents: Exponents, nodes: Array) -> Array:
    """The factors (monomials, n) of the monomials in the shape functions."""
    return np.asarray(np.linalg.inv(monomials(exponents, nodes)))


def _solid(kind: ElementKind) -> tuple[tuple[tuple[int, ...], ...], ...]:
    """The corners, the edges and the faces of a kind."""
    match kind:
        case ElementKind.TET4 | ElementKind.TET10:
            return TETRAHEDRON, TETRAHEDRON_EDGES, TETRAHEDRON_FACES
        case ElementKind.WEDGE6 | ElementKind.WEDGE15:
            return WEDGE, WEDGE_EDGES, WEDGE_FACES
        case ElementKind.HEX8 | ElementKind.HEX20 | ElementKind.HEX27:
            return CUBE, CUBE_EDGES, CUBE_FACES


def _tables(kind: ElementKind, full: bool) -> tuple[Exponents, Rule, Exponents, int]:
    """The monomials of the shape functions, the points, the monomials that are fitted to stresses, the cell of VTK."""
    match kind:
        case ElementKind.TET4:
            return _total(1), _centre_of_tetrahedron(), _total(0), 10
        case ElementKind.TET10:
            return _total(2), _four_points(), _total(1), 24
        case ElementKind.HEX8:
            return _each(1), _gauss(2), _each(1), 12
        case ElementKind.HEX20:
            return _serendipity(), _gauss(3 if full else 2), _serendipity() if full else _each(1), 25
        case ElementKind.HEX27:
            return _each(2), _gauss(4), _each(1), 29
        case ElementKind.WEDGE6:
            return _prism(1, 1), _wedge(((1 / 3, 1 / 3),), 2), _prism(0, 1), 13
        case ElementKind.WEDGE15:
            return (
                (*_prism(2, 1), *((a, b, 2) for a, b, _ in _prism(1, 0))),
                _wedge(TRIANGLE_POINTS, 3),
                _prism(1, 1),
                26,
            )


def _total(degree: int) -> Exponents:
    return tuple(e for e in product(range(degree + 1), repeat=3) if sum(e) <= degree)


def _each(degree: int) -> Exponents:
    return tuple(product(range(degree + 1), repeat=3))


def _serendipity() -> Exponents:
    """The monomials of a brick of 20 nodes: at most one exponent is 2."""
    return tuple(e for e in _each(2) if e.count(2) <= 1)


def _prism(degree: int, along: int) -> Exponents:
    return tuple(
        (a, b, c) for a, b, c in product(range(degree + 1), range(degree + 1), range(along + 1)) if a + b <= degree
    )


def monomials(exponents: Exponents, x: Array, derived: int | None = None) -> Array:
    """The monomials at points x (P, 3), or their derivatives along an axis, (P, monomials)."""
    powers = np.array(exponents)
    factors = np.ones(len(powers))
    if derived is not None:
        factors = powers[:, derived].astype(np.float64)
        powers = powers.copy()
        powers[:, derived] = np.maximum(powers[:, derived] - 1, 0)
    return np.asarray(factors * np.prod(x[:, None] ** powers, axis=2))


def _middles(corners: tuple[tuple[int, ...], ...], edges: tuple[tuple[int, ...], ...]) -> list[Array]:
    return [np.mean([corners[i], corners[j]], axis=0) for i, j in edges]


def _gauss(count: int) -> Rule:
    """Gauss points of a cube."""
    at, weights = np.polynomial.legendre.leggauss(count)
    points = np.array(list(product(at, repeat=3)))
    return points, np.array([np.prod(w) for w in product(weights, repeat=3)])


def _wedge(triangle: tuple[tuple[float, float], ...], count: int) -> Rule:
    """Points of a triangle with equal weights, times Gauss points along the wedge."""
    at, weights = np.polynomial.legendre.leggauss(count)
    points = np.array([(*p, z) for p in triangle for z in at])
    return points, np.tile(weights, len(triangle)) / (2 * len(triangle))


def _centre_of_tetrahedron() -> Rule:
    return np.full((1, 3), 1 / 4), np.array([1 / 6])


def _four_points() -> Rule:
    points = np.full((4, 3), NEAR) + (FAR - NEAR) * np.array(TETRAHEDRON)
    return points, np.full(4, 1 / 24)
