"""Outputs that a simulation adds to a scene in space to watch the validity of its bodies; no specification names them.

Those of beams are those of planar beams, in one of the planes in which a beam bends: along its e2 or its e3. A positive
bending moment goes with a positive curvature of the deflection.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from derive.algebra import sp
from derive.mechanics import quantity
from derive.mechanics.bodies.section_fields import Direction
from derive.mechanics.motion.vectors import dot
from derive.mechanics.multibody.bodies.rigid import BODY_FRAME
from derive.mechanics.multibody.outputs.section_forces import SECTION
from derive.mechanics.multibody.space.acting_loads import ACTING_LOAD
from derive.mechanics.multibody.space.output_parts import SpatialComponent, SpatialOutputType, SpatialParts
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.keys import Key, KeyType
from derive.spec.model.markers import MarkerRef
from derive.spec.model.spatial_beam import SpatialBeam

if TYPE_CHECKING:
    from derive.mechanics.multibody.space.beam_section import SpatialBeamSection

AXIS = Key("axis", KeyType.CHOICE, "", "The axis along which the beam deflects, 2 or 3; 1 of torsion.", required=True)
COMPONENT = Key("component", KeyType.CHOICE, "", "The beam, or a piece of it.", required=True)
DIRECTIONS = {2: Direction.ALONG_E2, 3: Direction.ALONG_E3}


def _moment_gap(section: SpatialBeamSection, axis: int) -> sp.Expr:
    """The bending moment from equilibrium less that from the curvature, for axis 1 the twisting moments."""
    about = 1 if axis == 1 else 5 - axis  # a deflection along e2 is bent about e3, one along e3 about -e2
    gap = section.resultant[1][about - 1] - section.moments_of_curvature[about - 1]
    return -gap if axis == 3 else gap


def _shear_gap(section: SpatialBeamSection, axis: int) -> sp.Expr:
    """The derivative of the bending moment from the shear force, less that of the shapes.

    The shear force is across the deformed axis, at first order across that of the floating frame.
    """
    direction = DIRECTIONS[axis]
    stiffness = section.stiffnesses[5 - axis - 1]
    slope = stiffness * section.derivative(direction, 3) + section.damping_moment(direction, 3)
    return -section.resultant[0][axis - 1] - slope


def _gap(doc: str, unit: str, gap: Callable[[SpatialBeamSection, int], sp.Expr]) -> SpatialOutputType:
    def components(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
        from derive.mechanics.multibody.space.beam_section import section_at_marker

        marker = values[SECTION.name]
        beam = next(body for body in parts.scene.bodies if body.name == marker.body)
        assert isinstance(beam, SpatialBeam)
        section = section_at_marker(parts, marker, of_frame=beam.order is DisplacementOrder.FIRST_ORDER)
        expr, text = gap(section, values[AXIS.name]), f"{doc} at {values[SECTION.name]} along e{values[AXIS.name]}"
        return (SpatialComponent("", unit, text, expr, section.constants),)

    return SpatialOutputType(doc, (SECTION, AXIS), ("",), components, of_numbers=True)


def _axial_load(power: int) -> SpatialOutputType:
    """A term N_power xi^power of the axial force of a beam or a piece, see `AxialLoad` of the plane."""
    doc = f"factor of xi^{power} in the axial force" if power else "axial force in the middle"

    def components(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
        from derive.mechanics.multibody.space.beam_section import SpatialBeamSection

        name = values[COMPONENT.name]
        beam = next(body for body in parts.scene.bodies if body.name == name)
        frame, instance = parts.at(MarkerRef(name, BODY_FRAME)), parts.instances[name]
        position, axes = sp.Matrix(frame.position), sp.Matrix(frame.frame)
        section = SpatialBeamSection(f"{name}_middle", parts, beam, Fraction(0), position, axes)  # type: ignore[arg-type]
        mass = section.mass
        match power:
            case 0:
                force = section.resultant[0][0]
            case 1:
                acceleration = sp.Matrix([row.a for row in instance.rows[:3]])
                for axis, fall in enumerate(quantity.gravity(parts.scene.gravity)[0]):
                    acceleration[axis] -= sp.S.Zero if fall.zero else fall.symbol
                half = section.constant("half_mass", mass / 2, "half the mass", "kg")
                force = half * dot(axes[:, 0], acceleration)
            case _:
                inertia = section.constant("spin_inertia", mass * section.length / 8, "m l/8", "kg m")
                force = -inertia * sp.Add(*(row.v**2 for row in instance.rows[4:6]))
        return (SpatialComponent("", "N", f"{doc} of {name}", force, section.constants),)

    return SpatialOutputType(doc, (COMPONENT,), ("",), components, of_numbers=True)


SPATIAL_MONITORS: Mapping[str, SpatialOutputType] = {
    "acting_load": ACTING_LOAD,
    "axial_load": _axial_load(0),
    "axial_load_linear": _axial_load(1),
    "axial_load_quadratic": _axial_load(2),
    "moment_gap": _gap("bending moment from equilibrium, less that from the curvature", "N m", _moment_gap),
    "shear_gap": _gap("derivative of the bending moment, from equilibrium, less that of the shapes", "N", _shear_gap),
}
"""The kinds of these outputs by their names."""
