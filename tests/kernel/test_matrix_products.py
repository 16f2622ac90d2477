"""Products of matrices are those of SymPy, which ask of each entry whether it is infinite; these do not."""

from __future__ import annotations

import pytest
import sympy as sp

from derive.mechanics.motion.products import inner, product


def matrices() -> tuple[sp.Matrix, sp.Matrix, sp.Matrix]:
    """Factors with zeros, numbers and sums, which are new objects for each test."""
    a, b, c = (sp.Dummy(name) for name in "abc")
    left = sp.Matrix([[a + b, 0, 2], [0, a * b - c, 1], [b, 0, 0]])
    return left, sp.Matrix([[0, c - a], [sp.Rational(1, 3), a + 2 * b], [b + c, 0]]), sp.Matrix([a - b, 0])


def test_products_are_those_of_sympy() -> None:
    first, second, third = matrices()
    assert product(first, second, third) == first * second * third
    assert product(first) is first
    assert inner(first[0, :], second[:, 0]) == first[0, :].dot(second[:, 0])


def test_vectors_of_different_lengths_have_no_product() -> None:
    with pytest.raises(ValueError, match="shorter"):
        product(sp.eye(3), sp.zeros(2, 1))


def test_no_sum_is_asked_whether_it_is_finite() -> None:
    first, second, _ = matrices()
    product(first, second)
    sums = [entry for matrix in (first, second) for entry in matrix if entry.is_Add]
    assert len(sums) == 5 and not any("finite" in entry._assumptions for entry in sums)
