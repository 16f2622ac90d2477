"""Masses that are attached to a beam: rigid bodies with their centres on its axis, which turn with its sections.

Such a body moves like the point of the axis, with X and the displacement fields there, and turns by phi + sum alpha_i
dphi_i/dx. Its mass adds to all moments of these fields. Its inertia J adds the moments of the rotations, which are 1
for phi and dphi_i/dx for alpha_i: J to C3, J dphi_i/dx to c6_i and, in a table R of its own, J (dphi_i/dx) (dphi_j/dx).
The last is no part of c8, since a rotation, unlike a deflection, does not take the mass further away from O.

The shape functions are those of the beam without its masses, for the conditions of a frame are exact and masses may be
run-time parameters. In the mean frame (17) and (19) then hold for the mass of the beam alone: c1, c2 and c6 do not
vanish, and c8 is no longer diagonal.

Where the beam stretches, the section turns by -dphi_i/dx dchi_k/dx alpha_i alpha_k as well at second order; J times
that is a part of c10_ik, the moment of what turns with the angular acceleration.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics import quantity
from derive.mechanics.bodies.beam_functions import rational
from derive.mechanics.bodies.planar_integrals import Value
from derive.mechanics.symbols import Family, pair
from derive.mechanics.terms import ModelConstant, ParameterSymbol
from derive.mechanics.zero_reasons import CANCEL, ZERO_THERE
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import AttachedMass
from derive.spec.model.quantity import Parameter

if TYPE_CHECKING:
    from derive.mechanics.bodies.beam_integrals import BeamField, BeamIntegrals
    from derive.mechanics.bodies.foreshortening import Foreshortening

NO_SLOPE = "these shapes (no slope at the attached masses)"


@dataclass(frozen=True)
class LocatedMass:
    """A mass (kg) with its inertia (kg m^2) at xi = `at`, and the rotations dphi_i/dx (1/m) of the section there.

    strains: dchi_k/dx (1/m) there; of each shape either the rotation or the strain is zero.
    """

    name: str
    at: Fraction
    mass: sp.Expr
    inertia: sp.Expr
    rotations: tuple[sp.Expr, ...]
    strains: tuple[sp.Expr, ...]

    def rotation(self, i: int) -> sp.Expr:
        """The factor of alpha_i (of phi for i = 0) in the rotation of the section; zero for stretching."""
        if i == 0:
            return sp.S.One
        return self.rotations[i - 1] if i <= len(self.rotations) else sp.S.Zero

    def second_rotation(self, i: int, j: int) -> sp.Expr:
        """The factor of alpha_i alpha_j in the rotation of the section, twice that for i = j, in 1/m^2."""
        return -self.rotations[i - 1] * self.strains[j - 1] - self.rotations[j - 1] * self.strains[i - 1]


def located_masses(
    masses: Iterable[AttachedMass], shapes: tuple[BeamField, ...], length: sp.Expr
) -> tuple[LocatedMass, ...]:
    """The masses on a beam with these displacement fields and this length (m)."""
    result = []
    for m in masses:
        slopes = {axis: [_slope(field, axis, m.at, length) for field in shapes] for axis in (1, 2)}
        mass, inertia = quantity.value(m.mass), quantity.value(m.inertia, positive=False)
        result.append(LocatedMass(m.name, m.at, mass, inertia, tuple(slopes[2]), tuple(slopes[1])))
    return tuple(result)


def _slope(field: BeamField, axis: int, at: Fraction, length: sp.Expr) -> sp.Expr:
    """The derivative of a field by x if it is along the given axis, else zero."""
    return 2 * rational(field.of.derivative().at(at)) / length if field.axis == axis else sp.S.Zero


@dataclass(frozen=True)
class IntegralsWithMasses:
    """The moments of the fields of a beam with those of its attached masses; see FieldIntegrals."""

    beam: BeamIntegrals
    masses: tuple[LocatedMass, ...]

    def first(self, i: int, component: int) -> Value:
        """The first moment int rho X or int rho Phi_i."""
        if self.beam.field(i).axis != component:
            return self.beam.first(i, component)
        return _sum(self.beam.first(i, component), [m.mass * self._there(i, m) for m in self.masses])

    def trace(self, i: int, j: int) -> Value:
        """The moment of X . X, including the inertia of the masses, of X . Phi_j or of Phi_i . Phi_j."""
        if self.beam.field(i).axis != self.beam.field(j).axis:
            return self.beam.trace(i, j)
        added = [m.mass * self._there(i, m) * self._there(j, m) for m in self.masses]
        added += [m.inertia for m in self.masses if i == j == 0]
        return _sum(self.beam.trace(i, j), added)

    def axial(self, i: int, j: int) -> Value:
        """The moment of X x Phi_j, including the inertia of the masses, or of Phi_i x Phi_j."""
        first, second = self.beam.field(i), self.beam.field(j)
        if first.axis == second.axis:
            return self.beam.axial(i, j)
        sign = 1 if first.axis == 1 else -1
        added = [sign * m.mass * self._there(i, m) * self._there(j, m) for m in self.masses]
        added += [m.inertia * m.rotation(j) for m in self.masses if i == 0]
        return _sum(self.beam.axial(i, j), added)

    def _there(self, i: int, mass: LocatedMass) -> sp.Expr:
        """The value of X or of a field at a mass, along its axis."""
        return self.beam.unit(i) * rational(self.beam.field(i).of.at(mass.at))


@dataclass(frozen=True)
class SecondOrderWithMasses:
    """The moments of the Psi_ij of a beam with those of its attached masses; see SecondOrderIntegrals."""

    beam: Foreshortening
    masses: tuple[LocatedMass, ...]

    def first(self, i: int, j: int, component: int) -> Value:
        """The first moment int rho Psi_ij . e_component."""
        of_beam = self.beam.first(i, j, component)
        if component == 2:
            return of_beam
        return _sum(of_beam, [self.beam.factor * m.mass * self._there(i, j, m) for m in self.masses])

    def trace(self, i: int, j: int) -> sp.Expr:
        """The moment int rho X . Psi_ij, where X = xi length/2."""
        own = (m.mass * rational(m.at) * self._there(i, j, m) for m in self.masses)
        return sp.Add(self.beam.trace(i, j), *own)

    def axial(self, i: int, j: int) -> Value:
        """The moment int rho X x Psi_ij, including the inertia of the masses."""
        turned = [m.inertia * m.second_rotation(i, j) for m in self.masses]
        return _sum(self.beam.axial(i, j), turned) if any(turned) else self.beam.axial(i, j)

    def _there(self, i: int, j: int, mass: LocatedMass) -> sp.Rational:
        """The value of psi_ij length/2 at a mass."""
        return rational(self.beam.of(i, j).at(mass.at))


def _sum(of_beam: Value, added: list[sp.Expr]) -> Value:
    """An integral of a beam with the contributions of masses, and the reason if the sum vanishes."""
    total = sp.expand(sp.Add(of_beam.expr, *added))
    if total:
        return Value(total)
    reason = CANCEL if any(added) else ZERO_THERE
    return Value(total, f"{of_beam.zero} and {reason}" if of_beam.zero else reason)


def rotary_inertia(masses: tuple[LocatedMass, ...], shapes: int) -> Iterator[ModelConstant]:
    """The entries R_ij, i <= j, in kg, of the inertia that opposes the angular accelerations of the sections."""
    if not any(m.inertia for m in masses):
        return
    for i in range(1, shapes + 1):
        for j in range(i, shapes + 1):
            added = [m.inertia * m.rotation(i) * m.rotation(j) for m in masses]
            value = sp.expand(sp.Add(*added))
            zero = None if value else CANCEL if any(added) else NO_SLOPE
            doc = f"rotary inertia of the attached masses: sum J dphi_{i}/dx dphi_{j}/dx"
            yield ModelConstant(pair(Family.ROTARY, i, j), value, "(10)", doc, "kg", zero)


def mass_parameters(beam: PlanarBeam) -> Iterator[ParameterSymbol]:
    """The run-time parameters of the masses of a beam."""
    for m in beam.masses:
        if isinstance(m.mass, Parameter):
            yield quantity.parameter(m.mass, f"attached mass {m.name}")
        if isinstance(m.inertia, Parameter):
            yield quantity.parameter(m.inertia, f"moment of inertia of the attached mass {m.name}", positive=False)
