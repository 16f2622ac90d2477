"""`--to exudyn-ffrf`: the shape integrals of a body in space for ObjectFFRFreducedOrder of Exudyn."""

from __future__ import annotations

from collections.abc import Iterable

from derive.artifacts import MARK, File
from derive.backends.description import LICENCE
from derive.backends.wrapping import prefixed
from derive.errors import Problem, SpecError
from derive.export.exudyn.floating_frame_arguments import floating_frame_arguments
from derive.export.exudyn.floating_frame_scene import scene_values
from derive.export.host_model import HostModel
from derive.export.interface import Interface
from derive.mechanics.bodies.modal_body import Array
from derive.reduction.body import reduce
from derive.rendering import render
from derive.spec.model.quantity import Parameter, Quantity
from derive.spec.model.scene import Scene
from derive.spec.model.spatial_scene import SpatialScene

IN_SPACE = "the floating-frame body of Exudyn is one in space: give the body by its nodes, or use --to exudyn"
NO_MODES = "the floating-frame body of Exudyn has modes and nodes: give the body a mode and a marker at least"
FIRST_ORDER = "the floating-frame body of Exudyn has displacements of first order: order = 1, or use --to exudyn"


def floating_frame_files(host: HostModel) -> tuple[File, ...]:
    """The module that adds the body, or the scene in space.

    Raises SpecError for a scene in the plane, for a body of second order or without modes, and for elements of a scene
    that have no item of Exudyn.
    """
    spec = host.spec
    if isinstance(spec, Scene):
        raise SpecError((Problem("", IN_SPACE),))
    if isinstance(spec, SpatialScene):
        return _files(host, "floating_frame_scene", {"scene": literal(scene_values(host, spec))})
    if spec.second_order:
        raise SpecError((Problem("body.order", FIRST_ORDER),))
    body = reduce(spec)
    if not body.modes or not body.points:
        raise SpecError((Problem("body", NO_MODES),))
    values = {
        "points": [point.name for point in body.points],
        "arguments": [(name, _literal(array)) for name, array in floating_frame_arguments(body).items()],
        "gravity": [_number(component) for component in spec.gravity or ()],
    }
    return _files(host, "floating_frame", values)


def _files(host: HostModel, template: str, values: dict[str, object]) -> tuple[File, ...]:
    common = {"mark": MARK, "licence": LICENCE, "name": host.name, "title": host.model.doc, "host": host}
    return (
        File(f"{host.name}_ffrf.py", render(f"export/exudyn/{template}.py.jinja", common | values)),
        File("manifest.json", host.manifest.text),
    )


def literal(value: object, indent: str = "") -> str:
    """Nested tables of a module, a line for each entry and row."""
    inner = indent + "    "
    if isinstance(value, dict) and value:
        lines = [f"{inner}{key!r}: {literal(of, inner)},".replace("'", '"') for key, of in value.items()]
        return "\n".join(["{", *lines, indent + "}"])
    if isinstance(value, list) and value and isinstance(value[0], list):
        return "\n".join(["[", *(f"{inner}{row!r}," for row in value), indent + "]"])
    return repr(value).replace("'", '"')


def _number(component: Quantity) -> float:
    return float(component.default if isinstance(component, Parameter) else component)


def _literal(array: Array) -> str:
    """A number, or nested lists of numbers, on lines."""
    if array.ndim == 0:
        return repr(float(array))
    return "[\n" + "\n".join(prefixed([", ".join(_rows(array)) + ","], "        ")) + "\n    ]"


def _rows(array: Array) -> Iterable[str]:
    plain = (array + 0.0).tolist()
    return map(repr, plain) if array.ndim == 1 else ("[" + ", ".join(map(repr, row)) + "]" for row in plain)


EXUDYN_FFRF = Interface(
    "Exudyn: the shape integrals of a body in space for its own floating-frame body",
    floating_frame_files,
    "import {name}_ffrf in Python with {folder} in the path; then {name}_ffrf.add(mbs)",
)
