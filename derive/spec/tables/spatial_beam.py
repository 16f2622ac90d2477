"""The table of a beam in a scene in space, and of its parts."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from derive.mechanics.multibody.bodies.beam import WHOLE_BEAM
from derive.mechanics.multibody.bodies.beam_loads import section_names
from derive.spec.model.beam_parts import ShapeFamily
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.instances import COUNT
from derive.spec.model.keys import KeyType, declared_keys
from derive.spec.model.spatial_beam import DEFLECTION_FIELDS, SpatialBeam
from derive.spec.model.spatial_beam_parts import (
    LateralDeflection,
    SectionFrame,
    SpatialAttachedMass,
    SpatialDistributedLoad,
    TorsionalDeformation,
)
from derive.spec.model.spatial_start import CURVE_RATES, CURVES, SpatialInitialValues
from derive.spec.parsing.values import WrongValueError
from derive.spec.tables.beam import assumed_deflection, check_first_order
from derive.spec.tables.declared_tables import TABLES, DeclaredTable, declare
from derive.spec.tables.inertia_tensor import check_tensor
from derive.spec.tables.value_types import VALUE_TYPES, markers_type


def _check_mass(of: SpatialAttachedMass) -> None:
    if of.inertia is not None and any(of.inertia):
        check_tensor(of.inertia)


def _check_load(load: SpatialDistributedLoad) -> None:
    if not any((*load.force, *load.torque)):
        raise WrongValueError("the load is zero; give it a force or a torque, or leave it out")


declare(LateralDeflection, "LateralTable")
declare(TorsionalDeformation, "TorsionTable")
declare(SpatialAttachedMass, "SpatialAttachedMassTable", check=_check_mass)
declare(SpatialDistributedLoad, "SpatialLoadTable", check=_check_load)
SECTION_FRAME = declare(
    SectionFrame,
    "SectionFrameTable",
    plain=VALUE_TYPES[KeyType.POSITION],
    doc="A marker of a beam in space: its position, and its rotation.",
)


def _section_frame(name: str, at: Any) -> SectionFrame:
    return replace(at, name=name) if isinstance(at, SectionFrame) else SectionFrame(name, at)


VALUE_TYPES[KeyType.SECTION_FRAMES] = markers_type(SECTION_FRAME.value, "positions", _section_frame)


def _beam(name: str, order: int, terms: str | None = None, **given: Any) -> SpatialBeam:
    """The beam, whose deflection and order are completed. Raises WrongValueError."""
    shapes = assumed_deflection(**{field: given.pop(field, None) for field in DEFLECTION_FIELDS})
    own = {field: getattr(shapes, field) for field in DEFLECTION_FIELDS}
    second = DisplacementOrder.FULL if terms == "full" else DisplacementOrder.TRUNCATED
    kept = DisplacementOrder.FIRST_ORDER if order == 1 else second
    beam = SpatialBeam(name=name, order=kept, **own, **given)
    if beam.ends is not None and any(isinstance(of.ansatz, ShapeFamily) for of in beam.deflections):
        raise WrongValueError("`ends` is for polynomials; families of shapes fulfil conditions of their own")
    if beam.pieces > 1 and (
        beam.ends is not None or any(isinstance(of.ansatz, ShapeFamily) for of in beam.deflections)
    ):
        raise WrongValueError(WHOLE_BEAM)
    if beam.pieces > 1 and (beam.start.amplitudes is not None or beam.start.amplitude_rates is not None):
        raise WrongValueError(
            "amplitudes belong to the shapes of a beam in one piece; write `deflection` and `twist`, polynomials along "
            "the whole beam, in `start`, or leave `pieces` out"
        )
    of_loads = {name for load in beam.loads for name in section_names(load.name, beam.pieces)}
    taken = of_loads & {marker.name for marker in beam.markers}
    if taken:
        raise WrongValueError(f"a point of a load is called like the marker {min(taken)}; rename one of them")
    check_first_order(beam, terms)
    return beam


def _check_start(start: SpatialInitialValues) -> None:
    """Refuse amplitudes beside the deflections that they make up."""
    for amplitudes, curves in (("amplitudes", CURVES), ("amplitude_rates", CURVE_RATES)):
        given = [name for name in curves if getattr(start, name) is not None]
        if getattr(start, amplitudes) is not None and given:
            raise WrongValueError(f"`{amplitudes}` and `{given[0]}` describe the same; leave one of them out")


def beam_in_space() -> DeclaredTable:
    """The table of a beam in space, after that of the initial values of every body is declared."""
    start = declare(
        SpatialInitialValues,
        "SpatialBeamStartTable",
        check=_check_start,
        doc="Initial values of a beam in space. The initial state keeps what is given; values not given adapt to it.",
    )
    tables, keys = {**TABLES, SpatialInitialValues: start}, (*declared_keys(SpatialBeam), COUNT)
    return declare(SpatialBeam, "SpatialBeamTable", keys=keys, make=_beam, tables=tables)
