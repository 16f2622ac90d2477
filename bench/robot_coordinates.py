"""From the coordinates of Pinocchio to those of a scene: motions, and with them mass matrices and forces.

The velocities of a scene are linear in those of Pinocchio, v = B(q) w, so that its mass matrix is B^T M B there, and a
force is B^T f. Coordinates of bodies are centres, quaternions and angular velocities, those of joints their angles and
displacements; the elements of a model are found by their names, so that scenes may have either.
"""

from __future__ import annotations

from collections.abc import Sequence
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from derive.spec.model.instances import identifier
from derive.spec.model.spatial_bodies import SpatialRigidBody
from derive.spec.model.spatial_scene import SpatialScene

Array = NDArray[np.float64]


class Motion(NamedTuple):
    """Coordinates, velocities and accelerations."""

    q: Array
    v: Array
    vdot: Array


class RobotCoordinates:
    """The map from a model of Pinocchio to a scene that has been imported from the same description.

    coordinates, velocities: the names of the elements of q and of v of the scene.
    """

    def __init__(
        self, pin: ModuleType, robot: Any, scene: SpatialScene, coordinates: Sequence[str], velocities: Sequence[str]
    ) -> None:
        self.pin, self.robot, self.data = pin, robot, robot.createData()
        self.coordinates, self.velocities = coordinates, velocities
        self.bodies = [body for body in scene.bodies if isinstance(body, SpatialRigidBody)]

    def motion(self, q: Array, v: Array, a: Array) -> Motion:
        """The motion of the scene in a state of Pinocchio."""
        self.pin.forwardKinematics(self.robot, self.data, q, v, a)
        places: dict[str, float] = {}
        speeds: dict[str, float] = {}
        rates: dict[str, float] = {}
        for body in self.bodies:
            name = identifier(body.name)
            frame = self.robot.frames[self.robot.getFrameId(body.name, self.pin.FrameType.BODY)]
            joint = self.robot.joints[frame.parentJoint]
            if joint.nv == 1:
                value = q[joint.idx_q] if joint.nq == 1 else np.arctan2(q[joint.idx_q + 1], q[joint.idx_q])
                for coordinate in (f"{name}_phi", f"{name}_s"):
                    places[coordinate] = value
                    speeds[f"{coordinate}dot"], rates[f"{coordinate}dot"] = v[joint.idx_v], a[joint.idx_v]
            centre = np.array(body.centre, float)
            pose = self.data.oMi[frame.parentJoint] * frame.placement
            R, speed = pose.rotation, frame.placement.actInv(self.data.v[frame.parentJoint])
            change, w = frame.placement.actInv(self.data.a[frame.parentJoint]), speed.angular
            at_centre = speed.linear + np.cross(w, centre)
            xddot = R @ (change.linear + np.cross(change.angular, centre) + np.cross(w, at_centre))
            places |= _named(name, "c", pose.translation + R @ centre)
            places |= _named(name, "e", Rotation.from_matrix(R).as_quat(scalar_first=True), first=0)
            speeds |= _named(name, "c", R @ at_centre, "dot") | _named(name, "omega", w)
            rates |= _named(name, "c", xddot, "dot") | _named(name, "omega", change.angular)
        return Motion(
            np.array([places[name] for name in self.coordinates]),
            np.array([speeds[name] for name in self.velocities]),
            np.array([rates[name] for name in self.velocities]),
        )

    def basis(self, q: Array) -> Array:
        """The matrix B of v = B(q) w."""
        none = np.zeros(self.robot.nv)
        return np.column_stack([self.motion(q, unit, none).v for unit in np.eye(self.robot.nv)])

    def states(self, count: int, seed: int = 5) -> list[tuple[Array, Array, Array]]:
        """Random coordinates, velocities, and forces of all joints, of Pinocchio; none act on a free base."""
        rng, result = np.random.default_rng(seed), []
        free = [joint for joint in self.robot.joints if joint.nv == 6]
        for _ in range(count):
            w, v, tau = rng.uniform(-1.5, 1.5, (3, self.robot.nv))
            for joint in free:
                tau[joint.idx_v : joint.idx_v + 6] = 0
            result.append((self.pin.integrate(self.robot, self.pin.neutral(self.robot), w), v, tau))
        return result


def _named(body: str, family: str, values: Array, suffix: str = "", first: int = 1) -> dict[str, float]:
    """Values by the names of the elements of a body."""
    return {f"{body}_{family}{i}{suffix}": float(value) for i, value in enumerate(values, first)}
