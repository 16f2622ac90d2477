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
    save,
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


MM_T_S = {"length": "mm", "mass": "t", "time": "s"}


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
