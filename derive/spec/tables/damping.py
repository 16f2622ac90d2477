"""The tables of damping: of a body given by its modes, and of a beam."""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated

from pydantic import Field, model_validator

from derive.spec.model.body import BeamDamping, Damping
from derive.spec.model.quantity import Quantity
from derive.spec.parsing import values
from derive.spec.tables.shared import NotNegative, NotNegativeInput, TomlTable, quantity

DAMPING_UNITS = {"ratio": "1", "mass": "1/s", "stiffness": "s"}
"""The constants of the damping of a beam, with the units of parameters."""


def check_damping(ratio: object, mass: object, stiffness: object) -> None:
    """Raise WrongValueError unless damping is given either by a ratio or by factors of mass and stiffness."""
    proportional = mass is not None or stiffness is not None
    if (ratio is not None) == proportional:
        raise values.WrongValueError(
            "write either { ratio = 0.01 }, of critical damping, or { mass = 0.1, stiffness = 1e-5 }, in 1/s and s"
        )


class DampingTable(TomlTable):
    """Viscous damping: a fraction of critical damping, or proportional to mass and stiffness."""

    ratio: Annotated[
        NotNegative | None, Field(description="Fraction of critical damping of each mode, such as 0.01.")
    ] = None
    mass: Annotated[NotNegative | None, Field(description="Factor of the mass matrix, 1/s.")] = None
    stiffness: Annotated[NotNegative | None, Field(description="Factor of the stiffness matrix, s.")] = None

    @model_validator(mode="after")
    def check(self) -> DampingTable:
        """Refuse keys that exclude each other."""
        check_damping(self.ratio, self.mass, self.stiffness)
        return self

    def damping(self) -> Damping:
        """The damping that the table describes."""
        return Damping(*(value or Fraction(0) for value in (self.ratio, self.mass, self.stiffness)))


class BeamDampingTable(TomlTable):
    """Damping of the deformation of a beam: a fraction of critical damping, or proportional to mass and stiffness.

    It is that of the whole beam without attached masses, the same in every frame and in any number of pieces; rigid
    motion is not damped.
    """

    ratio: Annotated[
        NotNegativeInput | None, Field(description="Fraction of critical damping of each free mode, such as 0.01.")
    ] = None
    mass: Annotated[
        NotNegativeInput | None,
        Field(
            description="Factor of the mass matrix of the deformation, 1/s: forces against the velocity relative to "
            "the mean frame of the whole beam."
        ),
    ] = None
    stiffness: Annotated[NotNegativeInput | None, Field(description="Factor of the stiffness matrix, s.")] = None

    @model_validator(mode="after")
    def check(self) -> BeamDampingTable:
        """Refuse keys that exclude each other."""
        check_damping(self.ratio, self.mass, self.stiffness)
        return self

    def damping(self) -> BeamDamping:
        """The damping that the table describes."""
        return BeamDamping(*(self._quantity(key) for key in DAMPING_UNITS))

    def _quantity(self, key: str) -> Quantity:
        value = getattr(self, key)
        return Fraction(0) if value is None else quantity(value, DAMPING_UNITS[key])
