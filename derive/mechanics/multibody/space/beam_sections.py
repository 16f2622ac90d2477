"""The cross-section of a beam in space at a marker: its point on the axis and its rotation, to their order."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING, TypeAlias

from derive.algebra import sp
from derive.mechanics.bodies.beam_functions import BeamFunction, rational
from derive.mechanics.bodies.section_fields import SectionShape, second_rotation, section_shapes, shortening_of
from derive.mechanics.bodies.spatial_beam import length_of
from derive.mechanics.motion.material_points import MaterialPoint
from derive.mechanics.motion.rotations import matrix_of
from derive.mechanics.multibody.bodies.body_type import CrossSection
from derive.mechanics.symbols import Family, Identity
from derive.mechanics.tables import AXES
from derive.mechanics.terms import ModelConstant
from derive.roles import Source
from derive.spec.model.body import DisplacementOrder

if TYPE_CHECKING:
    from derive.spec.model.spatial_beam import SectionFrame, SpatialBeam

Vectors: TypeAlias = "dict[tuple[int, ...], dict[int, sp.Expr]]"
"""Vectors by the numbers of modes, with their components by axes."""


def section_at(marker: SectionFrame, beam: SpatialBeam) -> CrossSection:
    """The cross-section at a marker. Raises ConditionError when the ansatz does not fit the frame."""
    shapes, length, at = section_shapes(beam), length_of(beam), marker.at
    pairs: list[tuple[int, int]] = []
    if beam.order is not DisplacementOrder.FIRST_ORDER:
        pairs += combinations_with_replacement(range(1, len(shapes) + 1), 2)
    first: Vectors = {(i,): _at(shape.rotation, at, 2 / length) for i, shape in enumerate(shapes, 1)}
    of_pairs = {(i, j): (shapes[i - 1], shapes[j - 1]) for i, j in pairs}
    second: Vectors = {}
    shortened: Vectors = {}
    for pair, both in of_pairs.items():
        second[pair] = _at(second_rotation(*both, beam.frame), at, (2 / length) ** 2)
        shortened[pair] = _at({1: shortening_of(*both, beam.frame)}, at, 2 / length)
    rotation = f"rotation of the section at marker {marker.name}"
    turns = tuple(_constants(Family.SECTION_ROTATION, first, marker.name, rotation, "1/m", "(21)"))
    turns += tuple(_constants(Family.SECTION_ROTATION, second, marker.name, rotation, "1/m^2", Source.SECOND_ORDER))
    along = f"displacement along the axis at marker {marker.name}"
    seconds = tuple(_constants(Family.POINT_SECOND, shortened, marker.name, along, "1/m", Source.SECOND_ORDER))
    position = Identity(Family.POINT_POSITION, components=(1,), point=marker.name).symbol
    zero = None if at else "the choice of the origin (the marker is there)"
    doc = f"reference position of marker {marker.name}"
    reference = ModelConstant(position, sp.Rational(at) * length / 2, "(24)", doc, "m", zero)
    point = MaterialPoint(
        name=marker.name,
        doc=f"material point at xi = {at}",
        position=sp.ImmutableMatrix([position if at else 0, 0, 0]),  # no name of what vanishes enters levers
        shapes=tuple(_displacement(shape, at) for shape in shapes),
        coefficients=(reference, *seconds),
        second=_square(seconds, pairs, len(shapes)),
    )
    twists = _vectors(turns)
    none = sp.ImmutableMatrix([0, 0, 0])
    return CrossSection(
        point,
        turns,
        matrix_of(marker.rotation),
        tuple(twists.get((i,), none) for i in range(1, len(shapes) + 1)),
        _square(turns, pairs, len(shapes)),
    )


def _at(functions: Mapping[int, BeamFunction], at: Fraction, unit: sp.Expr) -> dict[int, sp.Expr]:
    """The values of functions of xi at a position, in a unit, by axes; those that vanish are left out."""
    values = {axis: unit * rational(of.at(at)) for axis, of in functions.items()}
    return {axis: value for axis, value in values.items() if value != 0}


def _displacement(shape: SectionShape, at: Fraction) -> sp.ImmutableMatrix:
    """The displacement of the axis by a unit amplitude."""
    of = shape.displacement
    return sp.ImmutableMatrix([rational(of[k].at(at)) if k in of else 0 for k in AXES])


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
