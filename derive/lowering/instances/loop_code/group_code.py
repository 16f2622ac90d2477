"""The code of groups of elements with several bodies, and where such an element finds and puts its numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

from derive.algebra import sp
from derive.ir.expressions import Operator
from derive.lowering.flat.context import Input, array_input
from derive.lowering.flat.setup_constants import Constants
from derive.lowering.instances.classes.class_equations import with_known
from derive.lowering.instances.classes.groups import Group, GroupElement
from derive.lowering.instances.classes.known_motion import KnownMotion
from derive.lowering.instances.classes.varying_parts import FactorPlace
from derive.lowering.instances.loop_code.class_code import Loaded, LoopCode, LoopTarget
from derive.lowering.instances.places import Place, Places
from derive.mechanics.equations import Equations


@dataclass(frozen=True)
class GroupCode:
    """The code of a group of elements, each with several bodies."""

    code: LoopCode
    group: Group

    @property
    def elements(self) -> tuple[GroupElement, ...]:
        """Its elements."""
        return self.group.members

    @property
    def coordinates(self) -> list[list[int]]:
        """The indices of the coordinates of the bodies of each element."""
        return [list(element.coordinates) for element in self.elements]

    @property
    def rows(self) -> list[list[int]]:
        """The indices of the equations of motion of the bodies of each element, and of their velocities."""
        return [list(element.rows) for element in self.elements]

    @property
    def adds(self) -> bool:
        """Whether its elements are parts of sums."""
        return self.group.first.adds

    def state(self, *names: str) -> list[Loaded]:
        """The places of the coordinates and velocities of the bodies of an element; `names` selects among q and v."""
        ctx = self.code.context
        given = {"q": (ctx.q, self.coordinates), "v": (ctx.v, self.rows)}
        return [load for name in names if name in given for load in loads(self.code, name, *given[name])]

    def reactions(self, first_rows: Sequence[int]) -> list[list[int]]:
        """The indices of the multipliers of the joints of the bodies of each element."""
        return [[k for j in e.joints for k in range(first_rows[j], first_rows[j + 1])] for e in self.elements]


@dataclass(frozen=True)
class JointCode(GroupCode):
    """The code of a group of varying joints, or of gears.

    factors: for each side of the joint with coordinates the places of the factors in G that the body there reads, in
    the order in which they are stored; bodies: the columns of G of this body. turned: the symbols of the factors in
    rows along the axes of the first body; multipliers: those of the joint from those of these rows.
    """

    factors: Mapping[int, tuple[FactorPlace, ...]]
    bodies: Mapping[int, range]
    multipliers: tuple[sp.Expr, ...] = ()
    turned: Mapping[FactorPlace, sp.Symbol] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def are_gears(self) -> bool:
        """Whether it is one of gears."""
        first = self.group.first
        return any(h.is_gear for m in first.bodies for h in m.handles if h.joint == first.number)

    @property
    def joints(self) -> list[int]:
        """The numbers of the joints, or of the gears."""
        return [element.number for element in self.elements]

    def own_rows(self, first_rows: Sequence[int]) -> list[list[int]]:
        """The indices of the constraints of each joint."""
        return [[*range(first_rows[j], first_rows[j + 1])] for j in self.joints]


def group_code(
    group: Group, equations: Equations, known: KnownMotion, places: Places, constants: Constants
) -> LoopCode:
    """The code of a group with these equations, which contain symbols of what is known."""
    return LoopCode(group, with_known(equations, known, len(group.first.constants)), places, constants)


def loads(of: LoopCode, array: str, given: Input, positions: list[list[int]]) -> list[Loaded]:
    """The elements of an array at given positions for each member, which are named as those of an argument."""
    return [
        (array, of.place(f"{array}_{start}", [own[start] for own in positions]), array_input(array, symbols, ""))
        for start, stop in _runs(positions)
        if (symbols := given.symbols[start:stop])
    ]


def spread(
    of: LoopCode, array: str, positions: list[list[int]], operator: Operator | None, what: str = ""
) -> LoopTarget:
    """The target of outputs at given positions for each member; what: their name, if not the array."""
    places: dict[int, tuple[Place, int]] = {}
    for start, stop in _runs(positions):
        place = of.place(f"{what or array}_{start}", [own[start] for own in positions])
        places |= {k: (place, k - start) for k in range(start, stop)}
    entries = tuple(dict.fromkeys(place.entry for place, _ in places.values() if place.entry))
    return LoopTarget(array, lambda k: places[k][0].at(places[k][1]), operator, entries)


def _runs(positions: list[list[int]]) -> list[tuple[int, int]]:
    """The ranges of elements that follow each other for all members."""
    count = len(positions[0])
    breaks = [k for k in range(1, count) if any(own[k] != own[k - 1] + 1 for own in positions)]
    return list(zip([0, *breaks], [*breaks, count], strict=True)) if count else []
