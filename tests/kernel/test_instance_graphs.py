"""Loops over bodies and joints compute what straight-line code computes, on random graphs of bodies.

Sums are compared relative to the magnitudes of their terms. Solutions are measured by what they leave of M vdot + h -
G^T lambda and of G vdot - gamma, relative to the terms of these, and by their distance from each other and from a
solution in 50 digits, in the norm of M: the constrained motion is the free motion minus that due to the reactions, so
that the condition of G M^-1 G^T multiplies errors of these two.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
import pytest
from random_graphs import SHAPES, TWIN, Graph, dense, graph, relative_eigenvalues, ring_of_rods, sliding_chain

from conftest import random_cases
from corpus.summed_terms import summed_terms, worst
from derive.ir.interpreter import interpret
from derive.ir.kernel import Kernel
from derive.ir.model import Model
from derive.ir.patterns import Pattern
from derive.spec.model.planar_bodies import BeamBody

TOLERANCE = 1e-13
OF_CONDITION = 1e-15
"""Errors of solutions, relative to their terms, for a system of condition 1: a few units in the last place."""
SINGULAR = 1e-12
"""Eigenvalues of redundant constraints, which are less than those of others by WELL_POSED."""
OF_LEAST_NORM = 1e-5
"""Errors of reactions that are not unique, relative to the largest one; see `derive.lowering.proximal`."""
SOLVED = ("accel", "solve", "project_velocity", "solve_kkt")
FEW = 4
"""Bodies of small graphs, at most."""
SMALL = (0, 4, 9, 35)
WITH_PORTS = (1, 14)
VARYING = (53, 31)
TWINS = (31, 14)
LATER = pytest.mark.long
"""Further seeds of the tests of small graphs."""
IN_PIECES = (15, 7)


def results(of: Graph, model: Model, name: str) -> dict[str, np.ndarray]:
    """The results of a function, under its name in straight-line code."""
    kernel, number = of_marker(model, name)
    return {o: np.array(x, float) for o, x in interpret(kernel, of.arguments(name, model) | number).items()}


def of_marker(model: Model, name: str) -> tuple[Kernel, dict[str, int]]:
    """The function of that name; of a marker of a class that of the class, and the number of the marker there."""
    kind, _, marker = name.partition("_")
    for in_class in model.marker_classes if kind in ("marker", "load") else ():
        markers = [m.name for m in in_class.markers]
        if marker in markers:
            return model.kernel(f"{kind}_{in_class.name}"), {"number": markers.index(marker)}
    return model.kernel(name), {}


def terms(of: Graph, name: str) -> np.ndarray:
    return summed_terms(of.flat, name, *of.arguments(name).values())


@dataclass(frozen=True)
class System:
    """M x - G^T lambda = -h, G x = gamma of a graph, and the magnitudes of what is added up in them."""

    of: Graph

    def __post_init__(self) -> None:
        assert self.condition < 1e9

    @cached_property
    def m(self) -> np.ndarray:
        return dense(self.of.flat, "mass", self.of.state)

    @cached_property
    def g(self) -> np.ndarray:
        return dense(self.of.flat, "constraint_jacobian", self.of.state)

    @cached_property
    def inverse(self) -> np.ndarray:
        return np.linalg.inv(self.m)

    @cached_property
    def condition(self) -> float:
        """The condition of G M^-1 G^T, scaled to ones on the diagonal, where it has no eigenvalue 0."""
        values = relative_eigenvalues(self.m, self.g)
        values = values[values > SINGULAR]
        return float(values[0] / values[-1]) if len(values) else 1.0

    def forces(self, lam: np.ndarray) -> np.ndarray:
        """The terms of h - G^T lambda."""
        return terms(self.of, "force") + abs(self.g.T) @ abs(lam)

    def residuals(self, x: np.ndarray, lam: np.ndarray) -> tuple[float, float]:
        """The rest of the equations of motion and that of the constraints, relative to their terms."""
        (h,), (gamma,) = (results(self.of, self.of.flat, name).values() for name in ("force", "constraint_bias"))
        free = abs(self.inverse) @ self.forces(lam)
        motion = worst(self.m @ x, self.g.T @ lam - h, abs(self.m) @ abs(x) + self.forces(lam))
        joints = worst(self.g @ x, gamma, abs(self.g) @ free + terms(self.of, "constraint_bias")) if len(lam) else 0.0
        return motion, joints

    def norm(self, x: np.ndarray) -> float:
        return float(np.sqrt(x @ self.m @ x))

    def bound(self, forces: np.ndarray) -> float:
        """The error of a motion due to forces with such terms."""
        return OF_CONDITION * self.condition * self.norm(abs(self.inverse) @ forces)


def check(of: Graph) -> None:
    """Every function of the one model gives what it gives in the other one."""
    check_patterns(of)
    for name, apart in differences(of):
        assert apart <= TOLERANCE, f"{name}: {apart:.2g} of the summed terms"
    system = System(of)
    flat, loops = (results(of, model, "solve") for model in (of.flat, of.instances))
    motion, joints = system.residuals(loops["vdot"], loops["lam"])
    assert motion <= TOLERANCE, f"equations of motion: {motion:.2g} of the summed terms"
    assert joints <= max(TOLERANCE, OF_CONDITION * system.condition), f"constraints: {joints:.2g} of the summed terms"
    apart = system.norm(loops["vdot"] - flat["vdot"])
    assert apart <= system.bound(system.forces(flat["lam"])), f"vdot: {apart:.2g}, condition {system.condition:.2g}"
    assert np.array_equal(results(of, of.instances, "accel")["vdot"], loops["vdot"])
    by_flat, by_loops = (results(of, model, "project_velocity")["dv"] for model in (of.flat, of.instances))
    reactions = np.linalg.pinv(system.g @ system.inverse @ system.g.T) @ of.state["r"]
    assert system.norm(by_loops - by_flat) <= system.bound(abs(system.g.T) @ abs(reactions))
    if of.flat.sensitivities:
        by_flat, by_loops = (results(of, model, "solve_kkt") for model in (of.flat, of.instances))
        forces = abs(np.array(of.state["a"])) + abs(system.g.T) @ abs(by_flat["lam"])
        assert system.norm(by_loops["x"] - by_flat["x"]) <= system.bound(forces)


def check_patterns(of: Graph) -> None:
    """The functions, their arguments, the names of variables and the patterns of matrices are the same.

    The constants are their own.
    """
    for table in ("coordinates", "velocities", "multipliers", "outputs"):
        flat, loops = getattr(of.flat, table), getattr(of.instances, table)
        assert [(v.name, v.unit, v.doc) for v in flat] == [(v.name, v.unit, v.doc) for v in loops]
    functions = [of_marker(of.instances, kernel.name)[0] for kernel in of.flat.kernels]
    assert [*dict.fromkeys(k.name for k in functions)] == [k.name for k in of.instances.kernels]
    for flat, loops in zip(of.flat.kernels, functions, strict=True):
        numbers = [(a.name, a.name != "k" and a.size) for a in loops.arguments if not a.integer]
        assert [(a.name, a.name != "k" and a.size) for a in flat.arguments] == numbers
        for a, b in zip(flat.outputs, loops.outputs, strict=True) if flat.name != "setup" else ():
            number = of_marker(of.instances, flat.name)[1]
            expected = b.pattern if b.pattern is None or not number else among(of.instances, flat.name)
            assert (a.name, a.size, shape(a.pattern)) == (b.name, b.size, shape(expected)), flat.name


def among(model: Model, name: str) -> Pattern:
    """The pattern of the Jacobian of a marker in all generalised velocities."""
    kernel, number = of_marker(model, name)
    (in_class,) = (c for c in model.marker_classes if kernel.name == f"marker_{c.name}")
    return in_class.pattern.among(in_class.columns[number["number"]], len(model.velocities))


def shape(pattern: Pattern | None) -> tuple[int, int, tuple[tuple[int, int], ...]] | None:
    """The size and the entries of a pattern, however it is written."""
    return pattern and (pattern.rows, pattern.cols, tuple(pattern.entries))


def differences(of: Graph) -> Iterator[tuple[str, float]]:
    """The functions that add up terms, with the largest difference relative to the magnitudes of the terms."""
    for kernel in of.flat.kernels:
        if kernel.name not in ("setup", *SOLVED):
            a, b = (np.concatenate([*results(of, model, kernel.name).values()]) for model in (of.flat, of.instances))
            yield kernel.name, worst(a, b, terms(of, kernel.name)) if len(a) else 0.0


@pytest.mark.parametrize("seed", [*SMALL, *(pytest.param(n, marks=LATER) for n in (1, 6, 12, 14, 15, 30, 38, 39))])
def test_small_graphs(seed: int) -> None:
    check(small(seed))


@pytest.mark.parametrize("seed", [*WITH_PORTS, *(pytest.param(n, marks=LATER) for n in (0, 4, 9, 15))])
def test_graphs_with_parameters_inputs_springs_and_outputs(seed: int) -> None:
    """Derivatives with respect to parameters and inputs are among the functions."""
    of = graph(seed, FEW, ports=True)
    (jacobian,) = of.instances.kernel("parameter_jacobian").outputs
    assert jacobian.pattern and len(jacobian.pattern.entries) > 5
    check(of)


@pytest.mark.parametrize("seed", [VARYING[0], pytest.param(VARYING[1], marks=LATER)])
def test_graphs_with_joints_that_depend_on_both_of_their_bodies(seed: int) -> None:
    """Their axes move, or they remove functions of several relative motions; seed 53 has a drive of such a joint."""
    of = graph(seed, FEW, ports=True, varying=True)
    assert {"first_factor", "second_factor"} <= of.instances.kernel("solve").used
    check(of)


@pytest.mark.parametrize("seed", [TWINS[0], pytest.param(TWINS[1], marks=LATER)])
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


@pytest.mark.parametrize("driven", [True, pytest.param(False, marks=LATER)])
def test_a_chain_in_which_each_body_slides_along_the_one_before(driven: bool) -> None:
    """The joints are one group whose bodies differ in their numbers."""
    check(sliding_chain(6, driven))


@cache
def small(seed: int, varying: bool = False, pieces: bool = False) -> Graph:
    return graph(seed, FEW, varying=varying, pieces=pieces)


@pytest.mark.parametrize("seed", [*IN_PIECES[:1], *(pytest.param(seed, marks=LATER) for seed in IN_PIECES[1:])])
def test_graphs_with_beams_in_pieces(seed: int) -> None:
    """Pieces are bodies that welds connect; damping couples them, and loads act on each."""
    of = small(seed, False, True)
    assert any(body.pieces > 1 for body in of.scene.bodies if isinstance(body, BeamBody))
    check(of)


@LATER
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
