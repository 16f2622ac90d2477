"""Loops over bodies and joints compute what straight-line code computes, on random graphs of bodies."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from both_lowerings import OF_LEAST_NORM, check, results
from graph_scenes import SHAPES
from random_graphs import TWIN, Graph, graph, ring_of_rods, sliding_chain

from conftest import random_cases
from derive.spec.model.planar_bodies import BeamBody

FEW = 4
"""Bodies of small graphs, at most."""
SMALL = (0, 4, 9, 35)
WITH_PORTS = (1, 14)
VARYING = (53, 31)
TWINS = (31, 14)
IN_PIECES = (15, 7)


@pytest.mark.parametrize(
    "seed", [*SMALL, *(pytest.param(n, marks=pytest.mark.long) for n in (1, 6, 12, 14, 15, 30, 38, 39))]
)
def test_small_graphs(seed: int) -> None:
    check(small(seed))


@pytest.mark.parametrize("seed", [*WITH_PORTS, *(pytest.param(n, marks=pytest.mark.long) for n in (0, 4, 9, 15))])
def test_graphs_with_parameters_inputs_springs_and_outputs(seed: int) -> None:
    """Derivatives with respect to parameters and inputs are among the functions."""
    of = graph(seed, FEW, ports=True)
    (jacobian,) = of.instances.kernel("parameter_jacobian").outputs
    assert jacobian.pattern and len(jacobian.pattern.entries) > 5
    check(of)


@pytest.mark.parametrize("seed", [VARYING[0], pytest.param(VARYING[1], marks=pytest.mark.long)])
def test_graphs_with_joints_that_depend_on_both_of_their_bodies(seed: int) -> None:
    """Their axes move, or they remove functions of several relative motions; seed 53 has a drive of such a joint."""
    of = graph(seed, FEW, ports=True, varying=True)
    assert {"first_factor", "second_factor"} <= of.instances.kernel("solve").used
    check(of)


@pytest.mark.parametrize("seed", [TWINS[0], pytest.param(TWINS[1], marks=pytest.mark.long)])
def test_redundant_joints_that_depend_on_both_of_their_bodies(seed: int) -> None:
    """Two joints of each scene are there twice, so that reactions are those of least norm: the same in both."""
    of = graph(seed, FEW, varying=True, twins=2)
    assert of.instances.proximal and {"first_factor", "second_factor"} <= of.instances.kernel("solve").used
    check(of)
    flat, loops = (results(of, model, "solve")["lam"] for model in (of.flat, of.instances))
    assert np.abs(loops - flat).max() < OF_LEAST_NORM * np.abs(flat).max()
    number = {multiplier.name: k for k, multiplier in enumerate(of.flat.multipliers)}
    twins = [(k, number[f"{TWIN}{name}"]) for name, k in number.items() if f"{TWIN}{name}" in number]
    assert len(twins) > 1
    assert all(loops[a] == pytest.approx(loops[b], rel=1e-3) for a, b in twins)


@pytest.mark.parametrize("driven", [True, pytest.param(False, marks=pytest.mark.long)])
def test_a_chain_in_which_each_body_slides_along_the_one_before(driven: bool) -> None:
    """The joints are one group whose bodies differ in their numbers."""
    check(sliding_chain(6, driven))


@cache
def small(seed: int, varying: bool = False, pieces: bool = False) -> Graph:
    return graph(seed, FEW, varying=varying, pieces=pieces)


@pytest.mark.parametrize(
    "seed", [*IN_PIECES[:1], *(pytest.param(seed, marks=pytest.mark.long) for seed in IN_PIECES[1:])]
)
def test_graphs_with_beams_in_pieces(seed: int) -> None:
    """Pieces are bodies that welds connect; damping couples them, and loads act on each."""
    of = small(seed, False, True)
    assert any(body.pieces > 1 for body in of.scene.bodies if isinstance(body, BeamBody))
    check(of)


@pytest.mark.long
def test_pieces_of_a_rod_with_damping_loads_energies_and_powers() -> None:
    check(graph(3, 2, ports=True, pieces=True))


@pytest.mark.parametrize("seed", random_cases(300, long=6, further=60))
def test_more_graphs_with_beams_in_pieces(seed: int) -> None:
    check(graph(seed, FEW, ports=seed % 4 == 0, varying=seed % 3 == 0, pieces=True))


def test_rods_that_meet_their_joints_in_either_order() -> None:
    """Rods of one class whose joints are eliminated in different orders: their blocks are turned or not."""
    of = ring_of_rods(6, (3, 0, 5, 1, 4, 2))
    names = [array.name for array in of.instances.constant_arrays]
    assert any(name.startswith("coupling_0_1_row") for name in names), "no class has turned blocks and others"
    check(of)


def test_every_shape_is_among_the_small_graphs() -> None:
    assert {seed % len(SHAPES) for seed in (*SMALL, *WITH_PORTS)} == {*range(len(SHAPES))}


# 48 larger graphs are long, and 152 further ones are run by `pytest -m further tests/kernel`.


@pytest.mark.parametrize("seed", random_cases(100, long=18, further=52))
def test_larger_graphs(seed: int) -> None:
    check(graph(seed))


@pytest.mark.parametrize("seed", random_cases(200, long=18, further=72))
def test_more_graphs_with_joints_that_depend_on_both_of_their_bodies(seed: int) -> None:
    check(graph(seed, FEW, ports=seed % 2 == 0, varying=True))


@pytest.mark.parametrize("seed", random_cases(20, long=12, further=28))
def test_larger_graphs_with_parameters_inputs_springs_and_outputs(seed: int) -> None:
    check(graph(seed, ports=True))
