"""Bodies in space that are right: from files, from text and from Python, all the same."""

import hashlib
import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest
from bodies import (
    CONSISTENT,
    LUMPED,
    LUMPED_BODY,
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
    without,
)
from scipy.sparse import bsr_array, coo_array, coo_matrix, csr_array

from derive.errors import SpecError
from derive.spec.construction.bodies import nodal_body, planar_beam, symbolic_body
from derive.spec.model.body import BodyFrame, Damping, DisplacementOrder, NodalBody, SymbolicBody
from derive.spec.model.node_markers import NodeMarker
from derive.spec.model.quantity import Parameter
from derive.spec.model.simulation import AT_REST
from derive.spec.toml.read import parse, read

F = Fraction


def numbers(data):
    """Everything in NodeData, as nested lists."""
    return {
        "positions": data.positions.tolist(),
        "mass": data.mass.toarray().tolist(),
        "stiffness": None if data.stiffness is None else data.stiffness.toarray().tolist(),
        "modes": None if data.modes is None else data.modes.tolist(),
        "modal_stiffness": None if data.modal_stiffness is None else data.modal_stiffness.tolist(),
    }


def fields_of(body):
    """The fields of a body other than its numbers."""
    return {key: value for key, value in vars(body).items() if key != "data"}


DEFAULTS = {
    "name": "b",
    "modes": None,
    "frame": BodyFrame("mean"),
    "orthonormal": True,
    "damping": Damping(),
    "gravity": None,
    "markers": (),
    "lowering": "auto",
    "start": AT_REST,
    "simulation": None,
    "order": DisplacementOrder.FIRST_ORDER,
    "plots": (),
    "rigid_sets": (),
    "component_modes": None,
    "interface": (),
    "interface_markers": (),
    "loaded_nodes": (),
    "stress": False,
}


def test_a_body_with_modes_needs_no_more_than_its_file_and_its_units(tmp_path):
    save(tmp_path, **MODAL_BODY)
    (tmp_path / "b.toml").write_text(toml(""))
    body = read(tmp_path / "b.toml")
    assert isinstance(body, NodalBody)
    assert fields_of(body) == DEFAULTS
    assert numbers(body.data) == {
        "positions": POSITIONS.tolist(),
        "mass": np.diag(LUMPED).tolist(),
        "stiffness": None,
        "modes": MODES.tolist(),
        "modal_stiffness": MODAL.tolist(),
    }
    assert body.data.sha256 == hashlib.sha256((tmp_path / "b.npz").read_bytes()).hexdigest()
    assert isinstance(body.data.mass, csr_array)


def test_files_are_beside_the_specification_and_not_where_one_stands(tmp_path, monkeypatch):
    (tmp_path / "parts").mkdir()
    (tmp_path / "elsewhere").mkdir()
    save(tmp_path / "parts", **MODAL_BODY)
    (tmp_path / "b.toml").write_text(toml("", '"parts/b.npz"'))
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert read(tmp_path / "b.toml").data.positions.tolist() == POSITIONS.tolist()
    monkeypatch.chdir(tmp_path / "parts")
    assert parse(toml("")).data.positions.tolist() == POSITIONS.tolist()


G3 = Parameter("g3", "m/s^2", -9.81)
G = Parameter("g", "mm/s^2", 0.0)


