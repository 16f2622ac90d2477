"""The equations of motion of a model: terms, definitions, constants, energies, markers and constraints."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import sympy as sp

from derive import display
from derive.garbage_collection import paused
from derive.mechanics.body import Body
from derive.mechanics.expansion import expand
from derive.mechanics.sums import ModeSum, TableSum
from derive.mechanics.symbols import Family
from derive.mechanics.tables import CoefficientTable
from derive.mechanics.terms import (
    Constraint,
    Coordinate,
    Eliminated,
    EquationOfMotion,
    InputSymbol,
    Intermediate,
    MarkerEquations,
    ModelConstant,
    OutputEquation,
    ParameterSymbol,
    Pose,
    Reason,
    Term,
    Vanished,
)
from derive.spec.model.body import Lowering
from derive.spec.model.time_function import Spline

WIDTH = 110
"""The number of characters of a line of equations as text."""
MOST_LINES = 3
"""The largest number of lines of one equation."""
MOST_EQUATIONS = 14
"""The largest number of equations of one block."""


@dataclass(frozen=True)
class Equations:
    """The equations of motion of one model: the sum of the terms of each row is zero (no load at markers).

    They come in two forms. As `derive` returns them for a body, sums over the shapes are kept: there are the rows of
    the rigid motion and one row for a generic shape i, whose name is alpha_i, and expressions are in `definitions`
    (scalars), in `tables`, in `table_sums`, in `mode_sums` made of these, and in the alpha_i. The second form,
    `expanded()`, has no sums: a row for each shape function, no tables, and no terms that vanish.

    The expanded equations of a mechanism are those of its bodies, with `constraints`: the sum of a row is then what
    the multipliers contribute, sum lambda_k jacobian_k. `poses` are those of its bodies, `inputs` and `outputs` those
    of the scene, `eliminated` says what is not modelled.

    `frame_doc` describes where c is. `rates` gives the time derivatives of the coordinates. `coefficients` hold what
    depends on parameters alone, such as the shape integrals c1..c8 and the stiffness, `definitions` d1, D2, d3, J and
    what else is shared; both keep their zeros, with reasons. `mass` and `mass_zeros` belong to the expanded form: the
    mass matrix, and the row, column (lower triangle) and reason of each structural zero. `weight_energy` is the
    potential of gravity, None where there is none.

    `splines` are the tables of values that definitions look up.

    `body` is what the equations of a body were derived from, and `lowering` what its specification asks of the
    lowering.
    """

    name: str
    doc: str
    frame_doc: str
    coordinates: tuple[Coordinate, ...]
    rows: tuple[EquationOfMotion, ...]
    rates: tuple[sp.Expr, ...]
    parameters: tuple[ParameterSymbol, ...]
    coefficients: tuple[ModelConstant, ...]
    definitions: tuple[Intermediate, ...]
    terms: tuple[Term, ...]
    vanished: tuple[Vanished, ...]
    mass: sp.ImmutableMatrix
    mass_zeros: tuple[tuple[int, int, Reason], ...]
    kinetic_energy: sp.Expr
    strain_energy: sp.Expr
    weight_energy: sp.Expr | None
    linear_momentum: tuple[sp.Expr, ...]
    angular_momentum: tuple[sp.Expr, ...]
    markers: tuple[MarkerEquations, ...]
    constraints: tuple[Constraint, ...] = ()
    poses: tuple[Pose, ...] = ()
    inputs: tuple[InputSymbol, ...] = ()
    outputs: tuple[OutputEquation, ...] = ()
    eliminated: tuple[Eliminated, ...] = ()
    tables: tuple[CoefficientTable, ...] = ()
    table_sums: tuple[TableSum, ...] = ()
    mode_sums: tuple[ModeSum, ...] = ()
    body: Body | None = None
    lowering: Lowering = "auto"
    splines: tuple[Spline, ...] = ()

    @property
    def indexed(self) -> bool:
        """Whether the equations keep their sums over the modes (the form that loops are generated from)."""
        return bool(self.tables)

    @property
    def modes(self) -> int:
        """The number of assumed modes of a body; 0 for a mechanism."""
        return self.body.modes if self.body else 0

    @property
    def truncated(self) -> bool:
        """Whether moments of second-order fields enter through second order, as c9, c10 and in C5."""
        return self.body is not None and self.body.truncated

    def expanded(self) -> Equations:
        """Return the equations with all sums over the modes expanded, and one row for each mode."""
        return self._expanded if self.indexed else self

    @cached_property
    def _expanded(self) -> Equations:
        assert self.body is not None
        with paused():
            form = expand(self.body)
        return replace(
            self, tables=(), table_sums=(), mode_sums=(), **{name: getattr(form, name) for name in form.__match_args__}
        )

    @property
    def force(self) -> tuple[sp.Expr, ...]:
        """The forces h of M vdot + h = 0: the rows with all accelerations set to zero."""
        at_rest = {row.a: sp.S.Zero for row in self.rows}
        return tuple(self.sum_of(row.name).xreplace(at_rest) for row in self.rows)

    def table(self, family: Family) -> CoefficientTable:
        """The table of a family of integrals; StopIteration if the equations have none."""
        return next(t for t in self.tables if t.family is family)

    def marker(self, name: str) -> MarkerEquations:
        """The marker with this name; StopIteration if there is none."""
        return next(m for m in self.markers if m.name == name)

    def reason(self, *families: Family) -> Reason:
        """The reason why a quantity vanishes: the tables of these families are zero."""
        return Reason(tuple((t.symbol, t.zero) for t in map(self.table, families)))

    def sum_of(self, row: str) -> sp.Expr:
        """The left-hand side of one equation of motion, in coefficients, definitions and sums."""
        return sp.Add(*(t.expr for t in self.terms if t.row == row))

    def row(self, name: str) -> sp.Expr:
        """The left-hand side of one equation of motion in coordinates, velocities, accelerations and parameters.

        The row of shape 1 has the name `alpha1`.
        """
        form = self.expanded()
        return form.substituted(form.sum_of(name))

    def substituted(self, expr: sp.Expr) -> sp.Expr:
        """An expression of the expanded form with every definition and coefficient substituted."""
        for definition in reversed(self.definitions):
            expr = expr.subs(definition.symbol, definition.expr)
        return sp.expand(expr.subs({c.symbol: c.value for c in self.coefficients}))

    def __str__(self) -> str:
        """The equations row by row, with their sums kept, shortened to a page."""
        sums: list[tuple[str, sp.Expr | str]] = []
        for c in self.table_sums:
            products = " + ".join(f"sum_j {factor}*{entry}" for factor, entry in c.sums)
            sums.append((c.symbol.name, f"{c.offset} + {products}" if c.offset != 0 else products))
        for s in self.mode_sums:
            sums.append((s.symbol.name, f"{s.offset} + sum_i ({s.term})" if s.offset != 0 else f"sum_i ({s.term})"))
        rows = [(f"{row.name}: 0", self.sum_of(row.name)) for row in self.rows]
        law = "Equations of motion, without the constraint reactions" if self.constraints else "Equations of motion"
        definitions = [(d.symbol.name, d.expr) for d in self.definitions if not d.zero]
        constraints = [("0", c.position) for c in self.constraints]
        return _page(
            [
                [f"{self.name}: {self.doc}"],
                _block(f"{law}:", rows),
                _block("Constraints:", constraints),
                _block("with", definitions),
                _block("and the sums over the shapes", sums),
            ]
        )

    def _repr_html_(self) -> str:
        """The HTML that notebooks display."""
        return display.html(self)


def _equation(left: str, right: sp.Expr | str) -> list[str]:
    """The lines of an equation, wrapped; a long equation is shortened to its beginning."""
    lines = textwrap.wrap(f"{left} = {right}", WIDTH, subsequent_indent="        ")
    return lines if len(lines) <= MOST_LINES else [*lines[: MOST_LINES - 1], f"        ... ({len(lines)} lines in all)"]


def _block(title: str, equations: Sequence[tuple[str, sp.Expr | str]]) -> list[str]:
    """A titled list of equations; of a long list the first equations, with the number of the others."""
    if not equations:
        return []
    lines = [title]
    for left, right in equations[:MOST_EQUATIONS]:
        lines += [f"  {line}" for line in _equation(left, right)]
    more = len(equations) - MOST_EQUATIONS
    return [*lines, f"  ... and {more} more"] if more > 0 else lines


def _page(blocks: Iterable[list[str]]) -> str:
    """Join blocks with an empty line between them."""
    return "\n\n".join("\n".join(lines) for lines in blocks if lines)
