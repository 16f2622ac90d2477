"""The errors that monitors imply of random soft blades that spin, in few shapes, compared with six.

python bench/spinning_blades.py 0:3            (a minute each)

A clamped blade of second order on a hub that is driven with a constant speed is knocked at its tip in the plane in
which it spins. The error is that of `bench/monitors.py`, from the tangent at the root.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import derive
from derive.percentages import percent
from derive.simulation.trajectory import Trajectory

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from corpus.draws import Draws
from spinning_blade import blade, error_of

FEW, MANY = (2, 3, 4), 6


def run(seed: int, shapes: int) -> Trajectory:
    """The motion of the blade of a seed in some shapes."""
    draws = Draws(f"blade {seed}")
    stiffness, spin, radius = draws.scale(1, 12), draws.between(10, 45), draws.between(0.0, 0.5)
    width = draws.scale(0.01, 0.06)
    knock = f"{spin**2 / 2000:.4g}*exp(-((t - {3 * width:.4g})/{width:.4g})^2)"
    scene = blade(shapes, stiffness=stiffness, spin=spin, radius=radius, knock=knock)
    return derive.simulate(scene, duration=float(f"{draws.between(0.3, 1):.3g}"), output=0.002)


def main() -> None:
    known = []
    for seed in range(*map(int, sys.argv[1].split(":"))):
        exact = run(seed, MANY)
        for shapes in FEW:
            few = run(seed, shapes)
            implied = max(monitor.error for monitor in few.validity)
            known.append((error_of(few, exact), implied))
            print(f"{seed}, {shapes} shapes: {percent(known[-1][0])}, implied {percent(implied)}", flush=True)
    off = np.exp(np.abs(np.diff(np.log(np.minimum(known, 1.0)))))
    within = [percent(float(np.mean(off <= limit))) for limit in (2, 4)]
    print("within 2: {}, within 4: {} of {}".format(*within, len(known)))


if __name__ == "__main__":
    main()
