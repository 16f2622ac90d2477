"""Zeros by mirror symmetry: the sums behind them are nothing, and what is not symmetric has none."""

from __future__ import annotations

from dataclasses import replace

import bodies_of_nodes as bodies
import numpy as np
import pytest
from scipy.sparse import csr_array

from derive.reduction import reduce
from derive.reduction.body import prepare
from derive.reduction.frames import ModeShapes
from derive.reduction.integrals import shape_integrals
from derive.reduction.reasons import integral_entries
from derive.reduction.symmetry import made_symmetric, mirror_planes, separated_by_parity
from derive.spec.model.body import BodyFrame, NodalBody

MIRROR = "mirror symmetry in the plane normal to e"


def sums_behind(body: NodalBody) -> dict[str, float]:
    """Each integral that is zero by symmetry, as the sum that it is, relative to the size of its factors."""
    prepared = prepare(body)
    known = shape_integrals(prepared.mass, prepared.shapes.x, prepared.shapes.phi)
    x, phi = np.abs(prepared.shapes.x).max(), np.abs(prepared.shapes.phi).max(initial=0.0)
    size = {"c1": x, "c2": phi, "C3": x * x, "S4": x * phi, "S5": phi * phi, "c6": x * phi, "c7": phi * phi}
    zeros = {name for name, reason in reduce(body).zeros.items() if reason.startswith(MIRROR)}
    return {
        entry.name: float(getattr(known, entry.table)[entry.index]) / (known.mass * size[entry.table])
        for entry in integral_entries(len(phi_of(body)))
        if entry.name in zeros and entry.table in size
    }


def phi_of(body: NodalBody) -> np.ndarray:
    return prepare(body).shapes.phi


@pytest.mark.parametrize(
    "body",
    [
        bodies.nodal(bodies.truss(), modes=6),
        bodies.nodal(bodies.truss((4, 3, 3), (1, 0.5, 0.5)), modes=8),
        bodies.nodal(bodies.truss((3, 3, 3), (1, 1, 1)), modes=9),
        bodies.nodal(bodies.truss((3, 3, 3)), BodyFrame("point", 13), modes=6),
        bodies.nodal(bodies.truss((3, 3, 2)), BodyFrame("point", 8, (9, 10, 6, 14)), modes=4, orthonormal=False),
    ],
)
def test_sums_behind_the_zeros_are_nothing(body: NodalBody) -> None:
    found = sums_behind(body)
    assert len(found) > 50 and max(map(abs, found.values())) < 1e-15


def test_all_odd_sums_are_found() -> None:
    """Every integral that vanishes up to rounding in a body with three planes has a reason."""
    body = bodies.nodal(bodies.truss((4, 3, 2)), modes=6)
    prepared, found = prepare(body), reduce(body)
    known = shape_integrals(prepared.mass, prepared.shapes.x, prepared.shapes.phi)
    for entry in integral_entries(6):
        if entry.table not in ("stiffness", "damping") and abs(getattr(known, entry.table)[entry.index]) < 1e-13:
            assert entry.name in found.zeros, entry.name
    assert found.zeros["C3_12"] == MIRROR + "1" and found.zeros["C3_23"] == MIRROR + "2"


def test_modes_are_exactly_symmetric() -> None:
    prepared = prepare(bodies.nodal(bodies.truss((5, 3, 2)), modes=6))
    phi, parities = prepared.shapes.phi, prepared.parities
    x = prepared.shapes.x
    assert parities.axes == (0, 1, 2) and np.all(np.abs(parities.fields) == 1)
    for plane, axis in enumerate(parities.axes):
        flip = np.where(np.arange(3) == axis, -1.0, 1.0)
        partner = [int(np.argmin(np.abs(x * flip - row).sum(axis=1))) for row in x]
        for i, mode in enumerate(phi):
            assert np.array_equal(mode[partner] * flip, parities.fields[i + 1, plane] * mode)


