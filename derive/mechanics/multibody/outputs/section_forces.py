"""Axial force, shear force and bending moment of a beam, its curvature, and the strain of a fibre.

See `BeamSection` for the two ways in which the bending moment is computed.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import sympy as sp

from derive.mechanics.multibody.keys import Key, KeyType
from derive.mechanics.multibody.outputs.beam_section import BeamSection, piece_of_component
from derive.mechanics.multibody.outputs.output_type import OutputComponent, OutputComponents, OutputType
from derive.mechanics.multibody.scene_mechanics import SceneMechanics
from derive.spec.model.markers import MarkerRef

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
        """The component along the tangent (axial force) or along the normal of the section (shear force)."""
        section = _marked_section(name, scene, values["section"])
        resultant = section.resultant()
        angle = scene.point(values["section"]).rotation
        axes = ((sp.cos(angle), sp.sin(angle)), (-sp.sin(angle), sp.cos(angle)))
        force = sp.Matrix(axes[self.axis]).dot(resultant.force)
        doc = f"{self.doc} at {values['section']}, from equilibrium"
        return OutputComponents((OutputComponent("", "N", doc, force),), section.constants)


class BendingMoment(OutputType):
    """The bending moment about e3, from equilibrium, and from the curvature and its rate."""

    doc = "bending moment, from equilibrium and from the curvature"
    labels = ("", "curvature")
    keys = (SECTION,)

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Two components."""
        section = _marked_section(name, scene, values["section"])
        moment = section.resultant().torque
        bending = section.bending_stiffness * section.curvature + section.damping_moment
        where = f"at {values['section']}"
        damped = " with the damping of the material" if section.rod.beam.damping else ""
        return OutputComponents(
            (
                OutputComponent("", "N m", f"bending moment {where}, from equilibrium", moment),
                OutputComponent("curvature", "N m", f"bending moment {where}, EI times the curvature{damped}", bending),
            ),
            section.constants,
        )


class Curvature(OutputType):
    """d^2v/dx^2 at a section."""

    doc = "curvature of a beam"
    keys = (SECTION,)

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """One component."""
        section = _marked_section(name, scene, values["section"])
        curvature = section.curvature
        doc = f"curvature at {values['section']}"
        return OutputComponents((OutputComponent("", "1/m", doc, curvature),), section.constants)


class Strain(OutputType):
    """The axial strain of a fibre: that of the axis, if the beam stretches, - height d^2v/dx^2."""

    doc = "axial strain of a fibre of a beam"
    keys = (SECTION, HEIGHT)

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """One component."""
        section = _marked_section(name, scene, values["section"])
        strain = section.axial_strain - values["height"] * section.curvature
        doc = f"strain of a fibre at {values['section']}"
        return OutputComponents((OutputComponent("", "", doc, strain),), section.constants)


class AxialLoad(OutputType):
    """The force along e1 of the floating frame in the middle of a beam or of a piece: what monitors compare with EI."""

    doc = "axial force in the middle of a beam"
    keys = (Key("component", KeyType.CHOICE, "", "The beam, or a piece of it.", required=True),)

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """One component."""
        component = values["component"]
        section = BeamSection(name, scene, component, Fraction(0), sp.Matrix(scene.instances[component].origin))
        force = section.rotation[:, 0].dot(section.resultant().force)
        doc = f"axial force in the middle of {component}, from equilibrium"
        return OutputComponents((OutputComponent("", "N", doc, force),), section.constants)


def _marked_section(name: str, scene: SceneMechanics, marker: MarkerRef) -> BeamSection:
    """The section at a marker."""
    _, _, places = piece_of_component(scene, marker.body)
    return BeamSection(name, scene, marker.body, places[marker.marker], scene.position(marker))
