"""Meshes in Collada files: triangles of the geometries that a scene places, in metres; errors name their lines."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from derive.spec.files.meshes import mesh_file
from derive.spec.parsing.values import WrongValueError

QUAD = """<geometry id="quad"><mesh>
<source id="x"><float_array id="xa" count="16">0 0 0 9 1 0 0 9 1 1 0 9 0 1 0 9</float_array>
<technique_common><accessor source="#xa" count="4" stride="4"/></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#x"/></vertices>
FACES
</mesh></geometry>"""
INPUTS = '<input semantic="NORMAL" source="#x" offset="0"/><input semantic="VERTEX" source="#v" offset="1"/>'
SCENE = """<library_visual_scenes><visual_scene id="s">NODES</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene>"""
PLACED = '<instance_geometry url="#quad"/>'
FACES = {
    "polylist": f"<polylist count='1'>{INPUTS}<vcount>4</vcount><p>0 0 0 1 0 2 0 3</p></polylist>",
    "triangles": f"<triangles count='2'>{INPUTS}<p>0 0 0 1 0 2 0 0 0 2 0 3</p></triangles>",
    "polygons": f"<polygons count='1'>{INPUTS}<p>0 0 0 1 0 2 0 3</p></polygons>",
}


def document(faces: str = FACES["polylist"], nodes: str = "", unit: str = "") -> str:
    scene = SCENE.replace("NODES", nodes) if nodes else ""
    geometry = QUAD.replace("FACES", faces)
    return f"<COLLADA><asset>{unit}</asset><library_geometries>{geometry}</library_geometries>{scene}</COLLADA>"


@pytest.fixture
def corners(tmp_path: Path):  # type: ignore[no-untyped-def]
    """The corners (m, 3, 3) of the triangles of a document."""

    def of(text: str) -> np.ndarray:
        (tmp_path / "part.dae").write_text(text)
        mesh = mesh_file("part.dae", tmp_path)
        return np.asarray(mesh.points)[np.asarray(mesh.triangles)]

    return of


@pytest.mark.parametrize("kind", FACES)
def test_faces_become_triangles(corners, kind: str) -> None:  # type: ignore[no-untyped-def]
    """A square in two; the numbers of normals and the fourth numbers of points are skipped."""
    expected = [[(0, 0, 0), (1, 0, 0), (1, 1, 0)], [(0, 0, 0), (1, 1, 0), (0, 1, 0)]]
    np.testing.assert_array_equal(corners(document(FACES[kind])), expected)


def test_nodes_place_geometries(corners) -> None:  # type: ignore[no-untyped-def]
    """Transforms from the outside to the inside, in the unit of the file; the axis that it calls up turns nothing."""
    inner = f'<node id="n"><scale>2 1 1</scale>{PLACED}</node>'
    nodes = f"""<node><translate>10 0 0</translate><rotate>0 0 1 90</rotate>{inner}</node>
    <node><matrix>1 0 0 0 0 0 -1 5 0 1 0 0 0 0 0 1</matrix><instance_node url="#n"/></node>"""
    unit = '<unit meter="0.1"/><up_axis>Y_UP</up_axis>'
    found = corners(document(nodes=nodes, unit=unit))
    assert len(found) == 4
    np.testing.assert_allclose(found[0], [(1, 0, 0), (1, 0.2, 0), (0.9, 0.2, 0)], atol=1e-15)
    np.testing.assert_allclose(found[2], [(0, 0.5, 0), (0.2, 0.5, 0), (0.2, 0.5, 0.1)], atol=1e-15)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("solid", 'part.dae" cannot be read in line 1: this is no XML'),
        ('<!DOCTYPE x [<!ENTITY e SYSTEM "/etc/passwd">]><COLLADA>&e;</COLLADA>', "a document type"),
        ("<COLLADA/>", "has no triangles"),
        (document(FACES["polylist"].replace("<vcount>4", "<vcount>5")), "has 4 corners, and its faces need 5"),
        (document(FACES["polylist"].replace("0 3<", "0 9<")), "a triangle with a point that does not exist"),
        (document(FACES["polylist"].replace("0 3<", "0 x<")), 'line 5 of "part.dae": <p> needs numbers'),
        (document(FACES["polylist"].replace("#v", "#w")), "needs the name of an element of this file in source"),
        (document("<tristrips/>"), "<tristrips> is not read; write <triangles>"),
        (document(nodes="<node><scale>1 2</scale></node>"), "<scale> needs 3 numbers"),
        (document(nodes=f'<node id="n">{PLACED}<instance_node url="#n"/></node>'), "nested more than 100 deep"),
        (document().replace('stride="4"', 'stride="5"'), "points of three coordinates are needed"),
    ],
)
def test_what_is_wrong_has_a_line(corners, text: str, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(WrongValueError) as caught:
        corners(text)
    assert message in str(caught.value)
