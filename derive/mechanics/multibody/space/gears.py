"""Gears: constant ratios of the motions of two joints, without a count of turns where the constraints need none.

The motion of a joint that eliminates coordinates is a coordinate or that of a drive, and counts all turns; so does a
displacement. The rotation of any other joint is known up to whole turns. The constraint is then met modulo the smallest
change of g that whole turns of the joints make, which is what teeth and threads do: wheels of p and q teeth, with p/q
in lowest terms, mesh at p q places in a turn of both. The derivatives are those of g without the turns.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from derive.algebra import sp
from derive.errors import Problem, SpecError
from derive.mechanics.multibody.space.forces import MarkerLoad
from derive.mechanics.multibody.space.joint_motion import JointMotion
from derive.mechanics.multibody.space.joints import Freedom
from derive.mechanics.terms import Constraint, EquationOfMotion
from derive.mechanics.time_functions import Wrapped
from derive.spec.model.instances import identifier
from derive.spec.model.spatial_scene import Gear

LARGEST_TEETH = 10_000
"""The largest numerator and denominator of the ratio of two rotations that are known up to whole turns."""

Motions = Callable[[str], JointMotion]
"""The motion of a joint by its name."""


@dataclass(frozen=True)
class GearInstance:
    """A gear with the values of its keys as expressions."""

    gear: Gear
    ratio: sp.Expr
    offset: sp.Expr


def gear_constraint(gear: GearInstance, motions: Motions, rows: tuple[EquationOfMotion, ...]) -> Constraint:
    """The constraint of a gear: motion of the second joint less ratio times that of the first less the offset.

    Raises SpecError where both motions are known up to whole turns and the ratio is no fraction of teeth.
    """
    first, second = map(motions, gear.gear.joints)
    r = gear.ratio
    of_first, of_second = first.motion, second.motion
    factors = {row: -r * factor for row, factor in of_first.factors.items()}
    for row, factor in of_second.factors.items():
        factors[row] = factors.get(row, sp.S.Zero) + factor
    value = of_second.value - r * of_first.value - gear.offset
    a, b = gear.gear.joints
    unit = second.freedom.unit
    return Constraint(
        name=identifier(gear.gear.name),
        shown=gear.gear.name,
        of=gear.gear.name,
        doc=f"gear {gear.gear.name} couples the motion of {b} to that of {a}",
        unit=unit,
        force_unit="N m" if second.freedom is Freedom.ROTATION else "N",
        position=_without_turns(value, gear, first, second),
        rate=of_second.rate - r * of_first.rate,
        bias=of_second.bias - r * of_first.bias,
        jacobian=tuple((row.name, factors[row.name]) for row in rows if factors.get(row.name, 0) != 0),
        section="gears",
    )


def gear_loads(gear: GearInstance, multiplier: sp.Expr, motions: Motions) -> tuple[MarkerLoad, ...]:
    """The loads of a gear on the bodies of its joints."""
    result = []
    for joint, factor in zip(gear.gear.joints, (-gear.ratio, sp.S.One), strict=True):
        for load in motions(joint).loads:
            result.append(MarkerLoad(load.marker, load.force * factor * multiplier, load.torque * factor * multiplier))
    return tuple(result)


def _without_turns(value: sp.Expr, gear: GearInstance, first: JointMotion, second: JointMotion) -> sp.Expr:
    """g modulo the changes that whole turns of the joints make in it."""
    match first.counted, second.counted:
        case True, True:
            return value
        case True, False:
            return Wrapped(value, sp.S.One)
        case False, True:
            return Wrapped(value, gear.ratio)
    if not gear.ratio.is_Rational or max(abs(gear.ratio.p), gear.ratio.q) > LARGEST_TEETH:
        names = " and ".join(gear.gear.joints)
        text = (
            f"the rotations of {names} are those of bodies that keep their own coordinates, and known up to whole "
            f'turns: a ratio of numbers of teeth up to {LARGEST_TEETH} is needed, such as "-20/37", or a joint of a '
            "rigid body to the ground"
        )
        raise SpecError((Problem(f"gears.{gear.gear.name}.ratio", text),))
    return Wrapped(value, sp.Rational(1, gear.ratio.q))
