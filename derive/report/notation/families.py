"""The notation of the quantities of the derivation in formulas: a table from families to that of the paper.

Indices are the number of the integral, the shapes and the components, separated by commas. In a mechanism the body
stands above. A sum over the shapes that has a name of its own in the code, such as D2dot, is written as the product
that it is.
"""

from __future__ import annotations

from collections.abc import Callable

from derive.algebra import sp
from derive.mechanics.symbols import Family, Identity
from derive.mechanics.typed_symbol import Symbol
from derive.report.document.formula import Call, FormulaRow, Name, NumberToken, Power
from derive.report.notation.integral_symbols import (
    amplitudes,
    field_amplitude,
    field_tangent,
    field_weight,
    force_of_modes,
    integral,
    moment,
    preload,
    rate_product,
    rate_product_of,
    rates_twice,
    row_times_column,
    strain,
)
from derive.report.notation.typeset_names import (
    MOTION,
    Rank,
    TypesetSymbol,
    chosen,
    column,
    component_digits,
    index_text,
)


def written(symbol: sp.Symbol) -> TypesetSymbol:
    """The typeset form of a symbol. One without an identity is a letter that the report itself chose."""
    if not isinstance(symbol, Symbol):
        return TypesetSymbol(Rank.CONSTANT, chosen(symbol.name))
    known = symbol.identity
    above = (known.owner.replace("_", " "),) if known.owner else ()
    return WRITERS[known.family](known, above)


