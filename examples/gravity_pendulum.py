"""The period of a pendulum with a large amplitude.

A uniform rod swings from the horizontal. The exact period is 4 sqrt(2 l/(3 g)) K(m), with the complete elliptic
integral K and m = sin^2(amplitude/2) = 1/2. The number is the simulated period over the exact one.
"""

import sys
from pathlib import Path

import numpy as np
import scipy.interpolate
import scipy.special

import derive


def main(folder: str | None = None) -> float:
    """Return the simulated period over the exact one."""
    scene = derive.scene(
        "gravity_pendulum",
        ground={"hook": [0, 0]},
        gravity=[0, -9.81],
        bodies={
            "rod": {
                "mass": 2,
                "inertia": 2 / 12,
                "markers": {"top": [-0.5, 0], "tip": [0.5, 0]},
                "start": {"position": [0.5, 0]},
            }
        },
        joints={"hinge": {"kind": "revolute", "between": ["ground.hook", "rod.top"]}},
        simulation={"duration": 4, "output": 0.01, "tolerance": 1e-11},
    )
    trajectory = derive.simulate(scene)
    swing = scipy.interpolate.CubicSpline(trajectory["t"], trajectory["rod_phi"] + np.pi / 2)
    crossings = swing.roots(extrapolate=False)  # the rod hangs vertically twice in a period
    period = 2 * float(np.diff(crossings).mean())
    exact = 4 * np.sqrt(2 / (3 * 9.81)) * scipy.special.ellipk(0.5)
    print(f"period {period:.8f} s, exact {exact:.8f} s")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        axes.plot(trajectory["t"], np.degrees(trajectory["rod_phi"]) + 90)
        axes.axvline(exact, color="gray", linestyle="--", label="exact period")
        axes.set(xlabel="time, s", ylabel="angle from the vertical, degrees")
        axes.legend()
        figure.savefig(Path(folder) / "gravity_pendulum.svg")
        plt.close(figure)
    return float(period / exact)


if __name__ == "__main__":
    main(*sys.argv[1:])
