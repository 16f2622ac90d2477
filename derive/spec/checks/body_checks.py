"""Algebraic checks of the shape functions of a beam."""

from __future__ import annotations

from collections.abc import Mapping

from pydantic import ValidationError

from derive.spec.model.beam_parts import AssumedDeflection
from derive.spec.parsing.faults import Fault, KeyPath
from derive.spec.tables.beam import AXIAL, DEFLECTION


def shape_faults(path: KeyPath, beam: object) -> list[Fault]:
    """Faults of the ansatz and the axial ansatz in their frame; none if one of them cannot be read."""
    try:
        deflection = DEFLECTION.validate_python(beam)
    except ValidationError:
        return []
    return [*_faults((*path, "ansatz"), deflection), *_axial_faults(path, beam, deflection)]


def _faults(path: KeyPath, deflection: AssumedDeflection) -> list[Fault]:
    # SymPy takes its time to import, which a specification that fails before has not to wait for.
    from derive.mechanics.bodies.reference_conditions import ConditionError, assumed_shapes

    try:
        assumed_shapes(deflection)
    except ConditionError as error:
        return [Fault(path, message) for message in error.problems]
    return []


def _axial_faults(path: KeyPath, beam: object, deflection: AssumedDeflection) -> list[Fault]:
    if not isinstance(beam, Mapping) or beam.get("axial") is None:
        return []
    try:
        axial = AXIAL.validate_python(beam["axial"])
    except ValidationError:
        return []
    from derive.mechanics.bodies.displacement_fields import axial_shapes
    from derive.mechanics.bodies.reference_conditions import ConditionError

    try:
        axial_shapes(axial.ansatz, deflection.frame, deflection.orthogonal)
    except ConditionError as error:
        return [Fault((*path, "axial", "ansatz"), message) for message in error.problems]
    return []
