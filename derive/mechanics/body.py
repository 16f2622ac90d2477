"""A deformable body as the equations of motion (15) need to know it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Protocol

import sympy as sp

from derive.mechanics.motion.body_motion import MASS, Motion
from derive.mechanics.motion.material_points import MaterialPoint
from derive.mechanics.motion.planar import planar_motion
from derive.mechanics.motion.spatial import spatial_motion
from derive.mechanics.symbols import Family
from derive.mechanics.tables import CoefficientTable, planar_tables
from derive.mechanics.terms import ModelConstant, ParameterSymbol, Term
from derive.mechanics.virtual_work_equations import (
    angular_momentum,
    generic_inertia,
    kinetic_energy,
    linear_momentum,
    rigid_inertia,
)
from derive.spec.model.body import DisplacementOrder

if TYPE_CHECKING:  # a planar body needs no NumPy, nor does a specification that is read
    import numpy as np
    from numpy.typing import NDArray


class Values(Protocol):
    """The entries of the tables of a body."""

    def constants(self, table: CoefficientTable) -> Iterable[ModelConstant]:
        """The entries of a table in the order of `entries`, each with its value, or the reason why it vanishes."""

    def present(self, table: CoefficientTable) -> NDArray[np.bool_]:
        """A mask of the entries that are not structurally zero, by modes and components."""

    def numbers(self, table: CoefficientTable) -> NDArray[np.float64] | None:
        """The entries of a table, i <= j (i < j in an odd table) by rows; None if they are not numbers."""


@dataclass(frozen=True)
class Body:
    """The data of a deformable body in (15), with `modes` assumed modes, in the plane (`dimension` 2) or in space (3).

    `frame_doc` describes the choice of the origin c and of the floating frame. `tables` are the shape integrals, the
    stiffness K and the forces at rest S of U = 1/2 alpha K alpha + S alpha, the damping B, the factor of alphadot, and
    the rotary inertia R of attached masses, the factor of alphaddot besides c8; `values` are their entries.
    `gravity` is the acceleration of free fall in the inertial frame. `order` is that of the displacements.
    With `DisplacementOrder.FULL` the tables are those of the family Phi_1 .. Phi_N, theta_1 .. theta_`fields`, and
    the field weights z_p_i_j give Psi_ij = sum z_p_i_j theta_p; see `motion.full_second_order`.
    """

    name: str
    doc: str
    frame_doc: str
    dimension: int
    modes: int
    mass: sp.Expr
    tables: tuple[CoefficientTable, ...]
    values: Values
    points: tuple[MaterialPoint, ...] = ()
    parameters: tuple[ParameterSymbol, ...] = ()
    gravity: tuple[ModelConstant, ...] = ()
    order: DisplacementOrder = DisplacementOrder.FIRST_ORDER
    fields: int = 0

    @cached_property
    def motion(self) -> Motion:
        """The motion of the body, with all sums over the modes expanded."""
        return (
            planar_motion(self.modes, self.truncated)
            if self.dimension == 2
            else spatial_motion(self.modes, self.truncated)
        )

    @cached_property
    def rigid_motion(self) -> Motion:
        """The motion of the body without assumed modes."""
        return (planar_motion if self.dimension == 2 else spatial_motion)(0, self.truncated)

    @cached_property
    def rigid_inertia(self) -> tuple[Term, ...]:
        """The virtual work of the inertia on the rigid displacements; sums are named."""
        return rigid_inertia(self.rigid_motion)

    @cached_property
    def generic_inertia(self) -> tuple[Term, ...]:
        """The virtual work of the inertia on a variation of alpha_i, for a generic mode i; sums are named."""
        return generic_inertia(self.rigid_motion)

    @cached_property
    def kinetic_energy(self) -> sp.Expr:
        """The kinetic energy 1/2 int rho xdot . xdot; sums are named."""
        return kinetic_energy(self.rigid_motion)

    @cached_property
    def linear_momentum(self) -> tuple[sp.Expr, ...]:
        """The linear momentum int rho xdot along each axis; sums are named."""
        return linear_momentum(self.rigid_motion)

    @cached_property
    def angular_momentum(self) -> tuple[sp.Expr, ...]:
        """The angular momentum int rho x x xdot about the inertial origin; sums are named."""
        return angular_momentum(self.rigid_motion)

    @property
    def truncated(self) -> bool:
        """Whether the moments of the Psi_ij enter through second order alone."""
        return self.order is DisplacementOrder.TRUNCATED

    @property
    def mass_constant(self) -> ModelConstant:
        """The mass of the body."""
        return ModelConstant(MASS, self.mass, "(15)", "mass of the body", "kg")

    @cached_property
    def integrals(self) -> tuple[ModelConstant, ...]:
        """The shape integrals c1 to c8, entry by entry."""
        apart = (Family.STIFFNESS, Family.PRELOAD, Family.DAMPING, Family.ROTARY)
        return tuple(c for table in self.tables if table.family not in apart for c in self.values.constants(table))

    @cached_property
    def field_motion(self) -> Motion:
        """The motion in the family of fields, in which each theta_p has an amplitude of its own."""
        return planar_motion(self.modes + self.fields) if self.fields else self.motion

    @cached_property
    def stiffness(self) -> tuple[ModelConstant, ...]:
        """The entries K_ij of the stiffness matrix, i <= j, in N/m."""
        return self._constants(Family.STIFFNESS)

    @cached_property
    def preload(self) -> tuple[ModelConstant, ...]:
        """The forces S_i at rest, in N; empty if there are none."""
        return self._constants(Family.PRELOAD)

    @cached_property
    def damping(self) -> tuple[ModelConstant, ...]:
        """The entries B_ij of the damping matrix, i <= j, in N s/m; empty if all of them vanish."""
        constants = self._constants(Family.DAMPING)
        return constants if any(not c.zero for c in constants) else ()

    @cached_property
    def rotary_inertia(self) -> tuple[ModelConstant, ...]:
        """The entries R_ij of the rotary inertia of attached masses, i <= j, in kg; empty if there is none."""
        return self._constants(Family.ROTARY)

    def table(self, family: Family) -> CoefficientTable:
        """The table of an integral."""
        return next(table for table in self.tables if table.family is family)

    def _constants(self, family: Family) -> tuple[ModelConstant, ...]:
        return tuple(c for table in self.tables if table.family is family for c in self.values.constants(table))


@dataclass(frozen=True)
class ExactValues:
    """Entries that are exact expressions, each known individually."""

    every: tuple[ModelConstant, ...]

    def constants(self, table: CoefficientTable) -> Iterable[ModelConstant]:
        """Return the constants of a table, see `Values`."""
        return (c for c in self.every if c.symbol.identity.family is table.family)

    def present(self, table: CoefficientTable) -> NDArray[np.bool_]:
        """Return the mask of a table, see `Values`."""
        raise NotImplementedError("planar bodies are lowered to straight-line code alone")

    def numbers(self, table: CoefficientTable) -> NDArray[np.float64] | None:
        """Return the numbers of a table, see `Values`."""
        return None


def planar_body(
    name: str,
    doc: str,
    frame_doc: str,
    modes: int,
    mass: sp.Expr,
    constants: tuple[ModelConstant, ...],
    points: tuple[MaterialPoint, ...] = (),
    parameters: tuple[ParameterSymbol, ...] = (),
    gravity: tuple[ModelConstant, ...] = (),
    order: DisplacementOrder = DisplacementOrder.FIRST_ORDER,
    fields: int = 0,
) -> Body:
    """A planar body given by its shape integrals and its stiffness, entry by entry."""
    tables, values = planar_tables(constants), ExactValues(constants)
    return Body(name, doc, frame_doc, 2, modes, mass, tables, values, points, parameters, gravity, order, fields)
