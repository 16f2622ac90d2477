"""A rigid body that tumbles through every attitude: its quaternion, and angles that would lock.

With angles of yaw, pitch and roll the angular velocity is E times their rates, with det E = cos(pitch) and the
condition number sqrt((1 + |sin(pitch)|) / (1 - |sin(pitch)|)): at a pitch of 90 degrees, gimbal lock, two of them have
one axis. The rates of a unit quaternion are Z omega with three singular values of 1/2 in every attitude.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from derive.generated_models import generated
from derive.roles import Role
from derive.runtime.compiler import RUN_FLAGS
from derive.runtime.integrators.adaptive import Adaptive
from derive.runtime.loading import load
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.spec.construction.bodies import nodal_body

CORNERS = np.array(list(product((-0.15, 0.15), (-0.1, 0.1), (-0.05, 0.05))))
"""The corners of a block, m, each of 0.25 kg."""
SPIN = (0.01, 5.0, 0.01)
"""The angular velocity at the start, rad/s, almost about the axis of the intermediate moment of inertia: the pitch
passes 90 degrees, and the block flips later."""
TURNS, ROWS = 10, 2001
TOLERANCE = 1e-10


@dataclass(frozen=True, eq=False)
class Tumble:
    """A tumbling block over ten turns, in rows (n,): t in s, the pitch (rad), the condition numbers of the kinematics
    with angles and with a quaternion; and the largest relative changes of energy and angular momentum."""

    t: Vector
    pitch: Vector
    angles: Vector
    quaternion: Vector
    energy: float
    momentum: float


def tumble() -> Tumble:
    """The block spins about an axis that is first horizontal. Raises CompilerError."""
    nodes = {"positions": CORNERS, "mass": np.full(len(CORNERS), 0.25)}
    spec = nodal_body("tumbling_block", nodes, units="SI", frame="given", modes=0)
    native = load(generated(spec)[1], RUN_FLAGS)
    k = native.setup()
    q, v = np.array([0, 0, 0, 1.0, 0, 0, 0]), np.array([0, 0, 0, *SPIN])
    times = np.linspace(0.0, TURNS * 2 * np.pi / SPIN[1], ROWS)
    run = Adaptive(native).run(q, v, times, rtol=TOLERANCE, k=k)
    e0, e1, e2, e3 = run.q[:, [role is Role.QUATERNION for role in native.roles]].T
    sine = np.clip(np.abs(2 * (e0 * e2 - e1 * e3)), 0.0, 1.0)
    energy = np.array([native.energy(*row, k).sum() for row in zip(run.q, run.v, strict=True)])
    momentum = np.array([native.momentum(*row, k)[3:] for row in zip(run.q, run.v, strict=True)])
    with np.errstate(divide="ignore"):
        angles = np.sqrt((1 + sine) / (1 - sine))
    return Tumble(
        run.t,
        np.arcsin(np.clip(2 * (e0 * e2 - e1 * e3), -1.0, 1.0)),
        angles,
        np.array([_condition(native, row, k) for row in run.q]),
        float(np.abs(energy / energy[0] - 1).max()),
        float(np.linalg.norm(momentum - momentum[0], axis=1).max() / np.linalg.norm(momentum[0])),
    )


def _condition(native: NativeScene, q: Vector, k: Vector) -> float:
    """The condition number of the rates of the quaternion as a function of the angular velocity."""
    rotation = np.array([role is Role.QUATERNION for role in native.roles])
    columns = [native.rates(q, unit, k)[rotation] for unit in np.eye(native.nv)[3:6]]
    return float(np.linalg.cond(np.column_stack(columns)))
