"""Motion in space: translation, unit quaternion and omega in the body frame, for any deformable body.

In space D2_i is a tensor. Its antisymmetric part is d3_i: D2_i v = S_i v - d3_i x v / 2 with S_i symmetric, and
likewise C4_i and C5_ij have symmetric parts of their own, while their antisymmetric parts are c6_i and c7_ij. So S_i,
C4 and C5 below are the symmetric parts: the part that the appendix of the paper contains twice is kept once.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.axes import AXES, PAIRS
from derive.mechanics.motion.body_motion import Motion
from derive.mechanics.motion.kinematics import PHI, RDDOT, RDOT, MovingFrame, R
from derive.mechanics.motion.moments import (
    AXIAL,
    FIRST,
    FIRST_OF_SECOND_ORDER,
    TRACE_OF_SUMS,
    Moment,
    moment,
    transposed,
)
from derive.mechanics.motion.second_order import second_order_moment_sums, second_order_row_sums
from derive.mechanics.motion.vectors import skew
from derive.mechanics.sums import ALPHA, ALPHADDOT, ALPHADOT, IndexedSum
from derive.mechanics.symbols import Family, I, J, ShapeIndex, local, quantity
from derive.mechanics.symbols import vector as components
from derive.mechanics.terms import Coordinate, EquationOfMotion, Intermediate

if TYPE_CHECKING:
    from derive.mechanics.typed_symbol import Symbol

SYMMETRIC: dict[tuple[str, str], Moment] = {
    (R, R): (Family.INERTIA, 0, ()),
    (R, RDOT): (Family.S, 1, ()),
    (R, PHI): (Family.S, 0, (I,)),
}
"""The moments int rho ((f . g) I - sym f g^T): J, the symmetric part of D2_i, and its sum with the rates."""

FIRST_IN_SPACE_OF_SECOND_ORDER: dict[str, Moment] = {**FIRST_OF_SECOND_ORDER, RDDOT: (Family.D4, 2, ())}
"""The first moments int rho f at second order; the moment of rddot is its part of accelerations."""

EVEN = sp.Matrix(3, 3, lambda i, j: local("even", *sorted((i + 1, j + 1))))
ODD = sp.Matrix([local("odd", k) for k in AXES])
"""The parts of a second moment that have no name."""


def symmetric(family: Family, derivative: int = 0, shapes: tuple[ShapeIndex, ...] = ()) -> sp.Matrix:
    """The symmetric tensor of symbols with the components 11, 12, ..."""
    return sp.Matrix(3, 3, lambda i, j: quantity(family, *sorted((i + 1, j + 1)), derivative=derivative, shapes=shapes))


@dataclass(frozen=True)
class SpatialMoments:
    """The moments of the fields of a body in space: symbols of the appendix; see Moments.

    truncated: whether displacements are of second order, see `second_order`.
    """

    mass: sp.Symbol
    rotation: sp.Matrix
    truncated: bool = False
    unknown: frozenset[sp.Symbol] = frozenset((*EVEN, *ODD))

    def first(self, field: str) -> sp.Matrix:
        """The first moment int rho f."""
        names = FIRST_IN_SPACE_OF_SECOND_ORDER if self.truncated else FIRST
        return sp.Matrix([moment(names[field], k) for k in AXES]) + self._of_rates(field, Family.C9_RATES)

    def second(self, f: str, g: str) -> sp.Matrix:
        """The second moment int rho f g^T from its symmetric and its axial part; parts without a name must cancel."""
        if transposed(f, g, {**SYMMETRIC, **AXIAL, **TRACE_OF_SUMS}):
            return self.second(g, f).T
        even, odd = EVEN, ODD
        if (f, g) in SYMMETRIC:
            tensor = symmetric(*SYMMETRIC[f, g])
            even = sp.eye(3) * tensor.trace() / 2 - tensor
        elif (f, g) in TRACE_OF_SUMS:
            even = even + sp.eye(3) * (moment(TRACE_OF_SUMS[f, g]) - even.trace()) / 3
        if (f, g) in AXIAL:
            odd = sp.Matrix([moment(AXIAL[f, g], k) for k in AXES]) + self._of_rates(g, Family.C10_RATES)
        elif f == g:
            odd = sp.zeros(3, 1)
        return even - skew(odd) / 2

    def _of_rates(self, field: str, family: Family) -> sp.Matrix:
        """The contribution of sum alphadot_i alphadot_j Psi_ij, a part of rddot at second order, to a moment."""
        return components(family, len(AXES)) if self.truncated and field == RDDOT else sp.zeros(len(AXES), 1)


@cache
def spatial_motion(n: int, truncated: bool = False) -> Motion:
    """The motion of a body in space with n shapes; truncated at second order, r is quadratic in their amplitudes."""
    return _rigid_motion(truncated).with_modes(n)


@cache
def _rigid_motion(truncated: bool) -> Motion:
    rows = _rows()
    rotation, quaternion = symbols_of_rotation(), tuple(quantity(Family.QUATERNION, k) for k in range(4))
    omega, omegadot = (tuple(getattr(row, x) for row in rows[3:]) for x in ("v", "a"))
    products = {omega[i - 1] * omega[j - 1]: quantity(Family.OMEGA_PRODUCT, i, j) for i, j in PAIRS}
    named = tuple(Intermediate(s, p, "oo", "(5)", "products of omega") for p, s in products.items())
    axes = sp.eye(3)
    moment_sums, row_sums = spatial_sums(truncated)
    return Motion(
        coordinates=_coordinates(),
        rows=rows,
        rates=(*(row.v for row in rows[:3]), *quaternion_rates(quaternion, omega)),
        alpha=(),
        rotation=rotation,
        rotation_definitions=_rotation_definitions(rotation, quaternion),
        frame=MovingFrame(tuple(skew(axes[:, k]) for k in range(3)), omega, omegadot),
        moments=SpatialMoments(quantity(Family.MASS), rotation, truncated),
        named=named,
        moment_sums=moment_sums,
        row_sums=row_sums,
        products=products,
        rotation_generators=tuple((skew(axes[:, k]), skew(rotation[k, :])) for k in range(3)),
        identities={},
    )


def _coordinates() -> tuple[Coordinate, ...]:
    """The coordinates c1, c2, c3 and the quaternion of the rigid motion."""
    return (
        *(
            Coordinate(quantity(Family.TRANSLATION, k), f"translation of the floating frame along e{k}", "m")
            for k in AXES
        ),
        *(
            Coordinate(quantity(Family.QUATERNION, k), "unit quaternion of the floating frame, scalar first", "1")
            for k in range(4)
        ),
    )


def _rows() -> tuple[EquationOfMotion, ...]:
    translations, spins = [], []
    for k in AXES:
        v, a = (quantity(Family.TRANSLATION, k, derivative=d) for d in (1, 2))
        translations.append(EquationOfMotion(f"c{k}", v, a, f"time derivative of c{k}", "m/s", "N"))
        v, a = (quantity(Family.ANGULAR_VELOCITY, k, derivative=d) for d in (0, 1))
        name = quantity(Family.VIRTUAL_ROTATION, k).name
        spins.append(EquationOfMotion(name, v, a, f"angular velocity about the body axis {k}", "rad/s", "N m"))
    return (*translations, *spins)


def symbols_of_rotation() -> sp.Matrix:
    """The rotation tensor Q in symbols Q_11 .. Q_33."""
    return sp.Matrix(3, 3, lambda i, j: quantity(Family.ROTATION_TENSOR, i + 1, j + 1))


def rotation_of(quaternion: tuple[sp.Symbol, ...]) -> sp.Matrix:
    """The rotation tensor Q of a unit quaternion (e0, e): (e0^2 - e . e) I + 2 e e^T + 2 e0 e x."""
    e0, *imaginary = quaternion
    e = sp.Matrix(imaginary)
    return ((e0**2 - e.dot(e)) * sp.eye(3) + 2 * e * e.T + 2 * e0 * skew(e)).expand()


def quaternion_rates(quaternion: tuple[sp.Symbol, ...], omega: tuple[sp.Symbol, ...]) -> tuple[sp.Expr, ...]:
    """The quaternion rates: half the quaternion times (0, omega), omega in the body frame, so Qdot = Q (omega x)."""
    e0, *imaginary = quaternion
    e, w = sp.Matrix(imaginary), sp.Matrix(omega)
    scalar = -e.dot(w) / 2
    return (scalar.expand(), *(((e0 * w + e.cross(w)) / 2).expand()))


def _rotation_definitions(rotation: sp.Matrix, quaternion: tuple[sp.Symbol, ...]) -> tuple[Intermediate, ...]:
    pairs = zip(rotation, rotation_of(quaternion), strict=True)
    return tuple(Intermediate(s, value, "Q", "(1)", "rotation tensor of the quaternion") for s, value in pairs)


def spatial_sums(truncated: bool = False) -> tuple[tuple[IndexedSum, ...], tuple[IndexedSum, ...]]:
    """The moments of a body in space that have names of their own, and the remaining sums."""
    if truncated:
        moment_sums = second_order_moment_sums(spatial_moment_sums(), AXES)
        return moment_sums, second_order_row_sums(spatial_row_sums(), AXES)
    return spatial_moment_sums(), spatial_row_sums()


def spatial_moment_sums() -> tuple[IndexedSum, ...]:
    """The sums d1, S, d3, J and the others of (15), from r = X + sum alpha_j Phi_j, for a generic shape i.

    rdot and rddot are sums over the shapes as well, so r x rdot = X x rdot + sum alpha_j Phi_j x rdot.
    """
    result: list[IndexedSum] = []

    def define(symbol: Symbol, offset: Symbol | None, doc: str, *sums: tuple[Symbol, Symbol]) -> None:
        result.append(IndexedSum(symbol, offset, sums, doc))

    def each(family: Family, *components: int, derivative: int = 0, index: ShapeIndex = I) -> Symbol:
        """The symbol of a quantity with a generic shape."""
        return quantity(family, *components, derivative=derivative, shapes=(index,))

    for k in AXES:
        sums = ((ALPHA, each(Family.C2, k, index=J)),)
        define(quantity(Family.D1, k), quantity(Family.C1, k), "int rho r", *sums)
    for k in AXES:
        sums = ((ALPHADOT, each(Family.C2, k, index=J)),)
        define(quantity(Family.D1, k, derivative=1), None, "int rho rdot", *sums)
    for ab in PAIRS:
        sums = ((ALPHA, quantity(Family.C5, *ab, shapes=(I, J))),)
        define(each(Family.S, *ab), each(Family.C4, *ab), "symmetric part of D2_{i}", *sums)
    for k in AXES:
        sums = ((ALPHA, quantity(Family.C7, k, shapes=(J, I))),)
        define(each(Family.D3, k), each(Family.C6, k), "int rho r x Phi_{i}", *sums)
    for ab in PAIRS:
        inertia = ((ALPHA, each(Family.C4, *ab, index=J)), (ALPHA, each(Family.S, *ab, index=J)))
        define(quantity(Family.INERTIA, *ab), quantity(Family.C3, *ab), "int rho ((r . r) I - r r)", *inertia)
    for ab in PAIRS:
        sums = ((ALPHADOT, each(Family.S, *ab, index=J)),)
        define(quantity(Family.S, *ab, derivative=1), None, "S of the shapes, summed with their rates", *sums)
    for k in AXES:
        sums = ((ALPHADOT, quantity(Family.C7, k, shapes=(I, J))),)
        define(each(Family.C7_SUM, k, derivative=1), None, "int rho Phi_{i} x rdot", *sums)
    for k in AXES:
        c7dot_j = each(Family.C7_SUM, k, derivative=1, index=J)
        moved = ((ALPHADOT, each(Family.C6, k, index=J)), (ALPHA, c7dot_j))
        define(quantity(Family.D3, k, derivative=1), None, "int rho r x rdot", *moved)
    return tuple(result)


def spatial_row_sums() -> tuple[IndexedSum, ...]:
    """The sums without a name in the expanded form: those with accelerations, and those that occur only once."""
    c8_ij = quantity(Family.C8, shapes=(I, J))
    c8ddot_i, c8dot_i = (quantity(Family.C8_SUM, derivative=d, shapes=(I,)) for d in (2, 1))
    c8dot_j = quantity(Family.C8_SUM, derivative=1, shapes=(J,))
    d1ddot, d3ddot = (
        [
            IndexedSum(quantity(family, k, derivative=2), None, ((ALPHADDOT, quantity(entry, k, shapes=(J,))),), doc)
            for k in AXES
        ]
        for family, entry, doc in (
            (Family.D1, Family.C2, "int rho rddot"),
            (Family.D3, Family.D3, "int rho r x rddot"),
        )
    )
    return (
        *d1ddot,
        *d3ddot,
        IndexedSum(c8ddot_i, None, ((ALPHADDOT, c8_ij),), "int rho Phi_{i} . rddot"),
        IndexedSum(c8dot_i, None, ((ALPHADOT, c8_ij),), "int rho Phi_{i} . rdot"),
        IndexedSum(quantity(Family.RATE_PRODUCT), None, ((ALPHADOT, c8dot_j),), "int rho rdot . rdot"),
    )
