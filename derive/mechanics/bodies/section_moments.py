"""The shape integrals of a beam in space: second moments of its fields over the length and over the cross-section.

A section has the mass m/l dx, its centre of mass is at p = (0, e_y, e_z), and its moment of inertia about e1 through
the centre is J/l dx; about the other axes it has none, since the rotary inertia of bending is left out. Such a section
has int p p^T = m diag(-J, J, J)/(2 m) + m e e^T, whose first entry is negative: no body of points has this inertia, but
all integrals depend on int p p^T alone. They contain how the inertia J turns with the sections.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import combinations, combinations_with_replacement
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics import quantity
from derive.mechanics.axes import AXES, PAIRS
from derive.mechanics.bodies.beam_functions import LEFT, ONE, rational
from derive.mechanics.bodies.beam_integrals import CENTRED, ORTHOGONAL, PARITY
from derive.mechanics.bodies.section_fields import (
    SectionField,
    SectionShape,
    position_field,
    second_field,
    shape_field,
)
from derive.mechanics.bodies.section_masses import SectionMass
from derive.mechanics.bodies.spatial_tables import DOCS, SECOND_ORDER_DOCS
from derive.mechanics.symbols import Family
from derive.mechanics.symbols import quantity as quantity_symbol
from derive.mechanics.terms import ModelConstant
from derive.mechanics.zero_reasons import CANCEL, CONDITION_17, CONDITION_19, ZERO_THERE
from derive.roles import Source
from derive.spec.model.body import DisplacementOrder

if TYPE_CHECKING:
    from derive.spec.model.spatial_beam import SpatialBeam

GEOMETRY = "geometry (the displacements of the sections are along other axes)"
ON_AXIS = "the specification (the centres of mass of the sections are on the axis)"


@dataclass(frozen=True)
class Integral:
    """An integral over the beam: its value, whether any integrand is there, and whether all of them are odd in xi.

    of_masses: why the part of attached masses vanishes if the whole does; empty if no masses see the integrand.
    """

    value: sp.Expr
    there: bool = False
    odd: bool = True
    of_masses: str = ""

    def __add__(self, other: Integral) -> Integral:
        of_masses = CANCEL if CANCEL in (self.of_masses, other.of_masses) else self.of_masses or other.of_masses
        return Integral(self.value + other.value, self.there or other.there, self.odd and other.odd, of_masses)

    def scaled(self, factor: sp.Expr) -> Integral:
        """The integral times a number."""
        return Integral(factor * self.value, self.there, self.odd, self.of_masses)

    def reason(self, otherwise: str) -> str:
        """The reason why the integral vanishes."""
        return GEOMETRY if not self.there else PARITY if self.odd else otherwise

    def zero(self, reason: str) -> str:
        """The reason why the integral vanishes, with that of the attached masses."""
        return f"{reason} and {self.of_masses}" if self.of_masses else reason


Tensor = dict[tuple[int, int], Integral]
"""A second moment by two axes."""


@dataclass(frozen=True)
class SectionMoments:
    """The moments of the fields of a beam in space with these shapes, mass (kg), length (m) and inertia J (kg m^2).

    The masses are attached to its sections. They are the moments of its part to the right of xi = `start`; mass and
    inertia are those of the whole beam.

    further: fields of the family of a full model, which are numbered behind the shapes.
    """

    beam: SpatialBeam
    shapes: tuple[SectionShape, ...]
    mass: sp.Expr
    length: sp.Expr
    inertia: sp.Expr
    masses: tuple[SectionMass, ...] = ()
    start: Fraction = LEFT
    further: tuple[SectionField, ...] = ()

    def constants(self) -> Iterator[ModelConstant]:
        """The entries of the tables of shape integrals, each with its value, or the reason why it vanishes."""
        mean = self.beam.frame.kind == "mean"
        second_order = self.beam.order is DisplacementOrder.TRUNCATED
        X = position_field(self.length)
        family = (*(shape_field(shape, self.length) for shape in self.shapes), *self.further)
        fields, numbers = dict(enumerate(family, 1)), range(1, len(family) + 1)
        pairs = [*combinations_with_replacement(numbers, 2)]
        first_vanishes = {1: CENTRED, 2: ON_AXIS, 3: ON_AXIS}
        for k, integral in self._first(X).items():
            yield _constant(Family.C1, (), (k,), integral, first_vanishes[k])
        for i in numbers:
            for k, integral in self._first(fields[i]).items():
                yield _constant(Family.C2, (i,), (k,), integral, integral.reason(CONDITION_17 if mean else ORTHOGONAL))
        for ab, integral in _inertia(self._second(X, X)).items():
            yield _constant(Family.C3, (), ab, integral)
        with_position = {i: self._second(X, fields[i]) for i in numbers}
        for i in numbers:
            for ab, integral in _inertia(with_position[i]).items():
                yield _constant(Family.C4, (i,), ab, integral)
        n = len(self.shapes)
        of_pairs = {(i, j): self._second(fields[i], fields[j], whole=max(i, j) <= n) for i, j in pairs}
        second = {}
        for i, j in pairs if second_order else ():
            field = second_field(self.shapes[i - 1], self.shapes[j - 1], self.beam.frame, self.length)
            second[i, j] = self._first(field), self._second(X, field)
        for pair in pairs:
            tensor = _inertia(of_pairs[pair])
            if second_order:
                bent = _inertia(second[pair][1])
                tensor = {ab: integral + bent[ab] for ab, integral in tensor.items()}
            for ab, integral in tensor.items():
                yield _constant(Family.C5, pair, ab, integral, second_order=second_order)
        for i in numbers:
            for k, integral in _axial(with_position[i]).items():
                yield _constant(Family.C6, (i,), (k,), integral, integral.reason(CONDITION_19 if mean else ORTHOGONAL))
        for pair in combinations(numbers, 2):
            for k, integral in _axial(of_pairs[pair]).items():
                yield _constant(Family.C7, pair, (k,), integral)
        for pair in pairs:
            yield _constant(Family.C8, pair, (), _trace(of_pairs[pair]))
        for pair, (first, with_X) in second.items():
            for k, integral in first.items():
                yield _constant(Family.C9, pair, (k,), integral, integral.reason(CONDITION_17 if mean else ORTHOGONAL))
            for k, integral in _axial(with_X).items():
                yield _constant(Family.C10, pair, (k,), integral)

    @cached_property
    def _section(self) -> sp.Matrix:
        """The means (4, 4) of the products of 1 and the coordinates of p over a section."""
        own = self.inertia / (2 * self.mass)
        return self._centres + sp.diag(0, -own, own, own)

    @cached_property
    def _centres(self) -> sp.Matrix:
        """The products of 1 and the coordinates of p in the centre of mass of a section."""
        centre = sp.Matrix([1, 0, *(quantity.value(x, positive=False) for x in self.beam.centre)])
        return centre * centre.T

    def _first(self, field: SectionField) -> dict[int, Integral]:
        """The first moment int rho f."""
        unit = SectionField({(1, 0): ONE}, sp.S.One, sp.S.One)
        return {axis: self._entry(field, unit, axis, 1, whole=True) for axis in AXES}

    def _second(self, f: SectionField, g: SectionField, whole: bool = True) -> Tensor:
        """The second moment int rho f g^T, or without `whole` that of the mass in the centres of the sections.

        Attached masses count as a whole: without their inertia, which may be large, M would not be definite.
        """
        return {(a, b): self._entry(f, g, a, b, whole) for a in AXES for b in AXES}

    def _entry(self, f: SectionField, g: SectionField, a: int, b: int, whole: bool) -> Integral:
        total, means = Integral(sp.S.Zero), self._section if whole else self._centres
        for left, of in f.along(a):
            for right, other in g.along(b):
                if weight := means[left[1], right[1]]:
                    product = of * other
                    unit = f.unit(left) * g.unit(right) * weight * self.mass / 2
                    total += Integral(unit * rational(product.integral(self.start)), True, product.is_odd)
                for m in self.masses:
                    if weight := m.moments[left[1], right[1]]:
                        there = rational((of * other).at(m.at))
                        unit = f.unit(left) * g.unit(right) * weight
                        total += Integral(unit * there, True, True, CANCEL if there else ZERO_THERE)
        return total


def _axial(moment: Tensor) -> dict[int, Integral]:
    """The axial vector int rho f x g of a second moment."""
    pairs = ((k, k % 3 + 1, (k + 1) % 3 + 1) for k in AXES)
    return {k: moment[a, b] + moment[b, a].scaled(sp.S.NegativeOne) for k, a, b in pairs}


def _trace(moment: Tensor) -> Integral:
    return moment[1, 1] + moment[2, 2] + moment[3, 3]


def _inertia(moment: Tensor) -> dict[tuple[int, int], Integral]:
    """The symmetric part of int rho ((f . g) I - f g^T) of a second moment."""
    result = {}
    for a, b in PAIRS:
        if a == b:
            first, second = (moment[k, k] for k in AXES if k != a)
            result[a, b] = first + second
        else:
            result[a, b] = (moment[a, b] + moment[b, a]).scaled(-sp.S.Half)
    return result


def _constant(
    family: Family,
    shapes: tuple[int, ...],
    components: tuple[int, ...],
    integral: Integral,
    zero: str = "",
    second_order: bool = False,
) -> ModelConstant:
    """An entry of a table, with the reason if it vanishes; at second order the table may contain more."""
    of_second = second_order or family not in DOCS
    doc, unit = (SECOND_ORDER_DOCS if of_second else DOCS)[family]
    value = sp.expand(integral.value)
    reason = None if value else integral.zero(zero or integral.reason(ORTHOGONAL))
    source = Source.SECOND_ORDER if of_second else Source.APPENDIX
    return ModelConstant(quantity_symbol(family, *components, shapes=shapes), value, source, doc, unit, reason)
