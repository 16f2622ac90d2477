"""Axial force, shear force and bending moment of a beam, its curvature, and the strain of a fibre.

See `BeamSection` for the two ways in which the bending moment is computed.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from derive.algebra import sp
from derive.mechanics import quantity
from derive.mechanics.multibody.outputs.output_type import NamedElements, OutputComponent, OutputComponents, OutputType
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.keys import Key, KeyType
from derive.spec.model.markers import MarkerRef

if TYPE_CHECKING:
    from derive.mechanics.multibody.outputs.beam_section import BeamSection
    from derive.mechanics.multibody.scene_mechanics import SceneMechanics

SECTION = Key("section", KeyType.BEAM_MARKER, "", 'A marker of a beam, such as "rod.middle".', required=True)
HEIGHT = Key(
    "height", KeyType.QUANTITY, "m", "Distance of the fibre from the neutral axis, along e2 of the beam, m.", True
)


class SectionForce(OutputType):
    """A component of the force that the part to the right of a section exerts on the left part."""

    keys = (SECTION,)

    def __init__(self, doc: str, axis: int) -> None:
        self.doc, self.axis = doc, axis

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return the component along the tangent (axial force) or along the normal of the section (shear force)."""
        section = _marked_section(name, scene, values["section"])
        resultant = section.resultant()
        angle = scene.point(values["section"]).rotation
        axes = ((sp.cos(angle), sp.sin(angle)), (-sp.sin(angle), sp.cos(angle)))
        force = sp.Matrix(axes[self.axis]).dot(resultant.force)
        return OutputComponents((OutputComponent("", "N", force),), section.constants)

    def descriptions(self, values: Mapping[str, Any], mechanism: NamedElements) -> tuple[str, ...]:
        """Return the force and the section."""
        return (f"{self.doc} at {values['section']}, from equilibrium",)


class BendingMoment(OutputType):
    """The bending moment about e3, from equilibrium, and from the curvature and its rate."""

    doc = "bending moment, from equilibrium and from the curvature"
    labels = ("", "curvature")
    keys = (SECTION,)

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return two components: the bending moment from equilibrium, and that from the curvature and its rate."""
        section = _marked_section(name, scene, values["section"])
        moment = section.resultant().torque
        bending = section.bending_stiffness * section.curvature + section.damping_moment
        components = OutputComponent("", "N m", moment), OutputComponent("curvature", "N m", bending)
        return OutputComponents(components, section.constants)

    def descriptions(self, values: Mapping[str, Any], mechanism: NamedElements) -> tuple[str, ...]:
        """Return the section, and what each of the two moments follows from."""
        from derive.mechanics.multibody.outputs.beam_section import piece_of_component

        moment = f"bending moment at {values['section']}"
        rod, _, _ = piece_of_component(mechanism.scene, values["section"].body)
        damped = " with the damping of the material" if rod.beam.damping else ""
        return f"{moment}, from equilibrium", f"{moment}, EI times the curvature{damped}"


class _Gap(OutputType):
    """The base class of outputs that compare a section force from equilibrium with that of the shapes."""

    def descriptions(self, values: Mapping[str, Any], mechanism: NamedElements) -> tuple[str, ...]:
        """Return the gap and the section."""
        return (f"{self.doc} at {values['section']}",)


class MomentGap(_Gap):
    """The bending moment from equilibrium less that from the curvature: the error of the shapes at a section."""

    doc = "bending moment from equilibrium, less that from the curvature"
    keys = (SECTION,)

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return one component, the gap."""
        moments = BendingMoment().components(name, values, scene)
        equilibrium, bending = (c.expr for c in moments.components)
        return OutputComponents((OutputComponent("", "N m", equilibrium - bending),), moments.constants)


