"""How the quantities of the derivation are written in formulas: a table from families to the notation of the paper.

Indices are the number of the integral, the shapes and the components, separated by commas. In a mechanism the body
stands above. A sum over the shapes that has a name of its own in the code, such as D2dot, is written as the product
that it is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from itertools import takewhile

import sympy as sp

from derive.mechanics.symbols import Family, Identity, Index, ShapeIndex, Symbol
from derive.report.document.formula import Call, Formula, FormulaRow, Name, NumberToken, Power


class Rank(IntEnum):
    """The order of the factors in a product."""

    CONSTANT = 0
    MOMENT = 1
    AMPLITUDE = 2
    VELOCITY = 3
    ACCELERATION = 4
    ROTATION = 5
    SINE = 6


@dataclass(frozen=True)
class TypesetSymbol:
    """A symbol in formulas: its place in products, and how it is written."""

    rank: Rank
    formula: Formula


MOTION = (Rank.AMPLITUDE, Rank.VELOCITY, Rank.ACCELERATION)
"""Ranks of coordinates by their time derivatives."""

TENSORS = {Family.C3, Family.C4, Family.C5, Family.C8, Family.D2, Family.S, Family.INERTIA}
TENSORS |= {Family.STIFFNESS, Family.DAMPING, Family.ROTARY}
"""Families whose whole tables are tensors or matrices; those of the others are vectors or columns."""


def written(symbol: sp.Symbol) -> TypesetSymbol:
    """How a symbol is written. One without an identity is a letter that the report itself chose."""
    if not isinstance(symbol, Symbol):
        return TypesetSymbol(Rank.CONSTANT, chosen(symbol.name))
    known = symbol.identity
    above = (known.owner.replace("_", " "),) if known.owner else ()
    return WRITERS[known.family](known, above)


def chosen(text: str) -> Name:
    """A name that the user of a specification chose: its letters, then digits and what follows them as an index.

    `EI` stays as it is, `l1` is l with the index 1, `m_rod` is m with the index rod. This is typography alone: no fact
    about a quantity is taken from such a name.
    """
    letters = "".join(takewhile(lambda c: c.isascii() and c.isalpha(), text))
    if not letters:
        return Name(text, style="word")
    rest = text[len(letters) :]
    digits = "".join(takewhile(str.isdigit, rest))
    words = rest[len(digits) :].removeprefix("_").replace("_", " ").strip()
    below = ",".join(part for part in (digits, words) if part)
    return Name(letters, below=(below,) if below else ())


def whole(family: Family) -> Name:
    """A whole integral or moment, without the indices of shapes and components: the vector c2, the tensor C4."""
    letter, number = _stem(family)
    return Name(letter, below=(number,) if number else (), style="tensor" if family in TENSORS else "vector")


def indexed(family: Family, *shapes: ShapeIndex) -> Name:
    """A whole integral or moment of some shapes, without the indices of its components: c2 i."""
    letter, number = _stem(family)
    below = " ".join(part for part in (number, *map(index_text, shapes)) if part)
    return Name(letter, below=(below,) if below else (), style="tensor" if family in TENSORS else "vector")


def index_text(shape: ShapeIndex) -> str:
    """A shape index as text: 1, 2, ... or i, j."""
    return shape.value if isinstance(shape, Index) else str(shape)


def column(dots: int = 0, transposed: bool = False) -> Name:
    """The column of the amplitudes, or of their derivatives."""
    return Name("alpha", dots=dots, above=("T",) if transposed else (), style="vector")


def _stem(family: Family) -> tuple[str, str]:
    """The letter and the number of an integral or a moment."""
    return family.stem[:1], family.stem[1:]


def _below(number: str, known: Identity) -> tuple[str, ...]:
    """The number of the integral, the shapes and the components, separated by commas."""
    shapes = [index_text(s) for s in known.shapes]
    close = " " if known.indexed else ""
    beside = close.join(shapes) if all(len(s) == 1 for s in shapes) else ",".join(shapes)
    text = ",".join(part for part in (number, beside, _components(known)) if part)
    return (text,) if text else ()


def _components(known: Identity) -> str:
    return "".join(map(str, known.components))


def _motion(letter: str) -> Callable[[Identity, tuple[str, ...]], TypesetSymbol]:
    """A coordinate, its velocity or its acceleration; of an angular velocity the rank is one higher."""

    def write(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
        below = (*map(index_text, known.shapes), *map(str, known.components))
        rank = MOTION[known.derivative + (known.family is Family.ANGULAR_VELOCITY)]
        return TypesetSymbol(rank, Name(letter, dots=known.derivative, below=below, above=above))

    return write


def _mass(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    return TypesetSymbol(Rank.CONSTANT, Name("m", above=above))


def _integral(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    letter, number = _stem(known.family)
    return TypesetSymbol(Rank.CONSTANT, Name(letter, below=_below(number, known), above=above))


SUMMED = {Family.D1: Family.C2, **{family: family for family in (Family.D2, Family.D3, Family.D4, Family.S)}}
"""What the time derivatives of moments sum over the shapes, with the velocities or accelerations of the amplitudes."""


def _moment(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """A moment; its derivatives, which are sums over the shapes, as products with the column of alpha."""
    letter, number = _stem(known.family)
    single = known.family is Family.D1 and known.derivative == 1
    if not known.derivative or single:
        below = _below(number, known)
        return TypesetSymbol(Rank.MOMENT, Name(letter, dots=known.derivative, below=below, above=above))
    letter, number = _stem(SUMMED[known.family])
    moment = Name(letter, below=_below(number, known), above=above)
    return TypesetSymbol(Rank.MOMENT, FormulaRow((column(known.derivative, transposed=True), moment)))


def _row_times_column(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """c7dot_i and c8ddot_i: row i of a table times the velocities, or the accelerations."""
    _, number = _stem(known.family)
    parts = (number, *map(index_text, known.shapes), _components(known))
    below = ",".join(part for part in parts if part)
    table = Name(known.family.stem[:1], below=(below,), above=above)
    return TypesetSymbol(Rank.MOMENT, FormulaRow((table, column(known.derivative))))


def _rate_product(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    return _rate_product_of(Name("c", below=("8",), above=above, style="tensor"))


def _rate_product_of(matrix: Name) -> TypesetSymbol:
    """The quadratic form of a matrix of the velocities of the amplitudes."""
    return TypesetSymbol(Rank.MOMENT, FormulaRow((column(1, transposed=True), matrix, column(1))))


def _amplitudes(number: str) -> Callable[[Identity, tuple[str, ...]], TypesetSymbol]:
    """A component of a row of c7 or c10 times the column of the amplitudes."""

    def write(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
        parts = (number, *map(index_text, known.shapes), _components(known))
        table = Name("c", below=(",".join(part for part in parts if part),), above=above)
        return TypesetSymbol(Rank.MOMENT, FormulaRow((table, column())))

    return write


def _rates_twice(number: str) -> Callable[[Identity, tuple[str, ...]], TypesetSymbol]:
    """A component of c9 or c10 between the column of the velocities and itself."""

    def write(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
        table = Name("c", below=(f"{number},{_components(known)}",), above=above, style="tensor")
        return TypesetSymbol(Rank.MOMENT, FormulaRow((column(1, transposed=True), table, column(1))))

    return write


def _force_of_modes(letter: str, dots: int) -> Callable[[Identity, tuple[str, ...]], TypesetSymbol]:
    """Row i of the stiffness, the damping or the rotary inertia, times the amplitudes or their derivatives."""

    def write(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
        table = Name(letter, below=tuple(map(index_text, known.shapes)), above=above)
        return TypesetSymbol(Rank.MOMENT, FormulaRow((table, column(known.derivative or dots))))

    return write


def _strain(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    return TypesetSymbol(Rank.MOMENT, FormulaRow((column(transposed=True), whole(Family.STIFFNESS), column())))


def _preload(known: Identity, above: tuple[str, ...]) -> Name:
    """The column of the forces at rest, or an entry of it."""
    return Name("N", below=(",".join(map(index_text, known.shapes)),) if known.shapes else (), above=above)


def _sine(name: str) -> Callable[[Identity, tuple[str, ...]], TypesetSymbol]:
    return lambda known, above: TypesetSymbol(Rank.SINE, Call(name, Name("phi", above=above)))


def _rotation_tensor(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    return TypesetSymbol(Rank.ROTATION, Name("Q", below=(_components(known),), above=above))


def _omega_product(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    first, second = (Name("omega", below=(str(k),), above=above) for k in known.components)
    return TypesetSymbol(
        Rank.VELOCITY, Power(first, NumberToken("2")) if first == second else FormulaRow((first, second))
    )


def _vector(letter: str, in_body: bool) -> Callable[[Identity, tuple[str, ...]], TypesetSymbol]:
    """Gravity or a force, in components of the inertial frame, or of the floating frame, with a b above."""
    rank = Rank.ROTATION if in_body else Rank.CONSTANT
    frame = ("b",) if in_body else ()
    return lambda known, above: TypesetSymbol(rank, Name(letter, below=(_components(known),), above=(*above, *frame)))


def _of_point(letter: str) -> Callable[[Identity, tuple[str, ...]], TypesetSymbol]:
    """A constant of a material point: the point, the shapes and the components below."""

    def write(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
        parts = (known.point.replace("_", " "), *map(index_text, known.shapes), _components(known))
        sign = "," if known.point.isdigit() else " "
        below = sign.join(part for part in parts if part)
        return TypesetSymbol(
            Rank.CONSTANT, Name(letter, dots=known.derivative, below=(below,) if below else (), above=above)
        )

    return write


def _moving_point(letter: str) -> Callable[[Identity, tuple[str, ...]], TypesetSymbol]:
    """The position of a material point in the floating frame, or in inertial directions, with the point above."""

    def write(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
        place = " ".join(part.replace("_", " ") for part in (known.owner, known.point) if part)
        name = Name(letter, dots=known.derivative, below=(_components(known),), above=(place,) if place else ())
        return TypesetSymbol(Rank.MOMENT, name)

    return write


def _field_weight(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """z of a field and two shapes: z p i j."""
    return TypesetSymbol(Rank.CONSTANT, Name("z", below=(",".join(map(index_text, known.shapes)),), above=above))


def _field_amplitude(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """beta of a field, or its time derivative."""
    below = tuple(map(index_text, known.shapes))
    return TypesetSymbol(Rank.MOMENT, Name("beta", dots=known.derivative, below=below, above=above))


def _field_tangent(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """The derivative of beta of a field by the amplitude of a shape: beta p, i with a comma."""
    return TypesetSymbol(Rank.MOMENT, Name("beta", below=(",".join(map(index_text, known.shapes)),), above=above))


def _tangent(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """The derivative of r by the amplitude of a shape at a point: r k, i with a comma, and the point above."""
    place = " ".join(part.replace("_", " ") for part in (known.owner, known.point) if part)
    below = ",".join((_components(known), *map(index_text, known.shapes)))
    return TypesetSymbol(Rank.MOMENT, Name("r", below=(below,), above=(place,) if place else ()))


def _named(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """A parameter, or a quantity of a joint, a drive or the ground, under the name that it was given."""
    name = chosen(known.label) if known.label else Name("F")
    numbers = (*map(index_text, known.shapes), _components(known))
    below = " ".join(part for part in (*name.below, *numbers) if part)
    return TypesetSymbol(Rank.CONSTANT, Name(name.text, below=(below,) if below else (), above=above, style=name.style))


def _input(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """u of a run-time input, with its name below."""
    return TypesetSymbol(Rank.CONSTANT, Name("u", known.derivative, (known.label,), above))


WRITERS: dict[Family, Callable[[Identity, tuple[str, ...]], TypesetSymbol]] = {
    Family.TRANSLATION: _motion("c"),
    Family.ANGLE: _motion("phi"),
    Family.QUATERNION: _motion("e"),
    Family.ANGULAR_VELOCITY: _motion("omega"),
    Family.VIRTUAL_ROTATION: _motion("pi"),
    Family.AMPLITUDE: _motion("alpha"),
    Family.GUIDE: _motion("s"),
    Family.MASS: _mass,
    **dict.fromkeys((Family.C1, Family.C2, Family.C3, Family.C4, Family.C5, Family.C6), _integral),
    **dict.fromkeys((Family.C7, Family.C8, Family.C9, Family.C10), _integral),
    **dict.fromkeys((Family.STIFFNESS, Family.DAMPING, Family.ROTARY), _integral),
    Family.FIELD_WEIGHT: _field_weight,
    **dict.fromkeys((Family.D1, Family.D2, Family.D3, Family.D4, Family.S, Family.INERTIA), _moment),
    **dict.fromkeys((Family.C5_SUM, Family.C7_SUM, Family.C8_SUM, Family.C9_SUM, Family.C10_SUM), _row_times_column),
    Family.FIELD_AMPLITUDE: _field_amplitude,
    Family.FIELD_TANGENT: _field_tangent,
    Family.RATE_PRODUCT: _rate_product,
    Family.C7_AMPLITUDES: _amplitudes("7"),
    Family.C10_AMPLITUDES: _amplitudes("10"),
    Family.C9_RATES: _rates_twice("9"),
    Family.C10_RATES: _rates_twice("10"),
    Family.ELASTIC: _force_of_modes("K", 0),
    Family.DAMPING_FORCE: _force_of_modes("B", 1),
    Family.ROTARY_MOMENT: _force_of_modes("R", 0),
    Family.ROTARY_PRODUCT: lambda known, above: _rate_product_of(Name("R", above=above, style="tensor")),
    Family.STRAIN: _strain,
    Family.PRELOAD: lambda known, above: TypesetSymbol(Rank.CONSTANT, _preload(known, above)),
    Family.PRELOAD_WORK: lambda known, above: TypesetSymbol(
        Rank.MOMENT, FormulaRow((column(transposed=True), _preload(known, above)))
    ),
    Family.COSINE: _sine("cos"),
    Family.SINE: _sine("sin"),
    Family.ROTATION_TENSOR: _rotation_tensor,
    Family.OMEGA_PRODUCT: _omega_product,
    Family.GRAVITY: _vector("g", in_body=False),
    Family.BODY_GRAVITY: _vector("g", in_body=True),
    Family.FORCE: _vector("F", in_body=False),
    Family.BODY_FORCE: _vector("F", in_body=True),
    Family.POINT_POSITION: _of_point("X"),
    Family.POINT_SHAPE: _of_point("Phi"),
    Family.SECTION_ROTATION: _of_point("theta"),
    Family.POINT_SECOND: _of_point("Psi"),
    Family.RADIUS: _moving_point("r"),
    Family.LEVER: _moving_point("s"),
    Family.TANGENT: _tangent,
    Family.INPUT: _input,
    Family.PARAMETER: _named,
    Family.ELEMENT: _named,
    Family.TIME: _named,
    Family.LOCAL: _named,
}
"""How the symbols of each family are written: from an identity and its superscript to the formula."""
