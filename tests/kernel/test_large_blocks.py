"""The elimination of large blocks along a path: in loops over the rows of the next joint."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from numpy.typing import NDArray

from derive.ir.expressions import Element, Number, Operation, walk
from derive.ir.indices import constant
from derive.ir.interpreter import RequirementError, interpret
from derive.ir.kernel import Kernel, Section
from derive.ir.statements import ForEach, InstanceStatement, Let, Require, StoreElement, Work, inside
from derive.ir.written_out_rows import with_rows_written_out
from derive.lowering.instances.elimination.block_system import (
    COUPLING,
    DIAGONAL,
    FORCE,
    RIGHT,
    Blocks,
    blocks,
    packed,
)
from derive.lowering.instances.elimination.path_elimination import along_path
from kernel.test_instance_lanes import looped


def path(joints: int, size: int) -> Blocks:
    """A path of welded bodies, none of which is on the ground."""
    handles = [[(k, False)] * (k < joints) + [(k - 1, True)] * (k > 0) for k in range(joints + 1)]
    return blocks([size] * joints, handles)


def system(of: Blocks, seed: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """A positive definite matrix with such blocks, and a right-hand side."""
    rng, size = np.random.default_rng(seed), of.size
    rows = rng.uniform(-1, 1, (of.joints * size, of.joints * size + size))
    for k in range(of.joints):
        rows[k * size : (k + 1) * size, : k * size] = rows[k * size : (k + 1) * size, (k + 2) * size :] = 0.0
    return rows @ rows.T + np.eye(len(rows)), rng.uniform(-1, 1, len(rows))


def kernel(of: Blocks, matrix: NDArray[np.float64], right: NDArray[np.float64]) -> Kernel:
    """A function that stores the solution, with all numbers in its text; the second body of a joint has one third."""
    size, body = of.size, list[InstanceStatement]()
    components = dict.fromkeys(DIAGONAL, of.packed) | dict.fromkeys((*RIGHT, FORCE), size)
    for array, count in components.items():
        body.append(Work(array, count * of.spacing))
    body += [Work(COUPLING, size**2 * of.coupling_spacing)]

    def stored(array: str, index: int, value: float) -> None:
        body.append(StoreElement(Element(array, constant(index)), Number(Fraction(value))))

    for k in range(of.joints):
        for i in range(size):
            for array, part in zip(DIAGONAL, (0.75, 0.25), strict=True):
                for j in range(i, size):
                    stored(array, packed(size, i, j) * of.spacing + k, part * matrix[k * size + i, k * size + j])
            for array, part in zip(RIGHT, (0.75, 0.25), strict=True):
                stored(array, i * of.spacing + k, part * right[k * size + i])
            for j in range(size if k + 1 < of.joints else 0):
                stored(COUPLING, (size * i + j) * of.coupling_spacing + k, matrix[k * size + i, (k + 1) * size + j])
    body += along_path(of, False)
    places = [(k * size + i, i * of.spacing + k) for k in range(of.joints) for i in range(size)]
    body += [StoreElement(Element("vdot", constant(a)), Element(FORCE, constant(b))) for a, b in places]
    whole = looped("chain_2").kernel("accel")
    outputs = tuple(replace(o, count=len(right)) for o in whole.outputs)
    return replace(
        whole, sections=(Section("joints", "", "a path", tuple(body)),), outputs=outputs, arguments=(), constants=()
    )


def written_out(of: Kernel) -> Kernel:
    (made,) = with_rows_written_out(replace(looped("chain_2"), kernels=(of,))).kernels
    return made


def solution(of: Kernel) -> NDArray[np.float64]:
    return np.array(interpret(of, {})["vdot"])


def in_text(statements: Sequence[object]) -> int:
    """The operations in the text of loops, each of which is counted once."""
    items = [item for loop in statements if isinstance(loop, ForEach) for item in inside(loop)]
    exprs = [item.expr for item in items if isinstance(item, Let | StoreElement | Require)]
    return sum(isinstance(part, Operation) for expr in exprs for part in walk(expr))


@pytest.mark.parametrize("size", [4, 5, 6])
@pytest.mark.parametrize("joints", [1, 2, 3, 4, 5, 8])
def test_loops_over_rows_solve_the_system(joints: int, size: int) -> None:
    """Written out, as batches have them, they are the same operations."""
    of = path(joints, size)
    assert of.is_path and of.size == size
    matrix, right = system(of, joints)
    made = kernel(of, matrix, right)
    expected = np.linalg.solve(matrix, right)
    assert np.abs(solution(made) - expected).max() < 1e-13 * np.linalg.cond(matrix) * np.abs(expected).max()
    assert np.array_equal(solution(written_out(made)), solution(made))


@pytest.mark.parametrize("place", range(4 * 6))
def test_each_pivot_is_checked(place: int) -> None:
    """A row of zeros has no pivot, whichever joint and loop it belongs to."""
    of = path(4, 6)
    matrix, right = system(of, 1)
    matrix[place] = matrix[:, place] = 0.0
    with pytest.raises(RequirementError):
        solution(kernel(of, matrix, right))


def test_steps_have_less_text_than_straight_lines() -> None:
    """Columns have one text, which the back substitution and the joint in the middle do not have."""
    of = path(8, 6)
    made = kernel(of, *system(of, 1))
    loops, lines = in_text(made.statements), in_text(written_out(made).statements)
    assert 3 * loops < 2 * lines
    assert loops == in_text(kernel(path(20, 6), *system(path(20, 6), 1)).statements)
