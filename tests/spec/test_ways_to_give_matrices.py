"""Masses, stiffnesses and modes in all the ways in which files give them, and their units."""

import hashlib

import numpy as np
import pytest
from bodies import (
    CONSISTENT,
    LUMPED,
    MODAL,
    MODAL_BODY,
    MODES,
    POSITIONS,
    STIFFNESS,
    N,
    entries,
    save,
    save_mtx,
    toml,
)
from scipy.sparse import coo_matrix
from test_body import MM_T_S, numbers

from derive.spec.construction.bodies import nodal_body
from derive.spec.toml.read import parse


def kron(m):
    return np.kron(m, np.eye(3))


LOWER = np.tril(CONSISTENT)
DIRECTED = np.array([0, 1, 0, 3]), np.array([0, 0, 0, 3]), np.array([1.0, 0.5, 2.0, 4.0])


@pytest.mark.parametrize(
    ("arrays", "mass"),
    [
        ({"mass": LUMPED}, np.diag(LUMPED)),
        ({"mass": LUMPED.astype(np.float32)}, np.diag(LUMPED)),
        ({"mass": np.arange(4)}, np.diag([0, 1, 2, 3])),
        ({"mass": LUMPED[:, None]}, np.diag(LUMPED)),
        ({"mass": LUMPED[None]}, np.diag(LUMPED)),
        ({"mass": np.repeat(LUMPED, 3)}, np.diag(LUMPED)),
        ({"mass": np.repeat(LUMPED, 3)[:, None]}, np.diag(LUMPED)),
        ({"mass": CONSISTENT}, CONSISTENT),
        ({"mass": kron(CONSISTENT)}, CONSISTENT),
        ({"mass": CONSISTENT * (1 + 1e-12 * np.triu(np.ones((N, N)), 1))}, CONSISTENT * (1 + 5e-13)),
        (entries("mass", CONSISTENT), CONSISTENT),
        (entries("mass", LOWER), CONSISTENT),
        (entries("mass", LOWER.T), CONSISTENT),
        (entries("mass", kron(CONSISTENT)), CONSISTENT),
        (entries("mass", kron(LOWER)), CONSISTENT),
        (entries("mass", np.diag(LUMPED)), np.diag(LUMPED)),
        (
            {f"mass_{part}": array for part, array in zip(("row", "col", "value"), DIRECTED, strict=True)},
            [[3, 0.5, 0, 0], [0.5, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 4]],
        ),
    ],
)
def test_a_mass_is_given_in_many_ways(tmp_path, arrays, mass):
    save(tmp_path, positions=POSITIONS, stiffness=STIFFNESS, **arrays)
    found = nodal_body("b", str(tmp_path / "b.npz"), units="SI", modes=2).data.mass
    assert np.allclose(found.toarray(), mass, rtol=1e-12, atol=0)
    assert np.array_equal(found.toarray(), found.toarray().T)
    assert found.shape == (N, N)


@pytest.mark.parametrize(
    "arrays",
    [
        {"stiffness": STIFFNESS},
        entries("stiffness", STIFFNESS),
        entries("stiffness", np.tril(STIFFNESS)),
        {"stiffness": STIFFNESS.astype(np.int32)},
        {"stiffness": STIFFNESS * (1 + 1e-15 * np.tril(np.ones((3 * N, 3 * N))))},
    ],
)
def test_a_stiffness_is_given_in_many_ways(tmp_path, arrays):
    save(tmp_path, positions=POSITIONS, mass=LUMPED, **arrays)
    found = nodal_body("b", str(tmp_path / "b.npz"), units="SI", modes=2).data.stiffness.toarray()
    assert np.allclose(found, STIFFNESS, rtol=1e-12, atol=0)
    assert np.array_equal(found, found.T)


@pytest.mark.parametrize("modes", [MODES, MODES.reshape(2, -1).T])
@pytest.mark.parametrize("modal", [np.diag([5.0, 7.0]), np.array([5.0, 7.0]), np.array([[5.0], [7.0]])])
def test_modes_and_their_stiffness_are_given_in_many_ways(tmp_path, modes, modal):
    save(tmp_path, positions=POSITIONS, mass=LUMPED, modes=modes, modal_stiffness=modal)
    data = nodal_body("b", tmp_path / "b.npz", units="SI").data
    assert data.modes.tolist() == MODES.tolist()
    assert data.modal_stiffness.tolist() == [[5, 0], [0, 7]]


