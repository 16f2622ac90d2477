"""The files of `tisserand simulate --fields`: BODY.pvd beside the CSV, and its instants in the folder BODY_fields."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import PurePosixPath

from derive.artifacts import File
from derive.simulation.observables.fields import field_instants, instants
from derive.simulation.trajectory import Trajectory
from derive.spec.model.body import NodalBody
from derive.visual.vtk_files import pvd, vtu

SERIES = ".pvd"
BYTES_OF_A_NODE, BYTES_OF_A_CORNER = 70, 6
"""Of 13 compressed numbers at a node in base64, and of the number of a node of an element."""


def planned_fields(model: str, bodies: Sequence[NodalBody], rows: int, most: int) -> Iterator[str]:
    """The paths of the files of bodies in a run of so many rows."""
    for body in bodies:
        yield _series(model, body)
        yield from (_instant(model, body, i) for i in range(len(instants(rows, most))))


def expected_field_size(bodies: Sequence[NodalBody], rows: int, most: int) -> int:
    """The approximate size of these files, in bytes."""
    nodes = sum(len(body.data.positions) for body in bodies)
    corners = sum(block.nodes.size for body in bodies if body.data.mesh for block in body.data.mesh.elements)
    return len(instants(rows, most)) * (BYTES_OF_A_NODE * nodes + BYTES_OF_A_CORNER * corners)


def field_files(trajectory: Trajectory, bodies: Sequence[NodalBody], most: int) -> list[File]:
    """The files of bodies in a run, of at most so many instants."""
    files, model = [], trajectory.name
    rows = instants(len(trajectory.t), most)
    for body in bodies:
        assert body.data.mesh is not None, "field_bodies gives bodies with elements"
        series = []
        for i, fields in enumerate(field_instants(body, trajectory, rows)):
            path = _instant(model, body, i)
            files.append(File(path, vtu(body.data.mesh, fields)))
            series.append((fields.t, str(PurePosixPath(path).relative_to(model))))
        files.append(File(_series(model, body), pvd(series)))
    return files


def _series(model: str, body: NodalBody) -> str:
    return f"{model}/{body.name}{SERIES}"


def _instant(model: str, body: NodalBody, number: int) -> str:
    return f"{model}/{body.name}_fields/{number:04d}.vtu"
