"""The rows of a body in the constraints of a varying joint: factors in G, which it reads where they vary.

Each such joint computes its constraints from both bodies, and those factors in G that depend on both.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TypeAlias

from derive.algebra import sp
from derive.lowering.instances.classes.dimension import AnyJoint, of_joint, space
from derive.lowering.instances.classes.gears import CoupledJoints
from derive.lowering.instances.classes.known_motion import moving_symbols
from derive.lowering.instances.classes.mode_factors import constants_of_modes, mode_coefficients
from derive.lowering.instances.classes.varying_joints import drive_of
from derive.mechanics.axes import SPACE
from derive.mechanics.multibody.instances import InstanceEquations
from derive.mechanics.multibody.space.first_body_rows import factors_along_own_axes, rows_along_first
from derive.mechanics.multibody.space.joints import SpatialJointInstance
from derive.mechanics.symbols import Identity, local
from derive.mechanics.terms import Constraint, Intermediate

FactorPlace: TypeAlias = "tuple[int, int | Identity]"
"""The number of a constraint, and the number of a coordinate or a constant of modes."""


@dataclass(frozen=True)
class VaryingPart:
    """The rows of a body in the constraints of a varying joint.

    constraints: with factors alone, in which those that depend on the other body are symbols; factors: these symbols,
    by the numbers of the constraint and of the coordinate, or by the constant of modes whose coefficient they are;
    definitions: what the other factors contain.
    """

    constraints: tuple[Constraint, ...]
    factors: Mapping[FactorPlace, sp.Symbol]
    definitions: tuple[Intermediate, ...]


def varying_part(joint: AnyJoint, marker: str, is_first: bool, own: InstanceEquations) -> VaryingPart:
    """The rows of the body with the marker, which is the first one of the joint or the second."""
    of, motion = of_joint(joint), own.motions[marker]
    ends = (motion, of.other) if is_first else (of.other, motion)
    definitions, conditions = joint.constraints(*ends, drive_of(joint), own.rows)
    return _part(definitions, conditions, moving_symbols(definitions, of.symbols), own)


def gear_part(gear: CoupledJoints, body: str, own: InstanceEquations) -> VaryingPart:
    """The row of a body in the constraint of a gear, whose joints have it and up to three others."""
    of = space()
    condition = gear.constraint(lambda m: own.motions[m.marker] if m.body == body else of.other, own.rows)
    return _part((), (condition,), frozenset(of.symbols), own)


def part_along_first(joint: SpatialJointInstance, marker: str, is_first: bool, own: InstanceEquations) -> VaryingPart:
    """The rows of a body in a joint whose first rows are along the axes of its first body.

    The factors of the second body that depend on the first one are then a rotation tensor.
    """
    other = varying_part(joint, marker, is_first, own)
    held = rows_along_first(joint)
    factors = {place: symbol for place, symbol in other.factors.items() if place[0] >= held}
    of_marker = factors_along_own_axes(own.motions[marker])
    parts = list(other.constraints)
    for k in range(held):
        start = k - k % SPACE
        turned = [local(f"factor_{parts[k].name}_{m + 1}") for m in range(SPACE)]
        if not is_first:
            factors |= {(k, m): symbol for m, symbol in enumerate(turned)}
        total: dict[str, list[sp.Expr]] = {}
        own_factors = [(k, sp.Integer(-1))] if is_first else [(start + m, symbol) for m, symbol in enumerate(turned)]
        for n, factor in own_factors:
            for row, value in of_marker[n].items():
                total.setdefault(row, []).append(factor * value)
        jacobian = tuple((row.name, sp.Add(*total[row.name])) for row in own.rows if row.name in total)
        parts[k] = replace(parts[k], jacobian=jacobian)
    return VaryingPart(tuple(parts), dict(sorted(factors.items(), key=lambda item: item[0][0])), other.definitions)


def _part(
    definitions: tuple[Intermediate, ...],
    conditions: tuple[Constraint, ...],
    others: frozenset[sp.Symbol],
    own: InstanceEquations,
) -> VaryingPart:
    """The rows of a body in constraints; others: the symbols that depend on other bodies."""
    number = {row.name: j for j, row in enumerate(own.rows)}
    constants = constants_of_modes(c.symbol for c in own.coefficients)
    factors: dict[FactorPlace, sp.Symbol] = {}
    parts = []
    for k, condition in enumerate(conditions):
        varying = {number[row]: factor for row, factor in condition.jacobian if factor.free_symbols & others}
        of_modes = {j: factor for j, factor in varying.items() if factor.free_symbols & constants.keys()}
        coefficients = mode_coefficients(of_modes, constants) or {}
        values = dict[int, sp.Expr]()
        for label in coefficients:
            factors[k, label] = local(f"factor_{condition.name}_{label.name}")
        for j, factor in varying.items():
            if coefficients and j in of_modes:
                own_of = sorted(factor.free_symbols & constants.keys(), key=str)
                values[j] = sp.Add(*(factors[k, constants[c]] * c for c in own_of))
            else:
                values[j] = factors[k, j] = local(f"factor_{condition.name}_{own.rows[j].name}")
        jacobian = tuple((row, values.get(number[row], factor)) for row, factor in condition.jacobian)
        zero = sp.S.Zero
        parts.append(replace(condition, position=zero, rate=zero, bias=zero, jacobian=jacobian))
    return VaryingPart(tuple(parts), factors, tuple(d for d in definitions if d.symbol not in others))
