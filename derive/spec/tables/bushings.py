"""The stiffness or damping of a bushing: six numbers, or a symmetric, positive semidefinite matrix of six rows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Annotated, Any

from pydantic import AfterValidator

from derive.mechanics.multibody.space.springs import bushing_unit
from derive.spec.model.quantity import Parameter, Quantity
from derive.spec.parsing.values import WrongValueError
from derive.spec.tables.quantities import SignedQuantity, quantity
from derive.spec.tables.shared import components, one_of

MOTIONS = ("x", "y", "z", "rx", "ry", "rz")
ROUNDING = 1e-9
"""The part of the entries by which a matrix may fail to be positive semidefinite, since entries are rounded."""


def bushing_with_units(values: Mapping[str, Any]) -> dict[str, Any]:
    """The values of the keys of a bushing, whose parameters without a unit have that of their entry."""

    def entry(key: str, of: Quantity, i: int, j: int) -> Quantity:
        return replace(of, unit=bushing_unit(key, i, j)) if isinstance(of, Parameter) and not of.unit else of

    def row(key: str, of: Any, i: int) -> Any:
        return tuple(entry(key, x, i, j) for j, x in enumerate(of)) if isinstance(of, tuple) else entry(key, of, i, i)

    return {key: tuple(row(key, of, i) for i, of in enumerate(rows)) for key, rows in values.items()}


def _six(values: Sequence[Any]) -> tuple[Quantity, ...]:
    numbers = tuple(quantity(value, "") for value in values)
    for motion, number in zip(MOTIONS, numbers, strict=True):
        if not isinstance(number, Parameter) and number < 0:
            raise WrongValueError(f"that of {motion} is {float(number):g}; zero or a positive number is needed")
    return numbers


def _matrix(rows: Sequence[Sequence[Any]]) -> tuple[tuple[Quantity, ...], ...]:
    """A matrix with its checks, if its entries are numbers; parameters have to be symmetric alone."""
    matrix = tuple(tuple(quantity(value, "") for value in row) for row in rows)
    for i, row in enumerate(matrix):
        for j in range(i):
            if row[j] != matrix[j][i]:
                text = (
                    f"the entries of {MOTIONS[j]}, {MOTIONS[i]} and of {MOTIONS[i]}, {MOTIONS[j]} are "
                    f"{_shown(matrix[j][i])} and {_shown(row[j])}; a symmetric matrix is needed, as the bushing would "
                    "supply energy otherwise"
                )
                raise WrongValueError(text)
    if not any(isinstance(entry, Parameter) for row in matrix for entry in row):
        _check_definite([[float(entry) for entry in row] for row in matrix])
    return matrix


def _check_definite(matrix: list[list[float]]) -> None:
    """Raise WrongValueError with a motion whose energy or dissipation is negative."""
    import numpy as np  # not for specifications that have no such matrices

    K = np.array(matrix)
    scales = np.sqrt(np.abs(np.diag(K)))
    scales[scales == 0.0] = 1.0
    values, vectors = np.linalg.eigh(K / np.outer(scales, scales))
    if values[0] < -ROUNDING * max(1.0, float(np.abs(values).max())):
        motion = vectors[:, 0] / scales
        motion /= motion[np.argmax(np.abs(motion))]
        shown = ", ".join(f"{name} {x:.3g}" for name, x in zip(MOTIONS, motion, strict=True) if abs(x) > 1e-6)
        raise WrongValueError(
            f"this matrix is not positive semidefinite: the motion {shown} would supply energy; correct an entry"
        )


def _shown(value: Quantity) -> str:
    return value.symbol if isinstance(value, Parameter) else f"{float(value):g}"


def _notation(value: Any) -> str:
    several = isinstance(value, (list, tuple)) and any(isinstance(row, (list, tuple)) for row in value)
    return "matrix" if several else "six"


_quantities: Any = (SignedQuantity,) * 6
_row: Any = Annotated[tuple[_quantities], components(("1000", "0", "0", "0", "0", "0"), "numbers")]
_rows: Any = (_row,) * 6
BushingMatrix: Any = one_of(
    _notation,
    six=Annotated[
        tuple[_quantities], components(("1000", "1000", "1000", "10", "10", "10"), "numbers"), AfterValidator(_six)
    ],
    matrix=Annotated[tuple[_rows], components(("[1000, 0, ..]", *["[..]"] * 5), "rows"), AfterValidator(_matrix)],
)
"""The pydantic type of six quantities, or of a symmetric matrix of them."""
