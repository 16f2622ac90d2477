"""The tables of a body in space as pydantic models: made of nodes, or with parameters for all its integrals."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, PlainValidator, Tag, WithJsonSchema, model_validator

from derive.spec.files.node_format import FILES, LENGTHS, MASSES, TIMES, Units
from derive.spec.model.body import (
    BodyFrame,
    BodyFrameKind,
    Damping,
    DisplacementOrder,
    Gravity,
    Lowering,
    NodalBody,
    NodeData,
    NodeMarker,
    SymbolicBody,
    SymbolicFrame,
)
from derive.spec.model.plots import Plot
from derive.spec.model.simulation import Simulation
from derive.spec.parsing import choices, values
from derive.spec.tables.damping import DampingTable
from derive.spec.tables.shared import (
    MAX_MARKERS,
    Name,
    SignedInput,
    SpatialGravity,
    TomlTable,
    Truth,
    acceleration,
    few,
    few_markers,
    written_as,
)
from derive.spec.tables.spatial_start import SpatialStartTable

MAX_AROUND = 1000

_FILE = {"type": "string", "minLength": 1}
_NODES = {
    "anyOf": [
        _FILE,
        {
            "type": "object",
            "properties": {key: {**_FILE, "description": text} for key, text in FILES.items()},
            "required": ["positions", "mass"],
            "additionalProperties": False,
        },
    ]
}
_COUNT = {"type": "integer", "minimum": 0}
_MODES = {**_COUNT, "maximum": values.MAX_MODES}

Count = Annotated[int, PlainValidator(values.whole), WithJsonSchema(_COUNT)]
ModeCount = Annotated[int, PlainValidator(values.mode_count), WithJsonSchema(_MODES)]


def _one_of(table: Mapping[str, Fraction], noun: str) -> PlainValidator:
    return PlainValidator(lambda value: table[choices.choice(value, tuple(table), f"the unit of {noun}")])


class UnitsTable(TomlTable):
    """Units of the numbers in the files of a body; stiffness is in mass per time squared."""

    length: Annotated[Fraction, _one_of(LENGTHS, "length"), WithJsonSchema({"enum": [*LENGTHS]})]
    mass: Annotated[Fraction, _one_of(MASSES, "mass"), WithJsonSchema({"enum": [*MASSES]})]
    time: Annotated[Fraction, _one_of(TIMES, "time"), WithJsonSchema({"enum": [*TIMES]})]


def _plain_units(value: object) -> Units:
    if value != "SI":
        raise values.WrongValueError(
            'units are "SI", or a table of all three such as { length = "mm", mass = "t", time = "s" }'
        )
    return Units()


UnitsInput = Annotated[
    Annotated[Units, PlainValidator(_plain_units), WithJsonSchema({"const": "SI"}), Tag("plain")]
    | Annotated[UnitsTable, Tag("table")],
    Discriminator(written_as),
]


def _few_around(value: object) -> object:
    if not isinstance(value, (list, tuple)):
        raise values.WrongValueError(f"a list of nodes is needed, such as [3, 4, 5], not {values.kind_of(value)}")
    few(len(value), 0, MAX_AROUND, "nodes")
    return value


class BodyFrameTable(TomlTable):
    """The kind of the floating frame of a body, and its nodes."""

    kind: Annotated[
        BodyFrameKind, PlainValidator(choices.body_frame_kind), WithJsonSchema({"enum": [*choices.BODY_FRAME_KINDS]})
    ]
    node: Annotated[Count | None, Field(description="The node of a point frame, counted from 0.")] = None
    around: Annotated[
        tuple[Count, ...],
        BeforeValidator(_few_around),
        Field(
            description="Nodes whose mean rotation a point frame follows; by default the nearest neighbours of `node`.",
            json_schema_extra={"maxItems": MAX_AROUND},
        ),
    ] = ()

    @model_validator(mode="after")
    def check(self) -> BodyFrameTable:
        """Refuse a kind and nodes that do not go together."""
        self.frame()
        return self

    def frame(self) -> BodyFrame:
        """The frame that the table describes."""
        if self.kind == "point":
            if self.node is None:
                raise values.WrongValueError(_POINT)
            if len({self.node, *self.around}) <= len(self.around):
                raise values.WrongValueError("a node is named twice; `node` and those in `around` have to differ")
        elif self.node is not None or self.around:
            raise values.WrongValueError(f'the frame "{self.kind}" is at no node; leave `node` and `around` out')
        return BodyFrame(self.kind, self.node, self.around)


_POINT = (
    "a point frame needs the node it is at, and turns with those in `around`, or with its nearest neighbours: "
    '{ kind = "point", node = 12, around = [3, 4, 5] }'
)


def _plain_frame(value: object) -> BodyFrame:
    kind = choices.body_frame_kind(value)
    if kind == "point":
        raise values.WrongValueError(_POINT)
    return BodyFrame(kind)


BodyFrameInput = Annotated[
    Annotated[BodyFrame, PlainValidator(_plain_frame), WithJsonSchema({"enum": ["mean", "given"]}), Tag("plain")]
    | Annotated[BodyFrameTable, Tag("table")],
    Discriminator(written_as),
]


LoweringInput = Annotated[
    Lowering,
    PlainValidator(choices.lowering),
    WithJsonSchema({"enum": [*choices.LOWERINGS]}),
    Field(
        description="Code of sums over the modes: flat (unrolled), table (loops), or auto (the faster, as predicted)."
    ),
]


class NodalTable(TomlTable):
    """A flexible body in space given by nodes, as a finite-element program exports it."""

    nodes: Annotated[
        Any,
        WithJsonSchema(_NODES),
        Field(
            description="A .npz file with the arrays, or one MatrixMarket file for each; relative to the specification."
        ),
    ]
    units: Annotated[UnitsInput, Field(description='Units of the numbers in the files: "SI", or a table of units.')]
    modes: Annotated[
        ModeCount | None,
        Field(description="Number of modes that are computed, or kept of the given ones; by default all given ones."),
    ] = None
    frame: Annotated[
        BodyFrameInput,
        Field(
            description="The floating frame, whose conditions remove rigid-body motion from the modes: mean (no mean "
            "displacement, no mean rotation), point (fixed to a node), given (the modes are used unchanged).",
            json_schema_extra={"default": "mean"},
        ),
    ] = BodyFrame("mean")
    orthonormal: Annotated[
        Truth | None,
        Field(
            description="Whether the modes are made orthonormal with respect to the mass; by default in the mean frame "
            "and for computed modes."
        ),
    ] = None
    order: Annotated[
        int | None,
        PlainValidator(values.order),
        WithJsonSchema({"enum": [1, 2]}),
        Field(
            description="The order of the displacements in the amplitudes: 2 uses the geometric stiffness matrices of "
            "the files (K0t, K0r, K0omega, K0F), 1 leaves them out; by default 2 if there are any."
        ),
    ] = None
    damping: Annotated[DampingTable | None, Field(description="Viscous damping; none by default.")] = None
    gravity: SpatialGravity = None
    lowering: LoweringInput = "auto"
    markers: Annotated[
        dict[Name, Count],
        few_markers("nodes"),
        Field(
            description="Named nodes and their numbers, counted from 0.",
            json_schema_extra={"maxProperties": MAX_MARKERS, "additionalProperties": False},
        ),
    ] = {}  # noqa: RUF012  as in BeamTable: pydantic copies it

    start: Annotated[SpatialStartTable, Field(description="Initial state of a simulation of the body alone.")] = (
        SpatialStartTable()
    )

    def scales(self) -> Units:
        """The units, from either notation."""
        units = self.units
        return Units(units.length, units.mass, units.time) if isinstance(units, UnitsTable) else units

    def body_frame(self) -> BodyFrame:
        """The frame, from either notation."""
        return self.frame.frame() if isinstance(self.frame, BodyFrameTable) else self.frame

    def body(self, name: str, data: NodeData, simulation: Simulation | None, plots: tuple[Plot, ...]) -> NodalBody:
        """The model of the body that the reduction takes."""
        frame = self.body_frame()
        by_default = frame.kind == "mean" or data.modes is None
        second_order = data.has_geometric_stiffness and self.order != 1
        return NodalBody(
            name=name,
            data=data,
            modes=self.modes,
            frame=frame,
            orthonormal=by_default if self.orthonormal is None else self.orthonormal,
            damping=Damping() if self.damping is None else self.damping.damping(),
            gravity=_gravity(self.gravity),
            markers=tuple(NodeMarker(marker, node) for marker, node in self.markers.items()),
            lowering=self.lowering,
            start=self.start.start(),
            simulation=simulation,
            order=DisplacementOrder.TRUNCATED if second_order else DisplacementOrder.FIRST_ORDER,
            plots=plots,
        )


def _symbolic(value: object) -> str:
    return choices.choice(value, ("symbolic",), "`integrals`")


class SymbolicTable(TomlTable):
    """A flexible body in space whose mass, shape integrals and stiffness are run-time parameters."""

    integrals: Annotated[
        Literal["symbolic"],
        PlainValidator(_symbolic),
        WithJsonSchema({"const": "symbolic"}),
        Field(description="Makes mass, shape integrals and stiffness run-time parameters."),
    ]
    modes: Annotated[ModeCount, Field(description="Number of modes.")]
    frame: Annotated[
        SymbolicFrame,
        PlainValidator(choices.symbolic_frame),
        WithJsonSchema({"enum": [*choices.SYMBOLIC_FRAMES]}),
        Field(description="Assumption about the modes: mean (orthonormal in the mean frame), or given (none)."),
    ] = "mean"
    damping: Annotated[Truth, Field(description="Whether viscous damping is among the parameters.")] = False
    gravity: SpatialGravity = None
    lowering: LoweringInput = "auto"

    def body(self, name: str) -> SymbolicBody:
        """The model of the body that the derivation takes."""
        return SymbolicBody(name, self.modes, self.frame, self.damping, _gravity(self.gravity), self.lowering)


def _gravity(value: tuple[SignedInput, SignedInput, SignedInput] | None) -> Gravity | None:
    return value and (acceleration(value[0]), acceleration(value[1]), acceleration(value[2]))


def kind_of_body(value: Any) -> str:
    """The kind of body that a table describes: a discriminator."""
    return "symbolic" if isinstance(value, Mapping) and "integrals" in value else "nodal"


BodyInput = Annotated[
    Annotated[NodalTable, Tag("nodal")] | Annotated[SymbolicTable, Tag("symbolic")], Discriminator(kind_of_body)
]
