"""The parts of a planar beam as frozen data: its frame, shapes, stretching and damping, and what is attached to it."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated, Literal

from derive.short_text import record_text
from derive.spec.model.documentation import documented
from derive.spec.model.keys import KeyType, key
from derive.spec.model.quantity import Parameter, Quantity

Polynomial = tuple[Fraction, ...]
"""A polynomial as its coefficients of 1, xi, xi^2, ... without trailing zeros."""

FrameKind = Literal["mean", "point", "chord", "tangent", "given"]
Ends = Literal["pinned", "free"]
"""The conditions on shapes at both ends of a beam, besides those of the frame: v'' = 0, or v'' = v''' = 0."""

DEFAULT_ANSATZ = ("1", "xi", "xi^2", "xi^3")
DEFAULT_POLYNOMIALS = tuple((Fraction(0),) * power + (Fraction(1),) for power in range(len(DEFAULT_ANSATZ)))
DEFAULT_FRAME: FrameKind = "mean"
DEFAULT_MASS = Parameter("m", "kg", 1.0)
DEFAULT_LENGTH = Parameter("l", "m", 1.0)
DEFAULT_BENDING_STIFFNESS = Parameter("EI", "N m^2", 1.0)
"""The free beam of the paper, (21)-(27): defaults for the keys that a specification leaves out."""
INERTIA_UNIT = "kg m^2"


@documented
@dataclass(frozen=True)
class Frame:
    """The conditions that remove rigid motion from the displacements due to deformation: (16) or (17), (19).

    In every frame X = xi l/2 e1, so that c is where the centre of the undeformed beam lies in the floating frame, not
    the point `at`.

    Attributes:
        kind: "mean": no mean displacement and no mean rotation; "point": no displacement and no slope at `at`; "chord":
            no displacement at either end; "tangent": no displacement and no slope at the end `at`; "given": the ansatz
            is used as it stands, and refused if it holds a rigid motion.

    Examples:
        >>> import derive
        >>> beam = derive.planar_beam("beam", frame=derive.Frame("tangent", at=-1))
        >>> beam.frame.kind, beam.frame.at
        ('tangent', Fraction(-1, 1))
    """

    kind: Annotated[FrameKind, key(KeyType.CHOICE, "", choice_of="the frame", example='"point"')]
    at: Annotated[
        Fraction | None,
        key(
            KeyType.POSITION,
            "The position xi of a point frame (default 0), or the end, -1 or 1, of a tangent frame.",
        ),
    ] = None
    __repr__ = record_text


FamilyKind = Literal["pinned", "free-free", "clamped-free"]


@dataclass(frozen=True)
class ShapeFamily:
    """Shape functions with names: the natural modes of a uniform beam, in mass and in stiffness orthogonal."""

    kind: Annotated[
        FamilyKind,
        key(
            KeyType.CHOICE,
            "Which beam they are modes of: pinned at both ends (half sine waves, for the frame chord), free-free (for "
            "the frame mean), clamped-free (clamped at the left end, for the frame tangent there).",
            choice_of="the family",
            example='"pinned"',
        ),
    ]
    count: Annotated[int, key(KeyType.SHAPE_COUNT, "How many, from that of the lowest frequency on.", example="3")]
    __repr__ = record_text


FAMILY_FRAMES: dict[FamilyKind, Frame] = {
    "pinned": Frame("chord"),
    "free-free": Frame("mean"),
    "clamped-free": Frame("tangent", Fraction(-1)),
}
"""The frame whose conditions the shapes of a family fulfil."""


@dataclass(frozen=True)
class AssumedDeflection:
    """The assumed deflection of a beam, which determines its shape functions.

    It is an ansatz of polynomials with the conditions of the frame and of the ends, or a family of shapes, which have
    to fulfil the conditions of the frame.
    """

    ansatz: tuple[Polynomial, ...] | ShapeFamily
    frame: Frame
    orthogonal: bool = False
    ends: Ends | None = None


@dataclass(frozen=True)
class AxialDeformation:
    """How a beam stretches. Without this table its axis keeps its length, to the order of its displacements."""

    ansatz: Annotated[
        tuple[Polynomial, ...],
        key(
            KeyType.SHAPES,
            "Polynomials in xi whose sum is the displacement along the axis, before the condition of the frame takes a "
            "constant from each: no mean displacement, none at the point of the frame, or opposite ones at the ends of "
            'a chord. ["xi"] is a uniform strain.',
            example='["xi"]',
        ),
    ]
    stiffness: Annotated[
        Quantity,
        key(
            KeyType.POSITIVE_QUANTITY,
            "Axial stiffness EA, N: a run-time parameter or a number.",
            "N",
            example="1e6",
        ),
    ]
    preload: Annotated[
        Quantity,
        key(
            KeyType.QUANTITY,
            "Axial force of the straight beam of the given length, N, positive in tension; for beams of order 2.",
            "N",
        ),
    ] = Fraction(0)
    __repr__ = record_text


@dataclass(frozen=True)
class Marker:
    """A named material point of a beam.

    Attributes:
        name: the name of the marker.
        at: the dimensionless position xi of (21), from -1 (left end) to 1 (right end).

    Examples:
        >>> import derive
        >>> beam = derive.planar_beam("beam", markers={"middle": 0, "tip": 1})
        >>> [(marker.name, float(marker.at)) for marker in beam.markers]
        [('middle', 0.0), ('tip', 1.0)]
    """

    name: str
    at: Fraction
    __repr__ = record_text


POSITION = key(KeyType.POSITION, "Position xi, from -1 (left end) to 1 (right end).", example="1")
MASSES = (
    "Attached masses by name: rigid bodies that are fixed to sections of the beam. The conditions of the frame and the "
    "damping are those of the beam without them."
)


@documented
@dataclass(frozen=True)
class AttachedMass:
    """A small rigid body that is fixed to the section of a beam, with its centre of mass on the axis.

    Attributes:
        name: the name of the mass.

    Examples:
        >>> import derive
        >>> tip = derive.AttachedMass("tip", at=1, mass="1/2")
        >>> derive.planar_beam("beam", masses=[tip]).masses[0].mass
        Fraction(1, 2)
    """

    name: str
    at: Annotated[Fraction, POSITION]
    mass: Annotated[Quantity, key(KeyType.POSITIVE_QUANTITY, "Mass, kg.", DEFAULT_MASS.unit, example="0.5")]
    inertia: Annotated[
        Quantity,
        key(KeyType.NOT_NEGATIVE_QUANTITY, "Moment of inertia about its centre of mass, kg m^2.", INERTIA_UNIT),
    ] = Fraction(0)
    __repr__ = record_text


@documented
@dataclass(frozen=True)
class BeamDamping:
    """Damping of the deformation of a beam: a fraction of critical damping, or proportional to mass and stiffness.

    It is that of the whole beam without attached masses, the same in every frame and in any number of pieces; rigid
    motion is not damped.

    Examples:
        >>> import derive
        >>> beam = derive.planar_beam("beam", damping=derive.BeamDamping(ratio=0.01))
        >>> round(derive.modes(beam).modes[-1].damping_ratio, 6)
        0.01
    """

    ratio: Annotated[
        Quantity,
        key(
            KeyType.NOT_NEGATIVE_QUANTITY,
            "Fraction of critical damping of each free mode, such as 0.01.",
            "1",
            optional=True,
        ),
    ] = Fraction(0)
    mass: Annotated[
        Quantity,
        key(
            KeyType.NOT_NEGATIVE_QUANTITY,
            "Factor of the mass matrix of the deformation, 1/s: forces against the velocity relative to the mean frame "
            "of the whole beam.",
            "1/s",
            optional=True,
        ),
    ] = Fraction(0)
    stiffness: Annotated[
        Quantity,
        key(KeyType.NOT_NEGATIVE_QUANTITY, "Factor of the stiffness matrix, s.", "s", optional=True),
    ] = Fraction(0)
    __repr__ = record_text
