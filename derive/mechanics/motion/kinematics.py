"""Kinematics of a deformable body, (1)-(6), by differentiation of x = c + Q (X + u).

A vector field over the body is a sum of tensors times the fields that the body knows: `ONE` (the same vector
everywhere), `R` = r = X + u, `RDOT` and `RDDOT`, its rates at a fixed material point, and `PHI`, the assumed
displacement field Phi_i of a generic index i. So a `Field` is a dict from the name of a field to its tensor. Tensors
depend on time alone, fields on the material point alone: the body enters only through the moments of these fields, and
the sums over the modes are part of rdot = sum alphadot_j Phi_j and rddot = sum alphaddot_j Phi_j.

`ONE` is resolved in the inertial frame (its tensor is a column), all other fields in the body frame; `HERE` is the same
vector everywhere as well, but resolved there.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

from derive.algebra import sp
from derive.mechanics.symbols import Family, quantity

Field: TypeAlias = "dict[str, sp.Matrix]"

ONE, HERE, R, RDOT, RDDOT, PHI = "1", "1 in the body frame", "r", "rdot", "rddot", "Phi_i"


def add(*fields: Field) -> Field:
    """The sum of fields; entries that cancel are dropped."""
    total: Field = {}
    for field in fields:
        for name, tensor in field.items():
            total[name] = (total[name] + tensor if name in total else tensor).expand()
    return {name: tensor for name, tensor in total.items() if not tensor.is_zero_matrix}


def times(tensor: sp.Matrix, field: Field) -> Field:
    """A tensor applied to a field."""
    return add({name: tensor * factor for name, factor in field.items()})


@dataclass(frozen=True)
class PlanarRotation:
    """The rotation tensor Q of (26) in the plane, written in symbols for the cosine and the sine of its angle."""

    angle: sp.Symbol

    @property
    def cos(self) -> sp.Symbol:
        """The symbol for the cosine."""
        return quantity(Family.COSINE)

    @property
    def sin(self) -> sp.Symbol:
        """The symbol for the sine."""
        return quantity(Family.SINE)

    @property
    def functions(self) -> dict[sp.Symbol, sp.Expr]:
        """The expressions of the cosine and the sine, by their symbols."""
        return {self.cos: sp.cos(self.angle), self.sin: sp.sin(self.angle)}

    @property
    def tensor(self) -> sp.Matrix:
        """The rotation tensor Q."""
        return sp.Matrix([[self.cos, -self.sin], [self.sin, self.cos]])

    @property
    def generator(self) -> sp.Matrix:
        """The generator Q^T dQ/dangle: the skew tensor whose axial vector is e3, (27)."""
        back = {value: symbol for symbol, value in self.functions.items()}
        derivative = self.tensor.subs(self.functions).diff(self.angle).subs(back)
        unreduced = (self.tensor.T * derivative).expand()
        return unreduced.subs(self.sin**2, 1 - self.cos**2).expand()


@dataclass(frozen=True)
class MovingFrame:
    """A rotating body frame, Qdot = Q (sum omega_k generator_k), and the time derivatives of fields resolved in it."""

    generators: tuple[sp.Matrix, ...]
    omega: tuple[sp.Symbol, ...]
    omegadot: tuple[sp.Symbol, ...]

    @property
    def angular_velocity_tensor(self) -> sp.Matrix:
        """The tensor omega x."""
        return sum((g * w for g, w in zip(self.generators, self.omega, strict=True)), 0 * self.generators[0])

    @property
    def position(self) -> Field:
        """The relative position Q^T (x - c) = r."""
        return {R: sp.eye(self.angular_velocity_tensor.rows)}

    @cached_property
    def velocity(self) -> Field:
        """The relative velocity Q^T (xdot - cdot) = omega x r + rdot."""
        return self.dot(self.position)

    @cached_property
    def acceleration(self) -> Field:
        """The relative acceleration Q^T (xddot - cddot) of (5)."""
        return self.dot(self.velocity)

    def dot(self, field: Field) -> Field:
        """The time derivative of Q f, in the body frame: fdot + omega x f."""
        pairs = list(zip(self.omega, self.omegadot, strict=True))
        return add(
            *({name: tensor.diff(w) * wdot for name, tensor in field.items()} for w, wdot in pairs),
            {RDOT: field[R]} if R in field else {},
            {RDDOT: field[RDOT]} if RDOT in field else {},
            times(self.angular_velocity_tensor, field),
        )

    def rotations(self) -> tuple[Field, ...]:
        """The virtual displacements Q^T (delta x - delta c) of (6) for unit variations of the rotation.

        x depends on time through its coordinates alone, so its variation is its velocity with the rates varied.
        """
        return tuple(add({f: tensor.diff(w) for f, tensor in self.velocity.items()}) for w in self.omega)

    def deformation(self) -> Field:
        """The virtual displacement Q^T (delta x - delta c) of (6) for unit variation of alpha_i: rdot becomes Phi_i."""
        return {PHI: self.velocity[RDOT]}
