"""The beam of a mechanism in space: its body, and marker frames that turn with its sections."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from derive.algebra import sp
from derive.mechanics.bodies.beam_damping import DAMPING_DOCS
from derive.mechanics.multibody.bodies.body_type import BodyType, Component, ComponentDamping, Constant, CrossSection
from derive.mechanics.multibody.bodies.rigid import BODY_FRAME
from derive.mechanics.multibody.bodies.shared_damping import shared_damping
from derive.spec.model.beam_pieces import CUT, piece_name, whole_beam
from derive.spec.model.spatial_beam import PieceOf, SpatialBeam
from derive.spec.model.spatial_start import NOT_GIVEN_IN_SPACE

if TYPE_CHECKING:
    from derive.mechanics.body import Body
    from derive.mechanics.terms import ModelConstant

KEPT = 32
"""The number of beams that are kept, since many bodies of a scene may be equal but for their names."""


TENSOR = ("xx", "yy", "zz", "xy", "xz", "yz")
"""The entries of a tensor of inertia in a specification."""


class BeamInSpace(BodyType[SpatialBeam]):
    """The type of a beam in space, which keeps all its coordinates."""

    doc = "beam in space"

    def components(self, body: SpatialBeam, gravity: tuple[ModelConstant, ...]) -> tuple[Component, ...]:
        """The beam with its floating frame."""
        from derive.mechanics.multibody.space.beam_loads import load_sections

        alike = replace(body, name="", start=NOT_GIVEN_IN_SPACE, loads=(), piece_of=_alike(body.piece_of))
        of, sections = _beam(alike, gravity)
        rod, names = whole_beam(body).name, tuple(m.name for m in body.markers if m.name not in CUT)
        # The pieces without masses share their constants.
        group = body.name if body.masses else rod
        return (Component(body.name, group, of, {**sections, **load_sections(body)}, names, rod),)

    def forces(self, body: SpatialBeam) -> tuple[Any, ...]:
        """The forces and torques by which distributed loads act."""
        from derive.mechanics.multibody.space.beam_loads import load_actions

        return tuple(load_actions(body))

    def constants(self, body: SpatialBeam) -> Iterator[Constant]:
        """The mass, length, inertia and stiffnesses, the offset of the centres of mass, masses, the damping."""
        if body.piece_of and body.piece_of.number:
            return  # those of the first piece
        name = whole_beam(body).name
        yield Constant(body.mass, f"mass of {name}", positive=True)
        yield Constant(body.length, f"length of {name}", positive=True)
        yield Constant(body.rotary_inertia, f"moment of inertia of {name} about its axis", positive=True)
        for axis, value in zip((3, 2), body.bending_stiffnesses, strict=True):
            yield Constant(value, f"bending stiffness EI of {name} about its e{axis}", positive=True)
        if body.torsion:
            yield Constant(body.torsion.stiffness, f"torsional stiffness GJ of {name}", positive=True)
        if body.axial:
            yield Constant(body.axial.stiffness, f"axial stiffness EA of {name}", positive=True)
            yield Constant(body.axial.preload, f"axial force at rest of {name}")
        for axis, value in zip((2, 3), body.centre, strict=True):
            yield Constant(value, f"offset of the centres of mass of {name} along its e{axis}")
        for m in whole_beam(body).masses:
            what = f"the mass {m.name} on {name}"
            yield Constant(m.mass, f"mass {m.name} that is attached to {name}", positive=True)
            for component, value in zip(TENSOR, m.inertia or (), strict=False):
                yield Constant(value, f"moment of inertia J{component} of {what}")
            for axis, value in enumerate(m.centre, 1):
                yield Constant(value, f"offset of {what} along e{axis}")
        for key, value in vars(body.damping).items() if body.damping else ():
            yield Constant(value, f"{DAMPING_DOCS[key]} of {name}")

    def damping(self, body: SpatialBeam) -> ComponentDamping | None:
        """The damping of a beam in pieces, where equal entries share a constant; of its first piece alone."""
        if body.damping is None or body.piece_of is None or body.piece_of.number:
            return None
        from derive.mechanics.bodies.section_fields import section_shapes
        from derive.mechanics.bodies.spatial_beam import damping_constants

        rod = body.piece_of.rod
        names = tuple(piece_name(rod.name, rod.pieces, k) for k in range(rod.pieces))
        return shared_damping(rod.name, names, damping_constants(body, section_shapes(body)))


def _alike(piece: PieceOf | None) -> PieceOf | None:
    """The place of a piece without what its equations do not depend on."""
    if piece is None:
        return None
    return PieceOf(replace(piece.rod, name="", markers=(), masses=(), loads=(), start=NOT_GIVEN_IN_SPACE), 0)


@lru_cache(KEPT)
def _beam(beam: SpatialBeam, gravity: tuple[ModelConstant, ...]) -> tuple[Body, Mapping[str, CrossSection]]:
    from derive.mechanics.bodies.spatial_beam import spatial_beam_body
    from derive.mechanics.motion.material_points import MaterialPoint
    from derive.mechanics.multibody.space.beam_sections import section_at

    body = spatial_beam_body(beam, gravity)
    sections = {m.name: section_at(m, beam) for m in beam.markers}
    still = sp.ImmutableMatrix([0, 0, 0])
    origin = MaterialPoint(BODY_FRAME, "origin of the floating frame", still, (still,) * body.modes)
    sections[BODY_FRAME] = CrossSection(origin, twists=(still,) * body.modes)
    return body, sections
