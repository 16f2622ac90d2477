"""The part of static responses that modes miss: of free modes the residual flexibility, of attachment modes nothing."""

from __future__ import annotations

import numpy as np
import pytest

import derive
from derive.reduction.body import prepare
from derive.reduction.missed_responses import missed_responses
from derive.spec.model.body import NodalBody
from spring_lattice import lattice

LAST = [16, 17, 18, 19]


def truss(kind: str, modes: int) -> NodalBody:
    """A lattice with an interface at both ends."""
    markers = {"left": {"nodes": [0, 1, 2, 3]}, "right": {"nodes": LAST}}
    interface = {} if kind == "free" else {"interface": ["left", "right"]}
    body = {
        "nodes": lattice(4),
        "units": "SI",
        "modes": modes,
        "component_modes": kind,
        "markers": markers,
        **interface,
    }
    (found,) = derive.spatial_scene("scene", bodies={"truss": body}).bodies
    assert isinstance(found, derive.FlexibleBody)
    return found.body


MARKERS = truss("attachment", 12).interface_markers


def test_attachment_modes_miss_nothing_of_loads_at_their_markers() -> None:
    """They are the responses to these loads, with inertia relief; free modes of the same number miss some."""
    own, free = (missed_responses(truss(kind, 12), MARKERS) for kind in ("attachment", "free"))
    loads = slice(0, 12)
    assert np.abs(own.energy[loads, loads]).max() < 1e-9 * np.abs(free.energy[loads, loads]).max()


@pytest.mark.parametrize("modes", [3, 8])
def test_free_modes_miss_the_residual_flexibility(modes: int) -> None:
    """The energy that they miss of a load is that of all natural modes but theirs, and none of their own inertia."""
    body = truss("free", modes)
    found, every = missed_responses(body, MARKERS), prepare(truss("free", body.data.mass.shape[0] * 3 - 6)).shapes
    force = every.phi[:, LAST].mean(axis=1)[:, 1]  # of a unit force along y at the right marker
    residual = np.sum(force[modes:] ** 2 / np.diag(every.stiffness)[modes:])
    assert found.energy[7, 7] == pytest.approx(residual, rel=1e-6)
    own = slice(12, 12 + modes)
    assert np.abs(found.energy[own, own]).max() < 1e-9 * found.energy[7, 7]


def test_free_modes_miss_the_residual_flexibility_of_a_spin() -> None:
    """The energy that they miss of the centrifugal forces of a spin is that of all natural modes but theirs as well."""
    body, omega = truss("free", 3), np.array([1.0, -2.0, 0.5])
    found, every = missed_responses(body, MARKERS), prepare(truss("free", len(lattice(4)["mass"]) * 3 - 6)).shapes
    centrifugal = -np.cross(omega, np.cross(omega, every.x)) * lattice(4)["mass"][:, None]
    forces = np.einsum("mij,ij->m", every.phi, centrifugal)
    load = found.of_spin(omega)
    missed = load @ found.energy[-len(load) :, -len(load) :] @ load
    assert missed == pytest.approx(np.sum(forces[3:] ** 2 / np.diag(every.stiffness)[3:]), rel=1e-6)


def test_more_modes_miss_less() -> None:
    """The missed energy of every load falls with the number of modes."""
    few, many = (missed_responses(truss("free", modes), MARKERS) for modes in (3, 12))
    assert np.all(np.diag(many.energy)[:12] < np.diag(few.energy)[:12])
