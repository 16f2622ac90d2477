"""Visuals of rigid bodies: files of meshes, their faults, what pictures show of them, and that no model has them."""

from __future__ import annotations

import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import derive
from derive.backends.model_files import fingerprint
from derive.errors import SpecError
from derive.simulation.observables.spatial_player_data import bodies_data
from derive.simulation.observables.spatial_scene_player import drawn_bodies
from derive.simulation.observables.visual_surfaces import visual_surfaces
from derive.spec.construction.validated import validated
from derive.spec.files.meshes import mesh_file
from derive.spec.model.visuals import Mesh
from derive.visual.spatial_scene_picture import undeformed_picture

POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]])
TRIANGLES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
BODY = 'name = "top"\n[bodies.top]\nmass = 1\ninertia = [1, 1, 1, 0, 0, 0]\nmarkers = { tip = [0, 0, 1] }\n'


def binary(corners: np.ndarray, head: bytes = b"solid, as some programs write") -> bytes:
    triangles = (struct.pack("<12fH", 0, 0, 0, *triangle.ravel(), 0) for triangle in corners)
    return head.ljust(80) + struct.pack("<I", len(corners)) + b"".join(triangles)


def text(corners: np.ndarray) -> bytes:
    lines = (f"  vertex {x!r} {y!r} {z!r}" for x, y, z in corners.reshape(-1, 3).tolist())
    return "\n".join(["solid tetrahedron", " facet", *lines, "endsolid"]).encode()


def wavefront() -> bytes:
    """The faces by numbers from the first point, and from the last one back; two are one quadrilateral."""
    points = "".join(f"v {x} {y} {z}\n" for x, y, z in POINTS)
    return f"# OBJ\n{points}vn 0 0 1\nf 1/1/1 3//1 2\nf -4 -3 -1\nf 4 2 3 1\n".encode()


def ball(n: int) -> np.ndarray:
    """The corners (2 n^2, 3, 3) of triangles on a sphere of radius 1."""
    a, b = np.meshgrid(np.linspace(0, np.pi, n + 1), np.linspace(0, 2 * np.pi, n + 1), indexing="ij")
    x = np.stack([np.sin(a) * np.cos(b), np.sin(a) * np.sin(b), np.cos(a)], axis=2)
    lower, upper = (x[:-1, :-1], x[1:, :-1], x[1:, 1:]), (x[:-1, :-1], x[1:, 1:], x[:-1, 1:])
    return np.concatenate([np.stack(part, axis=2).reshape(-1, 3, 3) for part in (lower, upper)])


@pytest.mark.parametrize(
    ("name", "content"),
    [("a.stl", binary(POINTS[TRIANGLES])), ("a.STL", text(POINTS[TRIANGLES])), ("a.obj", wavefront())],
)
def test_a_mesh_is_where_its_body_is(name: str, content: bytes, tmp_path: Path) -> None:
    """Scaled, then turned about e3, then displaced, in all formats, with the marker of the body behind its points."""
    (tmp_path / name).write_bytes(content)
    keys = "at = [5, 0, 0], rotation = { axis = [0, 0, 1], angle = 1.5707963267948966 }, scale = [1, 2, 1]"
    (tmp_path / "top.toml").write_text(f'{BODY}visuals = [{{ mesh = "{name}", {keys} }}]\n')
    (body,) = drawn_bodies(derive.read(tmp_path / "top.toml"))  # type: ignore[arg-type]
    corners = {tuple(x) for x in np.round(body.x[:4], 9) + 0.0}
    assert corners == {(5, 0, 0), (5, 1, 0), (1, 0, 0), (5, 0, 3)}
    assert len(body.surface.faces) == 4 and body.markers == (("tip", 4),) and body.triangles == (4, 4)


