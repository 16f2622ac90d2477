"""The time of a sweep of 10 000 revolutions of the crank-slider, with one beam and a tolerance of 1e-6.

python bench/sweep.py [--side 100] [--workers 2] [--random]

The bending stiffness and the mass of the slider vary on a grid of side x side values, at a constant speed, so that each
run is one revolution; the output is the peak of the deflection in 200 rows. With --random the speed varies as well, so
that each sample has an initial state of its own; runs then last as long as a revolution at the mean speed. The time is
that of the command from its start to its end, in a process of its own and after another one that has compiled the
model: imports, plan, workers, runs, tables and picture.
"""

from __future__ import annotations

import argparse
import math
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from machine import described

SCENE = Path(__file__).parent.parent / "scenes" / "crank_slider_3.toml"
SPEED, ROWS = 150, 200


def command(side: int, workers: int, random: bool, folder: str) -> list[str]:
    """The command of a sweep with side x side samples."""
    revolution = 2 * math.pi / SPEED
    names = ["bodies.rod.bending_stiffness", "bodies.slider.mass", "drives.motor.speed"]
    values = (
        ["uniform(8,40)", "uniform(0.02,0.05)", "uniform(100,200)"]
        if random
        else [f"8:40:{side}", f"0.02:0.05:{side}", str(SPEED)]
    )
    sets = [f"--set={name}={value}" for name, value in zip(names, values, strict=True)]
    drawn = [f"--samples={side * side}"] if random else []
    times = [f"--duration={revolution!r}", f"--interval={revolution / ROWS!r}", "--tolerance=1e-6"]
    given = ["--set=bodies.rod.pieces=1", *sets, *drawn, *times, "--output=peak", f"--workers={workers}"]
    return [sys.executable, "-m", "derive", "sweep", str(SCENE), *given, "--out", folder]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--side", type=int, default=100)
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument("--random", action="store_true")
    options = parser.parse_args()
    print("\n".join(described("scipy", "numpy")))
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(command(2, options.workers, options.random, folder), check=True, capture_output=True)
        before, load = time.perf_counter(), os.getloadavg()[0]
        done = subprocess.run(
            command(options.side, options.workers, options.random, folder), check=True, capture_output=True, text=True
        )
        seconds = time.perf_counter() - before
    print(f"load      {load:.2f} processes before\n")
    print(done.stdout.rsplit("\n\n", 1)[0])
    print(f"\n{options.side**2} samples, {options.workers} workers: {seconds:.2f} s")


if __name__ == "__main__":
    main()
