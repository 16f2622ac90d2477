"""The tables of a beam as pydantic models."""

from __future__ import annotations

from typing import Annotated

from pydantic import ConfigDict, Field, PlainValidator, WithJsonSchema, model_validator

from derive.spec.model.body import (
    DEFAULT_BENDING_STIFFNESS,
    DEFAULT_LENGTH,
    DEFAULT_MASS,
    DisplacementOrder,
    Marker,
    PlanarBeam,
)
from derive.spec.model.quantity import Parameter, Quantity
from derive.spec.parsing import choices, values
from derive.spec.tables.beam_parts import AttachedMassTable, AxialTable, BeamPosition
from derive.spec.tables.beam_shapes import ShapeFamilyTable, ShapeKeys
from derive.spec.tables.damping import BeamDampingTable
from derive.spec.tables.markers import MAX_NAMED, few_named
from derive.spec.tables.shared import MAX_MARKERS, Name, ParameterTable, QuantityInput, few_markers, quantity


def _as_table(parameter: Parameter) -> ParameterTable:
    return ParameterTable(symbol=parameter.symbol, unit=parameter.unit, default=parameter.default)


class BeamKeys(ShapeKeys):
    """The keys of a beam, whether it is free or part of a scene."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    mass: Annotated[
        QuantityInput, Field(description="Mass, kg: a run-time parameter, or a number that is folded into the code.")
    ] = _as_table(DEFAULT_MASS)
    length: Annotated[QuantityInput, Field(description="Length, m: a run-time parameter or a number.")] = _as_table(
        DEFAULT_LENGTH
    )
    bending_stiffness: Annotated[
        QuantityInput,
        Field(
            description="Bending stiffness EI, N m^2: a run-time parameter or a number. Rotary inertia of the "
            "cross-sections and shear deformation are left out at either order."
        ),
    ] = _as_table(DEFAULT_BENDING_STIFFNESS)
    axial: Annotated[
        AxialTable | None,
        Field(
            description='How the beam stretches: { ansatz = ["xi"], stiffness = 1e6 }, the shapes of the displacement '
            "along its axis and EA in N. By default its axis does not stretch."
        ),
    ] = None
    damping: Annotated[
        BeamDampingTable | None,
        Field(
            description="Damping of the deformation: { ratio = 0.01 } of critical in each free mode of the beam, or "
            "{ mass = 0.1, stiffness = 1e-5 }, factors of its mass and stiffness matrices, in 1/s and s."
        ),
    ] = None
    masses: Annotated[
        dict[Name, AttachedMassTable],
        few_named("masses", "[bodies.rod.masses.tip]"),
        Field(
            description="Attached masses by name: rigid bodies that are fixed to sections of the beam. The conditions "
            "of the frame and the damping are those of the beam without them.",
            json_schema_extra={"maxProperties": MAX_NAMED, "additionalProperties": False},
        ),
    ] = {}  # noqa: RUF012
    markers: Annotated[
        dict[Name, BeamPosition],
        few_markers("places"),
        Field(
            description="Named points of the beam and their positions xi, from -1 (left end) to 1 (right end).",
            json_schema_extra={"maxProperties": MAX_MARKERS, "additionalProperties": False},
        ),
    ] = {}  # noqa: RUF012

    order: Annotated[
        int,
        PlainValidator(values.order),
        WithJsonSchema({"enum": [1, 2]}),
        Field(
            description="The order of the displacements in the amplitudes: 1 as in the paper, where a fast-spinning "
            "beam softens and no beam buckles; 2 with the shortening of a beam that bends.",
            json_schema_extra={"default": 1},
        ),
    ] = 1
    terms: Annotated[
        str | None,
        PlainValidator(choices.second_order_terms),
        WithJsonSchema({"enum": [*choices.SECOND_ORDER_TERMS]}),
        Field(
            description="What a beam of order 2 keeps: truncated (kinetic and potential energy through second order in "
            "the amplitudes), full (all that the displacements yield; the mass matrix is always positive definite). "
            "By default truncated in the frames mean, chord and given, and full in the frames point and tangent."
        ),
    ] = None

    @model_validator(mode="after")
    def check_ends(self) -> BeamKeys:
        """Refuse `ends` beside a family of shapes, which fulfils conditions at the ends by itself."""
        if self.ends is not None and isinstance(self.ansatz, ShapeFamilyTable):
            raise values.WrongValueError(
                f"`ends` is for polynomials; {self.ansatz.kind} shapes fulfil conditions of their own; leave it out"
            )
        return self

    @model_validator(mode="after")
    def check_axial(self) -> BeamKeys:
        """Refuse a preload at first order, and rotary inertia of masses in the full model of a beam that stretches."""
        if self.axial is None:
            return self
        if self.order == 1 and self.axial.preload != 0:
            raise values.WrongValueError(
                "a preload stiffens a beam through the strain of second order; write order = 2, or leave `preload` out"
            )
        turning = [name for name, mass in self.masses.items() if mass.inertia != 0]
        if turning and self.displacement_order() is DisplacementOrder.FULL:
            raise values.WrongValueError(
                f"the full model of a beam that stretches takes no rotary inertia of attached masses ({turning[0]}); "
                'write terms = "truncated", or leave `inertia` out'
            )
        return self

    @model_validator(mode="after")
    def check_terms(self) -> BeamKeys:
        """Refuse a choice of terms for a beam of first order."""
        if self.order == 1 and self.terms is not None:
            raise values.WrongValueError(
                f'terms = "{self.terms}" is for beams of order 2; write order = 2 beside it, or leave it out'
            )
        return self

    def displacement_order(self) -> DisplacementOrder:
        """The order of the displacements, with the terms that are kept."""
        if self.order == 1:
            return DisplacementOrder.FIRST_ORDER
        terms = self.terms or ("full" if self.deflection().frame.kind in ("point", "tangent") else "truncated")
        return DisplacementOrder.FULL if terms == "full" else DisplacementOrder.TRUNCATED

    def planar_beam(self, name: str, gravity: tuple[Quantity, Quantity] | None = None) -> PlanarBeam:
        """The model of the beam that the derivation takes."""
        deflection = self.deflection()
        return PlanarBeam(
            name=name,
            ansatz=deflection.ansatz,
            frame=deflection.frame,
            mass=quantity(self.mass, DEFAULT_MASS.unit),
            length=quantity(self.length, DEFAULT_LENGTH.unit),
            bending_stiffness=quantity(self.bending_stiffness, DEFAULT_BENDING_STIFFNESS.unit),
            markers=tuple(Marker(name, at) for name, at in self.markers.items()),
            orthogonal=deflection.orthogonal,
            gravity=gravity,
            damping=None if self.damping is None else self.damping.damping(),
            order=self.displacement_order(),
            ends=deflection.ends,
            masses=tuple(table.attached_mass(name) for name, table in self.masses.items()),
            axial=None if self.axial is None else self.axial.axial(),
        )
