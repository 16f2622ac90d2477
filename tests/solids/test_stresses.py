"""Stresses of displacements: constant and linear ones are exact, in crooked meshes of elements of each kind."""

from __future__ import annotations

import numpy as np
import pytest
from grid_meshes import STEEL, box_mesh

from derive.errors import SpecError
from derive.solids.stresses import IntegratedMesh, nodal_stresses, strain_energies, von_mises
from derive.spec.model.mesh import ElementKind

YOUNG, POISSON = 210e9, 0.3
QUADRATIC = (ElementKind.TET10, ElementKind.HEX20, ElementKind.HEX27, ElementKind.WEDGE15)


def hooke(strain: np.ndarray) -> np.ndarray:
    """The stresses (..., 6) of strains (3, 3), by the compliance of the textbooks."""
    stress = YOUNG / (1 + POISSON) * (strain + POISSON / (1 - 2 * POISSON) * np.trace(strain) * np.eye(3))
    return np.array([stress[0, 0], stress[1, 1], stress[2, 2], stress[0, 1], stress[1, 2], stress[0, 2]])


@pytest.mark.parametrize("full", [False, True])
@pytest.mark.parametrize("kind", ElementKind)
def test_a_constant_strain_has_its_stress_everywhere(kind: ElementKind, full: bool) -> None:
    gradient = 1e-4 * np.array([[1.0, 2.0, -3.0], [0.5, -1.0, 4.0], [2.0, -2.5, 3.0]])
    x, mesh = box_mesh(kind, (1.0, 0.4, 0.3), (3, 2, 2), crooked=0.2)
    solid, u = IntegratedMesh(mesh, x, full), (x @ gradient.T)[None]
    strain = (gradient + gradient.T) / 2
    expected = hooke(strain)
    assert np.allclose(nodal_stresses(solid, u)[0], expected, atol=1e-9 * np.abs(expected).max())
    doubled = expected @ np.array([*np.diag(strain), 2 * strain[0, 1], 2 * strain[1, 2], 2 * strain[0, 2]])
    assert strain_energies(solid, u)[0] == pytest.approx(doubled / 2 * 0.12, rel=1e-12)


@pytest.mark.parametrize("full", [False, True])
@pytest.mark.parametrize("kind", QUADRATIC)
def test_pure_bending_has_a_linear_stress(kind: ElementKind, full: bool) -> None:
    """Quadratic elements contain the displacement of Saint-Venant, and the stress z E/R is extrapolated exactly."""
    radius = 500.0
    x, mesh = box_mesh(kind, (1.0, 0.2, 0.1), (4, 2, 2))
    a, b, c = x.T
    u = np.stack([a * c, -POISSON * b * c, -(a**2) / 2 + POISSON / 2 * (b**2 - c**2)], axis=1) / radius
    stresses = nodal_stresses(IntegratedMesh(mesh, x, full), u[None])[0]
    expected = np.zeros((len(x), 6))
    expected[:, 0] = YOUNG * c / radius
    assert np.allclose(stresses, expected, atol=1e-9 * expected.max())


def test_the_stress_of_von_mises() -> None:
    """Of tension sigma, of shear sqrt(3) tau, and zero of pressure."""
    states = np.array([[7.0, 0, 0, 0, 0, 0], [0, 0, 0, 2, 0, 0], [5, 5, 5, 0, 0, 0]])
    assert von_mises(states) == pytest.approx([7, 2 * 3**0.5, 0])


def test_an_element_that_is_turned_inside_out_is_named() -> None:
    x, mesh = box_mesh(ElementKind.HEX8, (1.0, 1.0, 1.0), (1, 1, 1), material=STEEL)
    mesh.elements[0].nodes[0, [0, 1]] = mesh.elements[0].nodes[0, [1, 0]]
    with pytest.raises(SpecError, match="hex8 is distorted, or its nodes are not in the order of VTK: nodes 4, 0"):
        nodal_stresses(IntegratedMesh(mesh, x), x[None])
