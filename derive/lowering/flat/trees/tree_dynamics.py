"""The equations of motion of a model by recursions along its trees, and its accelerations if it has nothing else."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from derive.algebra import sp
from derive.ir.statements import Requirement, ReturnCode
from derive.lowering.flat.casadi_symbols import Symbols, added, multiplied, subtracted
from derive.lowering.flat.context import Context
from derive.lowering.flat.schedule import RequiredValue
from derive.lowering.flat.trees.composite_bodies import mass_entries
from derive.lowering.flat.trees.links import TreeFrame, TreeFrames
from derive.lowering.flat.trees.recursions import ArticulatedBodies, forces, motions, needed
from derive.lowering.flat.trees.spatial_vectors import dot, plus, times
from derive.lowering.flat.trees.steps import SingleFreedom, Turn, TurnedFrame, Wrench
from derive.lowering.ldlt import VANISHING
from derive.lowering.vectors import Vector
from derive.mechanics.axes import AXES
from derive.mechanics.equations import Equations
from derive.mechanics.multibody.space.tree.recursions import INERTIAL
from derive.mechanics.symbols import Family, identity


@dataclass(frozen=True)
class TreeDynamics:
    """The trees of a model in the symbols of a kernel: their links, and the rows that are theirs."""

    context: Context
    symbols: Symbols
    frames: TreeFrames
    rows: frozenset[int]

    @property
    def links(self) -> Sequence[TreeFrame]:
        """The bodies of the trees, those before others first."""
        return self.frames.every

    @cached_property
    def still(self) -> list[TurnedFrame]:
        """The motions without accelerations of the coordinates."""
        return motions(self.links, {})

    @property
    def wrenches(self) -> list[Wrench]:
        """The wrenches that the links need without accelerations of the coordinates."""
        return [needed(link, m) for link, m in zip(self.links, self.still, strict=True)]

    def bias(self, body: str, place: Vector) -> tuple[Vector, Vector]:
        """The accelerations of a point of a link without those of the coordinates, linear and angular, in the link."""
        m, fall = self.still[self.frames.numbers[body]], [-x for x in self.frames.upwards]
        linear = plus(plus(m.linear, self.frames.resolved(body, fall)), times(m.of_points, place))
        return linear, m.angular

    def applied(self, row: int) -> ca.SX:
        """The terms of a row of h besides the inertia and the weight of its tree."""
        eq = self.context.equations
        name, at_rest = eq.rows[row].name, {of.a: sp.S.Zero for of in eq.rows}
        others = (term.expr for term in eq.terms if term.row == name and term.equation != INERTIAL)
        return self.symbols(sp.Add(*others).xreplace(at_rest))

    def forces(self, accelerations: Sequence[ca.SX] = ()) -> dict[int, ca.SX]:
        """The rows of h that are those of trees; those of M vdot + h with accelerations of all rows."""
        moving = motions(self.links, dict(enumerate(accelerations))) if accelerations else self.still
        needs = [needed(link, m) for link, m in zip(self.links, moving, strict=True)]
        return {row: added(force, self.applied(row)) for row, force in forces(self.links, needs).items()}

    def in_order(self) -> Iterator[int]:
        """The rows in the order of their elimination."""
        for link in reversed(self.links):
            yield from (step.row for step in reversed(link.steps) if isinstance(step, SingleFreedom))

    def pivot_checks(
        self, bodies: ArticulatedBodies, more: Sequence[tuple[int, ca.SX, ca.SX]]
    ) -> Iterator[RequiredValue]:
        """The checks that each pivot exceeds the rounding errors of the inertia behind it, whose size is a constant.

        more: masses and moments of inertia that links have besides their own, by number.
        """
        margin = self.symbols.number(VANISHING)
        masses = [link.mass for link in self.links]
        inertias = [link.half_trace for link in self.links]
        for n, mass, moment in more:
            masses[n], inertias[n] = added(masses[n], mass), added(inertias[n], moment)
        for n in reversed(range(len(self.links))):
            link = self.links[n]
            for step in reversed(link.steps):
                if isinstance(step, SingleFreedom):
                    size = inertias[n] if step.turns else masses[n]
                    above = subtracted(bodies.eliminated[step.row].pivot, multiplied(margin, size))
                    text = f"the pivot of {self.context.rows[step.row]} vanished"
                    yield RequiredValue(Requirement.POSITIVE, above, ReturnCode.PIVOT, text)
            if link.parent >= 0:
                moved = multiplied(masses[n], dot(link.place, link.place))
                inertias[link.parent] = added(inertias[link.parent], added(inertias[n], moved))
                masses[link.parent] = added(masses[link.parent], masses[n])


def tree_dynamics(context: Context, symbols: Symbols) -> TreeDynamics | None:
    """The trees of a model; None if there are none, or if results have to be exact beside unit quaternions."""
    eq = context.equations
    if not eq.trees:
        return None
    numbers = {name: n for n, name in enumerate(context.rows)}
    frames = TreeFrames(symbols, eq.trees, numbers, _gravity(eq))
    steps = [step for link in frames.every for step in link.steps]
    if context.sensitivities and any(isinstance(step, Turn) and step.free for step in steps):
        return None
    return TreeDynamics(
        context, symbols, frames, frozenset(step.row for step in steps if isinstance(step, SingleFreedom))
    )


def _gravity(equations: Equations) -> sp.Matrix:
    """The acceleration of free fall (3, 1)."""
    known = {
        of.components: c.symbol
        for c in equations.coefficients
        if not c.zero and (of := identity(c.symbol)).family is Family.GRAVITY
    }
    return sp.Matrix([known.get((k,), sp.S.Zero) for k in AXES])


def force_values(context: Context, symbols: Symbols) -> list[ca.SX]:
    """The rows of h, by recursions where they are those of trees."""
    tree = tree_dynamics(context, symbols)
    known = tree.forces() if tree else {}
    return [known[n] if n in known else symbols(context.force_rows[n]) for n in range(len(context.rows))]


def mass_values(context: Context, symbols: Symbols) -> list[ca.SX]:
    """The entries of M in its pattern, by composite bodies where they are those of trees."""
    tree, mass = tree_dynamics(context, symbols), context.equations.mass
    known = mass_entries(tree.links) if tree else {}
    return [known[at] if at in known else symbols(mass[at]) for at in context.mass_pattern().entries]
