"""Fields of beams in space against exact rotations, their energies, and their integrals against points."""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from itertools import combinations_with_replacement
from typing import Any

import mpmath
import numpy as np
import pytest
from rods_in_space import FRAMES, beam, numbers, points

from derive.algebra import sp
from derive.mechanics.bodies.section_fields import (
    Direction,
    SectionField,
    SectionShape,
    position_field,
    second_field,
    section_shapes,
    shape_field,
)
from derive.mechanics.bodies.section_moments import SectionMoments
from derive.mechanics.bodies.spatial_beam import cubic_stiffness, stiffness_constants
from derive.mechanics.symbols import Family


def value(field: SectionField, xi: Fraction, p: tuple[Any, ...]) -> list[mpmath.mpf]:
    """A field at a point p of the section at xi."""
    result = [mpmath.mpf(0)] * 3
    for (axis, coordinate), of in field.slots.items():
        number = sp.Rational(of.at(xi)) * field.unit((axis, coordinate))
        result[axis - 1] += mpmath.mpf(int(number.p)) / int(number.q) * (p[coordinate - 1] if coordinate else 1)
    return result


class ExactSection:
    """The sections of a beam that bends, twists and stretches by finite amounts, from their tangents and twists.

    The axis has the deflections v and w along e2 and e3, and its tangent has the length 1 + du/dx. A section is turned
    from e1 to the tangent about the normal of both, and then about the tangent by the angle theta + 1/2 int (v' w'' -
    v'' w') dx, whose twist is theta' to second order.
    """

    def __init__(self, shapes: tuple[SectionShape, ...], length: float, amplitudes: Any) -> None:
        self.shapes, self.l, self.a = shapes, mpmath.mpf(length), amplitudes

    def sums(self, direction: Direction, xi: Any, order: int = 0) -> Any:
        """The sum of the shapes of a direction, or a derivative of it by x."""
        total = mpmath.mpf(0)
        for a, shape in zip(self.a, self.shapes, strict=True):
            if shape.direction is direction:
                coefficients = shape.of.derivative(order).coefficients
                total += a * sum(mpmath.mpf(c.numerator) / c.denominator * xi**n for n, c in enumerate(coefficients))
        return total * (2 / self.l) ** order

    def axis(self, xi: Any) -> Any:
        """The position along e1 of the axis, from the left end."""

        def slope(x: Any) -> Any:
            v, w, u = (self.sums(d, x, 1) for d in (Direction.ALONG_E2, Direction.ALONG_E3, Direction.AXIAL))
            return mpmath.sqrt((1 + u) ** 2 - v**2 - w**2) * self.l / 2

        return gauss(slope, xi)

    def rotation(self, xi: Any) -> Any:
        """The rotation matrix of the section."""
        v, w, u = (self.sums(d, xi, 1) for d in (Direction.ALONG_E2, Direction.ALONG_E3, Direction.AXIAL))
        t2, t3 = v / (1 + u), w / (1 + u)
        t1 = mpmath.sqrt(1 - t2**2 - t3**2)
        normal = turned([0, -t3, t2], mpmath.atan2(mpmath.sqrt(t2**2 + t3**2), t1))
        return turned([t1, t2, t3], self.sums(Direction.TORSION, xi) * 2 / self.l + self.twist(xi)) * normal

    def twist(self, xi: Any) -> Any:
        """The angle 1/2 int (v' w'' - v'' w') dx from the left end."""

        def rate(x: Any) -> Any:
            v, w = ((self.sums(d, x, 1), self.sums(d, x, 2)) for d in (Direction.ALONG_E2, Direction.ALONG_E3))
            return (v[0] * w[1] - v[1] * w[0]) * self.l / 4

        return gauss(rate, xi)


@cache
def gauss_points() -> list[tuple[Any, Any]]:
    """The nodes and weights of Gauss-Legendre quadrature that is exact for the polynomials here."""
    n = 6
    first = np.polynomial.legendre.leggauss(n)[0]
    roots = [mpmath.findroot(lambda x: mpmath.legendre(n, x), float(x)) for x in first]
    slopes = [n * mpmath.legendre(n - 1, r) / (1 - r**2) for r in roots]
    return [(r, 2 / ((1 - r**2) * slope**2)) for r, slope in zip(roots, slopes, strict=True)]