class ShearGap(_Gap):
    """The derivative of the bending moment from the shear force in equilibrium, less that of the shapes.

    The shear force is across the deformed axis; at first order, which does not know how an axial force acts on slopes,
    across e1 of the floating frame.
    """

    doc = "derivative of the bending moment, from the shear force in equilibrium, less that of the shapes"
    keys = (SECTION,)

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return one component, the gap."""
        section = _marked_section(name, scene, values["section"])
        first = section.rod.beam.order is DisplacementOrder.FIRST_ORDER
        angle = section.instance.coordinates[2].q if first else scene.point(values["section"]).rotation
        shear = sp.Matrix([-sp.sin(angle), sp.cos(angle)]).dot(section.resultant().force)
        gap = -shear - section.bending_stiffness * section.curvature_slope - section.damping_moment_slope
        return OutputComponents((OutputComponent("", "N", gap),), section.constants)


class Curvature(OutputType):
    """The curvature d^2v/dx^2 of a beam at a section."""

    doc = "curvature of a beam"
    keys = (SECTION,)

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return one component, the curvature."""
        section = _marked_section(name, scene, values["section"])
        curvature = section.curvature
        return OutputComponents((OutputComponent("", "1/m", curvature),), section.constants)

    def descriptions(self, values: Mapping[str, Any], mechanism: NamedElements) -> tuple[str, ...]:
        """Return the section."""
        return (f"curvature at {values['section']}",)


class Strain(OutputType):
    """The axial strain of a fibre: the strain of the axis, if the beam stretches, less height d^2v/dx^2."""

    doc = "axial strain of a fibre of a beam"
    keys = (SECTION, HEIGHT)

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return one component, the strain."""
        section = _marked_section(name, scene, values["section"])
        strain = section.axial_strain - values["height"] * section.curvature
        return OutputComponents((OutputComponent("", "", strain),), section.constants)

    def descriptions(self, values: Mapping[str, Any], mechanism: NamedElements) -> tuple[str, ...]:
        """Return the section."""
        return (f"strain of a fibre at {values['section']}",)


class AxialLoad(OutputType):
    """A term of the axial force of a beam or a piece as its inertia distributes it, which monitors compare with its EI.

    Along e1 of the floating frame, N(xi) = N_0 + N_1 xi + N_2 xi^2: from equilibrium in the middle, and with the
    acceleration of the frame along e1, less that of free fall, and its angular velocity. This is the inertia of a
    slender beam; distributed loads along it are left out of N_1 and N_2.
    """

    keys = (Key("component", KeyType.CHOICE, "", "The beam, or a piece of it.", required=True),)

    def __init__(self, power: int) -> None:
        """power: the exponent of xi in the term of N."""
        self.power = power
        self.doc = f"factor of xi^{power} in the axial force of" if power else "axial force in the middle of"

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Return one component, the factor N_power."""
        from derive.mechanics.multibody.outputs.beam_section import BeamSection

        component = values["component"]
        instance = scene.instances[component]
        section = BeamSection(name, scene, component, Fraction(0), sp.Matrix(instance.origin))
        along = section.rotation[:, 0]
        match self.power:
            case 0:
                force = along.dot(section.resultant().force)
            case 1:
                acceleration = sp.Matrix([row.a for row in instance.rows[:2]])
                for axis, fall in enumerate(quantity.gravity(scene.scene.gravity)[0]):
                    acceleration[axis] -= sp.S.Zero if fall.zero else fall.symbol
                force = section.constant("inertia", section.mass / 2, "half the mass", "kg") * along.dot(acceleration)
            case _:
                inertia = section.mass * section.length / 8
                force = -section.constant("inertia", inertia, "m l/8", "kg m") * instance.rows[2].v ** 2
        return OutputComponents((OutputComponent("", "N", force),), section.constants)

    def descriptions(self, values: Mapping[str, Any], mechanism: NamedElements) -> tuple[str, ...]:
        """Return the term and the component."""
        return (f"{self.doc} {values['component']}",)


def _marked_section(name: str, scene: SceneMechanics, marker: MarkerRef) -> BeamSection:
    """The section of a beam at a marker."""
    from derive.mechanics.multibody.outputs.beam_section import BeamSection, piece_of_component

    _, _, places = piece_of_component(scene.scene, marker.body)
    return BeamSection(name, scene, marker.body, places[marker.marker], scene.position(marker))
