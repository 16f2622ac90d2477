"""The surfaces of what pictures show of rigid bodies: boxes, cylinders, spheres, and meshes of few enough triangles."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from derive.simulation.configurations import rotation_matrix
from derive.simulation.observables.body_surface import Face
from derive.simulation.observables.motion import Array
from derive.spec.files.mesh_clusters import clustered
from derive.spec.model.visuals import Mesh, Visual

BOX_FACES = ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5))
"""The faces of a box by its corners, whose three binary digits say which end of each axis they are at."""
AROUND = 24
"""The number of sides of a cylinder, and of a sphere at its equator."""
FINEST, COARSEST = 256.0, 4.0
"""The numbers of cells along a mesh between which there is one of few enough triangles."""

Faces = Sequence[Sequence[int]]


@dataclass(frozen=True, eq=False)
class VisualSurface:
    """The points x (n, 3), m, in the frame of a body, and the faces of its visuals.

    triangles: how many faces are those of meshes, and how many triangles the files of these have.
    """

    x: Array
    faces: tuple[Face, ...]
    triangles: tuple[int, int]


def visual_surfaces(bodies: Iterable[Sequence[Visual]], most: int) -> list[VisualSurface]:
    """The surfaces of the visuals of bodies, whose meshes have at most so many triangles together.

    All meshes become coarser, each against its own size, until they have no more; where that does not suffice, the
    boxes around them are shown.
    """
    bodies = list(bodies)
    uses = [visual.mesh for visuals in bodies for visual in visuals if isinstance(visual.mesh, Mesh)]
    drawn = {mesh: (mesh.points, mesh.triangles) for mesh in uses}
    cells = FINEST
    while (many := sum(len(drawn[mesh][1]) for mesh in uses) > most) and cells >= COARSEST:
        drawn = {mesh: clustered(*drawn[mesh], _size(mesh) / cells) for mesh in drawn}
        cells /= 2**0.5
    shown: Mapping[Mesh, tuple[Array, Faces]] = {
        mesh: (box(mesh.points.min(axis=0), mesh.points.max(axis=0)), BOX_FACES)
        if many or not len(triangles)
        else (points, triangles.tolist())
        for mesh, (points, triangles) in drawn.items()
    }
    return [_joined(visuals, shown) for visuals in bodies]


def _size(mesh: Mesh) -> float:
    return float(np.ptp(mesh.points, axis=0).max()) or 1.0


def _joined(visuals: Sequence[Visual], shown: Mapping[Mesh, tuple[Array, Faces]]) -> VisualSurface:
    """The surface of all visuals of a body."""
    x, faces, triangles = [np.zeros((0, 3))], list[Face](), np.zeros(2, dtype=int)
    first = 0
    for visual in visuals:
        points, own = shown[visual.mesh] if isinstance(visual.mesh, Mesh) else _form(visual)
        x.append(np.array(visual.at) + (points * visual.scale) @ rotation_matrix(np.array(visual.rotation)).T)
        faces += (tuple(first + i for i in face) for face in own)
        first += len(points)
        triangles += (len(own), visual.mesh.count) if isinstance(visual.mesh, Mesh) else (0, 0)
    return VisualSurface(np.concatenate(x), tuple(faces), (int(triangles[0]), int(triangles[1])))


def _form(visual: Visual) -> tuple[Array, Faces]:
    """The points and the faces of a box, a cylinder or a sphere in its own frame."""
    if visual.box is not None:
        half = np.array(visual.box) / 2
        return box(-half, half), BOX_FACES
    if visual.cylinder is not None:
        radius, length = visual.cylinder
        rings = [(radius, -length / 2), (radius, length / 2)]
    else:
        assert visual.sphere is not None
        latitudes = np.linspace(-np.pi / 2, np.pi / 2, AROUND // 2 + 1)[1:-1]
        rings = [(visual.sphere * np.cos(a), visual.sphere * np.sin(a)) for a in latitudes]
    angles = np.arange(AROUND) * 2 * np.pi / AROUND
    x = np.array([(r * np.cos(a), r * np.sin(a), z) for r, z in rings for a in angles])
    sides = [
        (i * AROUND + k, i * AROUND + n, (i + 1) * AROUND + n, (i + 1) * AROUND + k)
        for i in range(len(rings) - 1)
        for k, n in zip(range(AROUND), (*range(1, AROUND), 0), strict=True)
    ]
    return x, [(*range(AROUND - 1, -1, -1),), *sides, (*range(len(x) - AROUND, len(x)),)]


def box(low: Array, high: Array) -> Array:
    """The corners (8, 3) of a box, in the order of BOX_FACES."""
    bits = np.array([bits[::-1] for bits in product((0, 1), repeat=3)])
    corners: Array = np.where(bits, high, low)
    return corners
