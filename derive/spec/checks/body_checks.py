"""Algebraic checks of the shape functions of a beam."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from pydantic import ValidationError

from derive.spec.model.beam_parts import AssumedDeflection, Polynomial
from derive.spec.parsing.faults import Fault, KeyPath
from derive.spec.tables.beam import AXIAL, DEFLECTION


def shape_faults(path: KeyPath, beam: object) -> list[Fault]:
    """Faults of the ansatz and the axial ansatz in their frame; none if one of them cannot be read."""
    try:
        deflection = DEFLECTION.validate_python(beam)
    except ValidationError:
        return []
    return [*_faults((*path, "ansatz"), deflection), *_axial_faults(path, beam, deflection)]


def spatial_shape_faults(path: KeyPath, beam: Mapping[str, object]) -> list[Fault]:
    """Faults of all shapes of a beam in space: those of a planar beam, of the other deflection, and of torsion."""
    faults = shape_faults(path, beam)
    try:
        deflection, lateral = both_deflections(beam)
    except ValidationError:
        return faults
    if lateral is not deflection:
        faults += _faults((*path, "lateral", "ansatz"), lateral)
    return faults + _axial_faults(path, beam, deflection, "torsion")


def both_deflections(beam: Mapping[str, object]) -> tuple[AssumedDeflection, AssumedDeflection]:
    """The assumed deflections of a beam in space along e2 and e3. Raises ValidationError if one cannot be read."""
    deflection, lateral = DEFLECTION.validate_python(beam), beam.get("lateral")
    if not isinstance(lateral, Mapping) or "ansatz" not in lateral:
        return deflection, deflection
    other = DEFLECTION.validate_python({**beam, "ansatz": lateral["ansatz"]})
    return deflection, replace(deflection, ansatz=other.ansatz)


def torsion_ansatz(beam: Mapping[str, object]) -> tuple[Polynomial, ...]:
    """The ansatz of the torsion of a beam in space. Raises ValidationError if it cannot be read."""
    return () if beam.get("torsion") is None else AXIAL.validate_python(beam["torsion"]).ansatz


def _faults(path: KeyPath, deflection: AssumedDeflection) -> list[Fault]:
    # SymPy takes its time to import, which a specification that fails before has not to wait for.
    from derive.mechanics.bodies.reference_conditions import ConditionError, assumed_shapes

    try:
        assumed_shapes(deflection)
    except ConditionError as error:
        return [Fault(path, message) for message in error.problems]
    return []


def _axial_faults(path: KeyPath, beam: object, deflection: AssumedDeflection, key: str = "axial") -> list[Fault]:
    if not isinstance(beam, Mapping) or beam.get(key) is None:
        return []
    try:
        axial = AXIAL.validate_python(beam[key])
    except ValidationError:
        return []
    from derive.mechanics.bodies.displacement_fields import axial_shapes
    from derive.mechanics.bodies.reference_conditions import ConditionError

    try:
        axial_shapes(axial.ansatz, deflection.frame, deflection.orthogonal)
    except ConditionError as error:
        return [Fault((*path, key, "ansatz"), message) for message in error.problems]
    return []
