"""The tables of what belongs to a beam besides its shape: its damping, and the masses that are attached to it."""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated

from pydantic import Field, PlainValidator, WithJsonSchema, model_validator

from derive.spec.model.body import DEFAULT_MASS, AttachedMass, BeamDamping
from derive.spec.model.quantity import Quantity
from derive.spec.parsing import values
from derive.spec.tables.body import check_damping
from derive.spec.tables.shared import NotNegativeInput, QuantityInput, TomlTable, number_schema, quantity

BEAM_POSITION = number_schema(minimum=-1, maximum=1)
"""What an editor accepts for a position xi."""
DAMPING_UNITS = {"ratio": "1", "mass": "1/s", "stiffness": "s"}
"""The constants of the damping of a beam, with the units of parameters."""
MASS_UNITS = {"mass": DEFAULT_MASS.unit, "inertia": "kg m^2"}
"""The constants of an attached mass, with the units of parameters."""

BeamPosition = Annotated[Fraction, PlainValidator(values.beam_position), WithJsonSchema(BEAM_POSITION)]


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
