"""A beam in space as frozen data: its shapes in both planes, in torsion and along its axis, and what is on it."""

from __future__ import annotations

from dataclasses import dataclass, fields
from fractions import Fraction
from typing import Annotated, ClassVar

from derive.short_text import record_text
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import (
    DEFAULT_LENGTH,
    INERTIA_UNIT,
    MASSES,
    AssumedDeflection,
    AxialDeformation,
    BeamDamping,
    Ends,
    Frame,
    Polynomial,
    ShapeFamily,
)
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.documentation import documented
from derive.spec.model.keys import Key, KeyType, declared_keys, key
from derive.spec.model.quantity import Quantity
from derive.spec.model.spatial_beam_parts import (
    LateralDeflection,
    SectionFrame,
    SpatialAttachedMass,
    SpatialDistributedLoad,
    TorsionalDeformation,
)
from derive.spec.model.spatial_bodies import FlexibleBody, SpatialRigidBody
from derive.spec.model.spatial_start import (
    NOT_GIVEN_IN_SPACE,
    SPATIAL_START,
    SpatialInitialValues,
)

OF_BEAM = ("length", "bending_stiffness", "ansatz")
"""The keys that beams alone have, in the plane and in space."""
OF_BEAM_IN_SPACE = ("rotary_inertia", "torsion", "lateral")
"""The keys that beams in space alone have."""


def _of_planar(name: str, **changed: object) -> Key:
    """The declaration of a key that a beam in space shares with the planar beam."""
    own = next(key for key in declared_keys(PlanarBeam) if key.name == name)
    return key(own.type, own.description, own.unit, **{**_shared(own), **changed})  # type: ignore[arg-type]


def _shared(own: Key) -> dict[str, object]:
    names = ("default", "choices", "example", "choice_of", "shown", "optional")
    return {name: getattr(own, name) for name in names}


@dataclass(frozen=True)
class PieceOf:
    """The place of a piece: the whole beam, whose length and mass it has a part of, and its number from 0."""

    rod: SpatialBeam
    number: int


