"""Recursions along trees of rigid bodies beside the terms of their equations: equal values, no more operations."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from trees_of_bodies import random_tree

import derive
from derive.ir.analysis import operations
from derive.ir.interpreter import interpret
from derive.runtime.interpreted_scene import InterpretedScene
from derive.simulation.compiled_scene import mass_matrix
from derive.simulation.configurations import normalised
from some_functions import only

LIMIT = 1e-11
AXES = ({"x": [0, 1, 0], "z": [0, 0, 1]}, {"x": [0, 0, -1], "z": [0, 1, 0]}, {"x": [3, 4, 0], "z": [0, 0, -1]})
"""Rotations of markers that are permutations of axes, and one that is not."""
LOOPS = {
    "rod": {"kind": "distance", "between": ["ground.o", "body2.o"], "distance": 1},
    "ball": {"kind": "spherical", "between": ["body1.o", "ground.o"], "closes_loop": True},
}


def tree(seed: int, kinds: tuple[str, ...], free: bool, loops: bool, right: bool) -> derive.SpatialScene:
    """A random tree; loops: with constraints; right: whether the axes of its markers are those of bodies, turned."""
    tables: Any = random_tree(seed, kinds, free)
    tables["joints"] |= LOOPS if loops else {}
    if right:
        for n, body in enumerate(tables["bodies"].values()):
            for name, marker in body["markers"].items():
                marker["rotation"] = AXES[(n + len(name)) % 3]
    return replace(derive.spatial_scene(tables), coordinates="relative")


@pytest.mark.parametrize(
    ("seed", "kinds", "free", "loops", "right"),
    [
        (0, ("revolute", "spherical", "prismatic"), True, False, False),
        (1, ("revolute", "planar", "fixed", "screw"), False, False, True),
        (2, ("cylindrical", "universal", "revolute"), True, True, True),
    ],
)
def test_recursions_solve_the_equations_of_trees(
    seed: int, kinds: tuple[str, ...], free: bool, loops: bool, right: bool
) -> None:
    """h by Newton and Euler, accelerations and multipliers by articulated bodies; T is v . M v / 2."""
    equations = replace(derive.derive(tree(seed, kinds, free, loops, right)).expanded(), markers=())
    with only("force", "solve", "energy"):
        by_recursion, by_terms = (derive.lower(of, explicit=True) for of in (equations, replace(equations, trees=())))
    rng = np.random.default_rng(seed)
    found: list[list[NDArray[np.float64]]] = []
    for model in (by_recursion, by_terms):
        native = InterpretedScene(model)
        k = native.setup()
        if not found:
            q = normalised(native, rng.normal(size=native.nq))
            v = rng.normal(size=native.nv)
        vdot, lam = native.solve(0.0, q, v, k)
        found.append([vdot, lam, native.force(0.0, q, v, k)])
        T = v @ mass_matrix(native, q, k) @ v / 2
        assert native.energy(q, v, k)[0] == pytest.approx(T, rel=LIMIT)
    for ours, other in zip(*found, strict=True):
        assert abs(ours - other).max(initial=0) < LIMIT * abs(other).max(initial=1)
    for name in ("force", "solve"):
        counts = [sum(map(operations, model.kernel(name).statements)) for model in (by_recursion, by_terms)]
        assert counts[0] <= counts[1], name


def test_residuals_of_trees_vanish_where_their_accelerations_are() -> None:
    """M vdot + h by Newton and Euler, in residuals for implicit integrators."""
    model = derive.lower(derive.derive(tree(3, ("revolute", "cylindrical"), False, False, True)))
    native = InterpretedScene(model)
    k, (q, v) = native.setup(), np.random.default_rng(0).normal(size=(2, native.nq))
    vdot, _ = native.solve(0.0, q, v, k)
    given = {"t": 0.0, "y": [*q, *v], "ydot": [*v, *vdot], "k": k}
    found = [interpret(model.kernel("residual"), {**given, "ydot": [*v, *a]})["F"] for a in (vdot, 0 * vdot)]
    assert np.abs(found[0]).max() < LIMIT * np.abs(found[1]).max()
