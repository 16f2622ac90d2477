"""The keys of a beam that determine its shape functions: its ansatz, its floating frame, and its ends."""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    PlainValidator,
    Tag,
    WithJsonSchema,
    model_validator,
)

from derive.spec.model.body import (
    DEFAULT_ANSATZ,
    DEFAULT_FRAME,
    FAMILY_FRAMES,
    AssumedDeflection,
    Ends,
    FamilyKind,
    Frame,
    FrameKind,
    Polynomial,
    ShapeFamily,
)
from derive.spec.parsing import choices, values
from derive.spec.parsing.polynomial import MAX_LENGTH
from derive.spec.tables.shared import (
    TomlTable,
    few,
    number_schema,
    written_as,
)

BEAM_POSITION = number_schema(minimum=-1, maximum=1)
"""The JSON schema of a position xi."""
MAX_SHAPES = 20
MAX_DIGITS = 800


def _few_shapes(value: object) -> object:
    if not isinstance(value, (list, tuple)):
        raise values.WrongValueError(
            'a list of polynomials is needed, such as ["1", "xi", "xi^2"], or a family, such as '
            f'{{ kind = "pinned", count = 3 }}, not {values.kind_of(value)}'
        )
    few(len(value), 1, MAX_SHAPES, "polynomials")
    return value


def _few_digits(ansatz: tuple[Polynomial, ...]) -> tuple[Polynomial, ...]:
    # Shapes are computed exactly, and their fractions are about as long as those of the whole ansatz together.
    digits = sum(values.digits(shape) for shape in ansatz)
    if digits > MAX_DIGITS:
        raise values.WrongValueError(
            f"over common denominators, the coefficients of the ansatz have {digits} digits, and at most "
            f"{MAX_DIGITS} are allowed; round them"
        )
    return ansatz


def _family_count(value: object) -> int:
    count = values.whole(value)
    if not 1 <= count <= MAX_SHAPES:
        raise values.WrongValueError(f"1 to {MAX_SHAPES} shapes of a family are allowed, not {values.shown(count)}")
    return count


_SHAPE = {"type": "string", "minLength": 1, "maxLength": MAX_LENGTH}
# A plain "tangent" would not say which end is meant.
_PLAIN_FRAMES = [kind for kind in choices.FRAME_KINDS if kind != "tangent"]


def frame_from(kind: FrameKind, at: Fraction | None) -> Frame:
    """A frame, if its kind and its position go together; a point is the middle of the beam by default."""
    if kind == "point":
        return Frame(kind, Fraction(0) if at is None else at)
    if kind == "tangent":
        if at not in (-1, 1):
            raise values.WrongValueError(
                'a tangent frame needs the end it is at: { kind = "tangent", at = -1 } or at = 1'
            )
        return Frame(kind, at)
    if at is not None:
        raise values.WrongValueError(f'the frame "{kind}" has no place; leave `at` out, or choose "point"')
    return Frame(kind)


def _plain_frame(value: object) -> Frame:
    """A frame that is given by its kind alone."""
    return frame_from(choices.frame_kind(value), None)


Shape = Annotated[Polynomial, PlainValidator(values.shape), WithJsonSchema(_SHAPE)]


class FrameTable(TomlTable):
    """The kind of a floating frame of a beam, and its position."""

    kind: Annotated[FrameKind, PlainValidator(choices.frame_kind), WithJsonSchema({"enum": [*choices.FRAME_KINDS]})]
    at: Annotated[
        Fraction | None,
        PlainValidator(values.beam_position),
        WithJsonSchema(BEAM_POSITION),
        Field(description="The position xi of a point frame (default 0), or the end, -1 or 1, of a tangent frame."),
    ] = None

    @model_validator(mode="after")
    def check(self) -> FrameTable:
        """Refuse a kind and a position that do not go together."""
        self.frame()
        return self

    def frame(self) -> Frame:
        """The frame that the table describes."""
        return frame_from(self.kind, self.at)


