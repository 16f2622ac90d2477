"""The tables of the settings of a simulation and of its plots."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import (
    BeforeValidator,
    Discriminator,
    Field,
    PlainValidator,
    Tag,
    WithJsonSchema,
    model_validator,
)

from derive.mechanics.multibody.outputs.deflection import CHORD, DIVIDED_BY
from derive.spec.model.plots import ColumnCurves, Deflection, Plot, ReferenceCurve
from derive.spec.model.simulation import Simulation
from derive.spec.parsing import scene_values, values
from derive.spec.tables.markers import MarkerInput, NameOf, PieceCount, PositiveFloat, Text, TwoMarkers
from derive.spec.tables.shared import TomlTable, few, number_schema

MAX_STEPS = 10**7
MAX_CURVES = 12
"""The largest number of curves of a plot of columns."""


class SimulationTable(TomlTable):
    """Duration, output and accuracy of a simulation."""

    duration: Annotated[PositiveFloat, Field(description="Duration, s.")]
    output: Annotated[PositiveFloat, Field(description="Time between rows of the output, s.")]
    tolerance: Annotated[
        float,
        PlainValidator(scene_values.tolerance),
        WithJsonSchema(number_schema(exclusiveMinimum=0, exclusiveMaximum=1)),
        Field(description="Tolerance of the integrator for the error of a step, relative and absolute."),
    ] = 1e-9
    until: Annotated[
        str | None,
        PlainValidator(scene_values.until),
        WithJsonSchema({"type": "string", "minLength": 3}),
        Field(
            description='Condition on columns that ends the simulation before its duration, such as "rod_phi > pi/2" '
            'or "slider_s = 0.2".'
        ),
    ] = None

    @model_validator(mode="after")
    def check(self) -> SimulationTable:
        """Refuse an unreasonable number of output rows."""
        if self.duration < self.output:
            raise values.WrongValueError("`output`, the time between rows, is longer than `duration`; make it shorter")
        if self.duration > MAX_STEPS * self.output:
            raise values.WrongValueError(
                f"the output would have more than {MAX_STEPS} rows; make `duration` shorter or `output` longer"
            )
        return self

    def simulation(self) -> Simulation:
        """The model of the settings of the simulation."""
        return Simulation(self.duration, self.output, self.tolerance, self.until)


def _few_piece_counts(value: object) -> object:
    if not isinstance(value, (list, tuple)):
        raise values.WrongValueError(
            f"a list of whole numbers is needed, such as [1, 2, 3], not {values.kind_of(value)}"
        )
    few(len(value), 1, scene_values.MAX_PIECES, "numbers of pieces")
    return value


class ReferenceTable(TomlTable):
    """A reference curve: two columns of a CSV file."""

    file: Annotated[Text, Field(description="CSV file, relative to the specification.")]
    x: Annotated[Text, Field(description="Name of the column of the horizontal axis.")]
    y: Annotated[Text, Field(description="Name of the column of the vertical axis.")]


class PlotKeys(TomlTable):
    """The keys that plots share."""

    cut: Annotated[NameOf | None, Field(description="Beam that is divided into other numbers of pieces.")] = None
    pieces: Annotated[
        tuple[PieceCount, ...] | None,
        BeforeValidator(_few_piece_counts),
        Field(description="Numbers of pieces, one curve for each."),
    ] = None
    reference: Annotated[ReferenceTable | None, Field(description="Reference curve.")] = None

    @model_validator(mode="after")
    def check(self) -> PlotKeys:
        """Require `cut` and `pieces` together."""
        if (self.cut is None) != (self.pieces is None):
            raise values.WrongValueError('`cut` and `pieces` go together: write cut = "rod" and pieces = [1, 2, 3]')
        return self

    def quantity(self) -> Deflection | ColumnCurves:
        """The plotted quantity."""
        raise NotImplementedError

    def over_drive(self) -> str | None:
        """The drive whose motion is the horizontal axis."""
        return None

    def plot(self, name: str, rows: Any) -> Plot:
        """The model of the plot; `rows` are the numbers of its reference."""
        known = self.reference
        return Plot(
            name=name,
            quantity=self.quantity(),
            over=self.over_drive(),
            cut=self.cut,
            pieces=self.pieces or (),
            reference=None if known is None else ReferenceCurve(known.file, known.x, known.y, rows),
        )


class PlotTable(PlotKeys):
    """A plot of the distance of a marker from the chord between two others."""

    deflection: Annotated[
        MarkerInput, Field(description="Marker whose distance from the chord is plotted, positive to the left.")
    ]
    chord: Annotated[TwoMarkers, Field(description=CHORD.description)]
    divided_by: Annotated[PositiveFloat | None, Field(description=DIVIDED_BY.description)] = None
    over: Annotated[
        NameOf | None, Field(description="Drive whose motion is the horizontal axis; by default the time.")
    ] = None

    def quantity(self) -> Deflection:
        """The plotted deflection."""
        return Deflection(self.deflection, self.chord, self.divided_by)

    def over_drive(self) -> str | None:
        """The drive whose motion is the horizontal axis, if there is one."""
        return self.over


def _few_columns(value: object) -> object:
    if isinstance(value, str):
        return (value,)
    if not isinstance(value, (list, tuple)):
        kind = values.kind_of(value)
        raise values.WrongValueError(f'a column or a list of columns is needed, such as ["rod_phi"], not {kind}')
    few(len(value), 1, MAX_CURVES, "columns")
    return value


class ColumnPlotTable(PlotKeys):
    """A plot of columns of the trajectory over another one."""

    y: Annotated[
        tuple[Text, ...],
        BeforeValidator(_few_columns),
        WithJsonSchema(
            {
                "anyOf": [
                    {"type": "string", "minLength": 1},
                    {"type": "array", "items": {"type": "string"}, "minItems": 1, "maxItems": MAX_CURVES},
                ]
            }
        ),
        Field(description='Columns of the CSV file, one or a list, such as "rod_phi".'),
    ]
    x: Annotated[Text, Field(description="Column of the horizontal axis; by default the time.")] = "t"

    @model_validator(mode="after")
    def check_reference(self) -> ColumnPlotTable:
        """Refuse a reference for several curves."""
        if self.reference is not None and len(self.y) > 1:
            raise values.WrongValueError("a reference is compared with one column, and `y` has several; leave one")
        return self

    def quantity(self) -> ColumnCurves:
        """The plotted columns."""
        return ColumnCurves(self.y, self.x)


def kind_of_plot(value: Any) -> str:
    """The kind of plot that a table describes: a discriminator."""
    if isinstance(value, Mapping) and ("y" in value or "x" in value):
        return "columns"
    return "deflection"


PlotInput = Annotated[
    Annotated[PlotTable, Tag("deflection")] | Annotated[ColumnPlotTable, Tag("columns")], Discriminator(kind_of_plot)
]
