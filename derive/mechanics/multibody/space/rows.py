"""The relative motions of two marker frames: six rows for joints, and the two that drives prescribe.

A row is a polynomial g of the positions x1, x2 and the axes A1, A2 of both frames. Its factors of the velocities and
the part of its second derivative without accelerations follow from xdot = v, Adot = w x A, so that nobody writes one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.motion.vectors import cross, dot, skew

if TYPE_CHECKING:
    from derive.mechanics.multibody.space.frame_motion import FrameMotion


def _dummies(label: str, rows: int, columns: int = 1) -> sp.Matrix:
    return sp.Matrix(rows, columns, lambda i, j: sp.Dummy(f"{label}_{i + 1}{j + 1}"))


@dataclass(frozen=True)
class FrameVariables:
    """The variables of one frame: position x, velocity v, axes A as columns, and angular velocity w."""

    x: sp.Matrix
    v: sp.Matrix
    A: sp.Matrix
    w: sp.Matrix

    def rates(self) -> dict[sp.Symbol, sp.Expr]:
        """The time derivatives of the variables without accelerations."""
        turning = skew(self.w) * self.A
        return {**dict(zip(self.x, self.v, strict=True)), **dict(zip(self.A, turning, strict=True))}

    def values(self, frame: FrameMotion) -> dict[sp.Symbol, sp.Expr]:
        """The values of the variables for a marker frame."""
        pairs = (
            (self.x, frame.position),
            (self.v, frame.velocity),
            (self.A, frame.axes),
            (self.w, frame.angular_velocity),
        )
        return {s: value for symbols, matrix in pairs for s, value in zip(symbols, matrix, strict=True)}


def _frame(number: int) -> FrameVariables:
    return FrameVariables(
        _dummies(f"x{number}", 3), _dummies(f"v{number}", 3), _dummies(f"A{number}", 3, 3), _dummies(f"w{number}", 3)
    )


@dataclass(frozen=True)
class RowVariables:
    """The variables of rows: those of both frames, and those of their joint and its drive.

    motion: the prescribed motion of the drive with its derivatives, with its cosine and its sine. length: the distance
    of a joint that keeps one. lead: the displacement along z of a screw joint for a rotation of 1 rad about it, m/rad.
    """

    first: FrameVariables
    second: FrameVariables
    motion: tuple[sp.Symbol, ...]
    cos: sp.Symbol
    sin: sp.Symbol
    length: sp.Symbol
    lead: sp.Symbol

    @property
    def apart(self) -> sp.Matrix:
        """The vector from the first marker to the second."""
        return self.second.x - self.first.x

    def along(self, i: int, j: int) -> sp.Expr:
        """The product of axis i of the first marker and axis j of the second."""
        return dot(self.first.A[:, i], self.second.A[:, j])

    def displacement(self, axis: int) -> sp.Expr:
        """The displacement of the second marker along an axis of the first."""
        return dot(self.first.A[:, axis], self.apart)


@cache
def row_variables() -> RowVariables:
    """The variables of all rows, which do not depend on the joint."""
    motion = tuple(sp.Dummy(label) for label in ("motion", "motiondot", "motionddot"))
    others = (sp.Dummy(label) for label in ("cos_motion", "sin_motion", "length", "lead"))
    return RowVariables(_frame(1), _frame(2), motion, *others)


@dataclass(frozen=True)
class RelativeFunction:
    """A function g of two marker frames, which a joint removes or a drive prescribes.

    The name of the multiplier is that of the joint with `label` behind it. `doc` is a template with the fields
    {markers}, {second} (the second body) and {joint}. unit: that of g; force_unit: that of the multiplier. formula: g
    as a function of the variables.
    """

    label: str
    doc: str
    unit: str
    force_unit: str
    formula: Callable[[RowVariables], sp.Expr]

    @cached_property
    def g(self) -> sp.Expr:
        """The function, an expression of the variables."""
        return self.formula(row_variables())


@dataclass(frozen=True)
class Derived:
    """The derivatives of a row: gdot = f1 . v1 + m1 . w1 + f2 . v2 + m2 . w2 + drift, and gddot without accelerations.

    f1, m1, f2, m2 are what a unit multiplier exerts on the two frames: forces and torques in inertial components.
    """

    f1: sp.Matrix
    m1: sp.Matrix
    f2: sp.Matrix
    m2: sp.Matrix
    rate: sp.Expr
    bias: sp.Expr

    @property
    def turns(self) -> bool:
        """Whether gdot depends on the difference of the angular velocities alone."""
        forces, torques = (*self.f1, *self.f2), (sp.expand(a + b) for a, b in zip(self.m1, self.m2, strict=True))
        return not any(forces) and not any(torques)


@lru_cache(256)
def derived(row: RelativeFunction) -> Derived:
    """The derivatives of a row."""
    of, rate = row_variables(), _rate(row.g)
    velocities = (of.first.v, of.first.w, of.second.v, of.second.w)
    f1, m1, f2, m2 = (sp.Matrix([sp.factor_terms(rate.diff(s)) for s in v]) for v in velocities)
    bias = _bias_of_rotation(row.g)
    return Derived(f1, m1, f2, m2, rate, _rate(rate) if bias is None else bias)


def _bias_of_rotation(g: sp.Expr) -> sp.Expr | None:
    """The second derivative, without accelerations, of a sum of products p . a with axes a of the second frame.

    p moves with the first frame, from which a has the relative angular velocity w = w2 - w1 and, since that has no
    derivative but the one that turning gives it, the acceleration w x (w x a) - (w1 x w) x a, which rows share. None of
    other functions.
    """
    first, second = row_variables().first, row_variables().second
    factors = [sp.Matrix([g.diff(x) for x in second.A[:, k]]) for k in range(3)]
    present = set().union(*(x.free_symbols for p in factors for x in p))
    products = (p_k * a_k for k, p in enumerate(factors) for p_k, a_k in zip(p, second.A[:, k], strict=True))
    if not present <= first.A.free_symbols or sp.expand(g - sp.Add(*products)) != 0:
        return None
    w = second.w - first.w
    turning = cross(first.w, w)
    total = sp.S.Zero
    for k, p in enumerate(factors):
        if any(p):
            a = second.A[:, k]
            total += dot(p, cross(w, cross(w, a)) - cross(turning, a))
    return total


def _rate(of: sp.Expr) -> sp.Expr:
    """The time derivative of an expression in which all accelerations are zero."""
    known = row_variables()
    rates: Mapping[sp.Symbol, sp.Expr] = {
        **known.first.rates(),
        **known.second.rates(),
        **dict(pairwise(known.motion)),
        known.cos: -known.sin * known.motion[1],
        known.sin: known.cos * known.motion[1],
    }
    present = of.free_symbols & rates.keys()
    return sp.Add(*(of.diff(s) * rates[s] for s in sorted(present, key=lambda s: (s.name, s.dummy_index))))


# ---- the rows ----


def _displacement(k: int, axis: str) -> RelativeFunction:
    doc = f"{{markers}} coincide along the {axis} axis of the first"
    return RelativeFunction(axis, doc, "m", "N", lambda of: of.displacement(k))


def _coincident(k: int, axis: str) -> RelativeFunction:
    doc = f"{{markers}} coincide along the inertial {axis} axis"
    return RelativeFunction(axis, doc, "m", "N", lambda of: of.apart[k])


COINCIDENT = tuple(_coincident(k, axis) for k, axis in enumerate("xyz"))
"""The rows of a joint that removes all displacements: inertial components, whose factors do not depend on the state."""


def _rotation(axis: str, sign: int, i: int, j: int) -> RelativeFunction:
    """The product of axis i of the first marker and axis j of the second, with a sign."""
    doc = f"{{markers}}: {'xyz'[i]} of the first is normal to {'xyz'[j]} of the second"
    return RelativeFunction(f"r{axis}", doc, "rad", "N m", lambda of: of.along(i, j) if sign > 0 else -of.along(i, j))


DISPLACEMENTS = {axis: _displacement(k, axis) for k, axis in enumerate("xyz")}
"""The displacements of the second marker along the axes of the first."""

ROTATIONS: Mapping[str, tuple[RelativeFunction, RelativeFunction]] = {
    "rx": (_rotation("x", 1, 2, 1), _rotation("x", -1, 1, 2)),
    "ry": (_rotation("y", -1, 2, 0), _rotation("y", 1, 0, 2)),
    "rz": (_rotation("z", 1, 1, 0), _rotation("z", -1, 0, 1)),
}
"""Two forms of each rotation about an axis of the first marker, equal to it where the frames are nearly parallel."""

_FORMS = {
    ("rx",): (0,),
    ("ry",): (0,),
    ("rz",): (0,),
    ("rx", "ry"): (1, 1),
    ("rx", "rz"): (0, 1),
    ("ry", "rz"): (0, 0),
    ("rx", "ry", "rz"): (0, 1, 0),
}
"""The forms of the rotations that a joint removes: two of them keep the axis of the third one parallel."""

RELATIVE_MOTIONS = (*DISPLACEMENTS, *ROTATIONS)
"""The names of the relative motions, in the order of the multipliers."""


def masked(removes: tuple[str, ...]) -> tuple[RelativeFunction, ...]:
    """The rows of a joint that removes these relative motions."""
    rotations = tuple(name for name in ROTATIONS if name in removes)
    forms = _FORMS.get(rotations, ())
    along = tuple(DISPLACEMENTS[name] for name in DISPLACEMENTS if name in removes)
    displacements = COINCIDENT if len(along) == len(COINCIDENT) else along
    return (*displacements, *(ROTATIONS[name][form] for name, form in zip(rotations, forms, strict=True)))


def _turn(of: RowVariables) -> sp.Expr:
    from derive.mechanics.time_functions import Atan2

    return Atan2(of.along(1, 0), of.along(0, 0))


def _screw(of: RowVariables) -> sp.Expr:
    from derive.mechanics.time_functions import Wrapped

    return Wrapped(of.displacement(2) - of.lead * TURN.g, of.lead)


DISTANCE = RelativeFunction(
    "distance",
    "{markers} keep their distance",
    "m",
    "N",
    lambda of: (dot(of.apart, of.apart) - of.length**2) / (2 * of.length),
)

TURN = RelativeFunction("turn", "", "rad", "N m", _turn)
"""The rotation about z from -pi to pi: the angle of x of the second marker in the plane of x and y of the first."""

SCREW = RelativeFunction("screw", "{markers} move along z by the pitch for each turn", "m", "N", _screw)
"""The displacement along z less that of the rotation about z, modulo the pitch: the displacement counts the turns."""

DRIVEN_ROTATION = RelativeFunction(
    "turn",
    "drive {drive} turns {second}",
    "rad",
    "N m",
    lambda of: of.along(1, 0) * of.cos - of.along(0, 0) * of.sin,
)
"""The rotation about z less the prescribed one: the sine of the difference."""

DRIVEN_DISPLACEMENT = RelativeFunction(
    "along", "drive {drive} displaces {second}", "m", "N", lambda of: of.displacement(2) - of.motion[0]
)
