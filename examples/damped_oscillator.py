"""A torsional oscillator with a spring and a damper.

A wheel on a bearing is attached to the ground by a rotational spring of 100 N m/rad and a damper of 4 N m s/rad, and
is released at an angle of 0.1 rad. The bearing leaves one coordinate, `wheel_phi`. The number is the largest
difference between the simulated angle and the closed form, in rad.
"""

import sys
from pathlib import Path

import numpy as np

import derive

INERTIA, STIFFNESS, DAMPING, RELEASE = 1.0, 100.0, 4.0, 0.1


def main(folder: str | None = None) -> float:
    """Return the largest error of the angle, rad."""
    scene = derive.scene(
        "damped_oscillator",
        ground={"bearing": [0, 0]},
        bodies={
            "wheel": {
                "mass": 1,
                "inertia": INERTIA,
                "markers": {"hub": [0, 0]},
                "start": {"angle": RELEASE},
            }
        },
        joints={"axle": {"kind": "revolute", "between": ["ground.bearing", "wheel.hub"]}},
        springs={
            "spring": {
                "kind": "rotational",
                "between": ["ground.bearing", "wheel.hub"],
                "stiffness": STIFFNESS,
                "damping": DAMPING,
            }
        },
        simulation={"duration": 2, "output": 0.01, "tolerance": 1e-11},
    )
    trajectory = derive.simulate(scene)
    t = trajectory["t"]
    decay = DAMPING / (2 * INERTIA)
    frequency = np.sqrt(STIFFNESS / INERTIA - decay**2)
    exact = RELEASE * np.exp(-decay * t) * (np.cos(frequency * t) + decay / frequency * np.sin(frequency * t))
    error = float(np.abs(trajectory["wheel_phi"] - exact).max())
    print(f"largest error of the angle: {error:.2e} rad")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        axes.plot(t, exact, color="gray", linewidth=5, alpha=0.5, label="closed form")
        axes.plot(t, trajectory["wheel_phi"], label="simulated")
        axes.set(xlabel="time, s", ylabel="angle, rad")
        axes.legend()
        figure.savefig(Path(folder) / "damped_oscillator.svg")
        plt.close(figure)
    return error


if __name__ == "__main__":
    main(*sys.argv[1:])
