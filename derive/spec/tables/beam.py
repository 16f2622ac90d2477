"""The tables of a beam, alone and in a scene, and of its parts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from fractions import Fraction
from typing import Annotated, Any

from pydantic import ConfigDict, PlainValidator, TypeAdapter, WithJsonSchema

from derive.mechanics.multibody.bodies.beam import WHOLE_BEAM
from derive.mechanics.multibody.bodies.beam_loads import point_names
from derive.mechanics.multibody.bodies.registry import BODIES
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import (
    DEFAULT_FRAME,
    FAMILY_FRAMES,
    AssumedDeflection,
    AttachedMass,
    AxialDeformation,
    BeamDamping,
    Ends,
    Frame,
    FrameKind,
    Polynomial,
    ShapeFamily,
)
from derive.spec.model.body import Damping, DisplacementOrder
from derive.spec.model.instances import COUNT
from derive.spec.model.keys import KeyType, declared_keys
from derive.spec.model.planar_bodies import BeamBody, DistributedLoad
from derive.spec.model.simulation import OF_BEAMS, InitialValues
from derive.spec.parsing import choices
from derive.spec.parsing.values import WrongValueError
from derive.spec.tables.declared_tables import TABLES, declare
from derive.spec.tables.shared import TomlTable
from derive.spec.tables.value_types import VALUE_TYPES

BEAM_KEYS = BODIES["beam"].identifying_keys
"""The keys by which a body is a beam."""


def frame_from(kind: FrameKind, at: Fraction | None = None) -> Frame:
    """A frame, if its kind and its position go together; a point is the middle of the beam by default."""
    if kind == "point":
        return Frame(kind, Fraction(0) if at is None else at)
    if kind == "tangent":
        if at not in (-1, 1):
            raise WrongValueError('a tangent frame needs the end it is at: { kind = "tangent", at = -1 } or at = 1')
        return Frame(kind, at)
    if at is not None:
        raise WrongValueError(f'the frame "{kind}" has no place; leave `at` out, or choose "point"')
    return Frame(kind)


def damping(of: type) -> Callable[..., Any]:
    """The function that makes damping of a type from either a ratio or factors of mass and stiffness."""

    def made(**given: Any) -> Any:
        if ("ratio" in given) == bool({"mass", "stiffness"} & given.keys()):
            raise WrongValueError(
                "write either { ratio = 0.01 }, of critical damping, or { mass = 0.1, stiffness = 1e-5 }, in 1/s and s"
            )
        return of(**given)

    return made


def _check_load(load: DistributedLoad) -> None:
    if not any(load.force):
        raise WrongValueError("both components of the load are zero; leave it out")


def assumed_deflection(
    ansatz: tuple[Polynomial, ...] | ShapeFamily,
    frame: Frame | None = None,
    orthogonal: bool | None = None,
    ends: Ends | None = None,
) -> AssumedDeflection:
    """The assumed deflection; by default its frame is that of the family of shapes, or the mean frame."""
    if frame is None:
        frame = FAMILY_FRAMES[ansatz.kind] if isinstance(ansatz, ShapeFamily) else Frame(DEFAULT_FRAME)
    return AssumedDeflection(ansatz, frame, frame.kind == "mean" if orthogonal is None else orthogonal, ends)


def _beam(order: int, terms: str | None = None, **given: Any) -> PlanarBeam:
    """The beam, whose deflection and order are completed. Raises WrongValueError."""
    shapes = assumed_deflection(**{field.name: given.pop(field.name, None) for field in fields(AssumedDeflection)})
    if shapes.ends is not None and isinstance(shapes.ansatz, ShapeFamily):
        raise WrongValueError(
            f"`ends` is for polynomials; {shapes.ansatz.kind} shapes fulfil conditions of their own; leave it out"
        )
    by_default = "full" if shapes.frame.kind in ("point", "tangent") else "truncated"
    second = DisplacementOrder.FULL if (terms or by_default) == "full" else DisplacementOrder.TRUNCATED
    beam = PlanarBeam(order=DisplacementOrder.FIRST_ORDER if order == 1 else second, **vars(shapes), **given)
    _check_axial(beam)
    if order == 1 and terms is not None:
        raise WrongValueError(f'terms = "{terms}" is for beams of order 2; write order = 2 beside it, or leave it out')
    return beam


def _check_axial(beam: PlanarBeam) -> None:
    """Refuse a preload at first order, and rotary inertia of masses in the full model of a beam that stretches."""
    if beam.axial is None:
        return
    if beam.order is DisplacementOrder.FIRST_ORDER and beam.axial.preload != 0:
        raise WrongValueError(
            "a preload stiffens a beam through the strain of second order; write order = 2, or leave `preload` out"
        )
    turning = [mass.name for mass in beam.masses if mass.inertia != 0]
    if turning and beam.order is DisplacementOrder.FULL:
        raise WrongValueError(
            f"the full model of a beam that stretches takes no rotary inertia of attached masses ({turning[0]}); "
            'write terms = "truncated", or leave `inertia` out'
        )


def _beam_body(name: str, **given: Any) -> BeamBody:
    own = {key.field: given.pop(key.field) for key in declared_keys(BeamBody)}
    return BeamBody(name, _beam(name=name, **given), **own)


def _check_beam_body(body: BeamBody) -> None:
    """Refuse families of shapes for a beam in pieces, and loads with names of markers."""
    for load in body.loads:
        if taken := point_names(load.name, body.pieces) & {marker.name for marker in body.markers}:
            text = f"a point of the load {load.name} is called like the marker {min(taken)}; rename one of them"
            raise WrongValueError(text)
    if body.pieces > 1 and (body.beam.ends is not None or isinstance(body.beam.ansatz, ShapeFamily)):
        raise WrongValueError(WHOLE_BEAM)


class PartOfBeamTable(TomlTable):
    """Some keys of the table of a beam, which are checked even if another key is at fault."""

    model_config = ConfigDict(extra="ignore")


class AnyBeamTable(TomlTable):
    """The table of a beam in a scene."""

    model_config = ConfigDict(json_schema_extra={"anyOf": [{"required": [key]} for key in BEAM_KEYS]})


# A plain "tangent" would not say which end is meant.
_PLAIN = [kind for kind in choices.FRAME_KINDS if kind != "tangent"]
_plain_frame = PlainValidator(lambda value: frame_from(choices.frame_kind(value)))
declare(
    Frame,
    "FrameTable",
    make=frame_from,
    plain=Annotated[Frame, _plain_frame, WithJsonSchema({"enum": _PLAIN})],
    doc="The kind of a floating frame of a beam, and its position.",
)
declare(ShapeFamily, "ShapeFamilyTable", plain=VALUE_TYPES[KeyType.SHAPES])
_axial = declare(AxialDeformation, "AxialTable")
AXIAL: TypeAdapter[AxialDeformation] = TypeAdapter(_axial.value)
"""The reader of the table of the stretching of a beam, other keys of which may be faulty."""

declare(BeamDamping, "BeamDampingTable", make=damping(BeamDamping))
DAMPING = declare(Damping, "DampingTable", make=damping(Damping))
declare(AttachedMass, "AttachedMassTable")
declare(DistributedLoad, "LoadTable", check=_check_load)

_of_body = tuple(key for key in declared_keys(InitialValues) if key.name not in OF_BEAMS)
_bent = tuple(key for key in declared_keys(InitialValues) if key.name in OF_BEAMS)
declare(InitialValues, "StartTable", keys=_of_body)
BEAM_START = declare(
    InitialValues,
    "BeamStartTable",
    keys=(*_of_body, *_bent),
    doc="Initial values of a beam. The initial state keeps what is given; values that are not given adapt to it.",
)

_keys = {key.name: key for key in declared_keys(PlanarBeam)}
_shapes = tuple(_keys.pop(field.name) for field in fields(AssumedDeflection))
_alone = (_keys.pop("gravity"), _keys.pop("start"))
_constants = tuple(_keys.pop(name) for name in ("mass", "length", "bending_stiffness"))
_parts = tuple(_keys.pop(name) for name in ("axial", "damping", "masses"))
_of_every_beam = (*_shapes, *_constants, *_parts, *_keys.values())
_tables = {**TABLES, InitialValues: BEAM_START}
BEAM = declare(PlanarBeam, "BeamTable", keys=(*_of_every_beam, *_alone), make=_beam, tables=_tables)
BEAM_BODY = declare(
    BeamBody,
    "BeamBodyTable",
    keys=(*_of_every_beam, *declared_keys(BeamBody), COUNT),
    make=_beam_body,
    check=_check_beam_body,
    base=AnyBeamTable,
    tables=_tables,
)
_deflected = declare(AssumedDeflection, "ShapeKeys", keys=_shapes, make=assumed_deflection, base=PartOfBeamTable)
DEFLECTION: TypeAdapter[AssumedDeflection] = TypeAdapter(_deflected.value)
"""The reader of the assumed deflection in the table of a beam, other keys of which may be faulty."""
