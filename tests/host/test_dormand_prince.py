"""The method of Dormand and Prince: the order conditions of its step, its error estimates and its interpolant."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from functools import cache
from itertools import combinations_with_replacement
from math import prod

import numpy as np
import pytest
from numpy.typing import NDArray

from derive.runtime.compiler import compile_shared
from derive.runtime.integrators.compilation import host_sources

Array = NDArray[np.float64]
Tree = tuple["Tree", ...]
"""A rooted tree, by the subtrees of its root."""

TABLES = {"A": (16, 16), "C": (16,), "ERROR5": (12,), "ERROR6": (12,), "THIRD": (3,), "DENSE": (4, 16)}


@pytest.fixture(scope="module")
def tables(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Array]:
    """The tables of dormand_prince.c, which are static."""
    folder = tmp_path_factory.mktemp("tables")
    host_sources(["dormand_prince"], folder)
    access = "".join(f"const double *get_{name}(void) {{ return (const double *) {name}; }}\n" for name in TABLES)
    (folder / "access.c").write_text(f'#include "dormand_prince.c"\n{access}')
    library = ctypes.CDLL(str(compile_shared([folder / "access.c"], folder / "tables.so")))
    result = {}
    for name, shape in TABLES.items():
        function = getattr(library, f"get_{name}")
        function.restype = ctypes.POINTER(ctypes.c_double)
        result[name] = np.array(function()[: prod(shape)]).reshape(shape)
    return result


@cache
def trees(order: int) -> tuple[Tree, ...]:
    """The rooted trees with so many nodes."""

    def forests(nodes: int, largest: int) -> Iterator[Tree]:
        if nodes == 0:
            yield ()
        for size in range(min(nodes, largest), 0, -1):
            for count in range(1, nodes // size + 1):
                for some in combinations_with_replacement(trees(size), count):
                    for others in forests(nodes - size * count, size - 1):
                        yield (*some, *others)

    return tuple(forests(order - 1, order - 1))


def nodes(tree: Tree) -> int:
    return 1 + sum(map(nodes, tree))


def density(tree: Tree) -> int:
    """gamma(t)"""
    return nodes(tree) * prod(map(density, tree))


def weight(tree: Tree, a: Array) -> Array:
    """The elementary weight of each stage."""
    return np.asarray(prod((a @ weight(child, a) for child in tree), start=np.ones(len(a))))


def defect(b: Array, a: Array, order: int, x: float = 1.0) -> float:
    """The largest violation of the order conditions with so many nodes, of the solution with weights b at t + x h."""
    return max(abs(b @ weight(t, a)[: len(b)] - x**order / density(t)) for t in trees(order))


def test_there_are_as_many_trees_as_there_should_be() -> None:
    assert [len(trees(order)) for order in range(1, 10)] == [1, 1, 2, 4, 9, 20, 48, 115, 286]


def test_abscissae_are_the_sums_of_rows(tables: dict[str, Array]) -> None:
    assert np.abs(tables["A"].sum(axis=1) - tables["C"]).max() < 3e-14
    assert np.all(np.triu(tables["A"]) == 0)


def test_the_step_has_order_eight(tables: dict[str, Array]) -> None:
    a = tables["A"]
    b = a[12]
    assert max(defect(b, a, order) for order in range(1, 9)) < 1e-14
    assert defect(b, a, 9) > 1e-7


def test_the_estimates_have_orders_six_five_and_three(tables: dict[str, Array]) -> None:
    a = tables["A"]
    sixth, fifth = a[12, :12] - tables["ERROR6"], a[12, :12] - tables["ERROR5"]
    third = np.zeros(12)
    third[[0, 8, 11]] = tables["THIRD"]
    for b, order, rounding in ((sixth, 6, 5e-14), (fifth, 5, 1e-14), (third, 3, 1e-14)):
        assert max(defect(b, a, lower) for lower in range(1, order + 1)) < rounding
        assert defect(b, a, order + 1) > 1e-4


def test_there_is_no_other_estimate_of_order_six(tables: dict[str, Array]) -> None:
    a = tables["A"][:12, :12]
    conditions = np.array([weight(tree, a) for order in range(1, 7) for tree in trees(order)])
    conditions /= np.abs(conditions).max(axis=1)[:, None]
    assert np.sum(np.linalg.svd(conditions, compute_uv=False) > 1e-12) == 11


def vibration(weights: Array, a: Array, product: float) -> float:
    """|h sum_j weights[j] K[j]| for ydot = i omega y from y = 1, product = omega h."""
    stages = np.linalg.solve(np.eye(12) - 1j * product * a[:12, :12], 1j * product * np.ones(12))
    return float(abs(weights @ stages))


def test_the_estimates_of_a_vibration_are_equal_at_the_limit_of_stability(tables: dict[str, Array]) -> None:
    a = tables["A"]
    fifth, sixth = (vibration(tables[name], a, 5.9604) for name in ("ERROR5", "ERROR6"))
    assert sixth == pytest.approx(fifth, rel=1e-4)


@pytest.mark.parametrize("x", [0.1, 0.37, 0.5, 0.8])
def test_the_interpolant_has_order_seven(x: float, tables: dict[str, Array]) -> None:
    a = tables["A"]
    first, last = np.eye(16)[0], np.eye(16)[12]
    d = [a[12], first - a[12], 2 * a[12] - first - last, *tables["DENSE"]]
    b = np.zeros(16)
    for j in range(6, -1, -1):
        b = (b + d[j]) * (x if j % 2 == 0 else 1 - x)
    assert max(defect(b, a, order, x) for order in range(1, 8)) < 1e-13
    assert defect(b, a, 8, x) > 1e-9
