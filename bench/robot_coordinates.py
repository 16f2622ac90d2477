"""From the coordinates of Pinocchio to those of a scene: motions, and with them mass matrices and forces.

The velocities of a scene are linear in those of Pinocchio, v = B(q) w, so that its mass matrix is B^T M B there, and a
force is B^T f. Coordinates of bodies are centres, quaternions and angular velocities, those of joints their angles and
displacements; the elements of a model are found by their names, so that scenes may have either.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
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


@dataclass(frozen=True, eq=False)
class _Body:
    """A body of a scene: the prefix of its coordinates, its frame of Pinocchio, and its centre in this frame."""

    name: str
    frame: int
    centre: Array


class RobotCoordinates:
    """The map from a model of Pinocchio to a scene that has been imported from the same description.

    coordinates, velocities: the names of the elements of q and of v of the scene.
    """

    def __init__(
        self, pin: ModuleType, robot: Any, scene: SpatialScene, coordinates: Sequence[str], velocities: Sequence[str]
    ) -> None:
        self.pin, self.robot, self.data = pin, robot, robot.createData()
        self.coordinates, self.velocities = coordinates, velocities
        rigid = (body for body in scene.bodies if isinstance(body, SpatialRigidBody))
        every = [_Body(identifier(b.name), self._frame(b.name), np.array(b.centre, float)) for b in rigid]
        self.free = [body for body in every if f"{body.name}_e0" in coordinates]
        self.hinged = [body for body in every if body not in self.free]

    def _frame(self, link: str) -> int:
        return int(self.robot.getFrameId(link, self.pin.FrameType.BODY))

    def motion(self, q: Array, v: Array, a: Array) -> Motion:
        """The motion of the scene in a state of Pinocchio."""
        self.pin.forwardKinematics(self.robot, self.data, q, v, a)
        values: dict[str, float] = {}
        for body in self.hinged:
            joint = self._joint(body)
            values |= _of_joint(body.name, "", q[joint.idx_q])
            values |= _of_joint(body.name, "dot", v[joint.idx_v]) | _of_joint(body.name, "ddot", a[joint.idx_v])
        for body in self.free:
            pose, speed = self._pose(body), self.pin.getFrameVelocity(self.robot, self.data, body.frame)
            change = self.pin.getFrameAcceleration(self.robot, self.data, body.frame)
            R, w, centre = pose.rotation, speed.angular, body.centre
            at_centre = speed.linear + np.cross(w, centre)
            xddot = R @ (change.linear + np.cross(change.angular, centre) + np.cross(w, at_centre))
            values |= _of_axes(f"{body.name}_c", "", pose.translation + R @ centre)
            values |= _of_axes(f"{body.name}_e", "", Rotation.from_matrix(R).as_quat(scalar_first=True), first=0)
            values |= _of_axes(f"{body.name}_c", "dot", R @ at_centre) | _of_axes(f"{body.name}_c", "ddot", xddot)
            values |= _of_axes(f"{body.name}_omega", "", w) | _of_axes(f"{body.name}_omega", "dot", change.angular)
        return Motion(
            np.array([values[name] for name in self.coordinates]),
            np.array([values[name] for name in self.velocities]),
            np.array([values[_rate(name)] for name in self.velocities]),
        )

    def basis(self, q: Array) -> Array:
        """The matrix B of v = B(q) w."""
        self.pin.computeJointJacobians(self.robot, self.data, q)
        unit, rows = np.eye(self.robot.nv), {}
        for body in self.hinged:
            rows |= _of_joint(body.name, "dot", unit[self._joint(body).idx_v])
        for body in self.free:
            J = self.pin.getFrameJacobian(self.robot, self.data, body.frame, self.pin.ReferenceFrame.LOCAL)
            at_centre = J[:3] + np.cross(J[3:].T, body.centre).T
            rows |= _of_axes(f"{body.name}_c", "dot", self._pose(body).rotation @ at_centre)
            rows |= _of_axes(f"{body.name}_omega", "", J[3:])
        return np.array([rows[name] for name in self.velocities])

    def _joint(self, body: _Body) -> Any:
        return self.robot.joints[self.robot.frames[body.frame].parentJoint]

    def _pose(self, body: _Body) -> Any:
        """The frame of a body."""
        return self.pin.updateFramePlacement(self.robot, self.data, body.frame)

    def states(self, count: int, seed: int = 5) -> list[tuple[Array, Array, Array]]:
        """Random coordinates, velocities, and forces of all joints, of Pinocchio; none act on a free base."""
        rng, result = np.random.default_rng(seed), []
        free = [joint for joint in self.robot.joints[1:] if joint.nv == 6]
        for _ in range(count):
            w, v, tau = rng.uniform(-1.5, 1.5, (3, self.robot.nv))
            for joint in free:
                tau[joint.idx_v : joint.idx_v + 6] = 0
            result.append((self.pin.integrate(self.robot, self.pin.neutral(self.robot), w), v, tau))
        return result


def _of_joint(body: str, suffix: str, value: Any) -> dict[str, Any]:
    """A value by the names of the coordinate that a joint with one motion gives a body: an angle or a displacement."""
    return {f"{body}_phi{suffix}": value, f"{body}_s{suffix}": value}


def _of_axes(name: str, suffix: str, values: Array, first: int = 1) -> dict[str, Any]:
    """Values by the names of components."""
    return {f"{name}{i}{suffix}": value for i, value in enumerate(values, first)}


def _rate(velocity: str) -> str:
    """The name of the derivative of a velocity: that of c1dot is c1ddot, that of omega1 is omega1dot."""
    return f"{velocity.removesuffix('dot')}ddot" if velocity.endswith("dot") else f"{velocity}dot"
