"""The shapes of links as visuals of rigid bodies: their text, the files of meshes, and lines on those left out."""

from __future__ import annotations

import json
import math
import os
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path, PurePosixPath

import numpy as np

from derive.errors import printable
from derive.short_text import counted
from derive.spec.files.meshes import READERS, mesh_file
from derive.spec.parsing.values import WrongValueError
from derive.urdf.rigid_bodies import LinkPart, RobotBody
from derive.urdf.robot import LinkShape
from derive.urdf.texts import axes_text, list_text, number_text

SIZES = {"box": ("size",), "cylinder": ("radius", "length"), "sphere": ("radius",)}
"""The attributes with the sizes of shapes that have no file."""


class WrittenVisuals:
    """Writes the visuals of bodies; `left` has why shapes are left out, with their number and the first one's name.

    robot: the folder of the URDF, beside or above which its meshes are. folder: that of the specification.
    """

    def __init__(self, robot: Path, folder: Path) -> None:
        self.robot, self.folder = robot, folder
        self.left: Counter[str] = Counter()
        self.first: dict[str, str] = {}
        self.by_collisions: list[str] = []
        self.faults: dict[Path, str] = {}

    def of(self, body: RobotBody) -> Iterator[str]:
        """The tables of the visuals of a body; of a link none of whose visuals can be shown, its shapes for contact."""
        for part in body.parts:
            shown = self.shown(part, part.link.visuals)
            if part.link.visuals and not shown:
                shown = self.shown(part, part.link.collisions)
                self.by_collisions += [part.link.name] if shown else []
            yield from shown

    def lines(self, body: RobotBody) -> list[str]:
        """The key `visuals` of a body, if it has any."""
        shapes = list(self.of(body))
        return ["visuals = [", *(f"    {shape}," for shape in shapes), "]"] if shapes else []

    def notes(self) -> Iterator[str]:
        """Lines on the shapes that are not shown, and on those that stand for others."""
        for why, number in self.left.items():
            yield f"not shown: {counted(number, 'shape')}, {why}, such as {printable(self.first[why])}"
        if self.by_collisions:
            yield f"shown by its shapes for contact: {', '.join(map(printable, self.by_collisions))}"

    def shown(self, part: LinkPart, shapes: Sequence[LinkShape]) -> list[str]:
        """The tables of those shapes of a link that can be shown."""
        result = []
        for shape in shapes:
            try:
                form = self.form(shape)
            except WrongValueError as error:
                self.left[str(error)] += 1
                self.first.setdefault(str(error), shape.attributes.get("filename") or part.link.name)
                continue
            placement = part.placement.of(shape.origin.placement)
            at = f", at = {list_text(placement.position)}" if placement.position.any() else ""
            turned = not np.array_equal(placement.rotation, np.eye(3))
            rotation = f", rotation = {axes_text(placement.rotation)}" if turned else ""
            result.append(f"{{ {form}{at}{rotation} }}")
        return result

    def form(self, shape: LinkShape) -> str:
        """The keys of a shape without its placement. Raises WrongValueError where it cannot be shown."""
        if shape.form == "mesh":
            scale = _numbers(shape.attributes.get("scale", "1 1 1"))
            if len(scale) != 3 or not all(scale):
                raise WrongValueError("whose scale is not three numbers")
            file = os.path.relpath(self.mesh(shape.attributes.get("filename", "")), self.folder)
            factors = f", scale = {list_text(scale)}" if scale != [1, 1, 1] else ""
            return f"mesh = {json.dumps(Path(file).as_posix())}{factors}"
        if shape.form not in SIZES:
            raise WrongValueError(f"<{printable(shape.form)}>" if shape.form else "without a geometry")
        sizes = [x for name in SIZES[shape.form] for x in _numbers(shape.attributes.get(name, ""))]
        if len(sizes) != {"box": 3}.get(shape.form, len(SIZES[shape.form])) or not all(size > 0 for size in sizes):
            raise WrongValueError(f"<{shape.form}> without positive sizes")
        return f"{shape.form} = {number_text(sizes[0]) if shape.form == 'sphere' else list_text(sizes)}"

    def mesh(self, name: str) -> Path:
        """The file of a mesh. Raises WrongValueError where there is none, or it cannot be read."""
        if PurePosixPath(name).suffix.lower() not in READERS:
            raise WrongValueError(f"which are no {' or '.join(READERS)} files")
        file = next((path for path in self.places(name) if path.is_file()), None)
        if file is None:
            raise WrongValueError("whose files are not there")
        if file not in self.faults:
            self.faults[file] = ""
            try:
                mesh_file(str(file.resolve()), Path())
            except WrongValueError:
                self.faults[file] = "whose files cannot be read as meshes"
        if self.faults[file]:
            raise WrongValueError(self.faults[file])
        return file

    def places(self, name: str) -> Iterator[Path]:
        """Where the file of a mesh may be: of `package://NAME/...` in folders of this name beside or above the URDF."""
        for scheme in ("package://", "model://"):
            if name.startswith(scheme):
                parts = PurePosixPath(name.removeprefix(scheme).lstrip("/")).parts
                for folder in (self.robot.resolve(), *self.robot.resolve().parents):
                    yield folder.joinpath(*parts)
                    if folder.name == parts[0]:
                        yield folder.joinpath(*parts[1:])
                return
        yield self.robot / name.removeprefix("file://")


def _numbers(text: str) -> list[float]:
    """The finite numbers of a text; none if one is not."""
    try:
        values = [float(part) for part in text.split()]
    except ValueError:
        return []
    return values if all(map(math.isfinite, values)) else []
