"""Motion in the plane: (23)-(27) for any deformable body, with the sums of its shape integrals."""

from __future__ import annotations

from dataclasses import replace

from derive.mechanics.integrals import planar_series, planar_sums
from derive.mechanics.kinematics import MovingFrame, PlanarRotation
from derive.mechanics.motion import MASS, Motion, definitions_of, sums_of
from derive.mechanics.series import ALPHA, ALPHADDOT, ALPHADOT
from derive.mechanics.symbols import Family, Symbol, amplitude, identity, quantity
from derive.mechanics.terms import Coordinate, Definition, Row
from derive.mechanics.virtual_work import PlanarMoments


def planar_motion(n: int) -> Motion:
    """The motion of a planar body with n shapes."""
    coordinates = _coordinates(n)
    rows = tuple(map(_row, coordinates))
    alpha = tuple(c.q for c in coordinates[3:])
    rotation, phi = PlanarRotation(coordinates[2].q), rows[2]
    turn = rotation.generator  # about e3, which both bases share
    shapes = rows[3:]
    vectors = {ALPHA: alpha, ALPHADOT: tuple(row.v for row in shapes), ALPHADDOT: tuple(row.a for row in shapes)}
    return Motion(
        coordinates=coordinates,
        rows=rows,
        rates=tuple(row.v for row in rows),
        alpha=alpha,
        rotation=rotation.tensor,
        rotation_definitions=_rotation_definitions(rotation),
        frame=MovingFrame((turn,), (phi.v,), (phi.a,)),
        moments=PlanarMoments(MASS, rotation.tensor),
        definitions=definitions_of(planar_series(), vectors, n),
        sums=sums_of(planar_sums(), vectors, n),
        products={},
        turns=((turn, turn),),
        identities={("phi", "centrifugal"): "planar motion: omega x (J . omega) = 0"},
    )


def _coordinates(n: int) -> tuple[Coordinate, ...]:
    """c1, c2, phi, alpha1..alphaN: (14), (23), (27)."""
    c1, c2 = (quantity(Family.TRANSLATION, k) for k in (1, 2))
    return (
        Coordinate(c1, "position of the origin of the floating frame along the inertial e1", "m"),
        Coordinate(c2, "position of the origin of the floating frame along the inertial e2", "m"),
        Coordinate(quantity(Family.ANGLE), "rotation of the floating frame", "rad"),
        *(Coordinate(amplitude(i), f"amplitude of assumed mode {i}", "m") for i in range(1, n + 1)),
    )


def _row(coordinate: Coordinate) -> Row:
    """In the plane every coordinate has its row, and its rate is its time derivative."""
    name, known = str(coordinate.q), identity(coordinate.q)
    v, a = (Symbol(replace(known, derivative=d)) for d in (1, 2))
    return Row(
        name, v, a, f"time derivative of {name}", f"{coordinate.unit}/s", "N m" if coordinate.unit == "rad" else "N"
    )


def _rotation_definitions(rotation: PlanarRotation) -> tuple[Definition, ...]:
    docs = {rotation.cos: "cosine of the rotation angle", rotation.sin: "sine of the rotation angle"}
    return tuple(Definition(s, value, "Q", "(26)", docs[s]) for s, value in rotation.functions.items())
