"""The equations of motion of a model: terms, definitions, constants, energies, markers and constraints."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import sympy as sp

from derive import display
from derive.mechanics.body import Body
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
    SpatialPose,
    Term,
    Vanished,
)
from derive.spec.model.time_function import Spline

WIDTH = 110
"""The number of characters of a line of equations as text."""
MOST_LINES = 3
"""The largest number of lines of one equation."""
MOST_EQUATIONS = 14
"""The largest number of equations of one block."""


NO_MATRIX = sp.ImmutableMatrix(0, 0, [])


@dataclass(frozen=True)
class Equations:
    """The equations of motion of one model: the sum of the terms of each row is zero (no load at markers).

    There is a row for each coordinate velocity, and no term vanishes. `IndexedEquations` keep their sums over the modes
    instead, in a row for a generic mode, and `expanded()` returns this form of them.

    The equations of a mechanism are those of its bodies, with `constraints`: the sum of a row is then what the
    multipliers contribute, sum lambda_k jacobian_k. `poses` are those of its bodies, `inputs` and `outputs` those of
    the scene, `eliminated` says what is eliminated or left out and why, and `splines` are the tables of values that
    definitions look up.

    `frame_doc` describes where c is. `rates` gives the time derivatives of the coordinates. `coefficients` hold what
    depends on parameters alone, such as the shape integrals c1..c8 and the stiffness, `definitions` d1, D2, d3, J and
    what else is shared; both keep their zeros, with reasons. `mass` is the mass matrix, and `mass_zeros` are the row,
    column (lower triangle) and reason of each of its structural zeros. `weight_energy` is the potential of gravity,
    None where there is none. `body` is what the equations of a body were derived from.
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
    kinetic_energy: sp.Expr
    strain_energy: sp.Expr
    weight_energy: sp.Expr | None
    linear_momentum: tuple[sp.Expr, ...]
    angular_momentum: tuple[sp.Expr, ...]
    markers: tuple[MarkerEquations, ...]
    constraints: tuple[Constraint, ...] = ()
    poses: tuple[Pose, ...] | tuple[SpatialPose, ...] = ()
    inputs: tuple[InputSymbol, ...] = ()
    outputs: tuple[OutputEquation, ...] = ()
    eliminated: tuple[Eliminated, ...] = ()
    splines: tuple[Spline, ...] = ()
    mass: sp.ImmutableMatrix = NO_MATRIX
    mass_zeros: tuple[tuple[int, int, Reason], ...] = ()
    body: Body | None = None

    @property
    def modes(self) -> int:
        """The number of assumed modes of a body; 0 for a mechanism."""
        return self.body.modes if self.body else 0

    @property
    def truncated(self) -> bool:
        """Whether moments of second-order fields enter through second order, as c9, c10 and in C5."""
        return self.body is not None and self.body.truncated

    def expanded(self) -> Equations:
        """Return the equations with a row for each coordinate, which these are."""
        return self

    @property
    def force(self) -> tuple[sp.Expr, ...]:
        """The forces h of M vdot + h = 0: the rows with all accelerations set to zero."""
        at_rest = {row.a: sp.S.Zero for row in self.rows}
        return tuple(self.sum_of(row.name).xreplace(at_rest) for row in self.rows)

    def marker(self, name: str) -> MarkerEquations:
        """The marker with this name; StopIteration if there is none."""
        return next(m for m in self.markers if m.name == name)

    def sum_of(self, row: str) -> sp.Expr:
        """The left-hand side of one equation of motion, in coefficients, definitions and sums."""
        return sp.Add(*(t.expr for t in self.terms if t.row == row))

    def row(self, name: str) -> sp.Expr:
        """The left-hand side of one equation of motion in coordinates, velocities, accelerations and parameters.

        The row of mode 1 has the name `alpha1`.
        """
        form = self.expanded()
        return form.substituted(form.sum_of(name))

    def substituted(self, expr: sp.Expr) -> sp.Expr:
        """An expression with every definition and coefficient substituted."""
        for definition in reversed(self.definitions):
            expr = expr.subs(definition.symbol, definition.expr)
        return sp.expand(expr.subs({c.symbol: c.value for c in self.coefficients}))

    def __str__(self) -> str:
        """The equations row by row, shortened to a page."""
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
                _block("and the sums over the shapes", self._sums()),
            ]
        )

    def _sums(self) -> list[tuple[str, sp.Expr | str]]:
        """The sums over the modes that the equations keep, as text: name and value."""
        return []

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
