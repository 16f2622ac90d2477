"""Motion in space: translation, unit quaternion and omega in the body base, for any deformable body.

In space D2_i is a tensor. Its antisymmetric part is d3_i: D2_i v = S_i v - d3_i x v / 2 with S_i symmetric, and
likewise C4_i and C5_ij have symmetric parts of their own, while their antisymmetric parts are c6_i and c7_ij. So S_i,
C4 and C5 below are the symmetric parts: what the appendix of the paper holds twice is held once.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement, groupby

import sympy as sp

from derive.mechanics.equations import Coordinate, Definition, Row
from derive.mechanics.kinematics import PHI, RDDOT, RDOT, MovingFrame, R
from derive.mechanics.motion import MASS, Motion
from derive.mechanics.series import ALPHA, ALPHADDOT, ALPHADOT, Series, written_out
from derive.mechanics.virtual_work import FIRST, transposed
from derive.roles import Role

Vectors = dict[str, Sequence[sp.Symbol]]

AXES = (1, 2, 3)
PAIRS = tuple(combinations_with_replacement(AXES, 2))
"""Index pairs of a symmetric tensor: 11, 12, 13, 22, 23, 33."""

SYMMETRIC = {(R, R): "J", (R, RDOT): "Sdot", (R, PHI): "S_i"}
"""int rho ((f . g) I - sym f g^T): J, the symmetric part of D2_i, and its sum with the rates."""

AXIAL = {(R, RDOT): "d3dot", (R, RDDOT): "d3ddot", (R, PHI): "d3_i", (PHI, RDOT): "c7dot_i"}
"""int rho f x g, odd in f and g."""

TRACE = {(PHI, RDDOT): "c8ddot_i", (RDOT, RDOT): "c8dotdot"}
"""int rho f . g."""


def skew(v: Iterable[sp.Expr]) -> sp.Matrix:
    """The tensor v x."""
    a, b, c = v
    return sp.Matrix([[0, -c, b], [c, 0, -a], [-b, a, 0]])


def vector(name: str) -> sp.Matrix:
    """A vector of symbols name_1, name_2, name_3."""
    return sp.Matrix([sp.Symbol(f"{name}_{k}") for k in AXES])


def symmetric(name: str) -> sp.Matrix:
    """A symmetric tensor of symbols name_11, name_12, ..."""
    return sp.Matrix(3, 3, lambda i, j: sp.Symbol("{}_{}{}".format(name, *sorted((i + 1, j + 1)))))


@dataclass(frozen=True)
class SpatialMoments:
    """The moments of the fields of a body in space: symbols of the appendix; see Moments."""

    mass: sp.Symbol
    rotation: sp.Matrix
    unknown: frozenset[sp.Symbol] = frozenset((*symmetric("even"), *vector("odd")))

    def first(self, field: str) -> sp.Matrix:
        """int rho f."""
        return vector(FIRST[field])

    def second(self, f: str, g: str) -> sp.Matrix:
        """int rho f g^T from its symmetric and its axial part; what has no name must cancel."""
        if transposed(f, g, {**SYMMETRIC, **AXIAL, **TRACE}):
            return self.second(g, f).T
        even, odd = symmetric("even"), vector("odd")
        if (f, g) in SYMMETRIC:
            tensor = symmetric(SYMMETRIC[f, g])
            even = sp.eye(3) * tensor.trace() / 2 - tensor
        elif (f, g) in TRACE:
            even = even + sp.eye(3) * (sp.Symbol(TRACE[f, g]) - even.trace()) / 3
        if (f, g) in AXIAL:
            odd = vector(AXIAL[f, g])
        elif f == g:
            odd = sp.zeros(3, 1)
        return even - skew(odd) / 2


def spatial_motion(n: int) -> Motion:
    """The motion of a body in space with n shapes."""
    shapes = range(1, n + 1)
    alpha = tuple(sp.Symbol(f"alpha{i}") for i in shapes)
    rows = _rows(shapes)
    rotation, quaternion = symbols_of_rotation(), sp.symbols("e0 e1 e2 e3")
    omega, omegadot = (tuple(getattr(row, x) for row in rows[3:6]) for x in ("v", "a"))
    alphadot, alphaddot = (tuple(getattr(row, x) for row in rows[6:]) for x in ("v", "a"))
    vectors: Vectors = {ALPHA: alpha, ALPHADOT: alphadot, ALPHADDOT: alphaddot}
    products = {omega[i - 1] * omega[j - 1]: sp.Symbol(f"oo_{i}{j}") for i, j in PAIRS}
    named = tuple(Definition(s, p, "oo", "(5)", "products of omega") for p, s in products.items())
    axes = sp.eye(3)
    return Motion(
        coordinates=_coordinates(alpha),
        rows=rows,
        rates=(*(row.v for row in rows[:3]), *quaternion_rates(quaternion, omega), *alphadot),
        alpha=alpha,
        rotation=rotation,
        rotation_definitions=_rotation_definitions(rotation, quaternion),
        frame=MovingFrame(tuple(skew(axes[:, k]) for k in range(3)), omega, omegadot),
        moments=SpatialMoments(MASS, rotation),
        definitions=(*named, *_definitions(vectors)),
        sums=_sums(vectors),
        products=products,
        turns=tuple((skew(axes[:, k]), skew(rotation[k, :])) for k in range(3)),
        identities={},
    )


def _coordinates(alpha: tuple[sp.Symbol, ...]) -> tuple[Coordinate, ...]:
    return (
        *(
            Coordinate(sp.Symbol(f"c{k}"), f"translation of the floating frame along e{k}", "m", Role.TRANSLATION)
            for k in AXES
        ),
        *(
            Coordinate(sp.Symbol(f"e{k}"), "unit quaternion of the floating frame, scalar first", "1", Role.QUATERNION)
            for k in range(4)
        ),
        *(Coordinate(a, f"amplitude of assumed shape {i}", "m", Role.AMPLITUDE) for i, a in enumerate(alpha, 1)),
    )


def _rows(shapes: range) -> tuple[Row, ...]:
    def row(name: str, rate: str, doc: str, unit: str, work: str) -> Row:
        acceleration = f"{rate}dot" if name.startswith("pi") else f"{name}ddot"
        return Row(name, sp.Symbol(rate), sp.Symbol(acceleration), doc, unit, work)

    return (
        *(row(f"c{k}", f"c{k}dot", f"rate of c{k}", "m/s", "N") for k in AXES),
        *(row(f"pi{k}", f"omega{k}", f"angular velocity about the body axis {k}", "rad/s", "N m") for k in AXES),
        *(row(f"alpha{i}", f"alpha{i}dot", f"rate of alpha{i}", "m/s", "N") for i in shapes),
    )


def symbols_of_rotation() -> sp.Matrix:
    """Q in symbols Q_11 .. Q_33."""
    return sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"Q_{i + 1}{j + 1}"))


def rotation_of(quaternion: tuple[sp.Symbol, ...]) -> sp.Matrix:
    """Q of a unit quaternion (e0, e): (e0^2 - e . e) I + 2 e e^T + 2 e0 e x."""
    e0, *imaginary = quaternion
    e = sp.Matrix(imaginary)
    return ((e0**2 - e.dot(e)) * sp.eye(3) + 2 * e * e.T + 2 * e0 * skew(e)).expand()


def quaternion_rates(quaternion: tuple[sp.Symbol, ...], omega: tuple[sp.Symbol, ...]) -> tuple[sp.Expr, ...]:
    """Half the quaternion times (0, omega), omega in the body base: then Qdot = Q (omega x)."""
    e0, *imaginary = quaternion
    e, w = sp.Matrix(imaginary), sp.Matrix(omega)
    scalar = -e.dot(w) / 2
    return (scalar.expand(), *(((e0 * w + e.cross(w)) / 2).expand()))


def _rotation_definitions(rotation: sp.Matrix, quaternion: tuple[sp.Symbol, ...]) -> tuple[Definition, ...]:
    pairs = zip(rotation, rotation_of(quaternion), strict=True)
    return tuple(Definition(s, value, "Q", "(1)", "rotation tensor of the quaternion") for s, value in pairs)


def spatial_series() -> tuple[Series, ...]:
    """d1, S, d3, J and what else (15) needs, from r = X + sum alpha_j Phi_j, for a generic shape i.

    rdot and rddot are sums over the shapes as well, so r x rdot = X x rdot + sum alpha_j Phi_j x rdot.
    """
    found: list[Series] = []

    def define(name: str, base: str | None, doc: str, *sums: tuple[str, str]) -> None:
        found.append(Series(name, base, sums, doc))

    for k in AXES:
        define(f"d1_{k}", f"c1_{k}", f"int rho r . e{k}", (ALPHA, f"c2_j_{k}"))
    for k in AXES:
        define(f"d1dot_{k}", None, f"int rho rdot . e{k}", (ALPHADOT, f"c2_j_{k}"))
    for a, b in PAIRS:
        define(f"S_i_{a}{b}", f"C4_i_{a}{b}", "symmetric part of D2_i", (ALPHA, f"C5_i_j_{a}{b}"))
    for k in AXES:
        define(f"d3_i_{k}", f"c6_i_{k}", f"int rho r x Phi_i . e{k}", (ALPHA, f"c7_j_i_{k}"))
    for a, b in PAIRS:
        inertia = ((ALPHA, f"C4_j_{a}{b}"), (ALPHA, f"S_j_{a}{b}"))
        define(f"J_{a}{b}", f"C3_{a}{b}", "int rho ((r . r) I - r r)", *inertia)
    for a, b in PAIRS:
        define(f"Sdot_{a}{b}", None, "S of the shapes, summed with their rates", (ALPHADOT, f"S_j_{a}{b}"))
    for k in AXES:
        define(f"c7dot_i_{k}", None, f"int rho Phi_i x rdot . e{k}", (ALPHADOT, f"c7_i_j_{k}"))
    for k in AXES:
        define(f"d3dot_{k}", None, f"int rho r x rdot . e{k}", (ALPHADOT, f"c6_j_{k}"), (ALPHA, f"c7dot_j_{k}"))
    return tuple(found)


def spatial_sums() -> tuple[Series, ...]:
    """What has no name in the flat form: sums with accelerations, and those that stand in one place alone."""
    return (
        *(Series(f"d1ddot_{k}", None, ((ALPHADDOT, f"c2_j_{k}"),), f"int rho rddot . e{k}") for k in AXES),
        *(Series(f"d3ddot_{k}", None, ((ALPHADDOT, f"d3_j_{k}"),), f"int rho r x rddot . e{k}") for k in AXES),
        Series("c8ddot_i", None, ((ALPHADDOT, "c8_i_j"),), "int rho Phi_i . rddot"),
        Series("c8dot_i", None, ((ALPHADOT, "c8_i_j"),), "int rho Phi_i . rdot"),
        Series("c8dotdot", None, ((ALPHADOT, "c8dot_j"),), "int rho rdot . rdot"),
    )


def _definitions(vectors: Vectors) -> tuple[Definition, ...]:
    """The series written out for each shape; zeros still inside."""
    found: list[Definition] = []
    for section, group in groupby(spatial_series(), lambda s: s.section):
        members = tuple(group)
        for i in range(1, len(vectors[ALPHA]) + 1) if members[0].indexed else (0,):
            for s in members:
                doc = s.doc.replace("_i", f"_{i}")
                found.append(Definition(_symbol(s.name, i), written_out(s, i, vectors), section, "appendix", doc))
    return tuple(found)


def _sums(vectors: Vectors) -> dict[sp.Symbol, sp.Expr]:
    found: dict[sp.Symbol, sp.Expr] = {}
    for s in spatial_sums():
        for i in range(1, len(vectors[ALPHA]) + 1) if s.indexed else (0,):
            found[_symbol(s.name, i)] = sp.expand(written_out(s, i, vectors).xreplace(found))
    return found


def _symbol(name: str, i: int) -> sp.Symbol:
    return sp.Symbol("_".join(str(i) if part == "i" else part for part in name.split("_")))
