"""Axial force, shear force and bending moment of a beam, its curvature, and the strain of a fibre.

Section forces follow from the equilibrium of the part of the beam to the right of the section: its inertia and its
weight, see `beam_part`, and what loads and joints exert on it.

The bending moment also follows from the curvature, EI d^2v/dx^2. The two agree as far as the shape functions can
represent the deflection, so that their difference shows the quality of the model.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import sympy as sp

from derive.mechanics import quantity
from derive.mechanics.bodies.beam_part import part_body, rigid_rows
from derive.mechanics.bodies.foreshortening import Foreshortening, pairs
from derive.mechanics.bodies.reference_conditions import assumed_shapes, exact_polynomial, xi
from derive.mechanics.expansion import constants_of
from derive.mechanics.multibody.bodies.beam import CUT, piece_name, place_in_piece
from derive.mechanics.multibody.bodies.beam_loads import density_of_piece
from derive.mechanics.multibody.instances import InstanceEquations
from derive.mechanics.multibody.keys import Key, KeyType
from derive.mechanics.multibody.outputs.output_type import OutputComponent, OutputComponents, OutputType
from derive.mechanics.multibody.scene_mechanics import NOTHING, Resultant, SceneMechanics
from derive.mechanics.symbols import element
from derive.mechanics.terms import ModelConstant
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.markers import MarkerRef
from derive.spec.model.scene import BeamBody

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
    """The bending moment about e3, from equilibrium and from the curvature."""

    doc = "bending moment, from equilibrium and from the curvature"
    labels = ("", "curvature")
    keys = (SECTION,)

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """Two components."""
        section = _marked_section(name, scene, values["section"])
        moment, bending = section.resultant().torque, section.bending_stiffness * section.curvature
        where = f"at {values['section']}"
        return OutputComponents(
            (
                OutputComponent("", "N m", f"bending moment {where}, from equilibrium", moment),
                OutputComponent("curvature", "N m", f"bending moment {where}, EI times the curvature", bending),
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
    """The axial strain of a fibre by bending: - height d^2v/dx^2."""

    doc = "axial strain of a fibre of a beam by bending"
    keys = (SECTION, HEIGHT)

    def components(self, name: str, values: Mapping[str, Any], scene: SceneMechanics) -> OutputComponents:
        """One component."""
        section = _marked_section(name, scene, values["section"])
        strain = -values["height"] * section.curvature
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
    _, _, places = _piece(scene, marker.body)
    return BeamSection(name, scene, marker.body, places[marker.marker], scene.position(marker))


class BeamSection:
    """A section of a beam, or of a piece of a rod, with the constants of the output that asks for it."""

    def __init__(self, name: str, scene: SceneMechanics, component: str, at: Fraction, position: sp.Matrix) -> None:
        """component: the beam or the piece; at: the place xi of the section on it; position: that in the scene."""
        self.name, self.scene, self.component, self.at, self.position = name, scene, component, at, position
        self._constants: dict[sp.Symbol, ModelConstant] = {}
        self.rod, self.piece, self.places = _piece(scene, component)
        beam = self.rod.beam
        self.instance: InstanceEquations = scene.instances[component]
        self.shapes = [exact_polynomial(s) for s in assumed_shapes(beam.deflection)]
        self.mass = quantity.value(beam.mass) / self.rod.pieces
        self.length = quantity.value(beam.length) / self.rod.pieces
        self.bending_stiffness = self._constant("stiffness", quantity.value(beam.bending_stiffness), "EI", "N m^2")

    @property
    def constants(self) -> tuple[ModelConstant, ...]:
        """The constants that have been used so far."""
        return tuple(self._constants.values())

    @property
    def curvature(self) -> sp.Expr:
        """d^2v/dx^2."""
        total = sp.S.Zero
        for i, (shape, amplitude) in enumerate(zip(self.shapes, self.instance.coordinates[3:], strict=True), 1):
            value = shape.diff((xi, 2)).eval(sp.Rational(self.at)) * 4 / self.length**2
            total += self._constant(f"curvature_{i}", value, f"curvature of shape {i}", "1/m^2") * amplitude.q
        return total

    def resultant(self) -> Resultant:
        """What the part to the right of the section exerts on the left one; the torque is about the section.

        What acts at the section itself acts on the left part, but for the right end, where it acts on the right one.
        """
        about = self.position

        def on_the_right(marker: MarkerRef) -> bool:
            if marker.body != self.component:
                return False
            if marker.marker not in self.places:
                return False  # the resultant of a distributed load, of which a part may be on the right
            place = self.places[marker.marker]
            return place > self.at or place == 1

        return self.scene.loads(on_the_right, about) + self._distributed() + -self._inertia()

    def _distributed(self) -> Resultant:
        """The distributed loads on the part to the right, with their torque about the section."""
        coordinates, result = self.instance.coordinates, NOTHING
        rotation = self.rotation
        origin, about = sp.Matrix(self.instance.origin), self.position
        half = self.length / 2
        for load in self.rod.loads:
            in_time = quantity.function(load.time)
            for k, of_rod in enumerate(load.force):
                density = density_of_piece(of_rod, self.piece, self.rod.pieces)
                if density.is_zero:
                    continue

                def integral(of: sp.Poly, unit: sp.Expr, label: str, what: str = f"{load.name}_{k + 1}") -> sp.Expr:
                    return self._constant(f"{what}_{label}", unit * self._right(of), f"{label} of load {what}", "")

                total = integral(density, half, "total")
                first = integral(density * sp.Poly(xi, xi), half**2, "first")
                lever = sp.Matrix([first, sp.S.Zero])
                for i, (shape, c) in enumerate(zip(self.shapes, coordinates[3:], strict=True), 1):
                    lever[1] += integral(density * shape, half, f"shape_{i}") * c.q
                for (i, j), psi in self._second.items():
                    factor = sp.S.Half if i == j else sp.S.One
                    shortening = integral(density * psi, half * 2 / self.length, f"psi_{i}_{j}")
                    lever[0] += factor * shortening * coordinates[2 + i].q * coordinates[2 + j].q
                lever = rotation * lever
                direction = sp.eye(2)[:, k] if load.frame == "inertial" else rotation[:, k]
                torque = lever[0] * direction[1] - lever[1] * direction[0]
                result += Resultant(in_time * total * direction, in_time * torque).about(origin, about)
        return result

    @property
    def _second(self) -> Mapping[tuple[int, int], sp.Poly]:
        """psi_ij length/2 for i <= j; empty at first order."""
        beam = self.rod.beam
        if beam.order is DisplacementOrder.FIRST_ORDER:
            return {}
        second = Foreshortening(tuple(self.shapes), beam.frame, self.mass, self.length)
        return {(i, j): second.of(i, j) for i, j in pairs(len(self.shapes))}

    @property
    def rotation(self) -> sp.Matrix:
        """Q of the body."""
        phi = self.instance.coordinates[2].q
        return sp.Matrix([[sp.cos(phi), -sp.sin(phi)], [sp.sin(phi), sp.cos(phi)]])

    def _right(self, integrand: sp.Poly) -> sp.Rational:
        """The integral over xi from the section to the right end."""
        antiderivative = integrand.integrate()
        return antiderivative.eval(1) - antiderivative.eval(sp.Rational(self.at))

    def _inertia(self) -> Resultant:
        """The rate of change of momentum of the part to the right, less its weight; torque about the section."""
        beam, instance = self.rod.beam, self.instance
        gravity, _ = quantity.gravity(self.scene.scene.gravity)
        start = sp.Rational(self.at)
        part = part_body(tuple(self.shapes), beam.frame, beam.order, self.mass, self.length, start, gravity)
        motion = part.motion
        known: dict[sp.Basic, sp.Expr] = {}
        for own, of_instance in zip(motion.coordinates, instance.coordinates, strict=True):
            known[own.q] = of_instance.q
        for own_row, row in zip(motion.rows, instance.rows, strict=True):
            known |= {own_row.v: row.v, own_row.a: row.a}
        for c in constants_of(part):
            if c not in gravity:
                known[c.symbol] = sp.S.Zero if c.zero else self._constant(c.symbol.name, c.value, c.doc, c.unit)
        force1, force2, torque = (row.xreplace(known) for row in rigid_rows(part))
        origin, about = sp.Matrix(instance.origin), self.position
        return Resultant(sp.Matrix([force1, force2]), torque).about(origin, about)

    def _constant(self, label: str, value: sp.Expr, doc: str, unit: str) -> sp.Expr:
        """A number as it is; what depends on parameters as a constant of the model."""
        value = sp.expand(value)
        if value.is_Rational:
            return value
        symbol = element(self.name, label)
        self._constants[symbol] = ModelConstant(symbol, value, "", f"{doc}; output {self.name}", unit)
        return symbol


def _piece(scene: SceneMechanics, component: str) -> tuple[BeamBody, int, dict[str, Fraction]]:
    """The rod of a component, its number in the rod, from 0, and the places xi of the markers on it."""
    for body in scene.scene.bodies:
        if not isinstance(body, BeamBody):
            continue
        n = body.pieces
        for k in range(n):
            if piece_name(body, k) == component:
                own = {m.name: place_in_piece(m.at, n) for m in body.markers}
                return body, k, {**own, CUT[0]: Fraction(-1), CUT[1]: Fraction(1)}
    raise AssertionError(f"{component} is no beam; the specification refuses other bodies")
