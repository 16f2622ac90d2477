"""A force of my own: the drag of the air, which grows with the square of the speed.

A force is a class that declares its keys and its virtual work at the material points that it acts on, here that of
F = -b |v| v. Once it is registered, a specification may use it. A body that falls from rest reaches the speed
V tanh(g t/V), where V = sqrt(m g/b). The number is the simulated speed over this one.
"""

import sys
from pathlib import Path

import numpy as np
import sympy

import derive
import derive.extensions

MASS, DRAG, GRAVITY, DURATION = 2.0, 0.3, 9.81, 1.5


class Drag(derive.extensions.ForceType):
    """A force against the velocity of a marker."""

    section = "forces"
    doc = "of the air, against the velocity"
    keys = (
        derive.extensions.Key(
            "drag",
            derive.extensions.KeyType.POSITIVE_QUANTITY,
            "N s^2/m^2",
            "Force over the square of the speed, N s^2/m^2.",
            required=True,
        ),
    )

    def generalised_force(self, element, points, values, rows):
        """Return the virtual work of the drag at the marker."""
        (at,) = points
        speed = sympy.sqrt(at.velocity.dot(at.velocity))
        force = -values["drag"] * speed * at.velocity
        return derive.extensions.GeneralisedForce(derive.extensions.force_terms(element.name, at, force, rows))


def main(folder: str | None = None) -> float:
    """Return the simulated speed of a falling body over the exact one."""
    if "drag" not in derive.FORCES:
        derive.FORCES.register("drag", Drag())
    scene = derive.scene(
        "own_force",
        gravity=[0, -GRAVITY],
        bodies={"ball": {"mass": MASS, "inertia": 0.1, "markers": {"centre": [0, 0]}}},
        forces={"air": {"kind": "drag", "at": "ball.centre", "drag": DRAG}},
        simulation={"duration": DURATION, "output": 0.05, "tolerance": 1e-10},
    )
    motion = derive.simulate(scene)
    speed = -motion["ball_c2dot"][-1]
    limit = np.sqrt(MASS * GRAVITY / DRAG)
    exact = limit * np.tanh(GRAVITY * DURATION / limit)
    print(f"speed {speed:.8f} m/s, exact {exact:.8f} m/s")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        axes.plot(motion["t"], limit * np.tanh(GRAVITY * motion["t"] / limit), "--", label="closed form")
        axes.plot(motion["t"], -motion["ball_c2dot"], "o", label="simulated")
        axes.axhline(limit, color="gray", linestyle=":", label="limit")
        axes.set(xlabel="time, s", ylabel="speed, m/s")
        axes.legend()
        figure.savefig(Path(folder) / "force_of_my_own.svg")
        plt.close(figure)
    return float(speed / exact)


if __name__ == "__main__":
    main(*sys.argv[1:])
