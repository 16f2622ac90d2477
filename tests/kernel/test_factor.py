"""The written-out LDL^T against NumPy, on patterns with and without fill-in."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from derive.ir.patterns import Pattern, pattern
from derive.lowering.elimination_orders import amd_order, elimination_order, fill_in, least_degree_order, work
from derive.lowering.ldlt import factorise, solve


def random_pattern(n: int, density: float, seed: int) -> Pattern:
    rng = np.random.default_rng(seed)
    entries = {(i, j) for i in range(n) for j in range(i) if rng.random() < density}
    return pattern(n, n, entries | {(i, i) for i in range(n)}, symmetric=True)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("density", [0.0, 0.3, 1.0])
def test_solution_is_that_of_numpy(density: float, seed: int) -> None:
    n = 7
    shape = random_pattern(n, density, seed)
    rng = np.random.default_rng(seed)
    dense = np.zeros((n, n))
    for i, j in shape.entries:
        dense[i, j] = dense[j, i] = rng.uniform(-1, 1) + (n if i == j else 0)
    right = rng.uniform(-1, 1, n)
    symbols = {entry: ca.SX.sym(f"a{entry[0]}{entry[1]}") for entry in shape.entries}
    b = [ca.SX.sym(f"b{i}") for i in range(n)]
    factors = factorise(shape, symbols)
    solution = ca.vertcat(*solve(factors, list(b)))
    function = ca.Function("f", [ca.vertcat(*symbols.values()), ca.vertcat(*b)], [solution])
    found = np.array(function([dense[e] for e in symbols], right)).ravel()
    assert np.allclose(found, np.linalg.solve(dense, right), rtol=1e-13, atol=1e-14)
    assert sorted(factors.order) == list(range(n))


def test_an_arrow_matrix_is_ordered_without_fill() -> None:
    """Eliminating the hub first would fill everything."""
    n = 8
    shape = pattern(n, n, {(i, 0) for i in range(n)} | {(i, i) for i in range(n)}, symmetric=True)
    symbols = {entry: ca.SX.sym("a") for entry in shape.entries}
    assert factorise(shape, symbols).fill == 0
    assert elimination_order(shape)[0] != 0


@pytest.mark.parametrize("modes", [3, 8])
def test_modes_of_a_body_in_space_are_eliminated_before_its_rotations(modes: int) -> None:
    """Each mode is coupled with the three rotations alone; AMD has rotations before the last modes, with fill-in."""
    translations, rotations, first = range(3), range(3, 6), 6
    size = first + modes
    coupled = {(i, j) for i in range(first, size) for j in rotations} | {(4, 3), (5, 3), (5, 4)}
    shape = pattern(size, size, coupled | {(i, i) for i in range(size)}, symmetric=True)
    order = elimination_order(shape)
    assert order == (*translations, *range(first, size), *rotations)
    assert fill_in(shape, order) == 0 < fill_in(shape, amd_order(shape))


def test_of_two_minimum_degree_orders_the_one_with_less_work_is_taken() -> None:
    """Neither exact nor approximate degrees are better on all patterns."""
    better = set()
    for seed in range(40):
        shape = random_pattern(14, 0.25, seed)
        exact, approximate = (work(shape, order(shape)) for order in (least_degree_order, amd_order))
        assert work(shape, elimination_order(shape)) == min(exact, approximate)
        better.add((exact > approximate) - (exact < approximate))
    assert better >= {-1, 1}
