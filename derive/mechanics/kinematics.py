"""Kinematics of a deformable body, (1)-(6), by differentiation of x = c + Q (X + u).

A vector field over the body, resolved in the body base, is a sum of tensors times the fields that the body knows:
`ONE` (the same vector everywhere), `R` = r = X + u, `RDOT` = du/dt, and the assumed displacement fields phi(i).
Its coefficients depend on time alone; the fields alone depend on the material point. So a `Field` is a dict from
the name of a field to its tensor (for ONE: to a column), and what is left of the body is moments of these fields.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

Field = dict[str, sp.Matrix]

ONE, R, RDOT = "1", "r", "rdot"


def phi(i: int) -> str:
    """The name of the assumed displacement field Phi_i, i = 1..N."""
    return f"Phi_{i}"


def add(*fields: Field) -> Field:
    """The sum of fields; what cancels is dropped."""
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
        return sp.Symbol(f"cos_{self.angle}")

    @property
    def sin(self) -> sp.Symbol:
        """The symbol for the sine."""
        return sp.Symbol(f"sin_{self.angle}")

    @property
    def functions(self) -> dict[sp.Symbol, sp.Expr]:
        """What the two symbols stand for."""
        return {self.cos: sp.cos(self.angle), self.sin: sp.sin(self.angle)}

    @property
    def tensor(self) -> sp.Matrix:
        """Q, with Q^T Q = I after `reduced`."""
        return sp.Matrix([[self.cos, -self.sin], [self.sin, self.cos]])

    def reduced(self, expr: sp.Expr) -> sp.Expr:
        """An expression of degree two in cosine and sine, with sin^2 = 1 - cos^2."""
        return expr.expand().subs(self.sin**2, 1 - self.cos**2).expand()

    @property
    def generator(self) -> sp.Matrix:
        """Q^T dQ/dangle: the skew tensor whose axial vector is e3, (27)."""
        back = {value: symbol for symbol, value in self.functions.items()}
        derivative = self.tensor.subs(self.functions).diff(self.angle).subs(back)
        return (self.tensor.T * derivative).applyfunc(self.reduced)


@dataclass(frozen=True)
class MovingFrame:
    """A body base that turns at rate omega, Qdot = Q (generator omega), and the shapes of a body in it.

    `shapes` are the pairs (alphadot_i, alphaddot_i) of the assumed displacement fields of (14).
    """

    generator: sp.Matrix
    omega: sp.Symbol
    omegadot: sp.Symbol
    shapes: tuple[tuple[sp.Symbol, sp.Symbol], ...]

    @property
    def position(self) -> Field:
        """Q^T (x - c) = r."""
        return {R: sp.eye(self.generator.rows)}

    @property
    def velocity(self) -> Field:
        """Q^T (xdot - cdot) = omega x r + rdot."""
        return self.dot(self.position)

    @property
    def acceleration(self) -> Field:
        """Q^T (xddot - cddot) of (5)."""
        return self.dot(self.velocity)

    def dot(self, field: Field) -> Field:
        """The time derivative of Q f, in the body base: fdot + omega x f."""
        return add(
            {name: tensor.diff(self.omega) * self.omegadot for name, tensor in field.items()},
            {RDOT: field[R]} if R in field else {},
            *({phi(i): field[RDOT] * addot} for i, (_, addot) in enumerate(self.shapes, 1) if RDOT in field),
            times(self.generator * self.omega, field),
        )

    def virtual_displacements(self) -> tuple[Field, ...]:
        """Q^T (delta x - delta c) of (6), for a unit variation of the angle and of each alpha_i in turn.

        x depends on time through its coordinates alone, so its variation is its velocity with the rates varied.
        """
        velocity = self.velocity
        turn = {name: tensor.diff(self.omega) for name, tensor in velocity.items()}
        return add(turn), *({phi(i): velocity[RDOT]} for i in range(1, len(self.shapes) + 1))
