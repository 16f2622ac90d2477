"""Meshes of triangles in STL, OBJ and Collada files, for pictures; none of them is trusted."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

from derive.errors import quoted
from derive.spec.files.collada import collada
from derive.spec.files.file_content import file_content
from derive.spec.model.visuals import Mesh
from derive.spec.parsing.faults import Faults, KeyPath
from derive.spec.parsing.values import WrongValueError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

MAX_BYTES = 50_000_000
KEPT = 20_000
"""The largest number of triangles that a specification has of a file, so that its copies are small."""
HEAD = 4000
"""The bytes in which the first triangle of an STL file as text begins."""
LARGEST = 1e9
"""The largest absolute value of a coordinate, m."""

Arrays = tuple["NDArray[np.float64]", "NDArray[np.int64]"]
"""The points (n, 3) and the numbers of the corners (m, 3) of triangles."""


def with_meshes(data: Mapping[str, Any], folder: Path) -> tuple[Mapping[str, Any], Faults]:
    """The data of a scene in which the names of files with meshes are replaced by the meshes, with their faults.

    Files are relative to `folder`, and each is read once.
    """
    faults, known = Faults(), dict[str, Mesh]()

    def with_read(table: Any, path: KeyPath) -> Any:
        """A table with the meshes of its visuals."""
        visuals = table.get("visuals") if isinstance(table, Mapping) else None
        if not isinstance(visuals, (list, tuple)):
            return table
        return {**table, "visuals": [read(visual, (*path, "visuals", k)) for k, visual in enumerate(visuals)]}

    def read(visual: Any, path: KeyPath) -> Any:
        """A visual with its mesh, if it has one that can be read."""
        file = visual.get("mesh") if isinstance(visual, Mapping) else None
        if not isinstance(file, str) or not file:
            return visual
        with faults.at(*path, "mesh"):
            known[file] = known.get(file) or mesh_file(file, folder)
        return {**visual, "mesh": known.get(file, file)}

    changed: dict[str, Any] = {}
    if "ground" in data:
        changed["ground"] = with_read(data["ground"], ("ground",))
    if isinstance(bodies := data.get("bodies"), Mapping):
        changed["bodies"] = {name: with_read(body, ("bodies", str(name))) for name, body in bodies.items()}
    return {**data, **changed}, faults


def mesh_file(name: str, folder: Path) -> Mesh:
    """The mesh of a file, which is simplified where it has more than KEPT triangles. Raises WrongValueError."""
    from derive.spec.files.mesh_clusters import at_most

    reader = READERS.get(Path(name).suffix.lower())
    if reader is None:
        raise WrongValueError(f"{quoted(name)} is no {' or '.join(READERS)} file, which are those that are read")
    content = file_content(name, folder, MAX_BYTES, ", the most that is read")
    points, triangles = _checked(*reader(content, quoted(name)), quoted(name))
    return Mesh(name, hashlib.sha256(content).hexdigest(), len(triangles), *at_most(points, triangles, KEPT))


def _checked(points: Any, triangles: Any, file: str) -> Arrays:
    """Triangles as arrays. Raises WrongValueError where there are none, or where they have corners of no use."""
    import numpy as np  # not for specifications without meshes

    points = np.asarray(points, dtype=float).reshape(-1, 3)
    triangles = np.asarray(triangles, dtype=np.int64).reshape(-1, 3)
    if not len(triangles):
        raise WrongValueError(f"{file} has no triangles")
    if not (np.abs(points) <= LARGEST).all():
        raise WrongValueError(f"{file} has a point with a coordinate that is no number up to {LARGEST:g}")
    if triangles.min() < 0 or triangles.max() >= len(points):
        raise WrongValueError(f"{file} has a triangle with a point that does not exist; it has {len(points)} points")
    return points, triangles


def _stl(content: bytes, file: str) -> Arrays:
    """The triangles of an STL file, binary or as text, of which both may begin with `solid`."""
    import numpy as np

    count = int.from_bytes(content[80:84], "little")
    if len(content) != 84 + 50 * count and b"facet" in content[:HEAD]:
        return _stl_text(content, file)
    if len(content) < 84 or len(content) < 84 + 50 * count:
        raise WrongValueError(f"{file} is no STL file, or ends before its triangles do")
    triangle = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    corners = np.frombuffer(content, triangle, count, 84)["corners"].astype(float)
    return corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)


def _stl_text(content: bytes, file: str) -> Arrays:
    """The triangles of an STL file as text: three lines that begin with `vertex` each."""
    import numpy as np

    words = ((number, line.split()) for number, line in enumerate(content.splitlines(), 1))
    corners = [_numbers(line, number, file) for number, line in words if line and line[0].lower() == b"vertex"]
    if len(corners) % 3:
        raise WrongValueError(f"{file} has {len(corners)} corners of triangles, which is no multiple of three")
    return np.array(corners), np.arange(len(corners)).reshape(-1, 3)


def _obj(content: bytes, file: str) -> Arrays:
    """The faces of an OBJ file as triangles about their first corners."""
    import numpy as np

    points: list[list[float]] = []
    triangles: list[list[int]] = []
    for number, line in enumerate(content.splitlines(), 1):
        words = line.split()
        if words and words[0] == b"v":
            points.append(_numbers(words, number, file))
        elif words and words[0] == b"f":
            corners = [_corner(word, len(points), number, file) for word in words[1:]]
            triangles += ([corners[0], b, c] for b, c in pairwise(corners[1:]))
    return np.array(points), np.array(triangles, dtype=np.int64)


def _numbers(words: list[bytes], line: int, file: str) -> list[float]:
    """The three numbers behind the first word of a line."""
    try:
        x, y, z = map(float, words[1:4])
    except ValueError:
        raise WrongValueError(f"line {line} of {file}: three numbers are needed") from None
    return [x, y, z]


def _corner(word: bytes, points: int, line: int, file: str) -> int:
    """The number, from 0, of the point of a corner such as 7, 7/1/2 or -1, which is the last point so far."""
    try:
        number = int(word.split(b"/")[0])
    except ValueError:
        number = 0
    if not 0 < abs(number) <= points:
        raise WrongValueError(f"line {line} of {file}: a face needs the numbers of points, from 1 to {points} here")
    return number - 1 if number > 0 else points + number


READERS = {".stl": _stl, ".obj": _obj, ".dae": collada}
"""The readers of meshes by the endings of their files."""