def test_all_faults_of_files_and_sizes_have_lines(tmp_path: Path) -> None:
    files = {
        "cut.stl": binary(POINTS[TRIANGLES])[:-1],
        "empty.stl": binary(POINTS[[]]),
        "nan.stl": binary(POINTS[TRIANGLES] * np.nan),
        "word.stl": text(POINTS[TRIANGLES]).replace(b"2.0", b"two"),
        "face.obj": wavefront() + b"f 1 2 9\n",
    }
    for name, content in files.items():
        (tmp_path / name).write_bytes(content)
    tables = [
        *(f'mesh = "{name}"' for name in (*files, "none.stl", "model.ply")),
        "box = [1, 1, 1], sphere = 2",
        "at = [1, 1, 1]",
        "cylinder = [1, 0]",
        "sphere = 1, scale = [2, 2, 2]",
    ]
    lines = "".join(f"  {{ {table} }},\n" for table in tables)
    (tmp_path / "top.toml").write_text(f"{BODY}visuals = [\n{lines}]\n")
    with pytest.raises(SpecError) as caught:
        derive.read(tmp_path / "top.toml")
    messages = {problem.line: problem.message for problem in caught.value.problems}
    for line, message in enumerate(
        (
            '"cut.stl" is no STL file, or ends before its triangles do',
            '"empty.stl" has no triangles',
            '"nan.stl" has a point with a coordinate that is no number',
            'line 4 of "word.stl": three numbers are needed',
            'line 10 of "face.obj": a face needs the numbers of points, from 1 to 4 here',
            'the file "none.stl" cannot be read',
            '"model.ply" is no .stl or .obj or .dae file',
            "a visual is one of mesh, box, cylinder, sphere, and not box and sphere",
            "a visual is one of mesh, box, cylinder, sphere, such as",
            "the sizes of a cylinder are positive",
            "`scale` has the factors of a mesh",
        ),
        7,
    ):
        assert message in messages[line]


def test_large_meshes_become_coarser_and_keep_their_form(tmp_path: Path) -> None:
    """Two balls share a number of triangles; where there are more bodies than triangles, boxes stand for meshes."""
    (tmp_path / "ball.stl").write_bytes(binary(ball(60)))
    mesh = mesh_file("ball.stl", tmp_path)
    assert mesh.count == 7200 and len(mesh.triangles) == 7080  # without those that are lines at the poles
    one, two = visual_surfaces([[derive.Visual(mesh=mesh)], [derive.Visual(mesh=mesh)]], 3000)
    assert 500 < len(one.faces) == len(two.faces) <= 1500
    radii = np.linalg.norm(one.x, axis=1)
    assert radii.min() > 0.97 and radii.max() < 1.001
    assert one.triangles == (len(one.faces), 7200)
    (boxed,) = visual_surfaces([[derive.Visual(mesh=mesh)]], 5)
    np.testing.assert_allclose(np.abs(boxed.x), 1, atol=5e-3)
    assert len(boxed.faces) == 6


@pytest.mark.parametrize(
    ("visual", "volume"),
    [
        (derive.Visual(box=(1, 2, 3), at=(1, 2, 3), rotation=(0.6, 0, 0.8, 0)), 6),
        (derive.Visual(cylinder=(2, 3)), 12 * np.pi),
        (derive.Visual(sphere=2), 32 / 3 * np.pi),
    ],
)
def test_forms_have_their_sizes(visual: derive.Visual, volume: float) -> None:
    """The volume of the hull of their points about their middle, up to that of a polygon of 24 sides."""
    from scipy.spatial import ConvexHull

    (of,) = visual_surfaces([[visual]], 1)
    assert {i for face in of.faces for i in face} == {*range(len(of.x))}
    assert ConvexHull(of.x).volume == pytest.approx(volume, rel=0.04)
    np.testing.assert_allclose(of.x.mean(axis=0), visual.at, atol=1e-12)


def test_models_have_no_visuals_and_pictures_have(tmp_path: Path) -> None:
    """The same model with and without them; in pictures faces without edges in place of the box, and no lines."""
    (tmp_path / "ball.stl").write_bytes(binary(ball(4)))
    (tmp_path / "top.toml").write_text(f'{BODY}visuals = [{{ mesh = "ball.stl" }}, {{ sphere = 0.1 }}]\n')
    scene = derive.read(tmp_path / "top.toml")
    assert isinstance(scene, derive.SpatialScene)
    (top,) = scene.bodies
    assert isinstance(top, derive.SpatialRigidBody) and isinstance(top.visuals[0].mesh, Mesh)
    bare = replace(scene, bodies=(replace(top, visuals=()),))
    assert fingerprint(scene) == fingerprint(bare)
    assert validated(scene) == scene != bare
    data = bodies_data(drawn_bodies(scene))
    assert data["bodies"][0]["smooth"] and not data["bodies"][0]["links"] and data["triangles"] == [24, 32]
    assert 'class="s7"' in undeformed_picture(scene) and 'class="link"' not in undeformed_picture(scene)
    assert 'class="link"' in undeformed_picture(bare)
    assert drawn_bodies(scene, 0)[0].surface == drawn_bodies(bare)[0].surface
