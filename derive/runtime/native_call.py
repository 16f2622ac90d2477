"""Calls of compiled functions with NumPy arrays: checks of shapes, pointers, return codes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from derive.errors import TisserandError
from derive.ir.statements import ReturnCode
from derive.runtime.descriptor import Doubles

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


class ModelError(TisserandError, ArithmeticError):
    """A function of a compiled model returned a code other than 0; `code` is that of `ReturnCode`.

    refused: the arguments that are the reason, with their values, if they are known.
    """

    def __init__(self, function: str, code: int, refused: Sequence[str] = ()) -> None:
        self.code = code
        meaning = ReturnCode(code).meaning if code in tuple(ReturnCode) else "unknown"
        reason = f"; refused: {', '.join(refused)}" if refused else ""
        super().__init__(f"{function} returned {code}: {meaning}{reason}")


def invoke(name: str, function: Callable[..., int], arguments: list[Any], results: list[Vector]) -> None:
    """Call a compiled function, which writes into `results`.

    arguments: numbers, and pairs of a length and a vector that must have it. Raises ModelError if the function returns
    a code other than 0, ValueError on a wrong length; `name` is that of the function in both.
    """
    given = [checked_vector(a[0], a[1], name) if isinstance(a, tuple) else float(a) for a in arguments]
    pointers = [a.ctypes.data_as(Doubles) if isinstance(a, np.ndarray) else a for a in [*given, *results]]
    if code := function(*pointers):
        raise ModelError(name, code)


def checked_rows(columns: int, given: ArrayLike, name: str) -> Matrix:
    """`given` as a matrix (n, columns). Raises ValueError, which names the function, if it has another shape."""
    array = np.asarray(given, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != columns:
        raise ValueError(f"{name}: rows of {columns} are needed, not an array of shape {array.shape}")
    return array


def checked_vector(size: int, given: ArrayLike, name: str) -> Vector:
    """`given` as a contiguous vector (size,). Raises ValueError, which names the function, if it has another shape."""
    array = np.ascontiguousarray(given, dtype=np.float64)
    if array.shape != (size,):
        raise ValueError(f"{name}: a vector of {size} is needed, not an array of shape {array.shape}")
    return array
