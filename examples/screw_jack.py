"""A screw jack in space: a motor lifts a table by a bevel gear and a thread, compared with the closed form.

The axis of the motor is along e1, that of the wheel and of its thread along e3, and the table slides along e3. With the
ratio r of the gear and the pitch p of the thread, the height is h a for the angle a of the motor, h = p |r|/(2 pi), and
the acceleration of the motor under a constant torque M is (M - m g h)/(J_1 + r^2 J_2 + m h^2). Angles count all turns.
The number is the largest error of the height, in m; the motor turns more than a dozen times.
"""

import sys
from pathlib import Path

import numpy as np

import derive

TORQUE, RATIO, PITCH, MASS, GRAVITY = 0.1, -1 / 3, 0.005, 20.0, 9.81
MOTOR, WHEEL = 1e-5, 2e-3


def main(folder: str | None = None) -> float:
    """Return the largest error of the height of the table, m."""
    along_e1 = {"z": [1, 0, 0], "x": [0, 1, 0]}
    scene = derive.spatial_scene(
        "screw_jack",
        gravity=[0, 0, -GRAVITY],
        ground={"motor": {"at": [0.06, 0, 0.04], "rotation": along_e1}, "post": [0, 0, 0]},
        bodies={
            "pinion": {
                "mass": 0.1,
                "inertia": [MOTOR, MOTOR, MOTOR, 0, 0, 0],
                "markers": {"hub": {"at": [0, 0, 0], "rotation": along_e1}},
            },
            "wheel": {"mass": 1, "inertia": [1e-3, 1e-3, WHEEL, 0, 0, 0], "markers": {"hub": [0, 0, 0]}},
            "table": {"mass": MASS, "inertia": [0.1, 0.1, 0.1, 0, 0, 0], "markers": {"nut": [0, 0, 0]}},
        },
        joints={
            "motor": {"kind": "revolute", "between": ["ground.motor", "pinion.hub"]},
            "bearing": {"kind": "revolute", "between": ["ground.post", "wheel.hub"]},
            "guide": {"kind": "prismatic", "between": ["ground.post", "table.nut"]},
            "thread": {"kind": "screw", "pitch": PITCH, "between": ["wheel.hub", "table.nut"]},
        },
        gears={"bevel": {"joints": ["motor", "bearing"], "ratio": "-1/3"}},
        torques={"motor": {"on": "pinion.hub", "torque": [TORQUE, 0, 0]}},
        outputs={"height": {"kind": "joint", "joint": "guide"}},
        simulation={"duration": 1, "output": 0.01},
    )
    trajectory = derive.simulate(scene)
    lift = PITCH * abs(RATIO) / (2 * np.pi)
    acceleration = (TORQUE - MASS * GRAVITY * lift) / (MOTOR + RATIO**2 * WHEEL + MASS * lift**2)
    error = float(np.abs(trajectory["height"] - lift * acceleration * trajectory.t**2 / 2).max())
    print(f"turns of the motor: {acceleration / 2 / (2 * np.pi):.1f}; largest error of the height: {error:.1e} m")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        axes.plot(trajectory.t, 1e3 * lift * acceleration * trajectory.t**2 / 2, "--", label="closed form")
        axes.plot(trajectory.t[::5], 1e3 * trajectory["height"][::5], "o", label="simulated")
        axes.set(xlabel="time, s", ylabel="height of the table, mm")
        axes.legend()
        figure.savefig(Path(folder) / "screw_jack.svg")
        plt.close(figure)
    return error


if __name__ == "__main__":
    main(*sys.argv[1:])
