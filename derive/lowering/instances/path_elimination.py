"""The elimination of joints along a path, on which each is coupled with the next one alone, from both of its ends.

The two ends are independent until they meet, and are computed at once. What elimination has subtracted from the next
joint stays in small arrays, as long as the loop runs.
"""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca

from derive.ir.expressions import Element, Ends
from derive.ir.indices import ElementIndex, IndexTerm, constant, variable
from derive.ir.statements import ForEach, InstanceItem, InstanceStatement, Work
from derive.lowering.instances.block_body import (
    Adjugate,
    Block,
    BlockBody,
    Target,
    diagonal,
    has_adjugate,
    minus,
    plus,
    product,
    scaled,
    transposed,
)
from derive.lowering.instances.block_system import COUPLING, DIAGONAL, FORCE, KNOWN, RIGHT, Blocks

FACTOR, UPDATE, RIGHT_UPDATE, LAST = "factor", "update", "right_update", "last_reaction"
"""The local arrays of what back substitution needs, of what the joint before subtracts, and of its reactions."""
STEP, END = "step", "end"
"""The variables of the loops over the joints, counted from an end of the path, and over the two ends."""


def along_path(of: Blocks, has_known: bool) -> tuple[InstanceStatement, ...]:
    """The elimination of all joints and the back substitution; has_known: whether there is an array KNOWN."""
    return _Path(of, has_known).statements()


class _Path:
    """A path of joints: `pairs` from each end, then one more from the first end if their number is even, and one."""

    def __init__(self, of: Blocks, has_known: bool) -> None:
        self.of, self.size, self.has_known = of, of.size, has_known
        self.pairs = (of.joints - 1) // 2
        self.left = of.joints - 1 - 2 * self.pairs
        self.middle = self.pairs + self.left
        self.has_factor = has_adjugate(of.size, of.closes_loops)
        self.kept = self.size**2 + self.size + self.has_factor

    def statements(self) -> tuple[InstanceStatement, ...]:
        """All loops."""
        works = [Work(UPDATE, 2 * self.of.packed, cleared=True), Work(RIGHT_UPDATE, 2 * self.size, cleared=True)]
        works += [Work(LAST, 2 * self.size)]
        works += [Work(FACTOR, 2 * (self.pairs + self.left) * self.kept)] if self.middle else []
        both, single = _BothEnds(self), _FirstEnd(self)
        return (
            *works,
            *both.loops(self.forward(both)),
            *single.loops(self.forward(single)),
            _once(self.meet()),
            *single.loops(self.backward(single)),
            *both.loops(self.backward(both), backward=True),
        )

    def pivot(self, body: BlockBody, at: Callable[[str, int, int], Target]) -> tuple[Block, Block]:
        """The block and the right-hand side of a joint, to which both bodies contribute."""

        def of(array: str) -> Callable[[int], Target]:
            return lambda component: at(array, component, self.of.joints)

        diagonals = [body.symmetric(f"{name}_", of(name)) for name in DIAGONAL]
        names = [*RIGHT, *([KNOWN] if self.has_known else [])]
        rights = [body.vector(f"{name}_", of(name)) for name in names]
        return plus(*diagonals), plus(*rights)

    def forward(self, ends: _Ends) -> tuple[InstanceItem, ...]:
        """The elimination of a joint: what the next one needs, and what back substitution needs."""
        body = BlockBody(self.size)
        whole, r = self.pivot(body, ends.own)
        d = minus(whole, body.symmetric("u", lambda c: ends.carried(UPDATE, c)))
        r = minus(r, body.vector("v", lambda c: ends.carried(RIGHT_UPDATE, c)))
        inverse = body.inverse(d, diagonal(whole), self.of.closes_loops)
        s = body.matrix("s", ends.coupling)
        if isinstance(inverse, Adjugate):  # the division takes long: its result is a factor of sums
            y, w, factor = inverse.part(s), inverse.part(r), inverse.inverse
            body.store(ends.factor(self.kept - 1), factor)
        else:
            y, w, factor = inverse.solve(s), inverse.solve(r), ca.SX(1)
        body.store_rows(ends.factor, y)
        body.store_rows(lambda c: ends.factor(self.size**2 + c), w)
        body.store_symmetric(lambda c: ends.carried(UPDATE, c), scaled(factor, product(transposed(s), y)))
        body.store_rows(lambda c: ends.carried(RIGHT_UPDATE, c), scaled(factor, product(transposed(s), w)))
        return body.statements()

    def meet(self) -> tuple[InstanceItem, ...]:
        """The reactions of the joint in the middle."""
        body = BlockBody(self.size)
        n = self.of.joints
        whole, r = self.pivot(body, lambda array, c, n: Element(array, constant(c * n + self.middle)))
        d = whole
        for end in (0, 1) if self.pairs else (0,) if self.middle else ():
            d = minus(d, body.symmetric(f"u_{end}_", _at_end(UPDATE, end)))
            r = minus(r, body.vector(f"v_{end}_", _at_end(RIGHT_UPDATE, end)))
        for c, (value,) in enumerate(body.inverse(d, diagonal(whole), self.of.closes_loops).solve(r)):
            body.store(Element(FORCE, constant(c * n + self.middle)), value)
            if self.middle:
                body.store(Element(LAST, constant(2 * c)), value)
                body.store(Element(LAST, constant(2 * c + 1)), value)
        return body.statements()

    def backward(self, ends: _Ends) -> tuple[InstanceItem, ...]:
        """The reactions of a joint from those of the next one."""
        body = BlockBody(self.size)
        y = body.matrix("y", ends.factor)
        w = body.vector("w", lambda c: ends.factor(self.size**2 + c))
        known = body.vector("f", lambda c: ends.carried(LAST, c))
        factor = body.element("inverse", ends.factor(self.kept - 1)) if self.has_factor else ca.SX(1)
        for c, (value,) in enumerate(scaled(factor, minus(w, product(y, known)))):
            body.store(ends.carried(LAST, c), value)
            body.store(ends.own(FORCE, c, self.of.joints), value)
        return body.statements()


