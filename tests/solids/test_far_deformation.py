"""The note of a run on a finite-element body of second order that deforms far."""

from __future__ import annotations

import pytest
from assembled import assembled
from grid_meshes import box_mesh

import derive
from derive.solids.stresses import IntegratedMesh
from derive.spec.files.mesh_arrays import mesh_arrays
from derive.spec.model.mesh import ElementKind, Material


@pytest.mark.parametrize(("amplitude", "noted"), [(0.004, True), (0.001, False)])
def test_a_bar_that_starts_far_bent(amplitude: float, noted: bool) -> None:
    """Its ends are a tenth or a fortieth of its length beside its mean axis, and the error grows with the square."""
    x, mesh = box_mesh(ElementKind.HEX20, (0.2, 0.01, 0.01), (4, 1, 1), material=Material("steel", 210e9, 0.3, 7850.0))
    mass, stiffness = assembled(IntegratedMesh(mesh, x, full=True))
    nodes = {"positions": x, "mass": mass, "stiffness": stiffness, **mesh_arrays(mesh)}
    bar = {"nodes": nodes, "units": "SI", "modes": 1, "order": 2, "start": {"amplitudes": [amplitude]}}
    run = derive.simulate(derive.spatial_scene("bar", bodies={"bar": bar}), duration=2e-4, output=5e-5)
    told = [note for note in run.notes if "third order" in note]
    assert len(told) == noted and all("bar: it deforms by up to 10 % of its size" in note for note in told)
