"""The motions of bodies and of their markers that joints along their first bodies read, which the bodies compute once.

Each joint would compute those of both of its bodies, from amplitudes that it would gather, and the bodies them again.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from derive.algebra import sp
from derive.ir.expressions import Element, Number
from derive.ir.indices import LANES, constant
from derive.ir.statements import Statement, StoreElement, Work
from derive.lowering.flat.context import array_input, stores
from derive.lowering.flat.schedule import Step
from derive.lowering.instances.elimination.block_system import spaced
from derive.lowering.instances.loop_code.class_code import ClassCode, Loaded
from derive.lowering.instances.loop_code.context import InstanceContext, given_inputs, state
from derive.lowering.instances.loop_code.ground_at_rest import JointsWithGround
from derive.lowering.instances.loop_code.group_code import JointCode
from derive.mechanics.equations import Equations
from derive.mechanics.symbols import Family, identity

MOTIONS = "motions"
"""The local array of all bodies, one component after the other."""
OF_BODY = (Family.ROTATION_TENSOR, Family.ANGULAR_VELOCITY)
OF_MARKER = (Family.RADIUS, Family.SECTION_VECTOR, Family.SECTION_SCALE)
GROUND = LANES - 1
"""The place of the ground, before that of the first body, which vectors begin with."""


@dataclass(frozen=True)
class BodyMotions:
    """The places of the bodies in the array.

    number: those of bodies by their numbers in the mechanism; points: the markers at which these have joints, with the
    name of the body that their symbols have; count: the most components.
    """

    number: Mapping[int, int]
    spacing: int
    count: int

    def symbols(self, equations: Equations, owner: str) -> list[sp.Symbol]:
        """The symbols of the components of a body that has this name in some equations."""
        return _symbols(equations, owner)

    def works(self, context: InstanceContext) -> Iterator[Statement]:
        """The array, with the ground in it where joints read it as a body, and the loops of the bodies."""
        yield Work(MOTIONS, self.count * self.spacing, spacing=self.spacing)
        for group in context.joints_in_lanes:
            if isinstance(group, JointsWithGround):
                for k, value in enumerate(_at_rest(group)):
                    yield StoreElement(Element(MOTIONS, constant(k * self.spacing + GROUND)), value)
        for of in context.classes_in_lanes:
            symbols = of.context.symbols(*given_inputs(of, "q", "v"))
            own = self.own(of)
            items = stores(MOTIONS, symbols.values_of(own))
            target = {MOTIONS: of.target(MOTIONS, self._place(of))}
            step = Step(f"motions_of_{of.name}", "(6)", "", items)
            yield of.loop(symbols, [step], state(of, "q", "v"), target, True)

    def own(self, of: ClassCode) -> list[sp.Symbol]:
        """The symbols of a class of bodies."""
        return _symbols(of.context.equations, _owner(of.context.equations, range(len(of.context.rows))))

    def of_class(self, of: ClassCode) -> Loaded:
        """The components of a body of a class."""
        return MOTIONS, self._place(of), array_input(MOTIONS, self.own(of), "")

    def _place(self, of: ClassCode):  # type: ignore[no-untyped-def]
        return of.place(MOTIONS, [LANES + self.number[m.number] for m in of.of.members], self.spacing)

    def of_joint(self, group: JointCode) -> list[Loaded]:
        """The components of the bodies of a joint."""
        result = []
        equations = group.code.context.equations
        for position, (side, columns) in enumerate(group.bodies.items()):
            symbols = _symbols(equations, _owner(equations, columns))
            firsts = [_position(self, element.bodies[position].number, element.bodies[position].coordinate) for element in group.elements]
            place = group.code.place(f"{MOTIONS}_{side}", firsts, self.spacing)
            result.append((MOTIONS, place, array_input(MOTIONS, symbols, "")))
        return result


def body_motions(context: InstanceContext) -> BodyMotions:
    """The places of all bodies."""
    members = sorted(m.number for of in context.classes_in_lanes for m in of.of.members)
    number = {body: k for k, body in enumerate(members)}
    made = BodyMotions(number, LANES + spaced(len(members)), 0)
    count = max(len(made.own(of)) for of in context.classes_in_lanes)
    return BodyMotions(number, made.spacing, count)


def _position(of: BodyMotions, number: int, coordinate: int) -> int:
    """The place of a body, or of the ground as one, whose coordinates precede those of bodies."""
    return GROUND if coordinate < 0 else LANES + of.number[number]


def _owner(equations: Equations, columns: range) -> str:
    """The name of the body whose rows these are."""
    return identity(equations.rows[columns[0]].v).owner


def _symbols(equations: Equations, owner: str) -> list[sp.Symbol]:
    known = [(d.symbol, identity(d.symbol)) for d in equations.definitions]
    speeds = [row.v for row in equations.rows]
    known += [(v, identity(v)) for v in speeds]
    families = (*OF_BODY, *OF_MARKER)
    return [s for s, of in known if of.owner == owner and of.family in families]


def _at_rest(group: JointsWithGround) -> Sequence[Number]:
    """The components of the ground as a body: zero but for its axes, the scale of its rotations, and its marker."""
    equations, side = group.code.context.equations, group.side
    element = group.elements[0]
    symbols = _symbols(equations, _owner(equations, group.bodies[side]))
    first = list(group.bodies).index(side)
    values = dict(zip((c.symbol for c in equations.coefficients), (c.value for c in element.constants), strict=False))
    values |= {c.q: _still(c.q) for c in equations.coordinates}
    values |= {row.v: sp.S.Zero for row in equations.rows}
    assert element.bodies[first].coordinate < 0
    for d in equations.definitions:
        if d.needs <= values.keys():
            values[d.symbol] = d.expr.xreplace(values)
    return [Number(Fraction(int(values[s].p), int(values[s].q))) for s in symbols]


def _still(q: sp.Symbol) -> sp.Expr:
    """The value of a coordinate of a body at rest in the origin."""
    of = identity(q)
    return sp.Integer(of.family is Family.QUATERNION and of.components == (0,))
