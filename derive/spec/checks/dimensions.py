"""The dimension of a scene, which its vectors have: two components in the plane, three in space."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from derive.spec.model.markers import GROUND
from derive.spec.model.spatial_beam import OF_BEAM, OF_BEAM_IN_SPACE
from derive.spec.parsing.faults import Fault, KeyPath, path_text

PLANE, SPACE = 2, 3
VECTORS = ("centre",)
OF_START = ("position", "velocity")
IN_SPACE = ("rotation", "angular_velocity")
"""The keys of a start that bodies in space alone have."""
OF_NODES = ("nodes",)
"""The keys that finite-element bodies alone have."""


def is_in_space(data: Mapping[str, object]) -> bool:
    """Whether the data of a scene have nodes, a beam in space, or vectors with three components.

    A beam without keys of beams in space is one in the plane unless all vectors have three components.
    """
    if _has_body_with(data, (*OF_NODES, *OF_BEAM_IN_SPACE)):
        return True
    dimensions = {dimension for _, dimension in vectors(data)}
    return dimensions == {SPACE} if _has_body_with(data, OF_BEAM) else SPACE in dimensions


def _has_body_with(data: Mapping[str, object], keys: tuple[str, ...]) -> bool:
    bodies = data.get("bodies")
    tables = bodies.values() if isinstance(bodies, Mapping) else ()
    return any(isinstance(body, Mapping) and any(key in body for key in keys) for body in tables)


def dimension_faults(data: Mapping[str, object]) -> Iterator[Fault]:
    """Faults of scenes with vectors of two and of three components: the first of each kind."""
    first: dict[int, KeyPath] = {}
    beams_in_plane = _has_body_with(data, OF_BEAM) and not is_in_space(data)
    for path, dimension in () if beams_in_plane else vectors(data):
        first.setdefault(dimension, path)
    if len(first) == 2:
        for dimension, other in ((PLANE, SPACE), (SPACE, PLANE)):
            text = (
                f"this vector is of a scene {'in the plane' if dimension == PLANE else 'in space'}, with {dimension} "
                f"components, and {path_text(first[other])} of one {'in the plane' if other == PLANE else 'in space'}, "
                f"with {other}; give all vectors of a scene as many components"
            )
            yield Fault(first[dimension], text)


def vectors(data: Mapping[str, object]) -> Iterator[tuple[KeyPath, int]]:
    """The vectors of a scene with their numbers of components, 2 or 3, by their paths."""
    for path, value in _values(data):
        if isinstance(value, (list, tuple)) and len(value) in (PLANE, SPACE):
            yield path, len(value)
            continue
        telling = {"inertia": (list, tuple)} | dict.fromkeys(IN_SPACE, (list, tuple, Mapping))
        if isinstance(value, telling.get(str(path[-1]), ())):
            yield path, SPACE


def _values(data: Mapping[str, object]) -> Iterator[tuple[KeyPath, object]]:
    scene, ground, bodies = (data.get(key) for key in ("scene", GROUND, "bodies"))
    if isinstance(scene, Mapping):
        yield ("scene", "gravity"), scene.get("gravity")
    if isinstance(ground, Mapping):
        yield from _markers((GROUND, "markers"), ground.get("markers"))
    for name, body in bodies.items() if isinstance(bodies, Mapping) else ():
        if not isinstance(body, Mapping):
            continue
        path: KeyPath = ("bodies", str(name))
        own = () if any(key in body for key in OF_BEAM) else (*VECTORS, "inertia")
        yield from ((((*path, key)), body.get(key)) for key in own)
        yield from _markers((*path, "markers"), body.get("markers"))
        start = body.get("start")
        if isinstance(start, Mapping):
            keys = (*OF_START, *(key for key in IN_SPACE if key in start))
            yield from (((*path, "start", key), start.get(key)) for key in keys)


def _markers(path: KeyPath, markers: object) -> Iterator[tuple[KeyPath, object]]:
    for name, marker in markers.items() if isinstance(markers, Mapping) else ():
        if isinstance(marker, Mapping):
            yield (*path, str(name), "at"), marker.get("at")
            yield from (((*path, str(name), key), marker[key]) for key in ("rotation",) if key in marker)
        else:
            yield (*path, str(name)), marker
