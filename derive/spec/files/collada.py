"""Meshes in Collada files (.dae): the triangles of the geometries that their scene places, in metres.

Read are <triangles>, <polylist> and <polygons>, the transforms of nodes, and the unit of length. The axis that a file
calls up is not: programs for robots place the numbers of a mesh as they are in the frame of its link.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from derive.errors import SpecError
from derive.spec.files.xml_tree import MAX_DEPTH, XmlElement, parse_xml
from derive.spec.parsing.values import WrongValueError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]
    Arrays = tuple[NDArray[np.float64], NDArray[np.int64]]

FACES = ("triangles", "polylist", "polygons")
"""The elements of faces that are read."""
OTHER_FACES = ("tristrips", "trifans")
TRANSFORMS = {"matrix": 16, "translate": 3, "rotate": 4, "scale": 3}
"""The elements that place a node in the one around it, with the number of their numbers."""
MOST_INSTANCES = 10_000
"""The largest number of geometries that a scene may place."""


def collada(content: bytes, file: str) -> Arrays:
    """The points (n, 3), m, and the triangles (m, 3) of a file, whose name errors show. Raises WrongValueError."""
    import numpy as np  # not for specifications without meshes

    try:
        root = parse_xml(content, keep_text=True)
    except SpecError as error:
        (problem,) = error.problems
        where = f" in line {problem.line}" if problem.line else ""
        raise WrongValueError(f"{file} cannot be read{where}: {problem.message}") from None
    reader = _Reader(root, file)
    unit = next(root.below("unit"), None)
    scale = float(reader.numbers(unit, unit.attributes.get("meter", "1"), 1)[0]) if unit else 1.0
    points, triangles, first = [np.zeros((0, 3))], [np.zeros((0, 3), dtype=np.int64)], 0
    for placement, geometry in reader.instances():
        for x, corners in reader.faces(geometry):
            points.append(scale * (x @ placement[:3, :3].T + placement[:3, 3]))
            triangles.append(corners + first)
            first += len(x)
    return np.concatenate(points), np.concatenate(triangles)


class _Reader:
    """The elements of a document by their names, and what they mean."""

    def __init__(self, root: XmlElement, file: str) -> None:
        self.root, self.file = root, file
        self.named: Mapping[str, XmlElement] = {name: e for e in _every(root) if (name := e.attributes.get("id"))}
        self.known: dict[int, list[Arrays]] = {}
        self.placed = 0

    def wrong(self, element: XmlElement, message: str) -> WrongValueError:
        """The error on an element."""
        return WrongValueError(f"line {element.line} of {self.file}: {message}")

    def referred(self, element: XmlElement, key: str) -> XmlElement:
        """The element that an attribute such as url="#arm" names."""
        name = element.attributes.get(key, "").strip()
        if name.removeprefix("#") not in self.named:
            raise self.wrong(element, f"<{element.tag}> needs the name of an element of this file in {key}")
        return self.named[name.removeprefix("#")]

    def numbers(self, element: XmlElement, text: str, count: int | None = None, kind: type = float) -> Any:
        """The numbers of a text, so many if that is given."""
        import numpy as np

        values: NDArray[Any]
        try:
            values = np.array(text.split(), dtype=kind)
        except (ValueError, OverflowError):
            values = np.zeros(0)
        if (count is not None and len(values) != count) or (not len(values) and text.strip()):
            raise self.wrong(element, f"<{element.tag}> needs {'' if count is None else f'{count} '}numbers")
        return values

    def instances(self) -> Iterator[tuple[Matrix, XmlElement]]:
        """The geometries of the scene with their placements; without a scene all, as they are."""
        import numpy as np

        scene = self.root.first("scene")
        shown = scene.first("instance_visual_scene") if scene else None
        if shown:
            yield from self.below(self.referred(shown, "url"), np.eye(4), 0)
        else:
            yield from ((np.eye(4), geometry) for geometry in self.root.below("geometry"))

    def below(self, around: XmlElement, placement: Matrix, depth: int) -> Iterator[tuple[Matrix, XmlElement]]:
        """The geometries in a scene or a node, which is placed in the frame of the file."""
        if depth > MAX_DEPTH:
            raise self.wrong(around, f"nodes are nested more than {MAX_DEPTH} deep")
        for child in around.children:
            if child.tag in TRANSFORMS:
                placement = placement @ self.transform(child)
            elif child.tag == "node":
                yield from self.below(child, placement, depth + 1)
            elif child.tag == "instance_node":
                yield from self.below(self.referred(child, "url"), placement, depth + 1)
            elif child.tag == "instance_geometry":
                self.placed += 1
                if self.placed > MOST_INSTANCES:
                    raise self.wrong(child, f"the scene places more than {MOST_INSTANCES} geometries")
                yield placement, self.referred(child, "url")

    def transform(self, element: XmlElement) -> Matrix:
        """The matrix (4, 4) of a transform."""
        import numpy as np
        from scipy.spatial.transform import Rotation

        values, result = self.numbers(element, element.text, TRANSFORMS[element.tag]), np.eye(4)
        if element.tag == "matrix":
            return np.asarray(values.reshape(4, 4))
        if element.tag == "translate":
            result[:3, 3] = values
        elif element.tag == "scale":
            result[:3, :3] = np.diag(values)
        elif any(values[:3]):
            axis = values[:3] / np.linalg.norm(values[:3])
            result[:3, :3] = Rotation.from_rotvec(np.radians(values[3]) * axis).as_matrix()
        return result

    def faces(self, geometry: XmlElement) -> list[Arrays]:
        """The faces of a geometry as triangles, with their points; each geometry is read once."""
        if id(geometry) not in self.known:
            mesh = geometry.first("mesh")
            elements = mesh.children if mesh else []
            if other := next((e for e in elements if e.tag in OTHER_FACES), None):
                raise self.wrong(other, f"<{other.tag}> is not read; write <triangles>")
            self.known[id(geometry)] = [self.triangles(e) for e in elements if e.tag in FACES]
        return self.known[id(geometry)]

    def triangles(self, faces: XmlElement) -> Arrays:
        """The points of faces, and the faces as triangles about their first corners."""
        import numpy as np

        inputs = list(faces.all("input"))
        offsets = [int(self.numbers(i, i.attributes.get("offset", "0"), 1, int)[0]) for i in inputs]
        stride = max(offsets, default=0) + 1
        of_points = next((k for k, i in enumerate(inputs) if i.attributes.get("semantic") == "VERTEX"), None)
        if of_points is None or min(offsets) < 0:
            raise self.wrong(faces, f'<{faces.tag}> needs <input semantic="VERTEX"> with an offset')
        corners = [
            self.numbers(p, p.text, kind=int).astype(np.int64)[offsets[of_points] :: stride] for p in faces.all("p")
        ]
        indices = np.concatenate([np.zeros(0, dtype=np.int64), *corners])
        if faces.tag == "polylist":
            vcount = faces.first("vcount")
            sizes = self.numbers(vcount, vcount.text, kind=int).astype(np.int64) if vcount else np.zeros(0, np.int64)
        else:
            sizes = np.array([len(c) for c in corners] if faces.tag == "polygons" else [3] * (len(indices) // 3), int)
        if sizes.sum() != len(indices) or (sizes < 0).any():
            raise self.wrong(faces, f"<{faces.tag}> has {len(indices)} corners, and its faces need {sizes.sum()}")
        return self.points(self.referred(inputs[of_points], "source")), fans(indices, sizes)

    def points(self, vertices: XmlElement) -> Matrix:
        """The points (n, 3) of <vertices>."""
        import numpy as np

        positions = next((i for i in vertices.all("input") if i.attributes.get("semantic") == "POSITION"), None)
        source = self.referred(positions, "source") if positions else None
        array = source.first("float_array") if source else None
        if array is None:
            raise self.wrong(vertices, "these points have no <float_array>")
        accessor = next(source.below("accessor"), None) if source else None
        text = accessor.attributes.get("stride", "1") if accessor else "3"
        stride = int(self.numbers(accessor or array, text, 1, int)[0])
        values = self.numbers(array, array.text)
        if stride < 3 or len(values) % stride:
            raise self.wrong(array, f"points of three coordinates are needed, {stride} numbers apart")
        return np.asarray(values.reshape(-1, stride)[:, :3])


def fans(indices: Any, sizes: Any) -> NDArray[np.int64]:
    """Faces, which are their corners behind each other, as triangles (m, 3) about the first corner of each."""
    import numpy as np

    counts = np.maximum(sizes - 2, 0)
    first = np.repeat(np.cumsum(sizes) - sizes, counts)
    step = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    return np.asarray(np.column_stack([indices[first], indices[first + step + 1], indices[first + step + 2]]))


def _every(element: XmlElement) -> Iterator[XmlElement]:
    yield element
    for child in element.children:
        yield from _every(child)
