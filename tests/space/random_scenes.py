"""Random small scenes in space: all bodies, joints, drives and forces, with markers of any orientation, from a seed.

Nothing has to fit together, since functions are compared in random states: joints are between any two bodies, and close
loops where they happen to. The kinds are those of the registries, so that a new one is drawn as soon as it is there.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from random_bodies import RandomBodies
from random_values import rows_text

from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS, Freedom
from derive.mechanics.multibody.space.rows import DISPLACEMENTS, RELATIVE_MOTIONS
from derive.mechanics.multibody.space.springs import SPATIAL_BUSHINGS, SPATIAL_SPRINGS

FIRST_BEAM = 200
"""The scenes of the seeds from this one on have beams."""
KINDS = tuple(SPATIAL_JOINTS)
DRIVEN = tuple(kind for kind, of in SPATIAL_JOINTS.items() if of.driven)


class Writer(RandomBodies):
    """The lines of a scene from random numbers."""

    def __init__(self, seed: int) -> None:
        super().__init__(seed)
        self.prescribed = {"ground"}
        """The bodies whose motion is known."""
        self.joints: dict[str, tuple[str, tuple[str, ...], list[str]]] = {}
        """Kinds, removed motions and markers of the joints by their names."""
        self.driven: set[str] = set()

    def pair(self, markers: Sequence[str]) -> list[str]:
        """Two markers of different bodies, of which one moves."""
        while True:
            first, second = self.random.sample(list(markers), 2)
            bodies = {first.split(".")[0], second.split(".")[0]}
            if len(bodies) == 2 and not bodies <= self.prescribed:
                return [first, second]

    def kinds(self, between: Sequence[str]) -> list[str]:
        """The kinds of joints that the markers allow: those at nodes act on no rotation of theirs."""
        first, second = (marker in self.turning for marker in between)
        if first and second:
            return [*SPATIAL_JOINTS]
        return ["spherical", "distance", "general"] + ["point_on_line"] * first

    def removed(self, between: Sequence[str]) -> tuple[str, ...]:
        """The motions that a general joint removes."""
        first, second = (marker in self.turning for marker in between)
        of: Sequence[str] = RELATIVE_MOTIONS if first and second else (*DISPLACEMENTS,)
        count = len(of) if not first else self.random.randint(1, min(5, len(of)))
        return tuple(sorted(self.random.sample(of, count), key=RELATIVE_MOTIONS.index))

    def joint(self, name: str, between: list[str], kind: str = "", driven: bool | None = None) -> None:
        """A joint of any kind that the markers allow, with a drive sometimes."""
        kind = kind or self.random.choice(self.kinds(between))
        of = SPATIAL_JOINTS[kind]
        keys = {key.name for key in of.keys}
        removed = self.removed(between) if of.removes is None else of.removes
        self.joints[name] = kind, removed, between
        self.lines += [f"[joints.{name}]", f'kind = "{kind}"', f"between = {between}"]
        if "removes" in keys:
            self.lines.append(f"removes = {[*removed]}")
        if "distance" in keys:
            self.lines.append(f"distance = {self.positive(0.5, 3)}")
        if "pitch" in keys:
            self.lines.append(f"pitch = {self.quantity(self.random.choice([-1, 1]) * self.positive())}")
        if kind in DRIVEN and (self.chance(0.4) if driven is None else driven):
            self.drive(name)
        self.find_prescribed()

    def find_prescribed(self) -> None:
        """Find the rigid bodies that fixed and driven joints place behind what is prescribed."""
        for _ in self.joints:
            for name, (kind, _, between) in self.joints.items():
                bodies = [marker.split(".")[0] for marker in between]
                for own, other in (bodies, bodies[::-1]) if name in self.driven or kind == "fixed" else ():
                    if other in self.prescribed and own not in self.kept | self.flexible_bodies:
                        self.prescribed.add(own)

    @property
    def moving(self) -> list[str]:
        """The markers of bodies whose motion nothing prescribes."""
        return [marker for marker in self.markers if marker.split(".")[0] not in self.prescribed]

    def drive(self, joint: str) -> None:
        self.driven.add(joint)
        self.lines += [f"[drives.{joint}_drive]", f'joint = "{joint}"']
        if self.chance(0.5):
            self.lines.append(f"motion = {self.motion()}")
        else:
            self.lines += [f"speed = {self.speed()}", f"offset = {self.number()}"]

    def gear(self) -> None:
        """A gear between two joints, if there are two whose motions it may couple, of which one is not prescribed."""
        motions = {name: SPATIAL_JOINTS[kind].couples(removed) for name, (kind, removed, _) in self.joints.items()}
        coupled = [name for name, motion in motions.items() if motion]
        if len(coupled) < 2 or {*coupled} <= self.driven:
            return
        pair = self.random.sample(coupled, 2)
        while {*pair} <= self.driven:
            pair = self.random.sample(coupled, 2)
        teeth = f'"{self.random.choice([-1, 1]) * self.random.randint(1, 9)}/{self.random.randint(1, 9)}"'
        if all(motions[name] is Freedom.DISPLACEMENT for name in pair):
            teeth = self.quantity(self.number(2) or 1.0, 0.8)
        self.lines += ["[gears.mesh]", f"joints = {pair}", f"ratio = {teeth}"]
        self.lines.append(f"offset = {self.quantity(self.number(2))}")

    # ---- forces

    def functions(self) -> str:
        return "[" + ", ".join(self.function() for _ in range(3)) + "]"

    def frame(self) -> str:
        return f'frame = "{self.random.choice(["inertial", "body"])}"'

    def actions(self, moving: Sequence[str]) -> None:
        """Forces, torques and springs at markers, and loads in joints."""
        for k in range(self.random.randint(1, 2)):
            on = self.random.choice(moving)
            self.lines += [f"[forces.push{k}]", f'at = "{on}"', f"force = {self.functions()}", self.frame()]
        turning = [m for m in moving if m in self.turning]
        if turning:
            on = self.random.choice(turning)
            others = [m for m in self.markers if m in self.turning and m.split(".")[0] != on.split(".")[0]]
            self.lines += ["[torques.twist]", f'on = "{on}"', f"torque = {self.functions()}", self.frame()]
            if self.chance(0.5):
                self.lines.append(f'against = "{self.random.choice(others)}"')
        for section, motion in (("forces", Freedom.DISPLACEMENT), ("torques", Freedom.ROTATION)):
            joints = [
                n for n, (kind, removed, _) in self.joints.items() if SPATIAL_JOINTS[kind].leaves(removed, motion)
            ]
            if joints:
                self.lines += [f"[{section}.own_{section[:-1]}]", f'joint = "{self.random.choice(joints)}"']
                self.lines.append(f"value = {self.function()}")
        for k in range(self.random.randint(1, 2)):
            self.spring(f"strut{k}")

    def spring(self, name: str) -> None:
        """A spring of any kind, of which those of rotations are between the markers of a joint sometimes."""
        hinges = [between for _, _, between in self.joints.values() if {*between} <= self.turning]
        pair = self.pair(self.markers)
        while any({*pair} == {*between} for _, _, between in self.joints.values()):  # no line is between them
            pair = self.pair(self.markers)
        kinds = ["linear"]
        if {*pair} <= self.turning or (hinges and self.chance(0.5)):
            kinds = [*SPATIAL_SPRINGS, *SPATIAL_BUSHINGS, *SPATIAL_BUSHINGS]
        kind = self.random.choice(kinds)
        if kind != "linear" and hinges and (not {*pair} <= self.turning or self.chance(0.4)):
            pair = self.random.choice(hinges)[:: self.random.choice([1, -1])]
        self.lines += [f"[springs.{name}]", f'kind = "{kind}"', f"between = {pair}"]
        if kind in SPATIAL_BUSHINGS:
            self.lines.append(f"stiffness = {self.six(20)}")
            if self.chance(0.8):
                self.lines.append(f"damping = {self.six(1)}")
            return
        for key, low, high in (("stiffness", 1, 20), ("damping", 0.2, 2), ("rest", 0.2, 2)):
            self.lines.append(f"{key} = {self.quantity(self.positive(low, high))}")

    def six(self, size: float) -> str:
        """Six numbers along the axes, or a symmetric matrix that is positive definite."""
        if self.chance(0.4):
            return self.quantities([self.positive(size / 20, size) for _ in range(6)])
        half = np.array([[self.number() for _ in range(6)] for _ in range(6)])
        matrix = np.round(size * (half @ half.T + 0.5 * np.eye(6)), 3)
        if self.chance(0.2):  # a parameter on the diagonal; entries off it would have to be equal in pairs
            matrix_text = [[str(x) for x in row] for row in matrix.tolist()]
            matrix_text[0][0] = self.quantity(float(matrix[0, 0]), 1)
            return f"[{', '.join('[' + ', '.join(row) + ']' for row in matrix_text)}]"
        return str(matrix.tolist())

    # ---- the scene

    def text(self) -> str:
        """The whole scene."""
        own = [line for header, body in self.sections.items() for line in (f"[{header}]", body)]
        lines = [*self.lines, *own, "[simulation]", "duration = 1", "output = 0.1"]
        return "\n".join(lines).replace("'", '"') + "\n"

    def write(self, folder: Path) -> Path:
        """The scene and its files in a folder; the path of the scene."""
        folder.mkdir(parents=True, exist_ok=True)
        self.write_files(folder)
        for name, rows in self.curves.items():
            (folder / name).write_text(rows_text(rows))
        path = folder / "scene.toml"
        path.write_text(self.text())
        return path


def random_writer(seed: int) -> Writer:
    """The lines of a random scene: one to three bodies, each connected to what comes before it or free, a joint more.

    In a part of the scenes the first body is carried by a drive, and in others a joint is there twice. Neighbouring
    seeds have all kinds of first joints in turn, with either end at the ground.
    """
    writer = Writer(seed)
    carried, doubled = writer.chance(0.3), writer.chance(0.15)
    scene = []
    if writer.chance(0.8):
        scene.append(f"gravity = {writer.quantities(writer.vector(9), 0.2)}")
    if doubled:
        scene.append('redundant = "resolve"')
    writer.lines += ["[scene]", *scene] if scene else []
    writer.ground()
    before: list[str] = list(writer.markers)
    pairs = []
    count = writer.random.randint(2 if carried else 1, 3)
    for k in range(count):
        name = f"body{k}"
        if seed >= FIRST_BEAM and not (carried and k == 0) and len(pairs) < 2 and writer.chance(0.8):
            writer.beam(name)
        elif not (carried and k == 0) and writer.chance(0.4 if k else 0.2):
            writer.flexible(name)
        else:
            writer.rigid(name, carried and k == 0 and writer.chance(0.5), 0.0 if carried and k == 0 else 0.3)
        own = [m for m in writer.markers if m.startswith(f"{name}.")]
        if k == 0 or carried or writer.chance(0.8):  # else nothing holds it
            of = [m for m in before if m.startswith("body0.")] if carried and k == 1 else before
            pair = [writer.random.choice(of), writer.random.choice(own)]
            pairs.append(pair[:: writer.random.choice([1, -1])] if k else pair[:: 1 - 2 * (seed // len(KINDS) % 2)])
        before += own
    for k, pair in enumerate(pairs):
        kind, first = "", carried and k == 0
        if first:
            kind = writer.random.choice([*DRIVEN, "fixed"])
        elif k == 0 and KINDS[seed % len(KINDS)] in writer.kinds(pair):
            kind = KINDS[seed % len(KINDS)]
        writer.joint(f"joint{k}", pair, kind, first or None)
    if doubled:
        _double(writer, f"joint{len(pairs) - 1}")
    elif writer.chance(0.4) and writer.moving:
        writer.joint(f"joint{len(pairs)}", writer.pair(writer.markers))
    writer.gear()
    if not writer.moving:
        writer.rigid("loose")
    writer.actions(writer.moving)
    return writer


def _double(writer: Writer, joint: str) -> None:
    """A joint between the same markers as another one, without its drive, if it has no keys of its own."""
    kind, _, between = writer.joints[joint]
    if not SPATIAL_JOINTS[kind].keys:
        writer.joint("joint_again", list(between), kind, driven=False)


def random_scene(seed: int, folder: Path) -> Path:
    """Write a random scene; the path of its file."""
    return random_writer(seed).write(folder)
