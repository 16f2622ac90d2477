"""Kinematics of a rigid slider-crank mechanism.

A drive turns the crank at constant speed, so that the mechanism has no degree of freedom left and the simulation only
follows the constraints. The position of the slider has the closed form r cos(p) + sqrt(l^2 - r^2 sin(p)^2), with the
crank angle p. The number is the largest difference, in m.
"""

import sys
from pathlib import Path

import numpy as np

import derive

CRANK, ROD, SPEED = 0.15, 0.3, 10.0


def main(folder: str | None = None) -> float:
    """Return the largest error of the slider position, m."""
    scene = derive.scene(
        "slider_crank_rigid",
        ground={"bearing": [0, 0]},
        bodies={
            "crank": {"markers": {"hub": [0, 0], "pin": [CRANK, 0]}},  # driven, so that it needs no mass
            "rod": {
                "mass": 0.5,
                "inertia": 0.004,
                "markers": {"left": [-ROD / 2, 0], "right": [ROD / 2, 0]},
                "start": {"position": [CRANK + ROD / 2, 0]},
            },
            "slider": {
                "mass": 0.2,
                "inertia": 1e-4,
                "markers": {"pin": [0, 0]},
                "start": {"position": [CRANK + ROD, 0]},
            },
        },
        joints={
            "hub": {"kind": "revolute", "between": ["ground.bearing", "crank.hub"]},
            "crank_pin": {"kind": "revolute", "between": ["crank.pin", "rod.left"]},
            "slider_pin": {"kind": "revolute", "between": ["rod.right", "slider.pin"]},
            "guide": {"kind": "translational", "between": ["ground.bearing", "slider.pin"], "axis": [1, 0]},
        },
        drives={"motor": {"joint": "hub", "speed": SPEED}},
        simulation={"duration": 1, "output": 0.005},
    )
    trajectory = derive.simulate(scene)
    angle = trajectory["motor"]
    exact = CRANK * np.cos(angle) + np.sqrt(ROD**2 - (CRANK * np.sin(angle)) ** 2)
    error = float(np.abs(trajectory["slider_s"] - exact).max())
    print(f"largest error of the slider position: {error:.2e} m")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        axes.plot(trajectory["t"], exact, color="gray", linewidth=5, alpha=0.5, label="closed form")
        axes.plot(trajectory["t"], trajectory["slider_s"], label="simulated")
        axes.set(xlabel="time, s", ylabel="position of the slider, m")
        axes.legend()
        figure.savefig(Path(folder) / "slider_crank_rigid.svg")
        plt.close(figure)
    return error


if __name__ == "__main__":
    main(*sys.argv[1:])
