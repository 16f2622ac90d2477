"""Algebraic checks of the shape functions of a beam."""

from __future__ import annotations

from pydantic import ValidationError

from derive.spec.parsing.faults import Fault, KeyPath
from derive.spec.tables.beam import ShapeKeys


def shape_faults(path: KeyPath, beam: object) -> list[Fault]:
    """What is wrong with the ansatz in its frame, if they are valid as they are written."""
    try:
        keys = ShapeKeys.model_validate(beam)
    except ValidationError:
        return []
    # SymPy takes its time to import, which a specification that fails before has not to wait for.
    from derive.mechanics.bodies.reference_conditions import ConditionError, assumed_shapes

    try:
        assumed_shapes(keys.deflection())
    except ConditionError as error:
        return [Fault((*path, "ansatz"), message) for message in error.problems]
    return []
