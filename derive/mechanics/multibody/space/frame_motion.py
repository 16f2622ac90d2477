"""The motion of a marker frame in space, and the virtual work of a force and a torque there.

Expressions are polynomials in c, the rotation tensor Q, alpha and their derivatives, in inertial components; the levers
and velocities of a marker have names of their own, so that what follows from them stays short.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property, lru_cache
from itertools import chain
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.axes import AXES
from derive.mechanics.motion.material_points import (
    MaterialPoint,
    acceleration_of_rates,
    radius_and_rate,
    tangent_vectors,
)
from derive.mechanics.motion.products import product
from derive.mechanics.motion.rotations import RATE, SCALE, THETA, inverse_tangent, section_rotation
from derive.mechanics.motion.vectors import cross, dot
from derive.mechanics.symbols import Family, Identity
from derive.mechanics.terms import ConstrainedFrame, EquationOfMotion, FreeRotation, Intermediate, OwnAxes, load_symbols

if TYPE_CHECKING:
    from derive.mechanics.motion.body_motion import Motion
    from derive.mechanics.multibody.bodies.body_type import CrossSection

KEPT = 256
"""The number of marker frames whose motion is kept."""


@cache
def unstressed() -> sp.ImmutableMatrix:
    """The stress of what does not deform."""
    return sp.ImmutableMatrix([0] * 6)


def still() -> sp.ImmutableMatrix:
    """The velocity of what does not move."""
    return sp.ImmutableMatrix([0, 0, 0])


@cache
def fixed_axes() -> sp.ImmutableMatrix:
    """The axes of the inertial frame, or of a body in its own frame."""
    return sp.ImmutableMatrix(sp.eye(3))


@dataclass(frozen=True)
class VirtualMotion:
    """The motion of a frame by a unit virtual displacement of a row.

    The point moves by translation + rotation x (lever) in the inertial frame, and by deformation in that of the body;
    the frame turns by rotation, inertial, and by the tangent operator times `twist` in the frame of the body.
    """

    row: str
    translation: sp.ImmutableMatrix = field(default_factory=still)
    rotation: sp.ImmutableMatrix = field(default_factory=still)
    deformation: sp.ImmutableMatrix = field(default_factory=still)
    twist: sp.ImmutableMatrix = field(default_factory=still)


@dataclass(frozen=True)
class FrameMotion:
    """The motion of a marker frame: columns of 3 in the inertial frame; `axes` has the axes of the frame as columns.

    `lever` is the vector from the origin O of the body to the marker, `frame` the rotation tensor Q of the body,
    `displacement` that of the marker by deformation, u, in the frame of the body, and `tangent` turns the rate of the
    rotation vector of a flexible body at the marker into an angular velocity. `stress` are the components of the stress
    there, Pa, along the axes of the body, where an output asks for them. `inverse_tangent` is the inverse of `tangent`.
    `virtual` are the motions by unit virtual displacements, which are the factors of the accelerations as well.
    `in_body` has the position and the axes of a marker of a body in a tree, in the frame of the body `carrier`;
    `own` is the motion along the axes of a body that keeps all coordinates.
    """

    definitions: tuple[Intermediate, ...]
    position: sp.ImmutableMatrix
    velocity: sp.ImmutableMatrix
    acceleration: sp.ImmutableMatrix
    axes: sp.ImmutableMatrix
    angular_velocity: sp.ImmutableMatrix
    angular_acceleration: sp.ImmutableMatrix
    lever: sp.ImmutableMatrix = field(default_factory=still)
    frame: sp.ImmutableMatrix = field(default_factory=fixed_axes)
    tangent: sp.ImmutableMatrix = field(default_factory=fixed_axes)
    displacement: sp.ImmutableMatrix = field(default_factory=still)
    stress: sp.ImmutableMatrix = field(default_factory=unstressed)
    inverse_tangent: sp.ImmutableMatrix = field(default_factory=fixed_axes)
    virtual: tuple[VirtualMotion, ...] = ()
    in_body: tuple[sp.ImmutableMatrix, sp.ImmutableMatrix] | None = None
    carrier: str = ""
    own: OwnAxes | None = None

    @property
    def is_still(self) -> bool:
        """Whether the frame does not move."""
        moving = (self.velocity, self.acceleration, self.angular_velocity, self.angular_acceleration)
        return not any(entry for vector in moving for entry in vector)

    def work(self, force: sp.Matrix, torque: sp.Matrix) -> Iterator[tuple[str, sp.Expr]]:
        """The virtual work of a force at the point and a torque on the frame, both inertial: a factor for each row."""
        moment = cross(self.lever, force) + sp.Matrix(torque)
        in_body = [product(self.frame.T, sp.Matrix(vector)) for vector in (force, torque)]
        of_twist = product(self.tangent.T, in_body[1])
        for v in self.virtual:
            pairs = ((v.translation, force), (v.rotation, moment), (v.deformation, in_body[0]), (v.twist, of_twist))
            total = sp.Add(*(dot(a, b) for a, b in pairs))
            if total != 0:
                yield v.row, total

    def constrained(self, force: sp.Matrix, torque: sp.Matrix) -> ConstrainedFrame:
        """The frame as a constraint acts on it, with the force and the torque of a unit multiplier."""
        tangent = product(self.frame, self.tangent)
        turns = ((v.row, v.rotation + product(tangent, v.twist) if any(v.twist) else v.rotation) for v in self.virtual)
        turning = {row: sp.ImmutableMatrix(factor) for row, factor in turns if any(factor)}
        rotation = self._free_rotation(tuple(turning))
        others = tuple((row, factor) for row, factor in turning.items() if not rotation or row not in rotation.rows)
        return ConstrainedFrame(
            rotation,
            sp.ImmutableMatrix(cross(self.lever, force) + sp.Matrix(torque)),
            others,
            sp.ImmutableMatrix(force),
            sp.ImmutableMatrix(torque),
            self.any_work,
            self.acceleration,
            self.angular_acceleration,
            self.carrier,
            self.in_body,
            self.own,
        )

    @cached_property
    def any_work(self) -> tuple[tuple[str, sp.Expr], ...]:
        """The virtual work of `load_symbols`, any force and torque."""
        return tuple(self.work(sp.Matrix(load_symbols()[:3]), sp.Matrix(load_symbols()[3:])))

    def _free_rotation(self, turning: tuple[str, ...]) -> FreeRotation | None:
        """The rotation of the body, if three rows turn it alone, about the axes of the body and about its origin."""
        own = [v for v in self.virtual if v.row in turning]
        if len(own) != len(AXES):
            return None
        alone = not any(entry for v in own for of in (v.translation, v.deformation, v.twist) for entry in of)
        along = all(v.rotation == self.frame[:, k] for k, v in enumerate(own))
        first, second, third = (v.row for v in own)
        return FreeRotation((first, second, third), self.frame) if alone and along else None

    def replaced(
        self, change: Callable[[sp.Expr], sp.Expr], weights: Sequence[tuple[str, Mapping[str, sp.Expr]]]
    ) -> FrameMotion:
        """The motion in other symbols; weights: the rows of the free body whose sum each new row is, with factors."""
        free = {v.row: v for v in self.virtual}

        def changed(matrix: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
            return sp.ImmutableMatrix(matrix.applyfunc(change))

        def combined(row: str, factors: Mapping[str, sp.Expr]) -> VirtualMotion:
            names = ("translation", "rotation", "deformation", "twist")
            sums = {
                name: sum((factor * getattr(free[old], name) for old, factor in factors.items()), sp.zeros(3, 1))
                for name in names
            }
            return VirtualMotion(row, **{name: changed(sp.ImmutableMatrix(total)) for name, total in sums.items()})

        vectors = ("position", "velocity", "acceleration", "angular_velocity", "angular_acceleration", "displacement")
        matrices = ("axes", "lever", "frame", "tangent", "stress", "inverse_tangent")
        return replace(
            self,
            **{name: changed(getattr(self, name)) for name in (*vectors, *matrices)},
            virtual=tuple(combined(row, factors) for row, factors in weights),
        )


def fixed_frame(position: sp.Matrix, axes: sp.Matrix) -> FrameMotion:
    """A marker frame of the ground."""
    return FrameMotion((), sp.ImmutableMatrix(position), still(), still(), sp.ImmutableMatrix(axes), still(), still())


class _Definitions:
    """Names for vectors of a marker, with their definitions; numbers stay as they are."""

    def __init__(self, point: str) -> None:
        self.point = point
        self.made: list[Intermediate] = []

    def __call__(self, family: Family, values: Sequence[sp.Expr], doc: str, derivative: int = 0) -> sp.Matrix:
        """The names of the components of a vector."""
        return sp.Matrix(
            [self.one(family, x, f"{doc}, along {k}", k, derivative) for k, x in zip(AXES, values, strict=True)]
        )

    def one(
        self,
        family: Family,
        value: sp.Expr,
        doc: str,
        k: int | tuple[int, ...] = (),
        derivative: int = 0,
        shapes: tuple[int, ...] = (),
    ) -> sp.Expr:
        """The name of a scalar."""
        value = sp.sympify(value)
        if value.is_Rational or value.is_Symbol:
            return value
        components = (k,) if isinstance(k, int) else k
        symbol = Identity(family, shapes, components, derivative, point=self.point).symbol
        self.made.append(Intermediate(symbol, value, self.point or "w", "(1)", doc))
        return symbol


@lru_cache(KEPT)
def frame_motion(motion: Motion, section: CrossSection) -> FrameMotion:
    """The motion of a marker frame of a free body from (1) and (5), in the symbols of its kind."""
    point, Q = section.point, motion.rotation
    of_body, named = _Definitions(""), _Definitions(point.name)
    c, cdot, cddot = (sp.Matrix([*of]) for of in _origin(motion))
    omega, omegadot = sp.Matrix(motion.frame.omega), sp.Matrix(motion.frame.omegadot)
    w = of_body(Family.INERTIAL_OMEGA, product(Q, omega), "angular velocity in the inertial frame")
    u, r, rdot, rddot = _radius(motion, point, named)
    lever = named(Family.LEVER, product(Q, r), f"Q r at {point.name}")
    relative = named(Family.SECTION_VELOCITY, product(Q, rdot), f"Q rdot at {point.name}")
    sdot = named(Family.LEVER, cross(w, lever) + relative, f"time derivative of Q r at {point.name}", 1)
    wdot = product(Q, omegadot)
    acceleration = cddot + cross(wdot, lever) + cross(w, sdot + relative) + product(Q, rddot)
    turned = _turned(motion, section, named)
    axes = product(Q, turned.matrix, section.axes)
    if section.axes != fixed_axes() or turned.deforms:
        axes = sp.Matrix(
            3, 3, lambda i, j: named.one(Family.FRAME_AXES, axes[i, j], f"axes of {point.name}", (i + 1, j + 1))
        )
    spin = named(Family.SECTION_SPIN, product(Q, turned.spin), f"angular velocity of {point.name} against its body")
    angular_acceleration = wdot + cross(w, spin) + product(Q, turned.acceleration)
    return FrameMotion(
        definitions=(*of_body.made, *named.made),
        position=sp.ImmutableMatrix(c + lever),
        velocity=sp.ImmutableMatrix(cdot + sdot),
        acceleration=sp.ImmutableMatrix(acceleration),
        axes=sp.ImmutableMatrix(axes),
        angular_velocity=sp.ImmutableMatrix(w + spin),
        angular_acceleration=sp.ImmutableMatrix(angular_acceleration),
        lever=sp.ImmutableMatrix(lever),
        frame=sp.ImmutableMatrix(Q),
        tangent=sp.ImmutableMatrix(turned.tangent),
        displacement=sp.ImmutableMatrix(u),
        stress=sp.ImmutableMatrix(_stress(motion, section)),
        inverse_tangent=turned.inverse_tangent,
        virtual=tuple(_virtual(motion, point, turned)),
    )


def _stress(motion: Motion, section: CrossSection) -> sp.Matrix:
    """The stress at a section, linear in the amplitudes."""
    of_modes = zip(motion.alpha, section.stresses, strict=True) if section.stresses else ()
    return sum((alpha * stress for alpha, stress in of_modes), sp.zeros(6, 1))


def _origin(motion: Motion) -> tuple[tuple[sp.Expr, ...], ...]:
    rows: tuple[EquationOfMotion, ...] = motion.rows[:3]
    return tuple(c.q for c in motion.coordinates[:3]), tuple(row.v for row in rows), tuple(row.a for row in rows)


def _radius(motion: Motion, point: MaterialPoint, named: _Definitions) -> tuple[sp.Matrix, ...]:
    """u, r = X + u, rdot and rddot of a point in the body frame; r and rdot with names where the body deforms."""
    if not motion.alpha:
        vanishing = {c.symbol: sp.S.Zero for c in point.coefficients if c.zero}
        return sp.zeros(3, 1), sp.Matrix(point.position.xreplace(vanishing)), sp.zeros(3, 1), sp.zeros(3, 1)
    tangents = tangent_vectors(
        motion, point, lambda i, k: Identity(Family.TANGENT, (i,), (k,), point=point.name).symbol
    )
    named.made += [Intermediate(symbol, value, point.name, "(6)", doc) for symbol, value, doc in tangents.definitions]
    at, rate = radius_and_rate(motion, point, tangents.vectors)
    r = named(Family.RADIUS, at, f"r = X + u at {point.name}")
    rdot = named(Family.RADIUS, rate, f"time derivative of r at {point.name}", 1)
    rddot = sum((v * a for v, a in zip(tangents.vectors, motion.alphaddot, strict=True)), sp.zeros(3, 1))
    return at - sp.Matrix(point.position), r, rdot, rddot + acceleration_of_rates(motion, point)


@dataclass(frozen=True)
class _Turned:
    """The rotation of a section by deformation: matrix, tangent operator, spin and angular acceleration in the body."""

    matrix: sp.Matrix
    tangent: sp.Matrix
    spin: sp.Matrix
    acceleration: sp.Matrix
    twists: tuple[sp.ImmutableMatrix, ...]
    deforms: bool
    inverse_tangent: sp.ImmutableMatrix


def _turned(motion: Motion, section: CrossSection, named: _Definitions) -> _Turned:
    twists, second = section.twists, section.second_twists
    if not any(entry for twist in (*twists, *chain(*second)) for entry in twist):
        none = sp.zeros(3, 1)
        return _Turned(sp.eye(3), sp.eye(3), none, none, (still(),) * len(motion.alpha), False, fixed_axes())
    name = section.point.name
    tangents = twists
    if second:
        tangents = tuple(
            sp.ImmutableMatrix(
                [
                    named.one(Family.SECTION_TANGENT, entry, f"dtheta/dalpha_{i} of {name}, about {k}", k, shapes=(i,))
                    for k, entry in enumerate(sp.Matrix(twist) + _total(row, motion.alpha), 1)
                ]
            )
            for i, (twist, row) in enumerate(zip(twists, second, strict=True), 1)
        )
    mean = [(sp.Matrix(a) + sp.Matrix(b)) / 2 for a, b in zip(twists, tangents, strict=True)]
    theta = named(Family.SECTION_VECTOR, _total(mean, motion.alpha), f"rotation vector of {name} by deformation")
    rate = named(Family.SECTION_VECTOR, _total(tangents, motion.alphadot), f"rate of the rotation vector of {name}", 1)
    of_rates = _total([_total(row, motion.alphadot) for row in second], motion.alphadot) if second else sp.zeros(3, 1)
    scale = named.one(Family.SECTION_SCALE, 1 / (1 + dot(theta, theta) / 4), f"scale of the rotation of {name}")
    values = {**dict(zip(THETA, theta, strict=True)), **dict(zip(RATE, rate, strict=True)), SCALE: scale}
    matrix, tangent, bias = (of.xreplace(values) for of in section_rotation())
    return _Turned(
        matrix,
        tangent,
        product(tangent, rate),
        bias + product(tangent, _total(tangents, motion.alphaddot) + of_rates),
        tuple(map(sp.ImmutableMatrix, tangents)),
        True,
        inverse_tangent().xreplace(values),
    )


def _total(vectors: Sequence[sp.Matrix], factors: Sequence[sp.Expr]) -> sp.Matrix:
    """The sum of vectors with factors."""
    return sum((sp.Matrix(vector) * f for vector, f in zip(vectors, factors, strict=True)), sp.zeros(3, 1))


def _virtual(motion: Motion, point: MaterialPoint, turned: _Turned) -> Iterator[VirtualMotion]:
    for k, row in enumerate(motion.rows[:3]):
        yield VirtualMotion(row.name, translation=sp.ImmutableMatrix(sp.eye(3)[:, k]))
    for k, row in enumerate(motion.rows[3:6]):
        yield VirtualMotion(row.name, rotation=sp.ImmutableMatrix(motion.rotation[:, k]))
    tangents = tangent_vectors(
        motion, point, lambda i, k: Identity(Family.TANGENT, (i,), (k,), point=point.name).symbol
    )
    for row, shape, twist in zip(motion.mode_rows, tangents.vectors, turned.twists, strict=True):
        yield VirtualMotion(row.name, deformation=sp.ImmutableMatrix(shape), twist=twist)
