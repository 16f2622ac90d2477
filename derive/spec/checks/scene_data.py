"""The data of a scene before validation, for checks that compare several tables, any of which may be faulty."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

from derive.mechanics.multibody.forces.registry import DEFAULT_KINDS, kinds
from derive.mechanics.multibody.outputs.registry import OUTPUTS
from derive.mechanics.multibody.space.outputs import SPATIAL_OUTPUTS
from derive.spec.checks.dimensions import is_in_space
from derive.spec.model.joints import Joint
from derive.spec.model.keys import Key, KeyType, declared_keys
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.plots import Deflection
from derive.spec.model.scene import NAMED
from derive.spec.model.spatial_forces import (
    SpatialForce,
    SpatialJointForce,
    SpatialJointTorque,
    SpatialSpring,
    SpatialTorque,
)
from derive.spec.model.spatial_scene import SpatialJoint
from derive.spec.parsing import scene_values
from derive.spec.parsing.faults import KeyPath, readable
from derive.spec.tables.scene_bodies import kind_of_scene_body
from derive.spec.tables.scene_elements import ELEMENTS
from derive.spec.tables.shared import MAX_MARKERS, MAX_NAMED
from derive.spec.tables.spatial_bodies import kind_of_spatial_body

Raw = Mapping[str, object]
FUNCTIONS = (KeyType.FUNCTION, KeyType.FUNCTION_PAIR, KeyType.FUNCTION_TRIPLE)
SPATIAL_ELEMENTS: dict[str, tuple[type, ...]] = {
    "joints": (SpatialJoint,),
    "forces": (SpatialForce, SpatialJointForce),
    "torques": (SpatialTorque, SpatialJointTorque),
    "springs": (SpatialSpring,),
}
"""The frozen types of the elements of sections in space."""
MARKERS = (KeyType.MARKER, KeyType.BEAM_MARKER, KeyType.MARKER_PAIR)


class WrittenRef(NamedTuple):
    """A reference to a marker, and its path."""

    path: KeyPath
    marker: MarkerRef


@dataclass(frozen=True)
class SceneData:
    """The sections of a scene whose elements have names, limited to the elements that are tables."""

    data: Raw
    tables: Mapping[str, Mapping[str, Raw]] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "tables", {kind: _tables(self.data.get(kind)) for kind in NAMED})

    @property
    def bodies(self) -> Mapping[str, Raw]:
        """The bodies by their names."""
        return self.tables["bodies"]

    def names(self, section: str) -> list[str]:
        """The names of all elements of a section, including those whose values are not tables."""
        elements = self.data.get(section)
        return [name for name in elements if isinstance(name, str)] if isinstance(elements, Mapping) else []

    @property
    def complete(self) -> bool:
        """Whether a name that is missing here is missing in the data, because all sections can be read."""
        sections = [self.data.get(kind, {}) for kind in NAMED]
        return all(isinstance(item, Mapping) and len(item) <= MAX_NAMED for item in sections)

    @cached_property
    def in_space(self) -> bool:
        """Whether the scene is one in space."""
        return is_in_space(self.data)

    def kind(self, body: str) -> str:
        """The kind of a body."""
        if self.in_space:
            return kind_of_spatial_body(self.bodies.get(body))
        return kind_of_scene_body(self.bodies.get(body))

    def is_beam(self, body: str) -> bool:
        """Whether a body is a beam."""
        return body in self.bodies and self.kind(body) == "beam"

    def markers(self, body: str) -> list[str] | None:
        """The markers of a body or of the ground; None where that is unknown."""
        table = self.data.get(GROUND, {}) if body == GROUND else self.bodies.get(body)
        markers = table.get("markers", {}) if isinstance(table, Mapping) else None
        if not isinstance(markers, Mapping) or len(markers) > MAX_MARKERS:
            return None
        return [name for name in markers if isinstance(name, str)]

    def pair(self, kind: str, name: str, key: str = "between") -> tuple[MarkerRef, MarkerRef] | None:
        """The two markers of a joint, a spring or a chord, if they can be read."""
        value = self.tables[kind][name].get(key)
        if not isinstance(value, (list, tuple)) or len(value) != 2:
            return None
        first, second = (readable(scene_values.marker_ref, item) for item in value)
        return None if first is None or second is None else (first, second)

    def marker_refs(self) -> Iterator[WrittenRef]:
        """All references to markers that can be read."""
        planar = {"joints": Joint, **ELEMENTS}
        elements = SPATIAL_ELEMENTS if self.in_space else {section: (of,) for section, of in planar.items()}
        types: dict[str, tuple[type, ...]] = {**elements, "plots": (Deflection,)}
        keys = {kind: [key.name for key in _declared(of) if key.type in MARKERS] for kind, of in types.items()}
        for name, table in self.tables["outputs"].items():
            kind = str(table.get("kind"))
            output_type = SPATIAL_OUTPUTS.get(kind) if self.in_space else OUTPUTS.get(kind)
            declared = output_type.keys if output_type else ()
            for key in (key.name for key in declared if key.type in MARKERS):
                yield from _marker_refs(("outputs", name, key), table.get(key))
        for kind, of in keys.items():
            for name, table in self.tables[kind].items():
                for key in of:
                    yield from _marker_refs((kind, name, key), table.get(key))

    def input_refs(self) -> Iterator[tuple[KeyPath, str]]:
        """All references to run-time inputs."""
        for name, drive in self.tables["drives"].items():
            yield from _input_refs(("drives", name, "motion"), drive.get("motion"))
        for section in DEFAULT_KINDS:
            of_kinds = (key for force_type in kinds(section).values() for key in force_type.keys)
            own = _declared(SPATIAL_ELEMENTS[section]) if self.in_space else of_kinds
            keys = {key.name: key for key in own}
            functions = [k for k, key in keys.items() if key.type in FUNCTIONS]
            for name, table in self.tables[section].items():
                for key in functions:
                    yield from _input_refs((section, name, key), table.get(key))
        for name, body in self.bodies.items():
            for load, table in _tables(body.get("loads")).items():
                yield from _input_refs(("bodies", name, "loads", load, "time"), table.get("time"))


def _declared(types: tuple[type, ...]) -> Iterator[Key]:
    """The keys that types declare."""
    for of in types:
        yield from declared_keys(of)


def _input_refs(path: KeyPath, value: object) -> Iterator[tuple[KeyPath, str]]:
    if isinstance(value, (list, tuple)):
        for i, item in enumerate(value[:3]):
            yield from _input_refs((*path, i), item)
    elif isinstance(value, Mapping) and isinstance(value.get("input"), str):
        yield path, value["input"]


def _marker_refs(path: KeyPath, value: object) -> Iterator[WrittenRef]:
    if isinstance(value, (list, tuple)):
        for i, item in enumerate(value[:2]):
            yield from _marker_refs((*path, i), item)
    elif isinstance(value, str):
        marker = readable(scene_values.marker_ref, value)
        if marker is not None:
            yield WrittenRef(path, marker)


def _tables(value: object) -> dict[str, Raw]:
    if not isinstance(value, Mapping) or len(value) > MAX_NAMED:
        return {}
    return {name: table for name, table in value.items() if isinstance(name, str) and isinstance(table, Mapping)}
