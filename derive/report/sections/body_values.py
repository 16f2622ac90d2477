"""The kinds of bodies in reports, and their masses and stiffnesses, with those of what is attached to a beam."""

from __future__ import annotations

from collections.abc import Iterator

from derive.report.document.page import Block, Content, table
from derive.spec.model.beam_parts import AttachedMass, AxialDeformation, BeamDamping
from derive.spec.model.beam_pieces import whole_beam
from derive.spec.model.planar_bodies import BeamBody, RigidBody, SceneBody
from derive.spec.model.quantity import Parameter, Quantity
from derive.spec.model.spatial_beam import SpatialBeam, SpatialBody
from derive.spec.model.spatial_bodies import FlexibleBody, SpatialRigidBody
from derive.spec.model.specification import AnyScene

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
"""The digits of exponents."""
INERTIA, BENDING = "kg\u00a0m²", "N\u00a0m²"
PRODUCTS = ("Jxx", "Jyy", "Jzz", "Jxy", "Jxz", "Jyz")
"""The entries of a tensor of inertia."""


def body_kind(body: SceneBody | SpatialBody) -> str:
    """The kind of a body, with the frame of a flexible one."""
    if isinstance(body, FlexibleBody):
        return f"flexible, {body.body.frame.kind} frame"
    if isinstance(body, SpatialBeam):
        piece = body.piece_of
        of = f"piece {piece.number + 1} of {body.pieces} of {piece.rod.name}, a " if piece else ""
        return f"{of}beam in space, {body.frame.kind} frame"
    if not isinstance(body, BeamBody):
        return body.kind
    cut = f" in {body.pieces} pieces" if body.pieces > 1 else ""
    return f"flexible{cut}, {body.beam.frame.kind} frame"


def body_values(body: SceneBody | SpatialBody) -> str:
    """The masses and the stiffnesses of a body."""
    match body:
        case SpatialRigidBody(mass=mass, inertia=inertia) if mass is not None and inertia is not None:
            about = ", ".join(value_text(entry, INERTIA) for entry in inertia[:3])
            return f"{value_text(mass, 'kg')}; {about} about its axes"
        case FlexibleBody():
            return f"{len(body.body.data.positions)} nodes"
        case SpatialBeam():
            whole = "the whole beam: " if body.piece_of else ""
            return f"{whole}{', '.join(_beam_in_space(whole_beam(body)))}"
        case BeamBody():
            return ", ".join(_planar_beam(body))
        case RigidBody(mass=mass) if mass is not None:
            values = [value_text(mass, "kg")]
            return ", ".join(values + ([value_text(body.inertia, INERTIA)] if body.inertia is not None else []))
        case _:
            return ""


def _planar_beam(body: BeamBody) -> Iterator[str]:
    beam = body.beam
    yield value_text(beam.mass, "kg")
    yield value_text(beam.length, "m")
    yield f"bending stiffness {value_text(beam.bending_stiffness, BENDING)}"
    yield from _deformation(beam.axial, beam.damping)
    yield from map(_attached, beam.masses)


def _beam_in_space(beam: SpatialBeam) -> Iterator[str]:
    yield value_text(beam.mass, "kg")
    yield f"{value_text(beam.rotary_inertia, INERTIA)} about its axis"
    if any(beam.centre):
        beside = " and ".join(f"{value_text(x, 'm')} along e{k}" for k, x in enumerate(beam.centre, 2) if x != 0)
        yield f"centre of mass of its sections {beside}"
    yield value_text(beam.length, "m")
    stiffnesses = dict.fromkeys(beam.bending_stiffnesses)
    yield f"bending stiffness {' and '.join(value_text(x, BENDING) for x in stiffnesses)}"
    if beam.torsion:
        yield f"torsional stiffness {value_text(beam.torsion.stiffness, BENDING)}"
    yield from _deformation(beam.axial, beam.damping)


def _deformation(axial: AxialDeformation | None, damping: BeamDamping | None) -> Iterator[str]:
    """The axial stiffness and the damping of a beam."""
    if axial:
        at_rest = f" and force at rest {value_text(axial.preload, 'N')}" if axial.preload != 0 else ""
        yield f"axial stiffness {value_text(axial.stiffness, 'N')}{at_rest}"
    if damping:
        of_modes = (
            ("ratio", damping.ratio, ""),
            ("of mass", damping.mass, "1/s"),
            ("of stiffness", damping.stiffness, "s"),
        )
        yield " and ".join(f"damping {of} {value_text(x, unit)}" for of, x, unit in of_modes if x != 0) or "damping 0"


def _attached(mass: AttachedMass) -> str:
    """A mass that is attached to a beam, with its inertia if it has one."""
    values = [value_text(mass.mass, "kg"), *([value_text(mass.inertia, INERTIA)] if mass.inertia else [])]
    return f"{' and '.join(values)} attached at ξ = {float(mass.at):g} ({mass.name})"


def section_mass_blocks(spec: AnyScene) -> tuple[Block, ...]:
    """The table of the masses that are attached to beams in space; none without such masses."""
    beams = (whole_beam(body) for body in spec.bodies if isinstance(body, SpatialBeam))
    rows: list[list[Content]] = []
    for beam in {beam.name: beam for beam in beams}.values():
        for of in beam.masses:
            entries = zip(PRODUCTS, of.inertia or (), strict=False)
            inertia = ", ".join(
                f"{name}\u00a0=\u00a0{value_text(entry, INERTIA)}" for name, entry in entries if entry != 0
            )
            centre = ", ".join(value_text(x, "") for x in of.centre)
            own = [value_text(of.mass, "kg"), inertia or "that of a point", f"[{centre}]\u00a0m"]
            rows.append([of.name, beam.name, f"{float(of.at):g}", *own])
    head = ("name", "beam", "at\u00a0ξ", "mass", "inertia about its centre", "centre")
    text = "Attached masses, with components along the axes of their sections"
    return (table(text, head, rows),) if rows else ()


def value_text(quantity: Quantity, unit: str) -> str:
    """A value with its unit, between which no line breaks: 2.194·10⁻⁶ kg m²."""
    if isinstance(quantity, Parameter):
        return f"{quantity.symbol}\u00a0{unit}".rstrip("\u00a0")
    mantissa, _, exponent = f"{float(quantity):g}".partition("e")
    power = f"·10{str(int(exponent)).translate(SUPERSCRIPTS)}" if exponent else ""
    return f"{mantissa}{power}\u00a0{unit}".rstrip("\u00a0")
