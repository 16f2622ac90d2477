"""Loops over bodies and joints on random graphs against dense systems that are solved with 50 digits."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from both_lowerings import System, results
from random_graphs import Graph
from test_instance_graphs import small

from derive.ir.interpreter import interpret

EXACT = (4, 9)


@pytest.mark.parametrize("seed", EXACT)
def test_both_solve_the_dense_system(seed: int) -> None:
    of = small(seed)
    system, (vdot, lam) = System(of), dense_solution(of)
    bound = system.bound(system.forces(lam))
    for model in (of.flat, of.instances):
        assert system.norm(results(of, model, "solve")["vdot"] - vdot) <= bound


def dense_solution(of: Graph) -> tuple[np.ndarray, np.ndarray]:
    """vdot and lambda in 50 digits, from the whole matrix of M and G."""
    n, rows = len(of.flat.coordinates), len(of.flat.multipliers)
    with mpmath.workdps(50):
        matrix = mpmath.zeros(n + rows)
        for (i, j), value in entries(of, "mass"):
            matrix[i, j] = matrix[j, i] = value
        for (i, j), value in entries(of, "constraint_jacobian"):
            matrix[n + i, j], matrix[j, n + i] = value, -value
        (h,), (gamma,) = exactly(of, "force").values(), exactly(of, "constraint_bias").values()
        solution = [float(x) for x in mpmath.lu_solve(matrix, mpmath.matrix([*(-x for x in h), *gamma]))]
    return np.array(solution[:n]), np.array(solution[n:])


def entries(of: Graph, name: str) -> Iterator[tuple[tuple[int, int], Any]]:
    (output,) = of.flat.kernel(name).outputs
    assert output.pattern
    return zip(output.pattern.entries, exactly(of, name)[output.name], strict=True)


def exactly(of: Graph, name: str) -> dict[str, list[Any]]:
    def number(value: Fraction) -> Any:
        return mpmath.mpf(value.numerator) / value.denominator

    given = {
        a: [mpmath.mpf(x) for x in value] if isinstance(value, list) else mpmath.mpf(value)
        for a, value in of.arguments(name).items()
    }
    functions = {f: getattr(mpmath, f) for f in ("sin", "cos", "sqrt")}
    return interpret(of.flat.kernel(name), given, number=number, functions=functions)