def gauss(function: Any, xi: Any) -> Any:
    """The integral from -1 to xi."""
    half = (xi + 1) / 2
    return half * sum(w * function(half * (r + 1) - 1) for r, w in gauss_points())


def turned(axis: list[Any], angle: Any) -> Any:
    """The rotation by an angle about an axis of any length."""
    size = mpmath.sqrt(sum(x**2 for x in axis))
    if size == 0:
        return mpmath.eye(3)
    x, y, z = (c / size for c in axis)
    skew = mpmath.matrix([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return mpmath.eye(3) + mpmath.sin(angle) * skew + (1 - mpmath.cos(angle)) * skew * skew


def place(shapes: tuple[SectionShape, ...], a: Any, xi: Any, p: tuple[Any, ...]) -> mpmath.matrix:
    """The place of a point of the section of the beam with amplitudes a, from its left end."""
    section = ExactSection(shapes, 1.5, a)
    axis = [section.axis(xi), section.sums(Direction.ALONG_E2, xi), section.sums(Direction.ALONG_E3, xi)]
    return mpmath.matrix(axis) + section.rotation(xi) * mpmath.matrix(p)


def of_each_direction(
    shapes: tuple[SectionShape, ...],
) -> list[tuple[tuple[int, SectionShape], tuple[int, SectionShape]]]:
    """A pair of shapes, with their numbers, of each pair of directions."""
    pairs = combinations_with_replacement(enumerate(shapes), 2)
    chosen = {(first[1].direction, second[1].direction): (first, second) for first, second in pairs}
    return [*chosen.values()]


def second_difference(function: Any, n: int, i: int, j: int, h: Any) -> Any:
    """The second derivative of a function of n amplitudes by two of them, at zero."""

    def at(*signs: int) -> Any:
        a = [mpmath.mpf(0)] * n
        for number, sign in zip((i, j), signs, strict=True):
            a[number] += sign * h
        return function(a)

    return (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4 * h**2)


def test_fields_of_second_order_are_derivatives_of_exact_rotations() -> None:
    """Phi_i and Psi_ij of a tangent frame are the derivatives of the place of any point of any section."""
    of = beam(frame={"kind": "tangent", "at": -1}, order=2)
    shapes, length = section_shapes(of), sp.Rational(3, 2)
    n, xi, p = len(shapes), Fraction(2, 5), tuple(map(mpmath.mpf, (0, "0.3", "-0.2")))
    assert {shape.direction for shape in shapes} == set(Direction)
    with mpmath.workdps(40):
        h = mpmath.mpf(10) ** -9
        at = mpmath.mpf(2) / 5
        for (i, first), (j, second) in of_each_direction(shapes):
            exact = second_difference(lambda a: place(shapes, a, at, p), n, i, j, h)
            derived = value(second_field(first, second, of.frame, length), xi, p)
            assert max(abs(x - y) for x, y in zip(exact, derived, strict=True)) < 1e-14, (first, second)
        for i, shape in [*dict(pair[0] for pair in of_each_direction(shapes)).items()]:
            ends = (place(shapes, [h * sign * (k == i) for k in range(n)], at, p) for sign in (1, -1))
            plus, minus = ends
            derived = value(shape_field(shape, length), xi, p)
            assert max(abs(x - y) for x, y in zip((plus - minus) / (2 * h), derived, strict=True)) < 1e-14


def test_strain_energy_is_that_of_exact_curvatures() -> None:
    """K and the factors of third order are derivatives of the energy of the curvatures of exact rotations."""
    of = beam(frame={"kind": "tangent", "at": -1}, order=2)
    shapes = section_shapes(of)
    n = len(shapes)
    stiffness = [mpmath.mpf(x) for x in (7, 12, 30)]  # of torsion, about e2 and about e3

    def energy(a: Any) -> Any:
        section, h = ExactSection(shapes, 1.5, a), mpmath.mpf(10) ** -12

        def density(xi: Any) -> Any:
            slope = (section.rotation(xi + h) - section.rotation(xi - h)) / (2 * h) * 2 / section.l
            spin = section.rotation(xi).T * slope
            curvatures = (spin[2, 1], spin[0, 2], spin[1, 0])
            u = section.sums(Direction.AXIAL, xi, 1)
            bent = sum(k * c**2 for k, c in zip(stiffness, curvatures, strict=True))
            return (bent + 1000 * u**2) * section.l / 4

        return gauss(density, mpmath.mpf(1))

    cubic = {c.symbol.identity.shapes: c.value for c in cubic_stiffness(of, shapes)}
    linear = {c.symbol.identity.shapes: c.value for c in stiffness_constants(of, shapes)}
    assert cubic
    with mpmath.workdps(40):
        h = mpmath.mpf(10) ** -6
        for i, j in ((0, 2), (3, 4), (6, 7)):
            exact = second_difference(energy, n, i, j, h)
            assert abs(exact - mpmath.mpf(float(linear[i + 1, j + 1]))) < 1e-6 * 30, (i, j)
        for (i, j, k), factor in [*cubic.items()][:1]:

            def third(sign: int, i: int = i, j: int = j, k: int = k) -> Any:
                return second_difference(
                    lambda a: energy([x + (sign * h if m == k - 1 else 0) for m, x in enumerate(a)]), n, i - 1, j - 1, h
                )

            exact = (third(1) - third(-1)) / (2 * h)
            assert abs(exact - mpmath.mpf(float(factor))) < 1e-4 * abs(float(factor)) + 1e-6, (i, j, k)


@pytest.mark.parametrize("frame", FRAMES)
def test_integrals_are_those_of_points(frame: Any) -> None:
    """The shape integrals of a beam off its axis are sums over points that move with the fields."""
    of = beam(frame=frame, order=2, centre=["1/20", "-1/30"])
    shapes, length = section_shapes(of)[::2], sp.Rational(3, 2)
    moments = SectionMoments(of, shapes, sp.Integer(2), length, sp.Rational(1, 50))
    entries = {c.symbol.identity: float(c.value) for c in moments.constants()}
    fields = [position_field(length), *(shape_field(shape, length) for shape in shapes)]
    n = len(shapes)
    pairs = [*combinations_with_replacement(range(n), 2)]
    fields += [second_field(shapes[i], shapes[j], of.frame, length) for i, j in pairs]
    cloud = points(of)
    weights = np.array([w for w, _, _ in cloud])
    at = np.array([[numbers(field, float(xi), p) for _, xi, p in cloud] for field in fields])
    first = np.einsum("p,fpk->fk", weights, at)
    gram = np.einsum("p,fpa,gpb->fgab", weights, at, at)
    unit = np.eye(3)

    def tensor(moment: Any) -> Any:
        return np.trace(moment) * unit - (moment + moment.T) / 2

    def axial(moment: Any) -> Any:
        return np.array([moment[(k + 1) % 3, (k + 2) % 3] - moment[(k + 2) % 3, (k + 1) % 3] for k in range(3)])

    second = {pair: n + 1 + number for number, pair in enumerate(pairs)}
    expected = {
        Family.C1: lambda: first[0],
        Family.C2: lambda i: first[i],
        Family.C3: lambda: tensor(gram[0, 0]),
        Family.C4: lambda i: tensor(gram[0, i]),
        Family.C5: lambda i, j: tensor(gram[i, j]) + tensor(gram[0, second[i - 1, j - 1]]),
        Family.C6: lambda i: axial(gram[0, i]),
        Family.C7: lambda i, j: axial(gram[i, j]),
        Family.C8: lambda i, j: np.trace(gram[i, j]),
        Family.C9: lambda i, j: first[second[i - 1, j - 1]],
        Family.C10: lambda i, j: axial(gram[0, second[i - 1, j - 1]]),
    }
    checked = dict.fromkeys(expected, 0)
    for known, derived in entries.items():
        whole = np.asarray(expected[known.family](*known.shapes))
        wanted = whole[tuple(k - 1 for k in known.components)]
        assert abs(derived - wanted) < 1e-12 * max(1.0, float(np.abs(whole).max())), known
        checked[known.family] += derived != 0
    assert all(checked.values()), checked
