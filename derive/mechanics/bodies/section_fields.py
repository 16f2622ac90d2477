"""The displacement fields of a beam in space, which move each of its cross-sections as a rigid body.

A point p = s e1 + y e2 + z e3 of the section at xi has the position X = (xi l/2) e1 + p. The axis is displaced by
v e2 + w e3 + u e1, and the section turns by the small rotation vector (theta, -dw/dx, dv/dx), so that

    Phi_i = f_i(xi) + t_i(xi) x p.

At second order a beam that bends and does not stretch shortens by psi_ij e1 (`foreshortening`), the section turns as
its tangent does, and by the part of its twist that bending in both planes makes:

    R p = p + t x p + t x (t x p)/2 + s x p,   s = ((1/2) int (v' w'' - v'' w') dx, theta v'/2, theta w'/2),

where theta is the angle whose derivative is the twist of the beam. Displacements u along the axis change the slopes to
v'(1 - u'), w'(1 - u'). Every field is linear in p, and its coefficients are functions of xi.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, TypeVar

from derive.algebra import sp
from derive.mechanics.axes import AXES
from derive.mechanics.bodies.beam_functions import NOTHING, ONE, XI, BeamFunction
from derive.mechanics.bodies.beam_integrals import BeamField
from derive.mechanics.bodies.displacement_fields import axial_shapes, shortening, without_translation
from derive.mechanics.bodies.reference_conditions import assumed_shapes

if TYPE_CHECKING:
    from derive.spec.model.beam_parts import Frame
    from derive.spec.model.spatial_beam import SpatialBeam

HALF = Fraction(1, 2)


Key = TypeVar("Key")


class Direction(Enum):
    """The kind of deformation that a shape belongs to."""

    ALONG_E2 = "deflection along e2"
    ALONG_E3 = "deflection along e3"
    TORSION = "torsion"
    AXIAL = "displacement along the axis"


@dataclass(frozen=True)
class SectionShape:
    """A shape function of a beam in space with its kind; of torsion it is the rotation of sections times length/2."""

    of: BeamFunction
    direction: Direction

    @cached_property
    def displacement(self) -> dict[int, BeamFunction]:
        """The displacement of the axis by axes, for a unit amplitude."""
        axis = {Direction.ALONG_E2: 2, Direction.ALONG_E3: 3, Direction.AXIAL: 1}.get(self.direction)
        return {} if axis is None else {axis: self.of}

    @cached_property
    def rotation(self) -> dict[int, BeamFunction]:
        """The rotation vector of the sections by axes, in units of 2/length."""
        match self.direction:
            case Direction.ALONG_E2:
                return {3: self.of.derivative()}
            case Direction.ALONG_E3:
                return {2: -self.of.derivative()}
            case Direction.TORSION:
                return {1: self.of}
            case Direction.AXIAL:
                return {}


def section_shapes(beam: SpatialBeam) -> tuple[SectionShape, ...]:
    """The shapes in the order of their amplitudes: along e2, along e3, torsion, along the axis.

    Raises ConditionError when an ansatz does not fit the frame.
    """
    first, second = (assumed_shapes(deflection) for deflection in beam.deflections)
    torsion = axial_shapes(beam.torsion.ansatz, beam.frame, beam.orthogonal) if beam.torsion else ()
    axial = axial_shapes(beam.axial.ansatz, beam.frame, beam.orthogonal) if beam.axial else ()
    directions = zip(Direction, (first, second, torsion, axial), strict=True)
    return tuple(SectionShape(of, direction) for direction, shapes in directions for of in shapes)


Slots = Mapping[tuple[int, int], BeamFunction]
"""Functions of xi by the axis of a displacement and the coordinate of p that they are the factor of, 0 for none."""


@dataclass(frozen=True)
class SectionField:
    """A field that is linear in the coordinates of a section: its parts, with a unit for those with p and another."""

    slots: Slots
    of_axis: sp.Expr
    of_section: sp.Expr

    def along(self, axis: int) -> list[tuple[tuple[int, int], BeamFunction]]:
        """The slots of an axis with their functions."""
        return [(slot, of) for slot, of in self.slots.items() if slot[0] == axis]

    def unit(self, slot: tuple[int, int]) -> sp.Expr:
        """The unit of the function of a slot."""
        return self.of_section if slot[1] else self.of_axis


def position_field(length: sp.Expr) -> SectionField:
    """The field X = (xi l/2) e1 + p."""
    slots = {(1, 0): XI} | {(k, k): ONE for k in AXES}
    return SectionField(slots, length / 2, sp.S.One)


def shape_field(shape: SectionShape, length: sp.Expr) -> SectionField:
    """The field Phi_i of a shape."""
    slots = {(axis, 0): of for axis, of in shape.displacement.items()}
    return SectionField(_kept({**slots, **_turned(shape.rotation)}), sp.S.One, 2 / length)


def second_rotation(first: SectionShape, second: SectionShape, frame: Frame) -> dict[int, BeamFunction]:
    """The rotation vector s_ij of sections at second order in units of (2/length)^2: s = 1/2 sum a_i a_j s_ij."""
    total: dict[int, BeamFunction] = {}
    for i, j in ((first, second), (second, first)):
        slope, other = i.of.derivative(), j.of
        match i.direction, j.direction:
            case Direction.ALONG_E2, Direction.ALONG_E3:
                twist = (slope * other.derivative(2) - i.of.derivative(2) * other.derivative()).antiderivative()
                part = {1: without_translation(twist, frame).scaled(HALF)}
            case Direction.ALONG_E2, Direction.TORSION:
                part = {2: (slope * other).scaled(HALF)}
            case Direction.ALONG_E3, Direction.TORSION:
                part = {3: (slope * other).scaled(HALF)}
            case Direction.ALONG_E2, Direction.AXIAL:
                part = {3: -(slope * other.derivative())}
            case Direction.ALONG_E3, Direction.AXIAL:
                part = {2: slope * other.derivative()}
            case _:
                part = {}
        for axis, of in part.items():
            total[axis] = total.get(axis, NOTHING) + of
    return _kept(total)


def second_field(first: SectionShape, second: SectionShape, frame: Frame, length: sp.Expr) -> SectionField:
    """The field Psi_ij of two shapes: the shortening of the axis, and the rotation of the sections at second order."""
    t, u = first.rotation, second.rotation
    slots = dict(_turned(second_rotation(first, second, frame)))
    for (b, of_t), (c, of_u) in ((x, y) for x in t.items() for y in u.items()):
        product = of_t * of_u  # t x (u x p) = u (t . p) - p (t . u), and half of it with t and u exchanged
        parts = [((b, c), HALF), ((c, b), HALF)] + [((k, k), Fraction(-1)) for k in AXES if b == c]
        for slot, factor in parts:
            slots[slot] = slots.get(slot, NOTHING) + product.scaled(factor)
    slots[1, 0] = shortening_of(first, second, frame)
    return SectionField(_kept(slots), 2 / length, (2 / length) ** 2)


def shortening_of(first: SectionShape, second: SectionShape, frame: Frame) -> BeamFunction:
    """The psi_ij length/2 of two shapes, which shorten the beam if both bend it in one plane."""
    if first.direction is not second.direction or first.direction not in BENDING:
        return NOTHING
    return shortening(BeamField(first.of, 2), BeamField(second.of, 2), frame)


BENDING = (Direction.ALONG_E2, Direction.ALONG_E3)
"""The deflections, which shorten the beam."""


def _turned(rotation: Mapping[int, BeamFunction]) -> dict[tuple[int, int], BeamFunction]:
    """The slots of t x p for a rotation vector t."""
    slots = {}
    for axis, of in rotation.items():
        after, last = axis % 3 + 1, (axis + 1) % 3 + 1
        slots[last, after], slots[after, last] = of, -of  # e1 x (y e2 + z e3) = y e3 - z e2
    return slots


def _kept(functions: Mapping[Key, BeamFunction]) -> dict[Key, BeamFunction]:
    return {key: of for key, of in functions.items() if not of.is_zero}
