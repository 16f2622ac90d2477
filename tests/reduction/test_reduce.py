"""The numbers of a modal body against sums over the nodes, and against the conditions of its frame."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import bodies_of_nodes as bodies
import numpy as np
import pytest
import scipy.linalg

from derive.mechanics.bodies.modal_body import ModalBody
from derive.reduction import reduce, residuals, zero_stiffness_modes
from derive.reduction.body import prepare
from derive.spec.model.body import BodyFrame, Damping, NodalBody


def sums(body: NodalBody) -> dict[str, np.ndarray]:
    """c1 .. c8 as the appendix has them, by einsum over pairs of nodes."""
    prepared = prepare(body)
    m, x, phi = prepared.mass.toarray(), prepared.shapes.x, prepared.shapes.phi

    def tensor(f, g):
        dot = np.einsum("ab,...ak,bk->...", m, f, g)[..., None, None] * np.eye(3)
        return dot - np.einsum("ab,...ak,bl->...kl", m, f, g)

    def cross(f, g):
        return np.einsum("abk->k", m[..., None] * np.cross(f[:, None], g[None]))

    return {
        "c1": np.einsum("ab,bk->k", m, x),
        "c2": np.einsum("ab,ibk->ik", m, phi),
        "C3": tensor(x, x),
        "C4": tensor(phi, x),
        "C5": np.array([[tensor(f, g) for g in phi] for f in phi]),
        "c6": np.array([cross(x, f) for f in phi]),
        "c7": np.array([[cross(f, g) for g in phi] for f in phi]),
        "c8": np.einsum("ab,iak,jbk->ij", m, phi, phi),
    }


def compare(found: ModalBody, body: NodalBody) -> None:
    for name, value in sums(body).items():
        assert np.allclose(getattr(found, name), value, rtol=0, atol=1e-12 * max(1.0, np.abs(value).max())), name


@pytest.mark.parametrize("full", [False, True])
@pytest.mark.parametrize("frame", [bodies.GIVEN, bodies.MEAN, BodyFrame("point", 3), BodyFrame("point", 2, (5, 7, 9))])
@pytest.mark.parametrize("orthonormal", [False, True])
def test_integrals_are_the_sums(full: bool, frame: BodyFrame, orthonormal: bool) -> None:
    data = bodies.consistent(bodies.cloud(4)) if full else bodies.cloud(4)
    body = bodies.nodal(data, frame, orthonormal=orthonormal)
    found = reduce(body)
    assert found.mass == pytest.approx(data.mass.sum(), rel=1e-14)
    compare(found, body)
    if orthonormal:
        assert np.array_equal(found.c8, np.eye(4)) and np.all(np.diff(np.diag(found.stiffness)) > 0)
        assert np.count_nonzero(found.stiffness) == 4


def test_nodes_lumped_are_the_diagonal_case() -> None:
    """Two masses of m that are coupled as a bar of mass 2 m: m_aa = 2/3 m, m_ab = 1/3 m, against the integral."""
    data = bodies.consistent(bodies.cloud(3))
    body = bodies.nodal(data, bodies.GIVEN, orthonormal=False)
    found = reduce(body)
    rows = np.asarray(data.mass.sum(axis=1)).ravel()
    lumps = reduce(bodies.nodal(bodies.lumped(rows, data.positions, data.modes, data.modal_stiffness), bodies.GIVEN))
    assert np.allclose(found.c1, lumps.c1) and not np.allclose(found.C3, lumps.C3, rtol=1e-3)


def test_conditions_of_the_mean_frame() -> None:
    body = bodies.nodal(bodies.cloud(5))
    found, far = reduce(body), residuals(body)
    assert far.before.largest > 0.1 and far.after.largest < 1e-15 * 10
    assert not np.any(found.c1) and not np.any(found.c2) and not np.any(found.c6)
    assert found.zeros["c1_2"] == "the choice of the origin (the centre of mass)"
    assert found.zeros["c2_3_1"] == "condition (17) (no mean displacement)"
    assert found.zeros["c6_5_3"] == "condition (19) (no mean rotation)"
    assert found.zeros["c8_1_2"] == found.zeros["K_1_2"] == "orthogonality (modes orthonormal in the mass)"
    assert found.zeros["B_1_1"] == "the specification (no damping)"
    assert not any(name.startswith(("C3", "C4", "C5", "c7")) for name in found.zeros)
    assert "centre of mass" in found.origin and found.doc == "body of 10 nodes with 5 modes, mean frame"


def test_zeros_are_those_of_the_tables() -> None:
    for data, n in ((bodies.cloud(3), 3), (bodies.truss(), 9)):
        found = reduce(bodies.nodal(data, modes=n))
        parts = [f"{name}_{i}" for name in ("c8", "K", "B") for i in ("1_1", "1_2")]
        assert {"c8_1_1", "K_1_1"}.isdisjoint(found.zeros) and set(parts) - {"c8_1_1", "K_1_1"} <= set(found.zeros)
        for name in found.zeros:
            assert value(found, name) == 0.0
        assert np.array_equal(found.c7, -found.c7.transpose(1, 0, 2))
        assert np.array_equal(found.C5, found.C5.transpose(1, 0, 3, 2)) and np.array_equal(found.C3, found.C3.T)


def value(body: ModalBody, name: str) -> float:
    """A number by the name of the derivation; of C4 and C5 the symmetric part."""
    table, *index = name.split("_")
    at = tuple(
        int(digit) - 1 for part in index for digit in (part if table[0] == "C" and part is index[-1] else [part])
    )
    array = {"K": body.stiffness, "B": body.damping}.get(table)
    array = getattr(body, table) if array is None else array
    return (array[at] + array[*at[:-2], at[-1], at[-2]]) / 2 if table[0] == "C" else array[at]


def test_strain_energy_is_kept_by_the_frame() -> None:
    data = bodies.cloud(3)
    for frame in (bodies.MEAN, BodyFrame("point", 1)):
        found = reduce(bodies.nodal(data, frame, orthonormal=False))
        assert np.array_equal(found.stiffness, data.modal_stiffness)


@pytest.mark.parametrize("frame", [bodies.GIVEN, bodies.MEAN, BodyFrame("point", 1)])
def test_orthonormal_modes_have_the_same_energy(frame: BodyFrame) -> None:
    data = bodies.consistent(bodies.cloud(4))
    raw, new = (reduce(bodies.nodal(data, frame, orthonormal=flag)) for flag in (False, True))
    assert np.allclose(np.diag(new.stiffness), scipy.linalg.eigvalsh(raw.stiffness, raw.c8), rtol=1e-11)


def test_frame_at_a_node() -> None:
    body = bodies.nodal(bodies.cloud(4), BodyFrame("point", 3), orthonormal=False)
    prepared = prepare(body)
    x, phi, around = prepared.shapes.x, prepared.shapes.phi, list(prepared.shapes.around)
    assert not np.any(x[3]) and not np.any(phi[:, 3])
    assert len(around) == 2
    distance = np.linalg.norm(x, axis=1)
    assert sorted(distance[around]) == sorted(distance)[1:3]
    turns = np.cross(x[around], phi[:, around]).sum(axis=1)
    assert np.abs(turns).max() < 1e-14 * np.abs(phi).max()
    found = reduce(body)
    assert found.origin == "node 3 of the undeformed body"
    assert f"no mean rotation of nodes {around[0]}, {around[1]} about it" in found.doc
    first = found.points[0]
    assert first.name == "first" and np.array_equal(first.position, x[0]) and np.array_equal(first.shapes, phi[:, 0])


def test_damping() -> None:
    data = bodies.cloud(3)
    half = reduce(bodies.nodal(data, damping=Damping(ratio=Fraction(1, 100))))
    assert np.allclose(np.diag(half.damping), 0.02 * np.sqrt(np.diag(half.stiffness)), rtol=1e-14)
    assert half.zeros["B_1_2"] == "orthogonality (modes orthonormal in the mass)"
    given = bodies.nodal(data, bodies.GIVEN, orthonormal=False)
    both = reduce(replace(given, damping=Damping(Fraction(1, 50), Fraction(3), Fraction(1, 1000))))
    free = reduce(replace(given, frame=BodyFrame("mean"))).c8  # of the same modes without their rigid motion
    rest = both.damping - 3 * free - both.stiffness / 1000
    root = np.linalg.inv(np.linalg.cholesky(free))
    values, k = (np.linalg.eigvalsh(root @ matrix @ root.T) for matrix in (rest, both.stiffness))
    assert np.allclose(values, 2 / 50 * np.sqrt(k), rtol=1e-12)


@pytest.mark.parametrize("frame", [BodyFrame("mean"), BodyFrame("point", 2), BodyFrame("given")])
@pytest.mark.parametrize("damping", [Damping(ratio=Fraction(1, 50)), Damping(mass=Fraction(3))])
def test_damping_of_the_free_body_does_not_depend_on_the_frame(frame: BodyFrame, damping: Damping) -> None:
    """Eigenvalues of M, B and K of all rows, at rest: each elastic mode has the ratio that was asked for."""
    body = reduce(bodies.nodal(bodies.cloud(3), frame, orthonormal=False, damping=damping))
    rigid = np.zeros((6, 6))
    rigid[:3, :3] = body.mass * np.eye(3)
    rigid[3:, 3:] = body.C3
    rigid[3:, :3] = np.cross(np.eye(3), body.c1)
    rigid[:3, 3:] = rigid[3:, :3].T
    coupling = np.hstack([body.c2, body.c6])
    elastic = body.c8 - coupling @ np.linalg.solve(rigid, coupling.T)
    root = np.linalg.inv(np.linalg.cholesky(elastic))
    values, turned = np.linalg.eigh(root @ body.stiffness @ root.T)
    rates = turned.T @ root @ body.damping @ root.T @ turned
    expected = 2 / 50 * np.sqrt(values) if damping.ratio else np.full(3, 3.0)
    assert np.allclose(rates, np.diag(expected), rtol=1e-10, atol=1e-10 * expected.max())


def test_loose_parts_are_told() -> None:
    data = bodies.cloud(3)
    assert zero_stiffness_modes(bodies.nodal(data)) == ()
    stiffness = data.modal_stiffness.copy()
    stiffness[1] = stiffness[:, 1] = 0.0
    assert zero_stiffness_modes(bodies.nodal(replace(data, modal_stiffness=stiffness))) == (1,)


def test_a_body_without_modes() -> None:
    found = reduce(bodies.nodal(bodies.cloud(0)))
    assert found.modes == 0 and found.c8.shape == (0, 0) and not np.any(found.c1) and found.C5.shape == (0, 0, 3, 3)


def test_same_bytes() -> None:
    for body in (bodies.nodal(bodies.cloud(6)), bodies.nodal(bodies.truss((8, 7, 6), seed=2), modes=6)):
        first, second = reduce(body), reduce(body)
        for name in ("c1", "C3", "C4", "C5", "c7", "stiffness"):
            assert getattr(first, name).tobytes() == getattr(second, name).tobytes()
