"""Loads on nodes of finite-element bodies: generalised forces on a free body, inputs, faults, texts written back."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import derive
from conftest import QUICK
from derive.cli.main import main
from derive.generated_models import generated_explicit
from derive.report.sections.mechanism import joint_blocks
from derive.runtime.compiler import ESSENTIAL
from derive.runtime.loading import load_scene
from derive.spec.toml.read import parse

LOAD = 'nodes = [0, 2], forces = [[3, 0, -1], [-2, 4, 0]], time = { input = "pull" }, frame = "body"'
SCENE = """
name = "nodal_loads"
[bodies.truss]
nodes = "FOLDER/truss.npz"
units = "SI"
frame = "given"
orthonormal = false
start = { rotation = { axis = [1, 2, 3], angle = 0.8 } }
[bodies.truss.loads]
push = { LOAD }
[inputs.pull]
value = "2*t"
[simulation]
duration = 1
output = 1
"""


def scene(folder: Path, load: str = LOAD) -> str:
    rng = np.random.default_rng(3)
    x = rng.uniform(-1, 1, (5, 3))
    mass = rng.uniform(1, 2, 5)
    np.savez(
        folder / "truss.npz",
        positions=x,
        mass=mass,
        modes=rng.uniform(-1, 1, (2, 5, 3)),
        modal_stiffness=np.diag([30.0, 50.0]),
    )
    return SCENE.replace("FOLDER", str(folder)).replace("LOAD", load)


def test_generalised_forces_are_those_of_the_nodes(tmp_path: Path) -> None:
    native = load_scene(generated_explicit(parse(scene(tmp_path)))[1], (*QUICK, *ESSENTIAL))
    data = np.load(tmp_path / "truss.npz")
    q, v = np.zeros(native.nq), np.zeros(native.nv)
    q[3:7] = np.array([0.5, -0.5, 0.7, 0.1])
    k = native.setup()
    loaded, free = (native.force(0.0, q, v, native.with_inputs(k, [u])) for u in (1.5, 0.0))
    w, a, b, c = q[3:7] = q[3:7] / np.linalg.norm(q[3:7])
    Q = np.array(
        [
            [1 - 2 * (b * b + c * c), 2 * (a * b - w * c), 2 * (a * c + w * b)],
            [2 * (a * b + w * c), 1 - 2 * (a * a + c * c), 2 * (b * c - w * a)],
            [2 * (a * c - w * b), 2 * (b * c + w * a), 1 - 2 * (a * a + b * b)],
        ]
    )
    forces = 1.5 * np.array([[3, 0, -1], [-2, 4, 0]])
    expected = np.concatenate(
        [
            Q @ forces.sum(axis=0),
            np.cross(data["positions"][[0, 2]], forces).sum(axis=0),
            np.einsum("nak,ak->n", data["modes"][:, [0, 2]], forces),
        ]
    )
    assert free - loaded == pytest.approx(expected, rel=1e-12)


def test_they_are_written_back(tmp_path: Path) -> None:
    spec = parse(scene(tmp_path))
    again = derive.validated(replace(spec, plots=()))
    assert again.bodies[0].loads == spec.bodies[0].loads
    (load,) = spec.bodies[0].loads
    assert load.forces == ((3, 0, -1), (-2, 4, 0)) and load.frame == "body"


@pytest.mark.parametrize(
    ("load", "message"),
    [
        ("nodes = [0, 5], forces = [[1, 0, 0]]", "there is no node 5: the nodes are 0 to 4"),
        ("nodes = [0, 1, 2], forces = [[1, 0, 0], [0, 1, 0]]", "there are 3 nodes and 2 forces"),
        ("nodes = [0, 0], forces = [[1, 0, 0]]", "a node is named twice"),
        ("nodes = [], forces = [[1, 0, 0]]", "a load acts on nodes"),
        ("nodes = [0], forces = [[0, 0, 0]]", "all forces of the load are zero"),
        ("nodes = [0], forces = [[0, 1]]", "a list of 3 components is needed"),
    ],
)
def test_faults(load: str, message: str, tmp_path: Path) -> None:
    text = scene(tmp_path, load).replace('[inputs.pull]\nvalue = "2*t"\n', "")
    with pytest.raises(derive.SpecError, match=message) as caught:
        parse(text)
    assert len(str(caught.value).splitlines()) == 1


FORCES = "node, x, y, z\n# a comment\n0, 3, 0, -1.25e0\n2, -2, 4, 0\n"


def test_forces_of_a_file_are_those_of_lists(tmp_path: Path) -> None:
    (tmp_path / "forces.csv").write_text(FORCES)
    listed = parse(scene(tmp_path, LOAD.replace("-1]", '"-5/4"]')))
    read = parse(scene(tmp_path, f'file = "{tmp_path}/forces.csv", time = {{ input = "pull" }}, frame = "body"'))
    assert read.bodies[0].loads == listed.bodies[0].loads
    assert derive.validated(replace(read, plots=())).bodies[0].loads == listed.bodies[0].loads


def test_forces_of_arrays_are_those_of_lists(tmp_path: Path) -> None:
    np.savez(tmp_path / "forces.npz", nodes=[0, 2], forces=[[3, 0, -1.25], [-2, 4, 0.1]])
    listed = "nodes = [0, 2], forces = [[3, 0, -1.25], [-2, 4, 0.1]]"
    read = f'file = "{tmp_path}/forces.npz"'
    loads = [parse(scene(tmp_path, f'{of}, time = {{ input = "pull" }}')).bodies[0].loads for of in (listed, read)]
    assert loads[0] == loads[1] and loads[0][0].forces[1][2] == Fraction(1, 10)


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"nodes": [0]}, 'has no array "forces"; it needs nodes'),
        ({"nodes": [0], "forces": [[1.0, 2.0]]}, r"forces in .* are float64 \(1, 2\); numbers \(1, 3\) are needed"),
        ({"nodes": [0.5], "forces": [[1, 2, 3]]}, r"nodes in .* are float64 \(1,\); whole numbers"),
        ({"nodes": [-1], "forces": [[1, 2, 3]]}, "-1 is no number of a node; nodes count from 0"),
        ({"nodes": [0], "forces": [[1, 2, np.nan]]}, "have a component that is no finite number"),
        ({"nodes": [7], "forces": [[1, 2, 3]]}, "there is no node 7: the nodes are 0 to 4"),
        ({"nodes": [0], "forces": [[1, 2, 3]], "force": [0]}, "force: unknown key"),
        ({"nodes": [0], "forces": np.array([[print, 2, 3]])}, "forces: this holds Python objects, which are not read"),
        (b"PK but no archive", "is no .npz file$"),
    ],
)
def test_faults_of_arrays(arrays: dict[str, Any] | bytes, message: str, tmp_path: Path) -> None:
    if isinstance(arrays, bytes):
        (tmp_path / "forces.npz").write_bytes(arrays)
    else:
        np.savez(tmp_path / "forces.npz", **arrays)
    text = scene(tmp_path, f'file = "{tmp_path}/forces.npz"').replace('[inputs.pull]\nvalue = "2*t"\n', "")
    with pytest.raises(derive.SpecError, match=message) as caught:
        parse(text)
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("node, x, y\n0, 1, 2\n", 'has no column "z"; its columns are "node", "x", "y"'),
        ("node, x, y, z\n", "has no forces: a line with the names of the columns and a row is needed"),
        ("node, x, y, z\n0, 1, 2, nan\n", 'line 2 of ".*": "nan" is no finite number'),
        ("node, x, y, z\n1.5, 1, 2, 3\n", 'line 2 of ".*": 1.5 is no number of a node'),
        ("node, x, y, z\n-1, 1, 2, 3\n", "-1 is no number of a node; nodes count from 0"),
        ("node, x, y, z\n7, 1, 2, 3\n", "there is no node 7: the nodes are 0 to 4"),
        ("node, x, y, z\n1, 1, 2, 3\n1, 1, 2, 3\n", "a node is named twice"),
        ("node, x, y, z\n" + 20_001 * "1, 1, 2, 3\n", "has 20001 nodes, and at most 20000 are read"),
        (None, "cannot be read: no such file or directory"),
    ],
)
def test_faults_of_files(content: str | None, message: str, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / "forces.csv").write_text(content)
    text = scene(tmp_path, f'file = "{tmp_path}/forces.csv"').replace('[inputs.pull]\nvalue = "2*t"\n', "")
    with pytest.raises(derive.SpecError, match=message) as caught:
        parse(text)
    assert len(str(caught.value).splitlines()) == 1


def test_a_file_stands_in_place_of_lists(tmp_path: Path) -> None:
    (tmp_path / "forces.csv").write_text(FORCES)
    with pytest.raises(derive.SpecError, match=r"loads\.push\.file: the file has the nodes and the forces; leave"):
        parse(scene(tmp_path, f'{LOAD}, file = "{tmp_path}/forces.csv"'))


def test_the_report_lists_them(tmp_path: Path) -> None:
    spec = parse(scene(tmp_path))
    text = repr(joint_blocks(spec, derive.derive(spec).expanded()))
    for cell in ("push", "nodal forces", "2 nodes of truss, in sum [1, 4, -1] N in the body frame"):
        assert f"text=({cell!r},)" in text


def test_a_point_of_a_load_has_the_name_of_a_marker(tmp_path: Path) -> None:
    text = scene(tmp_path).replace("[inputs", "[bodies.truss.markers]\npush_1p = 3\n[inputs")
    with pytest.raises(derive.SpecError, match="a point of the load push is called like the marker push_1p"):
        parse(text)


def test_bodies_of_one_file_share_its_data(tmp_path: Path) -> None:
    text = scene(tmp_path)
    other = text[text.index("[bodies.truss]") : text.index("[inputs")].replace("bodies.truss", "bodies.other")
    spec = parse(text.replace("[inputs", f"{other}[inputs"))
    first, second = spec.bodies
    assert first.body.data is second.body.data
    mechanism = derive.derive(spec)
    assert [instance.kind for instance in mechanism.instances] == [0, 0]
    millimetres = other.replace('units = "SI"', 'units = { length = "mm", mass = "kg", time = "s" }')
    first, second = parse(text.replace("[inputs", f"{millimetres}[inputs")).bodies
    assert second.body.data.positions == pytest.approx(first.body.data.positions / 1000)


def test_a_run_names_its_flexible_bodies(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Its table says of them that they are, and of a scene without them that all bodies are rigid."""
    path = tmp_path / "scene.toml"
    path.write_text(scene(tmp_path))
    assert main(["simulate", str(path), "--duration", "0.001", "--output", "0.0005", "--out", str(tmp_path)]) == 0
    out = capsys.readouterr().out
    assert "  truss flexible " in out and "rigid" not in out
