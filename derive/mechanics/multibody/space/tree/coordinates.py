"""Coordinates of rigid bodies in a tree of joints: those of a joint to a body that moves, or all of the body itself."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.axes import AXES
from derive.mechanics.motion.products import product
from derive.mechanics.motion.vectors import cross
from derive.mechanics.multibody.coordinates import CoordinateMap
from derive.mechanics.multibody.space.coordinates import (
    free_spatial_coordinates,
    rotation_about,
)
from derive.mechanics.multibody.space.frame_motion import VirtualMotion, still
from derive.mechanics.multibody.space.joint_coordinate import AXES_OF, JointCoordinate
from derive.mechanics.multibody.space.tree.carried_motion import CarriedMotion, Hinge, Rows, TreeDefinitions, summed
from derive.mechanics.symbols import Family, Identity, owned
from derive.mechanics.terms import Coordinate, Intermediate

if TYPE_CHECKING:
    from derive.mechanics.motion.body_motion import Motion
    from derive.mechanics.multibody.space.frame_motion import FrameMotion


def root_of_tree(name: str, motion: Motion) -> CoordinateMap:
    """The map of a body that keeps all coordinates and carries others."""
    free = free_spatial_coordinates(name, motion)
    define = TreeDefinitions(name)
    Q = _own_frame(name, motion)
    spin = sp.Matrix([row.v for row in free.rows[3:]])
    w = define.vector(Family.INERTIAL_OMEGA, product(Q, spin), "angular velocity in the inertial frame")
    translations = (VirtualMotion(row.name, translation=_unit(k)) for k, row in enumerate(free.rows[:3]))
    carried = CarriedMotion(
        parent="",
        lever=still(),
        rows=free.rows,
        own=len(free.rows),
        virtual=(*translations, *_rotations(free.rows[3:], Q)),
        frame=Q,
        position=sp.ImmutableMatrix([c.q for c in free.coordinates[:3]]),
        velocity=sp.ImmutableMatrix([row.v for row in free.rows[:3]]),
        acceleration=still(),
        angular_velocity=w,
        angular_acceleration=still(),
        definitions=tuple(define.made),
    )
    values = {**free.values, **_inertial_spin(w)}
    return replace(free, values=values, weights=tuple({} for _ in free.rows), carried=carried)


def behind_moving_marker(
    name: str,
    motion: Motion,
    parent: str,
    known: FrameMotion,
    rows_before: Rows,
    own_axes: sp.ImmutableMatrix,
    coordinates: Sequence[JointCoordinate],
    ball: bool,
    reason: str,
) -> CoordinateMap:
    """The map of a body whose origin O is its marker of a joint to the marker `known` of a body that moves.

    rows_before: the rows that move that body. own_axes: the axes of the marker in the body frame. coordinates: the
    relative motions, displacements along the axes of the known marker, then rotations. ball: whether the joint leaves
    all rotations, and the body keeps its quaternion.
    """
    define = TreeDefinitions(name)
    free = free_spatial_coordinates(name, motion)
    translations = [c for c in coordinates if not c.is_rotation]
    rotations = [c for c in coordinates if c.is_rotation]
    bias = {row.a: sp.S.Zero for row in rows_before}
    A, w_before = sp.Matrix(known.axes), sp.Matrix(known.angular_velocity)
    a_before, alpha_before = (v.xreplace(bias) for v in (known.acceleration, known.angular_acceleration))
    position, velocity, acceleration = [sp.Matrix(known.position)], [sp.Matrix(known.velocity)], [sp.Matrix(a_before)]
    moved: list[sp.Matrix] = []
    advance: dict[str, sp.Matrix] = {}
    for c in [*translations, *(c for c in rotations if c.along != 0)]:
        factor = c.along if c.is_rotation else sp.S.One
        axis = A[:, AXES_OF["z" if c.is_rotation else c.motion]] * factor
        s, rate, _ = c.values
        across = cross(w_before, axis)
        moved.append(axis * s)
        velocity.append(axis * rate + across * s)
        acceleration.append(across * (2 * rate) + (cross(alpha_before, axis) + cross(w_before, across)) * s)
        advance[c.motion] = axis
    definitions, Q, axes = _attitude(name, motion, A, own_axes, rotations, ball, define)
    lever = summed([sp.Matrix(known.lever), *moved])
    if moved:
        lever = sp.Matrix(define.vector(Family.OFFSET, lever, f"position of O from the origin of {parent}"))
        position.append(summed(moved))
    x = define.vector(Family.TRANSLATION, summed(position), "position of O")
    xdot = define.vector(Family.TRANSLATION, summed(velocity), "velocity of O", dots=1)
    a = define.vector(Family.BIAS, summed(acceleration), "acceleration of O without those of the coordinates")
    before = [
        replace(
            v,
            translation=define.vector(
                Family.COLUMN,
                v.translation + cross(v.rotation, lever),
                f"translation of O by a unit rate of {v.row}",
                v.row,
            ),
            rotation=still() if ball else v.rotation,
        )
        for v in known.virtual
    ]
    kept, own_rows = own_coordinates(name, motion, coordinates, ball)
    if ball:
        spin = sp.Matrix([row.v for row in free.rows[3:]])
        w = define.vector(Family.INERTIAL_OMEGA, product(Q, spin), "angular velocity in the inertial frame")
        alpha: sp.Matrix = still()
        turning = _rotations(free.rows[3:], Q)
    else:
        w, alpha = _turning(define, w_before, alpha_before, rotations, axes)
        turning = tuple(
            VirtualMotion(c.row.name, sp.ImmutableMatrix(advance.get(c.motion, still())), axes[c.motion])
            for c in rotations
            if c.row
        )
    own = (
        *(VirtualMotion(c.row.name, translation=sp.ImmutableMatrix(advance[c.motion])) for c in translations if c.row),
        *turning,
    )
    carried = CarriedMotion(
        parent=parent,
        lever=sp.ImmutableMatrix(lever),
        rows=(*rows_before, *own_rows),
        own=len(own_rows),
        virtual=(*before, *own),
        frame=Q,
        position=x,
        velocity=xdot,
        acceleration=a,
        angular_velocity=w,
        angular_acceleration=sp.ImmutableMatrix(alpha),
        definitions=(),
        hinge=_hinge(known, own_axes, (*translations, *rotations), ball),
    )
    values = _values(motion, carried)
    values |= {s: free.values[s] for s in free.values if s not in values} if ball else _spins(motion, carried, define)
    carried = replace(carried, definitions=(*definitions, *define.made))
    return CoordinateMap(
        kept,
        own_rows,
        values,
        tuple({} for _ in own_rows),
        (),
        reason,
        None if ball else Q,
        carried,
    )


def own_coordinates(
    name: str, motion: Motion, coordinates: Sequence[JointCoordinate], ball: bool
) -> tuple[tuple[Coordinate, ...], Rows]:
    """The coordinates and the rows of a body behind a joint that leaves these motions, and all rotations if `ball`."""
    free = free_spatial_coordinates(name, motion)
    kept = tuple(c.coordinate for c in coordinates if c.coordinate)
    rows = tuple(c.row for c in coordinates if c.row)
    return ((*kept, *free.coordinates[3:]), (*rows, *free.rows[3:])) if ball else (kept, rows)


class DerivedWhenNeeded(CoordinateMap):
    """The coordinates of a body in a tree, whose motion is derived when something asks for it.

    It has a column for each row of the bodies before it, so that all of a chain take the square of its length; loops
    over links need none of them.
    """

    def __init__(
        self, coordinates: tuple[Coordinate, ...], rows: Rows, reason: str, derived: Callable[[], CoordinateMap]
    ) -> None:
        """derived: the whole map."""
        self.__dict__ |= {"coordinates": coordinates, "rows": rows, "reason": reason, "_derived": derived}

    @property
    def is_carried(self) -> bool:
        """Whether the body is in a tree of joints in space."""
        return True

    @cached_property
    def _whole(self) -> CoordinateMap:
        derived: Callable[[], CoordinateMap] = self.__dict__["_derived"]
        return derived()

    @cached_property
    def values(self) -> Mapping[sp.Basic, sp.Basic]:
        """Each coordinate, velocity and acceleration of the free body."""
        return self._whole.values

    @cached_property
    def weights(self) -> tuple[Mapping[str, sp.Expr], ...]:
        """The factors of the equations of the free body."""
        return self._whole.weights

    @cached_property
    def definitions(self) -> tuple[Intermediate, ...]:
        """The quantities of a prescribed motion."""
        return self._whole.definitions

    @cached_property
    def attitude(self) -> sp.ImmutableMatrix | None:
        """The rotation tensor of a body without quaternion."""
        return self._whole.attitude

    @cached_property
    def carried(self) -> CarriedMotion | None:
        """The motion of the body."""
        return self._whole.carried


def _hinge(known: FrameMotion, own_axes: sp.ImmutableMatrix, motions: tuple[JointCoordinate, ...], ball: bool) -> Hinge:
    place, axes = known.in_body or (known.position, known.axes)
    return Hinge(known, place, axes, own_axes, motions, ball)


def _own_frame(name: str, motion: Motion) -> sp.ImmutableMatrix:
    """The rotation tensor of a body by the symbols that its quaternion defines."""
    return sp.ImmutableMatrix(3, 3, [owned(symbol, name) for symbol in motion.rotation])


def _unit(k: int) -> sp.ImmutableMatrix:
    return sp.ImmutableMatrix(sp.eye(3)[:, k])


def _rotations(rows: Rows, Q: sp.ImmutableMatrix) -> tuple[VirtualMotion, ...]:
    return tuple(VirtualMotion(row.name, rotation=sp.ImmutableMatrix(Q[:, k])) for k, row in enumerate(rows))


def _inertial_spin(w: sp.ImmutableMatrix) -> dict[sp.Basic, sp.Basic]:
    """The symbols of the angular velocity of a kind in the inertial frame, with their values."""
    return {Identity(Family.INERTIAL_OMEGA, components=(k,)).symbol: x for k, x in zip(AXES, w, strict=True)}


def _attitude(
    name: str,
    motion: Motion,
    A: sp.Matrix,
    own_axes: sp.ImmutableMatrix,
    rotations: Sequence[JointCoordinate],
    ball: bool,
    define: TreeDefinitions,
) -> tuple[list[Intermediate], sp.ImmutableMatrix, dict[str, sp.ImmutableMatrix]]:
    """The definitions of the rotation tensor of a body, the tensor, and the inertial axes of its rotations."""
    definitions: list[Intermediate] = []
    if ball:
        return definitions, _own_frame(name, motion), {}
    axes: dict[str, sp.ImmutableMatrix] = {}
    turned, named = A, TreeDefinitions(name)
    for c in rotations:
        axes[c.motion] = named.vector(Family.JOINT_AXIS, turned[:, AXES_OF[c.motion]], "axis of its joint", c.motion)
        turned = product(turned, rotation_about(name, c, definitions))
        if c is not rotations[-1]:
            turned = sp.Matrix(
                3,
                3,
                lambda i, j, now=turned: named.scalar(
                    Family.FRAME_AXES, now[i, j], "axes between the rotations of its joint", (i + 1, j + 1), "between"
                ),
            )
    Q = product(turned, sp.Matrix(own_axes.T))
    tensor = [
        named.scalar(Family.ROTATION_TENSOR, Q[i, j], "rotation tensor", (i + 1, j + 1))
        for i in range(3)
        for j in range(3)
    ]
    return [*definitions, *named.made], sp.ImmutableMatrix(3, 3, tensor), axes


def _turning(
    define: TreeDefinitions,
    before: sp.Matrix,
    alpha_before: sp.Matrix,
    rotations: Sequence[JointCoordinate],
    axes: dict[str, sp.ImmutableMatrix],
) -> tuple[sp.ImmutableMatrix, sp.ImmutableMatrix]:
    """The angular velocity of a body, and its angular acceleration without those of the coordinates."""
    w, alpha = [before], [alpha_before]
    for c in rotations:
        rate = axes[c.motion] * c.values[1]
        alpha.append(cross(summed(w), rate))
        w.append(rate)
    return (
        define.vector(Family.INERTIAL_OMEGA, summed(w), "angular velocity in the inertial frame"),
        define.vector(Family.ANGULAR_BIAS, summed(alpha), "angular acceleration without those of the coordinates"),
    )


def _values(motion: Motion, of: CarriedMotion) -> dict[sp.Basic, sp.Basic]:
    """The symbols of the origin and of the inertial angular velocity of a free body in coordinates of the tree."""
    linear, _ = of.of_accelerations()
    values = _inertial_spin(of.angular_velocity)
    for k in range(3):
        values |= {motion.coordinates[k].q: of.position[k], motion.rows[k].v: of.velocity[k]}
        values[motion.rows[k].a] = linear[k]
    return values


def _spins(motion: Motion, of: CarriedMotion, define: TreeDefinitions) -> dict[sp.Basic, sp.Basic]:
    """The symbols of the angular velocity and acceleration of a free body, which are resolved in its frame."""
    _, angular = of.of_accelerations()
    in_body = (product(sp.Matrix(of.frame.T), vector) for vector in (sp.Matrix(of.angular_velocity), angular))
    w, alpha = in_body
    w = define.vector(Family.ANGULAR_VELOCITY, w, "angular velocity in the frame of the body")
    pairs = zip(motion.rows[3:6], w, alpha, strict=True)
    return {symbol: x for row, v, a in pairs for symbol, x in ((row.v, v), (row.a, a))}
