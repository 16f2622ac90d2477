"""MuJoCo as a peer of generated C: its C library in the timed program, and its coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from timed_program import Program

Array = NDArray[np.float64]

SOURCE = Path(__file__).with_suffix(".c")
DECLARED = (
    "int mujoco_load(const char *); void mujoco_mass(const double *, double *);\n"
    "void mujoco_forward(const double *, const double *, const double *, double *);\n"
    "void mujoco_inverse(const double *, const double *, const double *, double *);"
)


class MujocoPeer:
    """The model that MuJoCo makes of a URDF, and the maps of states of Pinocchio to its own.

    refused: why it reads none; empty if it does.
    """

    def __init__(self, description: Path, robot: Any) -> None:
        self.description, self.robot, self.refused = description, robot, ""
        if not find_spec("mujoco"):
            self.refused = "it is not installed"
            return
        import mujoco

        try:
            self.model = mujoco.MjModel.from_xml_path(str(description))
        except ValueError as error:
            self.refused = " ".join(str(error).split())
            return
        self.joints = []  # of Pinocchio with the addresses in q and v of MuJoCo
        for name, joint in list(zip(robot.names, robot.joints, strict=True))[1:]:  # without the universe
            own = self.model.joint(name)
            self.joints.append((joint, int(own.qposadr[0]), int(own.dofadr[0])))

    def add_to(self, program: Program) -> None:
        """Add its functions, its library and its model to a timed program."""
        found = find_spec("mujoco")
        assert found and found.origin
        package = Path(found.origin).parent
        (library,) = package.glob("libmujoco.so.*")
        program.compile(SOURCE, f"-I{package / 'include'}", "mujoco_peer")
        program.libraries += [str(library), f"-Wl,-rpath,{package}"]
        program.declare.append(DECLARED)
        program.once.append(f'if (mujoco_load("{self.description.resolve()}")) return 7;')

    def coordinates(self, q: Array) -> Array:
        """Coordinates: quaternions of MuJoCo have the scalar first."""
        result = np.zeros(self.model.nq)
        for joint, at, _ in self.joints:
            values = q[joint.idx_q : joint.idx_q + joint.nq]
            result[at : at + joint.nq] = values[[0, 1, 2, 6, 3, 4, 5]] if joint.nq == 7 else values
        return result

    def basis(self, q: Array) -> Array:
        """The matrix by which its velocities follow from those of Pinocchio: linear ones are inertial."""
        result = np.zeros((self.model.nv, self.robot.nv))
        for joint, _, at in self.joints:
            block = np.eye(joint.nv)
            if joint.nv == 6:
                block[:3, :3] = rotation(q[joint.idx_q + 3 : joint.idx_q + 7])
            result[at : at + joint.nv, joint.idx_v : joint.idx_v + joint.nv] = block
        return result

    def bias(self, q: Array, v: Array) -> Array:
        """Its accelerations where those of Pinocchio vanish: those of axes that turn."""
        result = np.zeros(self.model.nv)
        for joint, _, at in self.joints:
            if joint.nv == 6:
                linear, angular = np.split(v[joint.idx_v : joint.idx_v + 6], 2)
                result[at : at + 3] = rotation(q[joint.idx_q + 3 : joint.idx_q + 7]) @ np.cross(angular, linear)
        return result


def rotation(quaternion: Sequence[float] | Array) -> Array:
    """The rotation matrix of a unit quaternion with the scalar last."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_quat(quaternion).as_matrix())
