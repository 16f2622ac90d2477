"""The cross-section of a beam in space at a marker: its point on the axis and its rotation, to their order."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING, TypeAlias

from derive.algebra import sp
from derive.mechanics.axes import AXES
from derive.mechanics.bodies.beam_functions import XI, BeamFunction, rational
from derive.mechanics.bodies.section_fields import SectionShape, second_rotation, section_shapes, shortening_of
from derive.mechanics.bodies.section_inertia import length_of
from derive.mechanics.motion.material_points import MaterialPoint
from derive.mechanics.motion.rotations import matrix_of
from derive.mechanics.multibody.bodies.body_type import CrossSection
from derive.mechanics.symbols import Family, Identity
from derive.mechanics.terms import ModelConstant
from derive.roles import Source
from derive.spec.model.body import DisplacementOrder

if TYPE_CHECKING:
    from derive.spec.model.spatial_beam import SpatialBeam
    from derive.spec.model.spatial_beam_parts import SectionFrame

Value: TypeAlias = "Callable[[BeamFunction], sp.Rational]"
"""The value of a function of xi at a section, or its mean over some part of the beam."""
Vectors: TypeAlias = "dict[tuple[int, ...], dict[int, sp.Expr]]"
"""Vectors by the numbers of modes, with their components by axes."""


def section_at(marker: SectionFrame, beam: SpatialBeam) -> CrossSection:
    """The cross-section at a marker. Raises ConditionError when the ansatz does not fit the frame."""
    shapes, length, pairs = section_shapes(beam), length_of(beam), _pairs(beam)
    value = value_at(marker.at)
    first: Vectors = {(i,): _values(shape.rotation, value, 2 / length) for i, shape in enumerate(shapes, 1)}
    second: Vectors = {
        (i, j): _values(second_rotation(shapes[i - 1], shapes[j - 1], beam.frame), value, (2 / length) ** 2)
        for i, j in pairs
    }
    rotation = f"rotation of the section at marker {marker.name}"
    turns = tuple(_constants(Family.SECTION_ROTATION, first, marker.name, rotation, "1/m", "(21)"))
    turns += tuple(_constants(Family.SECTION_ROTATION, second, marker.name, rotation, "1/m^2", Source.SECOND_ORDER))
    docs = (f"material point at xi = {marker.at}", f"reference position of marker {marker.name}")
    twists = _vectors(turns)
    none = sp.ImmutableMatrix([0, 0, 0])
    return CrossSection(
        _point(marker.name, docs, beam, value, "the choice of the origin (the marker is there)"),
        turns,
        matrix_of(marker.rotation),
        tuple(twists.get((i,), none) for i in range(1, len(shapes) + 1)),
        _square(turns, pairs, len(shapes)),
    )


def mean_section(name: str, docs: tuple[str, str], beam: SpatialBeam, mean: Value) -> CrossSection:
    """A point that moves as the mean over a load does, in a frame that turns with the floating frame.

    docs: the descriptions of the point and of its position; mean: the mean of a function of xi.
    """
    point = _point(name, docs, beam, mean, "the load is symmetric")
    return CrossSection(point, twists=(sp.ImmutableMatrix([0, 0, 0]),) * len(point.shapes))


def value_at(at: Fraction) -> Value:
    """The function that evaluates functions of xi at a position."""
    return lambda of: rational(of.at(at))


def _point(name: str, docs: tuple[str, str], beam: SpatialBeam, value: Value, zero: str) -> MaterialPoint:
    """A point that moves as the axis does at a position, or in the mean; zero: why its position may vanish."""
    shapes, length, pairs = section_shapes(beam), length_of(beam), _pairs(beam)
    shortened: Vectors = {
        (i, j): _values({1: shortening_of(shapes[i - 1], shapes[j - 1], beam.frame)}, value, 2 / length)
        for i, j in pairs
    }
    along = f"displacement along the axis at marker {name}"
    seconds = tuple(_constants(Family.POINT_SECOND, shortened, name, along, "1/m", Source.SECOND_ORDER))
    position, at = Identity(Family.POINT_POSITION, components=(1,), point=name).symbol, value(XI)
    reference = ModelConstant(position, at * length / 2, "(24)", docs[1], "m", None if at else zero)
    return MaterialPoint(
        name=name,
        doc=docs[0],
        position=sp.ImmutableMatrix([position if at else 0, 0, 0]),  # no name of what vanishes enters levers
        shapes=tuple(_displacement(shape, value) for shape in shapes),
        coefficients=(reference, *seconds),
        second=_square(seconds, pairs, len(shapes)),
    )


def _pairs(beam: SpatialBeam) -> list[tuple[int, int]]:
    """The pairs of modes, i <= j, that displace sections at second order; none at first order."""
    if beam.order is DisplacementOrder.FIRST_ORDER:
        return []
    return [*combinations_with_replacement(range(1, len(section_shapes(beam)) + 1), 2)]


def _values(functions: Mapping[int, BeamFunction], value: Value, unit: sp.Expr) -> dict[int, sp.Expr]:
    """The values of functions of xi, in a unit, by axes; those that vanish are left out."""
    values = {axis: unit * value(of) for axis, of in functions.items()}
    return {axis: of for axis, of in values.items() if of != 0}


def _displacement(shape: SectionShape, value: Value) -> sp.ImmutableMatrix:
    """The displacement of the axis by a unit amplitude."""
    of = shape.displacement
    return sp.ImmutableMatrix([value(of[k]) if k in of else 0 for k in AXES])


def _constants(
    family: Family, vectors: Vectors, point: str, doc: str, unit: str, source: str
) -> Iterator[ModelConstant]:
    """A constant for each component of vectors that does not vanish."""
    for numbers, vector in vectors.items():
        modes = " and ".join(map(str, numbers))
        for k, value in vector.items():
            symbol = Identity(family, numbers, (k,), point=point).symbol
            yield ModelConstant(symbol, value, source, f"{doc} by mode{'s' * (len(numbers) - 1)} {modes}, e{k}", unit)


def _vectors(constants: tuple[ModelConstant, ...]) -> dict[tuple[int, ...], sp.ImmutableMatrix]:
    """The vectors whose components are constants, by the numbers of modes."""
    components: dict[tuple[int, ...], list[sp.Expr]] = {}
    for c in constants:
        of = c.symbol.identity
        components.setdefault(of.shapes, [sp.S.Zero] * 3)[of.components[0] - 1] = c.symbol
    return {numbers: sp.ImmutableMatrix(vector) for numbers, vector in components.items()}


def _square(
    constants: tuple[ModelConstant, ...], pairs: list[tuple[int, int]], n: int
) -> tuple[tuple[sp.ImmutableMatrix, ...], ...]:
    """The vectors of pairs of modes as a square; empty where there are none."""
    vectors, none = _vectors(constants), sp.ImmutableMatrix([0, 0, 0])
    if not any(pair in vectors for pair in pairs):
        return ()
    numbers = range(1, n + 1)
    return tuple(tuple(vectors.get((min(i, j), max(i, j)), none) for j in numbers) for i in numbers)
