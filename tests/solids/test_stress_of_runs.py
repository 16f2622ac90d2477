"""Stresses of runs: a bent cantilever of bricks against the theory of beams, in the CSV and in files for ParaView."""

from __future__ import annotations

import csv
import xml.etree.ElementTree as ET
import zlib
from base64 import b64decode
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cantilever_run import FORCE, SIDES, YOUNG, cantilever, scene_file

import derive
from derive.cli.main import main
from derive.reduction.modal_stresses import modal_stresses
from derive.simulation.observables.default_plots import default_plots
from derive.simulation.observables.fields import field_bodies, field_instants
from derive.simulation.observables.spatial_player_data import spatial_player_data
from derive.simulation.observables.stresses import largest_stress
from derive.solids.face_areas import area_products
from derive.solids.stresses import von_mises
from derive.spec.files.mesh_arrays import mesh_arrays
from explicit_motion import moved

LENGTH, WIDTH, HEIGHT = SIDES
AT_ROOT = 6 * FORCE * LENGTH / (WIDTH * HEIGHT**2)
DEFLECTION = FORCE * LENGTH**3 / (3 * YOUNG * WIDTH * HEIGHT**3 / 12)
NUMBERS = {"Float32": "<f4", "Int32": "<i4", "UInt8": "<u1"}


def arrays_of(vtu: Path) -> dict[str, np.ndarray]:
    """The arrays of a .vtu file by their names, as its format defines them."""
    result = {}
    for element in ET.parse(vtu).getroot().iter("DataArray"):
        text = (element.text or "").encode()
        blocks, size, last, packed = np.frombuffer(b64decode(text[:44]), dtype="<u8")[:4]
        numbers = zlib.decompress(b64decode(text[44:]))
        assert blocks == 1 and size == last == len(numbers) and packed == len(b64decode(text[44:]))
        columns = int(element.get("NumberOfComponents", "1"))
        values = np.frombuffer(numbers, dtype=NUMBERS[str(element.get("type"))])
        result[str(element.get("Name"))] = values.reshape(-1, columns) if columns > 1 else values
    return result


