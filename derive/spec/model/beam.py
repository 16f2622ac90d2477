"""A planar beam as frozen data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

from derive.display import html
from derive.spec.model.beam_parts import (
    DEFAULT_ANSATZ,
    DEFAULT_BENDING_STIFFNESS,
    DEFAULT_FRAME,
    DEFAULT_LENGTH,
    DEFAULT_MASS,
    DEFAULT_POLYNOMIALS,
    MASSES,
    AssumedDeflection,
    AttachedMass,
    AxialDeformation,
    BeamDamping,
    Ends,
    Frame,
    Marker,
    Polynomial,
    ShapeFamily,
)
from derive.spec.model.body import GRAVITY, DisplacementOrder
from derive.spec.model.documentation import documented
from derive.spec.model.keys import KeyType, declared_keys, key
from derive.spec.model.plots import Plot
from derive.spec.model.quantity import Parameter, Quantity
from derive.spec.model.simulation import NOT_GIVEN, InitialValues, Simulation
from derive.spec.model.spec_text import beam_text


@documented
@dataclass(frozen=True)
class PlanarBeam:
    """A uniform slender beam that moves freely in a plane.

    Attributes:
        name: the name of the model.
        simulation: duration, output and tolerance of a simulation of the beam alone.
        plots: plots of a simulation of the beam alone.

    Examples:
        >>> import derive
        >>> beam = derive.planar_beam("beam", length=2)
        >>> beam.length, beam.mass.symbol
        (Fraction(2, 1), 'm')
    """

    name: str
    ansatz: Annotated[
        tuple[Polynomial, ...] | ShapeFamily,
        key(
            ShapeFamily,
            "Polynomials in xi whose sum is the deflection, before the conditions of the frame; or a family of shape "
            "functions.",
            default=DEFAULT_POLYNOMIALS,
            shown=DEFAULT_ANSATZ,
        ),
    ]
    frame: Annotated[
        Frame,
        key(
            Frame,
            "The floating frame, whose conditions remove rigid-body motion from the ansatz: mean (no mean "
            "displacement, no mean rotation), point (no displacement and no slope at a point), chord (no displacement "
            "at the ends), tangent (no displacement and no slope at an end), given (the ansatz is used unchanged). "
            "A family of shape functions has by default the frame that it is for.",
            shown=DEFAULT_FRAME,
            optional=True,
        ),
    ]
    mass: Annotated[
        Quantity,
        key(
            KeyType.POSITIVE_QUANTITY,
            "Mass, kg: a run-time parameter, or a number that is folded into the code.",
            DEFAULT_MASS.unit,
            default=DEFAULT_MASS,
        ),
    ]
    length: Annotated[
        Quantity,
        key(
            KeyType.POSITIVE_QUANTITY,
            "Length, m: a run-time parameter or a number.",
            DEFAULT_LENGTH.unit,
            default=DEFAULT_LENGTH,
        ),
    ]
    bending_stiffness: Annotated[
        Quantity,
        key(
            KeyType.POSITIVE_QUANTITY,
            "Bending stiffness EI, N m^2: a run-time parameter or a number. Rotary inertia of the cross-sections and "
            "shear deformation are left out at either order.",
            DEFAULT_BENDING_STIFFNESS.unit,
            default=DEFAULT_BENDING_STIFFNESS,
        ),
    ]
    markers: Annotated[
        tuple[Marker, ...],
        key(
            KeyType.BEAM_POINTS,
            "Named points of the beam and their positions xi, from -1 (left end) to 1 (right end).",
        ),
    ] = ()
    orthogonal: Annotated[
        bool,
        key(
            KeyType.TRUTH,
            "Whether the shape functions are made orthogonal; by default only in the mean frame.",
            optional=True,
        ),
    ] = False
    gravity: Annotated[tuple[Quantity, Quantity] | None, key(KeyType.PLANAR_ACCELERATION, GRAVITY)] = None
    start: Annotated[InitialValues, key(InitialValues, "Initial values of a simulation of the beam alone.")] = NOT_GIVEN
    simulation: Simulation | None = None
    plots: tuple[Plot, ...] = ()
    damping: Annotated[
        BeamDamping | None,
        key(
            BeamDamping,
            "Damping of the deformation: { ratio = 0.01 } of critical in each free mode of the beam, or "
            "{ mass = 0.1, stiffness = 1e-5 }, factors of its mass and stiffness matrices, in 1/s and s.",
            example="{ ratio = 0.01 }",
        ),
    ] = None
    order: Annotated[
        DisplacementOrder,
        key(
            KeyType.ORDER,
            "The order of the displacements in the amplitudes: 1 as in the paper, where a fast-spinning beam softens "
            "and no beam buckles; 2 with the shortening of a beam that bends.",
            default=1,
        ),
        key(
            KeyType.CHOICE,
            "What a beam of order 2 keeps: truncated (kinetic and potential energy through second order in the "
            "amplitudes), full (all that the displacements yield; the mass matrix is always positive definite). By "
            "default truncated in the frames mean, chord and given, and full in the frames point and tangent.",
            name="terms",
            choices=("truncated", "full"),
            choice_of="terms",
            optional=True,
        ),
    ] = DisplacementOrder.FIRST_ORDER
    ends: Annotated[
        Ends | None,
        key(
            KeyType.CHOICE,
            "What the shape functions fulfil at both ends of the beam besides the conditions of the frame: pinned (no "
            "curvature) or free (no curvature, no derivative of it). By default nothing.",
        ),
    ] = None
    masses: Annotated[
        tuple[AttachedMass, ...],
        key(AttachedMass, MASSES, example="[bodies.rod.masses.tip]"),
    ] = ()
    axial: Annotated[
        AxialDeformation | None,
        key(
            AxialDeformation,
            'How the beam stretches: { ansatz = ["xi"], stiffness = 1e6 }, the shapes of the displacement along its '
            "axis and EA in N. By default its axis does not stretch.",
            example='{ ansatz = ["xi"], stiffness = 1e6 }',
        ),
    ] = None
    section: ClassVar[str] = "beam"
    __repr__ = beam_text
    _repr_html_ = html

    @property
    def deflection(self) -> AssumedDeflection:
        """The assumed deflection, from which the shape functions follow."""
        return AssumedDeflection(self.ansatz, self.frame, self.orthogonal, self.ends)

    @property
    def body_name(self) -> str:
        """The name of the only body when the beam is simulated alone as a scene; it differs from that of the scene."""
        return "beam" if self.name.lower() != "beam" else "rod"


BEAM_QUANTITIES = {key.name: key.default for key in declared_keys(PlanarBeam) if isinstance(key.default, Parameter)}
"""The defaults of the physical constants of a beam, by their keys."""
