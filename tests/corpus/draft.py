"""A scene while it is made: its tables, and the poses of its bodies, from which joints, starts and springs follow."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from corpus.draws import Draws, rounded

Table = dict[str, Any]
Point = tuple[float, float]

NAMES = {
    "bodies": [
        "rod",
        "arm",
        "crank",
        "coupler",
        "rocker",
        "slider",
        "plate",
        "beam",
        "link",
        "blade",
        "q",
        "K",
        "Body_2",
        "wing",
        "boom",
        "tail",
        "M",
        "x1",
    ],
    "gears": ["mesh", "train", "belt"],
    "joints": [
        "hinge",
        "pin",
        "bearing",
        "guide",
        "clamp",
        "J",
        "a",
        "elbow",
        "joint_1",
        "root",
        "seam",
        "knee",
        "Weld",
    ],
    "drives": ["motor", "servo", "ram", "Spin", "w", "drive2"],
    "forces": ["pull", "wind", "F", "thrust", "f", "push_2", "load"],
    "torques": ["T", "brake", "moment_0", "tau", "twist"],
    "springs": ["spring", "k", "buffer", "coil", "mount", "S", "bush"],
    "inputs": ["u", "u2", "command", "in_1", "throttle"],
    "outputs": [
        "energy",
        "power",
        "y",
        "out",
        "tip_x",
        "stress",
        "n",
        "reaction_1",
        "force",
        "speed",
        "angle",
        "torque",
        "position",
        "value",
        "moment",
    ],
    "plots": ["bending", "p1", "curve", "Plot", "trace"],
    "parameters": ["A", "Omega", "P0", "omega_2", "c", "amplitude", "t0", "Te"],
    "tables": ["profile", "ramp", "tab", "lift"],
    "loads": ["gust", "pressure", "snow"],
    "masses": ["tip", "lump", "bob2", "head"],
}
"""Names in the style of users, some of one letter, some that kernels use as well."""


@dataclass
class Bar:
    """A body: its ends are at centre +- (length/2) (cos angle, sin angle) at t = 0, in the undeformed state.

    origin: the distance of the origin of a rigid body from the centre, along the bar; 0 for beams, whose `start` is
    that of the centre. markers: their distances from the centre over length/2, as xi of a beam.
    """

    name: str
    beam: bool
    length: float
    centre: Point
    angle: float
    mass: float
    origin: float = 0.0
    markers: dict[str, float] = field(default_factory=dict)
    prescribed: bool = False

    def at(self, marker: str) -> Point:
        """The position of a marker at t = 0, m."""
        return self.along(self.markers[marker] * self.length / 2)

    def along(self, distance: float) -> Point:
        """The point of the axis at a distance from the centre, m."""
        return (
            self.centre[0] + distance * math.cos(self.angle),
            self.centre[1] + distance * math.sin(self.angle),
        )


@dataclass
class JointSketch:
    """A joint with the markers that it connects, its kind, and whether it closes a loop."""

    name: str
    kind: str
    between: tuple[str, str]
    relative: float
    """The rotation of body 2 relative to body 1 at t = 0, rad."""
    displacement: float = 0.0
    loop: bool = False
    driven: bool = False


@dataclass
class Draft:
    """A scene that is being made.

    size: a typical length of its bodies, m; rate: the largest rate at which drives and loads change, rad/s; stiff: the
    highest natural frequency that its beams may have, rad/s, from which the duration follows.
    """

    draws: Draws
    size: float
    tables: Table = field(default_factory=dict)
    files: dict[str, str] = field(default_factory=dict)
    bars: dict[str, Bar] = field(default_factory=dict)
    ground: dict[str, Point] = field(default_factory=dict)
    joints: dict[str, JointSketch] = field(default_factory=dict)
    rate: float = 1.0
    stiff: float = 1.0
    gravity: float = 0.0
    linkage: str = ""
    names: set[str] = field(default_factory=set)
    symbols: dict[str, tuple[str, float]] = field(default_factory=dict)
    finishing: list[Callable[[], None]] = field(default_factory=list)

    def section(self, name: str) -> Table:
        """A top-level table of the scene, made on demand."""
        table: Table = self.tables.setdefault(name, {})
        return table

    def name(self, section: str) -> str:
        """A new name for a member of a section: no two names of a scene are alike, or begin with another and `_`."""
        for candidate in self.draws.shuffled(NAMES[section]):
            if self._free(candidate):
                return self._taken(candidate)
        number = 2
        while not self._free(f"{section[0]}{number}"):
            number += 1
        return self._taken(f"{section[0]}{number}")

    def _free(self, name: str) -> bool:
        lower = name.lower()
        return not any(
            lower == other or lower.startswith(f"{other}_") or other.startswith(f"{lower}_") for other in self.names
        )

    def _taken(self, name: str) -> str:
        self.names.add(name.lower())
        return name

    # ---- values ----

    def quantity(self, value: float, unit: str, parameter: float = 0.25) -> Any:
        """A constant: a number, or a parameter with a symbol."""
        draws = self.draws
        if draws.chance(parameter):
            shared = [symbol for symbol, like in self.symbols.items() if like == (unit, value)]
            symbol = shared[0] if shared else self.symbol()
            self.symbols[symbol] = (unit, value)
            return {"symbol": symbol, "default": value} | ({"unit": unit} if len(symbol) % 2 else {})
        return value

    def symbol(self) -> str:
        """A new symbol of a parameter."""
        number = len(self.symbols) + 1
        candidates = self.draws.shuffled(["m1", "L", "EI", "c", "k1", "beta", "a_1", "Ixx"])
        name = next((each for each in candidates if self._free(each)), f"par{number}")
        return self._taken(name)

    def ground_marker(self, at: Point) -> str:
        """A marker of the ground at a point."""
        name = "obcdefgh"[len(self.ground)]
        self.ground[name] = at
        self.section("ground").setdefault("markers", {})[name] = [
            self.quantity(at[0], "m", 0.05) if at[0] else 0,
            at[1],
        ]
        return f"ground.{name}"

    def position(self, marker: str) -> Point:
        """The position of a marker at t = 0, m."""
        body, name = marker.split(".")
        return self.ground[name] if body == "ground" else self.bars[body].at(name)

    def angle(self, marker: str) -> float:
        """The rotation of the body of a marker at t = 0, rad."""
        body = marker.split(".", maxsplit=1)[0]
        return 0.0 if body == "ground" else self.bars[body].angle

    def markers(self, beams: bool = False, ground: bool = False) -> list[str]:
        """All markers of bodies, of beams alone, or with those of the ground."""
        of_bodies = [f"{b.name}.{m}" for b in self.bars.values() if b.beam or not beams for m in b.markers]
        return of_bodies + ([f"ground.{name}" for name in self.ground] if ground else [])

    @property
    def weight(self) -> float:
        """A typical force, N: the mean weight of the bodies in the gravity of the Earth."""
        masses = [bar.mass for bar in self.bars.values()]
        return 9.81 * sum(masses) / len(masses)

    @property
    def beams(self) -> list[Bar]:
        """The flexible bodies."""
        return [bar for bar in self.bars.values() if bar.beam]


def written(value: float) -> float:
    """A position or an angle that has to agree with others."""
    return rounded(value, 12)
