"""Faults of lines between markers that are always at one place: their direction would be that of rounding errors."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from derive.mechanics.multibody.space.marker_outputs import ANGLE
from derive.spec.checks.scene_data import Raw, SceneData
from derive.spec.model.markers import MarkerRef
from derive.spec.parsing.faults import Fault


def line_faults(view: SceneData, holds: Callable[[Raw], bool]) -> Iterator[Fault]:
    """Faults of chords, springs and angles of lines; `holds`: whether a joint keeps its markers together."""
    held: dict[frozenset[MarkerRef], str] = {}
    for name, joint in view.tables["joints"].items():
        markers = view.pair("joints", name)
        if markers and holds(joint):
            held[frozenset(markers)] = name
    for path, noun, directed in _lines(view):
        markers = view.pair(*path)
        if markers and markers[0] == markers[1]:
            yield Fault(path, f"{noun} is between two markers, and these are the same")
        elif markers and directed and (joint_name := held.get(frozenset(markers))):
            why = f"the joint {joint_name} holds both markers at one place"
            yield Fault(path, f"{why}, so that no line between them has a direction; choose markers that are apart")


def _lines(view: SceneData) -> Iterator[tuple[tuple[str, str, str], str, bool]]:
    """The lines of a scene: their paths, their nouns, and whether they need a direction."""
    for section in ("outputs", "plots"):
        for name in view.tables[section]:
            yield (section, name, "chord"), "a chord", True
    for name, output in view.tables["outputs"].items():
        if output.get("kind") == ANGLE:
            yield ("outputs", name, "between"), "a line", True
    for name, spring in view.tables["springs"].items():
        yield ("springs", name, "between"), "a spring", spring.get("kind", "linear") == "linear"
