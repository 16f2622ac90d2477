"""The rows of a body in the constraints of a varying joint: factors in G, which it reads where they vary.

Each such joint computes its constraints from both bodies, and those factors in G that depend on both.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from derive.algebra import sp
from derive.lowering.instances.classes.dimension import AnyJoint, of_joint
from derive.lowering.instances.classes.known_motion import moving_symbols
from derive.lowering.instances.classes.varying_joints import drive_of
from derive.mechanics.multibody.instances import InstanceEquations
from derive.mechanics.symbols import local
from derive.mechanics.terms import Constraint, Intermediate


@dataclass(frozen=True)
class VaryingPart:
    """The rows of a body in the constraints of a varying joint.

    constraints: with factors alone, in which those that depend on the other body are symbols; factors: these symbols,
    by the numbers of the constraint and of the coordinate; definitions: what the other factors contain.
    """

    constraints: tuple[Constraint, ...]
    factors: Mapping[tuple[int, int], sp.Symbol]
    definitions: tuple[Intermediate, ...]


def varying_part(joint: AnyJoint, marker: str, is_first: bool, own: InstanceEquations) -> VaryingPart:
    """The rows of the body with the marker, which is the first one of the joint or the second."""
    of, motion = of_joint(joint), own.motions[marker]
    ends = (motion, of.other) if is_first else (of.other, motion)
    definitions, conditions = joint.constraints(*ends, drive_of(joint), own.rows)
    others = moving_symbols(definitions, of.symbols)
    number = {row.name: j for j, row in enumerate(own.rows)}
    factors = {
        (k, number[row]): local(f"factor_{condition.name}_{row}")
        for k, condition in enumerate(conditions)
        for row, factor in condition.jacobian
        if factor.free_symbols & others
    }
    parts = tuple(
        replace(
            condition,
            position=sp.S.Zero,
            rate=sp.S.Zero,
            bias=sp.S.Zero,
            jacobian=tuple((row, factors.get((k, number[row]), factor)) for row, factor in condition.jacobian),
        )
        for k, condition in enumerate(conditions)
    )
    return VaryingPart(parts, factors, tuple(d for d in definitions if d.symbol not in others))
