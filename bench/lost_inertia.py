"""The errors that a loss of inertia implies up to the stop of a run, compared with full terms of the same shapes.

python bench/lost_inertia.py            (some minutes)

A free beam in the plane, in the tangent frame of its left end, where truncated terms lose most, is struck while it
spins or not, harder and harder until its mass matrix becomes indefinite. Both models have the same shapes: the
difference is due to the terms alone. The error is the root mean square of the difference of deflections from the chord,
where it is largest along the beam, over the peak with full terms.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

import derive
from derive.errors import TisserandError
from derive.percentages import percent
from derive.simulation.observables.beams import function_values, shape_functions
from derive.simulation.trajectory import Trajectory
from derive.simulation.validity.beam_line import places
from derive.simulation.validity.bending_planes import bending_planes
from derive.simulation.validity.monitors import ERROR_LIMIT, Cause

SHAPES = (3, 4)
SPINS = (0.0, 6.0, 12.0, 20.0)
"""rad/s; the lowest frequency at rest is 22.4 rad/s."""
RATES = (0.05, 0.1, 0.15, 0.2, 0.25, 0.3)
"""Of the deflection at both ends, m/s, of a beam of 1 m."""
DURATION, OUTPUT = 2.0, 0.005
"""Seven periods."""


def struck(terms: str, shapes: int, spin: float, rate: float) -> Trajectory:
    """The motion of a beam with these terms. Raises SimulationError where it stops."""
    beam = {
        "length": 1,
        "mass": 1,
        "bending_stiffness": 1,
        "ansatz": [f"xi^{power}" for power in range(shapes + 2)],
        "frame": {"kind": "tangent", "at": -1},
        "order": 2,
        "terms": terms,
        "start": {"deflection_rate": f"{rate}*(3/2*xi^2 - 1/2)", "spin": spin},
    }
    return derive.simulate(derive.scene("struck", bodies={"rod": beam}), duration=DURATION, output=OUTPUT)


def deflections(run: Trajectory) -> np.ndarray:
    """(n, places): the deflections from the chord."""
    (shapes,) = bending_planes(run.motion.scene)
    amplitudes = run.motion.q[:, shapes.amplitudes_in(run.motion.native, "rod")]
    w = amplitudes @ np.array([function_values(f, places()) for f in shape_functions(shapes.beam)])
    along = (places() + 1) / 2
    return np.asarray(w - np.outer(w[:, 0], 1 - along) - np.outer(w[:, -1], along))


def rows() -> Iterator[tuple[int, float, float, float, float, float]]:
    """Shapes, spin, rate, the largest loss of inertia, the error and the implied one, of the runs that do not stop."""
    for shapes in SHAPES:
        for spin in SPINS:
            for rate in RATES:
                try:
                    run = struck("truncated", shapes, spin, rate)
                except TisserandError:
                    break
                own, exact = deflections(run), deflections(struck("full", shapes, spin, rate))
                error = np.sqrt(((own - exact) ** 2).mean(axis=0)).max() / np.abs(exact).max()
                (lost,) = (m for m in run.validity if m.cause is Cause.MASS_MATRIX)
                yield shapes, spin, rate, lost.value, float(error), lost.error


def main() -> None:
    print("| shapes | spin, rad/s | rate, m/s | lost | error | implied |\n|---:|---:|---:|---:|---:|---:|")
    known = []
    for row in rows():
        known.append(row[-2:])
        print("| {} | {:g} | {:g} |".format(*row[:3]), " | ".join(map(percent, row[3:])), "|", flush=True)
    error, implied = np.minimum(np.array(known).T, 1.0)
    off = np.exp(np.abs(np.log(implied / error)))
    wrong, warned = error > ERROR_LIMIT, implied > ERROR_LIMIT
    print(f"within 2: {percent(float(np.mean(off <= 2)))}, within 4: {percent(float(np.mean(off <= 4)))} of {len(off)}")
    counts = [int(np.sum(of)) for of in (wrong & warned, wrong & ~warned, ~wrong & warned, ~wrong & ~warned)]
    print("wrong and warned {}, missed {}, false alarm {}, right and silent {}".format(*counts))


if __name__ == "__main__":
    main()
