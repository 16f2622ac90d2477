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
    """How long is simulated, and how exactly."""

    duration: Annotated[PositiveFloat, Field(description="How long, s.")]
    output: Annotated[PositiveFloat, Field(description="The time between rows of the output, s.")]
    tolerance: Annotated[
        float,
        PlainValidator(scene_values.tolerance),
        WithJsonSchema(number_schema(exclusiveMinimum=0, exclusiveMaximum=1)),
        Field(description="The relative error that the integrator aims at."),
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
    """A curve to compare with: two columns of a CSV file."""

    file: Annotated[Text, Field(description="The CSV file; its path begins at this file.")]
    x: Annotated[Text, Field(description="The column of what the plot is over, as the header of the file names it.")]
    y: Annotated[Text, Field(description="The column of what is plotted.")]


class PlotTable(TomlTable):
    """The distance of a marker from the chord between two others, as a picture."""

    deflection: Annotated[
        MarkerInput, Field(description="The marker whose distance to the left of the chord is drawn.")
    ]
    chord: Annotated[TwoMarkers, Field(description="The markers that the chord begins and ends at.")]
    divided_by: Annotated[PositiveFloat, Field(description="A length that the distance is divided by, m.")]
    over: Annotated[
        NameOf | None, Field(description="The drive over whose motion it is drawn; over the time if left out.")
    ] = None
    cut: Annotated[NameOf | None, Field(description="The beam that is cut into other numbers of pieces.")] = None
    pieces: Annotated[
        tuple[PieceCount, ...] | None,
        BeforeValidator(_few_piece_counts),
        Field(description="The numbers of pieces, a curve for each."),
    ] = None
    reference: Annotated[ReferenceTable | None, Field(description="A curve to compare with.")] = None

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
