"""Accelerations of trees with constraints: M^-1 G^T, column by column along the tree, and the multipliers from it.

With X = M^-1 G^T and the accelerations a of the tree without multipliers, (G X) lambda = gamma - G a and
vdot = a + X lambda. Articulated bodies have been eliminated before; a column passes them once in either direction. G X
is dense, of a row for each constraint.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import casadi as ca

from derive.ir.expressions import Element, Expr, Number, Operation, Operator, ScalarRef
from derive.ir.indices import ElementIndex, IndexTerm, constant, variable
from derive.ir.statements import (
    ForEach,
    InstanceItem,
    Let,
    Require,
    Requirement,
    ReturnCode,
    Statement,
    StoreElement,
    Work,
)
from derive.lowering.instances.loop_code.kernels import ZERO
from derive.lowering.ldlt import VANISHING
from derive.lowering.trees.articulated import SHARE, carried, solved
from derive.lowering.trees.joint_axes import joint_axes
from derive.lowering.trees.link_loop import LinkLoop
from derive.lowering.trees.motion import FRAME, TreeMotion, matrix
from derive.lowering.vectors import applied, dot, plus, scaled, transposed

COLUMN, OTHER, ROW = "column", "other", "row"
"""The variables of loops over constraints, and over rows."""
G, ANSWERS, SCHUR, REACTIONS, INVERSES = "G_by_rows", "answers", "schur", "reactions", "inverse_pivots"
"""The arrays of G and of M^-1 G^T, row of M by row, of G X, of the multipliers, and of the inverses of pivots."""
PUSH, KNOWN, ANSWER = "push", "known_rate", "answer"
"""The arrays of links for a column: of forces behind them, of rates without those before them, and of accelerations."""


@dataclass(frozen=True)
class Reactions:
    """The code of the multipliers of `count` constraints of a tree with so many rows."""

    motion: TreeMotion
    count: int
    rows: int

    def position(self, condition: int, row: int) -> int:
        """The place of an entry of G."""
        return row * self.count + condition

    @property
    def declared(self) -> list[Statement]:
        """The declaration of G, of zeros."""
        return [Work(G, self.rows * self.count, cleared=True)]

    # ---- M^-1 G^T ----

    def answers(self) -> list[Statement]:
        """The statements of M^-1 G^T and of G X, after those of articulated bodies."""
        motion, m = self.motion, self.count
        declared = [
            Work(ANSWERS, self.rows * m),
            Work(SCHUR, m * m, cleared=True),
            *motion.work((PUSH, 6), (KNOWN, 1), (ANSWER, 6), cleared=True),
        ]
        inside: list[InstanceItem] = [self._cleared()]
        inside += [self._backward()] if motion.joints else []
        inside += [self._of_free()] if motion.free else []
        inside += [self._forward()] if motion.joints else []
        column = ForEach(COLUMN, constant(0), constant(m), tuple(inside))
        entry = StoreElement(
            Element(SCHUR, ElementIndex(0, (IndexTerm(m, COLUMN), IndexTerm(1, OTHER)))),
            _times(Element(G, _by_row(m, COLUMN)), Element(ANSWERS, _by_row(m, OTHER))),
            Operator.ADD,
        )
        lower = ForEach(OTHER, constant(0), ElementIndex(1, (IndexTerm(1, COLUMN),)), (entry,))
        products = ForEach(
            ROW, constant(0), constant(self.rows), (ForEach(COLUMN, constant(0), constant(m), (lower,)),)
        )
        return [*declared, column, products]

    def _cleared(self) -> ForEach:
        loop = self.motion.loop("push", range(len(self.motion.tree.links)))
        loop.store_vector(PUSH, loop.of_links(), [ca.SX(0)] * 6)
        return loop.made(independent=True)

    def _of_column(self, loop: LinkLoop, k: int = 0) -> ElementIndex:
        """The index of the row of each link in this column."""
        rows = [self.motion.tree.links[n].row for n in loop.links]
        first = loop.place("row_of_column", [row * self.count for row in rows], self.count).at(k)
        return ElementIndex(first.offset, (*first.terms, IndexTerm(1, COLUMN)))

    def _backward(self) -> ForEach:
        loop = self.motion.loop("column_backward", self.motion.joints)
        here, before = loop.of_links(), loop.of_parents()
        f, n = loop.vector(PUSH, here), loop.vector(PUSH, here, first=3)
        joint = joint_axes(loop, here)
        *share, inverse = loop.vector(SHARE, here, 7)
        force = loop.element(G, self._of_column(loop)) - joint.along(f, n)
        known = force * inverse
        loop.store(KNOWN, here.at(0), known)
        passed = joint.passed(plus(f, scaled(known, share[:3])), plus(n, scaled(known, share[3:])))
        loop.store_vector(PUSH, before, passed, operator=Operator.ADD)
        return loop.made(backward=True)

    def _of_free(self) -> ForEach:
        loop = self.motion.loop("column_free", self.motion.free)
        here = loop.of_links()
        m, s, j, _, _ = carried(self.motion, loop, here)
        whole = [[*m[i], *s[i]] for i in range(3)] + [[*transposed(s)[i], *j[i]] for i in range(3)]
        Q = matrix(loop.vector(FRAME, here, 9))
        given = [loop.element(G, self._of_column(loop, k)) for k in range(6)]
        force = [*given[:3], *applied(Q, given[3:])]
        push = loop.vector(PUSH, here, 6)
        found = solved(loop, whole, [a - b for a, b in zip(force, push, strict=True)])
        loop.store_vector(ANSWER, here, found)
        for k, value in enumerate([*found[:3], *applied(transposed(Q), found[3:])]):
            loop.store(ANSWERS, self._of_column(loop, k), value)
        return loop.made()

    def _forward(self) -> ForEach:
        loop = self.motion.loop("column_forward", self.motion.joints)
        here, before = loop.of_links(), loop.of_parents()
        joint = joint_axes(loop, here)
        a, alpha = joint.carried(loop.vector(ANSWER, before), loop.vector(ANSWER, before, first=3))
        *share, inverse = loop.vector(SHARE, here, 7)
        rate = loop.element(KNOWN, here.at(0)) - inverse * dot(share, [*a, *alpha])
        loop.store_vector(ANSWER, here, joint.moved(a, alpha, rate))
        loop.store(ANSWERS, self._of_column(loop), rate)
        return loop.made()

    # ---- multipliers ----

    def multipliers(self, wanted: Callable[[ElementIndex], Expr], free: str = "") -> list[Statement]:
        """The statements of (G X) lambda = wanted - G free, by L D L^T; free: the array of accelerations, if any."""
        m, column = self.count, variable(COLUMN)
        pivot = Element(SCHUR, ElementIndex(0, (IndexTerm(m + 1, COLUMN),)))
        start = (
            StoreElement(Element(REACTIONS, column), wanted(column)),
            StoreElement(Element(INVERSES, column), pivot),
        )
        result: list[Statement] = [
            Work(REACTIONS, m),
            Work(INVERSES, m),
            ForEach(COLUMN, constant(0), constant(m), start),
        ]
        if free:
            term = _times(Element(G, _by_row(m, COLUMN)), Element(free, variable(ROW)))
            one = StoreElement(Element(REACTIONS, column), term, Operator.SUB)
            result.append(
                ForEach(ROW, constant(0), constant(self.rows), (ForEach(COLUMN, constant(0), constant(m), (one,)),))
            )
        return [*result, self._eliminated(), self._substituted()]

    def _eliminated(self) -> ForEach:
        """The loop over pivots, which leaves S below them as it is."""
        m, column, row = self.count, variable(COLUMN), variable(ROW)
        pivot, inverse = Element(SCHUR, ElementIndex(0, (IndexTerm(m + 1, COLUMN),))), ScalarRef("inverse")
        above = Operation(Operator.SUB, (pivot, _times(Number(VANISHING), Element(INVERSES, column))))
        text = "the constraints depend on each other"
        behind = ElementIndex(1, (IndexTerm(1, COLUMN),))
        other = Element(SCHUR, ElementIndex(0, (IndexTerm(m, OTHER), IndexTerm(1, COLUMN))))
        target = Element(SCHUR, ElementIndex(0, (IndexTerm(m, ROW), IndexTerm(1, OTHER))))
        update = StoreElement(target, _times(ScalarRef("factor"), other), Operator.SUB)
        left = StoreElement(
            Element(REACTIONS, row), _times(ScalarRef("factor"), Element(REACTIONS, column)), Operator.SUB
        )
        of_row = (
            Let("factor", _times(self._below, inverse)),
            ForEach(OTHER, behind, ElementIndex(1, (IndexTerm(1, ROW),)), (update,)),
            left,
        )
        of_column = (
            Require(Requirement.POSITIVE, above, ReturnCode.PIVOT, text),
            Let("inverse", Operation(Operator.DIV, (Number(Fraction(1)), pivot))),
            StoreElement(Element(INVERSES, column), inverse),
            ForEach(ROW, behind, constant(m), of_row),
        )
        return ForEach(COLUMN, constant(0), constant(m), of_column)

    @property
    def _below(self) -> Element:
        return Element(SCHUR, ElementIndex(0, (IndexTerm(self.count, ROW), IndexTerm(1, COLUMN))))

    def _substituted(self) -> ForEach:
        own = Element(REACTIONS, variable(COLUMN))
        term = _times(self._below, Element(REACTIONS, variable(ROW)))
        behind = ForEach(
            ROW,
            ElementIndex(1, (IndexTerm(1, COLUMN),)),
            constant(self.count),
            (StoreElement(own, term, Operator.SUB),),
        )
        divided = StoreElement(own, _times(own, Element(INVERSES, variable(COLUMN))))
        return ForEach(COLUMN, constant(0), constant(self.count), (behind, divided), backward=True)

    def results(self, output: str, free: str = "") -> list[Statement]:
        """The statements of free + X lambda for each row; free: the array of the accelerations, if any."""
        target = Element(output, variable(ROW))
        start = Element(free, variable(ROW)) if free else ZERO
        term = _times(Element(ANSWERS, _by_row(self.count, COLUMN)), Element(REACTIONS, variable(COLUMN)))
        added = ForEach(COLUMN, constant(0), constant(self.count), (StoreElement(target, term, Operator.ADD),))
        return [ForEach(ROW, constant(0), constant(self.rows), (StoreElement(target, start), added))]

    def given(self, output: str) -> list[Statement]:
        """The statements that give the multipliers."""
        own = StoreElement(Element(output, variable(COLUMN)), Element(REACTIONS, variable(COLUMN)))
        return [ForEach(COLUMN, constant(0), constant(self.count), (own,))]


def _by_row(count: int, other: str) -> ElementIndex:
    return ElementIndex(0, (IndexTerm(count, ROW), IndexTerm(1, other)))


def _times(a: Expr, b: Expr) -> Expr:
    return Operation(Operator.MUL, (a, b))
