"""Geometric stiffness matrices in the files of a body: their forms, their units, their faults, and `order`."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import numpy as np
import pytest
from bodies import MODAL_BODY, save, save_mtx, toml, without
from scipy.io import mmwrite

import derive
from conftest import ROOT
from derive.cli.build_notes import build_notes
from derive.errors import SpecError
from derive.pipeline import build
from derive.spec.as_tables import specification_tables
from derive.spec.construction.bodies import nodal_body
from derive.spec.model.body import DisplacementOrder, NodalBody
from derive.spec.toml.read import read
from explicit_motion import moved

sys.path.insert(0, str(Path(__file__).parents[1] / "reduction"))
import bodies_of_nodes as truss

_RANDOM = np.random.default_rng(9).integers(-9, 9, (3 + 3 + 6 + 6, 2, 2)).astype(float)
_EVEN = _RANDOM + _RANDOM.swapaxes(1, 2)
K0 = {
    "K0t": _EVEN[:3],
    "K0r": _EVEN[3:6],
    "K0omega": _EVEN[6:12],
    "K0F": _EVEN[12:].reshape(2, 3, 2, 2),
    "K0F_nodes": np.array([3, 0]),
}
BODY = MODAL_BODY | K0


def test_arrays_of_python_and_of_archives(tmp_path) -> None:
    save(tmp_path, **BODY)
    (tmp_path / "b.toml").write_text(toml(""))
    for body in (nodal_body("b", BODY, units="SI"), read(tmp_path / "b.toml")):
        assert isinstance(body, NodalBody) and body.order is DisplacementOrder.TRUNCATED
        for name, array in K0.items():
            assert np.array_equal(getattr(body.data, name), array), name
        again = nodal_body("b", body.data)
        assert again.order is DisplacementOrder.TRUNCATED and np.array_equal(again.data.K0F, K0["K0F"])


def test_matrices_below_each_other(tmp_path) -> None:
    """Matrices are stacked as in MatrixMarket files, which have two indices."""
    flat = {"modes": BODY["modes"].reshape(2, -1).T, "mass": BODY["mass"][:, None]}
    save_mtx(tmp_path, **without(MODAL_BODY, *flat), **flat)
    for name, array in K0.items():
        mmwrite(tmp_path / f"{name}.mtx", array.reshape(-1, 1) if name == "K0F_nodes" else array.reshape(-1, 2))
    files = ", ".join(f'{key} = "{key}.mtx"' for key in BODY)
    (tmp_path / "b.toml").write_text(toml("", nodes=f"{{ {files} }}"))
    data = read(tmp_path / "b.toml").data
    for name, array in K0.items():
        assert np.array_equal(getattr(data, name), array), name


def test_units_are_those_of_a_stiffness_by_its_load() -> None:
    units = {"length": "mm", "mass": "t", "time": "ms"}
    data = nodal_body("b", BODY, units=units).data
    factors = {"K0t": 1e6, "K0r": 1e3, "K0omega": 1e3, "K0F": 1e3}  # kg/m, kg, kg, 1/m
    for name, factor in factors.items():
        assert np.allclose(getattr(data, name), factor * K0[name], rtol=1e-15), name


@pytest.mark.parametrize(("order", "expected"), [(1, DisplacementOrder.FIRST_ORDER), (2, DisplacementOrder.TRUNCATED)])
def test_order_chooses(order: int, expected: DisplacementOrder) -> None:
    body = nodal_body("b", BODY, units="SI", order=order)
    assert body.order is expected
    tables = specification_tables(body)
    assert tables["body"]["order"] == order
    plain = nodal_body("b", MODAL_BODY, units="SI")
    assert plain.order is DisplacementOrder.FIRST_ORDER and "order" not in specification_tables(plain)["body"]


def faults(**changes: object) -> list[str]:
    arrays = {key: value for key, value in (BODY | changes).items() if value is not None}
    with pytest.raises(SpecError) as caught:
        nodal_body("b", arrays, units="SI")
    return [f"{problem.path}: {problem.message}".removeprefix("body.nodes.") for problem in caught.value.problems]


ODD = K0["K0omega"].copy()
ODD[4, 0, 1] += 2


@pytest.mark.parametrize(
    ("name", "array", "message"),
    [
        ("K0t", K0["K0t"][:2], r"the shape is \(2, 2, 2\), and \(3, 2, 2\) or \(6, 2\) is needed, of 2 modes"),
        ("K0F", K0["K0F"][:1], r"the shape is \(1, 3, 2, 2\), and \(2, 3, 2, 2\) or \(12, 2\) is needed, of 2 modes"),
        ("K0omega", ODD, r"the matrices are not symmetric in the modes: \d\.\de-01 of the largest entry"),
        ("K0r", K0["K0r"] * np.nan, r"numbers that are NaN, infinite or beyond 1e\+100: 12 of 12, .*"),
        ("K0F_nodes", np.array([1, 4]), "there is no node 4: the nodes are 0 to 3"),
        ("K0F_nodes", np.array([1, -2]), "there is no node -2: the nodes are 0 to 3"),
        ("K0F_nodes", np.array([1, 1]), "a node is there twice; keep one"),
        ("K0F_nodes", np.array([1.0, 2.5]), "these are decimals; whole numbers are needed, from 0: .*"),
    ],
)
def test_faults_of_arrays(name: str, array: np.ndarray, message: str) -> None:
    (found,) = faults(**{name: array})
    assert re.fullmatch(f"{name}: {message}", found), found


def test_arrays_that_belong_together() -> None:
    both = "is missing; forces at nodes need both K0F and K0F_nodes"
    assert faults(K0F_nodes=None) == [f"K0F: K0F_nodes {both}"]
    assert faults(K0F=None) == [f"K0F_nodes: K0F {both}"]
    modeless = dict.fromkeys(("modes", "modal_stiffness"))
    missing = "there are no modes that this could belong to; add them as `modes`"
    assert {f"{name}: {missing}" for name in ("K0t", "K0r", "K0omega", "K0F")} <= set(faults(**modeless))


def test_order_two_needs_matrices(tmp_path) -> None:
    save(tmp_path, **MODAL_BODY)

    def problems(lines: str) -> list[str]:
        (tmp_path / "b.toml").write_text(toml(lines))
        with pytest.raises(SpecError) as caught:
            read(tmp_path / "b.toml")
        return [f"{problem.path}: {problem.message}" for problem in caught.value.problems]

    assert problems("order = 2") == [
        "body.order: a body of order 2 needs geometric stiffness matrices, K0t, K0r, K0omega or K0F, among its arrays, "
        "or elements with materials and a stiffness, from which they are computed"
    ]
    assert problems("order = 3") == ["body.order: the order is 1 or 2, not 3"]


def notes(tmp_path, lines: str, **arrays: np.ndarray) -> list[str]:
    """The notes of `build` on geometric stiffness, for the truss of the reduction with these matrices."""
    data = truss.cloud(2, 6)
    save(
        tmp_path,
        positions=data.positions,
        mass=data.mass.diagonal(),
        modes=data.modes,
        modal_stiffness=data.modal_stiffness,
        **arrays,
    )
    path = tmp_path / "b.toml"
    path.write_text(toml(lines))
    return [note for note in build_notes(build(path), path) if "geometric stiffness" in note]


def test_build_says_what_is_used(tmp_path) -> None:
    some = {name: K0[name] for name in ("K0omega", "K0F", "K0F_nodes")}
    assert notes(tmp_path, "", **some) == [
        "displacements of second order in the amplitudes, from geometric stiffness K0omega, K0F; K0t, K0r: not given, "
        "and taken as zero"
    ]
    assert notes(tmp_path, "order = 1", **some) == [
        "warning: geometric stiffness K0omega, K0F is left out, since order = 1"
    ]
    (note,) = notes(tmp_path, "")
    assert "displacements of first order in the amplitudes: there is no geometric stiffness" in note


def test_a_run_notes_a_body_whose_tables_lack_those_of_its_spin() -> None:
    """At a fifth of its lowest frequency; with K0omega, or without spin, there is nothing to note."""
    arrays = dict(np.load(ROOT / "scenes/solid_beam.npz"))
    few = {name: array for name, array in arrays.items() if name != "K0omega"}
    times = {"duration": 1e-4, "output": 1e-4}
    for data, spin, noted in ((few, 60, True), (arrays, 60, False), (few, 0, False)):
        body = {"nodes": data, "units": "SI", "start": {"angular_velocity": [0, spin, 0]}}
        run = moved(derive.spatial_scene("free", bodies={"beam": body}, simulation=times))
        notes = [note for note in run.notes if "its files lack K0omega, its centrifugal stiffening" in note]
        assert len(notes) == noted
