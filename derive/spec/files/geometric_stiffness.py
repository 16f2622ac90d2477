"""The geometric stiffness matrices of a body of nodes, checked and brought to one form and to SI units."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import issparse

from derive.spec.files.node_files import NODES, Array
from derive.spec.files.node_format import Units
from derive.spec.parsing.faults import Faults
from derive.spec.parsing.values import WrongValueError

LOADS = {"K0t": 3, "K0r": 3, "K0omega": 6}
"""The number of loads of each array."""

SYMMETRIC = 1e-6
"""The largest asymmetry of a matrix, relative to the largest entry of its array."""


def geometric_stiffness(
    arrays: Mapping[str, Array | None], nodes: int, modes: int, units: Units, faults: Faults
) -> dict[str, Any]:
    """The arrays K0t, K0r, K0omega (loads, modes, modes), K0F (K, 3, modes, modes) and K0F_nodes that are there."""
    result: dict[str, Any] = {}
    if arrays.get("K0F_nodes") is not None:
        with faults.at(*NODES, "K0F_nodes"):
            result["K0F_nodes"] = _node_numbers(arrays["K0F_nodes"], nodes)
    forces = result.get("K0F_nodes")
    shapes: dict[str, tuple[int, ...]] = {name: (loads, modes, modes) for name, loads in LOADS.items()}
    if forces is not None:
        shapes["K0F"] = (len(forces), 3, modes, modes)
    for name, shape in shapes.items():
        if arrays.get(name) is not None:
            with faults.at(*NODES, name):
                unit = units.geometric_stiffness[name]
                result[name] = _matrices(arrays[name], shape) * float(unit.numerator) / float(unit.denominator)
    for name, other in (("K0F", "K0F_nodes"), ("K0F_nodes", "K0F")):
        if name in arrays and other not in arrays:
            with faults.at(*NODES, name):
                raise WrongValueError(f"{other} is missing; forces at nodes need both K0F and K0F_nodes")
    return result


def without_modes(arrays: Mapping[str, Array | None], faults: Faults) -> None:
    """Add faults of arrays that need modes where there are none."""
    for name in (*LOADS, "K0F"):
        if name in arrays:
            with faults.at(*NODES, name):
                raise WrongValueError("there are no modes that this could belong to; add them as `modes`")


def _dense(array: Array) -> NDArray[Any]:
    return np.asarray(array.toarray() if issparse(array) else array)


def _node_numbers(array: Array, nodes: int) -> NDArray[np.int64]:
    """The numbers of nodes, without repetitions."""
    numbers = _dense(array).reshape(-1).astype(np.int64)
    if np.any(numbers < 0) or np.any(numbers >= nodes):
        wrong = int(numbers[(numbers < 0) | (numbers >= nodes)][0])
        raise WrongValueError(f"there is no node {wrong}: the nodes are 0 to {nodes - 1}")
    if len(np.unique(numbers)) < len(numbers):
        raise WrongValueError("a node is there twice; keep one")
    return numbers


def _matrices(array: Array, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """The matrices in an array, made symmetric in the modes; in an array with two indices they are stacked by rows."""
    stacked = (int(np.prod(shape[:-1])), shape[-1])
    if array.shape not in (shape, stacked):
        raise WrongValueError(f"the shape is {array.shape}, and {shape} or {stacked} is needed, of {shape[-1]} modes")
    result = np.ascontiguousarray(_dense(array), dtype=np.float64).reshape(shape)
    other = np.swapaxes(result, -1, -2)
    difference = np.abs(result - other).max(initial=0.0)
    largest = np.abs(result).max(initial=0.0)
    if difference > SYMMETRIC * largest:
        share = difference / largest
        raise WrongValueError(f"the matrices are not symmetric in the modes: {share:.1e} of the largest entry")
    return (result + other) / 2
