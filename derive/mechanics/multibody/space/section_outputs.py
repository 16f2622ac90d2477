"""Outputs of sections of beams in space: forces and moments, curvatures, the twist, and the strain of a fibre.

Components are along the axes of the section: e1 is the tangent, e2 and e3 turn with the section. See
`SpatialBeamSection` for the two ways in which moments are computed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeAlias

from derive.mechanics import quantity
from derive.mechanics.bodies.section_fields import Direction
from derive.mechanics.multibody.outputs.section_forces import HEIGHT, SECTION
from derive.mechanics.multibody.space.output_parts import SpatialComponent, SpatialOutputType, SpatialParts
from derive.spec.model.keys import Key, KeyType

if TYPE_CHECKING:
    from derive.algebra import sp
    from derive.mechanics.multibody.space.beam_section import SpatialBeamSection

WIDTH = Key("width", KeyType.QUANTITY, "m", "Distance of the fibre from the axis along e3 of the beam, m.", shown=0)
FIBRE = replace(HEIGHT, description="Distance of the fibre from the axis along e2 of the beam, m.")
Numbers: TypeAlias = "Callable[[SpatialBeamSection, Mapping[str, Any]], tuple[sp.Expr, ...]]"
"""The numbers of an output of a section."""


def _of_section(doc: str, unit: str, parts: Mapping[str, str], numbers: Numbers, *keys: Key) -> SpatialOutputType:
    """The type of an output of a section; parts: the descriptions of its components by their labels."""

    def components(values: Mapping[str, Any], of: SpatialParts) -> tuple[SpatialComponent, ...]:
        from derive.mechanics.multibody.space.beam_section import section_at_marker

        section = section_at_marker(of, values[SECTION.name])
        found = numbers(section, values)
        known, at = section.constants, f"at {values[SECTION.name]}"
        labelled = zip(parts.items(), found, strict=True)
        return tuple(SpatialComponent(label, unit, f"{text} {at}", expr, known) for (label, text), expr in labelled)

    return SpatialOutputType(doc, (SECTION, *keys), tuple(parts), components, of_numbers=True)


def _axial_force(section: SpatialBeamSection, _: Mapping[str, Any]) -> tuple[sp.Expr, ...]:
    return (section.resultant[0][0],)


def _shear_force(section: SpatialBeamSection, _: Mapping[str, Any]) -> tuple[sp.Expr, ...]:
    return tuple(section.resultant[0][1:])


def _twisting_moment(section: SpatialBeamSection, _: Mapping[str, Any]) -> tuple[sp.Expr, ...]:
    return section.resultant[1][0], section.moments_of_curvature[0]


def _bending_moment(section: SpatialBeamSection, _: Mapping[str, Any]) -> tuple[sp.Expr, ...]:
    return (*section.resultant[1][1:], *section.moments_of_curvature[1:])


def _twist(section: SpatialBeamSection, _: Mapping[str, Any]) -> tuple[sp.Expr, ...]:
    return (section.derivative(Direction.TORSION, 0),)


def _strain(section: SpatialBeamSection, values: Mapping[str, Any]) -> tuple[sp.Expr, ...]:
    """The strain u' - height kappa_3 + width kappa_2 of a fibre."""
    height, width = (quantity.value(values.get(key.name, 0), positive=False) for key in (FIBRE, WIDTH))
    _, second, third = section.curvatures
    y, z = section.constant("height", height, "height of a fibre", "m"), section.constant("width", width, "", "m")
    return (section.derivative(Direction.AXIAL, 1) - y * third + z * second,)


SECTION_OUTPUTS: Mapping[str, SpatialOutputType] = {
    "axial_force": _of_section(
        "axial force of a beam, positive in tension", "N", {"": "axial force, from equilibrium,"}, _axial_force
    ),
    "shear_force": _of_section(
        "shear force of a beam along e2 and e3 of the section",
        "N",
        {str(k): f"shear force along e{k} of the section, from equilibrium," for k in (2, 3)},
        _shear_force,
    ),
    "twisting_moment": _of_section(
        "twisting moment of a beam, from equilibrium and from the rate of twist",
        "N m",
        {"": "twisting moment, from equilibrium,", "twist": "twisting moment, GJ times the rate of twist,"},
        _twisting_moment,
    ),
    "bending_moment": _of_section(
        "bending moments of a beam about e2 and e3 of the section, from equilibrium and from the curvatures",
        "N m",
        {str(k): f"bending moment about e{k} of the section, from equilibrium," for k in (2, 3)}
        | {f"curvature{k}": f"bending moment about e{k} of the section, EI times the curvature," for k in (2, 3)},
        _bending_moment,
    ),
    "curvature": _of_section(
        "rate of twist of a beam, and its curvatures about e2 and e3 of the section",
        "1/m",
        {"1": "rate of twist", "2": "curvature about e2 of the section", "3": "curvature about e3 of the section"},
        lambda section, _: section.curvatures,
    ),
    "twist": _of_section(
        "angle of twist of a beam against its floating frame", "rad", {"": "angle of twist of the section"}, _twist
    ),
    "strain": _of_section("axial strain of a fibre of a beam", "", {"": "strain of a fibre"}, _strain, FIBRE, WIDTH),
}
"""The kinds of outputs of sections of beams."""
