"""The reaction in the joint of a pendulum.

The multipliers of a joint are the force that it exerts on its second body. A rigid body on the ground has only the
coordinates that its joint leaves, and no multipliers; `keep_coordinates` restores both. A uniform rod that is released
from the horizontal pulls at its hinge with 5/2 of its weight when it passes the vertical. The number is this ratio.
"""

import sys
from pathlib import Path

import numpy as np
import scipy.interpolate

import derive

MASS, GRAVITY = 2.0, 9.81


def main(folder: str | None = None) -> float:
    """Return the largest vertical reaction over the weight."""
    scene = derive.scene(
        "pendulum_reaction",
        ground={"hook": [0, 0]},
        gravity=[0, -GRAVITY],
        bodies={
            "rod": {
                "mass": MASS,
                "inertia": MASS / 12,
                "markers": {"top": [-0.5, 0], "tip": [0.5, 0]},
                "start": {"position": [0.5, 0]},
                "keep_coordinates": True,
            }
        },
        joints={"hinge": {"kind": "revolute", "between": ["ground.hook", "rod.top"]}},
        simulation={"duration": 1, "output": 0.005, "tolerance": 1e-11},
    )
    trajectory = derive.simulate(scene)
    reaction = scipy.interpolate.CubicSpline(trajectory["t"], trajectory["lambda_hinge_2"])
    largest = float(np.max(reaction(reaction.derivative().roots(extrapolate=False))))
    print(f"largest vertical reaction {largest:.6f} N, weight {MASS * GRAVITY:.6f} N")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        axes.plot(trajectory["t"], trajectory["lambda_hinge_1"] / (MASS * GRAVITY), label="horizontal")
        axes.plot(trajectory["t"], trajectory["lambda_hinge_2"] / (MASS * GRAVITY), label="vertical")
        axes.axhline(2.5, color="gray", linestyle="--", label="5/2")
        axes.set(xlabel="time, s", ylabel="reaction, of the weight")
        axes.legend()
        figure.savefig(Path(folder) / "pendulum_reaction.svg")
        plt.close(figure)
    return largest / (MASS * GRAVITY)


if __name__ == "__main__":
    main(*sys.argv[1:])
