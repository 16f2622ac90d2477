"""Names that are derived from the names in a scene, and clashes between them.

Coordinates, multipliers and definitions begin with the name of their element: rod_c1, rod_2_alpha1, pin_1. In the
code some of them are in upper case, so that names must differ in more than case.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from derive.errors import quoted
from derive.mechanics.multibody.forces.registry import kinds
from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.multibody.outputs.registry import OUTPUTS
from derive.mechanics.multibody.space.rows import DISTANCE, RELATIVE_MOTIONS, SCREW
from derive.spec.checks.scene_data import Raw, SceneData
from derive.spec.model.beam_parts import DEFAULT_ANSATZ
from derive.spec.model.beam_pieces import piece_name
from derive.spec.model.instances import identifier, joined, rate_name
from derive.spec.model.keys import quantities
from derive.spec.model.markers import GROUND
from derive.spec.model.scene import NAMED
from derive.spec.parsing import scene_values, values
from derive.spec.parsing.faults import Fault, KeyPath, readable
from derive.spec.parsing.names import element_name_problem, name_problem
from derive.spec.tables.value_types import MAX_SHAPES

RESERVED = {"t": "it is the time", "pi": "it is the number pi"}
GRAVITY = dict.fromkeys(("g_1", "g_2", "g_3"), "it is a component of gravity")
SPATIAL_COORDINATES = (
    *("c1", "c2", "c3", "e0", "e1", "e2", "e3", "omega1", "omega2", "omega3", "pi1", "pi2", "pi3"),
    *(f"{stem}{axis}" for stem in ("phi", "s") for axis in ("", 1, 2, 3)),
)
"""The ends of the names of coordinates and velocities of a body in space."""
OWN_MARKERS = ("base", "cut_left", "cut_right")
"""The names of points of bodies that the derivation adds."""
RATES = ("", "dot", "ddot")


def _labels(kind: str) -> tuple[str, ...]:
    """The suffixes of names derived from an element: those of multipliers, constants and intermediates."""
    if kind == "drives":
        return ("", "_speed")
    if kind == "gears":
        return ("", "_ratio", "_offset")
    if kind == "joints":
        labels_of_types = (
            (*(m.label for m in joint.removes), *quantities(joint.keys), *joint.axes.intermediates)
            for joint in JOINTS.values()
        )
    else:
        labels_of_types = ((*quantities(force.keys), *force.intermediates) for force in kinds(kind).values())
    return tuple(dict.fromkeys(f"_{label}" for labels in labels_of_types for label in labels))


def _spatial_labels() -> tuple[str, ...]:
    """The suffixes of the names of multipliers and constants of joints in space."""
    return tuple(f"_{label}" for label in (*RELATIVE_MOTIONS, DISTANCE.label, SCREW.label, "pitch"))


Made = tuple[KeyPath, str, str]
"""The path of the name from which another is derived, the derived name, and its description."""


def name_faults(view: SceneData) -> Iterator[Fault]:
    """Faults of names that are taken, each reported once, where the later of the two is written."""
    repeated = list(_written_twice(view))
    yield from repeated
    yield from _markers(view)
    reported = {fault.path for fault in repeated}
    first: dict[str, tuple[KeyPath, str]] = {name: ((), why) for name, why in _reserved(view).items()}
    model = view.data.get("name")
    if isinstance(model, str):
        first[model.lower()] = (("name",), "it is the name of the model")
    for path, name, what in made_names(view):
        other, why = first.setdefault(name.lower(), (path, f"it is {what}"))
        if other != path and path not in reported:
            reported.add(path)
            reason = (
                f"{quoted(name)}, {what}, is taken: {why}" if name != path[1] else f"{quoted(name)} is taken: {why}"
            )
            yield Fault(path, f"{reason}; choose another name")


def column_faults(view: SceneData) -> Iterator[Fault]:
    """Faults of outputs whose columns have the names of other columns of a trajectory."""
    columns = {"t": "it is the time"}
    for path, name, what in made_names(view):
        if path[0] in ("bodies", "drives"):
            columns.setdefault(name.lower(), f"it is {what}")
    for name, table in _named(view, "outputs"):
        output_type = OUTPUTS.get(str(table.get("kind")))
        for label in output_type.labels if output_type else ():
            column = identifier(name, label)
            why = columns.setdefault(column.lower(), f"it is a component of the output {name}")
            if why != f"it is a component of the output {name}":
                yield Fault(("outputs", name), f"{quoted(column)} is taken: {why}; choose another name")
                break


def taken_names(view: SceneData) -> dict[str, str]:
    """The names in lower case that no symbol may have, with the reason."""
    return {**_reserved(view), **{name.lower(): f"it is {what}" for _, name, what in made_names(view)}}


def _reserved(view: SceneData) -> dict[str, str]:
    """The names that every scene makes, and those of gravity if there is gravity."""
    scene = view.data.get("scene")
    return RESERVED | GRAVITY if isinstance(scene, Mapping) and "gravity" in scene else RESERVED


def made_names(view: SceneData) -> Iterator[Made]:
    """All names that a scene makes."""
    for name, body in _named(view, "bodies"):
        path: KeyPath = ("bodies", name)
        if view.in_space:
            yield from _spatial_names(view, path, name, body)
            continue
        if not view.is_beam(name):
            yield from _coordinates(path, name, 0, f"the body {name}")
            continue
        axial = body.get("axial")
        shapes = _shape_count(body.get("ansatz", DEFAULT_ANSATZ))
        shapes += _shape_count(axial.get("ansatz")) if isinstance(axial, Mapping) else 0
        for count in piece_counts(view, name, body):
            if count == 1:
                yield from _coordinates(path, name, shapes, f"the body {name}")
                continue
            for k in range(1, count + 1):
                yield from _coordinates(path, f"{name}_{k}", shapes, f"piece {k} of the body {name}")
                for weld in JOINTS["weld"].removes:
                    yield (
                        path,
                        identifier(name, "cut", str(k), weld.label),
                        f"a multiplier of cut {k} of the body {name}",
                    )
    for name, _ in _named(view, "inputs"):
        for rate in RATES:
            made = identifier(f"u_{rate_name(name, rate)}")
            yield ("inputs", name), made, f"the input {name}{' or its rate' if rate else ''}"
    for kind in ("joints", "forces", "torques", "springs", "drives", "gears"):
        labels = _spatial_labels() if view.in_space and kind == "joints" else _labels(kind)
        for name, _ in _named(view, kind):
            what = "the multiplier" if kind in ("drives", "gears") else "a name"
            for end in labels:
                yield (kind, name), identifier(f"{name}{end}"), f"{what} of the {NAMED[kind]} {name}"


def _shape_count(ansatz: object) -> int:
    """The largest number of shapes that an ansatz may give."""
    if isinstance(ansatz, Mapping):
        return min(readable(values.whole, ansatz.get("count")) or 0, MAX_SHAPES)
    return min(len(ansatz), MAX_SHAPES) if isinstance(ansatz, (list, tuple)) else 0


def _coordinates(path: KeyPath, name: str, shapes: int, of: str) -> Iterator[Made]:
    for coordinate in map(identifier, coordinate_names(name, shapes)):
        for rate in RATES:
            yield path, f"{coordinate}{rate}", f"a {'rate' if rate else 'coordinate'} of {of}"


def _spatial_names(view: SceneData, path: KeyPath, name: str, body: Raw) -> Iterator[Made]:
    """The names that a body in space makes, a beam with those of its pieces and of the welds between them."""
    for count in piece_counts(view, name, body) if view.is_beam(name) else (1,):
        for k in range(count):
            yield from _spatial_coordinates(path, piece_name(name, count, k))
        for k in range(1, count):
            for end in _spatial_labels():
                yield path, identifier(f"{name}_cut_{k}{end}"), f"a name of cut {k} of the body {name}"


def _spatial_coordinates(path: KeyPath, name: str) -> Iterator[Made]:
    for end in SPATIAL_COORDINATES:
        for rate in RATES:
            yield path, f"{identifier(name, end)}{rate}", f"a {'rate' if rate else 'coordinate'} of the body {name}"


def coordinate_names(body: str, shapes: int) -> list[str]:
    """The names of columns that the coordinates of a body with so many shape functions may have."""
    return [joined(body, end) for end in ("c1", "c2", "phi", "s", *(f"alpha{i}" for i in range(1, shapes + 1)))]


def piece_counts(view: SceneData, name: str, body: Raw) -> list[int]:
    """The numbers of pieces into which a body is cut, in its table and in plots."""
    counts = [body.get("pieces", 1)]
    for plot in view.tables["plots"].values():
        pieces = plot.get("pieces")
        if plot.get("cut") == name and isinstance(pieces, (list, tuple)):
            counts += pieces[: scene_values.MAX_PIECES]
    read = {readable(scene_values.piece_count, count) for count in counts}
    return sorted(count for count in read if count is not None)


def _named(view: SceneData, kind: str) -> Iterator[tuple[str, Raw]]:
    for name, table in view.tables[kind].items():
        if not element_name_problem(name):
            yield name, table


def _written_twice(view: SceneData) -> Iterator[Fault]:
    """Faults of names in one section that differ in case alone."""
    for kind in NAMED:
        first: dict[str, str] = {}
        for name in view.tables[kind]:
            other = first.setdefault(name.lower(), name)
            if other != name:
                noun = NAMED[kind]
                text = f"there is {'an' if noun[0] in 'aeiou' else 'a'} {noun} {quoted(other)}"
                yield Fault((kind, name), f"{quoted(name)} is taken: {text}; names must differ in more than case")


def _markers(view: SceneData) -> Iterator[Fault]:
    """Faults of markers whose names coincide when they are prefixed with the names of their bodies."""
    first: dict[str, tuple[str, str]] = {}
    for body in (GROUND, *view.bodies):
        for marker in view.markers(body) or ():
            path: KeyPath = (GROUND, "markers", marker) if body == GROUND else ("bodies", body, "markers", marker)
            if name_problem(marker) or (body != GROUND and element_name_problem(body)):
                continue
            if body != GROUND and marker.lower() in OWN_MARKERS:
                text = f"{quoted(marker)} is taken: it is what a point of every body is called"
                yield Fault(path, f"{text}; choose another name")
            other = first.setdefault(identifier(body, marker).lower(), (body, marker))
            if other == (body, marker):
                continue
            if other[0] == body:
                text = f"there is a marker {quoted(other[1])}; names must differ in more than case"
                yield Fault(path, f"{quoted(marker)} is taken: {text}")
            else:
                text = (
                    f"{identifier(body, marker)} would be this marker and the marker {other[1]} of the body {other[0]}"
                )
                yield Fault(path, f"{text}; choose another name")
