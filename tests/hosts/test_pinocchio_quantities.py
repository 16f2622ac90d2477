"""Inverse dynamics, gravity, centre of mass, centroidal momentum and rotations of robots are those of Pinocchio."""

from __future__ import annotations

from functools import cache
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from pinocchio_models import Array, PinocchioModel, pinocchio_model
from programs import package
from test_urdf import robot_file, written

import derive
from conftest import QUICK
from derive.backends.model_files import explicit_files
from derive.spec.toml.read import parse

pytestmark = pytest.mark.hosts

LIMIT = 1e-11
"""The largest difference, relative to the largest number."""
ROBOTS = {
    "ur5": ("ur_description/urdf/ur5_robot.urdf", "fixed"),
    "solo12": ("solo_description/robots/solo12.urdf", "free"),
}


@pytest.fixture(scope="module")
def pin() -> ModuleType:
    return package("pinocchio")


class Robot:
    """A robot with all functions, in coordinates of its joints or absolute ones, and in Pinocchio."""

    def __init__(self, pin: ModuleType, name: str, coordinates: str) -> None:
        path, base = ROBOTS[name]
        text = written(robot_file(path), base)
        if coordinates == "absolute":
            text = text.replace('coordinates = "relative"\n', "")
            text = text.replace("\nmass = ", "\nkeep_coordinates = true\nmass = ")
        spec = parse(text)
        model = derive.lower(derive.derive(spec), explicit=True, functions="all")
        self.native = derive.load_scene(explicit_files(model, spec), QUICK)
        self.other: PinocchioModel = pinocchio_model(pin, text)
        self.pin, self.model, self.data = pin, self.other.model, self.other.model.createData()
        self.rng, self.k = np.random.default_rng(3), self.native.setup()

    def state(self) -> tuple[Array, Array, Array]:
        """A random state and accelerations of Pinocchio."""
        v, a, w = self.rng.uniform(-1.5, 1.5, (3, self.model.nv))
        return self.pin.integrate(self.model, self.pin.neutral(self.model), w), v, a

    def own(self, q: Array, v: Array, a: Array) -> tuple[Array, Array, Array]:
        """The coordinates, velocities and accelerations of the scene: of bodies and of joints, in its order."""
        self.pin.forwardKinematics(self.model, self.data, q, v, a)
        motions, result = self.other.motions(self.data), list[tuple[Array, Array, Array]]()
        for name in self.native.coordinates:
            if name.endswith("_c1"):
                result.append(motions[name.removesuffix("_c1")])
            elif name.endswith("_phi"):
                joint = self.model.joints[self.other.joints[name.removesuffix("_phi")]]
                result.append((q[[joint.idx_q]], v[[joint.idx_v]], a[[joint.idx_v]]))
        Q, V, A = (np.concatenate([part[i] for part in result]) for i in range(3))
        assert len(Q) == self.native.nq and len(V) == self.native.nv
        return Q, V, A

    def velocities(self, q: Array) -> Array:
        """The velocities of the scene by those of Pinocchio (nv, nv)."""
        n = self.model.nv
        return np.column_stack([self.own(q, np.eye(n)[j], np.zeros(n))[1] for j in range(n)])


def close(a: Any, b: Any) -> None:
    assert np.abs(np.asarray(a) - b).max() <= LIMIT * max(1.0, np.abs(b).max())


@cache
def made(pin: ModuleType, name: str, coordinates: str) -> Robot:
    return Robot(pin, name, coordinates)


CASES = [
    ("ur5", "absolute"),
    ("ur5", "relative"),
    pytest.param(("solo12", "relative"), marks=pytest.mark.long),
    pytest.param(("solo12", "absolute"), marks=pytest.mark.long),
]


@pytest.fixture(params=CASES, ids="-".join)
def robot(request: pytest.FixtureRequest, pin: ModuleType) -> Robot:
    return made(pin, *request.param)


def test_forces_are_those_of_the_recursive_algorithm(robot: Robot) -> None:
    """The virtual work of M vdot + h on the motions of the joints: rnea, and the gravity torques."""
    q, v, a = robot.state()
    Q, V, A = robot.own(q, v, a)
    turning = robot.velocities(q)
    torques = robot.pin.rnea(robot.model, robot.data, q, v, a)
    close(turning.T @ robot.native.inverse_dynamics(0.0, Q, V, A, robot.k), torques)
    gravity = robot.pin.computeGeneralizedGravity(robot.model, robot.data, q)
    close(turning.T @ robot.native.gravity_compensation(0.0, Q, robot.k), gravity)


def test_centre_of_mass_and_momentum(robot: Robot) -> None:
    q, v, a = robot.state()
    Q, V, _ = robot.own(q, v, a)
    x, xdot, jacobian, mass = robot.native.centre_of_mass(Q, V, robot.k)
    momentum, A = robot.native.centroidal_momentum(Q, V, robot.k)
    turning = robot.velocities(q)
    robot.pin.ccrba(robot.model, robot.data, q, v)
    close(momentum, robot.data.hg.vector)
    close(robot.native.patterns["centroidal_momentum"].dense(A) @ turning, robot.data.Ag)
    robot.pin.centerOfMass(robot.model, robot.data, q, v)
    close(x, robot.data.com[0])
    close(xdot, robot.data.vcom[0])
    close(mass, robot.pin.computeTotalMass(robot.model))
    velocity = robot.native.patterns["centre_of_mass"].dense(jacobian)
    close(velocity @ turning, robot.pin.jacobianCenterOfMass(robot.model, robot.data, q))


def test_rotations_of_markers(robot: Robot) -> None:
    q, v, a = robot.state()
    Q, V, _ = robot.own(q, v, a)
    turning = robot.velocities(q)
    robot.pin.computeJointJacobians(robot.model, robot.data, q)
    for body, table in robot.other.scene["bodies"].items():
        for marker in table.get("markers", {}):
            name = f"{body}_{marker}"
            omega, jacobian = robot.native.rotation(name, Q, V, robot.k)
            own = robot.native.patterns[f"rotation_{name}"].dense(jacobian)
            frame = robot.pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
            theirs = robot.pin.getJointJacobian(robot.model, robot.data, robot.other.joints[body], frame)[3:]
            close(own @ turning, theirs)
            close(omega, theirs @ v)


def test_inputs_of_joints_are_their_torques(robot: Robot) -> None:
    """The inputs with which all bodies have the accelerations of `aba` are the torques that it was given."""
    q, v, _ = robot.state()
    driven = len(robot.native.inputs)
    torques = np.concatenate(
        [np.zeros(robot.model.nv - driven), robot.rng.uniform(-5, 5, driven)]
    )  # none on a free base
    accelerations = robot.pin.aba(robot.model, robot.data, q, v, torques).copy()
    Q, V, A = robot.own(q, v, accelerations)
    forces = derive.inverse_dynamics(robot.native, 0.0, Q, V, A, robot.k)
    assert not forces.undetermined
    close(list(forces.inputs.values()), torques[-driven:])
    held = np.where([name.endswith("c1dot") for name in robot.native.velocities], np.nan, A)
    close(derive.inverse_dynamics(robot.native, 0.0, Q, V, held, robot.k).vdot, A)
