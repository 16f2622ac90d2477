"""The equations of motion (15) of a deformable body that moves in a plane, term by term.

Inertia is the virtual work of the acceleration (5) on each virtual displacement (6); elasticity is the variation of
the strain energy. Which parts vanish follows from the body's integrals.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import sympy as sp

from derive.mechanics import zeros
from derive.mechanics.equations import (
    Coefficient,
    Coordinate,
    Definition,
    Equations,
    MarkerEquations,
    ParameterSymbol,
    Row,
    Term,
)
from derive.mechanics.integrals import FieldIntegrals, coefficients, definitions, of_index, sums
from derive.mechanics.kinematics import ONE, PHI, RDDOT, RDOT, Field, MovingFrame, PlanarRotation, R, times
from derive.mechanics.virtual_work import Moments, total

IN_PLANE = "planar motion: omega x (J . omega) = 0"
TRANSLATIONS = "the mass enters as m I, so translations along e1 and e2 do not couple"
MASS = sp.Symbol("mass")


@dataclass(frozen=True)
class MaterialPoint:
    """A named material point: its reference position X (2) and the values of the N shapes there (2 each)."""

    name: str
    doc: str
    position: sp.ImmutableMatrix
    shapes: tuple[sp.ImmutableMatrix, ...]
    coefficients: tuple[Coefficient, ...] = ()


@dataclass(frozen=True)
class PlanarBody:
    """What (15) needs to know of a body in the plane; `stiffness` holds K_ij, i <= j, of U = 1/2 alpha K alpha."""

    name: str
    doc: str
    shapes: int
    mass: sp.Expr
    integrals: FieldIntegrals
    stiffness: tuple[Coefficient, ...]
    points: tuple[MaterialPoint, ...]
    parameters: tuple[ParameterSymbol, ...]


def equations(body: PlanarBody) -> Equations:
    """The equations of motion of a body in the plane, with energy, momentum and markers."""
    motion = Motion(body.shapes)
    mass = Coefficient(MASS, body.mass, "(15)", "mass of the body", "kg")
    of_points = tuple(c for point in body.points for c in point.coefficients)
    every = (mass, *coefficients(body.integrals, body.shapes), *body.stiffness, *of_points)
    composed, reasons = zeros.drop_definitions(motion.definitions, zeros.reasons_of(every))
    strain = _strain_energy(motion, body.stiffness)
    complete = (*_inertia(motion), *_elasticity(motion, strain))
    terms, vanished = zeros.drop_terms(complete, reasons)
    return Equations(
        name=body.name,
        doc=body.doc,
        coordinates=motion.coordinates,
        rows=motion.rows,
        rates=tuple(row.v for row in motion.rows),
        parameters=body.parameters,
        coefficients=every,
        definitions=(*_rotation_definitions(motion.rotation), *composed),
        terms=terms,
        vanished=tuple(v if v.reason else replace(v, reason=IN_PLANE) for v in vanished),
        mass=_mass_matrix(motion, terms),
        mass_zeros=_mass_zeros(motion, complete, reasons),
        kinetic_energy=zeros.drop(_kinetic_energy(motion), reasons),
        strain_energy=zeros.drop(strain, reasons),
        linear_momentum=tuple(zeros.drop(p, reasons) for p in _linear_momentum(motion)),
        angular_momentum=(zeros.drop(_angular_momentum(motion), reasons),),
        markers=tuple(_marker(motion, point, reasons) for point in body.points),
    )


class Motion:
    """The motion of a planar body with n shapes: its coordinates, and position, velocity, acceleration as fields."""

    def __init__(self, n: int) -> None:
        self.coordinates = _coordinates(n)
        self.rows = tuple(map(_row, self.coordinates))
        c1, c2, phi, *shapes = self.rows
        self.alpha = tuple(c.q for c in self.coordinates[3:])
        self.alphadot = tuple(row.v for row in shapes)
        self.rotation = PlanarRotation(self.coordinates[2].q)
        self.frame = MovingFrame((self.rotation.generator,), (phi.v,), (phi.a,))
        self.moments = Moments(MASS, self.rotation.tensor)
        self.definitions = definitions(self.alpha, self.alphadot)
        self.sums = sums(self.alphadot, tuple(row.a for row in shapes))
        self.position = {ONE: sp.Matrix([c.q for c in self.coordinates[:2]]), **self.frame.position}
        self.velocity = {ONE: sp.Matrix([c1.v, c2.v]), **self.frame.velocity}
        self.acceleration = {ONE: sp.Matrix([c1.a, c2.a]), **self.frame.acceleration}
        self.translations: tuple[Field, ...] = ({ONE: sp.Matrix([1, 0])}, {ONE: sp.Matrix([0, 1])})

    def product(self, a: Field, b: Field) -> sp.Expr:
        """int rho a . b over the body, for a generic index i if a or b holds PHI."""
        return total(a, b, self.moments)

    def summed(self, expr: sp.Expr) -> sp.Expr:
        """An expression with the sums that have no name of their own written out."""
        return sp.expand(expr.xreplace(self.sums))


def _coordinates(n: int) -> tuple[Coordinate, ...]:
    """c1, c2, phi, alpha1..alphaN: (14), (23), (27)."""
    return (
        Coordinate(sp.Symbol("c1"), "translation of the floating frame along e1", "m"),
        Coordinate(sp.Symbol("c2"), "translation of the floating frame along e2", "m"),
        Coordinate(sp.Symbol("phi"), "rotation of the floating frame", "rad"),
        *(Coordinate(sp.Symbol(f"alpha{i}"), f"amplitude of assumed shape {i}", "m") for i in range(1, n + 1)),
    )


def _row(coordinate: Coordinate) -> Row:
    """In the plane every coordinate has its row, and its rate is its time derivative."""
    name = str(coordinate.q)
    v, a = sp.symbols(f"{name}dot {name}ddot")
    return Row(name, v, a, f"rate of {name}", f"{coordinate.unit}/s", "N m" if coordinate.unit == "rad" else "N")


def _rotation_definitions(rotation: PlanarRotation) -> tuple[Definition, ...]:
    docs = {rotation.cos: "cosine of the rotation angle", rotation.sin: "sine of the rotation angle"}
    return tuple(Definition(s, value, "Q", "(26)", docs[s]) for s, value in rotation.functions.items())


def _parts(motion: Motion) -> tuple[tuple[str, Field], ...]:
    """The acceleration (5), split into its named parts."""
    acceleration = motion.acceleration
    turning, still = acceleration[R], dict.fromkeys(motion.frame.omegadot, sp.S.Zero)
    centrifugal = turning.xreplace(still)
    return (
        ("translation", {ONE: acceleration[ONE]}),
        ("Euler", {R: turning - centrifugal}),
        ("centrifugal", {R: centrifugal}),
        ("Coriolis", {RDOT: acceleration[RDOT]}),
        ("relative", {RDDOT: acceleration[RDDOT]}),
    )


def _inertia(motion: Motion) -> tuple[Term, ...]:
    """The virtual work of the inertia: a term for each part of (5) on each virtual displacement of (6)."""
    rigid = [row.name for row in motion.rows[: len(motion.rows) - len(motion.alpha)]]
    displacements = dict(zip(rigid, (*motion.translations, *motion.frame.rotations()), strict=True))
    terms = [
        Term(row, name, "(15)", motion.summed(motion.product(part, displacement)))
        for row, displacement in displacements.items()
        for name, part in _parts(motion)
    ]
    generic = [(name, motion.product(part, motion.frame.deformation())) for name, part in _parts(motion)]
    for i, alpha in enumerate(motion.alpha, 1):
        terms += [Term(str(alpha), name, "(15)", motion.summed(of_index(expr, i))) for name, expr in generic]
    return tuple(terms)


def _strain_energy(motion: Motion, stiffness: tuple[Coefficient, ...]) -> sp.Expr:
    entries = {c.symbol for c in stiffness}
    n = len(motion.alpha)
    pairs = [(i, j, sp.Symbol(f"K_{i + 1}_{j + 1}")) for i in range(n) for j in range(i, n)]
    weights = ((sp.S.Half if i == j else sp.S.One, i, j, k) for i, j, k in pairs if k in entries)
    return sum((w * k * motion.alpha[i] * motion.alpha[j] for w, i, j, k in weights), sp.S.Zero)


def _elasticity(motion: Motion, strain: sp.Expr) -> tuple[Term, ...]:
    """delta U, the first term of (13)."""
    return tuple(Term(str(a), "elastic", "(13), (22)", sp.expand(strain.diff(a))) for a in motion.alpha)


def _mass_matrix(motion: Motion, terms: tuple[Term, ...]) -> sp.ImmutableMatrix:
    """The factors of the accelerations in each row."""
    sums_of = [sp.Add(*(t.expr for t in terms if t.row == row.name)) for row in motion.rows]
    return sp.ImmutableMatrix([[left.diff(row.a) for row in motion.rows] for left in sums_of])


def _mass_zeros(motion: Motion, complete: tuple[Term, ...], reasons: zeros.Reasons) -> tuple[tuple[int, int, str], ...]:
    """Row, column and reason of each structural zero of the mass matrix (lower triangle)."""
    full = _mass_matrix(motion, complete)
    n = len(motion.rows)
    lower = ((i, j, full[i, j]) for i in range(n) for j in range(i + 1))
    return tuple(
        (i, j, zeros.why(entry, reasons) or TRANSLATIONS) for i, j, entry in lower if zeros.drop(entry, reasons) == 0
    )


def _kinetic_energy(motion: Motion) -> sp.Expr:
    """1/2 int rho xdot . xdot."""
    return motion.summed(motion.product(motion.velocity, motion.velocity) / 2)


def _linear_momentum(motion: Motion) -> tuple[sp.Expr, ...]:
    """int rho xdot along e1 and e2: the virtual work of the velocity on the two translations."""
    return tuple(motion.product(motion.velocity, d) for d in motion.translations)


def _angular_momentum(motion: Motion) -> sp.Expr:
    """int rho x x xdot about the inertial origin, along e3."""
    (turn,) = motion.frame.generators  # it is the same in both bases
    return motion.product(times(turn, motion.position), motion.velocity)


def _marker(motion: Motion, point: MaterialPoint, reasons: zeros.Reasons) -> MarkerEquations:
    """Position, velocity and Jacobian of a material point, from the same fields taken at that point."""

    def at_point(amplitudes: tuple[sp.Symbol, ...], base: sp.Matrix) -> sp.Matrix:
        return sum((shape * a for shape, a in zip(point.shapes, amplitudes, strict=True)), base)

    names = {R: "r", RDOT: "rdot"}
    values = {R: at_point(motion.alpha, sp.Matrix(point.position)), RDOT: at_point(motion.alphadot, sp.zeros(2, 1))}
    local = tuple(
        Definition(sp.Symbol(f"{names[f]}_{k + 1}"), value[k], "r", "(1), (14)", f"{names[f]} . e{k + 1} at the marker")
        for f, value in values.items()
        for k in (0, 1)
    )
    kept, known = zeros.drop_definitions(local, reasons)
    vectors = {f: sp.Matrix(sp.symbols(f"{names[f]}_1 {names[f]}_2")) for f in names}

    def vector(field: Field) -> sp.Matrix:
        """A field at the marker, in the inertial base."""
        here = field.get(ONE, sp.zeros(2, 1))
        moving = (tensor * vectors[name] for name, tensor in field.items() if name != ONE)
        resolved = here + motion.rotation.tensor * sum(moving, sp.zeros(2, 1))
        return resolved.applyfunc(lambda e: zeros.drop(sp.expand(e), known))

    columns = [vector(d) for d in (*motion.translations, *motion.frame.rotations())]
    for shape in point.shapes:
        vectors[PHI] = sp.Matrix(shape)
        columns.append(vector(motion.frame.deformation()))
    return MarkerEquations(
        name=point.name,
        doc=point.doc,
        definitions=kept,
        position=sp.ImmutableMatrix(vector(motion.position)),
        velocity=sp.ImmutableMatrix(vector(motion.velocity)),
        jacobian=sp.ImmutableMatrix.hstack(*columns),
    )
