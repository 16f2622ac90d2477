"""Arguments of compiled functions: checks of their shapes, types and origin; and what return codes mean."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from derive.errors import TisserandError
from derive.ir.statements import ReturnCode

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


class SetupConstants(np.ndarray[tuple[int], np.dtype[np.float64]]):
    """The constants k (nk,) of `setup`: an array that knows by its attribute `build` the hash of its model."""

    def __array_finalize__(self, source: object) -> None:
        self.build: str = getattr(source, "build", "")


def constants_of(build: str, values: Vector) -> SetupConstants:
    """The values as the constants of the model with this hash."""
    constants = values.view(SetupConstants)
    constants.build = build
    return constants


PLAIN = (np.ndarray, SetupConstants)
"""The types of arrays without masks."""


def checked_origin(build: str, name: str, given: ArrayLike) -> ArrayLike:
    """`given`, unless it comes from the `setup` of another model than `name`, which has the hash `build`.

    An array that no `setup` returned is accepted. Raises ValueError.
    """
    if getattr(given, "build", build) not in ("", build):
        raise ValueError(f"{name}: the constants k come from the setup of another model; call setup of {name}")
    return given


class ModelError(TisserandError, ArithmeticError):
    """A function of a compiled model returned a code other than 0.

    Attributes:
        code: the return code, a value of `ReturnCode`.

    Examples:
        >>> import derive
        >>> beam = derive.planar_beam("beam")
        >>> native = derive.load(derive.model_files(derive.lower(derive.derive(beam)), beam))
        >>> try:
        ...     native.setup(m=-1)
        ... except derive.ModelError as error:
        ...     print(error.code, error)
        2 beam_setup returned 2: a value is not finite or not positive; refused: m = -1
    """

    def __init__(self, function: str, code: int, refused: Sequence[str] = ()) -> None:
        self.code = code
        meaning = ReturnCode(code).meaning if code in tuple(ReturnCode) else "unknown"
        reason = f"; refused: {', '.join(refused)}" if refused else ""
        super().__init__(f"{function} returned {code}: {meaning}{reason}")


def doubles(given: ArrayLike, name: str) -> NDArray[np.float64]:
    """`given` as an array of doubles.

    Raises ValueError, which names the function, for complex numbers and masked elements, which have no double.
    """
    if isinstance(given, np.ndarray) and type(given) in PLAIN and given.dtype == np.float64:
        return given
    array = np.asanyarray(given)
    if np.iscomplexobj(array):
        raise ValueError(f"{name}: real numbers are needed, not complex ones; their imaginary parts would be lost")
    if np.ma.is_masked(array):
        raise ValueError(f"{name}: an array has masked elements, which have no value; fill them first")
    return np.asarray(array, dtype=np.float64)


def checked_number(given: ArrayLike, name: str) -> float:
    """`given` as a number. Raises ValueError, which names the function, if it is complex, masked, or an array."""
    if isinstance(given, (float, int)):
        return float(given)
    number = doubles(given, name)
    if number.ndim:
        raise ValueError(f"{name}: a number is needed, not an array of shape {number.shape}")
    return float(number)


def checked_rows(columns: int, given: ArrayLike, name: str) -> Matrix:
    """`given` as a matrix (n, columns). Raises ValueError, which names the function, if it has another shape."""
    array = doubles(given, name)
    if array.ndim != 2 or array.shape[1] != columns:
        raise ValueError(f"{name}: rows of {columns} are needed, not an array of shape {array.shape}")
    return array


def checked_vector(size: int, given: ArrayLike, name: str) -> Vector:
    """`given` as a contiguous vector (size,). Raises ValueError, which names the function, if it has another shape."""
    array = doubles(given, name)
    array = array if array.flags.c_contiguous else np.ascontiguousarray(array)
    if array.shape != (size,):
        raise ValueError(f"{name}: a vector of {size} is needed, not an array of shape {array.shape}")
    return array