FrameInput = Annotated[
    Annotated[Frame, PlainValidator(_plain_frame), WithJsonSchema({"enum": _PLAIN_FRAMES}), Tag("plain")]
    | Annotated[FrameTable, Tag("table")],
    Discriminator(written_as),
]


def _frame(value: Frame | FrameTable | None, ansatz: Ansatz) -> Frame:
    """The frame that is given; by default that of the family of shapes, or the mean frame for an ansatz."""
    if value is None:
        return FAMILY_FRAMES[ansatz.kind] if isinstance(ansatz, ShapeFamily) else Frame(DEFAULT_FRAME)
    return value.frame() if isinstance(value, FrameTable) else value


class ShapeFamilyTable(TomlTable):
    """Shape functions with names: the natural modes of a uniform beam, in mass and in stiffness orthogonal."""

    kind: Annotated[
        FamilyKind,
        PlainValidator(choices.family_kind),
        WithJsonSchema({"enum": [*choices.FAMILY_KINDS]}),
        Field(
            description="Which beam they are modes of: pinned at both ends (half sine waves, for the frame chord), "
            "free-free (for the frame mean), clamped-free (clamped at the left end, for the frame tangent there)."
        ),
    ]
    count: Annotated[
        int,
        PlainValidator(_family_count),
        WithJsonSchema({"type": "integer", "minimum": 1, "maximum": MAX_SHAPES}),
        Field(description="How many, from that of the lowest frequency on."),
    ]

    def family(self) -> ShapeFamily:
        """The family that the table describes."""
        return ShapeFamily(self.kind, self.count)


Polynomials = Annotated[
    tuple[Shape, ...],
    BeforeValidator(_few_shapes),
    AfterValidator(_few_digits),
    Field(json_schema_extra={"minItems": 1, "maxItems": MAX_SHAPES}),
]
AnsatzInput = Annotated[
    Annotated[Polynomials, Tag("plain")] | Annotated[ShapeFamilyTable, Tag("table")], Discriminator(written_as)
]
Ansatz = tuple[Polynomial, ...] | ShapeFamily


class ShapeKeys(BaseModel):
    """The keys of a beam that say which shapes it has; they are checked even if another key is at fault."""

    model_config = ConfigDict(extra="ignore", frozen=True)

    ansatz: Annotated[
        AnsatzInput,
        Field(
            description="Polynomials in xi whose sum is the deflection, before the conditions of the frame; or a "
            "family of shape functions.",
            json_schema_extra={"default": [*DEFAULT_ANSATZ]},
        ),
    ] = tuple(values.shape(text) for text in DEFAULT_ANSATZ)
    frame: Annotated[
        FrameInput | None,
        Field(
            description="The floating frame, whose conditions remove rigid-body motion from the ansatz: mean (no mean "
            "displacement, no mean rotation), point (no displacement and no slope at a point), chord (no displacement "
            "at the ends), tangent (no displacement and no slope at an end), given (the ansatz is used unchanged). "
            "A family of shape functions has by default the frame that it is for.",
            json_schema_extra={"default": DEFAULT_FRAME},
        ),
    ] = None
    orthogonal: Annotated[
        bool | None,
        PlainValidator(values.truth),
        WithJsonSchema({"type": "boolean"}),
        Field(description="Whether the shape functions are made orthogonal; by default only in the mean frame."),
    ] = None

    ends: Annotated[
        Ends | None,
        PlainValidator(choices.ends),
        WithJsonSchema({"enum": [*choices.ENDS]}),
        Field(
            description="What the shape functions fulfil at both ends of the beam besides the conditions of the frame: "
            "pinned (no curvature) or free (no curvature, no derivative of it). By default nothing."
        ),
    ] = None

    def deflection(self) -> AssumedDeflection:
        """The assumed deflection, from which the shape functions follow."""
        ansatz = self.ansatz.family() if isinstance(self.ansatz, ShapeFamilyTable) else self.ansatz
        frame = _frame(self.frame, ansatz)
        orthogonal = frame.kind == "mean" if self.orthogonal is None else self.orthogonal
        return AssumedDeflection(ansatz, frame, orthogonal, self.ends)
