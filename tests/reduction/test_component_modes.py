"""Craig-Bampton and attachment modes: against the full matrices of a lattice, and what they are made of."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from bodies_of_nodes import fitted_rotations
from scipy.linalg import eigh, null_space

import derive
from conftest import ROOT
from derive.reduction.body import Prepared, prepare
from derive.reduction.component_mode_table import component_mode_table
from derive.reduction.component_modes import component_modes
from derive.reduction.frames import rigid_fields
from derive.spec.model.body import NodalBody
from spring_lattice import lattice

LEFT, RIGHT = (0, 1, 2, 3), (32, 33, 34, 35)
CRAIG_BAMPTON = "craig_bampton"


@cache
def truss(kind: str, modes: int, rigid: bool = False, bays: int = 8) -> NodalBody:
    """A lattice of some bays with an interface at both ends."""
    last = [*range(4 * bays, 4 * bays + 4)]
    right = {"nodes": last} | ({"motion": "rigid"} if rigid else {})
    markers = {"left": {"nodes": [*LEFT], "weights": [1, 2, 1, 1]}, "right": right}
    body = {"nodes": lattice(bays), "units": "SI", "modes": modes, "component_modes": kind}
    body |= {"markers": markers} | ({} if kind == "free" else {"interface": ["left", "right"]})
    scene = derive.spatial_scene("scene", bodies={"truss": body})
    return scene.bodies[0].body


@cache
def prepared(kind: str, modes: int, rigid: bool = False) -> Prepared:
    return prepare(truss(kind, modes, rigid))


def marker_rows(x: np.ndarray) -> np.ndarray:
    """The displacements and rotations (12, displacements) of both markers, whose fit is one of least squares."""
    rows = []
    for nodes, weights in ((LEFT, [0.2, 0.4, 0.2, 0.2]), (RIGHT, [0.25] * 4)):
        fields = np.eye(x.size).reshape(-1, *x.shape)[:, list(nodes)]
        centre = np.array(weights) @ x[list(nodes)]
        rows.append(np.einsum("a,nak->kn", weights, fields))
        rows.append(fitted_rotations(np.array(weights), x[list(nodes)] - centre, fields).T)
    return np.concatenate(rows)


def full_matrices(body: NodalBody) -> tuple[np.ndarray, np.ndarray]:
    assert body.data.stiffness is not None
    return body.data.stiffness.toarray(), np.kron(body.data.mass.toarray(), np.eye(3))


@pytest.mark.parametrize("kind", ["craig_bampton", "attachment"])
@pytest.mark.parametrize("rigid", [False, True])
def test_static_response_to_loads_at_the_interface_is_exact(kind: str, rigid: bool) -> None:
    """A balanced load at the interface, with the body held at six motions of it, deforms as the full matrices say.

    Craig-Bampton modes carry loads at the interface alone, attachment modes with inertia relief those that rigid
    inertia balances; a self-equilibrated load is both.
    """
    body, modes = truss(kind, 12, rigid), prepared(kind, 12, rigid)
    k, _ = full_matrices(body)
    x = body.data.positions
    rows = marker_rows(x)
    rigid_motion = rigid_fields(x).reshape(6, -1)
    balanced = null_space((rows @ rigid_motion.T).T).T @ rows  # loads at the markers without resultant
    phi = modes.raw.phi.reshape(12, -1)
    own = phi.T @ np.linalg.solve(phi @ k @ phi.T, phi @ balanced.T)
    if rigid:  # the constraint of the rigid set, as a basis of displacements that meet it
        levers = x[list(RIGHT)] - x[list(RIGHT)].mean(axis=0)
        others = np.delete(np.eye(x.size), [3 * n + i for n in RIGHT for i in range(3)], axis=0)
        of_set = np.zeros((6, *x.shape))
        of_set[:, list(RIGHT)] = rigid_fields(levers)
        basis = np.concatenate([others, of_set.reshape(6, -1)])
    else:
        basis = np.eye(x.size)
    full = basis.T @ np.linalg.lstsq(basis @ k @ basis.T, basis @ balanced.T, rcond=1e-10)[0]
    assert balanced @ own == pytest.approx(balanced @ full, rel=1e-8, abs=1e-10 * np.abs(balanced @ full).max())


def test_modes_meet_the_mean_frame_and_are_orthonormal() -> None:
    modes = prepared(CRAIG_BAMPTON, 9)
    _, m = full_matrices(truss(CRAIG_BAMPTON, 9))
    phi = modes.shapes.phi.reshape(9, -1)
    assert phi @ m @ phi.T == pytest.approx(np.eye(9), abs=1e-12)
    assert phi @ m @ rigid_fields(modes.shapes.x).reshape(6, -1).T == pytest.approx(0.0, abs=1e-12)


def test_strain_energy_is_that_of_modes_before_the_projection() -> None:
    """Vibration modes of the held body have its frequencies, from matrices with constraints, after the projection."""
    body = truss(CRAIG_BAMPTON, 9)
    k, m = full_matrices(body)
    vibration = component_modes(body, prepared(CRAIG_BAMPTON, 9).mass, body.data.positions).vibration.reshape(3, -1)
    free = null_space(marker_rows(body.data.positions))
    squares, vectors = eigh(free.T @ k @ free, free.T @ m @ free)
    held = (free @ vectors[:, :3]).T
    energies = np.diag(vibration @ k @ vibration.T) / np.diag(vibration @ m @ vibration.T)
    basis = rigid_fields(body.data.positions).reshape(6, -1)
    moved = held - (held @ m @ basis.T) @ np.linalg.solve(basis @ m @ basis.T, basis)
    assert energies == pytest.approx(squares[:3] / np.diag(moved @ m @ moved.T), rel=1e-8)


def test_all_modes_span_all_displacements() -> None:
    """With as many modes as there are, frequencies are those of the full matrices, whatever the kind."""
    count = 3 * 12 - 6
    k, m = full_matrices(truss(CRAIG_BAMPTON, count, bays=2))
    full = eigh(k, m, eigvals_only=True)[6:]
    assert np.diag(prepare(truss(CRAIG_BAMPTON, count, bays=2)).shapes.stiffness) == pytest.approx(full, rel=1e-8)


def test_the_table_tells_static_modes_from_vibration_and_their_errors() -> None:
    """Free modes beside attachment modes are exact; Craig-Bampton modes are above the full frequencies."""
    k, m = full_matrices(truss("attachment", 15))
    full = np.sqrt(eigh(k, m, eigvals_only=True)[6:]) / (2 * np.pi)
    rows = component_mode_table(truss("attachment", 15))
    assert [row.kind for row in rows].count("vibration") == 3
    assert [row.frequency for row in rows if row.kind == "vibration"] == pytest.approx(full[:3], rel=1e-9)
    rows = component_mode_table(truss(CRAIG_BAMPTON, 9))
    assert [row.full for row in rows] == pytest.approx(full[:9], rel=1e-9)
    assert all(row.frequency >= row.full * (1 - 1e-9) for row in rows)
    assert {row.kind for row in rows} == {"static", "vibration"}
    assert {row.kind for row in component_mode_table(truss(CRAIG_BAMPTON, 6))} == {"static"}


@cache
def rod(kind: str, modes: int) -> NodalBody:
    """The rod of examples/spatial_crank_slider.toml, with an interface at both ends."""
    markers = {"ball": {"nodes": [*range(9)]}, "yoke": {"nodes": [*range(108, 117)]}}
    body = {"nodes": str(ROOT / "examples/spatial_rod.npz"), "units": "SI", "modes": modes, "markers": markers}
    body |= {"component_modes": kind} | ({} if kind == "free" else {"interface": ["ball", "yoke"]})
    return derive.spatial_scene("scene", bodies={"rod": body}).bodies[0].body


def pinned_frequency(body: NodalBody, fields: np.ndarray) -> float:
    """The lowest bending frequency with fields (n, nodes, 3) of the body pinned at its left and guided at its right."""
    k, m = full_matrices(body)
    flat = fields.reshape(len(fields), -1)
    left, right = (fields[:, nodes].mean(axis=1) for nodes in (slice(9), slice(108, 117)))
    free = null_space(np.hstack([left, right[:, 1:]]).T).T @ flat
    return float(np.sqrt(eigh(free @ k @ free.T, free @ m @ free.T, eigvals_only=True)[1]))  # after a rigid rotation


def test_craig_bampton_modes_converge_faster_in_joints_than_free_modes() -> None:
    """Eight modes have a twentieth of the error of eight free modes, and twelve that of eighteen free modes."""
    full = rod(CRAIG_BAMPTON, 8)
    exact = pinned_frequency(full, np.eye(full.data.positions.size).reshape(-1, *full.data.positions.shape))

    def error(kind: str, modes: int) -> float:
        rigid = rigid_fields(full.data.positions)
        return pinned_frequency(full, np.concatenate([rigid, prepare(rod(kind, modes)).raw.phi])) / exact - 1

    assert 0 < error(CRAIG_BAMPTON, 8) < error("free", 8) / 20
    assert 0 < error(CRAIG_BAMPTON, 12) < error("free", 18) / 20
