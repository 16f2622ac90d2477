"""Null spaces of rational matrices, compared with SymPy's, whose basis is the same one."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest
import sympy as sp

from derive.mechanics.exact_nullspace import nullspace


@pytest.mark.parametrize(
    ("rows", "columns", "rank"), [(2, 5, 2), (4, 4, 2), (5, 3, 3), (3, 6, 1), (0, 2, 0), (3, 3, 0)]
)
def test_the_basis_is_that_of_sympy(rows: int, columns: int, rank: int) -> None:
    rng = random.Random(rows + 10 * columns)
    left, right = (
        [[Fraction(rng.randint(-9, 9), rng.randint(1, 7)) for _ in range(n)] for _ in range(m)]
        for m, n in ((rows, rank), (rank, columns))
    )
    matrix = [
        [sum((a * b[j] for a, b in zip(of, right, strict=True)), Fraction(0)) for j in range(columns)] for of in left
    ]
    found = nullspace(matrix, columns)
    exact = sp.Matrix(rows, columns, [sp.Rational(x.numerator, x.denominator) for row in matrix for x in row])
    expected = [[Fraction(int(x.p), int(x.q)) for x in vector] for vector in exact.nullspace()]
    assert found == expected
    assert len(found) == columns - rank