def _motion(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """A coordinate, its velocity or its acceleration; of an angular velocity the rank is one higher."""
    below = (*map(index_text, known.shapes), *map(str, known.components))
    rank = MOTION[known.derivative + (known.family is Family.ANGULAR_VELOCITY)]
    return TypesetSymbol(rank, Name(known.family.stem, dots=known.derivative, below=below, above=above))


def _mass(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    return TypesetSymbol(Rank.CONSTANT, Name("m", above=above))


def _sine(name: str) -> Callable[[Identity, tuple[str, ...]], TypesetSymbol]:
    return lambda known, above: TypesetSymbol(Rank.SINE, Call(name, Name("phi", above=above)))


def _rotation_tensor(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    return TypesetSymbol(Rank.ROTATION, Name("Q", below=(component_digits(known),), above=above))


def _omega_product(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    first, second = (Name("omega", below=(str(k),), above=above) for k in known.components)
    return TypesetSymbol(
        Rank.VELOCITY, Power(first, NumberToken("2")) if first == second else FormulaRow((first, second))
    )


def _vector(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """Gravity or a force in components of the inertial frame."""
    return TypesetSymbol(Rank.CONSTANT, Name(known.family.stem, below=(component_digits(known),), above=above))


IN_BODY = {Family.BODY_GRAVITY: Family.GRAVITY, Family.BODY_FORCE: Family.FORCE}
"""The families of the same vectors in components of the inertial frame."""


def _vector_in_body(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """Gravity or a force in components of the floating frame, with a b above."""
    letter = IN_BODY[known.family].stem
    return TypesetSymbol(Rank.ROTATION, Name(letter, below=(component_digits(known),), above=(*above, "b")))


def _of_point(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """A constant of a material point: the point, the shapes and the components below."""
    letter = "theta" if known.family is Family.SECTION_ROTATION else known.family.stem
    parts = (known.point.replace("_", " "), *map(index_text, known.shapes), component_digits(known))
    sign = "," if known.point.isdigit() else " "
    below = sign.join(part for part in parts if part)
    return TypesetSymbol(
        Rank.CONSTANT, Name(letter, dots=known.derivative, below=(below,) if below else (), above=above)
    )


def _moving_point(letter: str) -> Callable[[Identity, tuple[str, ...]], TypesetSymbol]:
    """The position or the motion of a material point or a frame, in the floating or the inertial frame, with the point
    above."""
    return lambda known, above: TypesetSymbol(Rank.MOMENT, _at_point(letter, known, component_digits(known)))


def _at_point(letter: str, known: Identity, below: str) -> Name:
    place = " ".join(part.replace("_", " ") for part in (known.owner, known.point) if part)
    return Name(letter, dots=known.derivative, below=(below,), above=(place,) if place else ())


def _tangent(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """The derivative of r by the amplitude of a shape at a point: r k, i with a comma, and the point above."""
    below = ",".join((component_digits(known), *map(index_text, known.shapes)))
    return TypesetSymbol(Rank.MOMENT, _at_point("r", known, below))


def _section_tangent(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """The derivative of the rotation vector of a section by the amplitude of a shape, with the point above."""
    below = ",".join((component_digits(known), *map(index_text, known.shapes)))
    return TypesetSymbol(Rank.MOMENT, _at_point("theta", known, below))


def _named(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """A parameter, or a quantity of a joint, a drive or the ground, under the name that it was given."""
    name = chosen(known.label) if known.label else Name("F")
    numbers = (*map(index_text, known.shapes), component_digits(known))
    below = " ".join(part for part in (*name.below, *numbers) if part)
    return TypesetSymbol(Rank.CONSTANT, Name(name.text, below=(below,) if below else (), above=above, style=name.style))


def _input(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """u of a run-time input, with its name below."""
    return TypesetSymbol(Rank.CONSTANT, Name("u", known.derivative, (known.label,), above))


TREE = {
    Family.COLUMN: "T",
    Family.JOINT_AXIS: "e",
    Family.OFFSET: "r",
    Family.BIAS: "a",
    Family.ANGULAR_BIAS: "psi",
    Family.FIRST_MOMENT: "h",
    Family.TURNED_INERTIA: "J",
    Family.COMPOSITE_MASS: "M",
    Family.COMPOSITE_MOMENT: "H",
    Family.COMPOSITE_INERTIA: "I",
    Family.UNIT_MOMENTUM: "p",
    Family.UNIT_SPIN: "L",
    Family.INERTIAL_FORCE: "f",
    Family.INERTIAL_TORQUE: "n",
    Family.FORCE_BEHIND: "F",
    Family.TORQUE_BEHIND: "N",
}
"""The letters of quantities of trees of bodies, in the inertial frame; the body and what they belong to stand above."""

WRITERS: dict[Family, Callable[[Identity, tuple[str, ...]], TypesetSymbol]] = {
    **dict.fromkeys((Family.TRANSLATION, Family.ANGLE, Family.QUATERNION, Family.ANGULAR_VELOCITY), _motion),
    **dict.fromkeys((Family.VIRTUAL_ROTATION, Family.AMPLITUDE, Family.GUIDE), _motion),
    Family.MASS: _mass,
    **dict.fromkeys((Family.C1, Family.C2, Family.C3, Family.C4, Family.C5, Family.C6), integral),
    **dict.fromkeys((Family.C7, Family.C8, Family.C9, Family.C10), integral),
    **dict.fromkeys((Family.STIFFNESS, Family.CUBIC_STIFFNESS, Family.DAMPING, Family.ROTARY), integral),
    Family.FIELD_WEIGHT: field_weight,
    **dict.fromkeys((Family.D1, Family.D2, Family.D3, Family.D4, Family.S, Family.INERTIA), moment),
    **dict.fromkeys((Family.C5_SUM, Family.C7_SUM, Family.C8_SUM, Family.C9_SUM, Family.C10_SUM), row_times_column),
    Family.FIELD_AMPLITUDE: field_amplitude,
    Family.FIELD_TANGENT: field_tangent,
    Family.RATE_PRODUCT: rate_product,
    Family.C7_AMPLITUDES: amplitudes("7"),
    Family.C10_AMPLITUDES: amplitudes("10"),
    Family.C9_RATES: rates_twice("9"),
    Family.C10_RATES: rates_twice("10"),
    Family.ELASTIC: force_of_modes("K", 0),
    Family.DAMPING_FORCE: force_of_modes("B", 1),
    Family.ROTARY_MOMENT: force_of_modes("R", 0),
    Family.ROTARY_PRODUCT: lambda known, above: rate_product_of(Name("R", above=above, style="tensor")),
    Family.STRAIN: strain,
    Family.PRELOAD: lambda known, above: TypesetSymbol(Rank.CONSTANT, preload(known, above)),
    Family.PRELOAD_WORK: lambda known, above: TypesetSymbol(
        Rank.MOMENT, FormulaRow((column(transposed=True), preload(known, above)))
    ),
    Family.COSINE: _sine("cos"),
    Family.SINE: _sine("sin"),
    Family.ROTATION_TENSOR: _rotation_tensor,
    Family.OMEGA_PRODUCT: _omega_product,
    **dict.fromkeys((Family.GRAVITY, Family.FORCE), _vector),
    **dict.fromkeys(IN_BODY, _vector_in_body),
    **dict.fromkeys((Family.POINT_POSITION, Family.POINT_SHAPE, Family.SECTION_ROTATION), _of_point),
    Family.POINT_SECOND: _of_point,
    Family.RADIUS: _moving_point("r"),
    Family.LEVER: _moving_point("s"),
    Family.INERTIAL_OMEGA: _moving_point("w"),
    Family.FRAME_AXES: _moving_point("A"),
    Family.SECTION_VECTOR: _moving_point("theta"),
    Family.SECTION_TANGENT: _section_tangent,
    Family.SECTION_SCALE: _moving_point("sigma"),
    Family.SECTION_SPIN: _moving_point("nu"),
    Family.SECTION_VELOCITY: _moving_point("v"),
    Family.TANGENT: _tangent,
    **{family: _moving_point(letter) for family, letter in TREE.items()},
    Family.INPUT: _input,
    Family.PARAMETER: _named,
    Family.ELEMENT: _named,
    Family.TIME: _named,
    Family.LOCAL: _named,
}
"""The functions that typeset the symbols of each family, from an identity and its superscript."""