def _at_end(array: str, end: int) -> Callable[[int], Element]:
    """The places of what is carried along from an end, outside of the loop over the ends."""
    return lambda component: Element(array, constant(2 * component + end))


def _once(body: tuple[InstanceItem, ...]) -> ForEach:
    return ForEach(STEP, constant(0), constant(1), body)


class _Ends:
    """The places of elements in a step."""

    def __init__(self, of: _Path) -> None:
        self.of, self.size = of, of.size

    def own(self, array: str, component: int, spacing: int) -> Target:
        """The element of a joint."""
        raise NotImplementedError

    def coupling(self, component: int) -> Target:
        """The element of the block of a joint and the next one, row by row."""
        raise NotImplementedError

    def carried(self, array: str, component: int) -> Target:
        """The element of what is carried along."""
        raise NotImplementedError

    def factor(self, component: int) -> Target:
        """The element of what back substitution needs."""
        raise NotImplementedError


class _BothEnds(_Ends):
    """The joints at the same distance from both ends."""

    def loops(self, body: tuple[InstanceItem, ...], backward: bool = False) -> tuple[InstanceStatement, ...]:
        """The loop over the joints of each end."""
        if not self.of.pairs:
            return ()
        inner = ForEach(STEP, constant(0), constant(self.of.pairs), body, backward)
        return (ForEach(END, constant(0), constant(2), (inner,), independent=True),)

    def own(self, array: str, component: int, spacing: int) -> Target:
        first = component * spacing
        return Ends(array, variable(STEP, 1, first), variable(STEP, -1, first + spacing - 1), END)

    def coupling(self, component: int) -> Target:
        i, j = divmod(component, self.size)
        n = self.of.of.couplings
        turned = self.size * j + i
        return Ends(COUPLING, variable(STEP, 1, component * n), variable(STEP, -1, turned * n + n - 1), END)

    def carried(self, array: str, component: int) -> Target:
        return Element(array, variable(END, 1, 2 * component))

    def factor(self, component: int) -> Target:
        terms = IndexTerm(2 * self.of.kept, STEP), IndexTerm(1, END)
        return Element(FACTOR, ElementIndex(2 * component, terms))


class _FirstEnd(_Ends):
    """The one joint that is left on the side of the first end."""

    def loops(self, body: tuple[InstanceItem, ...]) -> tuple[InstanceStatement, ...]:
        """The statements of the joint, if there is one."""
        return (_once(body),) if self.of.left else ()

    def own(self, array: str, component: int, spacing: int) -> Target:
        return Element(array, constant(component * spacing + self.of.pairs))

    def coupling(self, component: int) -> Target:
        return Element(COUPLING, constant(component * self.of.of.couplings + self.of.pairs))

    def carried(self, array: str, component: int) -> Target:
        return Element(array, constant(2 * component))

    def factor(self, component: int) -> Target:
        return Element(FACTOR, constant(2 * (self.of.pairs * self.of.kept + component)))
