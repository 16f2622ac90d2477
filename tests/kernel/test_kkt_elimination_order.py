"""The order and the factorisation of KKT matrices: no pivot vanishes where the matrix is regular."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from numpy.typing import NDArray

from derive.ir.patterns import Pattern, pattern
from derive.lowering.elimination_orders import coordinates_first, elimination_order, matched_order, safe_order, work
from derive.lowering.flat.graph import LoweringError
from derive.lowering.ldlt import factorise, solve

N, MULTIPLIERS = 9, 5


def random_saddle(seed: int) -> tuple[Pattern, NDArray[np.float64]]:
    """[M, -G^T; -G, 0] with sparse M and G; some entries of its pattern are zero, as in some states."""
    rng = np.random.default_rng(seed)
    low = np.where(rng.random((N, N)) < 0.15, rng.uniform(-0.3, 0.3, (N, N)), 0.0)
    mass = np.tril(low, -1) + np.tril(low, -1).T + np.diag(rng.uniform(2, 3, N))
    constraints = np.where(rng.random((MULTIPLIERS, N)) < 0.4, rng.uniform(-1, 1, (MULTIPLIERS, N)), 0.0)
    constraints[range(MULTIPLIERS), rng.permutation(N)[:MULTIPLIERS]] = 1.0
    matrix = np.block([[mass, -constraints.T], [-constraints, np.zeros((MULTIPLIERS, MULTIPLIERS))]])
    extra = {(N + k, int(j)) for k in range(MULTIPLIERS) for j in rng.integers(0, N, 2)}
    present = {(i, j) for i, j in zip(*np.nonzero(matrix), strict=True) if i >= j}
    size = N + MULTIPLIERS
    return pattern(size, size, {(int(i), int(j)) for i, j in present} | extra, symmetric=True), matrix


@pytest.mark.parametrize("seed", range(20))
def test_solution_is_that_of_numpy(seed: int) -> None:
    shape, matrix = random_saddle(seed)
    assert np.linalg.matrix_rank(matrix[N:, :N]) == MULTIPLIERS
    right = np.random.default_rng(seed).uniform(-1, 1, len(matrix))
    solution, pivots, order = eliminated(shape, matrix, right, safe_order(shape, N))
    assert np.allclose(solution, np.linalg.solve(matrix, right), rtol=1e-11, atol=1e-12)
    assert all((pivot > 0) == (node < N) for pivot, node in zip(pivots, order, strict=True))


@pytest.mark.parametrize("seed", range(20))
def test_multipliers_wait_for_their_coordinates(seed: int) -> None:
    shape, _ = random_saddle(seed)
    order = safe_order(shape, N)
    assert sorted(order) == list(range(N + MULTIPLIERS))
    for i, j in shape.entries:
        if i >= N > j:
            assert order.index(i) > order.index(j)


def test_a_matched_order_takes_no_more_work_and_is_not_safe() -> None:
    """Its pivots vanish where the entry of a pair does, as some entries of these patterns do; otherwise it solves."""
    vanished = []
    for seed in range(8):
        shape, matrix = random_saddle(seed)
        order = matched_order(shape, N)
        assert sorted(order) == list(range(N + MULTIPLIERS))
        for k in range(N, N + MULTIPLIERS):
            assert any(order.index(j) < order.index(k) for i, j in shape.entries if i == k)
        assert work(shape, order) <= work(shape, safe_order(shape, N))
        right = np.random.default_rng(seed).uniform(-1, 1, len(matrix))
        solution, pivots, _ = eliminated(shape, matrix, right, order)
        vanished.append(0.0 in pivots)
        if not vanished[-1]:
            assert np.allclose(solution, np.linalg.solve(matrix, right), rtol=1e-8, atol=1e-9)
    assert any(vanished) and not all(vanished)


def test_modes_of_welded_bodies_come_before_their_rotations() -> None:
    """They have fewer neighbours, unless multipliers that only seem to come first connect them with each other."""
    modes, bodies = 8, 3
    each = modes + 3
    count = bodies * each
    entries = {(i, i) for i in range(count)}
    for first in range(0, count, each):
        entries |= {(i, j) for i in range(first, first + each) for j in range(first, min(i, first + 3))}
    for k in range(6 * bodies):
        ends = (k // 6, k // 6 - 1)
        entries |= {(count + k, body * each + j) for body in ends if body >= 0 for j in range(each)}
    shape = pattern(count + 6 * bodies, count + 6 * bodies, entries, symmetric=True)
    assert work(shape, safe_order(shape, count)) <= work(shape, coordinates_first(shape, count))


def test_an_order_that_does_not_know_of_multipliers_fails() -> None:
    """A multiplier may come before all of its coordinates; its pivot is then an exact zero."""
    failed = []
    for seed in range(20):
        shape, matrix = random_saddle(seed)
        order = elimination_order(shape)
        first = [
            k for k in order if k >= N and all(order.index(j) > order.index(k) for i, j in shape.entries if i == k)
        ]
        if first:
            with pytest.raises(LoweringError, match="there is nothing to divide by"):
                eliminated(shape, matrix, np.ones(len(matrix)), order)
            failed.append(seed)
    assert failed


def test_a_pivot_of_dependent_constraints_is_rounding_error_of_its_scale() -> None:
    mass, constraints = np.diag([1.0, 2.0, 3.0]), np.array([[1.0, 0.3, 0.7], [1.0, 0.3, 0.7]])
    matrix = np.block([[mass, -constraints.T], [-constraints, np.zeros((2, 2))]])
    size = len(matrix)
    shape = pattern(size, size, {(i, j) for i, j in zip(*np.nonzero(np.tril(matrix)), strict=True)}, symmetric=True)
    symbols = {entry: ca.SX.sym("a") for entry in shape.entries}
    factors = factorise(shape, symbols, safe_order(shape, 3), 3)
    last = ca.Function("f", [ca.vertcat(*symbols.values())], [factors.pivots[-1], factors.scales[-1]])
    pivot, scale = (float(x) for x in last([matrix[e] for e in symbols]))
    assert abs(pivot) < 2**-44 * abs(scale)


def eliminated(
    shape: Pattern, matrix: NDArray[np.float64], right: NDArray[np.float64], order: tuple[int, ...]
) -> tuple[NDArray[np.float64], list[float], tuple[int, ...]]:
    """Solution, pivots and order of the written-out factorisation, with numbers."""
    symbols = {entry: ca.SX.sym("a") for entry in shape.entries}
    b = [ca.SX.sym("b") for _ in right]
    factors = factorise(shape, symbols, order, N)
    outputs = [ca.vertcat(*solve(factors, list(b))), ca.vertcat(*factors.pivots)]
    function = ca.Function("f", [ca.vertcat(*symbols.values()), ca.vertcat(*b)], outputs)
    solution, pivots = function([matrix[entry] for entry in symbols], right)
    return np.array(solution).ravel(), list(np.array(pivots).ravel()), factors.order