@pytest.mark.parametrize(
    ("lines", "keywords", "changes"),
    [
        ("modes = 1", {"modes": 1}, {"modes": 1}),
        ("modes = 0", {"modes": np.int64(0)}, {"modes": 0}),
        ('frame = "given"', {"frame": "given"}, {"frame": BodyFrame("given"), "orthonormal": False}),
        (
            'frame = "given"\northonormal = true',
            {"frame": BodyFrame("given"), "orthonormal": True},
            {"frame": BodyFrame("given")},
        ),
        (
            'frame = { kind = "point", node = 3 }',
            {"frame": {"kind": "point", "node": 3}},
            {"frame": BodyFrame("point", 3), "orthonormal": False},
        ),
        (
            'frame = { kind = "point", node = 0, around = [1, 2] }',
            {"frame": BodyFrame("point", 0, (1, 2))},
            {"frame": BodyFrame("point", 0, (1, 2)), "orthonormal": False},
        ),
        ('frame = { kind = "mean" }', {"frame": {"kind": "mean", "around": []}}, {}),
        ("orthonormal = false", {"orthonormal": False}, {"orthonormal": False}),
        ("damping = { ratio = 0.01 }", {"damping": {"ratio": 0.01}}, {"damping": Damping(F(1, 100))}),
        (
            "damping = { mass = 0.1, stiffness = 1e-5 }",
            {"damping": Damping(mass=F(1, 10), stiffness=F(1, 10**5))},
            {"damping": Damping(F(0), F(1, 10), F(1, 10**5))},
        ),
        ("damping = { ratio = 0 }", {"damping": Damping()}, {}),
        (
            "gravity = [0, 0.5, '-1/3']",
            {"gravity": (0, 0.5, F(-1, 3))},
            {"gravity": (F(0), F(1, 2), F(-1, 3))},
        ),
        (
            'gravity = [0, { symbol = "g", unit = "mm/s^2", default = 0 }, { symbol = "g3", default = -9.81 }]',
            {"gravity": [0, G, {"symbol": "g3", "default": -9.81}]},
            {"gravity": (F(0), G, G3)},
        ),
        ('lowering = "loops"', {"lowering": "loops"}, {"lowering": "loops"}),
        ('lowering = "flat"', {"lowering": "flat"}, {"lowering": "flat"}),
        (
            "markers = { tip = 3, root = 0 }",
            {"markers": {"tip": 3, "root": 0}},
            {"markers": (NodeMarker("tip", 3), NodeMarker("root", 0))},
        ),
    ],
)
def test_toml_and_python_say_the_same(tmp_path, lines, keywords, changes):
    save(tmp_path, **MODAL_BODY)
    from_toml = parse(toml(lines), str(tmp_path / "b.toml"))
    from_python = nodal_body("b", tmp_path / "b.npz", units="SI", **keywords)
    assert fields_of(from_toml) == fields_of(from_python) == DEFAULTS | changes
    assert numbers(from_toml.data) == numbers(from_python.data)
    assert from_toml.data.sha256 == from_python.data.sha256


def test_modes_are_computed_if_none_are_given(tmp_path):
    save(tmp_path, **LUMPED_BODY)
    body = parse(toml('modes = 6\nframe = { kind = "point", node = 1 }'), str(tmp_path / "b.toml"))
    assert (body.modes, body.orthonormal, body.data.modes) == (6, True, None)
    assert body.data.stiffness.toarray().tolist() == STIFFNESS.tolist()


def test_a_rigid_body_needs_no_stiffness():
    body = nodal_body("b", {"positions": POSITIONS, "mass": LUMPED}, units="SI", modes=0)
    assert (body.modes, body.data.modes, body.data.stiffness) == (0, None, None)
    one = nodal_body("b", {"positions": POSITIONS[:1], "mass": LUMPED[:1]}, units="SI", modes=0)
    assert one.data.mass.toarray().tolist() == [[1.0]]


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


MM_T_S = {"length": "mm", "mass": "t", "time": "s"}


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


@pytest.mark.parametrize("form", [np.asarray, csr_array, coo_array, coo_matrix, bsr_array])
def test_arrays_of_python_are_as_good_as_files(form):
    arrays = LUMPED_BODY | {"mass": form(CONSISTENT), "stiffness": form(STIFFNESS)}
    body = nodal_body("b", arrays, units=MM_T_S, modes=2)
    assert np.allclose(body.data.mass.toarray(), CONSISTENT * 1000)
    assert np.allclose(body.data.stiffness.toarray(), STIFFNESS * 1000)
    assert len(body.data.sha256) == 64


