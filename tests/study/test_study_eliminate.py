"""Elimination without pivoting on matrices whose pivots are known."""

from __future__ import annotations

import numpy as np
import pytest

from conftest import QUICK
from derive.generated_models import generated
from derive.ir.patterns import pattern
from derive.runtime.loading import load_scene
from derive.spec.toml.read import parse
from derive.study.elimination import backward_error, eliminate, entry_mask, equilibrated, kkt_systems


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


def test_a_change_of_sign_beside_a_state_in_which_an_earlier_pivot_vanishes_does_not_count() -> None:
    """[[x, 1], [1, 0]] has the pivots x and -1/x: where x vanishes in a state, -1/x says nothing."""
    for values in ([0.5, 0.0, -0.5], [1e-9, -0.5], [-0.5, 1e-9]):
        A = np.array([[[x, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]] for x in values])
        found = eliminate(A, np.ones((len(values), 3)), (0, 1, 2), (0, 1, 2))
        assert found.vanished.tolist()[:2] == [True, False], values
    for values in ([0.5, 1e-9], [1e-9, 0.5]):  # the pivots of [[x, 1], [1, 100]] are x and 100 - 1/x: 98 and -1e9
        A = np.array([[[x, 1.0], [1.0, 100.0]] for x in values])
        assert eliminate(A, np.ones((2, 2)), (0, 1), (0, 1)).vanished.tolist() == [True, False], values


def test_a_pivot_is_compared_with_its_column_before_and_after_the_elimination() -> None:
    """1 + 1e-12 - 1 vanishes against the 1 that it comes from."""
    cancelled = np.array([[[1.0, 1.0], [1.0, 1.0 + 1e-12]]])
    assert eliminate(cancelled, np.ones((1, 2)), (0, 1), (0, 1)).vanished.tolist() == [False, True]
    grown = np.array([[[1e-6, 1.0, 0.0], [0.0, 1.0, 1.0], [1.0, 1.0, 0.0]]])
    # The second pivot is 1 as the largest entry of its column was, and below it there is 1 - 1e6.
    (ratios,) = eliminate(grown, np.ones((1, 3)), (0, 1, 2), (0, 1, 2)).ratios
    assert ratios[1] == pytest.approx(1e-6, rel=1e-3)


def test_growth_is_of_all_of_u() -> None:
    """The largest entry of U is the last pivot, a pivot in the middle, or an entry of a row."""
    last = np.array([[[1.0, 0.0, 100.0], [0.0, 1.0, 0.0], [100.0, 0.0, 1.0]]])
    assert eliminate(last, np.ones((1, 3)), (0, 1, 2), (0, 1, 2)).growth[0] == pytest.approx(99.99)
    first = np.array([[[1e-3, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1e-3]]])
    assert eliminate(first, np.ones((1, 3)), (0, 1, 2), (0, 1, 2)).growth[0] == pytest.approx(1e3)
    beside = np.array([[[1.0, 50.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]])
    assert eliminate(beside, np.ones((1, 3)), (0, 1, 2), (0, 1, 2)).growth[0] == pytest.approx(1.0)


def test_equilibrated_matrices_have_rows_and_columns_of_size_one_and_the_same_solution() -> None:
    random = np.random.default_rng(1)
    D = np.diag(10.0 ** random.uniform(-6, 6, 5))
    symmetric = random.normal(size=(3, 5, 5))
    A = D @ (symmetric + symmetric.transpose(0, 2, 1)) @ D
    b = random.normal(size=(3, 5))
    scaled, right = equilibrated(A, b)
    assert np.abs(scaled).max(axis=1) == pytest.approx(np.ones((3, 5)), rel=1e-3)
    assert scaled == pytest.approx(scaled.transpose(0, 2, 1))
    factors = right / b
    x = np.linalg.solve(scaled, right[:, :, None])[:, :, 0] * factors
    rounding = 1e-14 * np.einsum("sij,sj->si", np.abs(A), np.abs(x))
    assert np.all(np.abs(np.einsum("sij,sj->si", A, x) - b) < rounding)


def test_backward_errors_are_relative_to_row_sums_and_to_the_right_hand_side() -> None:
    A, x = np.array([[[1.0, 1.0], [0.0, 1.0]]]), np.array([[1.0, 1.0]])
    # |A x - b| = 6e-6, |A| = 2, |x| = 1, |b| = 2.
    assert backward_error(A, np.array([[2.0, 1.0 + 6e-6]]), x)[0] == pytest.approx(1.5e-6, rel=1e-4)


def test_the_mask_of_a_symmetric_pattern_has_both_triangles() -> None:
    shape = pattern(3, 3, {(0, 0), (2, 0)}, symmetric=True)
    assert np.argwhere(entry_mask(shape)).tolist() == [[0, 0], [0, 2], [2, 0]]


def test_kkt_systems_have_accelerations_and_multipliers_as_solutions() -> None:
    scene = parse(
        'name = "pendulum"\n[scene]\ngravity = [0, -9.81]\n[ground.markers]\no = [0, 0]\n'
        "[bodies.rod]\nmass = 2\ninertia = 1\nkeep_coordinates = true\nmarkers = { end = [-0.5, 0] }\n"
        '[joints.pin]\nkind = "revolute"\nbetween = ["ground.o", "rod.end"]\n'
    )
    native = load_scene(generated(scene)[1], QUICK)
    k, state = native.setup(), (0.0, np.array([0.5, 0.0, 0.0]), np.array([0.0, 1.5, 3.0]))
    A, b = kkt_systems(native, k, [state])
    # A rod on a pin that passes the horizontal: phi'' = -m g r / (J + m r^2), and the pin carries m r omega^2.
    vdot3 = -2 * 9.81 * 0.5 / (1 + 2 * 0.25)
    expected = [-0.5 * 9, 0.5 * vdot3, vdot3, -2 * 0.5 * 9, 2 * (9.81 + 0.5 * vdot3)]
    assert np.linalg.solve(A[0], b[0]) == pytest.approx(expected, rel=1e-12)
