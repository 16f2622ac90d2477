"""The deflection at which each model of a beam leaves a geometrically exact rod by 1 %.

python bench/large_deflection.py        (about ten minutes)

The rod of `tests/second_order/exact_rod.py` is inextensible and knows neither a floating frame nor shape functions of
the deflection. Four cases: a free rod that is struck in its first mode when it is straight, without spin and with a
spin of 10 sqrt(EI/(m l^3)); a clamped rod that is struck so; a clamped rod with a load across its tip at rest. The
error is the root mean square over two periods, divided by the largest deflection; at rest it is that of the deflection.
The deflection is that of the middle from the chord, of a clamped rod that of its tip.
"""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path

import numpy as np
from numpy.polynomial import Legendre

from derive.errors import TisserandError

sys.path.insert(0, str(Path(__file__).parent.parent / "tests" / "second_order"))
from exact_rod import ExactRod
from rod_models import FRAMES, TERMS, TIMES, RodModel, deflection, first_mode

LIMIT = 0.01
SIZES = np.geomspace(0.004, 0.5, 22)
"""Deflections over the length at which the models are compared; crossings of the limit are interpolated."""
CASES = {"free": ("free", 0.0), "free, spin 10": ("free", 10.0), "clamped": ("clamped", 0.0)}
FREQUENCY = {"free": 22.37, "clamped": 3.516}


def velocity(case: str, size: float) -> Legendre:
    """The initial velocity of the strike, with the spin, over 0 <= s <= 1."""
    support, spin = CASES[case]
    return size * FREQUENCY[support] * first_mode(support) + Legendre([0, spin / 2], domain=[0, 1])


@cache
def exact(case: str, size: float) -> np.ndarray:
    """The deflection of the exact rod over the time."""
    support, _ = CASES[case]
    return deflection(ExactRod(support, 9).struck(velocity(case, size), TIMES[support], 1e-8), support)


@cache
def elastica(load: float) -> float:
    """The deflection of the tip of the exact rod."""
    return float(ExactRod("clamped", load=(0.0, load)).at_rest()[2][1])


def error_in_motion(model: RodModel, case: str, size: float) -> tuple[float, float]:
    """The largest deflection, and the error of a model over it."""
    truth = exact(case, size)
    largest = float(np.abs(truth).max())
    difference = deflection(model.struck(velocity(case, size), TIMES[model.support]), model.support) - truth
    return largest, float(np.sqrt(np.mean(difference**2))) / largest


def error_at_rest(model: RodModel, size: float) -> tuple[float, float]:
    """The deflection, and the error of a model over it; the load is 3 EI/l^2 times the size."""
    truth = elastica(3 * size)
    return truth, abs(float(model.at_rest(3 * size)[2][1]) / truth - 1)


def leaves(model: RodModel, case: str) -> str:
    """The deflection over the length at which the error passes the limit."""
    before: tuple[float, float] | None = None
    for size in SIZES:
        try:
            at, error = error_at_rest(model, size) if case == "at rest" else error_in_motion(model, case, size)
        except TisserandError:
            return f"stops at {size:.3f}" if before is None else f"stops after {before[0]:.3f}"
        if error > LIMIT:
            if before is None:
                return f"{100 * error:.0f} % off at {at:.3f}"
            along = np.log(LIMIT / before[1]) / np.log(error / before[1])
            return f"{before[0] * (at / before[0]) ** along:.3f}"
        before = at, error
    assert before is not None
    return f"above {before[0]:.2f}"


def main() -> None:
    print("| model | frame | free | free, spin 10 | clamped | clamped, at rest |")
    print("| --- | --- | ---: | ---: | ---: | ---: |")
    for terms in TERMS:
        for frame in FRAMES:
            free, clamped = RodModel("free", frame, terms), RodModel("clamped", frame, terms)
            cells = [leaves(clamped if case == "clamped" else free, case) for case in CASES]
            print(f"| {terms} | {frame} | {' | '.join(cells)} | {leaves(clamped, 'at rest')} |", flush=True)


if __name__ == "__main__":
    main()
