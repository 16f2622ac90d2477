"""The arrays of a body of nodes, checked, brought to one form and to SI units."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array, diags_array, issparse

from derive.spec.files.geometric_stiffness import geometric_stiffness, without_modes
from derive.spec.files.matrices import NEARLY, Entries, misfit, of_nodes, square, symmetric
from derive.spec.files.mesh_arrays import mesh_of
from derive.spec.files.node_files import MAX_BYTES, NODES, PARTS, SPARSE, Array, FoundArrays
from derive.spec.files.node_format import FILES, Units, holds_indices
from derive.spec.model.node_data import NodeData
from derive.spec.parsing.faults import Faults
from derive.spec.parsing.values import WrongValueError

MAX_NODES = 1_000_000
LARGEST = 1e100

Result = TypeVar("Result")

_KINDS = {"c": "complex numbers", "b": "true and false", "O": "Python objects", "U": "text", "S": "text"}


@dataclass(frozen=True)
class CheckedNodes:
    """The data in SI units, None if they are faulty, and the numbers of nodes and modes, if they are known."""

    data: NodeData | None
    nodes: int | None
    modes: int | None
    faults: Faults


def node_data(read: FoundArrays, units: Units) -> CheckedNodes:
    """Check the arrays that were read, and convert them to SI units."""
    faults = Faults()
    arrays = {key: _checked(faults, key, array, _numbers, key) for key, array in read.arrays.items()}
    for key in SPARSE:
        _gather(key, arrays, faults)
    for key in ("positions", "mass"):
        if key not in arrays and read.complete:
            with faults.at(*NODES, key):
                raise WrongValueError(f"this is missing: {FILES[key][:1].lower()}{FILES[key][1:-1]}")
    positions = _checked(faults, "positions", arrays.get("positions"), _positions)
    mass = stiffness = modes = modal = None
    if positions is not None:
        n = len(positions)
        mass = _checked(faults, "mass", arrays.get("mass"), _mass, n)
        stiffness = _checked(faults, "stiffness", arrays.get("stiffness"), _stiffness, n)
        modes = _checked(faults, "modes", arrays.get("modes"), _modes, n)
    geometric: dict[str, Any] = {}
    if "modes" not in arrays:
        _checked(faults, "modal_stiffness", arrays.get("modal_stiffness"), _no_modes)
        without_modes(arrays, faults)
    elif modes is not None:
        modal = _checked(faults, "modal_stiffness", arrays.get("modal_stiffness"), _modal_stiffness, len(modes))
        geometric = geometric_stiffness(arrays, len(modes[0]), len(modes), units, faults)
    mesh = None if positions is None else mesh_of(arrays, len(positions), units, faults)
    data = None
    if not faults and positions is not None and mass is not None:
        data = NodeData(
            positions=_scaled(positions, units.length),
            mass=_scaled(mass, units.mass),
            stiffness=None if stiffness is None else _scaled(stiffness, units.stiffness),
            modes=modes,
            modal_stiffness=None if modal is None else _scaled(modal, units.stiffness),
            sha256=read.sha256,
            mesh=mesh,
            **geometric,
        )
    return CheckedNodes(
        data, None if positions is None else len(positions), None if modes is None else len(modes), faults
    )


def _checked(
    faults: Faults, key: str, array: Array | None, check: Callable[..., Result], *arguments: object
) -> Result | None:
    """The result of a check of an array; None if there is no array, or if it is faulty."""
    if array is not None:
        with faults.at(*NODES, key):
            return check(array, *arguments)
    return None


def _numbers(array: Array, key: str) -> Array:
    """Return an array of finite real numbers, or of the indices of rows, columns and nodes, after checks."""
    kind = array.dtype.kind
    if kind not in "iuf":
        raise WrongValueError(f"this holds {_KINDS.get(kind, 'no numbers')}; real numbers are needed")
    if holds_indices(key):
        if kind == "f":
            raise WrongValueError("these are decimals; whole numbers are needed, from 0: save them as integers")
        return array.astype(np.int64)
    with np.errstate(over="ignore"):
        numbers = array.astype(np.float64)
    if issparse(array):
        numbers = coo_array(numbers)
    bad = ~(np.abs(numbers.data if issparse(array) else numbers) <= LARGEST)
    if bad.any():
        first = np.unravel_index(bad.argmax(), bad.shape)
        index = [int(c[first]) for c in numbers.coords] if issparse(array) else [int(i) for i in first]
        raise WrongValueError(
            f"numbers that are NaN, infinite or beyond {LARGEST:g}: {bad.sum()} of {bad.size}, the first at {index}"
        )
    return numbers


def _gather(key: str, arrays: dict[str, Array | None], faults: Faults) -> None:
    """Assemble a matrix that is given as rows, columns and values of its entries, if it is."""
    names = [f"{key}_{part}" for part in PARTS]
    given = [name for name in names if name in arrays]
    if not given:
        return
    if key in arrays:
        with faults.at(*NODES, key):
            raise WrongValueError(f"this is there twice, as an array and as {', '.join(given)}; keep one of them")
    arrays.setdefault(key, None)
    for name in names:
        if name not in arrays:
            with faults.at(*NODES, name):
                raise WrongValueError(f"this is missing; a sparse matrix is {', '.join(names)}")
    row, col, value = [arrays.get(name) for name in names]
    if row is None or col is None or value is None:
        return
    with faults.at(*NODES, names[0]):
        if row.ndim != 1 or not row.shape == col.shape == value.shape:
            shapes = ", ".join(str(part.shape) for part in (row, col, value))
            raise WrongValueError(f"{', '.join(names)} have the shapes {shapes}; one shape (entries,) is needed")
        arrays[key] = Entries(row, col, value)


def _positions(array: Array) -> NDArray[np.float64]:
    if array.ndim != 2 or array.shape[1] != 3 or not array.shape[0]:
        turned = "; transpose it" if array.ndim == 2 and array.shape[0] == 3 else ""
        raise WrongValueError(f"the shape is {array.shape}, and (nodes, 3) is needed{turned}")
    if array.shape[0] > MAX_NODES:
        raise WrongValueError(f"there are {array.shape[0]} nodes, and at most {MAX_NODES} are allowed")
    return _dense(array)


def _dense(array: Array) -> NDArray[np.float64]:
    if not issparse(array):
        return np.ascontiguousarray(array)
    if int(array.shape[0]) * int(array.shape[1]) > MAX_BYTES // 8:
        raise WrongValueError(f"the shape is {array.shape}, which is too large for a full array")
    return np.ascontiguousarray(array.toarray())


def _mass(array: Array, n: int) -> csr_array:
    """The matrix m of M = m (x) I3."""
    if not isinstance(array, Entries) and sum(size != 1 for size in array.shape) <= 1:
        vector = _vector(array, n)
        m = csr_array(diags_array(vector))
    else:
        fits = f"({n},), ({3 * n},), ({n}, {n})", f"({3 * n}, {3 * n})"
        m = square(array, (n, 3 * n), n, *fits)
        m = symmetric(m if m.shape[0] == n else of_nodes(m))
    diagonal = m.diagonal()
    negative = diagonal < 0
    if negative.any():
        node = int(negative.argmax())
        raise WrongValueError(
            f"{negative.sum()} of {n} nodes have a negative mass, the first of them node {node} with {diagonal[node]:g}"
        )
    total = float(m.sum())
    if total <= 0:
        raise WrongValueError(f"the masses add up to {total:g}; a body needs a positive mass")
    return m


def _vector(array: Array, n: int) -> NDArray[np.float64]:
    """The mass matrix from one mass per node, or from three equal ones."""
    size = int(np.prod(array.shape, dtype=object))
    if size not in (n, 3 * n):
        raise misfit(array.shape, n, f"({n},)", f"({3 * n},)", f"({n}, {n})", f"({3 * n}, {3 * n})")
    vector = _dense(array).reshape(-1)
    if size == n:
        return vector
    triples = vector.reshape(n, 3)
    uneven = np.ptp(triples, axis=1) > NEARLY * np.abs(vector).max()
    if uneven.any():
        node = int(uneven.argmax())
        masses = ", ".join(f"{mass:g}" for mass in triples[node])
        raise WrongValueError(
            f"node {node} has the masses {masses} in x, y and z; a node has one mass, the same in all directions"
        )
    return triples[:, 0]


def _stiffness(array: Array, n: int) -> csr_array:
    return symmetric(square(array, (3 * n,), n, f"({3 * n}, {3 * n})"))


def _modes(array: Array, n: int) -> NDArray[np.float64]:
    """The modes (N, nodes, 3), from an array of that shape or from columns."""
    if array.ndim == 3 and array.shape[1:] == (n, 3) and array.shape[0]:
        return _dense(array)
    if array.ndim == 2 and array.shape[0] == 3 * n and array.shape[1]:
        return np.ascontiguousarray(_dense(array).T).reshape(-1, n, 3)
    turned = "; transpose it" if array.ndim == 2 and array.shape[1] == 3 * n else ""
    error = misfit(array.shape, n, f"(modes, {n}, 3)", f"({3 * n}, modes)")
    raise WrongValueError(f"{error}{turned}")


def _no_modes(_: Array) -> None:
    raise WrongValueError("there are no modes that this could belong to; add them as `modes`")


def _modal_stiffness(array: Array, count: int) -> NDArray[np.float64]:
    if array.shape in ((count,), (count, 1), (1, count)):
        return np.diag(_dense(array).reshape(-1))
    if array.shape != (count, count):
        raise WrongValueError(
            f"the shape is {array.shape}, and there are {count} modes: ({count}, {count}) or ({count},) is needed"
        )
    return np.ascontiguousarray(symmetric(csr_array(array)).toarray())


def _scaled(array: Any, unit: Fraction) -> Any:
    """Numbers converted to SI units; a division is rounded once, where a product with 0.001 would be rounded twice."""
    return array if unit == 1 else array * float(unit.numerator) / float(unit.denominator)
