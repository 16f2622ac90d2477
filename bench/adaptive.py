"""The time of one revolution of the crank-slider: the adaptive method in C, and the same method of SciPy beside it.

python bench/adaptive.py [--beams 1 3] [--rows 200] [--tolerance 1e-6] [--runs 21]

The rod of parameter set A is divided into one or more beams. Derivation, compilation and the initial state are not part
of the time; the runs of both methods alternate, and the figures are medians of CPU times in one process. `C` is the
time inside the C function, `with call` that of the call from Python, whose result is arrays. The difference is the
largest one of the coordinates in all rows, which have to agree within 1000 tolerances.
"""

from __future__ import annotations

import argparse
import statistics
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from machine import described

import derive
from derive.runtime.integrators.adaptive import Adaptive
from derive.simulation.initial.initial_state import initial_state
from derive.simulation.integration.scipy_methods import integrate
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.scene import Scene

SCENE = Path(__file__).parent.parent / "scenes" / "crank_slider_3.toml"
REVOLUTION = 2 * np.pi / 150  # s


def scene(beams: int) -> Scene:
    """The crank-slider with a rod of so many beams."""
    result = derive.read(SCENE)
    assert isinstance(result, Scene)
    bodies = tuple(replace(b, pieces=beams) if isinstance(b, BeamBody) else b for b in result.bodies)
    return replace(result, bodies=bodies)


def measure(beams: int, rows: int, tolerance: float, runs: int) -> str:
    """A line of the table. Raises ArithmeticError if the methods do not agree."""
    spec = scene(beams)
    native = derive.load_scene(derive.model_files(derive.lower(derive.derive(spec)), spec))
    host, k = Adaptive(native), native.setup()
    start, times = initial_state(spec, native, k), np.linspace(0.0, REVOLUTION, rows)
    inside, called, scipy = [], [], []
    for _ in range(runs):
        before = time.process_time()
        run = host.run(start.q, start.v, times, rtol=tolerance, k=k, drift=1e-9)
        called.append(time.process_time() - before)
        inside.append(run.seconds)
        other = integrate(native, k, start.q, start.v, times, tolerance=tolerance)
        scipy.append(other.cost.seconds)
    difference = float(np.abs(run.q - other.q).max())
    if not difference < 1000 * tolerance:
        raise ArithmeticError(f"{beams} beams: the methods differ by {difference:.1e}")
    figures = [1e3 * statistics.median(seconds) for seconds in (inside, called, scipy)]
    cells = "".join(f"{figure:12.3f}" for figure in figures)
    return (
        f"{beams:5}{run.counts['steps']:7}{other.cost.steps:7}{run.counts['accelerations']:13}{cells}{difference:12.1e}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--beams", type=int, nargs="+", default=[1, 3])
    parser.add_argument("--rows", type=int, default=200)
    parser.add_argument("--tolerance", type=float, default=1e-6)
    parser.add_argument("--runs", type=int, default=21)
    options = parser.parse_args()
    print("\n".join(described("scipy", "numpy")))
    print(f"figures   ms of CPU time, median of {options.runs} runs; {options.rows} rows, {options.tolerance:g}\n")
    print("beams  steps  SciPy  evaluations           C   with call       SciPy  difference")
    for beams in options.beams:
        print(measure(beams, options.rows, options.tolerance, options.runs), flush=True)


if __name__ == "__main__":
    main()
