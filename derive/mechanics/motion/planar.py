"""Motion in the plane: (23)-(27) for any deformable body, with the sums of its shape integrals."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

from derive.mechanics.motion.body_motion import Motion
from derive.mechanics.motion.kinematics import MovingFrame, PlanarRotation
from derive.mechanics.motion.moments import FIRST, FIRST_OF_SECOND_ORDER, PlanarMoments
from derive.mechanics.motion.second_order import second_order_moment_sums, second_order_row_sums
from derive.mechanics.sums import ALPHA, ALPHADDOT, ALPHADOT, IndexedSum
from derive.mechanics.symbols import Family, I, J, identity, quantity
from derive.mechanics.terms import Coordinate, EquationOfMotion, Intermediate


@cache
def planar_motion(n: int, second_order: bool = False) -> Motion:
    """The motion of a planar body with n shapes; at second order r is quadratic in their amplitudes."""
    return _rigid_motion(second_order).with_modes(n)


@cache
def _rigid_motion(second_order: bool) -> Motion:
    coordinates = _coordinates()
    rows = tuple(map(_row, coordinates))
    rotation, phi = PlanarRotation(coordinates[2].q), rows[2]
    generator = rotation.generator  # about e3, which both frames share
    moment_sums, row_sums = planar_sums(second_order)
    return Motion(
        coordinates=coordinates,
        rows=rows,
        rates=tuple(row.v for row in rows),
        alpha=(),
        rotation=rotation.tensor,
        rotation_definitions=_rotation_definitions(rotation),
        frame=MovingFrame((generator,), (phi.v,), (phi.a,)),
        moments=PlanarMoments(quantity(Family.MASS), rotation.tensor, FIRST_OF_SECOND_ORDER if second_order else FIRST),
        named=(),
        moment_sums=moment_sums,
        row_sums=row_sums,
        products={},
        rotation_generators=((generator, generator),),
        identities={("phi", "centrifugal"): "planar motion: omega x (J . omega) = 0"},
    )


def _coordinates() -> tuple[Coordinate, ...]:
    """The coordinates c1, c2, phi of the rigid motion: (14), (23)."""
    c1, c2 = (quantity(Family.TRANSLATION, k) for k in (1, 2))
    return (
        Coordinate(c1, "position of the origin of the floating frame along the inertial e1", "m"),
        Coordinate(c2, "position of the origin of the floating frame along the inertial e2", "m"),
        Coordinate(quantity(Family.ANGLE), "rotation of the floating frame", "rad"),
    )


def _row(coordinate: Coordinate) -> EquationOfMotion:
    """The equation of motion of a coordinate: in the plane its velocity is the time derivative of the coordinate."""
    name, known = str(coordinate.q), identity(coordinate.q)
    v, a = (replace(known, derivative=d).symbol for d in (1, 2))
    return EquationOfMotion(
        name, v, a, f"time derivative of {name}", f"{coordinate.unit}/s", "N m" if coordinate.unit == "rad" else "N"
    )


def _rotation_definitions(rotation: PlanarRotation) -> tuple[Intermediate, ...]:
    docs = {rotation.cos: "cosine of the rotation angle", rotation.sin: "sine of the rotation angle"}
    return tuple(Intermediate(s, value, "Q", "(26)", docs[s]) for s, value in rotation.functions.items())


def planar_sums(second_order: bool = False) -> tuple[tuple[IndexedSum, ...], tuple[IndexedSum, ...]]:
    """The moments of a planar body that have names of their own, and the remaining sums."""
    if second_order:
        return second_order_moment_sums(planar_moment_sums()), second_order_row_sums(planar_row_sums())
    return planar_moment_sums(), planar_row_sums()


def planar_moment_sums() -> tuple[IndexedSum, ...]:
    """The sums d1, D2, d3, J and their sums with the velocities of alpha, from r = X + sum alpha_j Phi_j."""
    c4_j, c6_i = quantity(Family.C4, shapes=(J,)), quantity(Family.C6, shapes=(I,))
    c8_ij, c7_ji = quantity(Family.C8, shapes=(I, J)), quantity(Family.C7, shapes=(J, I))
    d2_j, d3_j = (quantity(family, shapes=(J,)) for family in (Family.D2, Family.D3))
    result: list[IndexedSum] = []
    for k in (1, 2):
        c2_j = quantity(Family.C2, k, shapes=(J,))
        d1, d1dot = (quantity(Family.D1, k, derivative=d) for d in (0, 1))
        result.append(IndexedSum(d1, quantity(Family.C1, k), ((ALPHA, c2_j),), "int rho r"))
        result.append(IndexedSum(d1dot, None, ((ALPHADOT, c2_j),), "int rho rdot"))
    d2, d3 = (quantity(family, shapes=(I,)) for family in (Family.D2, Family.D3))
    result.append(IndexedSum(d2, quantity(Family.C4, shapes=(I,)), ((ALPHA, c8_ij),), "int rho r . Phi_{i}"))
    result.append(IndexedSum(d3, c6_i, ((ALPHA, c7_ji),), "int rho r x Phi_{i}"))  # r x Phi_i = X x Phi_i + ...
    inertia = ((ALPHA, c4_j), (ALPHA, d2_j))
    result.append(IndexedSum(quantity(Family.INERTIA), quantity(Family.C3), inertia, "int rho r . r"))
    result.append(IndexedSum(quantity(Family.D2, derivative=1), None, ((ALPHADOT, d2_j),), "int rho r . rdot"))
    result.append(IndexedSum(quantity(Family.D3, derivative=1), None, ((ALPHADOT, d3_j),), "int rho r x rdot"))
    return tuple(result)


def planar_row_sums() -> tuple[IndexedSum, ...]:
    """The remaining sums of (15): those that occur in a single equation, and those with accelerations."""
    c8_ij, c7_ij = (quantity(family, shapes=(I, J)) for family in (Family.C8, Family.C7))
    d3_j = quantity(Family.D3, shapes=(J,))
    c8dot_i, c8ddot_i = (quantity(Family.C8_SUM, derivative=d, shapes=(I,)) for d in (1, 2))
    c8dot_j = quantity(Family.C8_SUM, derivative=1, shapes=(J,))
    c7dot_i = quantity(Family.C7_SUM, derivative=1, shapes=(I,))
    d1ddot = (
        IndexedSum(quantity(Family.D1, k, derivative=2), None, ((ALPHADDOT, c2_j),), "int rho rddot")
        for k in (1, 2)
        for c2_j in [quantity(Family.C2, k, shapes=(J,))]
    )
    return (
        *d1ddot,
        IndexedSum(quantity(Family.D3, derivative=2), None, ((ALPHADDOT, d3_j),), "int rho r x rddot"),
        IndexedSum(c8ddot_i, None, ((ALPHADDOT, c8_ij),), "int rho Phi_{i} . rddot"),
        IndexedSum(c7dot_i, None, ((ALPHADOT, c7_ij),), "int rho Phi_{i} x rdot"),
        IndexedSum(c8dot_i, None, ((ALPHADOT, c8_ij),), "int rho Phi_{i} . rdot"),
        IndexedSum(quantity(Family.RATE_PRODUCT), None, ((ALPHADOT, c8dot_j),), "int rho rdot . rdot"),
    )
