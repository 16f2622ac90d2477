"""The typeset forms of shape integrals, moments and their products, from an identity and its superscript."""

from __future__ import annotations

from collections.abc import Callable

from derive.mechanics.symbols import Family, Identity
from derive.report.document.formula import FormulaRow, Name
from derive.report.notation.typeset_names import (
    Rank,
    TypesetSymbol,
    column,
    component_digits,
    index_text,
    stem,
    subscript,
    whole,
)


def integral(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """A shape integral, a stiffness or a damping."""
    letter, number = stem(known.family)
    return TypesetSymbol(Rank.CONSTANT, Name(letter, below=subscript(number, known), above=above))


SUMMED = {Family.D1: Family.C2, **{family: family for family in (Family.D2, Family.D3, Family.D4, Family.S)}}
"""The families that the time derivatives of moments sum over the shapes, times derivatives of the amplitudes."""


def moment(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """A moment; its derivatives, which are sums over the shapes, as products with the column of alpha."""
    single = known.family is Family.D1 and known.derivative == 1
    if not known.derivative or single:
        return TypesetSymbol(Rank.MOMENT, dotted(known, above))
    letter, number = stem(SUMMED[known.family])
    moment = Name(letter, below=subscript(number, known), above=above)
    return TypesetSymbol(Rank.MOMENT, FormulaRow((column(known.derivative, transposed=True), moment)))


def dotted(known: Identity, above: tuple[str, ...] = ()) -> Name:
    """A moment with a dot for each time derivative."""
    letter, number = stem(known.family)
    return Name(letter, dots=known.derivative, below=subscript(number, known), above=above)


def row_times_column(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """c7dot_i and c8ddot_i: row i of a table times the velocities, or the accelerations."""
    _, number = stem(known.family)
    parts = (number, *map(index_text, known.shapes), component_digits(known))
    below = ",".join(part for part in parts if part)
    table = Name(known.family.stem[:1], below=(below,), above=above)
    return TypesetSymbol(Rank.MOMENT, FormulaRow((table, column(known.derivative))))


def rate_product(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """The symbol of the product alphadot c8 alphadot."""
    return rate_product_of(Name("c", below=("8",), above=above, style="tensor"))


def rate_product_of(matrix: Name) -> TypesetSymbol:
    """The quadratic form of a matrix of the velocities of the amplitudes."""
    return TypesetSymbol(Rank.MOMENT, FormulaRow((column(1, transposed=True), matrix, column(1))))


def amplitudes(number: str) -> Callable[[Identity, tuple[str, ...]], TypesetSymbol]:
    """A component of a row of c7 or c10 times the column of the amplitudes."""

    def write(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
        parts = (number, *map(index_text, known.shapes), component_digits(known))
        table = Name("c", below=(",".join(part for part in parts if part),), above=above)
        return TypesetSymbol(Rank.MOMENT, FormulaRow((table, column())))

    return write


def rates_twice(number: str) -> Callable[[Identity, tuple[str, ...]], TypesetSymbol]:
    """A component of c9 or c10 between the column of the velocities and itself."""

    def write(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
        table = Name("c", below=(f"{number},{component_digits(known)}",), above=above, style="tensor")
        return TypesetSymbol(Rank.MOMENT, FormulaRow((column(1, transposed=True), table, column(1))))

    return write


def force_of_modes(letter: str, dots: int) -> Callable[[Identity, tuple[str, ...]], TypesetSymbol]:
    """Row i of the stiffness, the damping or the rotary inertia, times the amplitudes or their derivatives."""

    def write(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
        table = Name(letter, below=tuple(map(index_text, known.shapes)), above=above)
        return TypesetSymbol(Rank.MOMENT, FormulaRow((table, column(known.derivative or dots))))

    return write


def strain(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """Twice the strain energy."""
    return TypesetSymbol(Rank.MOMENT, FormulaRow((column(transposed=True), whole(Family.STIFFNESS), column())))


def preload(known: Identity, above: tuple[str, ...]) -> Name:
    """The column of the forces at rest, or an entry of it."""
    return Name("N", below=(",".join(map(index_text, known.shapes)),) if known.shapes else (), above=above)


WITHOUT_ACCELERATIONS = 2
"""The derivative of the amplitude of a field whose part without accelerations is a symbol."""


def field_weight(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """z of a field and two shapes: z p i j."""
    return TypesetSymbol(Rank.CONSTANT, Name("z", below=(",".join(map(index_text, known.shapes)),), above=above))


def field_amplitude(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """beta of a field, or its time derivative; of the second one the part without accelerations, which has a 0."""
    below, without = tuple(map(index_text, known.shapes)), ("0",) if known.derivative == WITHOUT_ACCELERATIONS else ()
    return TypesetSymbol(Rank.MOMENT, Name("beta", dots=known.derivative, below=below, above=(*without, *above)))


def field_tangent(known: Identity, above: tuple[str, ...]) -> TypesetSymbol:
    """The derivative of beta of a field by the amplitude of a shape: beta p, i with a comma."""
    return TypesetSymbol(Rank.MOMENT, Name("beta", below=(",".join(map(index_text, known.shapes)),), above=above))
