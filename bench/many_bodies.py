"""Chains of 1 to 1000 hinged beams: seconds to prepare and of a step of the adaptive integrator, against their number.

python bench/many_bodies.py [--sizes 3 10 30 100 300 1000] [--kind revolute] [--duration 0.02]

The last column is the exponent of the seconds per step between a number of beams and the one before. Scenes below the
limit of `derive.lowering.instances.lower` are straight-line code, and those above it loops over the beams.
"""

from __future__ import annotations

import argparse
import math
import resource
import time

from chain_scene import chain

import derive
from derive.simulation.prepared_run import PreparedRun


def main() -> None:
    """Print a line for each number of beams."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", type=int, nargs="+", default=[10, 30, 100, 300, 1000])
    parser.add_argument("--kind", default="revolute")
    parser.add_argument("--duration", type=float, default=0.02)
    options = parser.parse_args()
    print("beams  lowering   prepare, s  run, s  steps  evaluations  us per step  MB  exponent")
    before: tuple[int, float] | None = None
    for count in options.sizes:
        scene = chain(count, kind=options.kind, duration=options.duration, output=options.duration / 4)
        began = time.perf_counter()
        run = PreparedRun(scene, complete=False)
        prepared = time.perf_counter()
        trajectory = run.trajectory()
        ended = time.perf_counter()
        cost = trajectory.solution.cost
        step = cost.seconds / cost.steps
        exponent = math.log(step / before[1]) / math.log(count / before[0]) if before else math.nan
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(
            f"{count:5}  {run.model.lowering:9}  {prepared - began:10.2f}  {ended - prepared:6.2f}  {cost.steps:5}"
            f"  {cost.evaluations:11}  {step * 1e6:11.1f}  {memory:.0f}  {exponent:.2f}",
            flush=True,
        )
        before = count, step


if __name__ == "__main__":
    print(f"tisserand {derive.__version__}")
    main()
