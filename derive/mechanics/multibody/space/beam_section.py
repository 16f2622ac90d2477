"""A section of a beam in space: its curvature and twist, and what the part to the right of it exerts on the left part.

Section forces follow from the equilibrium of the part to the right of the section: its inertia and its weight, see
`spatial_beam_part`, and what forces, springs and joints exert on it. Moments also follow from the curvatures of the
shapes and from the damping of the material; see `outputs/beam_section` of planar beams.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from itertools import combinations_with_replacement

from derive.algebra import sp
from derive.mechanics import quantity
from derive.mechanics.bodies.beam_functions import XI, BeamFunction, rational
from derive.mechanics.bodies.reference_conditions import on_piece
from derive.mechanics.bodies.section_fields import Direction, section_shapes, shortening_of
from derive.mechanics.bodies.section_inertia import length_of
from derive.mechanics.bodies.spatial_beam import damping_along
from derive.mechanics.bodies.spatial_beam_part import spatial_part
from derive.mechanics.motion.rotations import matrix_of
from derive.mechanics.motion.vectors import cross, dot
from derive.mechanics.multibody.bodies.rigid import BODY_FRAME
from derive.mechanics.multibody.section_values import SectionValues
from derive.mechanics.multibody.space.forces import moved_to
from derive.mechanics.multibody.space.output_parts import SpatialParts
from derive.spec.model.beam_pieces import piece_name
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.markers import MarkerRef
from derive.spec.model.spatial_beam import SpatialBeam, cut_into
from derive.spec.model.spatial_start import NOT_GIVEN_IN_SPACE

RIGID = 6
"""The rows of the rigid motion of a body."""
COORDINATES = 7
"""Its coordinates."""


class SpatialBeamSection(SectionValues):
    """A section of a beam at a place xi, with the constants of what is asked for."""

    def __init__(
        self, name: str, parts: SpatialParts, beam: SpatialBeam, at: Fraction, position: sp.Matrix, axes: sp.Matrix
    ) -> None:
        """name: what the names of its constants begin with; position: inertial; axes: of components, as columns."""
        super().__init__(name, "section", parts.instances[beam.name])
        self.parts, self.beam, self.at = parts, beam, at
        self.position, self.axes = position, axes
        self.shapes = section_shapes(beam)
        self.length = length_of(beam)
        self.mass = quantity.value(beam.mass) / cut_into(beam)

    # ---- deformation

    def derivative(self, direction: Direction, order: int) -> sp.Expr:
        """The derivative of a deflection, of the angle of twist or of the displacement along the axis by x."""
        total, label = sp.S.Zero, f"{direction.name.lower()}_{order}"
        for i, value in self._derivatives(direction, order).items():
            doc = f"derivative {order} by x of shape {i}" if order else f"value of shape {i}"
            factor = self.constant(f"{label}_{i}", value, doc, "")
            total += factor * self.instance.coordinates[COORDINATES - 1 + i].q
        return total

    def _derivatives(self, direction: Direction, order: int) -> dict[int, sp.Expr]:
        """The derivatives of the shapes of a direction by x, by their numbers; those of torsion are of the angle."""
        unit = (2 / self.length) ** (order + (direction is Direction.TORSION))
        of = {i: shape.of for i, shape in enumerate(self.shapes, 1) if shape.direction is direction}
        return {i: unit * rational(shape.derivative(order).at(self.at)) for i, shape in of.items()}

    @property
    def curvatures(self) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
        """The rate of twist and the curvatures about e2 and e3 of the section: theta', -w'', v''.

        At second order a beam that twists has the curvatures -w'' + theta v'' and v'' + theta w''.
        """
        v, w = (self.derivative(direction, 2) for direction in (Direction.ALONG_E2, Direction.ALONG_E3))
        theta = sp.S.Zero
        if self.beam.order is not DisplacementOrder.FIRST_ORDER:
            theta = self.derivative(Direction.TORSION, 0)
        return self.derivative(Direction.TORSION, 1), theta * v - w, v + theta * w

    @property
    def stiffnesses(self) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
        """GJ, zero if the beam is rigid in torsion, and EI about e2 and e3."""
        third, second = self.beam.bending_stiffnesses
        first = self.beam.torsion.stiffness if self.beam.torsion else Fraction(0)
        labels = (("GJ", first), ("EI_2", second), ("EI_3", third))
        first, second, third = (self.constant(of, quantity.value(x), of, "N m^2") for of, x in labels)
        return first, second, third

    def damping_moment(self, direction: Direction, order: int) -> sp.Expr:
        """The moment of the damping of the material in a direction, or its derivative along the axis.

        It is that of the amplitudes K^-1 B alphadot; order: of the derivative of the shapes by x.
        """
        derivatives = self._derivatives(direction, order)
        if self.beam.damping is None or not derivatives:
            return sp.S.Zero
        of = damping_along(self.beam, self.shapes, direction)
        first, second, third = self.stiffnesses
        stiffness = {Direction.TORSION: first, Direction.ALONG_E3: second, Direction.ALONG_E2: third}[direction]
        pieces, number = [self.beam.name], 0
        if cut := self.beam.piece_of:
            pieces, number = [piece_name(cut.rod.name, cut.rod.pieces, k) for k in range(cut.rod.pieces)], cut.number
        n = len(derivatives)
        factors = sp.Matrix([[*derivatives.values()]]) * of.retardation_times[n * number : n * (number + 1), :]
        rates = [self.parts.instances[piece].rows[RIGID - 1 + i].v for piece in pieces for i in derivatives]
        total, label = sp.S.Zero, f"damping_{direction.name.lower()}_{order}"
        for j, (value, rate) in enumerate(zip(factors, rates, strict=True), 1):
            total += self.constant(f"{label}_{j}", value, f"damping per rate of amplitude {j}", "") * rate
        return stiffness * total

    @property
    def moments_of_curvature(self) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
        """The twisting moment and the bending moments about e2 and e3 of the section, of its deformation."""
        twist, second, third = (k * of for k, of in zip(self.stiffnesses, self.curvatures, strict=True))
        return (
            twist + self.damping_moment(Direction.TORSION, 1),
            second - self.damping_moment(Direction.ALONG_E3, 2),
            third + self.damping_moment(Direction.ALONG_E2, 2),
        )

    # ---- equilibrium

    @cached_property
    def resultant(self) -> tuple[sp.Matrix, sp.Matrix]:
        """The force of the part to the right on the left part, and its torque about the section, along `axes`.

        What acts at the section itself acts on the left part, but for the right end, where it acts on the right one.
        """
        about, places = self.position, {m.name: m.at for m in self.beam.markers}
        force, torque = (a + b for a, b in zip(self._inertia(about), self._distributed(about), strict=True))
        for load in self.parts.loads_on(self.beam.name):
            place = places.get(load.marker.marker, self.at)  # others are the resultants of distributed loads
            if place > self.at or place == 1:
                f, m = moved_to(load, sp.Matrix(self.parts.at(load.marker).position), about)
                force, torque = force + f, torque + m
        return self._along(force), self._along(torque)

    def _along(self, vector: sp.Matrix) -> sp.Matrix:
        return sp.Matrix([dot(self.axes[:, k], vector) for k in range(3)])

    def _distributed(self, about: sp.Matrix) -> tuple[sp.Matrix, sp.Matrix]:
        """The distributed loads on the part to the right, with their torque about a point.

        Torques per length turn with the sections by their rotations of first order.
        """
        frame = self.parts.at(MarkerRef(self.beam.name, BODY_FRAME))
        Q, force, torque = sp.Matrix(frame.frame), sp.zeros(3, 1), sp.zeros(3, 1)
        for load in self.beam.loads:
            in_time, n = quantity.function(load.time), cut_into(self.beam)
            number = self.beam.piece_of.number if self.beam.piece_of else 0
            axes = sp.eye(3) if load.frame == "inertial" else Q
            for k in range(3):
                what = f"{load.name}_{k + 1}"
                density = on_piece(load.force[k], n, number)
                if not density.is_zero:
                    lever = Q * sp.Matrix(self._lever(density, what))
                    pulled = in_time * self._right(density, what, "total") * axes[:, k]
                    force += pulled
                    torque += cross(lever, in_time * axes[:, k]) + cross(sp.Matrix(frame.position) - about, pulled)
                density = on_piece(load.torque[k], n, number)
                if not density.is_zero:
                    unit = sp.eye(3)[:, k]
                    total = self._right(density, f"{what}_torque", "total") * unit
                    if load.frame != "inertial":
                        total += cross(sp.Matrix(self._rotation(density, f"{what}_torque")), unit)
                    torque += in_time * (total if load.frame == "inertial" else Q * total)
        return force, torque

    def _right(self, of: BeamFunction, what: str, label: str, order: int = 0) -> sp.Expr:
        """The integral of a function by x from the section to the right end, with (2/l)^order."""
        half = self.length / 2
        value = half ** (1 - order) * rational(of.integral(self.at))
        return self.constant(f"{what}_{label}", value, f"{label} of load {what}", "")

    def _lever(self, density: BeamFunction, what: str) -> list[sp.Expr]:
        """The integral of a load times the position of its points, from the floating frame along its axes."""
        amplitudes = [c.q for c in self.instance.coordinates[COORDINATES:]]
        total = [self._right(density * XI, what, "first", -1), sp.S.Zero, sp.S.Zero]
        for i, (shape, a) in enumerate(zip(self.shapes, amplitudes, strict=True), 1):
            for axis, of in shape.displacement.items():
                total[axis - 1] += self._right(density * of, what, f"shape_{i}") * a
        if self.beam.order is not DisplacementOrder.FIRST_ORDER:
            numbered = [*enumerate(zip(self.shapes, amplitudes, strict=True), 1)]
            for (i, (shape, a)), (j, (other, b)) in combinations_with_replacement(numbered, 2):
                psi = density * shortening_of(shape, other, self.beam.frame)
                if not psi.is_zero:
                    factor = sp.S.Half if i == j else sp.S.One
                    total[0] += factor * self._right(psi, what, f"psi_{i}_{j}", 1) * a * b
        return total

    def _rotation(self, density: BeamFunction, what: str) -> list[sp.Expr]:
        """The integral of a load times the rotation vector of its sections."""
        total, amplitudes = [sp.S.Zero] * 3, [c.q for c in self.instance.coordinates[COORDINATES:]]
        for i, (shape, a) in enumerate(zip(self.shapes, amplitudes, strict=True), 1):
            for axis, of in shape.rotation.items():
                total[axis - 1] += self._right(density * of, what, f"rotation_{i}_{axis}", 1) * a
        return total

    def _inertia(self, about: sp.Matrix) -> tuple[sp.Matrix, sp.Matrix]:
        """The weight of the part to the right, less the rate of change of its momentum; torque about a point."""
        gravity, _ = quantity.gravity(self.parts.scene.gravity)
        alike = replace(self.beam, name="", start=NOT_GIVEN_IN_SPACE, markers=(), loads=())
        part, rows = spatial_part(alike, self.at, gravity)
        frame = self.parts.at(MarkerRef(self.beam.name, BODY_FRAME))
        known = {**dict(zip(part.motion.rotation, frame.frame, strict=True)), **self.known(part, gravity)}
        needed = [row.xreplace(known) for row in rows]
        force, torque = sp.Matrix(needed[:3]), sp.Matrix(frame.frame) * sp.Matrix(needed[3:])
        lever = sp.Matrix(frame.position) - about
        return -force, -torque - cross(lever, force)


def section_at_marker(parts: SpatialParts, marker: MarkerRef, of_frame: bool = False) -> SpatialBeamSection:
    """The section of a beam at a marker, with its own axes or with those of the floating frame, made once."""
    if (marker, of_frame) not in parts.sections:
        parts.sections[marker, of_frame] = _section_at_marker(parts, marker, of_frame)
    section: SpatialBeamSection = parts.sections[marker, of_frame]
    return section


def _section_at_marker(parts: SpatialParts, marker: MarkerRef, of_frame: bool) -> SpatialBeamSection:
    beam = next(body for body in parts.scene.bodies if body.name == marker.body)
    assert isinstance(beam, SpatialBeam)
    of = next(m for m in beam.markers if m.name == marker.marker)
    own = sp.Matrix(parts.at(marker).axes) * matrix_of(of.rotation).T
    axes = sp.Matrix(parts.at(MarkerRef(beam.name, BODY_FRAME)).frame) if of_frame else own
    position = sp.Matrix(parts.at(marker).position)
    return SpatialBeamSection(f"{marker.body}_{marker.marker}_part", parts, beam, of.at, position, axes)
