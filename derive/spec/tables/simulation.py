"""The tables of what to simulate and of the pictures that a simulation draws."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Field, PlainValidator, WithJsonSchema, model_validator

from derive.spec.model.scene import Deflection, Plot, ReferenceCurve, Simulation
from derive.spec.parsing import scene_values, values
from derive.spec.tables.markers import MarkerInput, NameOf, PieceCount, PositiveFloat, Text, TwoMarkers
from derive.spec.tables.shared import TomlTable, few, number_schema

MAX_STEPS = 10**7


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

    @model_validator(mode="after")
    def check(self) -> SimulationTable:
        """The output has to have a reasonable number of rows."""
        if self.duration < self.output:
            raise values.WrongValueError("`output`, the time between rows, is longer than `duration`; make it shorter")
        if self.duration > MAX_STEPS * self.output:
            raise values.WrongValueError(
                f"the output would have more than {MAX_STEPS} rows; make `duration` shorter or `output` longer"
            )
        return self

    def simulation(self) -> Simulation:
        """The simulation as it is run."""
        return Simulation(self.duration, self.output, self.tolerance)


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


class PlotTable(TomlTable):
    """A plot of the distance of a marker from the chord between two others."""

    deflection: Annotated[
        MarkerInput, Field(description="Marker whose distance from the chord is plotted, positive to the left.")
    ]
    chord: Annotated[TwoMarkers, Field(description="Markers at the beginning and the end of the chord.")]
    divided_by: Annotated[PositiveFloat, Field(description="Length by which the distance is divided, m.")]
    over: Annotated[
        NameOf | None, Field(description="Drive whose motion is the horizontal axis; by default the time.")
    ] = None
    cut: Annotated[NameOf | None, Field(description="Beam that is divided into other numbers of pieces.")] = None
    pieces: Annotated[
        tuple[PieceCount, ...] | None,
        BeforeValidator(_few_piece_counts),
        Field(description="Numbers of pieces, one curve for each."),
    ] = None
    reference: Annotated[ReferenceTable | None, Field(description="Reference curve.")] = None

    @model_validator(mode="after")
    def check(self) -> PlotTable:
        """A cut needs to know what is cut, and into how many pieces."""
        if (self.cut is None) != (self.pieces is None):
            raise values.WrongValueError('`cut` and `pieces` go together: write cut = "rod" and pieces = [1, 2, 3]')
        return self

    def plot(self, name: str, rows: Any) -> Plot:
        """The plot as it is drawn; `rows` are the numbers of its reference."""
        known = self.reference
        return Plot(
            name=name,
            quantity=Deflection(self.deflection, *self.chord, self.divided_by),
            over=self.over,
            cut=self.cut,
            pieces=self.pieces or (),
            reference=None if known is None else ReferenceCurve(known.file, known.x, known.y, rows),
        )
