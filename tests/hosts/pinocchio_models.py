"""Mechanisms of rigid bodies in space, as scenes in TOML and as models of Pinocchio from the tables of these.

A body of Pinocchio has the frame of the marker at which a joint connects it to its parent. The states of a scene follow
from those of Pinocchio by its kinematics: the positions of the centres, their velocities, quaternions and angular
velocities in the axes of the bodies.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

sys.path.append(str(Path(__file__).parents[1] / "space"))
from decimal_vectors import floats
from mass_points import inertia_tensor
from written_scene import Numbers, Table, rotation, tables

Array = np.ndarray
KINDS = ("revolute", "prismatic", "cylindrical", "universal", "spherical", "planar", "fixed")
"""The joints of trees that both have."""


def tree(kinds: tuple[str, ...], seed: int) -> str:
    """A scene with a body for each kind of joint, on the ground or on a body before it; `free` ones have no joint."""
    rng = np.random.default_rng(seed)

    def vector(size: float) -> list[float]:
        return np.round(rng.uniform(-size, size, 3), 3).tolist()

    def frame() -> str:
        return f"{{ at = {vector(1)}, rotation = {{ axis = {vector(1)}, angle = {rng.uniform(-3, 3):.3f} }} }}"

    lines = ['name = "tree"', f"scene.gravity = {vector(9)}", f"ground.markers.tip = {frame()}"]
    for i, kind in enumerate(kinds):
        a, b, c = rng.uniform(0.2, 0.4, 3)
        lines += [f"[bodies.body{i}]", f"mass = {rng.uniform(0.5, 3):.3f}", f"centre = {vector(0.5)}"]
        lines += [f"inertia = {[*np.round([b + c, c + a, a + b], 3).tolist(), *vector(0.02)]}"]
        lines += ["keep_coordinates = true", f"markers.root = {frame()}", f"markers.tip = {frame()}"]
        if kind != "free":
            before = rng.integers(-1, i)
            other = f"body{before}" if before >= 0 else "ground"
            lines += [f"[joints.joint{i}]", f'kind = "{kind}"', f'between = ["{other}.tip", "body{i}.root"]']
    last = len(kinds) - 1
    lines += [f'[forces.pull]\nat = "body{last}.tip"\nforce = {vector(5)}']
    lines += [f'[torques.turn]\non = "body0.tip"\ntorque = {vector(5)}']
    return "\n".join([*lines, "[simulation]", "duration = 1", "output = 1"]) + "\n"


@dataclass(frozen=True, eq=False)
class PinocchioModel:
    """A model of Pinocchio, and for each body of the scene its joint there and its pose (SE3) in the frame of that.

    order: the joints of the scene that are joints there, in the order of their coordinates.
    """

    pin: ModuleType
    model: Any
    scene: Table
    joints: dict[str, int]
    poses: dict[str, Any]
    order: list[Table]

    def marker(self, reference: str) -> tuple[int, Any]:
        """The joint of the body of a marker, and the pose of the marker in its frame."""
        body = reference.split(".", maxsplit=1)[0]
        return self.joints[body], self.poses[body] * marker_pose(self.pin, self.scene, reference)

    def start(self) -> Array:
        """The joint coordinates of the initial values, where joints are revolute, prismatic or universal."""
        placed = {name: pose(self.pin, table["start"], "position") for name, table in self.scene["bodies"].items()}
        placed["ground"] = self.pin.SE3.Identity()
        q: list[float] = []
        for joint in self.order:
            first, second = (placed[end.split(".")[0]] * marker_pose(self.pin, self.scene, end) for end in ends(joint))
            R, x = first.actInv(second).rotation, first.actInv(second).translation
            about_z, about_x = np.arctan2(R[1, 0], R[0, 0]), np.arctan2(R[2, 1], R[2, 2])
            q += {"revolute": [about_z], "prismatic": [x[2]], "universal": [about_z, about_x]}[joint["kind"]]
        return np.array(q)

    def external_forces(self, data: Any) -> Any:
        """The forces and torques of the scene, which are constant in the inertial frame, in a state of `data`."""
        forces = self.pin.StdVec_Force()
        for _ in range(self.model.njoints):
            forces.append(self.pin.Force.Zero())
        for table in (*self.scene.get("forces", {}).values(), *self.scene.get("torques", {}).values()):
            joint, at = self.marker(table.get("at", table.get("on")))
            axes = data.oMi[joint].rotation
            force, torque = (axes.T @ np.array(table.get(key, (0, 0, 0)), float) for key in ("force", "torque"))
            forces[joint] += self.pin.Force(force, torque + np.cross(at.translation, force))
        return forces

    def motions(self, data: Any) -> dict[str, tuple[Array, Array, Array]]:
        """Of each body in a state of `data`: coordinates (7), velocities (6) and accelerations (6), as in scenes."""
        result = {}
        for name, table in self.scene["bodies"].items():
            at_body = self.poses[name] * self.pin.SE3(np.eye(3), np.array(table.get("centre", (0, 0, 0)), float))
            joint = self.joints[name]
            place = data.oMi[joint] * at_body
            v, a = at_body.actInv(data.v[joint]), at_body.actInv(data.a[joint])
            R = place.rotation
            xdot, xddot = R @ v.linear, R @ (a.linear + np.cross(v.angular, v.linear))
            e = Rotation.from_matrix(R).as_quat(scalar_first=True)
            accelerations = np.concatenate([xddot, a.angular])
            result[name] = np.concatenate([place.translation, e]), np.concatenate([xdot, v.angular]), accelerations
        return result


def ends(joint: Table) -> tuple[str, str]:
    """The markers of a joint."""
    first, second = joint["between"]
    return first, second


def pose(pin: ModuleType, table: Any, position: str = "at") -> Any:
    """A position, with a rotation if it is a table, as an SE3."""
    if not isinstance(table, dict):
        table = {position: table}
    return pin.SE3(floats(rotation(table.get("rotation"))), np.array(table[position], float))


def marker_pose(pin: ModuleType, scene: Table, reference: str) -> Any:
    """A marker in the frame of its body."""
    body, name = reference.split(".")
    return pose(pin, (scene["ground"] if body == "ground" else scene["bodies"][body])["markers"][name])


def pinocchio_model(pin: ModuleType, text: str, closing: tuple[str, ...] = ()) -> PinocchioModel:
    """The model of a scene in TOML. Its joints, but those that close loops, lead from the ground outwards."""
    scene = tables(text)
    result = PinocchioModel(pin, pin.Model(), scene, {"ground": 0}, {"ground": pin.SE3.Identity()}, [])
    result.model.gravity.linear = np.array(scene["scene"]["gravity"], float)
    connections = [table for name, table in scene["joints"].items() if name not in closing]
    inward = {ends(joint)[1].split(".")[0]: joint for joint in connections}
    rest = [*scene["bodies"]]
    while rest:  # a body after that which carries it, and limb by limb, as mass matrices of Pinocchio need it
        carriers = ((name, ends(inward[name])[0].split(".")[0] if name in inward else "ground") for name in rest)
        ready = next(name for name, carrier in carriers if carrier in result.joints)
        rest.remove(ready)
        _add(result, ready, inward)
    return result


def _add(result: PinocchioModel, name: str, inward: dict[str, Table]) -> None:
    """Add a body, which is free or hangs on one that is there."""
    pin, scene, model = result.pin, result.scene, result.model
    if joint := inward.get(name):
        parent, before = result.marker(ends(joint)[0])
        own, kind = marker_pose(pin, scene, ends(joint)[1]).inverse(), joint["kind"]
    else:
        parent, before, own, kind = 0, pin.SE3.Identity(), pin.SE3.Identity(), "free"
    if kind == "fixed":
        result.joints[name], result.poses[name] = parent, before * own
    else:
        result.joints[name], result.poses[name] = model.addJoint(parent, joint_model(pin, kind), before, name), own
        result.order.extend([joint] if joint else [])
    model.appendBodyToJoint(result.joints[name], inertia(pin, scene, scene["bodies"][name]), result.poses[name])


def inertia(pin: ModuleType, scene: Table, body: Table) -> Any:
    """Mass, centre and the tensor about it."""
    value = Numbers(scene)
    centre, tensor = value.vector(body.get("centre", (0, 0, 0))), inertia_tensor(value.vector(body["inertia"]))
    return pin.Inertia(float(body["mass"]), floats(centre), floats(tensor))


def joint_model(pin: ModuleType, kind: str) -> Any:
    """The joint of Pinocchio that has the free motions of a kind."""
    if kind == "cylindrical":
        result = pin.JointModelComposite()
        result.addJoint(pin.JointModelPZ())
        result.addJoint(pin.JointModelRZ())
        return result
    z, x = np.array([0.0, 0, 1]), np.array([1.0, 0, 0])
    return {
        "free": pin.JointModelFreeFlyer,
        "revolute": pin.JointModelRZ,
        "prismatic": pin.JointModelPZ,
        "spherical": pin.JointModelSpherical,
        "planar": pin.JointModelPlanar,
        "universal": lambda: pin.JointModelUniversal(z, x),
    }[kind]()
