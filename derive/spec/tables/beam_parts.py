"""The tables of what belongs to a beam besides its shape: how it stretches, its damping, and attached masses."""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated

from pydantic import Field, PlainValidator, WithJsonSchema, model_validator

from derive.spec.model.body import DEFAULT_MASS, AttachedMass, AxialDeformation, BeamDamping
from derive.spec.model.quantity import Quantity
from derive.spec.parsing import values
from derive.spec.tables.beam_shapes import BEAM_POSITION, Polynomials
from derive.spec.tables.body import check_damping
from derive.spec.tables.shared import NotNegativeInput, QuantityInput, SignedInput, TomlTable, quantity

DAMPING_UNITS = {"ratio": "1", "mass": "1/s", "stiffness": "s"}
"""The constants of the damping of a beam, with the units of parameters."""
MASS_UNITS = {"mass": DEFAULT_MASS.unit, "inertia": "kg m^2"}
"""The constants of an attached mass, with the units of parameters."""

AXIAL_UNITS = {"stiffness": "N", "preload": "N"}
"""The constants of how a beam stretches, with the units of parameters."""

BeamPosition = Annotated[Fraction, PlainValidator(values.beam_position), WithJsonSchema(BEAM_POSITION)]


class AxialTable(TomlTable):
    """How a beam stretches. Without this table its axis keeps its length, to the order of its displacements."""

    ansatz: Annotated[
        Polynomials,
        Field(
            description="Polynomials in xi whose sum is the displacement along the axis, before the condition of the "
            "frame takes a constant from each: no mean displacement, none at the point of the frame, or opposite ones "
            'at the ends of a chord. ["xi"] is a uniform strain.'
        ),
    ]
    stiffness: Annotated[QuantityInput, Field(description="Axial stiffness EA, N: a run-time parameter or a number.")]
    preload: Annotated[
        SignedInput,
        Field(
            description="Axial force of the straight beam of the given length, N, positive in tension; for beams of "
            "order 2."
        ),
    ] = Fraction(0)

    def axial(self) -> AxialDeformation:
        """The deformation as the derivation takes it."""
        stiffness, preload = (quantity(getattr(self, key), unit) for key, unit in AXIAL_UNITS.items())
        return AxialDeformation(self.ansatz, stiffness, preload)


class BeamDampingTable(TomlTable):
    """Damping of the deformation of a beam: a fraction of critical damping, or proportional to mass and stiffness.

    It is that of the beam without attached masses, and the same in every frame.
    """

    ratio: Annotated[
        NotNegativeInput | None, Field(description="Fraction of critical damping of each free mode, such as 0.01.")
    ] = None
    mass: Annotated[
        NotNegativeInput | None,
        Field(description="Factor of the mass matrix of the deformation, without rigid motion, 1/s."),
    ] = None
    stiffness: Annotated[NotNegativeInput | None, Field(description="Factor of the stiffness matrix, s.")] = None

    @model_validator(mode="after")
    def check(self) -> BeamDampingTable:
        """The keys exclude each other."""
        check_damping(self.ratio, self.mass, self.stiffness)
        return self

    def damping(self) -> BeamDamping:
        """The damping that the table describes."""
        return BeamDamping(*(self._quantity(key) for key in DAMPING_UNITS))

    def _quantity(self, key: str) -> Quantity:
        value = getattr(self, key)
        return Fraction(0) if value is None else quantity(value, DAMPING_UNITS[key])


class AttachedMassTable(TomlTable):
    """A small rigid body that is fixed to the section of a beam, with its centre of mass on the axis."""

    at: Annotated[BeamPosition, Field(description="Position xi, from -1 (left end) to 1 (right end).")]
    mass: Annotated[QuantityInput, Field(description="Mass, kg.")]
    inertia: Annotated[NotNegativeInput, Field(description="Moment of inertia about its centre of mass, kg m^2.")] = (
        Fraction(0)
    )

    def attached_mass(self, name: str) -> AttachedMass:
        """The mass as the derivation takes it."""
        mass, inertia = (quantity(getattr(self, key), unit) for key, unit in MASS_UNITS.items())
        return AttachedMass(name, self.at, mass, inertia)
