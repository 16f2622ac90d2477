"""The tables of the parts of a beam besides its shape: stretching, damping, and attached masses."""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated

from pydantic import Field, PlainValidator, WithJsonSchema

from derive.spec.model.body import DEFAULT_MASS, AttachedMass, AxialDeformation
from derive.spec.parsing import values
from derive.spec.tables.beam_shapes import BEAM_POSITION, Polynomials
from derive.spec.tables.shared import NotNegativeInput, QuantityInput, SignedInput, TomlTable, quantity

MASS_UNITS = {"mass": DEFAULT_MASS.unit, "inertia": "kg m^2"}
"""The constants of an attached mass, with the units of parameters."""

AXIAL_UNITS = {"stiffness": "N", "preload": "N"}
"""The constants of the stretching of a beam, with the units of parameters."""

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
        """The model of the deformation that the derivation takes."""
        stiffness, preload = (quantity(getattr(self, key), unit) for key, unit in AXIAL_UNITS.items())
        return AxialDeformation(self.ansatz, stiffness, preload)


class AttachedMassTable(TomlTable):
    """A small rigid body that is fixed to the section of a beam, with its centre of mass on the axis."""

    at: Annotated[BeamPosition, Field(description="Position xi, from -1 (left end) to 1 (right end).")]
    mass: Annotated[QuantityInput, Field(description="Mass, kg.")]
    inertia: Annotated[NotNegativeInput, Field(description="Moment of inertia about its centre of mass, kg m^2.")] = (
        Fraction(0)
    )

    def attached_mass(self, name: str) -> AttachedMass:
        """The model of the mass that the derivation takes."""
        mass, inertia = (quantity(getattr(self, key), unit) for key, unit in MASS_UNITS.items())
        return AttachedMass(name, self.at, mass, inertia)
