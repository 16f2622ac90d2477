"""The equations of motion of a tree of rigid bodies, by recursions along it.

d'Alembert's virtual work of a body on a unit virtual displacement of row j is T_j . f + e_j . n, with the force f and
the torque n about its origin O that its motion needs. What the bodies behind a joint need is summed up from the leaves:
the mass, first moment and inertia of all bodies behind it (composite bodies) for the factors of the accelerations, and
the forces and torques without these accelerations (the recursion of Newton and Euler) for the others.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.axes import AXES, PAIRS
from derive.mechanics.motion.products import product
from derive.mechanics.motion.vectors import cross, dot
from derive.mechanics.multibody.space.tree.carried_motion import CarriedMotion, TreeDefinitions, summed
from derive.mechanics.symbols import Family, identity, owned
from derive.mechanics.terms import Intermediate, Reason, Term

if TYPE_CHECKING:
    from derive.mechanics.multibody.space.frame_motion import VirtualMotion
    from derive.mechanics.terms import EquationOfMotion, ModelConstant


@dataclass(frozen=True)
class CompositeInertia:
    """The mass, first moment (3, 1) and inertia (3, 3) about a point, of one body or several, in the inertial frame."""

    mass: sp.Expr
    moment: sp.Matrix
    tensor: sp.Matrix

    def momentum(self, v: VirtualMotion) -> tuple[sp.Matrix, sp.Matrix]:
        """The linear momentum and the angular momentum about the point, for a unit rate of a virtual motion of it."""
        linear = summed([v.translation * self.mass, cross(v.rotation, self.moment)])
        angular = summed([cross(self.moment, v.translation), product(self.tensor, sp.Matrix(v.rotation))])
        return linear, angular

    def carried(self, motion: CarriedMotion) -> CompositeInertia:
        """The inertia that the body before it carries: a mass at the point, if this does not turn with that body."""
        return self if motion.turns_with_parent else CompositeInertia(self.mass, sp.zeros(3, 1), sp.zeros(3, 3))


BRANCHES = "they are motions of joints on different branches of a tree"
INERTIAL = "(15)"
"""The equation of all terms of a tree; those of loads on its bodies have another one."""


@dataclass(frozen=True)
class TreeEquations:
    """The contribution of a tree to the equations of motion: its definitions, the terms of all rows, and zeros of M."""

    definitions: tuple[Intermediate, ...]
    terms: tuple[Term, ...]
    mass_zeros: tuple[tuple[str, str, Reason], ...]


@dataclass(frozen=True)
class TreeBody:
    """A body of a tree: its motion, and the symbols of its mass and of the moments of X in its frame."""

    name: str
    motion: CarriedMotion
    mass: sp.Expr
    moment: sp.Matrix
    tensor: sp.Matrix


def tree_body(name: str, group: str, motion: CarriedMotion, constants: Sequence[ModelConstant]) -> TreeBody:
    """The body of a tree with these constants, the names of whose symbols begin with `group`."""
    known = {
        (of.family, of.components): owned(c.symbol, group)
        for c in constants
        if not c.zero and c.value != 0 and (of := identity(c.symbol)).owner == ""
    }
    moment = sp.Matrix([known.get((Family.C1, (k,)), sp.S.Zero) for k in AXES])
    tensor = sp.zeros(3, 3)
    for a, b in PAIRS:
        tensor[a - 1, b - 1] = tensor[b - 1, a - 1] = known.get((Family.C3, (a, b)), sp.S.Zero)
    return TreeBody(name, motion, known.get((Family.MASS, ()), sp.S.Zero), moment, tensor)


def tree_equations(bodies: Sequence[TreeBody], gravity: sp.Matrix) -> TreeEquations:
    """The equations of trees; bodies: those before others first. gravity: the acceleration, zeros if there is none."""
    return _Recursions(bodies, gravity).equations()


class _Recursions:
    def __init__(self, bodies: Sequence[TreeBody], gravity: sp.Matrix) -> None:
        self.bodies, self.gravity = bodies, gravity
        self.own: list[Intermediate] = []
        self.behind: list[Intermediate] = []
        self.children: dict[str, list[TreeBody]] = {body.name: [] for body in bodies}
        for body in bodies:
            if body.motion.parent in self.children:
                self.children[body.motion.parent].append(body)

    def equations(self) -> TreeEquations:
        """The definitions and the terms."""
        inertias = {body.name: self._inertia(body) for body in self.bodies}
        composites: dict[str, CompositeInertia] = {}
        forces: dict[str, tuple[sp.Matrix, sp.Matrix]] = {}
        factors: dict[str, dict[str, sp.Expr]] = {}
        terms: list[Term] = []
        for body in reversed(self.bodies):
            composites[body.name] = self._composite(body, inertias[body.name], composites)
            forces[body.name] = self._behind(body, inertias[body.name], forces)
        for body in self.bodies:
            for row, v in zip(body.motion.own_rows, body.motion.own_virtual, strict=True):
                self._couple(body, row, v, composites[body.name], factors)
        rows = {row.name: row for body in self.bodies for row in body.motion.own_rows}
        for name, of in factors.items():
            inertial = sp.Add(*(factor * rows[other].a for other, factor in of.items()))
            terms.append(Term(name, "inertia", INERTIAL, inertial))
        for body in self.bodies:
            f, n = forces[body.name]
            for row, v in zip(body.motion.own_rows, body.motion.own_virtual, strict=True):
                terms += self._forces(row, v, f, n, composites[body.name])
        kept = tuple(term for term in terms if term.expr != 0)
        return TreeEquations((*self.own, *self.behind), kept, tuple(self._zeros()))

    def _zeros(self) -> Iterator[tuple[str, str, Reason]]:
        """The pairs of rows that move no body together, with the reason."""
        every = [(row.name, body) for body in self.bodies for row in body.motion.own_rows]
        moving = {body.name: {row.name for row in body.motion.rows} for body in self.bodies}
        for number, (row, body) in enumerate(every):
            for other, of in every[:number]:
                if other not in moving[body.name] and row not in moving[of.name]:
                    yield row, other, Reason(identity=BRANCHES)

    def _inertia(self, body: TreeBody) -> CompositeInertia:
        """The inertia of a body about O in the inertial frame."""
        define, Q = TreeDefinitions(body.name, f"{body.name} inertia"), sp.Matrix(body.motion.frame)
        moment = define.vector(Family.FIRST_MOMENT, product(Q, body.moment), "first moment about O")
        tensor = _symmetric(product(product(Q, body.tensor), Q.T), define, Family.TURNED_INERTIA, "inertia about O")
        self.own += define.made
        return CompositeInertia(body.mass, sp.Matrix(moment), tensor)

    def _composite(self, body: TreeBody, own: CompositeInertia, of: Mapping[str, CompositeInertia]) -> CompositeInertia:
        """The inertia of a body with all bodies behind it, about its origin."""
        behind = self.children[body.name]
        if not behind:
            return own
        define = TreeDefinitions(body.name, f"{body.name} composite")
        moments, tensors = [own.moment], [own.tensor]
        for child in behind:
            part, r = of[child.name].carried(child.motion), sp.Matrix(child.motion.lever)
            moved = define.vector(
                Family.COMPOSITE_MOMENT, summed([part.moment, r * part.mass]), f"first moment behind {child.name}",
                child.name,
            )  # fmt: skip
            moments.append(sp.Matrix(moved))
            tensors.append(part.tensor + _shift(r, part.moment + sp.Matrix(moved)))
        mass = define.scalar(
            Family.COMPOSITE_MASS, sp.Add(own.mass, *(of[c.name].mass for c in behind)), "mass with that behind it"
        )
        moment = define.vector(Family.COMPOSITE_MOMENT, summed(moments), "first moment with that behind it")
        total = sp.Matrix(3, 3, lambda i, j: sp.Add(*(tensor[i, j] for tensor in tensors)))
        tensor = _symmetric(total, define, Family.COMPOSITE_INERTIA, "inertia with that behind it")
        self.behind += define.made
        return CompositeInertia(mass, sp.Matrix(moment), tensor)

    def _behind(
        self, body: TreeBody, own: CompositeInertia, of: Mapping[str, tuple[sp.Matrix, sp.Matrix]]
    ) -> tuple[sp.Matrix, sp.Matrix]:
        """The force and the torque about O of a body and those behind it without accelerations of coordinates."""
        motion, define = body.motion, TreeDefinitions(body.name, f"{body.name} forces")
        a, alpha, w = motion.acceleration, motion.angular_acceleration, motion.angular_velocity
        spun = [cross(alpha, own.moment), cross(w, _named_cross(define, w, own.moment))]
        force = [sp.Matrix(a) * own.mass, *spun]
        angular = define.vector(
            Family.UNIT_SPIN, product(own.tensor, sp.Matrix(w)), "angular momentum of the rotation about O"
        )
        torque = [cross(own.moment, a), product(own.tensor, sp.Matrix(alpha)), cross(w, angular)]
        f = define.vector(Family.INERTIAL_FORCE, summed(force), "force without accelerations of coordinates")
        n = define.vector(Family.INERTIAL_TORQUE, summed(torque), "torque without accelerations of coordinates")
        forces, torques = [sp.Matrix(f)], [sp.Matrix(n)]
        for child in self.children[body.name]:
            f_child, n_child = of[child.name]
            forces.append(f_child)
            torques += [*([n_child] * child.motion.turns_with_parent), cross(child.motion.lever, f_child)]
        if len(forces) > 1:
            f = define.vector(Family.FORCE_BEHIND, summed(forces), "force with that behind it")
            n = define.vector(Family.TORQUE_BEHIND, summed(torques), "torque with that behind it")
        self.behind += define.made
        return sp.Matrix(f), sp.Matrix(n)

    def _couple(
        self,
        body: TreeBody,
        row: EquationOfMotion,
        v: VirtualMotion,
        composite: CompositeInertia,
        factors: dict[str, dict[str, sp.Expr]],
    ) -> None:
        """Add the factors of the accelerations in a row of a body, and in the rows of the bodies before it."""
        define = TreeDefinitions(body.name, f"{body.name} mass")
        linear, angular = composite.momentum(v)
        p = define.vector(Family.UNIT_MOMENTUM, linear, f"momentum behind for a unit rate of {row.name}", row.name)
        L = define.vector(Family.UNIT_SPIN, angular, f"angular momentum behind for a unit rate of {row.name}", row.name)
        self.behind += define.made
        for other, by in zip(body.motion.rows, body.motion.virtual, strict=True):
            factor = sp.Add(dot(by.translation, p), dot(by.rotation, L))
            if factor != 0:
                factors.setdefault(row.name, {})[other.name] = factor
                factors.setdefault(other.name, {})[row.name] = factor
            if other.name == row.name:
                break

    def _forces(
        self, row: EquationOfMotion, v: VirtualMotion, f: sp.Matrix, n: sp.Matrix, composite: CompositeInertia
    ) -> Iterator[Term]:
        """The terms of a row besides those with accelerations of coordinates."""
        yield Term(row.name, "centrifugal and Coriolis", INERTIAL, sp.Add(dot(v.translation, f), dot(v.rotation, n)))
        weight = [
            dot(v.translation, self.gravity) * composite.mass,
            dot(v.rotation, cross(composite.moment, self.gravity)),
        ]
        yield Term(row.name, "gravity", INERTIAL, -sp.Add(*weight))


def _named_cross(define: TreeDefinitions, w: sp.Matrix, moment: sp.Matrix) -> sp.Matrix:
    return sp.Matrix(define.vector(Family.FIRST_MOMENT, cross(w, moment), "rate of the first moment about O", dots=1))


def _symmetric(values: sp.Matrix, define: TreeDefinitions, family: Family, doc: str) -> sp.Matrix:
    """A symmetric tensor with names for its entries."""
    result = sp.zeros(3, 3)
    for a, b in PAIRS:
        result[a - 1, b - 1] = result[b - 1, a - 1] = define.scalar(family, values[a - 1, b - 1], doc, (a, b))
    return result


def _shift(r: sp.Matrix, g: sp.Matrix) -> sp.Matrix:
    """The part that an inertia gains about a point from which the one before is at r.

    g: the sum of the first moments about both points.

    With m r^2 + 2 r . s = r . g and m r r + r s + s r = (r g + g r)/2, where s is the first moment before.
    """
    diagonal = [r[k] * g[k] for k in range(3)]
    half = sp.Rational(1, 2)

    def entry(i: int, j: int) -> sp.Expr:
        if i == j:
            return sp.Add(*(diagonal[k] for k in range(3) if k != i))
        return -half * (r[i] * g[j] + r[j] * g[i])

    return sp.Matrix(3, 3, entry)
