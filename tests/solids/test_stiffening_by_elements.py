"""Bodies of order 2 whose geometric stiffness comes from their elements: a spinning beam and a compressed plate."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from assembled import assembled
from grid_meshes import box_mesh
from scipy.sparse import csr_array, identity, kron
from scipy.sparse.linalg import eigsh

import derive
from derive.notes.body_notes import body_notes
from derive.reduction.body import prepare
from derive.reduction.frame_points import modal_frames
from derive.reduction.mesh_stiffening import (
    free_response,
    geometric_stiffness_tables,
    integrated_mesh,
    strain_energy_ratios,
)
from derive.solids.stresses import IntegratedMesh
from derive.spec.files.mesh_arrays import mesh_arrays
from derive.spec.model.mesh import ElementKind, Material

SIDES = (1.0, 0.02, 0.01)
SLENDER = Material("slender", 70e9, 0.0, 2700.0)


def beam_arrays(kind: ElementKind, counts: tuple[int, ...], full: bool = False) -> dict[str, Any]:
    """A beam along e1 with its centre in the origin, as a file of nodes with elements."""
    x, mesh = box_mesh(kind, SIDES, counts, material=SLENDER)
    x = x - np.array(SIDES) / 2
    m, k = assembled(IntegratedMesh(mesh, x, full))
    return {"positions": x, "mass": m, "stiffness": k, **mesh_arrays(mesh)}


@pytest.mark.parametrize(
    ("kind", "counts"),
    [(ElementKind.HEX20, (8, 2, 1)), (ElementKind.TET10, (8, 1, 1)), (ElementKind.WEDGE15, (8, 1, 1))],
)
def test_the_tension_of_a_spinning_beam_stiffens_it(kind: ElementKind, counts: tuple[int, ...]) -> None:
    """K0omega is the work of the axial force m l (1/4 - s^2) w^2/2 on the slopes, K0F that of a pull at the ends."""
    arrays = beam_arrays(kind, counts)
    ends = {"left": _middle(arrays["positions"], -0.5), "right": _middle(arrays["positions"], 0.5)}
    keys = {"units": "SI", "modes": 4, "markers": ends}
    one, two = (derive.modal(derive.nodal_body("beam", arrays, order=n, **keys)) for n in (1, 2))
    spun = -(two.C5 - one.C5)
    shapes = prepare(derive.nodal_body("beam", arrays, **keys)).shapes
    along, section = np.unique(np.round(shapes.x[:, 0], 9), return_inverse=True)
    means = np.array([[np.bincount(section, w) / np.bincount(section) for w in f[:, 1:].T] for f in shapes.phi])
    s, weights = np.polynomial.legendre.leggauss(12)
    s, weights = s / 2, weights / 2
    slopes = np.array([_slopes(along, deflections, s) for deflections in means])
    mass = 2700 * np.prod(SIDES)
    tension = mass * (1 / 4 - s**2) / 2
    expected = np.einsum("p,iap,jap->ij", weights * tension, slopes, slopes)
    for axis in (1, 2):
        assert spun[..., axis, axis] == pytest.approx(expected, abs=6e-3 * np.abs(expected).max()), axis
    shortening = two.points[1].second[..., 0] - two.points[0].second[..., 0]
    expected = -np.einsum("p,iap,jap->ij", weights, slopes, slopes)
    assert shortening == pytest.approx(expected, abs=6e-3 * np.abs(expected).max())
    assert not two.c9.any() and not two.c10.any()


def _slopes(x: np.ndarray, deflections: np.ndarray, at: np.ndarray) -> list[np.ndarray]:
    """The slopes of deflections at x, by polynomials."""
    return [np.polyval(np.polyder(np.polyfit(x, w, 8)), at) for w in deflections]


def _middle(x: np.ndarray, along: float) -> int:
    """The node in the middle of an end, or the nearest one."""
    return int(np.linalg.norm(x - np.array([along, 0, 0]), axis=1).argmin())


@pytest.mark.parametrize("full", [False, True])
def test_the_points_of_integration_are_those_of_the_stiffness(full: bool) -> None:
    arrays = beam_arrays(ElementKind.HEX20, (3, 2, 1), full)
    body = derive.nodal_body("beam", arrays, units="SI", modes=3)
    solid = integrated_mesh(body.data.mesh, prepare(body).shapes)
    assert solid.full == full
    assert strain_energy_ratios(solid, prepare(body).shapes) == pytest.approx(1, rel=1e-6)


def test_a_stiffness_of_other_elements_is_noted() -> None:
    """A wrong unit of Young's modulus, such as kPa for Pa."""
    arrays = beam_arrays(ElementKind.TET10, (3, 1, 1))
    keys = {"units": "SI", "modes": 3, "stress": True}
    assert not any("strain energy" in note for note in body_notes(derive.nodal_body("beam", arrays, **keys)))
    arrays["materials"] = arrays["materials"] * np.array([1e-3, 1, 1])
    notes = body_notes(derive.nodal_body("beam", arrays, **keys))
    assert any("has 0.001 times the strain energy by its elements" in note for note in notes)


