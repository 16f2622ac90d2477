"""The rigid body in space: no shapes, and the moments of X about the origin of its frame."""

from __future__ import annotations

from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.axes import AXES, PAIRS
from derive.mechanics.bodies.spatial_tables import DOCS, rigid_tables
from derive.mechanics.body import Body, ExactValues
from derive.mechanics.motion.material_points import MaterialPoint
from derive.mechanics.symbols import Family, Identity
from derive.mechanics.terms import ModelConstant
from derive.mechanics.zero_reasons import AT_CENTRE
from derive.roles import Source

if TYPE_CHECKING:
    pass

SYMMETRIC_BODY = "the specification (no such product of inertia)"


def spatial_rigid_body(
    name: str, mass: sp.Expr, inertia: sp.Matrix, centre: sp.Matrix, gravity: tuple[ModelConstant, ...]
) -> Body:
    """A rigid body; `inertia` (3, 3) is about the centre of mass, `centre` (3, 1) counts from O."""
    about = inertia + mass * (centre.dot(centre) * sp.eye(3) - centre * centre.T)
    first, tensor = DOCS[Family.C1], DOCS[Family.C3]
    constants = [
        ModelConstant(
            Identity(Family.C1, components=(k,)).symbol, value, Source.APPENDIX, *first, None if value else AT_CENTRE
        )
        for k in AXES
        for value in [sp.expand(mass * centre[k - 1])]
    ]
    constants += [
        ModelConstant(
            Identity(Family.C3, components=(a, b)).symbol,
            value,
            Source.APPENDIX,
            *tensor,
            None if value else SYMMETRIC_BODY,
        )
        for a, b in PAIRS
        for value in [sp.expand(about[a - 1, b - 1])]
    ]
    vanishing = all(c.zero for c in constants[: len(AXES)])
    tables = rigid_tables(AT_CENTRE if vanishing else "")
    values = ExactValues(tuple(constants))
    return Body(name, "rigid body in space", "", 3, 0, mass, tables, values, gravity=gravity)


def spatial_rigid_point(name: str, position: sp.Matrix) -> MaterialPoint:
    """A point of a rigid body at `position` from O."""
    symbols = [Identity(Family.POINT_POSITION, components=(k,), point=name).symbol for k in AXES]
    result = tuple(
        ModelConstant(s, sp.expand(x), "(1)", f"X . e{k} of {name}", "m", None if x else "the choice of the origin")
        for k, (s, x) in enumerate(zip(symbols, position, strict=True), 1)
    )
    return MaterialPoint(name, f"point {name}", sp.ImmutableMatrix(symbols), (), result)
