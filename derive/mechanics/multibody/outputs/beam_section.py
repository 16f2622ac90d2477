"""A section of a beam: its curvature, and the force and the moment that the part to the right of it exerts.

Section forces follow from the equilibrium of the part of the beam to the right of the section: its inertia and its
weight, see `beam_part`, and what loads and joints exert on it.

The bending moment also follows from the curvature, EI d^2v/dx^2. The damping of a beam is one of its material: it acts
on the deformation as a further bending moment, that of the amplitudes K^-1 B alphadot, whose elastic forces are the
damping forces. With proportional damping by the stiffness alone, B = beta K, this is Kelvin's and Voigt's law
EI (w'' + beta w''dot). The two moments then do the same work on every shape function, and agree as far as the
curvatures of the shapes can represent the moment, so that their difference shows the quality of the model.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics import quantity
from derive.mechanics.bodies.attached_masses import located_masses
from derive.mechanics.bodies.beam_damping import retardation_times
from derive.mechanics.bodies.beam_functions import XI, BeamFunction, rational
from derive.mechanics.bodies.beam_part import part_body
from derive.mechanics.bodies.displacement_fields import displacement_fields
from derive.mechanics.bodies.foreshortening import Foreshortening, pairs
from derive.mechanics.bodies.reference_conditions import on_piece
from derive.mechanics.expansion import rigid_rows
from derive.mechanics.multibody.bodies.beam import masses_of_piece, piece_name
from derive.mechanics.multibody.scene_mechanics import NOTHING, Resultant, SceneMechanics
from derive.mechanics.multibody.section_values import SectionValues
from derive.spec.model.beam_pieces import CUT, place_in_piece
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.markers import MarkerRef
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.scene import Scene

if TYPE_CHECKING:
    pass


class BeamSection(SectionValues):
    """A section of a beam, or of a piece of a rod, with the constants of the output that asks for it."""

    def __init__(self, name: str, scene: SceneMechanics, component: str, at: Fraction, position: sp.Matrix) -> None:
        """component: the beam or the piece; at: the xi of the section on it; position: its inertial position."""
        super().__init__(name, "output", scene.instances[component])
        self.scene, self.component, self.at, self.position = scene, component, at, position
        self.rod, self.piece, self.places = piece_of_component(scene.scene, component)
        beam = self.rod.beam
        self.shapes = displacement_fields(beam)
        self.mass = quantity.value(beam.mass) / self.rod.pieces
        self.length = quantity.value(beam.length) / self.rod.pieces
        self.bending_stiffness = self.constant("stiffness", quantity.value(beam.bending_stiffness), "EI", "N m^2")

    @property
    def curvature(self) -> sp.Expr:
        """The curvature d^2v/dx^2."""
        return self._bent(2, "curvature", "curvature", "1/m^2")

    @property
    def curvature_slope(self) -> sp.Expr:
        """The derivative of the curvature, d^3v/dx^3."""
        return self._bent(3, "curvature_slope", "derivative of the curvature", "1/m^3")

    def _bent(self, order: int, label: str, doc: str, unit: str) -> sp.Expr:
        """A derivative of the deflection along the axis."""
        total = sp.S.Zero
        for i, value in self._derivatives(order).items():
            factor = self.constant(f"{label}_{i}", value, f"{doc} of shape {i}", unit)
            total += factor * self.instance.coordinates[2 + i].q
        return total

    @property
    def axial_strain(self) -> sp.Expr:
        """The strain of the axis; zero if the beam does not stretch."""
        total = sp.S.Zero
        for k, value in self._derivatives(1).items():
            strain = self.constant(f"strain_{k}", value, f"strain of shape {k}", "1/m")
            total += strain * self.instance.coordinates[2 + k].q
        return total

    @property
    def damping_moment(self) -> sp.Expr:
        """The bending moment of the damping of the material."""
        return self._damped(2, "damping", "moment of the damping", "N s")

    @property
    def damping_moment_slope(self) -> sp.Expr:
        """The derivative of the bending moment of the damping along the axis."""
        return self._damped(3, "damping_slope", "derivative of the moment of the damping", "N s/m")

    def _damped(self, order: int, label: str, doc: str, unit: str) -> sp.Expr:
        """The moment of the damping (order 2) or its slope (3): EI d^n v/dx^n with the amplitudes K^-1 B alphadot."""
        beam, total = self.rod.beam, sp.S.Zero
        if beam.damping is None:
            return total
        derivatives = self._derivatives(order)
        n, pieces = len(derivatives), self.rod.pieces
        own = retardation_times(beam, pieces)[n * self.piece : n * (self.piece + 1), :]
        factors = quantity.value(beam.bending_stiffness) * sp.Matrix([list(derivatives.values())]) * own
        instances = (self.scene.instances[piece_name(self.rod, k)] for k in range(pieces))
        rates = [instance.rows[2 + i].v for instance in instances for i in derivatives]
        for j, (value, rate) in enumerate(zip(factors, rates, strict=True), 1):
            total += self.constant(f"{label}_{j}", value, f"{doc}, per rate of amplitude {j}", unit) * rate
        return total

    def _derivatives(self, order: int) -> dict[int, sp.Expr]:
        """Derivatives by shape number: d^n phi_i/dx^n of bending (n = 2, 3), or dchi_k/dx of stretching (n = 1)."""
        axis = min(order, 2)  # bending is along e2, stretching along e1
        unit = (2 / self.length) ** order
        fields = ((i, field.of) for i, field in enumerate(self.shapes, 1) if field.axis == axis)
        return {i: rational(shape.derivative(order).at(self.at)) * unit for i, shape in fields}

    def resultant(self) -> Resultant:
        """The force of the part to the right of the section on the left part, and its torque about the section.

        What acts at the section itself acts on the left part, but for the right end, where it acts on the right one.
        """
        about = self.position

        def on_the_right(marker: MarkerRef) -> bool:
            if marker.body != self.component:
                return False
            if marker.marker not in self.places:
                return False  # the resultant of a distributed load, of which a part may be on the right
            return self._is_right(self.places[marker.marker])

        return self.scene.loads(on_the_right, about) + self._distributed() + -self._inertia()

    def _is_right(self, place: Fraction) -> bool:
        """Whether a load or a mass at xi = `place` of the piece belongs to the part to the right."""
        return place > self.at or place == 1

    def _distributed(self) -> Resultant:
        """The distributed loads on the part to the right, with their torque about the section."""
        coordinates, result = self.instance.coordinates, NOTHING
        rotation = self.rotation
        origin, about = sp.Matrix(self.instance.origin), self.position
        half = self.length / 2
        for load in self.rod.loads:
            in_time = quantity.function(load.time)
            for k, of_rod in enumerate(load.force):
                density = on_piece(of_rod, self.rod.pieces, self.piece)
                if density.is_zero:
                    continue

                def integral(
                    of: BeamFunction, unit: sp.Expr, label: str, what: str = f"{load.name}_{k + 1}"
                ) -> sp.Expr:
                    return self.constant(f"{what}_{label}", unit * self._right(of), f"{label} of load {what}", "")

                total = integral(density, half, "total")
                first = integral(density * XI, half**2, "first")
                lever = sp.Matrix([first, sp.S.Zero])
                for i, (field, c) in enumerate(zip(self.shapes, coordinates[3:], strict=True), 1):
                    lever[field.axis - 1] += integral(density * field.of, half, f"shape_{i}") * c.q
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
    def _second(self) -> Mapping[tuple[int, int], BeamFunction]:
        """The functions psi_ij length/2 for i <= j; empty at first order."""
        beam = self.rod.beam
        if beam.order is DisplacementOrder.FIRST_ORDER:
            return {}
        second = Foreshortening(self.shapes, beam.frame, self.mass, self.length)
        return {(i, j): second.of(i, j) for i, j in pairs(len(self.shapes))}

    @property
    def rotation(self) -> sp.Matrix:
        """The rotation matrix Q of the body."""
        phi = self.instance.coordinates[2].q
        return sp.Matrix([[sp.cos(phi), -sp.sin(phi)], [sp.sin(phi), sp.cos(phi)]])

    def _right(self, integrand: BeamFunction) -> sp.Rational:
        """The integral over xi from the section to the right end."""
        return rational(integrand.integral(self.at))

    def _inertia(self) -> Resultant:
        """The rate of change of momentum of the part to the right, less its weight; torque about the section."""
        beam, instance = self.rod.beam, self.instance
        gravity, _ = quantity.gravity(self.scene.scene.gravity)
        start, shapes = self.at, self.shapes
        own_masses = (m for m in masses_of_piece(self.rod, self.piece) if self._is_right(m.at))
        masses = located_masses(own_masses, shapes, self.length)
        part = part_body(shapes, beam.frame, beam.order, self.mass, self.length, start, gravity, masses)
        known = self.known(part, gravity)
        force1, force2, torque = (row.xreplace(known) for row in rigid_rows(part))
        origin, about = sp.Matrix(instance.origin), self.position
        return Resultant(sp.Matrix([force1, force2]), torque).about(origin, about)


def piece_of_component(scene: Scene, component: str) -> tuple[BeamBody, int, dict[str, Fraction]]:
    """The rod of a component, its number in the rod, from 0, and the positions xi of the markers on it."""
    for body in scene.bodies:
        if not isinstance(body, BeamBody):
            continue
        n = body.pieces
        for k in range(n):
            if piece_name(body, k) == component:
                own = {m.name: place_in_piece(m.at, n) for m in body.markers}
                return body, k, {**own, CUT[0]: Fraction(-1), CUT[1]: Fraction(1)}
    raise AssertionError(f"{component} is no beam; the specification refuses other bodies")
