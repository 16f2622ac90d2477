"""DOP853 and IDA compute the same motion.

The explicit method DOP853 of SciPy integrates the accelerations and is projected onto the constraints after each step.
IDA of SUNDIALS solves the stabilised form of index 2 implicitly with the generated residual and Jacobian; it needs the
package scikit-sundae (`pip install 'tisserand[ida]'`). Both follow the crank-slider with a rod of one beam for 10 ms.
The number is the largest difference of the amplitudes, relative to their largest value.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

import derive

SCENE = Path(__file__).parent.parent / "scenes" / "crank_slider_3.toml"


def main() -> float:
    """Return the largest relative difference of the amplitudes."""
    scene = derive.read(SCENE)
    crank, rod, slider = scene.bodies
    scene = replace(scene, bodies=(crank, replace(rod, pieces=1), slider), plots=())
    amplitudes = []
    for integrator in ("dop853", "ida"):
        trajectory = derive.simulate(scene, duration=0.01, tolerance=1e-8, integrator=integrator)
        amplitudes.append(trajectory["rod_alpha1"])
        cost = trajectory.solution.cost
        print(f"{integrator}: {cost.steps} steps, {cost.evaluations} evaluations")
    difference = np.abs(amplitudes[0] - amplitudes[1]).max() / np.abs(amplitudes[0]).max()
    return float(difference)


if __name__ == "__main__":
    main()
