"""Axial force, shear force and bending moment of a beam, its curvature, and the strain of a fibre.

Section forces follow from the equilibrium of the part of the beam to the right of the section: its inertia, its weight,
and what loads and joints exert on it. With X + u = (X, v) in the body frame, Q^T cddot = (A1, A2) and the angular
velocity w, the acceleration of a material point is, from (5),

    a1 = A1 - wdot v - w^2 X - 2 w vdot,    a2 = A2 + wdot X - w^2 v + vddot.

The bending moment also follows from the curvature, EI d^2v/dx^2. The two agree as far as the shape functions can
represent the deflection, so that their difference shows the quality of the model.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import sympy as sp

from derive.mechanics import quantity
from derive.mechanics.bodies.reference_conditions import assumed_shapes, exact_polynomial, xi
from derive.mechanics.multibody.bodies.beam import CUT, piece_name, place_in_piece
from derive.mechanics.multibody.bodies.beam_loads import density_of_piece
from derive.mechanics.multibody.instances import InstanceEquations
from derive.mechanics.multibody.keys import Key, KeyType
from derive.mechanics.multibody.outputs.output_type import OutputComponent, OutputComponents, OutputType
from derive.mechanics.multibody.scene_mechanics import NOTHING, Resultant, SceneMechanics
from derive.mechanics.symbols import element
from derive.mechanics.terms import ModelConstant
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
            factor = quantity.function(load.time)
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
                lever = rotation * lever
                direction = sp.eye(2)[:, k] if load.frame == "inertial" else rotation[:, k]
                torque = lever[0] * direction[1] - lever[1] * direction[0]
                result += Resultant(factor * total * direction, factor * torque).about(origin, about)
        return result

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
        coordinates, rows = self.instance.coordinates, self.instance.rows
        omega, omegadot = rows[2].v, rows[2].a
        alpha, alphadot, alphaddot = ([c.q for c in coordinates[3:]], [r.v for r in rows[3:]], [r.a for r in rows[3:]])
        rotation = self.rotation
        gravity = sp.Matrix(_gravity(self.scene))
        a1, a2 = rotation.T * (sp.Matrix([rows[0].a, rows[1].a]) - gravity)
        x, shapes = sp.Poly(xi, xi), self.shapes
        mass, first, second = (self._moment(x**n, n, f"moment_{n}") for n in range(3))
        numbers = range(len(shapes))
        of_shape = [self._moment(shapes[i], 0, f"shape_{i + 1}") for i in numbers]
        lever = [self._moment(x * shapes[i], 1, f"lever_{i + 1}") for i in numbers]
        pairs = [
            [self._moment(shapes[i] * shapes[j], 0, f"pair_{min(i, j) + 1}_{max(i, j) + 1}") for j in numbers]
            for i in numbers
        ]

        def summed(factors: list[sp.Expr], amplitudes: list[sp.Symbol]) -> sp.Expr:
            return sp.Add(*(f * a for f, a in zip(factors, amplitudes, strict=True)))

        def product(left: list[sp.Symbol], right: list[sp.Symbol]) -> sp.Expr:
            return sp.Add(*(left[i] * pairs[i][j] * right[j] for i in numbers for j in numbers))

        v, vdot, vddot = (summed(of_shape, of) for of in (alpha, alphadot, alphaddot))
        xvddot = summed(lever, alphaddot)
        force1 = mass * a1 - omegadot * v - omega**2 * first - 2 * omega * vdot
        force2 = mass * a2 + omegadot * first - omega**2 * v + vddot
        # int rho (X a2 - v a1): the centrifugal parts cancel.
        torque = first * a2 + omegadot * second + xvddot - v * a1
        torque += omegadot * product(alpha, alpha) + 2 * omega * product(alpha, alphadot)
        force = rotation * sp.Matrix([force1, force2])
        origin, about = sp.Matrix(self.instance.origin), self.position
        return Resultant(force, torque).about(origin, about)

    def _moment(self, integrand: sp.Poly, power: int, label: str) -> sp.Expr:
        """int rho (l/2)^power integrand over the part to the right of the section."""
        value = self.mass / 2 * (self.length / 2) ** power * self._right(integrand)
        return self._constant(label, value, f"{label} of the part to the right", "")

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


def _gravity(scene: SceneMechanics) -> list[sp.Expr]:
    """The acceleration of free fall in the inertial frame."""
    constants, _ = quantity.gravity(scene.scene.gravity)
    return [c.symbol if c.zero is None else sp.S.Zero for c in constants] or [sp.S.Zero, sp.S.Zero]
