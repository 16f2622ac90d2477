"""The relative motions of two marker frames: six rows for joints, and the two that drives prescribe.

A row is a polynomial g of the positions x1, x2 and the axes A1, A2 of both frames. Its factors of the velocities and
the part of its second derivative without accelerations follow from xdot = v, Adot = w x A, so that nobody writes one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

from derive.algebra import sp
from derive.mechanics.motion.spatial import skew
from derive.mechanics.multibody.space.frame_motion import FrameMotion, cross, dot
from derive.mechanics.time_functions import Atan2, Wrapped


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


FIRST, SECOND = _frame(1), _frame(2)
MOTION = tuple(sp.Dummy(label) for label in ("motion", "motiondot", "motionddot"))
COS, SIN = sp.Dummy("cos_motion"), sp.Dummy("sin_motion")
"""The prescribed motion of a drive with its derivatives, its cosine and its sine."""
LENGTH = sp.Dummy("length")
"""The distance of a joint that keeps one."""
LEAD = sp.Dummy("lead")
"""The displacement along z of a screw joint for a rotation of 1 rad about it, m/rad."""


@dataclass(frozen=True)
class RelativeFunction:
    """A function g of two marker frames, which a joint removes or a drive prescribes.

    The name of the multiplier is that of the joint with `label` behind it. `doc` is a template with the fields
    {markers}, {second} (the second body) and {joint}. unit: that of g; force_unit: that of the multiplier.
    """

    label: str
    doc: str
    unit: str
    force_unit: str
    g: sp.Expr


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
    rate = _rate(row.g)
    velocities = (FIRST.v, FIRST.w, SECOND.v, SECOND.w)
    f1, m1, f2, m2 = (sp.Matrix([sp.factor_terms(rate.diff(s)) for s in of]) for of in velocities)
    bias = _bias_of_rotation(row.g)
    return Derived(f1, m1, f2, m2, rate, _rate(rate) if bias is None else bias)


def _bias_of_rotation(g: sp.Expr) -> sp.Expr | None:
    """The second derivative, without accelerations, of a sum of products p . a with axes a of the second frame.

    p moves with the first frame, from which a has the relative angular velocity w = w2 - w1 and, since that has no
    derivative but the one that turning gives it, the acceleration w x (w x a) - (w1 x w) x a, which rows share. None of
    other functions.
    """
    factors = [sp.Matrix([g.diff(x) for x in SECOND.A[:, k]]) for k in range(3)]
    present = set().union(*(x.free_symbols for p in factors for x in p))
    products = (p_k * a_k for k, p in enumerate(factors) for p_k, a_k in zip(p, SECOND.A[:, k], strict=True))
    if not present <= FIRST.A.free_symbols or sp.expand(g - sp.Add(*products)) != 0:
        return None
    w = SECOND.w - FIRST.w
    turning = cross(FIRST.w, w)
    total = sp.S.Zero
    for k, p in enumerate(factors):
        if any(p):
            a = SECOND.A[:, k]
            total += dot(p, cross(w, cross(w, a)) - cross(turning, a))
    return total


def _rate(of: sp.Expr) -> sp.Expr:
    """The time derivative of an expression in which all accelerations are zero."""
    rates: Mapping[sp.Symbol, sp.Expr] = {
        **FIRST.rates(),
        **SECOND.rates(),
        **dict(pairwise(MOTION)),
        COS: -SIN * MOTION[1],
        SIN: COS * MOTION[1],
    }
    present = of.free_symbols & rates.keys()
    return sp.Add(*(of.diff(s) * rates[s] for s in sorted(present, key=lambda s: (s.name, s.dummy_index))))


# ---- the rows ----

_D = SECOND.x - FIRST.x
_X1, _Y1, _Z1 = (FIRST.A[:, k] for k in range(3))
_X2, _Y2, _Z2 = (SECOND.A[:, k] for k in range(3))


def _displacement(axis: str, direction: sp.Matrix) -> RelativeFunction:
    doc = f"{{markers}} coincide along the {axis} axis of the first"
    return RelativeFunction(axis, doc, "m", "N", dot(direction, _D))


COINCIDENT = tuple(
    RelativeFunction(axis, f"{{markers}} coincide along the inertial {axis} axis", "m", "N", component)
    for axis, component in zip("xyz", _D, strict=True)
)
"""The rows of a joint that removes all displacements: inertial components, whose factors do not depend on the state."""


def _rotation(axis: str, g: sp.Expr, doc: str) -> RelativeFunction:
    return RelativeFunction(f"r{axis}", f"{{markers}}: {doc}", "rad", "N m", g)


DISPLACEMENTS = {axis: _displacement(axis, of) for axis, of in (("x", _X1), ("y", _Y1), ("z", _Z1))}
"""The displacements of the second marker along the axes of the first."""

ROTATIONS: Mapping[str, tuple[RelativeFunction, RelativeFunction]] = {
    "rx": (
        _rotation("x", dot(_Z1, _Y2), "z of the first is normal to y of the second"),
        _rotation("x", -dot(_Y1, _Z2), "y of the first is normal to z of the second"),
    ),
    "ry": (
        _rotation("y", -dot(_Z1, _X2), "z of the first is normal to x of the second"),
        _rotation("y", dot(_X1, _Z2), "x of the first is normal to z of the second"),
    ),
    "rz": (
        _rotation("z", dot(_Y1, _X2), "y of the first is normal to x of the second"),
        _rotation("z", -dot(_X1, _Y2), "x of the first is normal to y of the second"),
    ),
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


DISTANCE = RelativeFunction(
    "distance", "{markers} keep their distance", "m", "N", (dot(_D, _D) - LENGTH**2) / (2 * LENGTH)
)

TURN = RelativeFunction("turn", "", "rad", "N m", Atan2(dot(_Y1, _X2), dot(_X1, _X2)))
"""The rotation about z from -pi to pi: the angle of x of the second marker in the plane of x and y of the first."""

SCREW = RelativeFunction(
    "screw", "{markers} move along z by the pitch for each turn", "m", "N", Wrapped(dot(_Z1, _D) - LEAD * TURN.g, LEAD)
)
"""The displacement along z less that of the rotation about z, modulo the pitch: the displacement counts the turns."""

DRIVEN_ROTATION = RelativeFunction(
    "turn", "drive {drive} turns {second}", "rad", "N m", dot(_Y1, _X2) * COS - dot(_X1, _X2) * SIN
)
"""The rotation about z less the prescribed one: the sine of the difference."""

DRIVEN_DISPLACEMENT = RelativeFunction("along", "drive {drive} displaces {second}", "m", "N", dot(_Z1, _D) - MOTION[0])
