"""The elimination of joints along a path, on which each is coupled with the next one alone, from both of its ends.

The two ends are independent until they meet, and are computed at once. What elimination has subtracted from the next
joint stays in small arrays, as long as the loop runs.

An even number of joints leaves one more on the side of the first end. It has a loop of its own, which runs once or, for
an odd number, not at all, so that chains of any length have one text; compilers drop a loop that does not run. Large
blocks do without it, since compilers take long to read its text. To give the joint a step of the loop over both ends,
with nothing at the second one, takes 5 to 7 % of the time of short chains.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from derive.ir.expressions import Element, Ends
from derive.ir.indices import ElementIndex, IndexTerm, constant, variable
from derive.ir.statements import ForEach, InstanceItem, InstanceStatement, Work
from derive.lowering.instances.elimination.block_body import (
    Adjugate,
    Block,
    BlockBody,
    Factors,
    Target,
    diagonal,
    has_adjugate,
    minus,
    plus,
    product,
    scaled,
    transposed,
)
from derive.lowering.instances.elimination.block_system import COUPLING, DIAGONAL, FORCE, KNOWN, RIGHT, Blocks, packed
from derive.lowering.instances.elimination.column_loops import Places, elimination_in_loops

UPDATE, RIGHT_UPDATE, SCALE, LAST = "update", "right_update", "update_scale", "last_reaction"
"""The local arrays of what the joint before subtracts, of its scale, and of its reactions."""
KEPT = "kept_joints"
"""The local array of what back substitution needs, with the joints of both ends side by side.

