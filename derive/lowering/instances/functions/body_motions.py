"""The motions of bodies and of their markers that joints along their first bodies read, which the bodies compute once.

Each joint would compute those of both of its bodies, from amplitudes that it would gather, and the bodies them again.
"""

from __future__ import annotations

from collections.abc import Iterator
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
from derive.lowering.instances.places import Place
from derive.mechanics.equations import Equations
from derive.mechanics.symbols import Family, identity

MOTIONS = "motions"
"""The local array of the motions of all bodies, one component after the other."""
FAMILIES = (
    Family.ROTATION_TENSOR,
    Family.ANGULAR_VELOCITY,
    Family.RADIUS,
    Family.SECTION_VECTOR,
    Family.SECTION_SCALE,
)
"""The components: the attitude and the spin of a body, and the place and the rotation of its markers with their rates.

From these follow all others in a few operations.
"""
GROUND = LANES - 1
"""The place of the ground, before that of the first body, with which a vector begins."""


class BodyMotions:
    """The places of all bodies in the array."""

    def __init__(self, context: InstanceContext) -> None:
        self.context = context
        bodies = sorted(m.number for of in context.classes_in_lanes for m in of.of.members)
        self.number = {body: LANES + k for k, body in enumerate(bodies)}
        self.spacing = LANES + spaced(len(bodies))

    def statements(self) -> Iterator[Statement]:
        """Yield the array, the ground in it where joints read it as a body, and the loops over the bodies."""
        classes = self.context.classes_in_lanes
        yield Work(MOTIONS, max(len(_own(of)) for of in classes) * self.spacing, spacing=self.spacing)
        for group in self.context.joints_in_lanes:
            if isinstance(group, JointsWithGround):
                for k, value in enumerate(_at_rest(group)):
                    yield StoreElement(Element(MOTIONS, constant(k * self.spacing + GROUND)), value)
        for of in classes:
            symbols = of.context.symbols(*given_inputs(of, "q", "v"))
            step = Step(f"motions_of_{of.name}", "(6)", "", stores(MOTIONS, symbols.values_of(_own(of))))
            yield of.loop(symbols, [step], state(of, "q", "v"), {MOTIONS: of.target(MOTIONS, self._place(of))}, True)

    def of_class(self, of: ClassCode) -> Loaded:
        """The components of a body of a class, besides its velocities, which come last and are in its state."""
        speeds = {row.v for row in of.context.equations.rows}
        return MOTIONS, self._place(of), array_input(MOTIONS, (s for s in _own(of) if s not in speeds), "")

    def of_joint(self, group: JointCode) -> list[Loaded]:
        """The components of the bodies of a joint, with the names that they have in its equations."""
        result = []
        for n, (side, columns) in enumerate(group.bodies.items()):
            bodies = [element.bodies[n] for element in group.elements]
            firsts = [GROUND if body.coordinate < 0 else self.number[body.number] for body in bodies]
            place = group.code.place(f"{MOTIONS}_{side}", firsts, self.spacing)
            result.append((MOTIONS, place, array_input(MOTIONS, _symbols(group.code.context.equations, columns), "")))
        return result

    def _place(self, of: ClassCode) -> Place:
        return of.place(MOTIONS, [self.number[m.number] for m in of.of.members], self.spacing)


def _own(of: ClassCode) -> list[sp.Symbol]:
    """The symbols of the components of a body of a class."""
    return _symbols(of.context.equations, range(len(of.context.rows)))


def _symbols(equations: Equations, columns: range) -> list[sp.Symbol]:
    """The symbols of the components of the body with these rows of some equations."""
    owner = identity(equations.rows[columns[0]].v).owner
    every = (*(d.symbol for d in equations.definitions), *(row.v for row in equations.rows))
    return [s for s in every if identity(s).owner == owner and identity(s).family in FAMILIES]


def _at_rest(group: JointsWithGround) -> list[Number]:
    """The components of the ground as a body: zero but for its axes, the scale of its rotations, and its marker."""
    equations = group.code.context.equations
    element = next(e for e in group.elements if any(body.coordinate < 0 for body in e.bodies))
    own = equations.coefficients[: len(element.constants)]
    values: dict[sp.Symbol, sp.Expr] = {
        c.symbol: constant.value for c, constant in zip(own, element.constants, strict=True)
    }
    values |= {c.q: sp.Integer(_is_scalar(c.q)) for c in equations.coordinates}
    values |= {row.v: sp.S.Zero for row in equations.rows}
    for d in equations.definitions:
        if d.needs <= values.keys():
            values[d.symbol] = d.expr.xreplace(values)
    return [Number(Fraction(int(values[s].p), int(values[s].q))) for s in _symbols(equations, group.bodies[group.side])]


def _is_scalar(q: sp.Symbol) -> bool:
    """Whether a coordinate is the scalar part of a quaternion, which is one at rest."""
    return identity(q).family is Family.QUATERNION and identity(q).components == (0,)
