"""Typed symbols: the meaning of a symbol of the derivation, as data from which its name is printed.

Every SymPy symbol of the derivation is a `Symbol` with an `Identity`: the family of the quantity, the shapes and
components it is counted by, its time derivative, and in a mechanism the body or element it belongs to. Code that
needs a fact about a symbol reads it from the identity; the name is printed for people and compilers and never parsed.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import Enum
from functools import cache, cached_property
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.spec.model.instances import identifier, joined, rate_name

if TYPE_CHECKING:
    from derive.mechanics.typed_symbol import Symbol


class Index(Enum):
    """The generic indices of shapes, which sums run over."""

    I = "i"  # noqa: E741  the name of the index
    J = "j"

    __hash__ = object.__hash__

    def __str__(self) -> str:
        return self.value


I, J = Index.I, Index.J  # noqa: E741

ShapeIndex = int | Index
"""The number of a shape, counted from 1, or a generic index."""

DOTS = ("", "dot", "ddot")
"""The suffixes of names for the time derivatives 0, 1 and 2."""


class Kind(Enum):
    """The kind of a family of quantities, which determines how its names are printed."""

    MOTION = "coordinates, velocities and accelerations"
    INTEGRAL = "integrals over the undeformed body, stiffness and damping"
    MOMENT = "moments of the deformed body, and sums over the shapes"
    ROTATION = "entries of the rotation tensor, and products of angular velocities"
    VECTOR = "gravity and forces"
    POINT = "constants of a material point"
    MOVING_POINT = "the position of a material point in the body frame, or turned to the inertial frame"
    TREE = "quantities of trees of bodies"
    CHOSEN = "quantities whose names the specification chooses"
    INPUT = "run-time inputs and their time derivatives"
    LOCAL = "intermediate results of a lowering"


class Family(Enum):
    """The families of quantities that the derivation knows: `stem`, what their names begin with, and their `kind`."""

    def __init__(self, stem: str, kind: Kind) -> None:
        self.stem, self.kind = stem, kind

    __hash__ = object.__hash__  # members are equal only to themselves; that of Enum hashes the name each time

    TRANSLATION = "c", Kind.MOTION
    ANGLE = "phi", Kind.MOTION
    QUATERNION = "e", Kind.MOTION
    ANGULAR_VELOCITY = "omega", Kind.MOTION
    VIRTUAL_ROTATION = "pi", Kind.MOTION
    AMPLITUDE = "alpha", Kind.MOTION
    GUIDE = "s", Kind.MOTION
    MASS = "mass", Kind.INTEGRAL
    C1 = "c1", Kind.INTEGRAL
    C2 = "c2", Kind.INTEGRAL
    C3 = "C3", Kind.INTEGRAL
    C4 = "C4", Kind.INTEGRAL
    C5 = "C5", Kind.INTEGRAL
    C6 = "c6", Kind.INTEGRAL
    C7 = "c7", Kind.INTEGRAL
    C8 = "c8", Kind.INTEGRAL
    C9 = "c9", Kind.INTEGRAL
    C10 = "c10", Kind.INTEGRAL
    FIELD_WEIGHT = "z", Kind.INTEGRAL
    STIFFNESS = "K", Kind.INTEGRAL
    CUBIC_STIFFNESS = "K3", Kind.INTEGRAL
    PRELOAD = "N", Kind.INTEGRAL
    DAMPING = "B", Kind.INTEGRAL
    ROTARY = "R", Kind.INTEGRAL
    D1 = "d1", Kind.MOMENT
    D2 = "D2", Kind.MOMENT
    D3 = "d3", Kind.MOMENT
    D4 = "d4", Kind.MOMENT
    FIELD_AMPLITUDE = "beta", Kind.MOMENT
    FIELD_TANGENT = "dbeta", Kind.MOMENT
    C9_SUM = "c9", Kind.MOMENT
    C10_SUM = "c10", Kind.MOMENT
    C7_AMPLITUDES = "c7a", Kind.MOMENT
    C10_AMPLITUDES = "c10a", Kind.MOMENT
    C9_RATES = "c9dotdot", Kind.MOMENT
    C10_RATES = "c10dotdot", Kind.MOMENT
    S = "S", Kind.MOMENT
    INERTIA = "J", Kind.MOMENT
    C5_SUM = "C5", Kind.MOMENT
    C7_SUM = "c7", Kind.MOMENT
    C8_SUM = "c8", Kind.MOMENT
    RATE_PRODUCT = "c8dotdot", Kind.MOMENT
    ELASTIC = "elastic", Kind.MOMENT
    DAMPING_FORCE = "damping", Kind.MOMENT
    ROTARY_MOMENT = "rotary", Kind.MOMENT
    ROTARY_PRODUCT = "rotarydotdot", Kind.MOMENT
    STRAIN = "strain", Kind.MOMENT
    PRELOAD_WORK = "at_rest", Kind.MOMENT
    COSINE = "cos_phi", Kind.ROTATION
    SINE = "sin_phi", Kind.ROTATION
    ROTATION_TENSOR = "Q", Kind.ROTATION
    OMEGA_PRODUCT = "oo", Kind.ROTATION
    GRAVITY = "g", Kind.VECTOR
    BODY_GRAVITY = "gb", Kind.VECTOR
    FORCE = "F", Kind.VECTOR
    BODY_FORCE = "Fb", Kind.VECTOR
    POINT_POSITION = "X", Kind.POINT
    POINT_SHAPE = "Phi", Kind.POINT
    SECTION_ROTATION = "turn", Kind.POINT
    POINT_SECOND = "Psi", Kind.POINT
    RADIUS = "r", Kind.MOVING_POINT
    LEVER = "s", Kind.MOVING_POINT
    TANGENT = "dr", Kind.MOVING_POINT
    INERTIAL_OMEGA = "w", Kind.MOVING_POINT
    FRAME_AXES = "A", Kind.MOVING_POINT
    SECTION_VECTOR = "theta", Kind.MOVING_POINT
    SECTION_TANGENT = "dtheta", Kind.MOVING_POINT
    SECTION_SCALE = "scale", Kind.MOVING_POINT
    SECTION_SPIN = "nu", Kind.MOVING_POINT
    SECTION_VELOCITY = "vrel", Kind.MOVING_POINT
    COLUMN = "T", Kind.TREE
    JOINT_AXIS = "axis", Kind.TREE
    OFFSET = "r", Kind.TREE
    BIAS = "a", Kind.TREE
    ANGULAR_BIAS = "alphabias", Kind.TREE
    FIRST_MOMENT = "ms", Kind.TREE
    TURNED_INERTIA = "Jw", Kind.TREE
    COMPOSITE_MASS = "m_behind", Kind.TREE
    COMPOSITE_MOMENT = "ms_behind", Kind.TREE
    COMPOSITE_INERTIA = "J_behind", Kind.TREE
    UNIT_MOMENTUM = "p", Kind.TREE
    UNIT_SPIN = "L", Kind.TREE
    INERTIAL_FORCE = "f", Kind.TREE
    INERTIAL_TORQUE = "n", Kind.TREE
    FORCE_BEHIND = "f_behind", Kind.TREE
    TORQUE_BEHIND = "n_behind", Kind.TREE
    PARAMETER = "parameter", Kind.CHOSEN
    ELEMENT = "element", Kind.CHOSEN
    TIME = "t", Kind.CHOSEN
    INPUT = "u", Kind.INPUT
    LOCAL = "local", Kind.LOCAL


@dataclass(frozen=True)
class Identity:
    """The meaning of a symbol.

    `shapes` are the shapes it is counted by, `components` its axes (from 1; the scalar of a quaternion is 0),
    `derivative` the number of time derivatives. `owner` is the body or element of a mechanism, `point` a material
    point, `label` the text that a specification or a lowering chose. A `parameter` is the value of the same quantity
    at run time, where the quantity itself is a constant computed from it.
    """

    family: Family
    shapes: tuple[ShapeIndex, ...] = ()
    components: tuple[int, ...] = ()
    derivative: int = 0
    owner: str = ""
    point: str = ""
    label: str = ""
    parameter: bool = False

    @cached_property
    def name(self) -> str:
        """The printed name."""
        return identifier(self.owner, *self._parts) + ("_" if self.parameter else "")

    @property
    def shown(self) -> str:
        """The name for people, in which the index of an instance is in brackets."""
        return joined(self.owner, *self._parts)

    @property
    def _parts(self) -> list[str]:
        """The parts of the name after that of the owner."""
        shapes = [str(s) for s in self.shapes]
        components = "".join([str(c) for c in self.components])
        stem = self.family.stem + DOTS[self.derivative]
        parts = [self.point, stem, *shapes, components]
        match self.family.kind:
            case Kind.INTEGRAL | Kind.MOMENT:  # first, since most symbols are entries of tables
                pass
            case Kind.MOTION if not self.indexed:
                number = "".join(shapes) + components
                parts = [f"{self.family.stem}{number}{DOTS[self.derivative]}"]
            case Kind.POINT if self.point.isdigit():
                parts = [f"{stem}{self.point}", *shapes, components]
            case Kind.POINT:
                parts = [stem, self.point, *shapes, components]
            case Kind.INPUT:
                parts = [self.family.stem, rate_name(self.label, DOTS[self.derivative])]
            case Kind.CHOSEN | Kind.LOCAL:
                parts = [self.label, *shapes, components]
        return parts

    @property
    def indexed(self) -> bool:
        """Whether the quantity has a generic index, so that it exists once for each shape."""
        return any(isinstance(s, Index) for s in self.shapes)

    @property
    def array(self) -> str:
        """The name of the array of the values of all shapes: S_i_11 is an element of S_11."""
        return replace(self, shapes=()).name if self.indexed else self.name

    @cached_property
    def order(self) -> tuple[str, tuple[int, ...], tuple[int, ...], str]:
        """The sort key of integrals: their family, then their indices as numbers, so that c8_2_1 is before c8_10_1."""
        whose = f"{self.owner}_{self.point}_{self.label}"
        return self.section, tuple([s for s in self.shapes if isinstance(s, int)]), self.components, whose

    @property
    def section(self) -> str:
        """The family with its time derivatives, under which generated code groups definitions."""
        return self.family.stem + DOTS[self.derivative]

    def of_shapes(self, shapes: tuple[ShapeIndex, ...]) -> Identity:
        """The identity of the same quantity for other shapes; `dataclasses.replace` is several times slower."""
        return Identity(
            self.family,
            shapes,
            self.components,
            self.derivative,
            self.owner,
            self.point,
            self.label,
            self.parameter,
        )

    @property
    def symbol(self) -> Symbol:
        """The symbol of this identity."""
        return _class()(self)

    def __lt__(self, other: Identity) -> bool:
        """Define an order for SymPy, which asks for it where two names are equal."""
        return repr(self) < repr(other)

    def __gt__(self, other: Identity) -> bool:
        """Define the reverse of `__lt__`."""
        return repr(self) > repr(other)


@cache
def _class() -> type[Symbol]:
    """The class of symbols, which loads SymPy."""
    from derive.mechanics.typed_symbol import Symbol

    return Symbol


def identity(symbol: sp.Basic) -> Identity:
    """The identity of a symbol. Raises TypeError for a symbol that has none."""
    if not isinstance(symbol, _class()):
        raise TypeError(f"{symbol} is no symbol of the derivation")
    known: Identity = symbol.identity
    return known


def is_indexed(symbol: sp.Basic) -> bool:
    """Whether a symbol has a generic index, so that it stands for one quantity for each shape."""
    return isinstance(symbol, _class()) and symbol.identity.indexed


def owned(symbol: sp.Basic, owner: str, point: str = "") -> Symbol:
    """The symbol of the same quantity of a body of a mechanism, or of one of its points."""
    known = identity(symbol)
    return replace(known, owner=owner, point=point or known.point).symbol


# ---- constructors, one for each layout ----


def quantity(family: Family, *components: int, derivative: int = 0, shapes: Iterable[ShapeIndex] = ()) -> Symbol:
    """The symbol of a quantity of a family with its components, shapes and time derivatives."""
    return Identity(family, tuple(shapes), components, derivative).symbol


def vector(family: Family, dimension: int, derivative: int = 0, shapes: Iterable[ShapeIndex] = ()) -> sp.Matrix:
    """The components of a vector quantity, from 1 to `dimension`, as a column."""
    shapes = tuple(shapes)
    axes = range(1, dimension + 1)
    return sp.Matrix([quantity(family, k, derivative=derivative, shapes=shapes) for k in axes])


def amplitude(shape: ShapeIndex, derivative: int = 0) -> Symbol:
    """The amplitude alpha of a shape, or its time derivative."""
    return quantity(Family.AMPLITUDE, derivative=derivative, shapes=(shape,))


def amplitude_of(owner: str, shape: int, derivative: int = 0) -> Identity:
    """The identity of an amplitude of a body of a mechanism."""
    return Identity(Family.AMPLITUDE, (shape,), derivative=derivative, owner=owner)


def pair(family: Family, i: int, j: int, *components: int) -> Symbol:
    """The entry (i, j) of a symmetric table, which has a name for i <= j alone."""
    return quantity(family, *components, shapes=sorted((i, j)))


def parameter(label: str, positive: bool = False) -> Symbol:
    """A run-time parameter under the name that the specification gives it."""
    return _class()(Identity(Family.PARAMETER, label=label), positive=positive or None)


def run_time_input(label: str, derivative: int = 0) -> Symbol:
    """A run-time input under the name that the specification gives it, or one of its time derivatives."""
    return Identity(Family.INPUT, derivative=derivative, label=label).symbol


def element(owner: str, label: str, *components: int) -> Symbol:
    """A quantity of a joint, a drive, a force or the ground: `spring_length`."""
    return Identity(Family.ELEMENT, components=components, owner=owner, label=label).symbol


def local(label: str, *components: int, shapes: Iterable[ShapeIndex] = ()) -> Symbol:
    """An intermediate result of a lowering."""
    return Identity(Family.LOCAL, tuple(shapes), components, label=label).symbol


def time() -> Symbol:
    """The time t."""
    return Identity(Family.TIME, label="t").symbol


def state_rate(symbol: sp.Basic) -> Symbol:
    """The time derivative of an element of a first-order state, where it is an unknown of its own: `phi_t`."""
    known = identity(symbol)
    if known.indexed:
        return Identity(Family.LOCAL, known.shapes, label=f"{known.array}_t").symbol
    return local(f"{known.name}_t")
