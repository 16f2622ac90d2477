"""The plots that a simulation draws: columns of the motion, or the deflection of a beam, and reference curves."""

from __future__ import annotations

from dataclasses import dataclass

from derive.spec.model.markers import MarkerRef


@dataclass(frozen=True)
class Deflection:
    """The distance of `marker` from the `chord` between two markers, to its left, or its ratio to `divided_by` (m)."""

    marker: MarkerRef
    chord: tuple[MarkerRef, MarkerRef]
    divided_by: float | None = None


@dataclass(frozen=True)
class ColumnCurves:
    """Columns `y` of a trajectory over its column `x`, by their names."""

    y: tuple[str, ...]
    x: str = "t"


@dataclass(frozen=True)
class ReferenceCurve:
    """Columns `x` and `y` of a CSV file to compare with; `rows` are its numbers."""

    file: str
    x: str
    y: str
    rows: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Plot:
    """A plot that `simulate` draws: a deflection over the time or over the motion of the drive `over`, or columns.

    `pieces` repeats it with the beam body `cut` cut into so many pieces each.
    """

    name: str
    quantity: Deflection | ColumnCurves
    over: str | None = None
    cut: str | None = None
    pieces: tuple[int, ...] = ()
    reference: ReferenceCurve | None = None
