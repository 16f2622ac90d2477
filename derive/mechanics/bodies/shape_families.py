"""Shape functions with names: the natural modes of a uniform beam with pinned ends, free ends, or one clamped end.

They are, for n = 1, 2, ... and with z = k_n (xi + 1),

    pinned         sin(n pi (xi + 1)/2)
    free-free      (cos(k_n xi)/cos k_n + cosh(k_n xi)/cosh k_n)/2,  tan k_n = -tanh k_n,  for odd n
                   (sin(k_n xi)/sin k_n + sinh(k_n xi)/sinh k_n)/2,  tan k_n = tanh k_n,   for even n
    clamped-free   a_n {cosh z - cos z - s_n (sinh z - sin z)},  cos(2 k_n) cosh(2 k_n) = -1

with s_n = (cosh 2k_n + cos 2k_n)/(sinh 2k_n + sin 2k_n), and a_n such that a clamped-free shape is one at its free end,
as a free-free one is at its right end; a pinned shape has the amplitude one. The natural frequencies of such a beam are
4 k_n^2 sqrt(EI/(m l^3)), of a pinned one with k_n = n pi/2. All of them are orthogonal in mass and in stiffness.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from functools import cache
from typing import assert_never

from derive.mechanics.bodies.beam_functions import ARITHMETIC, BeamFunction, Real, WaveNumber, exponential
from derive.spec.model.beam_parts import ShapeFamily


@cache
def family_shapes(family: ShapeFamily) -> tuple[BeamFunction, ...]:
    """The shapes of a family, from that of the lowest frequency on."""
    numbers = range(1, family.count + 1)
    match family.kind:
        case "pinned":
            return tuple(map(_pinned, numbers))
        case "free-free":
            return tuple(map(_free_free, numbers))
        case "clamped-free":
            return tuple(map(_clamped_free, numbers))
        case _ as never:
            assert_never(never)


def _pinned(n: int) -> BeamFunction:
    """The shape sin(n pi/2) cos(n pi xi/2) + cos(n pi/2) sin(n pi xi/2): one factor is zero, the other 1 or -1."""
    k = WaveNumber("pi/2", ARITHMETIC.pi / 2)
    wave = _even(k, n, imaginary=True) if n % 2 else _odd(k, n, imaginary=True)
    return wave if n % 4 in (0, 1) else -wave


def _free_free(n: int) -> BeamFunction:
    sign, wave = (1, _even) if n % 2 else (-1, _odd)
    guess = (2 * n + 1) * ARITHMETIC.pi / 4
    k = WaveNumber(f"free-free {n}", _root(lambda k: _sin(k) + sign * _cos(k) * ARITHMETIC.tanh(k), guess))
    parts = (wave(k, 1, imaginary) for imaginary in (True, False))
    first, second = (part.scaled(1 / (2 * part.at(Fraction(1)))) for part in parts)
    return first + second


def _clamped_free(n: int) -> BeamFunction:
    """The clamped-free shape from (1 - s) exp(z)/2 + (1 + s) exp(-z)/2 and the real part of -(1 + i s) exp(i z)."""
    guess = (2 * n - 1) * ARITHMETIC.pi / 4 if n > 1 else ARITHMETIC.mpf(15) / 16
    root = _root(lambda k: _cos(2 * k) + 1 / ARITHMETIC.cosh(2 * k), guess)
    k, whole, i = WaveNumber(f"clamped-free {n}", root), 2 * root, ARITHMETIC.mpc(0, 1)
    s = (ARITHMETIC.cosh(whole) + _cos(whole)) / (ARITHMETIC.sinh(whole) + _sin(whole))
    rising, turning = ARITHMETIC.exp(root), ARITHMETIC.exp(i * root)
    shape = exponential(k, 1, 0, (1 - s) / 2 * rising) + exponential(k, -1, 0, (1 + s) / 2 / rising)
    shape += exponential(k, 0, 1, -(1 + i * s) / 2 * turning) + exponential(k, 0, -1, -(1 - i * s) / 2 / turning)
    return shape.scaled(1 / shape.at(Fraction(1)))


def _even(k: WaveNumber, multiple: int, imaginary: bool) -> BeamFunction:
    """The even function cos, or cosh, of multiple k xi."""
    return _wave(k, multiple, imaginary, ARITHMETIC.mpf(1) / 2, ARITHMETIC.mpf(1) / 2)


def _odd(k: WaveNumber, multiple: int, imaginary: bool) -> BeamFunction:
    """The odd function sin, or sinh, of multiple k xi."""
    half = 1 / ARITHMETIC.mpc(0, 2) if imaginary else ARITHMETIC.mpf(1) / 2
    return _wave(k, multiple, imaginary, half, -half)


def _wave(k: WaveNumber, multiple: int, imaginary: bool, rising: Real, falling: Real) -> BeamFunction:
    rate = (0, multiple) if imaginary else (multiple, 0)
    return exponential(k, *rate, rising) + exponential(k, -rate[0], -rate[1], falling)


def _root(function: Callable[[Real], Real], guess: Real) -> Real:
    """The root of a function near a guess, to all digits."""
    return ARITHMETIC.findroot(function, guess)


def _sin(angle: Real) -> Real:
    return ARITHMETIC.sin(angle)


def _cos(angle: Real) -> Real:
    return ARITHMETIC.cos(angle)
