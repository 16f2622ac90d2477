"""Elimination without pivoting on matrices whose pivots are known."""

from __future__ import annotations

import numpy as np
import pytest

from derive.study.elimination import backward_error, eliminate


def turned(values: list[float]) -> np.ndarray:
    """[[x, 1], [1, 0]]: the pivots are x and -1/x."""
    return np.array([[[x, 1.0], [1.0, 0.0]] for x in values])


def test_pivots_growth_and_solution() -> None:
    A, b = turned([0.5, 1e-3]), np.array([[1.0, 2.0], [3.0, 4.0]])
    found = eliminate(A, b, (0, 1), (0, 1))
    assert found.pivots == pytest.approx(np.array([[0.5, -2.0], [1e-3, -1e3]]))
    assert found.ratios == pytest.approx(np.array([[0.5, 1.0], [1e-3, 1.0]]))
    assert found.growth == pytest.approx(np.array([2.0, 1e3]))
    assert found.x == pytest.approx(np.linalg.solve(A, b[:, :, None])[:, :, 0])
    assert not found.failed.any() and not found.vanished.any()


def test_any_order_of_rows_and_columns_solves() -> None:
    random = np.random.default_rng(0)
    A, b = random.normal(size=(5, 6, 6)), random.normal(size=(5, 6))
    found = eliminate(A, b, (3, 1, 0, 5, 4, 2), (0, 5, 1, 2, 3, 4))
    assert found.x == pytest.approx(np.linalg.solve(A, b[:, :, None])[:, :, 0])
    assert backward_error(A, b, found.x).max() < 1e-12


def test_a_pivot_of_zero_fails_and_is_told() -> None:
    found = eliminate(turned([1.0, 0.0]), np.ones((2, 2)), (0, 1), (0, 1))
    assert found.failed.tolist() == [False, True] and found.growth[1] == np.inf
    assert found.vanished.tolist() == [True, False]  # what comes after it does not count
    assert backward_error(turned([0.0]), np.ones((1, 2)), found.x[1:])[0] == np.inf


@pytest.mark.parametrize(
    ("values", "first"), [([1e-9], True), ([1e-7], False), ([0.1, -0.1], True), ([0.1, 0.2], False)]
)
def test_a_pivot_vanishes_in_a_state_or_between_two(values: list[float], first: bool) -> None:
    found = eliminate(turned(values), np.ones((len(values), 2)), (0, 1), (0, 1))
    assert found.vanished.tolist() == [first, False]


def test_backward_error_is_the_change_that_makes_it_exact() -> None:
    A, x = np.array([[[2.0, 1.0], [1.0, 3.0]]]), np.array([[1.0, 1.0]])
    assert backward_error(A, np.array([[3.0, 4.0]]), x)[0] == 0.0
    # |A x - b| = 8e-6, |A| = 4, |x| = 1, |b| = 4
    assert backward_error(A, np.array([[3.0, 4.0 + 8e-6]]), x)[0] == pytest.approx(1e-6, rel=1e-5)
