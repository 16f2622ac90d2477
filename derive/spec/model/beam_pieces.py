"""Beams that are cut into pieces: names and positions of the pieces, and the scene in space that has them as bodies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any, TypeVar

from derive.spec.model.markers import MarkerRef
from derive.spec.model.quantity import Parameter
from derive.spec.model.spatial_beam import PieceOf, SpatialBeam, SpatialBody
from derive.spec.model.spatial_beam_parts import SectionFrame
from derive.spec.model.spatial_scene import SpatialJoint, SpatialScene
from derive.spec.model.spatial_start import NOT_GIVEN_IN_SPACE, SpatialInitialValues

S = TypeVar("S")

AT_MARKERS = ("forces", "torques", "springs", "outputs")
"""The sections, besides joints, whose elements name markers of pieces; plots keep those of the specification."""
CUT = ("cut_left", "cut_right")
"""The markers at the ends at which pieces are welded together."""


def piece_name(rod: str, pieces: int, k: int) -> str:
    """The name of piece k of a rod, counted from 0; of a rod in one piece that of the rod."""
    return f"{rod}_{k + 1}" if pieces > 1 else rod


def piece_of(at: Fraction, pieces: int) -> int:
    """The number, from 0, of the piece that contains position xi of the rod; at a boundary, the left piece."""
    along = (at + 1) / 2 * pieces
    return max(-(-along.numerator // along.denominator) - 1, 0)


def place_in_piece(at: Fraction, pieces: int) -> Fraction:
    """The position xi in the piece that contains position xi of the rod."""
    return (at + 1) * pieces - 2 * piece_of(at, pieces) - 1


def in_pieces(spec: S) -> S:
    """A scene in space as it is computed: `with_pieces`; every other specification as it is."""
    result: Any = with_pieces(spec) if isinstance(spec, SpatialScene) else spec
    made: S = result
    return made


def with_pieces(scene: SpatialScene) -> SpatialScene:
    """The scene with a body for each piece of its beams, and joints that weld these together.

    Markers of a beam become those of its pieces, in joints and loads as well. A scene without beams in pieces, and one
    that has been cut already, is returned as it is.
    """
    cut = {body.name: body for body in scene.bodies if _is_cut(body)}
    if not cut:
        return scene
    bodies: list[SpatialBody] = []
    welds: list[SpatialJoint] = []
    places: dict[MarkerRef, MarkerRef] = {}
    for body in scene.bodies:
        if not (isinstance(body, SpatialBeam) and body.name in cut):
            bodies.append(body)
            continue
        pieces = [_piece(body, k) for k in range(body.pieces)]
        bodies += pieces
        for piece in pieces:
            places |= {MarkerRef(body.name, m.name): MarkerRef(piece.name, m.name) for m in piece.markers}
        for k, (left, right) in enumerate(pairwise(pieces), 1):
            ends = MarkerRef(left.name, CUT[1]), MarkerRef(right.name, CUT[0])
            welds.append(SpatialJoint(f"{body.name}_cut_{k}", "fixed", *ends))
    acting = {name: _located(getattr(scene, name), places) for name in AT_MARKERS}
    joints = (*_located(scene.joints, places), *welds)
    return replace(scene, bodies=tuple(bodies), joints=joints, **acting)


def located(scene: SpatialScene, marker: MarkerRef) -> MarkerRef:
    """A marker that the specification names, on the piece of a beam that it lies on."""
    beams = (body for body in scene.bodies if isinstance(body, SpatialBeam))
    pieces = (beam for beam in beams if whole_beam(beam).name == marker.body)
    own = (piece.name for piece in pieces if marker.marker in (m.name for m in piece.markers))
    return MarkerRef(next(own, marker.body), marker.marker)


def whole_beam(beam: SpatialBeam) -> SpatialBeam:
    """The beam as it is specified: of a piece the whole beam."""
    return beam.piece_of.rod if beam.piece_of else beam


def _is_cut(body: SpatialBody) -> bool:
    return isinstance(body, SpatialBeam) and body.pieces > 1 and body.piece_of is None


def _piece(rod: SpatialBeam, k: int) -> SpatialBeam:
    """Piece k of a beam, counted from 0, with the markers that lie on it."""
    n = rod.pieces
    own = tuple(replace(m, at=place_in_piece(m.at, n)) for m in rod.markers if piece_of(m.at, n) == k)
    ends = [SectionFrame(CUT[0], Fraction(-1))] if k else []
    ends += [SectionFrame(CUT[1], Fraction(1))] if k < n - 1 else []
    masses = tuple(replace(m, at=place_in_piece(m.at, n)) for m in rod.masses if piece_of(m.at, n) == k)
    name, of = piece_name(rod.name, n, k), PieceOf(rod, k)
    return replace(rod, name=name, markers=(*own, *ends), masses=masses, start=_start(rod, k), piece_of=of)


def _start(rod: SpatialBeam, k: int) -> SpatialInitialValues:
    """Where piece k of a straight rod starts if the pose of the rod is given: a first guess."""
    start, length = rod.start, rod.length
    if start.rotation is None:
        return NOT_GIVEN_IN_SPACE
    if start.position is None:
        return SpatialInitialValues(rotation=start.rotation, guess=True)
    half = (length.default if isinstance(length, Parameter) else float(length)) / 2
    along = half * (2 * k + 1 - rod.pieces) / rod.pieces
    w, x, y, z = (float(p) for p in start.rotation)
    square = w * w + x * x + y * y + z * z
    e1 = (w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y))
    c1, c2, c3 = (c + along * e / square for c, e in zip(start.position, e1, strict=True))
    return SpatialInitialValues(position=(c1, c2, c3), rotation=start.rotation, guess=True)


def _located(value: Any, places: Mapping[MarkerRef, MarkerRef]) -> Any:
    """A value of a specification with the markers of beams in it replaced by those of their pieces."""
    match value:
        case MarkerRef():
            return places.get(value, value)
        case tuple():
            return tuple(_located(item, places) for item in value)
        case Mapping():
            return {key: _located(item, places) for key, item in value.items()}
        case _ if is_dataclass(value) and not isinstance(value, type):
            own = {f.name: getattr(value, f.name) for f in fields(value) if f.init}
            changed = {name: new for name, old in own.items() if (new := _located(old, places)) != old}
            return replace(value, **changed) if changed else value
        case _:
            return value
