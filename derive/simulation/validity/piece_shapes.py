"""The shapes of a piece of a beam in numbers: their stiffness, their slopes, and the axes of its motion."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from numpy.polynomial.legendre import leggauss

from derive.mechanics.bodies.displacement_fields import stretching_shapes
from derive.mechanics.symbols import amplitude_of
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.compiled_scene import ConstrainedSystem
from derive.simulation.observables.beams import function_values, half_length, shape_functions
from derive.simulation.observables.motion import si_value
from derive.spec.model.planar_bodies import BeamBody

POINTS = 48
"""Gauss points along a piece: polynomials up to degree 95 are integrated exactly, and products of twenty half waves."""

ROTATIONS = 3
"""The components of the angular velocity, which are before the rates of the amplitudes of a body in space."""
IN_PLANE = 0
"""The axis of deflections in the plane, where there is no other."""
TWIST = 1
"""The axis about which a beam in space twists."""


@dataclass(frozen=True)
class PieceShapes:
    """The shapes of each piece of a beam, with its values in SI units.

    before: the amplitudes of a piece before those of these shapes. axis: the one along which a beam in space deflects,
    or `TWIST`: then the shapes are the rotations of the sections times half the length of a piece, the stiffness is GJ,
    moments are twisting moments, and curvatures the first derivatives of the shapes.
    """

    beam: BeamBody
    before: int = 0
    axis: int = IN_PLANE

    @property
    def length(self) -> float:
        """The length of a piece, m."""
        return 2 * half_length(self.beam)

    @property
    def mass(self) -> float:
        """The mass of a piece, kg."""
        return si_value(self.beam.beam.mass) / self.beam.pieces

    @property
    def bending_stiffness(self) -> float:
        """The stiffness of a section, N m^2: EI in bending, GJ in torsion."""
        return si_value(self.beam.beam.bending_stiffness)

    @property
    def twists(self) -> bool:
        """Whether these are the shapes of torsion."""
        return self.axis == TWIST

    @property
    def strain_order(self) -> int:
        """The derivative of the shapes that is strain: the second in bending, the first in torsion."""
        return 1 if self.twists else 2

    @cached_property
    def stiffness(self) -> Matrix:
        """K (shapes, shapes) of the strain energy 1/2 a^T K a, N/m."""
        xi, weights = gauss_points()
        curvatures = self._derivatives(self.strain_order, xi) * (2 / self.length) ** 2
        stiffness: Matrix = self.bending_stiffness * self.length / 2 * (curvatures * weights) @ curvatures.T
        return stiffness

    def moments(self, xi: Vector) -> Matrix:
        """(shapes, len(xi)): the moments of unit amplitudes at places xi of a piece, EI v'' in bending, N."""
        result: Matrix = self.bending_stiffness * (2 / self.length) ** 2 * self._derivatives(self.strain_order, xi)
        return result

    def shear_forces(self, xi: Vector) -> Matrix:
        """(shapes, len(xi)): the derivatives of the bending moments along the axis, N/m."""
        result: Matrix = self.bending_stiffness * (2 / self.length) ** 3 * self._derivatives(3, xi)
        return result

    def values(self, xi: Vector) -> Matrix:
        """(shapes, len(xi)): the deflections at places xi of a piece per unit of the amplitudes."""
        return self._derivatives(0, xi)

    def slopes(self, xi: Vector) -> Matrix:
        """(shapes, len(xi)): the slopes at places xi of a piece, 1/m."""
        return self._derivatives(1, xi) * 2 / self.length

    def _derivatives(self, order: int, xi: Vector) -> Matrix:
        """(shapes, len(xi)): derivatives of the shapes by xi."""
        shapes = stretching_shapes(self.beam.beam) if self.twists else shape_functions(self.beam)
        return np.array([function_values(f.derivative(order), xi) for f in shapes])

    def amplitudes_in(self, native: ConstrainedSystem, piece: str) -> list[int]:
        """The numbers of the coordinates of a scene that are the amplitudes of a piece."""
        return [native.coordinates.index(name) for name in self._names(piece, 0)]

    def rates_in(self, native: ConstrainedSystem, piece: str) -> list[int]:
        """The numbers of the velocities of a scene that are the rates of these amplitudes."""
        return [native.velocities.index(name) for name in self._names(piece, 1)]

    def beside_in(self, native: ConstrainedSystem, piece: str) -> list[int]:
        """The numbers of the velocities of a piece in space that do not belong to its motion in this plane.

        They are its spin about its axis, whose inertia is small, and the rates of its other amplitudes.
        """
        if self.axis == IN_PLANE:
            return []
        own = self.rates_in(native, piece)
        first, every = own[0] - self.before, set(native.velocities)
        count = next(i for i in itertools.count(1) if amplitude_of(piece, i + 1, 1).shown not in every)
        return [first - ROTATIONS, *(i for i in range(first, first + count) if i not in own)]

    def _names(self, piece: str, derivative: int) -> list[str]:
        return [amplitude_of(piece, self.before + i + 1, derivative).shown for i in range(len(self.stiffness))]


@cache
def gauss_points() -> tuple[Vector, Vector]:
    """Points and weights on [-1, 1]; they take a millisecond."""
    return leggauss(POINTS)
