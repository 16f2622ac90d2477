"""A joint to the ground in the lanes of those between bodies: the ground as a body at rest, whose code they have.

Alone, such a joint takes half as much text as four between bodies, and in a short chain of bodies with many modes each
call reads all text anew; chains of rigid bodies take 3 % longer so. The coordinates of the ground precede those of the
bodies in copies of q and v: amplitudes and velocities are zero, and the frame is the inertial one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import pairwise

from derive.algebra import sp
from derive.ir.expressions import Element, Number
from derive.ir.indices import ElementIndex, IndexTerm, constant, padded
from derive.ir.statements import ForEach, Statement, StoreElement, Work
from derive.lowering.instances.classes.body_classes import Member, fixed_values
from derive.lowering.instances.classes.dimension import plain_joint
from derive.lowering.instances.classes.groups import Bodies, GroupElement
from derive.lowering.instances.classes.joint_groups import markers_of
from derive.lowering.instances.classes.mode_factors import FEWEST_MODES
from derive.lowering.instances.classes.varying_joints import drive_of
from derive.lowering.instances.elimination.block_system import Blocks
from derive.lowering.instances.loop_code.class_code import INSTANCE, Loaded
from derive.lowering.instances.loop_code.group_code import JointCode, loads
from derive.mechanics.multibody.bodies.body_type import CrossSection
from derive.mechanics.multibody.space.frame_motion import FrameMotion
from derive.mechanics.symbols import Family, identity
from derive.mechanics.terms import ModelConstant
from derive.spec.model.markers import GROUND

STILL = (Family.POINT_POSITION, Family.POINT_SHAPE, Family.POINT_SECOND, Family.SECTION_ROTATION)
"""The constants of markers that a marker at rest may have: its position, and factors of amplitudes, which vanish."""

MOST = 16
"""The number of joints between bodies above which copies of the state take longer than a joint of its own."""


@dataclass(frozen=True)
class JointsWithGround(JointCode):
    """The code of varying joints of which one is at the ground, on this side."""

    side: int = field(kw_only=True)

    def copies(self, sizes: Iterable[tuple[str, int]]) -> Iterator[Statement]:
        """The copies of the state with that of the ground before it; sizes: of the arrays by their names."""
        for array, size in sizes:
            rest = self._at_rest[array]
            copy, own = self._copy(array), (IndexTerm(1, INSTANCE),)
            yield Work(copy, len(rest) + size)
            for k, value in enumerate(rest):
                yield StoreElement(Element(copy, constant(k)), Number(Fraction(value)))
            line = StoreElement(Element(copy, ElementIndex(len(rest), own)), Element(array, ElementIndex(0, own)))
            yield ForEach(INSTANCE, constant(0), constant(size), (line,))

    def state(self, *names: str) -> list[Loaded]:
        """The places of the coordinates and velocities in the copies, where those of the ground are the first ones."""
        ctx = self.code.context
        given = {"q": (ctx.q, self.coordinates), "v": (ctx.v, self.rows)}
        result = []
        for name in (name for name in names if name in given):
            of, positions = given[name]
            count = len(self._at_rest[name])
            result += loads(self.code, self._copy(name), of, [[k + count for k in own] for own in positions])
        return result

    def _copy(self, array: str) -> str:
        return f"{array}_of_{self.code.name}"

    @property
    def _at_rest(self) -> dict[str, list[int]]:
        """The state of the ground."""
        of = self.elements[0].bodies[self.side].instance.coordinates
        known = [identity(c.q) for c in of.coordinates]
        return {
            "q": [int(k.family is Family.QUATERNION and k.components == (0,)) for k in known],
            "v": [0] * len(of.rows),
        }


def joined_element(
    bodies: Bodies, ground: JointCode, others: JointCode, system: Blocks
) -> tuple[int, GroupElement] | None:
    """The only joint of a group as one of another group, and its side at the ground; None if it is none of these."""
    count = len(others.elements)
    if len(ground.elements) != 1 or not 1 < count <= MOST or len(others.factors) == 1:
        return None
    (element,), first = ground.elements, others.elements[0]
    if not all(map(_has_many_modes, first.bodies)):
        return None
    number, other = element.number, first.number
    here, there = (bodies.mechanism.joints[k] for k in (number, other))
    markers = markers_of(here)
    sides = [side for side, marker in enumerate(markers) if marker.body == GROUND]
    is_alike = (here.type, plain_joint(here), here.multipliers) == (there.type, plain_joint(there), there.multipliers)
    positions = [system.position[joint] for joint in sorted([number, *others.joints])]
    steps = {after - before for before, after in pairwise(positions)}
    if len(sides) != 1 or not is_alike or drive_of(here) != drive_of(there):
        return None
    if padded(count + 1) != padded(count) or len(steps) > 1:
        return None
    (side,) = sides
    mine, like = element.bodies[0], first.bodies[1 - side]
    own, their = markers[1 - side], markers_of(there)[1 - side]
    if bodies.form(own) != bodies.form(their) or fixed_values(mine.of_body) != fixed_values(like.of_body):
        return None
    still = _at_rest(bodies, first.bodies[side], markers_of(there)[side].marker, bodies.known.point(markers[side]))
    if still is None:
        return None
    return side, replace(element, bodies=(still, mine) if side == 0 else (mine, still))


def _has_many_modes(member: Member) -> bool:
    return sum(bool(identity(c.q).shapes) for c in member.instance.coordinates.coordinates) >= FEWEST_MODES


def _at_rest(bodies: Bodies, member: Member, marker: str, ground: FrameMotion) -> Member | None:
    """The ground as a body of the class of a member, with its marker; None if it is none."""
    component = member.instance.component
    section = component.sections[marker]
    if member.instance.coordinates.reason or sp.Matrix(section.axes) != sp.Matrix(ground.axes):
        return None
    values = {c.symbol: c.value for c in bodies.mechanism.constants}
    place = [values.get(x, x) for x in ground.position]
    known = [identity(c.symbol) for c in component.point_constants]
    if not all(k.family in STILL for k in known) or not all(x.is_Rational for x in place):
        return None
    if any(x != 0 and not own.free_symbols for x, own in zip(place, section.point.position, strict=True)):
        return None

    def moved(c: ModelConstant) -> ModelConstant:
        known = identity(c.symbol)
        return replace(c, value=place[known.components[0] - 1]) if known.family is Family.POINT_POSITION else c

    def at_rest(of: CrossSection) -> CrossSection:
        return replace(of, point=replace(of.point, coefficients=tuple(map(moved, of.point.coefficients))))

    sections = {name: at_rest(of) for name, of in component.sections.items()}
    instance = replace(member.instance, component=replace(component, sections=sections))
    coordinates = instance.coordinates
    return replace(
        member, instance=instance, coordinate=-len(coordinates.coordinates), row=-len(coordinates.rows), handles=()
    )
