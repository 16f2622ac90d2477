"""The moments of the displacement fields of a uniform slender beam, in closed form.

The inertia of (15) sees int rho ... dOmega = m/2 int ... dxi over -1 <= xi <= 1. X = xi l/2 e1 (24) lies along the
beam, shapes phi_i(xi) e2 (25) across it. The rotary inertia of the cross-section is neglected.
"""

from __future__ import annotations

from dataclasses import dataclass

from derive.algebra import sp
from derive.mechanics.bodies.beam_functions import XI, BeamFunction, rational
from derive.mechanics.bodies.planar_integrals import Value
from derive.mechanics.zero_reasons import CONDITION_17, CONDITION_19

LATERAL = "geometry (the beam lies along e1 and deflects along e2)"
PARALLEL = "geometry (all deflections are along e2)"
ALONG = "geometry (both are along e1)"
CENTRED = "the choice of the origin (the centre of the undeformed beam)"
PARITY = "parity (the integrand is odd in xi)"
BY_CHANCE = "these shapes (the integral vanishes exactly)"
ORTHOGONAL = "orthogonality (the integral vanishes exactly)"


@dataclass(frozen=True)
class BeamField:
    """A displacement field f(xi) e_axis of unit amplitude."""

    of: BeamFunction
    axis: int


@dataclass(frozen=True)
class BeamIntegrals:
    """Moments of X (index 0) and of fields (index 1, 2, ...) of a uniform beam; see FieldIntegrals.

    mean_frame: whether the fields meet (17) and (19).
    """

    fields: tuple[BeamField, ...]
    mass: sp.Expr
    length: sp.Expr
    mean_frame: bool

    def first(self, i: int, component: int) -> Value:
        """The first moment of X or of a field; X lies along e1."""
        field = self.field(i)
        if field.axis != component:
            return Value(sp.S.Zero, LATERAL)
        if i == 0:
            return self._value(field.of, self.length / 2, CENTRED)
        return self._value(field.of, sp.S.One, CONDITION_17 if self.mean_frame else None, BY_CHANCE)

    def trace(self, i: int, j: int) -> Value:
        """The moment of X . X, X . Phi_j or Phi_i . Phi_j."""
        first, second = self.field(i), self.field(j)
        if first.axis != second.axis:
            return Value(sp.S.Zero, LATERAL)
        return self._value(first.of * second.of, self.unit(i) * self.unit(j))

    def axial(self, i: int, j: int) -> Value:
        """The moment of X x Phi_j, or of Phi_i x Phi_j."""
        first, second = self.field(i), self.field(j)
        if first.axis == second.axis:
            return Value(sp.S.Zero, PARALLEL if first.axis == 2 else ALONG)
        condition = CONDITION_19 if self.mean_frame and i == 0 else None
        sign = 1 if first.axis == 1 else -1
        return self._value(first.of * second.of, sign * self.unit(i) * self.unit(j), condition)

    def field(self, i: int) -> BeamField:
        """The field X (index 0) or a displacement field."""
        return self.fields[i - 1] if i else BeamField(XI, 1)

    def unit(self, i: int) -> sp.Expr:
        """The factor of the field as a function of xi: X = xi l/2."""
        return sp.S.One if i else self.length / 2

    def _value(
        self, integrand: BeamFunction, factor: sp.Expr, reason: str | None = None, otherwise: str = ORTHOGONAL
    ) -> Value:
        """The integral m/2 int integrand dxi times factor, with the reason if it is zero."""
        value = integrand.integral()
        if value:
            return Value(self.mass * factor * rational(value) / 2)
        return Value(sp.S.Zero, reason or (PARITY if integrand.is_odd else otherwise))
