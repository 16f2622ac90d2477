"""The positions of a spatial scene as functions of time and state: bodies, markers, joints, lengths of springs.

Velocities are used in one way only: a state is moved along them by a small step, bodies turning about constant axes in
their own frames. Values, derivatives and virtual displacements are differences of what is a function of the state here.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import numpy as np
from beam_points import beam_body
from decimal_vectors import (
    ONE,
    Array,
    about,
    array,
    identity,
    of_quaternion,
    precise,
    zeros,
)
from mass_points import MarkerFrame, PointBody, rigid_body, rigid_marker
from nodal_points import NodalFields, nodal_body, nodal_fields
from relative_motion import (
    WHOLE_TURN,
    coupled,
    driven_row,
    free_motions,
    gear_turn,
    joint_rows,
    relative,
    relative_angle,
    without_turns,
)
from written_scene import Numbers, Table

GROUND = "ground"


@dataclass(frozen=True, eq=False)
class Pose:
    """The position of the origin of a frame, and its rotation."""

    c: Array
    R: Array

    def place(self, r: Array) -> Array:
        """c + R r, of one or of many points."""
        return self.c + r @ self.R.T


@dataclass(frozen=True, eq=False)
class SpaceState:
    """Scalars by the names of coordinates, rotation matrices by the names of what turns."""

    scalars: Mapping[str, Decimal]
    rotations: Mapping[str, Array]


class Columns:
    """The coordinates of a model: scalars, or the four numbers of a quaternion, whose three velocities are omega."""

    def __init__(self, names: Sequence[str]) -> None:
        self.names = tuple(names)
        self.parts: list[tuple[str, bool]] = []
        for name in names:
            if name.endswith("e0"):
                self.parts.append((name[:-2], True))
            elif not name.endswith(("e1", "e2", "e3")):
                self.parts.append((name, False))
        self.size = sum(3 if turns else 1 for _, turns in self.parts)

    def __contains__(self, name: str) -> bool:
        return (name, False) in self.parts or (name, True) in self.parts

    def state(self, q: Array) -> SpaceState:
        """The state of coordinates q."""
        of = dict(zip(self.names, array(q), strict=True))
        turned = {n: of_quaternion(np.array([of[f"{n}e{i}"] for i in range(4)])) for n, turns in self.parts if turns}
        return SpaceState({n: of[n] for n, turns in self.parts if not turns}, turned)

    def moved(self, state: SpaceState, v: Array, s: Decimal) -> SpaceState:
        """The state after moving with velocities v for a time s."""
        scalars, rotations, i = dict(state.scalars), dict(state.rotations), 0
        for name, turns in self.parts:
            if turns:
                if any(v[i : i + 3]):
                    rotations[name] = rotations[name] @ about(s * v[i : i + 3])
                i += 3
            else:
                scalars[name] = scalars[name] + s * v[i]
                i += 1
        return SpaceState(scalars, rotations)


class SpaceKinematics:
    """A scene as functions of t and a state. `fields` are those of flexible bodies, by default those of their files."""

    def __init__(
        self,
        scene: Table,
        coordinates: Sequence[str],
        multipliers: Sequence[str] = (),
        *,
        folder: Path = Path(),
        fields: Mapping[str, NodalFields] | None = None,
        p: Mapping[str, float] | None = None,
    ) -> None:
        self.scene, self.columns = scene, Columns(coordinates)
        with precise():
            self._read(scene, folder, fields or {}, p)
        self.joints: dict[str, Table] = dict(scene.get("joints", {}))
        self.drives = {table["joint"]: {**table, "name": name} for name, table in scene.get("drives", {}).items()}
        self.springs: dict[str, Table] = dict(scene.get("springs", {}))
        self.held = self._held_bodies(multipliers)

    def _read(
        self, scene: Table, folder: Path, fields: Mapping[str, NodalFields], p: Mapping[str, float] | None
    ) -> None:
        """The numbers of the scene and of its files."""
        self.value = Numbers(scene, p, folder)
        self.bodies: dict[str, PointBody] = {}
        for name, table in scene.get("bodies", {}).items():
            if "nodes" in table:
                of = fields.get(name) or nodal_fields(folder / table["nodes"], table)
                self.bodies[name] = nodal_body(name, table, self.value, of)
            elif "length" in table:
                self.bodies[name] = beam_body(name, table, self.value)
            else:
                self.bodies[name] = rigid_body(name, table, self.value)
        ground = scene.get("ground", {}).get("markers", {})
        self.ground = {name: rigid_marker(of, self.value) for name, of in ground.items()}
        centres = {
            name: table.get("centre") for name, table in scene.get("bodies", {}).items() if "length" not in table
        }
        self.centres = {name: self.value.vector(centres.get(name) or (0, 0, 0)) for name in self.bodies}
        self.gravity = self.value.vector(scene.get("scene", {}).get("gravity", (0, 0, 0)))

    def _held_bodies(self, multipliers: Sequence[str]) -> list[tuple[str, str]]:
        """Bodies without coordinates of their own, each with the joint that places it, in an order that can be used."""
        known = {GROUND} | {name for name in self.bodies if f"{name}_c1" in self.columns}
        placing = [name for name in self.joints if not any(row.startswith(f"{name}_") for row in multipliers)]
        result: list[tuple[str, str]] = []
        while len(known) <= len(self.bodies):
            for name in placing:
                ends = [end.split(".")[0] for end in self.joints[name]["between"]]
                new = [end for end in ends if end not in known]
                if len(new) == 1:
                    result.append((new[0], name))
                    known.add(new[0])
                    break
            else:
                raise ValueError("bodies that nothing places")
        return result

    # ---- poses

    def marker(self, reference: str) -> tuple[str, MarkerFrame]:
        """A marker by its reference, such as "rod.tip", with the name of its body."""
        body, _, name = reference.partition(".")
        return body, (self.ground[name] if body == GROUND else self.bodies[body].markers[name])

    def amplitudes(self, name: str, state: SpaceState) -> Array:
        """alpha of a body."""
        n = self.bodies[name].n
        return np.array([state.scalars[f"{name}_alpha{i}"] for i in range(1, n + 1)], dtype=object)

    def poses(self, t: Decimal, state: SpaceState) -> dict[str, Pose]:
        """The poses of the frames in which markers have their coordinates.

        The coordinates c of a rigid body are those of its centre of mass, of a flexible one of its floating frame.
        """
        result = {GROUND: Pose(zeros(3), identity(3))}
        for name in self.bodies:
            if f"{name}_c1" in self.columns:
                c = np.array([state.scalars[f"{name}_c{k}"] for k in (1, 2, 3)], dtype=object)
                R = state.rotations[f"{name}_"]
                result[name] = Pose(c - R @ self.centres[name], R)
        for name, joint in self.held:
            result[name] = self._held_pose(name, joint, t, state, result)
        return result

    def _held_pose(self, name: str, joint: str, t: Decimal, state: SpaceState, known: Mapping[str, Pose]) -> Pose:
        """The pose that a joint gives a body: by the coordinates that it leaves, or by its drive."""
        table = self.joints[joint]
        first, second = table["between"]
        sign = 1 if second.split(".")[0] == name else -1
        other, own = (first, second) if sign > 0 else (second, first)
        values: dict[str, Decimal] = {}
        ball = f"{name}_" in state.rotations  # the rotation of the body itself is kept
        for motion, end in free_motions(table, sign).items():
            if ball and motion.startswith("r"):
                continue
            if table["kind"] == "screw" and motion == "z":
                continue
            driven = joint in self.drives and motion == coupled(table) and f"{name}_{end}" not in self.columns
            values[motion] = sign * self.motion(joint, t) if driven else state.scalars[f"{name}_{end}"]
        if table["kind"] == "screw":
            values["z"] = values["rz"] * self.value(table["pitch"]) / WHOLE_TURN
        d, R = relative(values)
        x, A = self.frame(other, state, known)
        _, marker = self.marker(own)
        turned = state.rotations[f"{name}_"] if ball else A @ R @ marker.rotation.T
        return Pose(x + A @ d - turned @ marker.position, turned)

    def coupled_motion(
        self, joint: str, t: Decimal, state: SpaceState, poses: Mapping[str, Pose]
    ) -> tuple[Decimal, bool]:
        """The motion of a joint that a gear couples, and whether it counts turns."""
        table = self.joints[joint]
        motion = coupled(table)
        for body, placing in self.held:
            if placing == joint:
                own = self._own_motion(joint, body, state)
                return self.motion(joint, t) if own is None else own, True
        (x1, A1), (x2, A2) = (self.frame(end, state, poses) for end in table["between"])
        return (relative_angle(A1.T @ A2), False) if motion == "rz" else ((A1.T @ (x2 - x1))[2], True)

    def _own_motion(self, joint: str, body: str, state: SpaceState) -> Decimal | None:
        """The motion of a joint that is a coordinate of the body that it places; None if a drive prescribes it."""
        table = self.joints[joint]
        sign = 1 if table["between"][1].split(".")[0] == body else -1
        name = f"{body}_{free_motions(table, sign)[coupled(table)]}"
        return sign * state.scalars[name] if name in state.scalars else None

    def motion(self, joint: str, t: Decimal) -> Decimal:
        """The rotation or displacement that a drive prescribes."""
        drive = self.drives[joint]
        if "motion" in drive:
            return self.value.at(drive["motion"], t)
        speed, offset = drive["speed"], self.value(drive.get("offset", 0))
        if isinstance(speed, str):
            return self.value.functions.integral(speed, t) + offset
        return self.value(speed) * t + offset

    def frame(self, reference: str, state: SpaceState, poses: Mapping[str, Pose]) -> tuple[Array, Array]:
        """The inertial position and the axes of a marker.

        Those of a deformed body turn by the quaternion [1, theta/2], normalised, of their rotation vector theta.
        """
        body, marker = self.marker(reference)
        pose = poses[body]
        position, turned = marker.position, marker.rotation
        if body != GROUND and self.bodies[body].n:
            alpha = self.amplitudes(body, state)
            position = marker.at(alpha)
            if marker.turns is not None:
                turned = of_quaternion(np.array([ONE, *(marker.turn(alpha) / 2)], dtype=object)) @ turned
        return pose.place(position), pose.R @ turned

    # ---- functions of t and the state

    def points(self, state: SpaceState, poses: Mapping[str, Pose]) -> list[Array]:
        """The positions of the material points of each body, (P, 3)."""
        return [
            poses[name].place(body.deformed(self.amplitudes(name, state) if body.n else zeros(0)))
            for name, body in self.bodies.items()
        ]

    def constraints(self, t: Decimal, state: SpaceState, poses: Mapping[str, Pose]) -> dict[str, Decimal]:
        """g of joints that place no body, by joint and row, of drives of coordinates, and of gears."""
        result: dict[str, Decimal] = {}
        placing = {joint: body for body, joint in self.held}
        for name, table in self.joints.items():
            if name in placing:
                own = self._own_motion(name, placing[name], state) if name in self.drives else None
                if own is not None:
                    result[self.drives[name]["name"]] = own - self.motion(name, t)
                continue
            (x1, A1), (x2, A2) = (self.frame(end, state, poses) for end in table["between"])
            d, R = A1.T @ (x2 - x1), A1.T @ A2
            for row, value in joint_rows(table, d, R, self.value, A1).items():
                result[f"{name}_{row}"] = value
            if name in self.drives:
                drive = self.drives[name]["name"]
                result[drive] = driven_row(table, d, R, self.motion(name, t))
        for name, table in self.scene.get("gears", {}).items():
            (first, a), (second, b) = (self.coupled_motion(joint, t, state, poses) for joint in table["joints"])
            g = second - self.value(table["ratio"]) * first - self.value(table.get("offset", 0))
            ratio = table["ratio"]
            teeth = 1 if isinstance(ratio, Mapping) else Fraction(str(ratio)).denominator
            turn = gear_turn(self.value(ratio), teeth, (a, b))
            result[name] = g if turn is None else without_turns(g, turn)
        return result

    def acted_on(self) -> list[str]:
        """The markers at which forces and torques act, with repetitions, in the order of `frames`."""
        forces = [table["at"] for table in self.scene.get("forces", {}).values() if "joint" not in table]
        for table in self.scene.get("torques", {}).values():
            forces += [table[key] for key in ("at", "on", "against") if key in table]
        for _, table in self.in_joints():
            forces += self.joints[table["joint"]]["between"]
        for name, table in self.scene["bodies"].items():
            if any(self.loads_along(table, "torque")):
                forces += [f"{name}.{marker}" for marker in self.bodies[name].markers if marker.startswith("point ")]
        return forces

    @staticmethod
    def loads_along(body: Table, key: str) -> Iterator[Table]:
        """The loads of a beam that are a force or a torque per length."""
        loads = body.get("loads", {}).values() if "bending_stiffness" in body else ()
        return (load for load in loads if key in load)

    def in_joints(self) -> list[tuple[str, Table]]:
        """The forces and torques in joints, with their sections."""
        sections = ("forces", "torques")
        every = [(section, table) for section in sections for table in self.scene.get(section, {}).values()]
        return [(section, table) for section, table in every if "joint" in table]
