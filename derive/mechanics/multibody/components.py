"""The bodies of a scene one by one: rods cut into pieces, and the points by which joints and forces know them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

import sympy as sp

from derive.mechanics import quantity
from derive.mechanics.bodies.beam import beam_body, beam_point, section_turns
from derive.mechanics.bodies.rigid import rigid_body, rigid_point
from derive.mechanics.equations import Coefficient, ParameterSymbol
from derive.mechanics.points import MaterialPoint
from derive.mechanics.virtual_work_equations import Body
from derive.spec.model.body import Marker, Parameter, Quantity
from derive.spec.model.scene import BeamBody, Joint, MarkerRef, RigidBody, Scene

CUT = ("cut_left", "cut_right")
"""The ends at which pieces are welded together."""


@dataclass(frozen=True)
class Section:
    """A material point, and the rotations of the body's section there by each shape (none in a rigid body)."""

    point: MaterialPoint
    turns: tuple[Coefficient, ...] = ()


@dataclass(frozen=True)
class Member:
    """A body with coordinates of its own: `name` begins the names of these, `group` those of its coefficients.

    Pieces of one rod share their coefficients, so `body` is one for all of them. `shown` are the markers a user named.
    """

    name: str
    group: str
    body: Body
    sections: Mapping[str, Section]
    shown: tuple[str, ...]


def beam_members(rod: BeamBody, gravity: tuple[Coefficient, ...]) -> tuple[Member, ...]:
    """The pieces of a rod from its left to its right end."""
    n = rod.pieces
    body = replace(beam_body(replace(rod.beam, markers=()), n), gravity=gravity)
    found = []
    for k in range(n):
        own = [Marker(m.name, place_in_piece(m.at, n)) for m in rod.beam.markers if piece_of(m.at, n) == k]
        ends = [Marker(CUT[0], Fraction(-1))] if k else []
        ends += [Marker(CUT[1], Fraction(1))] if k < n - 1 else []
        sections = {m.name: Section(beam_point(m, rod.beam, n), section_turns(m, rod.beam, n)) for m in (*own, *ends)}
        found.append(Member(piece_name(rod, k), rod.name, body, sections, tuple(m.name for m in own)))
    return tuple(found)


def piece_name(rod: BeamBody, k: int) -> str:
    """The name of piece k, counted from 0."""
    return f"{rod.name}_{k + 1}" if rod.pieces > 1 else rod.name


def piece_of(at: Fraction, pieces: int) -> int:
    """The piece in which a place of the rod lies, counted from 0; of two that meet there, the left one."""
    along = (at + 1) / 2 * pieces
    return max(-(-along.numerator // along.denominator) - 1, 0)


def place_in_piece(at: Fraction, pieces: int) -> Fraction:
    """Its xi in that piece."""
    return (at + 1) * pieces - 2 * piece_of(at, pieces) - 1


def welds(rod: BeamBody) -> tuple[Joint, ...]:
    """What holds the pieces of a rod together."""
    pairs = ((piece_name(rod, k), piece_name(rod, k + 1)) for k in range(rod.pieces - 1))
    return tuple(
        Joint(f"{rod.name}_cut_{k}", "weld", MarkerRef(left, CUT[1]), MarkerRef(right, CUT[0]))
        for k, (left, right) in enumerate(pairs, 1)
    )


def rigid_member(rigid: RigidBody, about: str | None, gravity: tuple[Coefficient, ...]) -> Member:
    """A rigid body with its origin O in the marker `about`, or in its centre of mass."""
    centre = sp.Matrix([quantity.value(x, positive=False) for x in rigid.centre])
    places = {m.name: sp.Matrix([quantity.value(x, positive=False) for x in (m.x, m.y)]) for m in rigid.markers}
    origin = places[about] if about else centre
    sections = {name: Section(rigid_point(name, place - origin)) for name, place in places.items()}
    sections[BASE] = Section(rigid_point(BASE, -origin))
    mass, inertia = (sp.S.Zero if x is None else quantity.value(x) for x in (rigid.mass, rigid.inertia))
    body = rigid_body(rigid.name, mass, inertia, centre - origin, (), gravity)
    return Member(rigid.name, rigid.name, body, sections, tuple(places))


BASE = "base"
"""The point of a rigid body from which its markers count."""


def place_of(place: MarkerRef, rods: Mapping[str, BeamBody]) -> MarkerRef:
    """Where a marker is: in a rod cut into pieces, in one of these."""
    rod = rods.get(place.body)
    if rod is None:
        return place
    at = next(m.at for m in rod.beam.markers if m.name == place.marker)
    return MarkerRef(piece_name(rod, piece_of(at, rod.pieces)), place.marker)


def parameters(scene: Scene) -> tuple[ParameterSymbol, ...]:
    """The run-time parameters of a scene, each symbol once, in the order of the specification."""
    found: dict[str, ParameterSymbol] = {}

    def add(value: Quantity | None, doc: str, positive: bool = False) -> None:
        if isinstance(value, Parameter):
            known = found.get(value.symbol)
            doc = f"{known.doc}; {doc}" if known else doc
            positive = positive or bool(known and known.positive)
            found[value.symbol] = quantity.parameter(value, doc, positive)

    for axis, component in enumerate(scene.gravity or (), 1):
        add(component, f"acceleration of free fall along the inertial e{axis}")
    for body in scene.bodies:
        if isinstance(body, BeamBody):
            add(body.beam.mass, f"mass of {body.name}", positive=True)
            add(body.beam.length, f"length of {body.name}", positive=True)
            add(body.beam.bending_stiffness, f"bending stiffness EI of {body.name}", positive=True)
            continue
        add(body.mass, f"mass of {body.name}", positive=True)
        add(body.inertia, f"moment of inertia of {body.name} about its centre of mass", positive=True)
        for axis, x in enumerate(body.centre, 1):
            add(x, f"centre of mass of {body.name} along its e{axis}")
        for m in body.markers:
            add(m.x, f"marker {m.name} of {body.name} along its e1")
            add(m.y, f"marker {m.name} of {body.name} along its e2")
    for point in scene.ground:
        add(point.x, f"point {point.name} of the ground along e1")
        add(point.y, f"point {point.name} of the ground along e2")
    for drive in scene.drives:
        add(drive.speed, f"speed of drive {drive.name}")
    for spring in scene.springs:
        for what in ("stiffness", "damping", "rest"):
            add(getattr(spring, what), f"{what} of spring {spring.name}")
    return tuple(found.values())
