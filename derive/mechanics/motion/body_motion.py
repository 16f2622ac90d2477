"""The motion of a body in the plane or in space: coordinates, rotation, moving frame and moments."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.motion.kinematics import ONE, Field, MovingFrame
from derive.mechanics.motion.moments import Moments, total
from derive.mechanics.symbols import amplitude
from derive.mechanics.terms import Coordinate, EquationOfMotion, Intermediate

if TYPE_CHECKING:
    from derive.mechanics.sums import IndexedSum


@dataclass(frozen=True, eq=False)
class Motion:
    """The motion of a body with some number of shapes: coordinates, rotation tensor Q, moving frame, and moments.

    Bodies with the same number of shapes share one object, by whose identity results are kept.

    `moment_sums` define d1, D2, d3, J in terms of the shape integrals; `row_sums` occur in a single equation or contain
    accelerations, and are expanded in place; `products` gives names to products of velocities, which `named` defines.
    `rotation_generators` are the tensors e_k x, in the inertial and in the body frame. `identities` are the reasons of
    terms that cancel in any body, by row and name.
    """

    coordinates: tuple[Coordinate, ...]
    rows: tuple[EquationOfMotion, ...]
    rates: tuple[sp.Expr, ...]
    alpha: tuple[sp.Symbol, ...]
    rotation: sp.Matrix
    rotation_definitions: tuple[Intermediate, ...]
    frame: MovingFrame
    moments: Moments
    named: tuple[Intermediate, ...]
    moment_sums: tuple[IndexedSum, ...]
    row_sums: tuple[IndexedSum, ...]
    products: dict[sp.Expr, sp.Symbol]
    rotation_generators: tuple[tuple[sp.Matrix, sp.Matrix], ...]
    identities: dict[tuple[str, str], str]

    def with_modes(self, n: int) -> Motion:
        """The motion of a body with n assumed modes, whose amplitudes follow the coordinates of this rigid motion."""
        alpha, rows, modes = tuple(map(amplitude, range(1, n + 1))), [], []
        for i, q in enumerate(alpha, 1):
            v, a = (amplitude(i, derivative) for derivative in (1, 2))
            modes.append(Coordinate(q, f"amplitude of assumed mode {i}", "m"))
            rows.append(EquationOfMotion(q.name, v, a, f"time derivative of {q.name}", "m/s", "N"))
        return replace(
            self,
            coordinates=(*self.coordinates, *modes),
            rows=(*self.rows, *rows),
            rates=(*self.rates, *(row.v for row in rows)),
            alpha=alpha,
        )

    @property
    def rigid_rows(self) -> tuple[EquationOfMotion, ...]:
        """The rows of the rigid motion."""
        return self.rows[: len(self.rows) - len(self.alpha)]

    @property
    def mode_rows(self) -> tuple[EquationOfMotion, ...]:
        """The rows of the assumed modes."""
        return self.rows[len(self.rows) - len(self.alpha) :]

    @property
    def alphadot(self) -> tuple[sp.Symbol, ...]:
        """The generalised velocities of the shapes."""
        return tuple(row.v for row in self.mode_rows)

    @property
    def alphaddot(self) -> tuple[sp.Symbol, ...]:
        """The accelerations of the shapes."""
        return tuple(row.a for row in self.mode_rows)

    @property
    def position(self) -> Field:
        """The position x of (1)."""
        return {ONE: sp.Matrix([c.q for c in self.coordinates[: self.rotation.rows]]), **self.frame.position}

    @property
    def velocity(self) -> Field:
        """The velocity xdot."""
        return {ONE: sp.Matrix([row.v for row in self.rows[: self.rotation.rows]]), **self.frame.velocity}

    @property
    def acceleration(self) -> Field:
        """The acceleration xddot of (5)."""
        return {ONE: sp.Matrix([row.a for row in self.rows[: self.rotation.rows]]), **self.frame.acceleration}

    @property
    def translations(self) -> tuple[Field, ...]:
        """The virtual displacements delta x for unit variations of c."""
        unit = sp.eye(self.rotation.rows)
        return tuple({ONE: unit[:, k]} for k in range(unit.rows))

    def product(self, a: Field, b: Field) -> sp.Expr:
        """The integral int rho a . b over the body, for a generic index i if a or b holds PHI."""
        return total(a, b, self.moments)
