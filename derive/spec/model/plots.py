"""The plots that a simulation draws: columns of the motion, or the deflection of a beam, and reference curves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from derive.short_text import record_text
from derive.spec.model.documentation import documented
from derive.spec.model.keys import KeyType, key
from derive.spec.model.markers import MarkerRef


@documented
@dataclass(frozen=True)
class Deflection:
    """A plot of the distance of a marker from the chord between two others.

    Examples:
        >>> import derive
        >>> ends = derive.MarkerRef("rod", "left"), derive.MarkerRef("rod", "right")
        >>> derive.Deflection(derive.MarkerRef("rod", "middle"), ends).divided_by is None
        True
    """

    marker: Annotated[
        MarkerRef,
        key(
            KeyType.MARKER,
            "Marker whose distance from the chord is plotted, in the plane positive to the left.",
            name="deflection",
            example='"rod.middle"',
        ),
    ]
    chord: Annotated[
        tuple[MarkerRef, MarkerRef],
        key(
            KeyType.MARKER_PAIR,
            'Markers at the beginning and the end of the chord, such as ["rod.left", "rod.right"]; in the plane the '
            "deflection is positive to its left.",
            example='["rod.left", "rod.right"]',
        ),
    ]
    divided_by: Annotated[
        float | None,
        key(
            KeyType.POSITIVE_FLOAT,
            "Length by which the deflection is divided, m; by default it is a length.",
            "m",
        ),
    ] = None
    __repr__ = record_text


@dataclass(frozen=True)
class ColumnCurves:
    """A plot of columns of the trajectory over another one."""

    y: Annotated[
        tuple[str, ...],
        key(KeyType.COLUMNS, 'Columns of the CSV file, one or a list, such as "rod_phi".', example='"rod_phi"'),
    ]
    x: Annotated[str, key(KeyType.TEXT, "Column of the horizontal axis; by default the time.")] = "t"


@documented
@dataclass(frozen=True)
class ReferenceCurve:
    """A reference curve of a plot: two columns of a CSV file.

    Attributes:
        rows: the values of both columns, as they are read.

    Examples:
        >>> import derive
        >>> derive.ReferenceCurve("measured.csv", x="t", y="deflection").rows
        ()
    """

    file: Annotated[str, key(KeyType.TEXT, "CSV file, relative to the specification.", example='"curve.csv"')]
    x: Annotated[str, key(KeyType.TEXT, "Name of the column of the horizontal axis.", example='"the name of a column"')]
    y: Annotated[str, key(KeyType.TEXT, "Name of the column of the vertical axis.", example='"the name of a column"')]
    rows: tuple[tuple[float, float], ...] = ()
    __repr__ = record_text


@documented
@dataclass(frozen=True)
class Plot:
    """A plot that `simulate` draws: a deflection or columns over the time or over the motion of a drive.

    Attributes:
        name: the name of the plot.
        quantity: a Deflection, or the columns.

    Examples:
        >>> import derive
        >>> ends = derive.MarkerRef("rod", "left"), derive.MarkerRef("rod", "right")
        >>> plot = derive.Plot("bending", derive.Deflection(derive.MarkerRef("rod", "middle"), ends))
        >>> rod = {"length": 1, "frame": "mean", "markers": {"left": -1, "middle": 0, "right": 1}}
        >>> derive.scene("bar", bodies={"rod": rod}, plots=[plot]).plots[0].name
        'bending'
    """

    name: str
    quantity: Deflection | ColumnCurves
    over: Annotated[
        str | None, key(KeyType.DRIVE, "Drive whose motion is the horizontal axis; by default the time.")
    ] = None
    cut: Annotated[str | None, key(KeyType.BEAM, "Beam that is divided into other numbers of pieces.")] = None
    pieces: Annotated[
        tuple[int, ...], key(KeyType.PIECE_COUNTS, "Numbers of pieces, one curve for each.", optional=True)
    ] = ()
    reference: Annotated[ReferenceCurve | None, key(ReferenceCurve, "Reference curve.")] = None
    __repr__ = record_text
