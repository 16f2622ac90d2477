"""Coordinates of bodies in space: all of them, or those that a joint to a known motion leaves.

The position and the axes of a body behind a known marker are functions of the coordinates of the joint; velocities and
accelerations follow by differentiation, with xdot = v and Adot = w x A of the known marker.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.motion.vectors import cross, skew
from derive.mechanics.multibody.coordinates import CoordinateMap, new_coordinate
from derive.mechanics.multibody.space.joint_coordinate import AXES_OF, JointCoordinate
from derive.mechanics.multibody.space.rows import ROTATIONS
from derive.mechanics.quantity import rounded
from derive.mechanics.symbols import Family, Identity, identity, owned
from derive.mechanics.terms import Coordinate, EquationOfMotion, Intermediate

if TYPE_CHECKING:
    from derive.mechanics.motion.body_motion import Motion
    from derive.mechanics.multibody.point_motion import Derivatives
    from derive.mechanics.multibody.space.frame_motion import FrameMotion


def free_spatial_coordinates(name: str, motion: Motion) -> CoordinateMap:
    """The map of a body that keeps all coordinates; their names get that of the body as a prefix."""
    coordinates, rows = [], []
    values: dict[sp.Basic, sp.Basic] = {}
    for c in motion.coordinates:
        q = owned(c.q, name)
        coordinates.append(Coordinate(q, f"{name}: {c.doc}", c.unit))
        values[c.q] = q
    for row in motion.rows:
        new = _owned_row(name, row)
        rows.append(new)
        values |= {row.v: new.v, row.a: new.a}
    return CoordinateMap(tuple(coordinates), tuple(rows), values, tuple({row.name: sp.S.One} for row in motion.rows))


def _owned_row(name: str, row: EquationOfMotion) -> EquationOfMotion:
    v, a = owned(row.v, name), owned(row.a, name)
    family = identity(row.v).family
    known = identity(row.v)
    if family is Family.ANGULAR_VELOCITY:
        virtual = Identity(Family.VIRTUAL_ROTATION, components=known.components, owner=name).symbol.name
        return EquationOfMotion(virtual, v, a, f"{name}: {row.doc}", row.unit, row.force_unit)
    q = Identity(family, known.shapes, known.components, owner=name).symbol.name
    return EquationOfMotion(q, v, a, f"time derivative of {q}", row.unit, row.force_unit)


def joint_coordinate(body: str, motion: str, several: bool, prescribed: Derivatives | None) -> JointCoordinate:
    """The coordinate of a relative motion, one of several of its kind or not; none if it is prescribed."""
    if prescribed is not None:
        return JointCoordinate(motion, None, None, prescribed)
    rotation = motion in ROTATIONS
    family, unit = (Family.ANGLE, "rad") if rotation else (Family.GUIDE, "m")
    axis = AXES_OF[motion]
    components = (axis + 1,) if several else ()
    doc = f"rotation of {body} in its joint" if rotation else f"displacement of {body} along its joint"
    doc += f", {'xyz'[axis]} axis" if several else ""
    new, row = new_coordinate(Identity(family, components=components, owner=body).symbol, doc, unit)
    return JointCoordinate(motion, new, row, (new.q, row.v, row.a))


def behind_marker(
    name: str,
    motion: Motion,
    known: FrameMotion,
    own_axes: sp.ImmutableMatrix,
    coordinates: Sequence[JointCoordinate],
    reason: str,
) -> CoordinateMap:
    """The map of a body whose origin O is its marker of a joint.

    known: the motion of the other marker. own_axes: the axes of the marker in the body frame. coordinates: the relative
    motions, displacements along the axes of the known marker, then rotations, each about an axis of the frame that the
    ones before it have made.
    """
    definitions: list[Intermediate] = []
    values: dict[sp.Basic, sp.Basic] = {}
    moved = [(c.motion, c.values) for c in coordinates if not c.is_rotation]
    moved += [("z", _scaled(c.along, c.values)) for c in coordinates if c.along != 0]
    position, velocity, acceleration = (sp.Matrix(x) for x in (known.position, known.velocity, known.acceleration))
    A, w, wdot = sp.Matrix(known.axes), sp.Matrix(known.angular_velocity), sp.Matrix(known.angular_acceleration)
    for along, (s, rate, second) in moved:
        axis = A[:, AXES_OF[along]]
        across = cross(w, axis)
        position += axis * s
        velocity += axis * rate + across * s
        acceleration += axis * second + across * (2 * rate) + (cross(wdot, axis) + cross(w, across)) * s
    turned, axes, spin, spin_rate = _rotated(name, [c for c in coordinates if c.is_rotation], definitions)
    attitude = _named(name, motion.rotation, (A * turned * own_axes.T).expand(), definitions)
    omega_known, omegadot_known = (_in_body(attitude, vector) for vector in (w, wdot))
    relative, relative_rate = own_axes * spin, own_axes * spin_rate
    omega = omega_known + relative
    omegadot = omegadot_known + relative_rate - cross(relative, omega_known)
    own = [c for c in coordinates if c.row]
    for k in range(3):
        point = (position[k], velocity[k], acceleration[k])
        symbols = motion.coordinates[k].q, motion.rows[k].v, motion.rows[k].a
        values |= dict(zip(symbols, map(sp.expand, point), strict=True))
        values |= {motion.rows[3 + k].v: sp.expand(omega[k]), motion.rows[3 + k].a: sp.expand(omegadot[k])}
    weights: list[Mapping[str, sp.Expr]] = []
    for c in own:
        if c.is_rotation:
            direction = own_axes * axes[c.motion]
            weight = {motion.rows[3 + k].name: x for k, x in enumerate(direction) if x != 0}
            advance = A[:, AXES_OF["z"]] * c.along
            weights.append({**weight, **{motion.rows[k].name: x for k, x in enumerate(advance) if x != 0}})
        else:
            weights.append({motion.rows[k].name: x for k, x in enumerate(A[:, AXES_OF[c.motion]]) if x != 0})
    return CoordinateMap(
        tuple(c.coordinate for c in own if c.coordinate),
        tuple(c.row for c in own if c.row),
        values,
        tuple(weights),
        tuple(definitions),
        reason,
        sp.ImmutableMatrix(attitude),
    )


def _scaled(factor: sp.Expr, values: Derivatives) -> Derivatives:
    position, rate, second = values
    return factor * position, factor * rate, factor * second


def _in_body(attitude: sp.Matrix, vector: sp.Matrix) -> sp.Matrix:
    return attitude.T * vector if any(vector) else sp.zeros(3, 1)


def _named(name: str, symbols: sp.Matrix, values: sp.Matrix, definitions: list[Intermediate]) -> sp.Matrix:
    """The entries of a rotation tensor as symbols of the body with definitions; numbers and symbols as they are."""
    result = sp.zeros(3, 3)
    for i in range(3):
        for j in range(3):
            value = rounded(values[i, j])
            if not (value.is_Rational or value.is_Symbol):
                symbol = owned(symbols[i, j], name)
                definitions.append(Intermediate(symbol, value, name, "(1)", f"rotation tensor of {name}"))
                value = symbol
            result[i, j] = value
    return result


def _rotated(
    name: str, rotations: Sequence[JointCoordinate], definitions: list[Intermediate]
) -> tuple[sp.Matrix, dict[str, sp.Matrix], sp.Matrix, sp.Matrix]:
    """The relative rotation of the markers, the axis of each rotation in the second one, and the relative spin.

    The spin and its time derivative in the second frame, in which the axes turn with the rotations behind them.
    """
    matrices = [rotation_about(name, c, definitions) for c in rotations]
    total = sp.eye(3)
    for matrix in matrices:
        total = total * matrix
    axes: dict[str, sp.Matrix] = {}
    spin, spin_rate = sp.zeros(3, 1), sp.zeros(3, 1)
    for number, c in enumerate(rotations):
        behind = sp.eye(3)
        inner = sp.zeros(3, 1)  # the spin of the second frame against the frame in which the axis is fixed
        for later, matrix in zip(rotations[number + 1 :], matrices[number + 1 :], strict=True):
            behind = behind * matrix
            inner = matrix.T * inner + _unit(later.motion) * later.values[1]
        axis = (behind.T * _unit(c.motion)).expand()
        axes[c.motion] = axis
        spin += axis * c.values[1]
        spin_rate += axis * c.values[2] - cross(inner, axis) * c.values[1]
    return total, axes, spin, spin_rate


def _unit(motion: str) -> sp.Matrix:
    return sp.eye(3)[:, AXES_OF[motion]]


def rotation_about(name: str, c: JointCoordinate, definitions: list[Intermediate]) -> sp.Matrix:
    """The rotation matrix about an axis of the marker, with names for its cosine and sine."""
    angle, axis = c.values[0], AXES_OF[c.motion]
    components = () if c.coordinate is None else identity(c.coordinate.q).components
    named = []
    for family, function, text in ((Family.COSINE, sp.cos, "cosine"), (Family.SINE, sp.sin, "sine")):
        value = rounded(function(angle))
        if not value.is_Rational:
            symbol = Identity(family, components=components, owner=name).symbol
            definitions.append(
                Intermediate(symbol, value, name, "(26)", f"{text} of the rotation of {name} in its joint")
            )
            value = symbol
        named.append(value)
    cosine, sine = named
    e = sp.eye(3)[:, axis]
    matrix = cosine * sp.eye(3) + sine * skew(e) + (1 - cosine) * e * e.T
    return matrix.expand()


def on_ball(
    name: str, motion: Motion, known: FrameMotion, coordinates: Sequence[JointCoordinate], reason: str
) -> CoordinateMap:
    """The map of a body that keeps its rotation, and whose origin follows a known marker and moves along its axes."""
    free = free_spatial_coordinates(name, motion)
    moved = behind_marker(name, motion, known, sp.ImmutableMatrix(sp.eye(3)), coordinates, reason)
    translations = {
        s for c, row in zip(motion.coordinates[:3], motion.rows[:3], strict=True) for s in (c.q, row.v, row.a)
    }
    values = {s: value for s, value in free.values.items() if s not in translations}
    return CoordinateMap(
        (*moved.coordinates, *free.coordinates[3:]),
        (*moved.rows, *free.rows[3:]),
        {**values, **{s: moved.values[s] for s in translations}},
        (*moved.weights, *free.weights[3:]),
        (),
        reason,
    )
