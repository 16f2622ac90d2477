"""A cantilever of bricks in a scene: held at a rigid set of nodes, and bent by a force in static equilibrium."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from assembled import assembled
from grid_meshes import box_mesh

from derive.solids.stresses import IntegratedMesh
from derive.spec.files.mesh_arrays import mesh_arrays
from derive.spec.model.mesh import ElementKind, Material

SIDES, FORCE = (0.5, 0.02, 0.01), 20.0
YOUNG, DENSITY = 70e9, 2700.0


@dataclass(frozen=True, eq=False)
class Cantilever:
    """The mesh with its nodes at x (nodes, 3), m, and the nodes of both ends."""

    solid: IntegratedMesh
    root: list[int]
    tip: list[int]


def cantilever(poisson: float) -> Cantilever:
    x, mesh = box_mesh(ElementKind.HEX20, SIDES, (10, 2, 1), material=Material("0", YOUNG, poisson, DENSITY))
    x = x - np.array([0, SIDES[1] / 2, SIDES[2] / 2])
    root, tip = (np.flatnonzero(np.abs(x[:, 0] - at) < 1e-9).tolist() for at in (0, SIDES[0]))
    return Cantilever(IntegratedMesh(mesh, x), root, tip)


def scene_file(beam: Cantilever, folder: Path, more: str = "") -> Path:
    """The specification of the scene, with its mesh beside it; `more` are further keys of the body."""
    mass, stiffness = (matrix.tocoo() for matrix in assembled(beam.solid))
    arrays: dict[str, Any] = {"positions": beam.solid.x, **mesh_arrays(beam.solid.mesh)}
    for name, matrix in (("mass", mass), ("stiffness", stiffness)):
        row, col = matrix.coords
        arrays |= {f"{name}_row": row, f"{name}_col": col, f"{name}_value": matrix.data}
    np.savez_compressed(folder / "beam.npz", **arrays)
    path = folder / "beam.toml"
    path.write_text(
        f"""
name = "bent"
[scene]
start = "equilibrium"
[ground.markers]
wall = [0, 0, 0]
[bodies.beam]
nodes = "beam.npz"
units = "SI"
modes = 6
interface = ["root", "tip"]
stress = true
{more}
markers.root = {{ nodes = {beam.root}, motion = "rigid" }}
markers.tip = {{ nodes = {beam.tip} }}
start = {{ position = [0.25, 0, 0], rotation = [1, 0, 0, 0] }}
[bodies.beam.loads.tip]
nodes = {beam.tip}
forces = [[0, 0, {FORCE / len(beam.tip)}]]
[joints.clamp]
kind = "fixed"
between = ["ground.wall", "beam.root"]
[simulation]
duration = 1e-5
output = 1e-5
"""
    )
    return path
