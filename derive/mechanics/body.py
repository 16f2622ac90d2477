"""A deformable body as the equations of motion (15) need to know it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import TYPE_CHECKING, Protocol

from derive.mechanics.generic_forces import FORCES
from derive.mechanics.motion.planar import planar_motion
from derive.mechanics.motion.spatial import spatial_motion
from derive.mechanics.symbols import Family, quantity
from derive.mechanics.tables import PLANAR_DOCS, CoefficientTable, exact_tables
from derive.mechanics.terms import ModelConstant, ParameterSymbol
from derive.mechanics.virtual_work_equations import VirtualWork, virtual_work
from derive.spec.model.body import DisplacementOrder

if TYPE_CHECKING:  # a planar body needs no NumPy, nor does a specification that is read
    import numpy as np
    from numpy.typing import NDArray

    from derive.algebra import sp
    from derive.mechanics.motion.body_motion import Motion
    from derive.mechanics.motion.material_points import MaterialPoint


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

    @property
    def virtual_work(self) -> VirtualWork:
        """The equations of motion before anything vanishes, which bodies of the same kinematics share."""
        return virtual_work(self.dimension, self.truncated)

    @property
    def motion(self) -> Motion:
        """The motion of the body with its assumed modes."""
        return self._kinematics(self.modes, self.truncated)

    @property
    def field_motion(self) -> Motion:
        """The motion in the family of fields, in which each theta_p has an amplitude of its own."""
        return self._kinematics(self.modes + self.fields) if self.fields else self.motion

    @property
    def _kinematics(self) -> Callable[..., Motion]:
        return planar_motion if self.dimension == 2 else spatial_motion

    @property
    def truncated(self) -> bool:
        """Whether the moments of the Psi_ij enter through second order alone."""
        return self.order is DisplacementOrder.TRUNCATED

    @property
    def mass_constant(self) -> ModelConstant:
        """The mass of the body."""
        return ModelConstant(quantity(Family.MASS), self.mass, "(15)", "mass of the body", "kg")

    @cached_property
    def constants(self) -> tuple[ModelConstant, ...]:
        """The mass, the integrals and the entries of the tables of forces, entry by entry, then gravity and points.

        Of a body without damping, whose table vanishes altogether, there are no entries of damping.
        """
        forces = [force.family for force in FORCES]
        integrals = (t.family for t in self.tables if t.family not in forces)
        every = {family: self._entries(family) for family in (*integrals, *forces)}
        if all(c.zero for c in every[Family.DAMPING]):
            del every[Family.DAMPING]
        of_points = (c for point in self.points for c in point.coefficients)
        return (self.mass_constant, *chain.from_iterable(every.values()), *self.gravity, *of_points)

    def table(self, family: Family) -> CoefficientTable:
        """The table of an integral."""
        return next(table for table in self.tables if table.family is family)

    def _entries(self, family: Family) -> tuple[ModelConstant, ...]:
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
    tables, values = exact_tables(constants, PLANAR_DOCS, 2), ExactValues(constants)
    return Body(name, doc, frame_doc, 2, modes, mass, tables, values, points, parameters, gravity, order, fields)
