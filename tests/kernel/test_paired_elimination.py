"""Pairs of a coordinate and a multiplier: which are chosen, and that eliminating them solves the system."""

from __future__ import annotations

import casadi as ca
import numpy as np

from derive.ir.patterns import Pattern, pattern
from derive.lowering.ldlt import backward, factorise, forward
from derive.lowering.paired_elimination import Pair, PairedElimination, forest_of_pairs, left_by_pairs

COORDINATES = 5
"""Three translations and two rotations; the multipliers are 5 to 8."""
FACTORS = {
    (5, 0): 1.0,  # the ground and the first translation
    (6, 0): -1.0,  # the first translation and the second
    (6, 1): 1.0,
    (7, 1): 2.0,  # the second translation and the ground: closes a loop
    (8, 2): 0.3,  # a factor that varies
}
CONSTANT = [(5, 0), (6, 0), (6, 1), (7, 1)]


def system(seed: int = 1) -> np.ndarray:
    """A KKT matrix with coupled coordinates; every constraint has factors of the rotations."""
    rng = np.random.default_rng(seed)
    a = rng.normal(size=(COORDINATES, COORDINATES))
    mass = np.diag(rng.uniform(1, 2, COORDINATES))
    mass[2:, 2:] += a[2:, 2:] @ a[2:, 2:].T
    mass[1, 3] = mass[3, 1] = 0.2
    G = np.zeros((4, COORDINATES))
    for (i, j), value in FACTORS.items():
        G[i - COORDINATES, j] = value
    G[:, 3:] = rng.normal(size=(4, 2))
    return np.block([[mass, -G.T], [-G, np.zeros((4, 4))]])


def pattern_of(matrix: np.ndarray) -> Pattern:
    """The pattern of the lower triangle."""
    rows, cols = np.nonzero(np.tril(matrix))
    entries = set(zip(rows.tolist(), cols.tolist(), strict=True))
    return pattern(len(matrix), len(matrix), entries, symmetric=True)


def test_pairs_are_a_forest_from_its_leaves() -> None:
    """The edge that closes a loop stays, and so does a constraint whose factor varies."""
    pairs = forest_of_pairs(pattern_of(system()), COORDINATES, CONSTANT)
    assert {p.coordinate for p in pairs} == {0, 1} and {p.multiplier for p in pairs} < {5, 6, 7}
    chain = forest_of_pairs(pattern_of(system()), COORDINATES, [(5, 0), (6, 0), (6, 1)])
    assert chain == (Pair(1, 6), Pair(0, 5)), "the second body before the first one, which carries it"


def test_a_constraint_with_a_varying_factor_of_a_paired_coordinate_stays() -> None:
    """The constraint 6 has a varying factor of 1: constant factors alone would not make the pairs independent."""
    pairs = forest_of_pairs(pattern_of(system()), COORDINATES, [(5, 0), (6, 0), (7, 1)])
    assert {*pairs} == {Pair(0, 5), Pair(1, 7)}


def test_the_pairs_and_the_rest_solve_the_system() -> None:
    """Two pairs, then LDL^T of what is left: its pattern is predicted, and multipliers have no diagonal entries."""
    matrix = system()
    shape = pattern_of(matrix)
    pairs = forest_of_pairs(shape, COORDINATES, CONSTANT)
    entries = {(i, j): ca.SX(matrix[i, j]) for i, j in shape.entries}
    elimination = PairedElimination(entries, pairs)
    left, products = left_by_pairs(shape, pairs)
    assert {*entries} == {*left.entries} and products > 0
    assert not any(i == j >= COORDINATES for i, j in entries)
    gone = {row for p in pairs for row in (p.coordinate, p.multiplier)}
    order = tuple(i for i in range(len(matrix)) if i not in gone)
    factors = factorise(left, entries, order, COORDINATES)
    right = np.arange(1.0, 1 + len(matrix))
    eliminated = forward(factors, elimination.forward([ca.SX(x) for x in right]))
    solution = backward(factors, eliminated)
    x = elimination.backward(eliminated, {i: solution[i] for i in order})
    assert np.allclose(matrix @ np.array([float(value) for value in x]), right, rtol=1e-12, atol=1e-12)
