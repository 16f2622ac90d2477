"""Random small scenes in space: all joints, bodies and forces, with markers of any orientation, from a seed.

Nothing has to fit together, since functions are compared in random states: joints are between any two bodies, and close
loops where they happen to.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from random import Random

import numpy as np

KINDS = (
    "fixed",
    "spherical",
    "revolute",
    "prismatic",
    "cylindrical",
    "universal",
    "planar",
    "point_on_line",
    "distance",
    "general",
)
MOTIONS = ("x", "y", "z", "rx", "ry", "rz")
SEQUENCES = ("xyz", "xzy", "yzx", "yxz", "zxy", "zyx", "xyx", "xzx", "yzy", "yxy", "zxz", "zyz")
PARTS = frozenset({"drives", "flexible", "forces", "gears", "torques", "springs"})
"""The parts of a scene besides rigid bodies, joints and gravity."""


class Writer:
    """The lines of a scene from random numbers."""

    def __init__(self, seed: int, parts: frozenset[str]) -> None:
        self.seed, self.random, self.parts = seed, Random(f"spatial scene {seed}"), parts
        self.lines = [f'name = "space_{seed}"']
        self.markers: list[str] = []
        self.turning: set[str] = set()
        """The markers that have a rotation."""
        self.moves = False
        """Whether anything moves that nothing prescribes."""
        self.coupled: list[str] = []
        """The joints whose motions gears may couple."""
        self.guiding: list[str] = []
        self.hinging: list[str] = []
        """The joints with a displacement along z, and those with a rotation about z."""
        self.files: dict[str, dict[str, np.ndarray]] = {}

    def number(self, size: float = 1.0) -> float:
        """A number with two or three digits between -size and size."""
        return float(f"{self.random.uniform(-size, size):.3g}")

    def positive(self, low: float = 0.2, high: float = 2.0) -> float:
        return float(f"{self.random.uniform(low, high):.3g}")

    def signed(self) -> str:
        """A number behind another one in a sum."""
        value = self.number(2)
        return f"{'-' if value < 0 else '+'} {abs(value)}"

    def vector(self, size: float = 1.0) -> list[float]:
        return [self.number(size) for _ in range(3)]

    def chance(self, probability: float) -> bool:
        return self.random.random() < probability

    def rotation(self) -> str:
        """A rotation in one of its forms."""
        form = self.random.choice(["quaternion", "axis", "axes", "angles"])
        if form == "quaternion":
            e = np.array([self.random.gauss(0, 1) for _ in range(4)])
            return str((e / np.linalg.norm(e)).tolist())
        if form == "axis":
            return f"{{ axis = {self.vector()}, angle = {self.number(3)} }}"
        if form == "axes":  # of small integers, so that they are orthogonal exactly
            first, second = self.random.choice(
                [([1, 2, 2], [2, 1, -2]), ([3, 4, 0], [-4, 3, 0]), ([0, 1, 0], [0, 0, -2])]
            )
            names = self.random.sample("xyz", 2)
            return f"{{ {names[0]} = {first}, {names[1]} = {second} }}"
        angles = [self.number(3) for _ in range(3)]
        return f'{{ angles = {angles}, sequence = "{self.random.choice(SEQUENCES)}" }}'

    def marker(self) -> str:
        if self.chance(0.3):
            return str(self.vector())
        return f"{{ at = {self.vector()}, rotation = {self.rotation()} }}"

    # ---- parts of a scene

    def ground(self) -> None:
        self.lines.append("[ground.markers]")
        for k in range(2):
            self.lines.append(f"base{k} = {self.marker()}")
            self._known(f"ground.base{k}")

    def _known(self, marker: str, turning: bool = True) -> None:
        self.markers.append(marker)
        if turning:
            self.turning.add(marker)

    def rigid(self, name: str) -> None:
        """A rigid body whose inertia tensor is that of masses on three random lines."""
        arms = np.array([self.vector(0.6) for _ in range(3)])
        tensor = sum(((a @ a) * np.eye(3) - np.outer(a, a) for a in arms), np.zeros((3, 3)))
        six = [float(f"{tensor[i, j]:.6g}") for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
        self.lines += [f"[bodies.{name}]", f"mass = {self.positive()}", f"inertia = {six}"]
        if self.chance(0.7):
            self.lines.append(f"centre = {self.vector(0.3)}")
        if self.chance(0.5):
            self.lines.append("keep_coordinates = true")
        for marker in ("one", "two", "three"):
            self.lines.append(f"markers.{marker} = {self.marker()}")
            self._known(f"{name}.{marker}")

    def flexible(self, name: str) -> None:
        """A body of nodes, with modes that hold rigid motion or not, and markers at nodes and on sets of nodes."""
        modes, count = self.random.randint(1, 3), self.random.randint(5, 8)
        rng = np.random.default_rng(self.random.randrange(10**6))
        half = rng.uniform(-1, 1, (modes, modes))
        self.files[f"{name}.npz"] = {
            "positions": rng.uniform(-1, 1, (count, 3)),
            "mass": rng.uniform(0.1, 0.5, count),
            "modes": rng.uniform(-0.5, 0.5, (modes, count, 3)),
            "modal_stiffness": half @ half.T * 20 + np.eye(modes),
        }
        self.lines += [
            f"[bodies.{name}]",
            f'nodes = "{name}.npz"',
            'units = "SI"',
            'frame = "given"',
            "orthonormal = false",
        ]
        if self.chance(0.5):
            self.lines.append(f"damping = {{ mass = {self.positive(0, 0.2)}, stiffness = {self.positive(0, 0.01)} }}")
        nodes = self.random.sample(range(count), 5)
        self.lines.append(f"markers.tip = {nodes[0]}")
        self._known(f"{name}.tip", turning=False)
        face = f"nodes = {nodes[1:]}, weights = {[self.positive(1, 3) for _ in range(4)]}"
        self.lines.append(f"markers.face = {{ {face}, rotation = {self.rotation()} }}")
        self._known(f"{name}.face")
        self.lines.append(f"markers.edge = {{ nodes = {nodes[:3]} }}")
        self._known(f"{name}.edge")
        if "forces" in self.parts:
            self.loads(name, count)

    def loads(self, name: str, count: int) -> None:
        """Loads on nodes of a body; the rest of the scene does not depend on them."""
        rest, self.random = self.random, Random(f"loads {self.seed} {name}")
        nodes = self.random.sample(range(count), 3)
        forces = [self.vector(2) for _ in nodes]
        self.lines.append(f"loads.wind = {{ nodes = {nodes}, forces = {forces}, time = {self.function()} }}")
        forces = f"forces = [{self.vector(2)}]"
        self.lines.append(f'loads.jet = {{ nodes = {nodes[:2]}, {forces}, frame = "body" }}')
        self.random = rest

    def pair(self, markers: Sequence[str]) -> list[str]:
        """Two markers of different bodies."""
        while True:
            first, second = self.random.sample(list(markers), 2)
            if first.split(".")[0] != second.split(".")[0]:
                return [first, second]

    def joint(self, name: str, between: Sequence[str]) -> None:
        """A joint of any kind that the markers allow, with a drive sometimes."""
        both_turn = {*between} <= self.turning
        kind = self.random.choice(KINDS if both_turn else ("spherical", "distance"))
        if not both_turn:
            kind = "spherical"  # others are refused at a node without a rotation
        more = Random(f"{name} of {self.seed}")  # leaves the rest of the scene as it is
        if kind == "cylindrical" and more.random() < 0.5:
            kind = "screw"
        self.lines += [f"[joints.{name}]", f'kind = "{kind}"', f"between = {list(between)}"]
        if kind == "general":
            count = self.random.randint(1, 5)
            kept = sorted(self.random.sample(MOTIONS, count), key=MOTIONS.index)
            self.lines.append(f"removes = {kept}")
        if kind == "distance":
            self.lines.append(f"distance = {self.positive(0.5, 3)}")
        if kind == "screw":
            self.lines.append(f"pitch = {more.choice([-1, 1]) * round(more.uniform(0.2, 2), 2)}")
        if kind in ("revolute", "prismatic", "cylindrical", "screw", "planar"):
            self.coupled.append(name)
        self.guiding += [name] * (kind in ("prismatic", "cylindrical", "screw", "point_on_line"))
        self.hinging += [name] * (kind in ("revolute", "cylindrical", "screw", "planar"))
        driven = kind in ("revolute", "prismatic") and "drives" in self.parts and self.chance(0.4)
        self.moves |= not driven and kind != "fixed"
        if driven:
            self.lines += [f"[drives.{name}_drive]", f'joint = "{name}"']
            self.lines.append(
                f'motion = "{self.number()} + {self.positive()}*t {self.signed()}*sin({self.positive()}*t)"'
                if self.chance(0.6)
                else f"speed = {self.number(3)}\noffset = {self.number()}"
            )

    def gear(self) -> None:
        """A gear between two joints, if there are two whose motions it may couple."""
        random = Random(f"gear of {self.seed}")
        if len(self.coupled) > 1 and "gears" in self.parts:
            first, second = random.sample(self.coupled, 2)
            ratio = f'"{random.choice([-1, 1]) * random.randint(1, 9)}/{random.randint(1, 9)}"'
            self.lines += ["[gears.mesh]", f'joints = ["{first}", "{second}"]', f"ratio = {ratio}"]
            self.lines.append(f"offset = {round(random.uniform(-2, 2), 2)}")

    def function(self) -> str:
        """A function of time."""
        return (
            f'"{self.number(3)} {self.signed()}*cos({self.positive()}*t)"' if self.chance(0.4) else str(self.number(3))
        )

    def functions(self) -> str:
        return "[" + ", ".join(self.function() for _ in range(3)) + "]"

    def actions(self, moving: Sequence[str]) -> None:
        """Forces, torques and springs at markers; the rest of the scene does not depend on them."""
        self.random = Random(f"actions {self.seed}")
        turning = [m for m in moving if m in self.turning]
        if "forces" in self.parts:
            self.lines += ["[forces.push]", f'at = "{self.random.choice(moving)}"', f"force = {self.functions()}"]
            self.lines.append(f'frame = "{self.random.choice(["inertial", "body"])}"')
        if "torques" in self.parts and turning:
            on = self.random.choice(turning)
            others = [m for m in self.markers if m in self.turning and m.split(".")[0] != on.split(".")[0]]
            self.lines += ["[torques.twist]", f'on = "{on}"', f"torque = {self.functions()}"]
            self.lines.append(f'frame = "{self.random.choice(["inertial", "body"])}"')
            if self.chance(0.5):
                self.lines.append(f'against = "{self.random.choice(others)}"')
        self.in_joints()
        if "springs" in self.parts:
            pair = self.pair(self.markers)
            kinds = ("linear", "rotational", "bushing") if {*pair} <= self.turning else ("linear",)
            kind = self.random.choice(kinds)
            self.lines += ["[springs.strut]", f'kind = "{kind}"', f"between = {pair}"]
            if kind == "bushing":
                self.lines.append(f"stiffness = {[self.positive(1, 20) for _ in range(6)]}")
                self.lines.append(f"damping = {[self.positive(0, 1) for _ in range(6)]}")
            else:
                self.lines.append(f"stiffness = {self.positive(1, 20)}\ndamping = {self.positive()}")
                self.lines.append(f"rest = {self.positive()}")

    def in_joints(self) -> None:
        """Forces along and torques about the axes of joints; the rest of the scene does not depend on them."""
        rest, self.random = self.random, Random(f"in joints {self.seed}")
        for section, joints in (("forces", self.guiding), ("torques", self.hinging)):
            if section in self.parts and joints:
                joint = self.random.choice(joints)
                self.lines += [f"[{section}.own_{section[:-1]}]", f'joint = "{joint}"', f"value = {self.function()}"]
        self.random = rest

    def write(self, folder: Path) -> Path:
        """The scene and its files in a folder; the path of the scene."""
        folder.mkdir(parents=True, exist_ok=True)
        for name, arrays in self.files.items():
            np.savez(folder / name, **arrays)
        path = folder / "scene.toml"
        path.write_text(
            "\n".join([*self.lines, "[simulation]", "duration = 1", "output = 0.1"]).replace("'", '"') + "\n"
        )
        return path


def random_scene(seed: int, folder: Path, parts: frozenset[str] = PARTS) -> Path:
    """Write a random scene: one to three bodies, each connected to what comes before it or free, and a joint more."""
    writer = Writer(seed, parts)
    count = writer.random.randint(1, 3)
    if writer.chance(0.8):
        writer.lines.append(f"[scene]\ngravity = {writer.vector(9)}")
    writer.ground()
    before: list[str] = list(writer.markers)
    pairs = []
    for k in range(count):
        name = f"body{k}"
        if "flexible" in parts and writer.chance(0.35):
            writer.flexible(name)
        else:
            writer.rigid(name)
        own = [m for m in writer.markers if m.startswith(f"{name}.")]
        if k > 0 and writer.chance(0.2):
            writer.moves = True
        else:
            pair = [writer.random.choice(before), writer.random.choice(own)]
            pairs.append(pair[:: writer.random.choice([1, -1])])
        before += own
    if writer.chance(0.4):
        pairs.append(writer.pair(writer.markers))
    actions = [m for m in writer.markers if not m.startswith("ground.")]
    for k, pair in enumerate(pairs):
        writer.joint(f"joint{k}", pair)
    writer.gear()
    if not writer.moves:
        writer.rigid("loose")
    if parts & {"forces", "torques", "springs"}:
        writer.actions(actions)
    return writer.write(folder)
