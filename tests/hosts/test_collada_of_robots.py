"""Meshes of robots of others in Collada files have the sizes and places that Pinocchio reads."""

from __future__ import annotations

import numpy as np
import pytest
from programs import package
from test_urdf import robot_file

from derive.spec.files.collada import collada

pytestmark = pytest.mark.hosts

FILES = (
    "go1_description/meshes/depthCamera.dae",  # triangles, placed by a matrix
    "hyq_description/meshes/leg/hipassembly.dae",  # a list of polygons
    "hextilt_description/meshes/link_2.dae",  # of which y is said to be up
    "romeo_description/meshes/V1/visual/RWristYaw.dae",  # placed by rotations and scales
)


@pytest.mark.parametrize("name", FILES)
def test_boxes_around_meshes(name: str) -> None:
    pin, path = package("pinocchio"), robot_file(name)
    shape = f'<visual><geometry><mesh filename="{path}"/></geometry></visual>'
    text = f'<robot name="r"><link name="a">{shape}</link></robot>'
    (theirs,) = pin.buildGeomFromUrdfString(pin.buildModelFromXML(text), text, pin.GeometryType.VISUAL).geometryObjects
    theirs.geometry.computeLocalAABB()
    points, triangles = collada(path.read_bytes(), path.name)
    used = points[np.unique(triangles)]
    box = theirs.geometry.aabb_local
    assert abs(np.array([box.min_, box.max_]) - [used.min(axis=0), used.max(axis=0)]).max() < 1e-5 * np.ptp(used)
    assert theirs.geometry.num_tris == len(triangles)
