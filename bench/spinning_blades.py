"""The errors that monitors imply of random soft blades that spin, in few shapes, compared with six.

python bench/spinning_blades.py 0:3            (a minute each)

A clamped blade of second order on a hub that is driven with a constant speed is knocked at its tip in the plane in
which it spins. The error is that of `bench/monitors.py`, from the tangent at the root.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import derive
from derive.percentages import percent
from derive.simulation.observables.beams import function_values, shape_functions
from derive.simulation.trajectory import Trajectory
from derive.simulation.validity.beam_line import places
from derive.simulation.validity.bending_planes import bending_planes

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from corpus.draws import Draws

FEW, MANY = (2, 3, 4), 6


def blade(seed: int, shapes: int) -> tuple[Trajectory, np.ndarray]:
    """The motion of the blade of a seed in some shapes, and its deflections (n, places)."""
    draws = Draws(f"blade {seed}")
    stiffness, spin, radius = draws.scale(1, 12), draws.between(10, 45), draws.between(0.0, 0.5)
    width = draws.scale(0.01, 0.06)
    rod = {
        "length": 1,
        "mass": 1,
        "bending_stiffness": stiffness,
        "ansatz": [f"xi^{power}" for power in range(shapes + 2)],
        "frame": {"kind": "tangent", "at": -1},
        "order": 2,
        "markers": {"left": -1, "right": 1},
    }
    hub = {"mass": 1, "inertia": 1, "centre": [0, 0], "markers": {"o": [0, 0], "root": [radius, 0]}}
    knock = f"exp(-((t - {3 * width:.4g})/{width:.4g})^2)"
    scene = derive.scene(
        "blade",
        ground={"o": (0, 0)},
        bodies={"hub": hub, "rod": rod},
        joints={
            "bearing": {"kind": "revolute", "between": ["ground.o", "hub.o"]},
            "root": {"kind": "fixed", "between": ["hub.root", "rod.left"]},
        },
        drives={"speed": {"joint": "bearing", "speed": spin}},
        forces={"knock": {"at": "rod.right", "frame": "body", "components": [0, f"{spin**2 / 2000:.4g}*{knock}"]}},
    )
    run = derive.simulate(scene, duration=float(f"{draws.between(0.3, 1):.3g}"), output=0.002)
    (planar,) = bending_planes(run.motion.scene)
    amplitudes = run.motion.q[:, planar.amplitudes_in(run.motion.native, "rod")]
    return run, amplitudes @ np.array([function_values(f, places()) for f in shape_functions(planar.beam)])


def main() -> None:
    known = []
    for seed in range(*map(int, sys.argv[1].split(":"))):
        _, exact = blade(seed, MANY)
        for shapes in FEW:
            run, own = blade(seed, shapes)
            error = np.sqrt(((own - exact) ** 2).mean(axis=0)).max() / np.abs(exact).max()
            implied = max(monitor.error for monitor in run.validity)
            known.append((float(error), implied))
            print(f"{seed}, {shapes} shapes: {percent(known[-1][0])}, implied {percent(implied)}", flush=True)
    off = np.exp(np.abs(np.diff(np.log(np.minimum(known, 1.0)))))
    within = [percent(float(np.mean(off <= limit))) for limit in (2, 4)]
    print("within 2: {}, within 4: {} of {}".format(*within, len(known)))


if __name__ == "__main__":
    main()
