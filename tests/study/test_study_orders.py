"""Orders of a KKT matrix with two coordinates coupled by inertia, a third one, and two multipliers."""

from __future__ import annotations

import numpy as np
import pytest

from derive.ir.patterns import pattern
from derive.study.pivot_orders import ORDERS, Order, matching, without_diagonal

A = np.array(
    [
        [2.0, 0.5, 0.0, -1.0, -3.0],
        [0.5, 2.0, 0.0, 0.0, -4.0],
        [0.0, 0.0, 2.0, -1e-3, 0.0],
        [-1.0, 0.0, -1e-3, 0.0, 0.0],
        [-3.0, -4.0, 0.0, 0.0, 0.0],
    ]
)
SHAPE = pattern(5, 5, {(i, j) for i in range(5) for j in range(i + 1) if A[i, j]}, symmetric=True)


@pytest.mark.parametrize("name", ORDERS)
def test_orders_name_every_unknown_once(name: str) -> None:
    order = ORDERS[name](SHAPE, 3, A)
    assert sorted(order.rows) == sorted(order.cols) == list(range(5))


def test_fixed_multipliers_wait_for_all_of_their_coordinates() -> None:
    order = ORDERS["constrained"](SHAPE, 3, A).rows
    assert all(order.index(i) > order.index(j) for i, j in SHAPE.entries if i >= 3)


def test_paired_multipliers_come_behind_what_they_are_matched_with() -> None:
    assert matching(3, A) == {3: 0, 4: 1}  # 1 * 4 is more than 1e-3 * 4 and than 1e-3 * 3
    order = ORDERS["matched"](SHAPE, 3, A).rows
    assert all(order.index(i) == order.index(j) + 1 for i, j in matching(3, A).items())


def test_kept_pivots_are_large_enough_in_the_first_matrix() -> None:
    order = ORDERS["markowitz"](SHAPE, 3, A)
    work = A[np.ix_(order.rows, order.cols)]
    for j in range(5):
        assert abs(work[j, j]) >= 0.1 * np.abs(work[j:, j]).max()
        work[j + 1 :] -= np.outer(work[j + 1 :, j] / work[j, j], work[j])


def test_multipliers_before_their_coordinates_have_no_diagonal() -> None:
    def missing(*order: int) -> int:
        return without_diagonal(SHAPE, 3, Order(order, order))

    assert missing(0, 1, 2, 3, 4) == 0
    assert missing(3, 0, 1, 2, 4) == 1
    assert missing(4, 2, 3, 0, 1) == 1  # 3 has a diagonal from 2
    assert missing(3, 4, 0, 1, 2) == 2
    assert without_diagonal(SHAPE, 3, Order((3, 4, 0, 1, 2), (0, 1, 3, 4, 2))) == 0  # no symmetric order


@pytest.mark.parametrize(("size", "first"), [(0.2, True), (0.05, False)])
def test_a_sparse_pivot_is_selected_if_it_is_a_tenth_of_its_column(size: float, first: bool) -> None:
    """The first unknown is coupled with one other, so that its pivot costs least; its column has entries up to 1."""
    matrix = np.array([[size, 1.0, 0.0, 0.0], [1.0, 2.0, 1.0, 1.0], [0.0, 1.0, 3.0, 1.0], [0.0, 1.0, 1.0, 4.0]])
    shape = pattern(4, 4, {(i, j) for i in range(4) for j in range(i + 1) if matrix[i, j]}, symmetric=True)
    order = ORDERS["markowitz"](shape, 4, matrix)
    assert ((order.rows[0], order.cols[0]) == (0, 0)) == first
