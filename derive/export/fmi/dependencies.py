"""On which states and inputs the outputs of a unit and the derivatives of its states depend."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import accumulate

from derive.export.host_model import HostModel
from derive.ir.patterns import Pattern


def dependencies(model: HostModel) -> dict[int, tuple[int, ...]]:
    """The value references on which variables depend, in order, by the value reference of the variable.

    A derivative of a state or an output that is missing depends on the accelerations or multipliers, and so on all
    states, all inputs and the time. Dependencies are those of the sparsity, so that some may have no effect.
    """
    nq, nx, nu, nout = len(model.coordinates), len(model.states), len(model.inputs), len(model.outputs)
    nv, ends = nx - nq, [*accumulate((1, nu, len(model.parameters), nx, nx), initial=0)]
    _, first_input, _, first_state, first_derivative, first_output = ends
    jacobian = model.model.pattern("jacobian_index1" if model.model.bodies else "jacobian", "jac")
    result = {
        first_derivative + row: tuple(first_state + j for j in columns)
        for row, columns in _by_row(jacobian, range(nq)).items()
    }
    if nout:
        timed = (0,) if "t" in model.model.kernel("outputs").used else ()
        behind = nx + nv + len(model.multipliers)
        for row, columns in _by_row(model.model.pattern("outputs_jacobian", "jac"), range(nout)).items():
            if not any(nx <= j < behind for j in columns):
                inputs = (first_input + j - behind for j in columns if j >= behind)
                result[first_output + row] = (*timed, *inputs, *(first_state + j for j in columns if j < nx))
    return result


def _by_row(pattern: Pattern, rows: Iterable[int]) -> dict[int, list[int]]:
    """The columns of the entries of each row."""
    result: dict[int, list[int]] = {row: [] for row in rows}
    for column, (begin, end) in enumerate(zip(pattern.colptr[:-1], pattern.colptr[1:], strict=True)):
        for row in pattern.rowidx[begin:end]:
            if row in result:
                result[row].append(column)
    return result