def test_a_compressed_plate_buckles() -> None:
    """A square plate that is simply supported: N = 4 pi^2 D/a^2. The load is that of a uniform stress, K u."""
    a, h, poisson = 1.0, 0.02, 0.3
    x, mesh = box_mesh(ElementKind.HEX20, (a, a, h), (8, 8, 1))
    solid = IntegratedMesh(mesh, x)
    m, k = assembled(solid)
    edges = np.array([(np.abs(x[:, i]) < 1e-9) | (np.abs(x[:, i] - a) < 1e-9) for i in range(2)])
    middle = np.flatnonzero(edges.any(axis=0) & (np.abs(x[:, 2] - h / 2) < 1e-9))
    along = [3 * np.flatnonzero(edges[i]) + 1 - i for i in range(2)]  # edges do not move along themselves
    moving = np.setdiff1d(np.arange(x.size), np.concatenate([3 * middle + 2, *along]))
    held, full = k[moving][:, moving].tocsc(), csr_array(kron(m, identity(3)))[moving][:, moving].tocsc()
    squares, vectors = eigsh(held, 1, full, sigma=0, v0=np.ones(len(moving)))
    phi = np.zeros((1, x.size))
    phi[:, moving] = vectors.T
    unit = np.stack([-x[:, 0], poisson * x[:, 1], poisson * x[:, 2]], axis=1) / (210e9 * h)  # 1 N/m along e1
    nodes = np.flatnonzero(np.any((np.abs(x) < 1e-9) | (np.abs(x - [a, a, h]) < 1e-9), axis=1))
    k0 = geometric_stiffness_tables(solid, m, phi.reshape(1, *x.shape), nodes.tolist(), free_response(x, m, k))["K0F"]
    forces = (k @ unit.ravel()).reshape(-1, 3)
    assert np.abs(np.delete(forces, nodes, axis=0)).max() < 1e-9 * np.abs(forces).max()
    work = float(np.einsum("ak,ak->", forces[nodes], k0[:, :, 0, 0]))
    bending = 210e9 * h**3 / 12 / (1 - poisson**2)
    assert -squares[0] / work == pytest.approx(4 * np.pi**2 * bending / a**2, rel=0.01)


def test_craig_bampton_modes_have_geometric_stiffness() -> None:
    """The ends of a hinged beam approach each other by half the integral of its squared slope, whatever the modes."""
    arrays = beam_arrays(ElementKind.HEX20, (6, 2, 1))
    x = arrays["positions"]
    ends = {"left": np.abs(x[:, 0] + 0.5) < 1e-9, "right": np.abs(x[:, 0] - 0.5) < 1e-9}
    sets = {name: {"nodes": np.flatnonzero(own).tolist(), "motion": "rigid"} for name, own in ends.items()}
    body = {"nodes": arrays, "units": "SI", "modes": 8, "interface": ["left", "right"], "order": 2, "markers": sets}
    flexible = derive.spatial_scene("bar", bodies={"beam": body}).bodies[0]
    shapes = prepare(flexible.body).shapes
    line = np.flatnonzero((np.abs(x[:, 1]) < 1e-9) & (np.abs(x[:, 2] - 0.005) < 1e-9))
    line = line[np.argsort(x[line, 0])]
    left, right = (frame.point for frame in modal_frames(flexible))
    for i in range(2):
        slope = np.polyder(np.polyfit(x[line, 0], shapes.phi[i, line, 2], 8))
        squared = np.polyint(np.polymul(slope, slope))
        wide = np.polyder(np.polyfit(x[line, 0], shapes.phi[i, line, 1], 8))
        other = np.polyint(np.polymul(wide, wide))
        expected = sum(np.polyval(of, 0.5) - np.polyval(of, -0.5) for of in (squared, other))
        found = right.second[i, i, 0] - left.second[i, i, 0]
        assert found == pytest.approx(-expected, rel=5e-3), i


def test_tables_of_the_file_come_before_computed_ones() -> None:
    arrays = beam_arrays(ElementKind.HEX8, (3, 1, 1))
    computed = derive.nodal_body("beam", arrays, units="SI", modes=2)
    raw = prepare(computed).raw
    solid = IntegratedMesh(computed.data.mesh, raw.x)
    tables = geometric_stiffness_tables(
        solid, computed.data.mass, raw.phi, [3], free_response(raw.x, computed.data.mass, computed.data.stiffness)
    )
    given = {"modes": raw.phi, "modal_stiffness": raw.stiffness, "K0omega": 2 * tables["K0omega"]}
    twice = derive.nodal_body("beam", arrays | given, units="SI")
    once = derive.nodal_body("beam", arrays | {"modes": raw.phi, "modal_stiffness": raw.stiffness}, units="SI", order=2)
    flat = derive.nodal_body("beam", arrays | {"modes": raw.phi, "modal_stiffness": raw.stiffness}, units="SI")
    assert twice.second_order and not twice.computes_geometric_stiffness
    assert once.computes_geometric_stiffness and not flat.second_order
    base = derive.modal(flat).C5
    assert derive.modal(twice).C5 - base == pytest.approx(2 * (derive.modal(once).C5 - base), abs=1e-9)