@pytest.mark.long
def test_a_bent_cantilever_has_the_stress_of_the_theory(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """6 F l/(b h^2) at the root without Poisson's effect, and the deflection with 0.1 % of shear."""
    beam = cantilever(0.0)
    path = scene_file(beam, tmp_path)
    assert main(["simulate", str(path), "--out", str(tmp_path), "--fields", "beam", "--instants", "1"]) == 0
    written = capsys.readouterr().out
    assert "beam.pvd" in written and "stress.svg" in written and ".vtu" not in written
    rows = list(csv.DictReader((tmp_path / "bent/bent.csv").open()))
    assert float(rows[0]["beam_stress"]) == pytest.approx(AT_ROOT, rel=2e-3)
    series = ET.parse(tmp_path / "bent/beam.pvd").getroot()
    files = [(float(one.get("timestep")), one.get("file")) for one in series.iter("DataSet")]
    assert files == [(0.0, "beam_fields/0000.vtu")]
    fields = arrays_of(tmp_path / "bent" / files[0][1])
    x = beam.solid.x
    assert fields["places"][beam.root] == pytest.approx(x[beam.root], abs=1e-6)  # rotations by deformation are linear
    moved = fields["places"] - x
    assert moved[beam.tip, 2].mean() == pytest.approx(DEFLECTION, rel=2e-3)
    assert np.ptp(moved - fields["displacement"], axis=0)[1] < 1e-6  # they differ by a rigid motion
    assert np.array_equal(fields["connectivity"].reshape(-1, 20), beam.solid.mesh.elements[0].nodes)
    assert fields["offsets"].tolist() == list(range(20, 20 * 20 + 1, 20)) and set(fields["types"]) == {25}
    expected = 12 * FORCE * (LENGTH - x[:, 0]) * -x[:, 2] / (WIDTH * HEIGHT**3)
    assert fields["stress"][:, 0] == pytest.approx(expected, abs=3e-3 * AT_ROOT)
    assert fields["von_mises"].max() == pytest.approx(float(rows[0]["beam_stress"]), rel=1e-5)
    page = (tmp_path / "bent/bent.html").read_text()
    assert '"stress":' in page and "Stress of von Mises" in page


STRESSES = """[outputs.node]
kind = "stress"
marker = "beam.spot"
[outputs.end]
kind = "stress"
marker = "beam.tip"
"""


def test_stresses_at_markers_are_those_of_the_fields(tmp_path: Path) -> None:
    """The functions of the model compute them: at a node, and the mean over the area of a set of nodes."""
    beam = cantilever(0.3)
    spot = int(np.flatnonzero((beam.solid.x[:, 0] > 0.1) & (beam.solid.x[:, 2] > 0.004))[0])
    path = scene_file(beam, tmp_path, f"markers.spot = {spot}")
    path.write_text(path.read_text().replace("[joints.clamp]", f"{STRESSES}[joints.clamp]"))
    spec = derive.read(path)
    run = moved(spec)
    (body,) = field_bodies(run.spec, ["beam"])
    (fields,) = field_instants(body, run, np.array([-1]))
    assert fields.stresses is not None and fields.von_mises is not None
    components = [run[f"node_{label}"][-1] for label in ("xx", "yy", "zz", "xy", "yz", "xz")]
    assert components == pytest.approx(fields.stresses[spot], rel=1e-9)
    assert run["node_mises"][-1] == pytest.approx(fields.von_mises[spot], rel=1e-9) and run["node_mises"][-1] > 1e7
    products = area_products(beam.solid.mesh.elements, beam.solid.x, tuple(beam.tip))
    assert products is not None
    shares = products.sum(axis=0) / products.sum()
    mean = shares @ fields.stresses[beam.tip]
    assert run["end_xz"][-1] == pytest.approx(mean[5], rel=1e-9)
    assert isinstance(spec, derive.SpatialScene)
    looped = moved(replace(spec, lowering="instances"))
    assert looped.model.lowering == "instances"
    for name in ("node_xx", "node_mises", "end_xz"):
        assert looped[name] == pytest.approx(run[name], rel=1e-6, abs=1e-6 * abs(run[name]).max())


def test_stresses_of_bodies_without_elements_are_refused() -> None:
    rigid = {"mass": 1, "inertia": [1, 1, 1, 0, 0, 0], "markers": {"hub": [0, 0, 0]}}
    scene = derive.spatial_scene(
        "lump", bodies={"lump": rigid}, outputs={"s": {"kind": "stress", "marker": "lump.hub"}}
    )
    with pytest.raises(derive.SpecError, match=r"outputs\.s\.marker: stresses come from elements with"):
        derive.derive(scene)


def test_the_largest_stress_is_that_of_the_node() -> None:
    """Of a body alone: at each amplitude the largest of all nodes, in parts of the memory as at once."""
    beam = cantilever(0.3)
    x, mesh = beam.solid.x, beam.solid.mesh
    arrays = {"positions": x, "mass": np.ones(len(x)), **mesh_arrays(mesh)}
    bent = np.stack([x[:, 0] * x[:, 2], 0 * x[:, 0], -(x[:, 0] ** 2) / 2], axis=1)
    stretched = np.stack([x[:, 0], -0.3 * x[:, 1], -0.3 * x[:, 2]], axis=1)
    arrays |= {"modes": np.array([bent, stretched]), "modal_stiffness": np.eye(2)}
    body = derive.nodal_body("beam", arrays, units="SI", orthonormal=False)
    modal = modal_stresses(body)
    assert von_mises(modal[1]) == pytest.approx(YOUNG)
    amplitudes = np.array([[1.0, 0.0], [0.0, 1e-3], [1.0, 1e-3], [-2.0, 3e-3]])
    values, nodes = largest_stress(body, amplitudes)
    every = von_mises(np.tensordot(amplitudes, modal, axes=1))
    assert values == pytest.approx(every.max(axis=1)) and nodes.tolist() == every.argmax(axis=1).tolist()
    assert values[1] == pytest.approx(1e-3 * YOUNG)


def test_the_player_has_the_stresses_of_the_surface() -> None:
    """In steps of a five thousandth of the largest of each mode, from which the page computes von Mises' stress."""
    beam = cantilever(0.3)
    x, mesh = beam.solid.x, beam.solid.mesh
    bent = np.stack([x[:, 0] * x[:, 2], 0 * x[:, 0], -(x[:, 0] ** 2) / 2], axis=1)
    arrays = {"positions": x, "mass": np.ones(len(x)), **mesh_arrays(mesh)}
    arrays |= {"modes": np.array([bent]), "modal_stiffness": np.eye(1)}
    body = derive.nodal_body("beam", arrays, units="SI", orthonormal=False, markers={"tip": beam.tip[0]})
    q = np.array([[0, 0, 0, 1, 0, 0, 0, 0.0], [0, 0, 0, 1, 0, 0, 0, 2e-3]])
    data = spatial_player_data(body, np.array([0.0, 1.0]), q)
    (drawn,) = data["bodies"]
    (mode,) = drawn["stresses"]
    stresses = mode["step"] * np.array(mode["values"]).reshape(-1, 6)
    assert len(stresses) == len(drawn["nodes"]) - 1  # all but the marker
    assert 2e-3 * von_mises(stresses).max() == pytest.approx(largest_stress(body, q[:, 7:])[0][1], rel=1e-3)
    assert data["stress"] == pytest.approx(2e-3 * von_mises(stresses).max(), rel=1e-3)


def test_what_stresses_need_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = scene_file(cantilever(0.0), tmp_path)
    assert main(["simulate", str(path), "--out", str(tmp_path), "--fields", "bean"]) == 2
    assert 'there is no body with elements called "bean"; did you mean "beam"?' in capsys.readouterr().err
    with np.load(tmp_path / "beam.npz") as file:
        kept = {key: file[key] for key in file.files if "material" not in key}
    np.savez(tmp_path / "beam.npz", **kept)
    assert main(["simulate", str(path), "--out", str(tmp_path)]) == 2
    assert "bodies.beam.stress: stresses are computed from elements with Young's modulus" in capsys.readouterr().err


def test_the_plot_of_stresses_has_a_name_of_its_own() -> None:
    """A scene may have an output that is called stress."""
    scene = derive.spatial_scene(
        "one",
        bodies={"ball": {"mass": 1, "inertia": [1, 1, 1, 0, 0, 0], "markers": {"end": [1, 0, 0]}}},
        outputs={"stress": {"kind": "position", "marker": "ball.end"}},
    )
    plots = default_plots(scene, derive.lower(derive.derive(scene)), ("ball_stress",))
    assert [plot.name for plot in plots] == ["stress", "stress_of_bodies"]
