"""The limits of a model, for the commands that print them and for the interfaces to other programs."""

from __future__ import annotations

from derive.notes.conditioning import condition_warnings
from derive.notes.scene_notes import scene_notes
from derive.notes.spin_limit import spin_notes
from derive.spec.model.scene import Scene
from derive.spec.model.specification import Specification


def limits(spec: Specification) -> tuple[str, ...]:
    """The notes on where a model ceases to be valid, and on bodies that nothing connects with the ground."""
    of_scene = scene_notes(spec) if isinstance(spec, Scene) else ()
    return (*spin_notes(spec), *of_scene, *(f"warning: {text}" for text in condition_warnings(spec)))
