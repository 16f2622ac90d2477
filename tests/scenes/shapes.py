"""Assumed shapes by Gauss's elimination of numbers, and Gauss points: what the oracle knows of a beam."""

from __future__ import annotations

from fractions import Fraction
from functools import cache

import mpmath

from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import Frame

Shape = tuple[Fraction, ...]
POINTS = 6


def at(shape: Shape, xi: Fraction, order: int = 0) -> Fraction:
    """A polynomial, or one of its derivatives, at xi: a number of any kind that multiplies."""
    for _ in range(order):
        shape = tuple(n * c for n, c in enumerate(shape))[1:]
    total = xi * 0
    for c in reversed(shape):
        total = total * xi + (mpmath.mpf(c.numerator) / c.denominator if isinstance(xi, mpmath.mpf) else c)
    return total


def product(a: Shape, b: Shape) -> Fraction:
    """int a b dxi over the beam."""
    pairs = ((i + j, x * y) for i, x in enumerate(a) for j, y in enumerate(b))
    return sum((2 * c / (n + 1) for n, c in pairs if n % 2 == 0), Fraction(0))


@cache
def shapes(beam: PlanarBeam) -> tuple[Shape, ...]:
    """The ansatz in its frame: as many of its first terms as there are conditions stand in for the rest to meet them.

    Then, if asked for, each is made orthogonal to those before it; then scaled to 1 at xi = 1, or in the first
    derivative there that does not vanish.
    """
    conditions = [[_condition(beam.frame, k, p) for p in beam.ansatz] for k in range(_count(beam.frame))]
    found = []
    pivots, reduced = _eliminated(conditions)
    for j in range(len(beam.ansatz)):
        if j not in pivots:
            weights = [Fraction(0)] * len(beam.ansatz)
            weights[j] = Fraction(1)
            for row, pivot in zip(reduced, pivots, strict=True):
                weights[pivot] = -row[j]
            found.append(_sum(weights, beam.ansatz))
    if beam.orthogonal:
        kept: list[Shape] = []
        for p in found:
            rest = p
            for other in kept:
                rest = _sum((Fraction(1), -product(p, other) / product(other, other)), (rest, other))
            kept.append(rest)
        found = kept
    return tuple(_scaled(p) for p in found)


def _count(frame: Frame) -> int:
    return 0 if frame.kind == "given" else 2


def _condition(frame: Frame, k: int, p: Shape) -> Fraction:
    if frame.kind == "mean":
        return product(p, (Fraction(0), Fraction(1)) if k else (Fraction(1),))
    if frame.kind == "chord":
        return at(p, Fraction(2 * k - 1))
    return at(p, frame.at, order=k)


def _eliminated(rows: list[list[Fraction]]) -> tuple[list[int], list[list[Fraction]]]:
    pivots: list[int] = []
    done: list[list[Fraction]] = []
    for given in rows:
        rest = given
        for other, pivot in zip(done, pivots, strict=True):
            rest = [x - rest[pivot] * y for x, y in zip(rest, other, strict=True)]
        pivot = next(j for j, x in enumerate(rest) if x)
        rest = [x / rest[pivot] for x in rest]
        done = [[x - other[pivot] * y for x, y in zip(other, rest, strict=True)] for other in done]
        pivots.append(pivot)
        done.append(rest)
    return pivots, done


def _sum(weights: tuple[Fraction, ...] | list[Fraction], polynomials: tuple[Shape, ...]) -> Shape:
    size = max(map(len, polynomials))
    padded = [tuple(p) + (Fraction(0),) * (size - len(p)) for p in polynomials]
    return tuple(sum((w * p[n] for w, p in zip(weights, padded, strict=True)), Fraction(0)) for n in range(size))


def _scaled(p: Shape) -> Shape:
    order = next(k for k in range(len(p)) if at(p, Fraction(1), k))
    return tuple(c / at(p, Fraction(1), order) for c in p)


@cache
def gauss(digits: int) -> tuple[tuple[mpmath.mpf, mpmath.mpf], ...]:
    """Points and weights on [-1, 1], exact for polynomials to the degree 2 POINTS - 1, in so many digits."""
    with mpmath.workdps(digits + 10):
        roots = mpmath.polyroots(mpmath.taylor(lambda x: mpmath.legendre(POINTS, x), 0, POINTS)[::-1], maxsteps=200)
        slopes = [mpmath.diff(lambda x: mpmath.legendre(POINTS, x), x) for x in roots]
        return tuple((x, 2 / ((1 - x**2) * slope**2)) for x, slope in zip(roots, slopes, strict=True))
