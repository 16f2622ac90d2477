"""Strains and stresses of displacements of a mesh of solid elements, at points of integration and at nodes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from derive.errors import Problem, SpecError
from derive.solids.element_shapes import Array, ElementShape, element_shape
from derive.spec.model.mesh import Elements, Material, NodeMesh

CHUNK = 20_000
"""Points of integration whose gradients are in memory at a time."""

COMPONENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))
"""The components of a stress, in the order of VTK and of CalculiX: xx, yy, zz, xy, yz, xz."""


@dataclass(frozen=True, eq=False)
class IntegratedMesh:
    """Elements that all have a material, with nodes at x (nodes, 3), m.

    full: whether bricks of 20 nodes have 27 points of integration.
    """

    mesh: NodeMesh
    x: Array
    full: bool = False


@dataclass(frozen=True, eq=False)
class ElementPoints:
    """Some elements of a mesh at their points of integration.

    nodes (E, n). gradients (E, P, n, 3): those of the shape functions in space, 1/m. volumes (E, P), m^3: the weights
    of integrals. lame: the parameters lambda and mu, Pa.
    """

    shape: ElementShape
    nodes: NDArray[np.int64]
    gradients: Array
    volumes: Array
    lame: tuple[float, float]

    def displacement_gradients(self, u: Array) -> Array:
        """The gradients d u_m / d x_k (L, E, P, 3, 3) of displacements u (L, nodes, 3), m."""
        own = u[:, self.nodes]
        return np.asarray(np.einsum("lenm,epnk->lepmk", own, self.gradients, optimize=True))

    def stresses(self, u: Array) -> Array:
        """The stresses (L, E, P, 6), Pa, of displacements u (L, nodes, 3), m, by the law of Hooke."""
        return hooke(self.displacement_gradients(u), self.lame)


def hooke(gradients: Array, lame: tuple[float, float]) -> Array:
    """The stresses (..., 6), Pa, of the symmetric parts of gradients (..., 3, 3), by the law of Hooke."""
    lam, mu = lame
    result = np.stack([mu * (gradients[..., i, j] + gradients[..., j, i]) for i, j in COMPONENTS], axis=-1)
    result[..., :3] += lam * np.trace(gradients, axis1=-2, axis2=-1)[..., None]
    return result


def element_points(solid: IntegratedMesh) -> Iterator[ElementPoints]:
    """Yield the elements of a mesh, some at a time. Raises SpecError for distorted ones."""
    for block in solid.mesh.elements:
        shape, lame = element_shape(block.kind, solid.full), _lame(solid.mesh.materials[block.material])
        step = max(CHUNK // len(shape.points), 1)
        for first in range(0, len(block.nodes), step):
            nodes = block.nodes[first : first + step]
            jacobians = np.einsum("enk,pnj->epkj", solid.x[nodes], shape.gradients, optimize=True)
            sizes = np.linalg.det(jacobians)
            sizes *= np.sign(sizes.sum(axis=1))[:, None]
            if not sizes.min() > 0:
                raise SpecError((_distorted(block, first + int(np.argmin(sizes.min(axis=1)))),))
            gradients = np.einsum("pnj,epjk->epnk", shape.gradients, np.linalg.inv(jacobians), optimize=True)
            yield ElementPoints(shape, nodes, gradients, sizes * shape.weights, lame)


def nodal_stresses(solid: IntegratedMesh, u: Array) -> Array:
    """The stresses (L, nodes, 6), Pa, at nodes, of displacements u (L, nodes, 3), m; zero at nodes without elements.

    Those of an element are extrapolated from its points, and a node has the mean of its elements.
    """
    nodes = len(solid.x)
    totals, counts = np.zeros((nodes, len(u), 6)), np.zeros(nodes)
    for part in element_points(solid):
        at_nodes = np.einsum("np,lepc->enlc", part.shape.extrapolation, part.stresses(u), optimize=True)
        np.add.at(totals, part.nodes, at_nodes)
        np.add.at(counts, part.nodes, 1.0)
    return np.ascontiguousarray(np.moveaxis(totals / np.maximum(counts, 1)[:, None, None], 1, 0))


def strain_energies(solid: IntegratedMesh, u: Array) -> Array:
    """The strain energies (L,), J, of displacements u (L, nodes, 3), m, by the elements."""
    result = np.zeros(len(u))
    for part in element_points(solid):
        gradients = part.displacement_gradients(u)
        doubled = np.stack([gradients[..., i, j] + gradients[..., j, i] for i, j in COMPONENTS], axis=-1)
        doubled[..., :3] /= 2  # a strain, and twice a shear strain
        result += np.einsum("lepc,lepc,ep->l", part.stresses(u), doubled, part.volumes, optimize=True) / 2
    return result


def von_mises(stresses: Array) -> Array:
    """The stress of von Mises (...) of stresses (..., 6)."""
    xx, yy, zz, xy, yz, xz = np.moveaxis(stresses, -1, 0)
    normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.asarray(np.sqrt(normal / 2 + 3 * (xy**2 + yz**2 + xz**2)))


def _lame(material: Material) -> tuple[float, float]:
    """The parameters lambda and mu, Pa, of a material with both numbers."""
    young, poisson = material.young, material.poisson
    assert young is not None and poisson is not None, "a IntegratedMesh has materials"
    return young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))


def _distorted(block: Elements, element: int) -> Problem:
    nodes = ", ".join(map(str, block.nodes[element]))
    text = f"an element {block.kind.value} is distorted, or its nodes are not in the order of VTK: nodes {nodes}"
    return Problem("body.nodes", text)
