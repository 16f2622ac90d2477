"""A motor that runs up smoothly: a speed as a function of the time, and the deflection of an arm as an output.

The hub of a flexible arm runs up to 1 rad/s in 5 s. Its angle is the integral of the speed in closed form, so that it
has turned by exactly 2.5 rad then. The arm, whose first mode has 35 rad/s, follows slowly: its tip lags behind by the
deflection under the inertia load m a x/l^2 of the angular acceleration a, 11/120 m a l^3/EI, a = 15/8 Omega/T in the
middle of the run-up. The numbers are the angle after it and the largest simulated deflection over this one.
"""

import sys
from pathlib import Path

import numpy as np

import derive

SPEED, TIME, STIFFNESS = 1.0, 5.0, 100.0


def main(folder: str | None = None) -> tuple[float, float]:
    """Return the angle after the run-up, and the largest deflection of the tip over that of statics."""
    scene = derive.scene(
        "motor_run_up",
        ground={"axis": [0, 0]},
        bodies={
            "hub": {"markers": {"centre": [0, 0], "rim": [0.1, 0]}},
            "arm": {
                "ansatz": ["1", "xi", "xi^2", "xi^3", "xi^4"],
                "frame": {"kind": "tangent", "at": -1},
                "mass": 1,
                "length": 1,
                "bending_stiffness": STIFFNESS,
                "markers": {"root": -1, "tip": 1},
                "start": {"position": [0.5, 0]},
            },
        },
        joints={
            "shaft": {"kind": "revolute", "between": ["ground.axis", "hub.centre"]},
            "clamp": {"kind": "weld", "between": ["hub.centre", "arm.root"]},
        },
        drives={"motor": {"joint": "shaft", "speed": f"{SPEED}*step(t, 0, {TIME})"}},
        outputs={"lag": {"kind": "deflection", "marker": "arm.tip", "chord": ["hub.centre", "hub.rim"]}},
        simulation={"duration": TIME, "output": 0.01, "tolerance": 1e-10},
    )
    trajectory = derive.simulate(scene)
    angle = float(trajectory["motor"][-1])
    ratio = -trajectory["lag"].min() / (11 / 120 * 15 / 8 * SPEED / TIME / STIFFNESS)
    print(f"after the run-up the hub has turned by {angle:.12g} rad")
    print(f"the tip lags behind by {ratio:.4f} of the deflection of statics")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots(2, sharex=True)
        axes[0].plot(trajectory["t"], np.gradient(trajectory["motor"], trajectory["t"]))
        axes[0].set(ylabel="speed of the hub, rad/s")
        axes[1].plot(trajectory["t"], -1e3 * trajectory["lag"])
        axes[1].set(xlabel="time, s", ylabel="lag of the tip, mm")
        figure.savefig(Path(folder) / "motor_run_up.svg")
        plt.close(figure)
    return angle, float(ratio)


if __name__ == "__main__":
    main(*sys.argv[1:])
