"""A joint of my own: a rod without mass, which keeps the distance of two markers.

A joint is a class that declares the relative motions that it removes, here g = (d . d - L^2) / (2 L) of the
displacement d between its markers, with the keys that they depend on. Once it is registered, a specification may use
it. A body on such a rod is a mathematical pendulum. The number is its period over the exact one,
4 sqrt(L/g) K(sin^2(amplitude/2)).
"""

import sys
from pathlib import Path

import numpy as np
import scipy.interpolate
import scipy.special

import derive
import derive.extensions as ext

AMPLITUDE, LENGTH, GRAVITY = 1.0, 0.5, 9.81
KEY = ext.Key("distance", ext.KeyType.POSITIVE_QUANTITY, "m", "The distance, m.", required=True)


def elongation(joint, displacement, rotation):
    """Return g of the displacement (2, 1) between the markers; its time derivatives follow."""
    length = joint.values["distance"]
    return (displacement.dot(displacement) - length**2) / (2 * length)


class Distance(ext.JointType):
    """A rod without mass."""

    doc = "the distance of the markers is constant"
    removes = (ext.RelativeRow("tension", "{markers} keep their distance", "m", elongation, (KEY,)),)
    drawing = ext.Drawing(lines=(((-1, -2), (1, 2)),))


def main(folder: str | None = None) -> float:
    """Return the simulated period over the exact one."""
    if "distance" not in derive.JOINTS:
        derive.JOINTS.register("distance", Distance())
    start = [LENGTH * np.sin(AMPLITUDE), -LENGTH * np.cos(AMPLITUDE)]
    scene = derive.scene(
        "own_joint",
        ground={"pivot": [0, 0]},
        gravity=[0, -GRAVITY],
        bodies={"bob": {"mass": 2, "inertia": 0.1, "markers": {"centre": [0, 0]}, "start": {"position": start}}},
        joints={"rod": {"kind": "distance", "between": ["ground.pivot", "bob.centre"], "distance": LENGTH}},
        simulation={"duration": 5, "output": 0.01, "tolerance": 1e-10},
    )
    trajectory = derive.simulate(scene)
    swing = scipy.interpolate.CubicSpline(trajectory["t"], trajectory["bob_c1"])
    crossings = swing.roots(extrapolate=False)  # the body is below the pivot twice in a period
    period = 2 * float(np.diff(crossings).mean())
    exact = 4 * np.sqrt(LENGTH / GRAVITY) * scipy.special.ellipk(np.sin(AMPLITUDE / 2) ** 2)
    print(f"period {period:.8f} s, exact {exact:.8f} s")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        axes.plot(trajectory["t"], trajectory["bob_c1"])
        axes.axvline(exact, color="gray", linestyle="--", label="exact period")
        axes.set(xlabel="time, s", ylabel="horizontal position, m")
        axes.legend()
        figure.savefig(Path(folder) / "joint_of_my_own.svg")
        plt.close(figure)
    return float(period / exact)


if __name__ == "__main__":
    main(*sys.argv[1:])
