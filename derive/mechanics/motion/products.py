"""Products of matrices whose entries are finite.

Those of SymPy ask of each entry whether it is infinite, since zero times infinity is not zero. Of a sum of symbols that
takes as long as a hundred products, and there is no answer.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce

from derive.algebra import sp


def product(*factors: sp.Matrix) -> sp.Matrix:
    """The product of matrices, not expanded."""
    return reduce(_product, factors)


def inner(a: Iterable[sp.Expr], b: Iterable[sp.Expr]) -> sp.Expr:
    """The product a . b of two vectors, not expanded."""
    return sp.Add(*[x * y for x, y in zip(a, b, strict=True) if x and y])


def _product(a: sp.Matrix, b: sp.Matrix) -> sp.Matrix:
    columns = b.T.tolist()
    return sp.Matrix([[inner(row, column) for column in columns] for row in a.tolist()])
