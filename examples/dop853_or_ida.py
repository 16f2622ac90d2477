"""DOP853 and IDA compute the same motion.

The explicit method DOP853 of SciPy integrates the accelerations and is projected onto the constraints after each step.
IDA of SUNDIALS solves the stabilised form of index 2 implicitly with the generated residual and Jacobian; it needs the
package scikit-sundae (`pip install 'tisserand[ida]'`). Both follow the crank-slider with a rod of one beam for 10 ms.
The number is the largest difference of the amplitudes, relative to their largest value.
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

import derive

SCENE = Path(__file__).parent.parent / "scenes" / "crank_slider_3.toml"


def main(folder: str | None = None) -> float:
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
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        for values, name in zip(amplitudes, ("DOP853", "IDA"), strict=True):
            axes.plot(1e3 * trajectory["t"], 1e3 * values, label=name, linestyle="--" if name == "IDA" else "-")
        axes.set(xlabel="time, ms", ylabel="first amplitude of the rod, mm")
        axes.legend()
        figure.savefig(Path(folder) / "dop853_or_ida.svg")
        plt.close(figure)
    return float(difference)


if __name__ == "__main__":
    main(*sys.argv[1:])
