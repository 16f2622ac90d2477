"""The sine and cosine of the generated C: errors against mpmath, special values, and the same bits in vectors."""

from __future__ import annotations

import math

import numpy as np
import pytest
from generated_sine import sines
from mpmath import mp

from derive.runtime.compiler import FLAGS, vector_flags

LARGEST = 1e5
FAR = 1.03e5
"""Beyond 2^16 quarters of a turn."""
WIDTH = 8


def near_multiples(step: int) -> np.ndarray:
    """The doubles next to multiples of pi/4 up to the largest angle: there the reduced angle has the fewest digits."""
    with mp.workprec(120):
        last = int(LARGEST / (mp.pi / 4))
        nearest = np.array([float(mp.pi / 4 * n) for n in (*range(40), *range(40, last, step), last)])
    return np.concatenate([nearest, np.nextafter(nearest, 0), np.nextafter(nearest, np.inf)])


ANGLES = {
    "one quadrant": np.random.default_rng(1).uniform(-np.pi / 4, np.pi / 4, 3000),
    "some turns": np.random.default_rng(2).uniform(-30, 30, 3000),
    "all": np.random.default_rng(3).uniform(-LARGEST, LARGEST, 3000),
    "small": 10.0 ** np.random.default_rng(4).uniform(-320, 0, 1000),
    "near multiples of pi/4": near_multiples(137),
    "the largest": np.array([LARGEST, np.nextafter(LARGEST, 0), -LARGEST]),
}


@pytest.mark.parametrize("kind", ANGLES)
def test_error_in_units_in_the_last_place(kind: str) -> None:
    x = ANGLES[kind]
    with mp.workprec(200):
        for function, values in zip((mp.sin, mp.cos), sines(x), strict=True):
            exact = [function(mp.mpf(angle)) for angle in x]
            errors = [
                abs(float((mp.mpf(value) - e) / mp.mpf(np.spacing(abs(float(e))))))
                for value, e in zip(values, exact, strict=True)
            ]
            assert max(errors) < 0.9, (kind, x[int(np.argmax(errors))])


def test_special_values() -> None:
    s, c = sines(np.array([0.0, -0.0, 5e-324, -5e-324, np.inf, -np.inf, np.nan]))
    assert s[:4].tobytes() == np.array([0.0, -0.0, 5e-324, -5e-324]).tobytes()
    assert (c[:4] == 1).all() and np.isnan(s[4:]).all() and np.isnan(c[4:]).all()


def test_larger_angles_are_those_of_the_c_library() -> None:
    few = [FAR, -FAR, -3e6, 1e9, 1e22, -1.7e308, 6381956970095103.0 * 2.0**797]
    x = np.append(np.random.default_rng(5).uniform(FAR, 1.1 * FAR, 300), few)  # one in ten differs by a bit
    s, c = sines(x)
    assert s.tolist() == [math.sin(angle) for angle in x]
    assert c.tolist() == [math.cos(angle) for angle in x]


def test_sines_of_minus_x() -> None:
    x = np.concatenate([ANGLES["all"], ANGLES["some turns"]])
    (s, c), (minus_s, minus_c) = sines(x), sines(-x)
    assert minus_s.tobytes() == (-s).tobytes() and minus_c.tobytes() == c.tobytes()


@pytest.mark.parametrize("count", range(1, 2 * WIDTH + 2))
def test_blocks_have_the_bits_of_single_angles(count: int) -> None:
    """Blocks keep the bits of single angles also where one of them, at any place, is left to the C library."""
    x = ANGLES["some turns"][:count]
    for place in range(count):
        for angle in (-0.0, 2e5, -1e300):
            given = np.where(np.arange(count) == place, angle, x)
            for function in ("ones", "blocks"):
                assert [a.tobytes() for a in sines(given, function)] == [a.tobytes() for a in sines(given)]


@pytest.mark.parametrize("flags", [(*FLAGS,), (*FLAGS, "-mavx"), (*FLAGS, "-DTISSERAND_NO_VECTORS")], ids=str)
@pytest.mark.parametrize("count", range(1, 11))
def test_angles_at_a_distance_have_the_bits_of_single_angles(count: int, flags: tuple[str, ...]) -> None:
    """Every third element is an angle: fewer than a block, whole blocks, and a last block that overlaps."""
    x = np.full(3 * count - 2, np.nan)
    for place in range(count):
        for angle in (0.5, 2e5):
            x[::3] = np.where(np.arange(count) == place, angle, ANGLES["some turns"][:count])
            for values, expected in zip(sines(x, "spaced", flags), sines(x), strict=True):
                assert values[::3].tobytes() == expected[::3].tobytes()


VARIANTS = {
    "portable -O3": ("-std=c99", "-O3", "-ffp-contract=off"),
    "processor": vector_flags(),
}


@pytest.mark.parametrize("variant", VARIANTS)
def test_bits_do_not_depend_on_the_vectors(variant: str) -> None:
    x = np.concatenate([*ANGLES.values()])
    expected = [a.tobytes() for a in sines(x)]
    for function in ("singles", "ones", "blocks"):
        assert [a.tobytes() for a in sines(x, function, VARIANTS[variant])] == expected


def test_compilers_that_reorder_sums_leave_all_to_the_c_library() -> None:
    """The first two operations, x + 1.5 2^52 - 1.5 2^52, would vanish."""
    x = np.concatenate([*ANGLES.values()])
    for flags in (("-std=c99", "-O2", "-ffast-math"), ("-std=c99", "-O2", "-funsafe-math-optimizations")):
        s, c = sines(x, "singles", flags)
        np.testing.assert_allclose(s, np.sin(x), rtol=0, atol=1e-15)
        np.testing.assert_allclose(c, np.cos(x), rtol=0, atol=1e-15)
        assert np.nextafter(0.0, 1.0) > 0  # the library has left the arithmetic of the process alone
