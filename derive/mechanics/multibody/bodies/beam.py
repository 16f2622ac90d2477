"""The flexible rod in a mechanism: a planar beam, cut into pieces of equal length that are welded together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING

from derive.errors import Problem, SpecError
from derive.mechanics.bodies.beam_damping import DAMPING_DOCS, damping_constants
from derive.mechanics.bodies.displacement_fields import stretching_shapes
from derive.mechanics.bodies.reference_conditions import assumed_shapes
from derive.mechanics.multibody.bodies.beam_loads import load_forces, load_points
from derive.mechanics.multibody.bodies.body_type import BodyType, Component, ComponentDamping, Constant, CrossSection
from derive.mechanics.multibody.bodies.shared_damping import shared_damping
from derive.mechanics.terms import ModelConstant
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import AttachedMass, Marker, ShapeFamily
from derive.spec.model.beam_pieces import CUT, piece_of, place_in_piece
from derive.spec.model.beam_pieces import piece_name as name_of_piece
from derive.spec.model.forces import Force
from derive.spec.model.joints import Joint
from derive.spec.model.markers import MarkerRef
from derive.spec.model.planar_bodies import BeamBody

if TYPE_CHECKING:
    from derive.mechanics.body import Body

WHOLE_BEAM = (
    "`ends` and families of shape functions are for beams in one piece: with them the pieces could not bend at the "
    "cuts; leave `pieces` out, or take polynomials without `ends`"
)
"""The message that a beam cannot be cut."""

KEPT = 32
"""The number of pieces that are kept, since many bodies of a scene may be equal but for their names."""


class Beam(BodyType[BeamBody]):
    """The type of a rod of planar beams, which keeps all its coordinates."""

    doc = "beam"
    identifying_keys = ("length", "bending_stiffness", "ansatz", "frame")

    def components(self, body: BeamBody, gravity: tuple[ModelConstant, ...]) -> tuple[Component, ...]:
        """The pieces of the rod from its left to its right end. Raises SpecError if its shapes forbid to cut it."""
        n = body.pieces
        if n > 1 and (body.beam.ends is not None or isinstance(body.beam.ansatz, ShapeFamily)):
            raise SpecError((Problem(f"bodies.{body.name}", WHOLE_BEAM),))
        result = []
        for k in range(n):
            masses = masses_of_piece(body, k)
            own = tuple(Marker(m.name, place_in_piece(m.at, n)) for m in body.beam.markers if piece_of(m.at, n) == k)
            ends = [Marker(CUT[0], Fraction(-1))] if k else []
            ends += [Marker(CUT[1], Fraction(1))] if k < n - 1 else []
            piece, sections = _piece(replace(body.beam, name="", markers=(*own, *ends), masses=masses), n, gravity)
            name = piece_name(body, k)
            # The pieces without masses share their constants.
            group = name if masses else body.name
            every = {**sections, **load_points(body, k)}
            result.append(Component(name, group, piece, every, tuple(m.name for m in own), body.name))
        return tuple(result)

    def constants(self, body: BeamBody) -> Iterator[Constant]:
        """The mass, length and bending stiffness, the damping, the axial constants, and the attached masses."""
        yield Constant(body.beam.mass, f"mass of {body.name}", positive=True)
        yield Constant(body.beam.length, f"length of {body.name}", positive=True)
        yield Constant(body.beam.bending_stiffness, f"bending stiffness EI of {body.name}", positive=True)
        for key, value in vars(body.beam.damping).items() if body.beam.damping else ():
            yield Constant(value, f"{DAMPING_DOCS[key]} of {body.name}")
        if body.beam.axial:
            from derive.mechanics.bodies.beam import AXIAL_DOCS

            yield Constant(body.beam.axial.stiffness, f"{AXIAL_DOCS['stiffness']} of {body.name}", positive=True)
            yield Constant(body.beam.axial.preload, f"{AXIAL_DOCS['preload']} of {body.name}")
        for m in body.beam.masses:
            yield Constant(m.mass, f"mass {m.name} that is attached to {body.name}", positive=True)
            yield Constant(m.inertia, f"moment of inertia of the mass {m.name} on {body.name}")

    def joints(self, body: BeamBody) -> tuple[Joint, ...]:
        """The welds between the pieces of the rod."""
        pairs = ((piece_name(body, k), piece_name(body, k + 1)) for k in range(body.pieces - 1))
        return tuple(
            Joint(f"{body.name}_cut_{k}", "weld", MarkerRef(left, CUT[1]), MarkerRef(right, CUT[0]))
            for k, (left, right) in enumerate(pairs, 1)
        )

    def damping(self, body: BeamBody) -> ComponentDamping | None:
        """The damping of a rod in pieces, where equal entries share a constant; None for a rod in one piece."""
        if body.beam.damping is None or body.pieces == 1:
            return None
        names = tuple(piece_name(body, k) for k in range(body.pieces))
        return shared_damping(body.name, names, damping_constants(body.beam, body.pieces))

    def forces(self, body: BeamBody) -> tuple[Force, ...]:
        """The resultants of the distributed loads."""
        return tuple(force for k in range(body.pieces) for force in load_forces(body, k, piece_name(body, k)))

    def located(self, body: BeamBody, marker: str) -> MarkerRef:
        """The piece that a marker lies on, with the marker there."""
        at = next(m.at for m in body.beam.markers if m.name == marker)
        return MarkerRef(piece_name(body, piece_of(at, body.pieces)), marker)

    def note(self, body: BeamBody) -> str:
        """A description of the shape functions of a rod, which drawings of the rod need."""
        shapes = assumed_shapes(body.beam.deflection)
        texts = ", ".join(f"phi_{i} = {shape.text}" for i, shape in enumerate(shapes, 1))
        each = f"{body.name}, each of {body.pieces} pieces" if body.pieces > 1 else body.name
        text = f"Deflection of {each}, along its e2: alpha1 phi_1 + ..., {texts}; xi = 2 x / length."
        along = stretching_shapes(body.beam)
        if not along:
            return text
        stretch = " + ".join(f"alpha{k} ({shape.text})" for k, shape in enumerate(along, len(shapes) + 1))
        return f"{text} Stretching, along its e1: {stretch}."


@lru_cache(KEPT)
def _piece(
    beam: PlanarBeam, pieces: int, gravity: tuple[ModelConstant, ...]
) -> tuple[Body, Mapping[str, CrossSection]]:
    """One of the equal pieces of a beam, with the markers and masses of the piece, and its cross-sections there."""
    from derive.mechanics.bodies.beam import beam_body, beam_point, section_rotations

    sections = {
        m.name: CrossSection(beam_point(m, beam, pieces), section_rotations(m, beam, pieces)) for m in beam.markers
    }
    return replace(beam_body(replace(beam, markers=()), pieces), gravity=gravity), sections


def piece_name(rod: BeamBody, k: int) -> str:
    """The name of piece k, counted from 0."""
    return name_of_piece(rod.name, rod.pieces, k)


def masses_of_piece(rod: BeamBody, k: int) -> tuple[AttachedMass, ...]:
    """The attached masses on piece k, counted from 0, with their positions in it."""
    n = rod.pieces
    return tuple(replace(m, at=place_in_piece(m.at, n)) for m in rod.beam.masses if piece_of(m.at, n) == k)
