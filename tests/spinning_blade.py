"""A soft blade of second order on a hub that spins, knocked at its tip in the plane in which it spins."""

from __future__ import annotations

from typing import Any

import numpy as np

import derive
from derive.runtime.native_call import Matrix
from derive.simulation.observables.beams import function_values, shape_functions
from derive.simulation.trajectory import Trajectory
from derive.simulation.validity.beam_line import places
from derive.simulation.validity.bending_planes import bending_planes

ROD: dict[str, Any] = {
    "length": 1,
    "mass": 1,
    "bending_stiffness": 2,
    "frame": {"kind": "tangent", "at": -1},
    "order": 2,
    "markers": {"left": -1, "right": 1},
}


def blade(
    shapes: int, *, stiffness: float = 2, spin: float = 40, radius: float = 0.1, knock: str = "exp(-(60*t - 3)^2)"
) -> derive.Scene:
    """A blade in some shapes with a stiffness (N m^2), on a hub with a radius (m), at an angular velocity (rad/s).

    knock: the force at the tip, N, as a function of the time t.
    """
    rod = ROD | {"bending_stiffness": stiffness, "ansatz": [f"xi^{power}" for power in range(shapes + 2)]}
    hub = {"mass": 1, "inertia": 1, "centre": [0, 0], "markers": {"o": [0, 0], "root": [radius, 0]}}
    return derive.scene(
        "blade",
        ground={"o": (0, 0)},
        bodies={"hub": hub, "rod": rod},
        joints={
            "bearing": {"kind": "revolute", "between": ["ground.o", "hub.o"]},
            "root": {"kind": "fixed", "between": ["hub.root", "rod.left"]},
        },
        drives={"speed": {"joint": "bearing", "speed": spin}},
        forces={"knock": {"at": "rod.right", "frame": "body", "components": [0, knock]}},
    )


def deflections(run: Trajectory) -> Matrix:
    """The deflections (n, places) of the blade from the tangent at its root, m."""
    (planar,) = bending_planes(run.motion.scene)
    amplitudes = run.motion.q[:, planar.amplitudes_in(run.motion.native, "rod")]
    return np.asarray(amplitudes @ [function_values(f, places()) for f in shape_functions(planar.beam)])


def error_of(run: Trajectory, exact: Trajectory) -> float:
    """The error of the deflections, root mean square over the run, over their peak."""
    own, known = deflections(run), deflections(exact)
    return float(np.sqrt(((own - known) ** 2).mean(axis=0)).max() / np.abs(known).max())
