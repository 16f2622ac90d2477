"""Cholesky factors and substitutions with them as plain statements, in place and column by column."""

from __future__ import annotations

from fractions import Fraction

from derive.ir.expressions import Element, Number, Operation, Operator, ScalarRef
from derive.ir.indices import ElementIndex, IndexTerm, constant, triangle, variable
from derive.ir.loop_nests import Alias, Assign, For, Node, ordered_loop
from derive.ir.statements import Cholesky, Let, Require, Requirement, TriangularSolve

ROW, COLUMN = variable("i"), variable("j")


def _square(n: int, row: str, column: str) -> ElementIndex:
    """The index of an entry of a square matrix of n columns one after the other."""
    return ElementIndex(0, (IndexTerm(n, column), IndexTerm(1, row)))


def cholesky(s: Cholesky) -> tuple[Node, ...]:
    """The factorisation, column by column and in place."""
    n = s.count

    def low(index: ElementIndex) -> Element:
        return Element("low", index)

    copied = Assign(low(_square(n, "i", "j")), Element(s.source, triangle(n, 1, "j", "i")))
    product = Operation(Operator.MUL, (low(_square(n, "i", "m")), ScalarRef("above")))
    minus = Assign(low(_square(n, "i", "j")), product, Operator.SUB)
    columns: list[Node] = [Let("above", low(_square(n, "j", "m"))), ordered_loop("i", n, [minus], COLUMN)]
    pivot = low(variable("j", n + 1))
    inverse = Operation(Operator.DIV, (Number(Fraction(1)), Operation(Operator.SQRT, (pivot,))))
    scaled = Assign(low(_square(n, "i", "j")), ScalarRef("inverse"), Operator.MUL)
    body: list[Node] = [
        ordered_loop("m", COLUMN, columns),
        Require(Requirement.POSITIVE, pivot, s.code, s.text),
        Let("inverse", inverse),
        ordered_loop("i", n, [scaled], COLUMN.plus(1)),
        Assign(pivot, ScalarRef("inverse")),
    ]
    source = ordered_loop("j", n, [ordered_loop("i", n, [copied], COLUMN)])
    return (Alias("low", s.output, constant(s.offset)), source, ordered_loop("j", n, body))


def forward_substitution(s: TriangularSolve) -> For:
    """L^-1 y for all arrays in one pass, so that each entry of the factor is read once."""
    n = s.count
    pivot, below = Element(s.factor, variable("j", n + 1)), Element(s.factor, _square(n, "i", "j"))
    fixed = {array: f"y{k}" for k, array in enumerate(s.arrays)}
    products = {array: Operation(Operator.MUL, (below, ScalarRef(name))) for array, name in fixed.items()}
    body: list[Node] = [
        *(Assign(Element(array, COLUMN), pivot, Operator.MUL) for array in s.arrays),
        *(Let(name, Element(array, COLUMN)) for array, name in fixed.items()),
        ordered_loop("i", n, (Assign(Element(a, ROW), p, Operator.SUB) for a, p in products.items()), COLUMN.plus(1)),
    ]
    return ordered_loop("j", n, body)


def back_substitution(s: TriangularSolve) -> For:
    """L^-T y for all arrays in one pass; a row of L^T is a column of L."""
    n = s.count
    pivot, below = Element(s.factor, variable("j", n + 1)), Element(s.factor, _square(n, "i", "j"))
    products = {array: Operation(Operator.MUL, (below, Element(array, ROW))) for array in s.arrays}
    rest = (Assign(Element(array, COLUMN), product, Operator.SUB) for array, product in products.items())
    body: list[Node] = [
        ordered_loop("i", n, rest, COLUMN.plus(1)),
        *(Assign(Element(array, COLUMN), pivot, Operator.MUL) for array in s.arrays),
    ]
    return For("j", constant(n - 1), constant(-1), tuple(body), step=-1)