It is for large blocks: with those of planar joints, it displaced others from the cache in long paths (7 % of batches).
"""
LARGEST_SOLVED = 3
"""The largest blocks of joints for which elimination solves for all columns; larger ones are half as much work."""
STEP, END = "step", "end"
"""The variables of the loops over the joints, counted from an end of the path, and over the two ends."""


def along_path(of: Blocks, has_known: bool) -> tuple[InstanceStatement, ...]:
    """The elimination of all joints and the back substitution; has_known: whether there is an array KNOWN."""
    return _Path(of, has_known).statements()


class _Path:
    """A path of joints: `pairs` from each end, then one more from the first end if their number is even, and one."""

    def __init__(self, of: Blocks, has_known: bool) -> None:
        self.of, self.size = of, of.size
        self.rights = (*RIGHT, KNOWN) if has_known else RIGHT
        self.pairs = (of.joints - 1) // 2
        self.middle = of.joints // 2
        self.has_factor = has_adjugate(of.size, of.closes_loops)
        self.in_place = of.size <= LARGEST_SOLVED
        self.kept_in_step = 2 * (self.size * (self.size + 1) + of.packed)

    def statements(self) -> tuple[InstanceStatement, ...]:
        """The statements of the elimination along the path: arrays, loops from both ends, and the way back."""
        carried = {UPDATE: self.of.packed, RIGHT_UPDATE: self.size}
        carried |= {SCALE: 1} if self.has_factor else {}
        clears = self.in_place or self.pairs > 1
        works = [Work(name, 2 * count, cleared=clears) for name, count in carried.items()]
        works += [Work(LAST, 2 * self.size)]
        works += [Work(KEPT, self.middle * self.kept_in_step)] if self.middle and not self.in_place else []
        both, single = _BothEnds(self), _FirstEnd(self)
        return (
            *works,
            *both.loops(self.forward(both)),
            *single.loops(self.forward(single)),
            _once(self.meet()),
            *single.loops(self.backward(single), backward=True),
            *both.loops(self.backward(both), backward=True),
        )

    def pivot(self, body: BlockBody, at: Callable[[str, int, int], Target]) -> tuple[Block, Block]:
        """The block and the right-hand side of a joint, to which both bodies contribute."""

        def of(array: str) -> Callable[[int], Target]:
            return lambda component: at(array, component, self.of.spacing)

        diagonals = [body.symmetric(f"{name}_", of(name)) for name in DIAGONAL]
        rights = [body.vector(f"{name}_", of(name)) for name in self.rights]
        return plus(*diagonals), plus(*rights)

    def carried(self, body: BlockBody, name: str, at: Callable[[str, int], Target]) -> tuple[Block, Block]:
        """The parts that the elimination of the joint before subtracts from a block and from its right-hand side.

        The inverse of the determinant is a factor here and not before, where everything would wait for the division.
        """
        update = body.symmetric(f"u{name}", lambda c: at(UPDATE, c))
        right = body.vector(f"v{name}", lambda c: at(RIGHT_UPDATE, c))
        if not self.has_factor:
            return update, right
        scale = body.element(f"scale{name}", at(SCALE, 0))
        return scaled(scale, update), scaled(scale, right)

    def forward(self, ends: _BothEnds) -> tuple[InstanceItem, ...]:
        """The elimination of a joint: what the next one needs, and what back substitution needs."""
        if not self.in_place:
            return elimination_in_loops(self.size, ends.places())
        body = BlockBody(self.size)
        whole, r = self.pivot(body, ends.own)
        update, right_update = self.carried(body, "", ends.carried)
        d, r = minus(whole, update), minus(r, right_update)
        inverse = body.inverse(d, diagonal(whole), self.of.closes_loops)
        s = body.matrix("s", lambda c: ends.coupling(*divmod(c, self.size)))
        if isinstance(inverse, Adjugate):  # the division takes long: its result is a factor of sums
            y, w = inverse.part(s), inverse.part(r)
            body.store(ends.inverse(), inverse.inverse)
            body.store(ends.carried(SCALE, 0), inverse.inverse)
        else:
            y, w = inverse.solve(s), inverse.solve(r)
        body.store_rows(lambda c: ends.column(*divmod(c, self.size)), y)
        body.store_rows(ends.right, w)
        body.store_symmetric(lambda c: ends.carried(UPDATE, c), product(transposed(s), y))
        body.store_rows(lambda c: ends.carried(RIGHT_UPDATE, c), product(transposed(s), w))
        return body.statements()

    def meet(self) -> tuple[InstanceItem, ...]:
        """The reactions of the joint in the middle."""
        body = BlockBody(self.size)
        whole, r = self.pivot(body, lambda array, c, spacing: Element(array, constant(c * spacing + self.middle)))
        d = whole
        for end in (0, 1) if self.pairs else (0,) if self.middle else ():
            update, right_update = self.carried(body, f"_{end}_", _at_end(end))
            d, r = minus(d, update), minus(r, right_update)
        for c, (value,) in enumerate(body.inverse(d, diagonal(whole), self.of.closes_loops).solve(r)):
            body.store(Element(FORCE, constant(c * self.of.spacing + self.middle)), value)
            if self.middle:
                body.store(Element(LAST, constant(2 * c)), value)
                body.store(Element(LAST, constant(2 * c + 1)), value)
        return body.statements()

    def backward(self, ends: _BothEnds) -> tuple[InstanceItem, ...]:
        """The reactions of a joint from those of the next one."""
        body = BlockBody(self.size)
        y = body.matrix("y", lambda c: ends.column(*divmod(c, self.size)))
        w = body.vector("w", ends.right)
        known = body.vector("f", lambda c: ends.carried(LAST, c))
        left = w
        for k in reversed(range(self.size)):  # the next step finds its last reactions first
            left = minus(left, [[row[k] * known[k][0]] for row in y])
        if not self.in_place:
            factor = ends.places().factor
            inverse = Factors.of_block(body.symmetric("a", lambda c: factor(*divmod(c, self.size))))
            left = inverse.backward(inverse.middle(left))
        elif self.has_factor:
            left = scaled(body.element("inverse", ends.inverse()), left)
        for c, (value,) in enumerate(left):
            body.store(ends.carried(LAST, c), value)
            body.store(ends.own(FORCE, c, self.of.spacing), value)
        return body.statements()


def _at_end(end: int) -> Callable[[str, int], Element]:
    """The places of what is carried along from an end, outside of the loop over the ends."""
    return lambda array, component: Element(array, constant(2 * component + end))


def _once(body: tuple[InstanceItem, ...]) -> ForEach:
    return ForEach(STEP, constant(0), constant(1), body)


class _BothEnds:
    """The places of elements in a step: those of the joints at the same distance from both ends."""

    def __init__(self, of: _Path) -> None:
        self.of, self.size = of, of.size

    @property
    def has_first_alone(self) -> bool:
        """Whether the loop has no other joints than the first one of each end, from which nothing is subtracted."""
        return self.of.pairs == 1

    def loops(self, body: tuple[InstanceItem, ...], backward: bool = False) -> tuple[InstanceStatement, ...]:
        """The loop over the joints of each end."""
        if not self.of.pairs:
            return ()
        inner = ForEach(STEP, constant(0), constant(self.of.pairs), body, backward)
        return (ForEach(END, constant(0), constant(2), (inner,), independent=True),)

    def own(self, array: str, component: int, spacing: int) -> Target:
        """The element of a joint."""
        first = component * spacing
        return Ends(array, variable(STEP, 1, first), variable(STEP, -1, first + self.of.of.joints - 1), END)

    def coupling(self, row: int, column: int | str) -> Target:
        """The element of the block of a joint and the next one, row by row; a column may be that of a loop."""
        at, (spacing, last) = _index(column), (self.of.of.coupling_spacing, self.of.of.couplings - 1)
        first = at.scaled(spacing, row * self.size * spacing)
        second = at.scaled(self.size * spacing, row * spacing + last)
        return Ends(COUPLING, _counting(first, IndexTerm(1, STEP)), _counting(second, IndexTerm(-1, STEP)), END)

    def carried(self, array: str, component: int) -> Target:
        """The element of what is carried along."""
        return self.carried_at(array, constant(component))

    def carried_at(self, array: str, component: ElementIndex) -> Target:
        """The same of a component that may be that of a loop."""
        return Element(array, _counting(component.scaled(2), IndexTerm(1, END)))

    def places(self) -> Places:
        """The places of elements of large blocks."""
        size, spacing = self.size, self.of.of.spacing
        return Places(
            lambda i, j: [self.own(name, packed(size, i, j), spacing) for name in DIAGONAL],
            lambda i: [self.own(name, i, spacing) for name in self.of.rights],
            lambda i, j: self.carried_at(UPDATE, _counting(_index(i).scaled(size, _index(j).offset), *_index(j).terms)),
            lambda i: self.carried_at(RIGHT_UPDATE, _index(i)),
            self.coupling,
            self.column,
            self.right,
            lambda i, j: self.kept(constant(size * (size + 1) + packed(size, i, j))),
            self.has_first_alone,
        )

    def column(self, row: int, column: int | str) -> Target:
        """The element of what remains of the coupling block, of which back substitution finds columns; see `right`."""
        if self.of.in_place:
            assert isinstance(column, int)
            return self.coupling(row, column)
        return self.kept(_index(column).scaled(self.size, row))

    def right(self, row: int) -> Target:
        """The element of what remains of the right-hand side, which is one more column."""
        return self.own(RIGHT[0], row, self.of.of.spacing) if self.of.in_place else self.column(row, self.size)

    def inverse(self) -> Target:
        """The inverse of the determinant of a small block."""
        return self.own(DIAGONAL[0], 0, self.of.of.spacing)

    def kept(self, component: ElementIndex) -> Target:
        """The element of what back substitution needs of large blocks."""
        terms = IndexTerm(self.of.kept_in_step, STEP), IndexTerm(1, END)
        return Element(KEPT, _counting(component.scaled(2), *terms))


class _FirstEnd(_BothEnds):
    """The places of the joint that is left on the side of the first end, if there is one."""

    @property
    def has_first_alone(self) -> bool:
        return self.of.pairs == 0

    def loops(self, body: tuple[InstanceItem, ...], backward: bool = False) -> tuple[InstanceStatement, ...]:
        """The loop over this joint."""
        is_left = self.of.pairs < self.of.middle
        if not (is_left or (self.of.middle and self.of.in_place)):
            return ()
        return (ForEach(STEP, constant(self.of.pairs), constant(self.of.middle), body, backward),)

    def own(self, array: str, component: int, spacing: int) -> Target:
        return _at_first(super().own(array, component, spacing))

    def coupling(self, row: int, column: int | str) -> Target:
        return _at_first(super().coupling(row, column))

    def carried_at(self, array: str, component: ElementIndex) -> Target:
        return _at_first(super().carried_at(array, component))

    def kept(self, component: ElementIndex) -> Target:
        return _at_first(super().kept(component))


def _index(of: int | str) -> ElementIndex:
    """A number, or the variable of a loop."""
    return variable(of) if isinstance(of, str) else constant(of)


def _counting(index: ElementIndex, *terms: IndexTerm) -> ElementIndex:
    """An index that also counts from other variables."""
    return replace(index, terms=(*index.terms, *terms))


def _at_first(target: Target) -> Element:
    """The element of the first end."""
    element = target.of(0) if isinstance(target, Ends) else target
    return replace(element, index=element.index and element.index.with_value(END, 0))