def test_the_digest_of_arrays_tells_them_apart():
    digests = {
        nodal_body("b", arrays, units="SI", modes=1).data.sha256
        for arrays in (
            LUMPED_BODY,
            LUMPED_BODY | {"positions": 2 * POSITIONS},
            LUMPED_BODY | {"stiffness": csr_array(STIFFNESS)},
        )
    }
    assert len(digests) == 3
    again = dict(reversed(LUMPED_BODY.items()))
    assert nodal_body("b", again, units="SI", modes=1).data.sha256 in digests


def test_a_body_says_itself_again():
    body = nodal_body("b", MODAL_BODY, units=MM_T_S, frame="given", damping={"ratio": 0.5}, gravity=[0, 0, G3])
    again = nodal_body(
        body.name,
        body.data,
        frame=body.frame,
        orthonormal=body.orthonormal,
        damping=body.damping,
        gravity=body.gravity,
        markers={marker.name: marker.node for marker in body.markers},
        lowering=body.lowering,
    )
    assert fields_of(again) == fields_of(body)
    assert numbers(again.data) == numbers(body.data)
    assert again.data.sha256 == body.data.sha256
    with pytest.raises(SpecError, match=r"^body\.nodes\.mass: "):
        nodal_body("b", type(body.data)(**vars(body.data) | {"mass": -body.data.mass}))
    with pytest.raises(SpecError, match=r"^body\.units: NodeData are in SI units"):
        nodal_body("b", body.data, units=MM_T_S)


def test_what_python_does_to_its_arrays_later_does_not_change_the_body():
    positions = POSITIONS.copy()
    body = nodal_body("b", LUMPED_BODY | {"positions": positions}, units="SI", modes=1)
    positions[0, 0] = 99
    assert body.data.positions.tolist() == POSITIONS.tolist()


@pytest.mark.parametrize(
    ("lines", "keywords", "body"),
    [
        ("modes = 3", {"modes": 3}, SymbolicBody("b", 3, "mean", False, None, "auto")),
        ("modes = 0", {"modes": 0}, SymbolicBody("b", 0, "mean", False, None, "auto")),
        ("modes = 300", {"modes": 300}, SymbolicBody("b", 300, "mean", False, None, "auto")),
        (
            'modes = 2\nframe = "given"\ndamping = true\nlowering = "flat"\n'
            'gravity = [0, 0, { symbol = "g3", default = -9.81 }]',
            {"modes": 2, "frame": "given", "damping": True, "lowering": "flat", "gravity": [0, 0, G3]},
            SymbolicBody("b", 2, "given", True, (F(0), F(0), G3), "flat"),
        ),
    ],
)
def test_a_symbolic_body(lines, keywords, body):
    assert parse(f'name = "b"\n[body]\nintegrals = "symbolic"\n{lines}\n') == body
    assert symbolic_body("b", **keywords) == body


def test_the_gravity_of_a_beam():
    text = 'name = "b"\n[beam]\ngravity = [0, { symbol = "g", default = -9.81 }]\n'
    gravity = (F(0), Parameter("g", "m/s^2", -9.81))
    assert parse(text).gravity == planar_beam("b", gravity=[0, gravity[1]]).gravity == gravity
    assert planar_beam("b", gravity=(0, -9.81)).gravity == (F(0), F(-981, 100))
    assert planar_beam("b").gravity is None


def test_a_beam_and_a_symbolic_body_do_without_numpy_and_scipy():
    code = (
        "import sys, derive as s; s.symbolic_body('b', 3)\n"
        "s.planar_beam('b'); print({'numpy', 'scipy'} & set(sys.modules))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout == "set()\n"


def test_all_that_a_body_need_not_have_is_left_out(tmp_path):
    save(tmp_path, **without(MODAL_BODY, "modal_stiffness"), stiffness=STIFFNESS)
    data = nodal_body("b", tmp_path / "b.npz", units="SI").data
    assert data.modal_stiffness is None
    assert data.modes.tolist() == MODES.tolist()