def test_modes_of_equal_frequency_are_told_apart() -> None:
    """A bar with a square section: any mix of its two first bending modes is a mode as well."""
    body = bodies.nodal(bodies.truss((5, 3, 3), (1, 0.4, 0.4)), modes=5)
    prepared = prepare(body)
    values = np.diag(prepared.shapes.stiffness)
    pairs = [i for i in range(4) if np.isclose(values[i], values[i + 1], rtol=1e-9)]
    assert pairs and np.all(np.abs(prepared.parities.fields) == 1)
    turned = prepared.shapes.phi.copy()
    i = pairs[0]
    turned[i], turned[i + 1] = 0.6 * turned[i] + 0.8 * turned[i + 1], 0.8 * turned[i] - 0.6 * turned[i + 1]
    data = replace(body.data, modes=turned, modal_stiffness=prepared.shapes.stiffness)
    assert reduce(bodies.nodal(data)).zeros == reduce(body).zeros
    as_given = prepare(bodies.nodal(data, bodies.GIVEN, orthonormal=False)).parities.fields
    assert {int(v) for v in np.abs(as_given[i + 1 : i + 3]).ravel()} == {0, 1}


def test_a_mode_without_parity_loses_its_zeros_and_no_others() -> None:
    body = bodies.nodal(bodies.truss(), modes=4)
    phi = prepare(body).shapes.phi.copy()
    stiffness = prepare(body).shapes.stiffness
    data = replace(body.data, modes=phi, modal_stiffness=stiffness, stiffness=None)
    before = reduce(bodies.nodal(data, bodies.GIVEN, orthonormal=False)).zeros
    phi[1, 0] *= 1 + 1e-4
    after = reduce(bodies.nodal(replace(data, modes=phi), bodies.GIVEN, orthonormal=False)).zeros
    gone = {name for name, reason in before.items() if reason.startswith(MIRROR)} - set(after)
    assert gone == {name for name in gone if "2" in name.split("_")[1:3]}
    assert "C5_1_3_11" in before and all(
        name in after for name in before if name.startswith(("c2_1", "C5_1_3", "c7_3_4"))
    )
    assert not any(after.get(f"c7_1_2_{k}", "").startswith(MIRROR) for k in (1, 2, 3))


def test_what_is_not_symmetric_has_no_zeros() -> None:
    data = bodies.truss()
    masses = data.mass.diagonal()
    masses[0] *= 1 + 1e-5
    heavier = replace(data, mass=csr_array(np.diag(masses)))
    moved = data.positions.copy()
    moved[0, 0] += 1e-5
    tilted = data.positions @ np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    for other in (heavier, replace(data, positions=moved, **bodies.springs(moved, (4, 3, 2)))):
        assert not any(reason.startswith(MIRROR) for reason in reduce(bodies.nodal(other, modes=4)).zeros.values())
    turned = replace(data, positions=tilted, **bodies.springs(tilted, (4, 3, 2)))
    assert not any(reason.startswith(MIRROR) for reason in reduce(bodies.nodal(turned, modes=4)).zeros.values())


def test_planes() -> None:
    data = bodies.truss((4, 3, 2))
    assert [plane.axis for plane in mirror_planes(data.mass, data.positions + np.array([3, -4, 5]))] == [0, 1, 2]
    moved, masses = data.positions.copy(), data.mass.diagonal()
    moved[0, 0] += 1e-6
    masses[[0, -1]] += 1e-6
    assert mirror_planes(data.mass, moved) == ()
    assert mirror_planes(csr_array(np.diag(masses)), data.positions) == ()
    masses = data.mass.diagonal()
    masses[data.positions[:, 2] > 0] += 1e-6
    assert [plane.axis for plane in mirror_planes(csr_array(np.diag(masses)), data.positions)] == [0, 1]
    twice = np.concatenate([data.positions, data.positions[:1]])
    assert mirror_planes(csr_array(np.eye(25)), twice) == ()


def test_a_frame_beside_the_plane_has_fewer_zeros() -> None:
    """X has no parity there; what holds modes alone still has."""
    body = bodies.nodal(bodies.truss((3, 3, 2)), bodies.GIVEN, modes=4, orthonormal=False)
    shifted = replace(body, data=replace(body.data, positions=body.data.positions + 1.0))
    middle, beside = (
        {name for name, reason in reduce(b).zeros.items() if reason.startswith(MIRROR)} for b in (body, shifted)
    )
    assert {"C3_12", "c1_1"} <= middle and not any(name.startswith(("C3", "C4", "c1", "c6")) for name in beside)
    modes_alone = {name for name in middle if name.startswith(("C5", "c7", "c2", "c8", "K"))}
    assert beside == modes_alone


