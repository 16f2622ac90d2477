"""Modes that a wanted error selects: the fewest that keep frequencies and deflections, checked with dense matrices."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np
import pytest
from bodies_of_nodes import fitted_rotations
from scipy.linalg import eigh, eigvalsh

import derive
from derive.notes.component_mode_notes import component_mode_notes
from derive.reduction.body import prepare
from derive.reduction.component_mode_table import interface_deflections
from derive.reduction.mode_selection import selected_modes
from derive.spec.model.body import NodalBody
from derive.spec.model.spatial_bodies import FlexibleBody
from spring_lattice import lattice

UP_TO = 2.0
ENDS = {"left": {"nodes": [0, 1, 2, 3]}, "right": {"nodes": [20, 21, 22, 23]}}


@cache
def truss(kind: str, modes: float | int) -> NodalBody:
    """A lattice with an interface at both ends; `modes` is their number or, if it is below 1, their error."""
    wish = {"error": modes, "up_to": UP_TO} if modes < 1 else modes
    body = {"nodes": lattice(5), "units": "SI", "modes": wish, "component_modes": kind, "markers": ENDS}
    body |= {} if kind == "free" else {"interface": ["left", "right"]}
    return of_scene(body)


def of_scene(table: Mapping[str, object]) -> NodalBody:
    """The body of nodes that a table in a scene describes."""
    (body,) = derive.spatial_scene("scene", bodies={"truss": table}).bodies
    assert isinstance(body, FlexibleBody)
    return body.body


def exact(body: NodalBody) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The frequencies (Hz), the deflections at unit loads and the rows of the loads, with dense matrices."""
    assert body.data.stiffness is not None
    k, m, x = body.data.stiffness.toarray(), np.kron(body.data.mass.toarray(), np.eye(3)), body.data.positions
    values, vectors = eigh(k, m)
    rows = []
    for marker in ENDS.values():
        fields = np.eye(x.size).reshape(-1, *x.shape)[:, marker["nodes"]]
        rows.append(fields.mean(axis=1).T)
        rows.append(fitted_rotations(np.full(4, 0.25), x[marker["nodes"]] - x[marker["nodes"]].mean(axis=0), fields).T)
    loads = np.concatenate(rows)
    amplitudes = vectors[:, 6:].T @ loads.T  # modal superposition: the rigid motions are left out
    return np.sqrt(values[6:]) / (2 * np.pi), np.sum(amplitudes**2 / values[6:, None], axis=0), loads


def largest_error(body: NodalBody) -> float:
    """The largest error of the frequencies up to the limit and, with an interface, of the deflections."""
    full, deflections, loads = exact(body)
    assert body.data.stiffness is not None
    phi = prepare(body).raw.phi.reshape(len(prepare(body).raw.phi), -1)
    k, m = body.data.stiffness.toarray(), np.kron(body.data.mass.toarray(), np.eye(3))
    stiffness, c8 = phi @ k @ phi.T, phi @ m @ phi.T
    own = np.sqrt(eigvalsh(stiffness, c8)) / (2 * np.pi)
    count = int((full <= UP_TO).sum())
    errors = [np.inf] if len(own) < count else list(own[:count] / full[:count] - 1)
    if body.interface:
        forces = phi @ loads.T
        errors += list(1 - np.sum(forces * np.linalg.solve(stiffness, forces), axis=0) / deflections)
    return float(np.abs(errors).max())


@pytest.mark.parametrize(("kind", "error"), [("craig_bampton", 0.02), ("attachment", 0.01), ("free", 0.01)])
def test_the_fewest_modes_within_the_error_are_selected(kind: str, error: float) -> None:
    """With the modes that were selected the error is met, with one fewer it is not."""
    body = truss(kind, error)
    count = selected_modes(body).count
    assert derive.modal(body).modes == count
    assert largest_error(truss(kind, count)) <= error < largest_error(truss(kind, count - 1))


def test_deflections_under_unit_loads_are_those_of_the_full_matrices() -> None:
    """The exact ones equal a modal superposition, the others the static response of the modes."""
    body = truss("craig_bampton", 8)
    rows = interface_deflections(body)
    _, deflections, loads = exact(body)
    phi = prepare(body).raw.phi.reshape(8, -1)
    assert body.data.stiffness is not None
    forces = phi @ loads.T
    own = np.sum(forces * np.linalg.solve(phi @ body.data.stiffness.toarray() @ phi.T, forces), axis=0)
    np.testing.assert_allclose([row.full for row in rows], deflections, rtol=1e-9)
    np.testing.assert_allclose([row.own for row in rows], own, rtol=1e-9)
    assert all(0 < row.error < 1 for row in rows)
    assert [row.load for row in rows][3:7:3] == ["moment about e1 at left", "force along e1 at right"]


def test_a_note_says_why_there_are_so_many() -> None:
    """The note names the number, the limit and what one fewer mode would miss."""
    body = truss("attachment", 0.01)
    (line,) = (note for note in component_mode_notes(body) if "represent" in note)
    count = selected_modes(body).count
    assert line.startswith(f"{count} modes (12 static) represent the ")
    assert "up to 2 Hz and the deflections at the interface within 1 %; with one fewer " in line


@pytest.mark.parametrize(
    ("wish", "message"),
    [
        ({"error": 1e-3, "up_to": 1e-3}, "the first natural frequency, 0.87691 Hz, is above up_to"),
        ({"error": 0, "up_to": 10}, "bodies.truss.modes.error"),
        ({"error": 0.1}, "bodies.truss.modes.up_to"),
    ],
)
def test_wishes_that_cannot_be_met_have_a_line(wish: dict[str, float], message: str) -> None:
    """A limit below all frequencies, an error of zero and a missing limit are refused."""
    body = {"nodes": lattice(5), "units": "SI", "modes": wish, "component_modes": "free"}
    with pytest.raises(derive.SpecError) as refused:
        derive.modal(of_scene(body))
    assert message in str(refused.value)