def test_a_compressed_archive_is_read_too(tmp_path):
    np.savez_compressed(tmp_path / "b.npz", **MODAL_BODY)
    assert nodal_body("b", tmp_path / "b.npz", units="SI").data.modes.tolist() == MODES.tolist()


@pytest.mark.parametrize("form", [np.array, coo_matrix])
def test_matrix_market_says_the_same_as_an_archive(tmp_path, form):
    every = {"positions": POSITIONS, "mass": CONSISTENT, "stiffness": STIFFNESS}
    every |= {"modes": MODES.reshape(2, -1).T, "modal_stiffness": MODAL}
    save(tmp_path, **every)
    save_mtx(tmp_path, **{key: form(array) for key, array in every.items()})
    table = ", ".join(f'{key} = "{key}.mtx"' for key in reversed(every))
    body = parse(toml("", f"{{ {table} }}"), str(tmp_path / "b.toml"))
    assert numbers(body.data) == numbers(nodal_body("b", tmp_path / "b.npz", units="SI").data)
    content = b"".join((tmp_path / f"{key}.mtx").read_bytes() for key in every)
    assert body.data.sha256 == hashlib.sha256(content).hexdigest()
    assert "symmetric" in (tmp_path / "mass.mtx").read_text()
    assert nodal_body("b", {key: tmp_path / f"{key}.mtx" for key in every}, units="SI").data.sha256 == body.data.sha256


def test_a_lumped_mass_in_matrix_market_is_a_column(tmp_path):
    save_mtx(tmp_path, positions=POSITIONS, mass=coo_matrix(LUMPED[:, None]))
    files = {key: tmp_path / f"{key}.mtx" for key in ("positions", "mass")}
    assert nodal_body("b", files, units="SI", modes=0).data.mass.diagonal().tolist() == LUMPED.tolist()


@pytest.mark.parametrize(
    ("units", "length", "mass", "stiffness"),
    [
        ("SI", 1, 1, 1),
        ({"length": "m", "mass": "kg", "time": "s"}, 1, 1, 1),
        (MM_T_S, 1e-3, 1e3, 1e3),
        ({"length": "cm", "mass": "g", "time": "ms"}, 1e-2, 1e-3, 1e3),
        ({"length": "in", "mass": "lbf s^2/in", "time": "s"}, 0.0254, 175.12683524647636, 175.12683524647636),
    ],
)
def test_numbers_become_si(tmp_path, units, length, mass, stiffness):
    save(tmp_path, stiffness=STIFFNESS, **MODAL_BODY)
    data = nodal_body("b", tmp_path / "b.npz", units=units).data
    assert data.positions == pytest.approx(POSITIONS * length, rel=1e-15)
    assert data.mass.toarray() == pytest.approx(np.diag(LUMPED) * mass, rel=1e-15)
    assert data.stiffness.toarray() == pytest.approx(STIFFNESS * stiffness, rel=1e-15)
    assert data.modal_stiffness == pytest.approx(MODAL * stiffness, rel=1e-15)
    assert data.modes.tolist() == MODES.tolist()


def test_a_stiffness_in_newton_per_millimetre_is_that_of_millimetres_tonnes_and_seconds(tmp_path):
    spring = np.zeros((12, 12))
    spring[0, 0] = 5.0  # N/mm
    save(tmp_path, positions=POSITIONS, mass=LUMPED, stiffness=spring)
    text = toml("modes = 1", units='{ length = "mm", mass = "t", time = "s" }')
    assert parse(text, str(tmp_path / "b.toml")).data.stiffness[0, 0] == 5000.0  # N/m


def test_a_millimetre_is_a_thousandth_and_nothing_else():
    lengths = np.array([[1.0, 3, 7], [11, 13, 17]])
    data = nodal_body("b", {"positions": lengths, "mass": np.ones(2)}, units=MM_T_S, modes=0).data
    assert data.positions.tolist() == [[0.001, 0.003, 0.007], [0.011, 0.013, 0.017]]