def test_stiffness_that_is_not_symmetric_keeps_its_couplings() -> None:
    body = bodies.nodal(bodies.truss(), modes=4)
    shapes = prepare(body).shapes
    full = shapes.stiffness + 0.1 * np.sqrt(np.outer(*[np.diag(shapes.stiffness)] * 2)) * (1 - np.eye(4))
    data = replace(body.data, modes=shapes.phi, modal_stiffness=full, stiffness=None)
    found = reduce(bodies.nodal(data, bodies.GIVEN, orthonormal=False))
    assert np.allclose(found.stiffness, full, rtol=1e-15) and not any(name.startswith("K") for name in found.zeros)
    assert found.zeros["c8_1_2"].startswith(MIRROR)
    diagonal = replace(data, modal_stiffness=shapes.stiffness)
    assert reduce(bodies.nodal(diagonal, bodies.GIVEN, orthonormal=False)).zeros["K_1_2"].startswith(MIRROR)


def test_a_stiffness_is_mirrored_with_its_signs() -> None:
    """Mirrored, a coupling of u1 with u2 of one node is that of its partner with the other sign."""
    x = bodies.truss((2, 2, 2)).positions
    (plane,) = (p for p in mirror_planes(csr_array(np.eye(8)), x) if p.axis == 0)
    modes = np.zeros((0, 8, 3))

    def symmetric(sign: float) -> bool:
        k = np.eye(24)
        for node, factor in ((0, 1.0), (int(plane.partner[0]), sign)):
            k[3 * node, 3 * node + 1] = k[3 * node + 1, 3 * node] = factor
        shapes = ModeShapes(x, modes, np.zeros((0, 0)), "as given")
        (elastic,) = made_symmetric(shapes, (plane,), csr_array(k))[1].elastic
        return elastic

    assert symmetric(-1.0) and not symmetric(1.0)


@pytest.mark.parametrize(("change", "symmetric"), [(1e-7, True), (1e-5, False)])
def test_the_parity_of_a_mode_is_known_to_six_digits(change: float, symmetric: bool) -> None:
    body = bodies.nodal(bodies.truss(), modes=1)
    shapes = prepare(body).shapes
    phi = shapes.phi.copy()
    phi[0, 0] += change * np.abs(phi).max()
    data = replace(body.data, modes=phi, modal_stiffness=shapes.stiffness, stiffness=None)
    parities = prepare(bodies.nodal(data, bodies.GIVEN, orthonormal=False)).parities.fields[1]
    assert np.all(np.abs(parities) == symmetric)


@pytest.mark.parametrize(("change", "planes"), [(1e-9, 3), (1e-7, 0)])
def test_planes_are_known_to_eight_digits(change: float, planes: int) -> None:
    """Digits count relative to the largest distance of a node from the centre of mass, or entry of the mass matrix."""
    data = bodies.truss((4, 3, 2))
    moved, masses = data.positions.copy(), data.mass.diagonal()
    moved[0] += change * np.linalg.norm(moved, axis=1).max() / np.sqrt(3)
    masses[0] *= 1 + change
    assert len(mirror_planes(data.mass, moved)) == planes
    assert len(mirror_planes(csr_array(np.diag(masses)), data.positions)) == planes


@pytest.mark.parametrize(("difference", "separated"), [(1e-8, True), (1e-4, False)])
def test_modes_of_different_frequency_are_not_combined(difference: float, separated: bool) -> None:
    """Mixed modes of opposite parity are separated only where any mix is a mode as well."""
    body = bodies.nodal(bodies.truss(), modes=6)
    shapes, mass = prepare(body).shapes, body.data.mass
    planes = mirror_planes(mass, shapes.x)
    first, second = shapes.phi[0], shapes.phi[1]
    mixed = np.array([0.6 * first + 0.8 * second, 0.8 * first - 0.6 * second])
    found = separated_by_parity(mass, mixed, np.array([1.0, 1.0 + difference]), planes)
    assert np.array_equal(found, mixed) != separated
    if separated:
        parts = np.abs(np.einsum("ink,jnk->ij", found, np.array([first, second])))
        assert np.sort(parts / parts.max(), axis=1) == pytest.approx(np.array([[0, 1], [0, 1]]), abs=1e-9)
