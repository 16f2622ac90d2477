"""The results of a scene in loops over instances beside those of straight-line code.

Sums are compared relative to the magnitudes of their terms. Solutions are measured by what they leave of M vdot + h -
G^T lambda and of G vdot - gamma, relative to the terms of these, and by their distance from each other and from a
solution in 50 digits, in the norm of M: the constrained motion is the free motion minus that due to the reactions, so
that the condition of G M^-1 G^T multiplies errors of these two.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from itertools import accumulate, pairwise
from typing import Any

import numpy as np
from random_graphs import Graph, dense, random_state, relative_eigenvalues

import derive
from corpus.summed_terms import summed_terms, worst
from derive.ir.interpreter import interpret
from derive.ir.kernel import Kernel
from derive.ir.model import Model
from derive.ir.patterns import Pattern
from derive.lowering.flat.lower import lower as lower_flat
from derive.lowering.instances.lower import lower_instances

TOLERANCE = 1e-13
OF_CONDITION = 1e-15
"""Errors of solutions, relative to their terms, for a system of condition 1: a few units in the last place."""
SINGULAR = 1e-12
"""Eigenvalues of redundant constraints, which are less than those of others by WELL_POSED."""
OF_LEAST_NORM = 1e-5
"""Errors of reactions that are not unique, relative to the largest one; see `derive.lowering.proximal`."""
SOLVED = ("accel", "solve", "project_velocity", "solve_kkt")


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


@cache
def both(scene: derive.SpatialScene, explicit: bool, proximal: bool = False) -> Graph:
    """A scene lowered both ways, and a random state in which no constraint is met."""
    mechanism = derive.derive(scene)
    flat = lower_flat(mechanism.expanded(), explicit=explicit, proximal=proximal)
    loops = lower_instances(mechanism, explicit=explicit, proximal=proximal)
    return Graph(scene, "", flat, loops, random_state(flat, scene, np.random.default_rng(1)))


def check(of: Graph) -> None:
    """Every function of the one model gives what it gives in the other one."""
    check_interface(of)
    for kernel in of.flat.kernels:
        if kernel.name not in ("setup", *SOLVED):
            error = difference(of, kernel)
            assert error <= TOLERANCE, f"{kernel.name}: {error:.2g} of the summed terms"
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


def check_interface(of: Graph) -> None:
    """The functions, their arguments, the names of variables and, in the plane, the patterns of matrices are the same.

    The constants are their own, and in space loops may have other structural zeros.
    """
    for table in ("coordinates", "velocities", "multipliers", "outputs", "equations"):
        flat, loops = getattr(of.flat, table), getattr(of.instances, table)
        assert [(v.name, v.unit, v.doc) for v in flat] == [(v.name, v.unit, v.doc) for v in loops]
    functions = [of_marker(of.instances, kernel.name)[0] for kernel in of.flat.kernels]
    assert [*dict.fromkeys(k.name for k in functions)] == [k.name for k in of.instances.kernels]
    for flat, loops in zip(of.flat.kernels, functions, strict=True):
        numbers = [(a.name, a.name != "k" and a.size) for a in loops.arguments if not a.integer]
        assert [(a.name, a.name != "k" and a.size) for a in flat.arguments] == numbers
        if of.flat.in_space or flat.name == "setup":
            continue
        for a, b in zip(flat.outputs, loops.outputs, strict=True):
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


def difference(of: Graph, kernel: Kernel) -> float:
    """The largest difference of the results of a function relative to their terms; patterns may have other zeros."""
    values = [_by_place(of, kernel, loops) for loops in (False, True)]
    sizes, summed = [0, *accumulate(output.size for output in kernel.outputs)], terms(of, kernel.name)
    largest = 0.0
    for output, (first, stop) in zip(kernel.outputs, pairwise(sizes), strict=True):
        a, b = (v[output.name] for v in values)
        scale = dict(zip(a, summed[first:stop], strict=True))
        places = [*a, *(place for place in b if place not in a)]
        numbers = ([v.get(place, 0.0) for place in places] for v in (a, b, scale))
        largest = max(largest, worst(*map(np.array, numbers)) if places else 0.0)
    return largest


def _by_place(of: Graph, kernel: Kernel, loops: bool) -> dict[str, dict[Any, float]]:
    """The results of a function by their places: indices, or rows and columns."""
    model = of.instances if loops else of.flat
    own, number = of_marker(model, kernel.name)
    every, result = results(of, model, kernel.name), {}
    for output in own.outputs:
        of_output = among(model, kernel.name) if number and output.pattern else output.pattern
        values = every[output.name]
        places = of_output.entries if of_output else range(len(values))
        result[output.name] = dict(zip(places, values, strict=True))
    return result