@documented
@dataclass(frozen=True)
class SpatialBeam:
    """A uniform slender beam in a scene in space. Its axis is e1; it deflects along e2 and e3, twists and stretches.

    Attributes:
        name: the name of the body.
        piece_of: the beam that it is a piece of, in scenes whose beams are cut; their other keys are those of the beam.

    Examples:
        >>> import derive
        >>> rod = {"length": 1, "mass": 2, "bending_stiffness": 100, "rotary_inertia": 1e-3, "markers": {"tip": 1}}
        >>> scene = derive.spatial_scene("floating", bodies={"rod": rod})
        >>> scene.bodies[0].length, scene.bodies[0].markers[0].at
        (Fraction(1, 1), Fraction(1, 1))
    """

    name: str
    length: Annotated[
        Quantity,
        key(
            KeyType.POSITIVE_QUANTITY,
            "Length, m: a run-time parameter or a number.",
            DEFAULT_LENGTH.unit,
            example="1",
        ),
    ]
    mass: Annotated[Quantity, key(KeyType.POSITIVE_QUANTITY, "Mass, kg: a run-time parameter or a number.", "kg")]
    bending_stiffness: Annotated[
        Quantity,
        key(
            KeyType.POSITIVE_QUANTITY,
            "Bending stiffness EI about e3, N m^2, of deflections along e2, and along e3 unless `lateral` gives "
            "another. Rotary inertia of bending and shear deformation are left out.",
            "N m^2",
            example="10",
        ),
    ]
    rotary_inertia: Annotated[
        Quantity,
        key(
            KeyType.POSITIVE_QUANTITY,
            "Moment of inertia of the whole beam about its axis, kg m^2.",
            INERTIA_UNIT,
            example="1e-3",
        ),
    ]
    ansatz: Annotated[tuple[Polynomial, ...] | ShapeFamily, _of_planar("ansatz")]
    frame: Annotated[Frame, _of_planar("frame")]
    orthogonal: Annotated[bool, _of_planar("orthogonal")] = False
    ends: Annotated[Ends | None, _of_planar("ends")] = None
    lateral: Annotated[
        LateralDeflection | None,
        key(
            LateralDeflection,
            'The deflection along e3: { ansatz = ["xi^2"], bending_stiffness = 20 }. By default it is like that along '
            "e2.",
            example="{ bending_stiffness = 20 }",
        ),
    ] = None
    torsion: Annotated[
        TorsionalDeformation | None,
        key(
            TorsionalDeformation,
            'How the beam twists: { ansatz = ["xi"], stiffness = 10 }, the shapes of the rotation about its axis and '
            "GJ in N m^2. By default it is rigid in torsion.",
            example='{ ansatz = ["xi"], stiffness = 10 }',
        ),
    ] = None
    axial: Annotated[AxialDeformation | None, _of_planar("axial")] = None
    centre: Annotated[
        tuple[Quantity, Quantity],
        key(
            KeyType.COORDINATES,
            "Offset of the centre of mass of the sections from the axis along e2 and e3, m.",
            DEFAULT_LENGTH.unit,
        ),
    ] = (Fraction(0), Fraction(0))
    damping: Annotated[BeamDamping | None, _of_planar("damping")] = None
    order: Annotated[
        DisplacementOrder,
        key(
            KeyType.ORDER,
            "The order of the displacements in the amplitudes: 1 as in the paper, where a fast-spinning beam softens "
            "and no beam buckles; 2 with the shortening of a beam that bends and the coupling of torsion with the two "
            "bendings.",
            default=1,
        ),
        key(
            KeyType.CHOICE,
            "What a beam of order 2 keeps: truncated (kinetic and potential energy through second order in the "
            "amplitudes, the default), full (all that the displacements of the axis yield, also where a beam "
            "bends far, and the rotary inertia of sections through second order; the equations are several times as "
            "long).",
            name="terms",
            choices=("truncated", "full"),
            choice_of="terms",
            optional=True,
        ),
    ] = DisplacementOrder.FIRST_ORDER
    markers: Annotated[
        tuple[SectionFrame, ...],
        key(
            KeyType.SECTION_FRAMES,
            "Named markers: positions xi, from -1 (left end) to 1 (right end), or { at = 1, rotation = ... } of a "
            "frame that is rotated. A marker turns with the section of the beam.",
            default=(),
        ),
    ] = ()
    start: Annotated[SpatialInitialValues, SPATIAL_START] = NOT_GIVEN_IN_SPACE
    masses: Annotated[
        tuple[SpatialAttachedMass, ...],
        key(SpatialAttachedMass, MASSES, example="[bodies.rod.masses.tip]"),
    ] = ()
    loads: Annotated[
        tuple[SpatialDistributedLoad, ...],
        key(SpatialDistributedLoad, "Distributed loads by name.", example="[bodies.rod.loads.wind]"),
    ] = ()
    pieces: Annotated[
        int, key(KeyType.PIECE_COUNT, "Number of beams of equal length into which the beam is divided.")
    ] = 1
    piece_of: PieceOf | None = None
    keep_coordinates: ClassVar[bool] = True
    kind: ClassVar[str] = "beam"
    __repr__ = record_text

    @property
    def deflections(self) -> tuple[AssumedDeflection, AssumedDeflection]:
        """The assumed deflections along e2 and e3, from which their shape functions follow."""
        lateral = self.ansatz if self.lateral is None or self.lateral.ansatz is None else self.lateral.ansatz
        both = (self.ansatz, lateral)
        first, second = (AssumedDeflection(a, self.frame, self.orthogonal, self.ends) for a in both)
        return first, second

    @property
    def bending_stiffnesses(self) -> tuple[Quantity, Quantity]:
        """The bending stiffnesses of deflections along e2 and e3, N m^2."""
        lateral = self.lateral.bending_stiffness if self.lateral else None
        return self.bending_stiffness, self.bending_stiffness if lateral is None else lateral


def cut_into(body: SpatialBeam) -> int:
    """The number of equal pieces of its length and mass of which a body is one: 1 for a whole beam."""
    return 1 if body.piece_of is None else body.pieces


DEFLECTION_FIELDS = tuple(field.name for field in fields(AssumedDeflection))
"""The fields of a beam that make up its assumed deflection."""

SpatialBody = SpatialRigidBody | FlexibleBody | SpatialBeam
"""A body of a scene in space."""
