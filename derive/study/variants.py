"""One scene in several frames, its rods cut into several numbers of beams."""

from __future__ import annotations

from dataclasses import dataclass, replace

from derive.spec.model.scene import BeamBody, Scene
from derive.spec.parsing import values
from derive.spec.tables.beam import frame_from


@dataclass(frozen=True)
class Variant:
    """A scene whose rods are cut into `pieces` beams each, all of them in the frame `frame` (its kind)."""

    pieces: int
    frame: str
    scene: Scene


def variant(scene: Scene, pieces: int, frame: str) -> Variant:
    """The scene with all of its rods cut and framed so."""
    bodies = tuple(_framed(b, pieces, frame) if isinstance(b, BeamBody) else b for b in scene.bodies)
    return Variant(pieces, frame, replace(scene, bodies=bodies))


def rods(scene: Scene) -> tuple[BeamBody, ...]:
    """The flexible bodies of a scene."""
    return tuple(b for b in scene.bodies if isinstance(b, BeamBody))


def _framed(rod: BeamBody, pieces: int, name: str) -> BeamBody:
    """A rod as a specification with this frame gives it; one that has the frame already stays as it is."""
    frame = frame_from(values.frame_kind(name), None)
    if frame == rod.beam.frame:
        return replace(rod, pieces=pieces)
    return replace(rod, pieces=pieces, beam=replace(rod.beam, frame=frame, orthogonal=frame.kind == "mean"))
