"""The equations of motion (15) of a deformable body, in the plane or in space, term by term.

Inertia is the virtual work of the acceleration (5) on each virtual displacement (6); elasticity is the variation of
the strain energy. Which parts vanish follows from the body's integrals.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import sympy as sp

from derive.mechanics import zeros
from derive.mechanics.equations import Coefficient, Definition, Equations, ParameterSymbol, Reason, Term
from derive.mechanics.kinematics import HERE, ONE, RDDOT, RDOT, Field, R
from derive.mechanics.motion import MASS, Motion
from derive.mechanics.points import MaterialPoint, marker
from derive.mechanics.series import of_index
from derive.mechanics.symbols import Family, pair, quantity, vector

TRANSLATIONS = "the mass enters as m I, so translations along different axes do not couple"


@dataclass(frozen=True)
class Body:
    """What (15) needs to know of a body.

    `origin` says in words where c is; `stiffness` holds K_ij, i <= j, of U = 1/2 alpha K alpha; `damping` B_ij, i <= j,
    the factors of the rates; `gravity` the acceleration g_1, g_2, ... of free fall in the inertial base.
    """

    name: str
    doc: str
    origin: str
    motion: Motion
    mass: sp.Expr
    integrals: tuple[Coefficient, ...]
    stiffness: tuple[Coefficient, ...]
    points: tuple[MaterialPoint, ...]
    parameters: tuple[ParameterSymbol, ...]
    damping: tuple[Coefficient, ...] = ()
    gravity: tuple[Coefficient, ...] = ()


def constants_of(body: Body) -> tuple[Coefficient, ...]:
    """The constants of a body with their values: mass, integrals, stiffness, damping, gravity, and those of points."""
    mass = Coefficient(MASS, body.mass, "(15)", "mass of the body", "kg")
    of_points = tuple(c for point in body.points for c in point.coefficients)
    return (mass, *body.integrals, *body.stiffness, *body.damping, *body.gravity, *of_points)


def equations(body: Body) -> Equations:
    """The equations of motion of a body, with energy, momentum and markers."""
    motion = body.motion
    every = constants_of(body)
    needed = (*gravity_definitions(motion, body.gravity), *motion.definitions)
    composed, reasons = zeros.drop_definitions(needed, zeros.reasons_of(every))
    strain = _strain_energy(motion, body.stiffness)
    complete = (*_inertia(motion), *_elasticity(motion, strain), *_damping(motion, body.damping))
    complete += _weight(motion) if body.gravity else ()
    terms, vanished = zeros.drop_terms(complete, reasons)
    return Equations(
        name=body.name,
        doc=body.doc,
        origin=body.origin,
        coordinates=motion.coordinates,
        rows=motion.rows,
        rates=motion.rates,
        parameters=body.parameters,
        coefficients=every,
        definitions=(*motion.rotation_definitions, *composed),
        terms=terms,
        vanished=tuple(v if v.reason else replace(v, reason=_identity(motion, v.term)) for v in vanished),
        mass=_mass_matrix(motion, terms),
        mass_zeros=_mass_zeros(motion, complete, reasons),
        kinetic_energy=zeros.drop(motion.summed(kinetic_energy(motion)), reasons),
        strain_energy=zeros.drop(strain, reasons),
        weight_energy=zeros.drop(weight_energy(motion), reasons) if body.gravity else None,
        linear_momentum=tuple(zeros.drop(p, reasons) for p in linear_momentum(motion)),
        angular_momentum=tuple(zeros.drop(p, reasons) for p in angular_momentum(motion)),
        markers=tuple(marker(motion, point, reasons) for point in body.points),
    )


def _parts(motion: Motion) -> tuple[tuple[str, Field], ...]:
    """The acceleration (5), split into its named parts."""
    acceleration = motion.acceleration
    turning, still = acceleration[R], dict.fromkeys(motion.frame.omegadot, sp.S.Zero)
    centrifugal = turning.xreplace(still)
    named = centrifugal.expand().xreplace(motion.products)
    return (
        ("translation", {ONE: acceleration[ONE]}),
        ("Euler", {R: turning - centrifugal}),
        ("centrifugal", {R: named}),
        ("Coriolis", {RDOT: acceleration[RDOT]}),
        ("relative", {RDDOT: acceleration[RDDOT]}),
    )


def rigid_inertia(motion: Motion) -> tuple[Term, ...]:
    """The virtual work of the inertia on the rigid displacements (6): a term for each part of (5); sums are named."""
    return tuple(
        Term(row, name, "(15)", motion.product(part, displacement))
        for row, displacement in _rigid_displacements(motion)
        for name, part in _parts(motion)
    )


def generic_inertia(motion: Motion) -> tuple[Term, ...]:
    """The virtual work of the inertia on a variation of alpha_i, for a generic i; sums are named."""
    deformation = motion.frame.deformation()
    return tuple(Term("alpha_i", name, "(15)", motion.product(part, deformation)) for name, part in _parts(motion))


def _rigid_displacements(motion: Motion) -> Iterator[tuple[str, Field]]:
    names = [row.name for row in motion.rows[: len(motion.rows) - len(motion.alpha)]]
    return zip(names, (*motion.translations, *motion.frame.rotations()), strict=True)


def _inertia(motion: Motion) -> tuple[Term, ...]:
    """The virtual work of the inertia, its sums written out."""
    terms = [replace(t, expr=motion.summed(t.expr)) for t in rigid_inertia(motion)]
    return (*terms, *_of_each_shape(motion, generic_inertia(motion)))


def _of_each_shape(motion: Motion, generic: tuple[Term, ...]) -> Iterator[Term]:
    """The terms of a generic shape for each shape, their sums written out."""
    for i, alpha in enumerate(motion.alpha, 1):
        for t in generic:
            yield replace(t, row=str(alpha), expr=motion.summed(of_index(t.expr, i)))


def _strain_energy(motion: Motion, stiffness: tuple[Coefficient, ...]) -> sp.Expr:
    entries = {c.symbol for c in stiffness}
    n = len(motion.alpha)
    pairs = [(i, j, pair(Family.STIFFNESS, i + 1, j + 1)) for i in range(n) for j in range(i, n)]
    weights = ((sp.S.Half if i == j else sp.S.One, i, j, k) for i, j, k in pairs if k in entries)
    return sum((w * k * motion.alpha[i] * motion.alpha[j] for w, i, j, k in weights), sp.S.Zero)


def _elasticity(motion: Motion, strain: sp.Expr) -> tuple[Term, ...]:
    """delta U, the first term of (13)."""
    gradients = ((a, sp.expand(strain.diff(a))) for a in motion.alpha)
    return tuple(Term(str(a), "elastic", "(13), (22)", force) for a, force in gradients if force != 0)


def _damping(motion: Motion, damping: tuple[Coefficient, ...]) -> tuple[Term, ...]:
    """B alphadot."""
    present = {c.symbol for c in damping}
    shapes = range(1, len(motion.alpha) + 1)
    found = []
    for i in shapes:
        entries = [pair(Family.DAMPING, i, j) for j in shapes]
        pairs = zip(entries, motion.alphadot, strict=True)
        force = sp.Add(*(b * rate for b, rate in pairs if b in present))
        found += [Term(str(motion.alpha[i - 1]), "damping", "(13)", force)] if force != 0 else []
    return tuple(found)


def gravity_vector(motion: Motion) -> sp.Matrix:
    """The acceleration of free fall, g_1, g_2, ..., in the inertial base."""
    return vector(Family.GRAVITY, motion.rotation.rows)


def gravity_definitions(motion: Motion, gravity: tuple[Coefficient, ...]) -> tuple[Definition, ...]:
    """Q^T g: gravity seen from the body base."""
    if not gravity:
        return ()
    seen = motion.rotation.T * gravity_vector(motion)
    return tuple(
        Definition(
            quantity(Family.BODY_GRAVITY, k), expr, "gb", "(1)", f"gravity along the axis {k} of the floating frame"
        )
        for k, expr in enumerate(seen, 1)
    )


def _work_of(motion: Motion, displacement: Field) -> sp.Expr:
    """The work int rho g . f of gravity on a field: g as it is on a translation, from the body base on the rest."""
    seen = vector(Family.BODY_GRAVITY, motion.rotation.rows)
    translation = {ONE: displacement[ONE]} if ONE in displacement else {}
    rest = {name: tensor for name, tensor in displacement.items() if name != ONE}
    return motion.product({ONE: gravity_vector(motion)}, translation) + motion.product({HERE: seen}, rest)


def rigid_weight(motion: Motion) -> tuple[Term, ...]:
    """The virtual work of gravity on the rigid displacements, on the left-hand side."""
    return tuple(
        Term(row, "gravity", "(10)", -_work_of(motion, displacement))
        for row, displacement in _rigid_displacements(motion)
    )


def generic_weight(motion: Motion) -> tuple[Term, ...]:
    """The virtual work of gravity on a variation of alpha_i, on the left-hand side."""
    return (Term("alpha_i", "gravity", "(10)", -_work_of(motion, motion.frame.deformation())),)


def _weight(motion: Motion) -> tuple[Term, ...]:
    return (*rigid_weight(motion), *_of_each_shape(motion, generic_weight(motion)))


def weight_energy(motion: Motion) -> sp.Expr:
    """The potential of gravity, zero when c is the inertial origin and the body is a point there."""
    return -_work_of(motion, motion.position)


def _mass_matrix(motion: Motion, terms: tuple[Term, ...]) -> sp.ImmutableMatrix:
    """The factors of the accelerations in each row."""
    sums_of = [sp.Add(*(t.expr for t in terms if t.row == row.name)) for row in motion.rows]
    return sp.ImmutableMatrix([[left.diff(row.a) for row in motion.rows] for left in sums_of])


def _mass_zeros(
    motion: Motion, complete: tuple[Term, ...], reasons: zeros.Reasons
) -> tuple[tuple[int, int, Reason], ...]:
    """Row, column and reason of each structural zero of the mass matrix (lower triangle)."""
    full = _mass_matrix(motion, complete)
    n = len(motion.rows)
    lower = ((i, j, full[i, j]) for i in range(n) for j in range(i + 1))
    vanishing = ((i, j, entry) for i, j, entry in lower if zeros.drop(entry, reasons) == 0)
    return tuple((i, j, _reason(motion, entry, reasons, i, j)) for i, j, entry in vanishing)


def _reason(motion: Motion, entry: sp.Expr, reasons: zeros.Reasons, i: int, j: int) -> Reason:
    """The reason of a zero of the mass matrix: the integrals in it, or that translations are independent."""
    known = zeros.why(entry, reasons)
    if known:
        return known
    if max(i, j) < motion.rotation.rows:
        return Reason(identity=TRANSLATIONS)
    raise ArithmeticError(f"entry {i}, {j} of the mass matrix vanishes without a reason")


def _identity(motion: Motion, term: Term) -> Reason:
    """The reason of a vanished term in which no integral stands."""
    odd = "c7 is odd in its indices, so that one shape does not act on itself"
    known = motion.identities | {(str(a), "Coriolis"): odd for a in motion.alpha}
    if not motion.alpha:
        pairs = ((row.name, name) for row in motion.rows for name in ("Coriolis", "relative"))
        known |= dict.fromkeys(pairs, "a rigid body has no shapes")
    if (term.row, term.name) not in known:
        raise ArithmeticError(f"the {term.name} term of row {term.row} vanishes without a reason")
    return Reason(identity=known[term.row, term.name])


def kinetic_energy(motion: Motion) -> sp.Expr:
    """1/2 int rho xdot . xdot; sums are named."""
    return motion.product(motion.velocity, motion.velocity) / 2


def linear_momentum(motion: Motion) -> tuple[sp.Expr, ...]:
    """int rho xdot along each axis: the virtual work of the velocity on the two translations."""
    return tuple(motion.product(motion.velocity, d) for d in motion.translations)


def angular_momentum(motion: Motion) -> tuple[sp.Expr, ...]:
    """int rho x x xdot about the inertial origin: the virtual work of the velocity on e_k x x."""
    position = motion.position
    turned = ({ONE: fixed * position[ONE], R: moving} for fixed, moving in motion.turns)
    return tuple(motion.product(field, motion.velocity) for field in turned)
