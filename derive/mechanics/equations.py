"""The equations of motion of a model: terms, definitions, constants, energies, markers and constraints."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from derive import display
from derive.algebra import sp
from derive.registry import UnknownNameError
from derive.short_text import listed, summary
from derive.spec.model.time_function import Spline

if TYPE_CHECKING:
    from derive.mechanics.body import Body
    from derive.mechanics.multibody.space.tree.recursions import TreeBody
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

    Attributes:
        name: the name of the model.
        doc: the kind of model in words.
        frame_doc: where the origin c of the floating frame is, in words.
        coordinates: q with their symbols, units and roles.
        rows: the equations of motion by their names, with the symbols of velocities and accelerations.
        rates: the time derivatives of the coordinates, in velocities.
        parameters: the symbols of run-time parameters with their defaults.
        coefficients: what depends on parameters alone, such as the shape integrals c1..c8 and the stiffness, with zeros
            and the reasons for them.
        definitions: d1, D2, d3, J and what else is shared, with zeros and the reasons for them.
        terms: the terms of all rows, with their names and the numbers of their equations in the paper.
        vanished: the terms that vanish, with the reasons.
        kinetic_energy: in coefficients, definitions and sums, J.
        strain_energy: likewise, J.
        weight_energy: the potential of gravity, J; None where there is no gravity.
        linear_momentum: its components in the inertial frame, kg m/s.
        angular_momentum: its components about the origin of the inertial frame, kg m^2/s.
        mass_moments: the mass, kg, and the first moments of mass in the inertial frame, kg m.
        markers: the positions, velocities and Jacobians of markers.
        constraints: those of a mechanism; the sum of a row is then what the multipliers contribute, sum lambda_k
            jacobian_k.
        poses: those of the bodies of a mechanism.
        inputs: those of a scene.
        outputs: those of a scene.
        eliminated: what is eliminated or left out, and why.
        splines: the tables of values that definitions look up.
        mass: the mass matrix.
        mass_zeros: row, column (lower triangle) and reason of each of its structural zeros.
        body: what the equations of a body were derived from.
        trees: the rigid bodies in space whose rows are those of joints between bodies that move, those before others
            first, for lowerings by recursions.

    Examples:
        >>> import derive
        >>> equations = derive.derive(derive.planar_beam("beam")).expanded()
        >>> equations.mass[0, 0], equations.mass[2, 2]
        (mass, J)
        >>> equations.strain_energy
        K_1_1*alpha1**2/2 + K_2_2*alpha2**2/2
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
    mass_moments: tuple[sp.Expr, ...] = ()
    trees: tuple[TreeBody, ...] = ()

    @property
    def modes(self) -> int:
        """The number of assumed modes of a body; 0 for a mechanism."""
        return self.body.modes if self.body else 0

    @property
    def truncated(self) -> bool:
        """Whether moments of second-order fields enter through second order, as c9, c10 and in C5."""
        return self.body is not None and self.body.truncated

    def expanded(self) -> Equations:
        """Return the equations with a row for each coordinate, which these are.

        Examples:
            >>> equations.expanded() is equations
            True
        """
        return self

    @property
    def force(self) -> tuple[sp.Expr, ...]:
        """The forces h of M vdot + h = 0: the rows with all accelerations set to zero."""
        at_rest = {row.a: sp.S.Zero for row in self.rows}
        return tuple(self.sum_of(row.name).xreplace(at_rest) for row in self.rows)

    def marker(self, name: str) -> MarkerEquations:
        """The position, velocity and Jacobian of the marker with this name.

        Raises:
            UnknownNameError: if there is none.

        Examples:
            >>> with_tip = derive.derive(derive.planar_beam("beam", markers={"tip": 1})).expanded()
            >>> with_tip.marker("tip").name
            'tip'
        """
        for marker in self.markers:
            if marker.name == name:
                return marker
        raise UnknownNameError(f"marker of {self.name}", name, (marker.name for marker in self.markers))

    def sum_of(self, row: str) -> sp.Expr:
        """The left-hand side of the equation of motion `row`, in coefficients, definitions and sums.

        Raises:
            UnknownNameError: if there is no such row.

        Examples:
            >>> equations.sum_of("c1")
            c1ddot*mass
        """
        exprs = [t.expr for t in self.terms if t.row == row]
        names = [r.name for r in self.rows] if not exprs else []
        if not exprs and row not in names:
            raise UnknownNameError(f"equation of motion of {self.name}", row, names)
        return sp.Add(*exprs)

    def row(self, name: str) -> sp.Expr:
        """The left-hand side of one equation of motion in coordinates, velocities, accelerations and parameters.

        The row of mode 1 has the name `alpha1`.

        Raises:
            UnknownNameError: if there is no row with this name.

        Examples:
            >>> equations.row("c1")
            c1ddot*m
        """
        form = self.expanded()
        return form.substituted(form.sum_of(name))

    def substituted(self, expr: sp.Expr) -> sp.Expr:
        """The expression `expr` with every definition and coefficient substituted.

        Examples:
            >>> equations.substituted(equations.mass[0, 0])
            m
        """
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

    def __repr__(self) -> str:
        names = listed(row.name for row in self.rows)
        symbols = [parameter.symbol.name for parameter in self.parameters]
        return summary(
            f"{type(self).__name__} {self.name}: {self.doc}",
            {
                "rows": names,
                "terms": f"{len(self.terms)}, and {len(self.vanished)} that vanish",
                "constraints": listed(constraint.name for constraint in self.constraints),
                "parameters": listed(symbols),
            },
        )


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
