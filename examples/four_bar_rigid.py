"""The rocker angle of a four-bar linkage, compared with the closed form.

The links have the lengths of scenes/four_bar.toml, but are rigid: ground 1.2 m, crank 0.4 m, coupler 1.2 m, rocker 1
m. The position of the joint between coupler and rocker is the intersection of two circles, which gives the rocker
angle in closed form. The number is the largest difference over a revolution of the crank, in rad.
"""

import sys
from pathlib import Path

import numpy as np

import derive

GROUND, CRANK, COUPLER, ROCKER, SPEED = 1.2, 0.4, 1.2, 1.0, 2 * np.pi


def rocker_angle(crank_angle: np.ndarray) -> np.ndarray:
    """Return the angle of the rocker by the intersection of two circles."""
    pin = CRANK * np.exp(1j * crank_angle)
    to_pivot = GROUND - pin
    distance = np.abs(to_pivot)
    along = (COUPLER**2 - ROCKER**2 + distance**2) / (2 * distance)
    joint = pin + to_pivot / distance * (along + 1j * np.sqrt(COUPLER**2 - along**2))
    return np.angle(joint - GROUND)


def rod(length: float, position: list[float], angle: float) -> dict:
    """Return a slender rigid rod of 1 kg with markers at both ends."""
    markers = {"left": [-length / 2, 0], "right": [length / 2, 0]}
    return {
        "mass": 1,
        "inertia": length**2 / 12,
        "markers": markers,
        "start": {"position": position, "angle": angle},
    }


def main(folder: str | None = None) -> float:
    """Return the largest error of the rocker angle, rad."""
    scene = derive.scene(
        "four_bar_rigid",
        ground={"left": [0, 0], "right": [GROUND, 0]},
        bodies={
            "crank": {"markers": {"hub": [0, 0], "pin": [CRANK, 0]}},
            "coupler": rod(COUPLER, [0.523, 0.694], 0.512),
            "rocker": rod(ROCKER, [1.123, 0.494], 1.725),
        },
        joints={
            "shaft": {"kind": "revolute", "between": ["ground.left", "crank.hub"]},
            "crank_pin": {"kind": "revolute", "between": ["crank.pin", "coupler.left"]},
            "rocker_pin": {"kind": "revolute", "between": ["coupler.right", "rocker.right"]},
            "pivot": {"kind": "revolute", "between": ["ground.right", "rocker.left"]},
        },
        drives={"motor": {"joint": "shaft", "speed": SPEED, "offset": np.pi / 2}},
        simulation={"duration": 1, "output": 0.005},
    )
    trajectory = derive.simulate(scene)
    error = float(np.abs(trajectory["rocker_phi"] - rocker_angle(trajectory["motor"])).max())
    print(f"largest error of the rocker angle: {error:.2e} rad")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        axes.plot(
            np.degrees(trajectory["motor"]), np.degrees(rocker_angle(trajectory["motor"])), "--", label="closed form"
        )
        axes.plot(
            np.degrees(trajectory["motor"][::8]), np.degrees(trajectory["rocker_phi"][::8]), "o", label="simulated"
        )
        axes.set(xlabel="crank angle, degrees", ylabel="rocker angle, degrees")
        axes.legend()
        figure.savefig(Path(folder) / "four_bar_rigid.svg")
        plt.close(figure)
    return error


if __name__ == "__main__":
    main(*sys.argv[1:])
