"""Random scenes in space: trees with all joints, loops that can move, and flexible bodies of the block of `scenes/`.

Bodies are placed first. A joint is a frame somewhere between two bodies, which both of them have as a marker; all
coordinates of joints are zero at the start, so that every kind of joint fits and loops close.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from corpus import flexible_trees
from corpus.draft import NAMES, Table
from corpus.draws import Draws, rounded, words
from corpus.spatial_actions import act_in_space, observe_in_space
from corpus.spatial_beams import SHARE, beam_scene, initial_curves
from corpus.steady_scenes import steady_scene
from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS
from derive.spec.model.body import NodalBody

FIRST = 2000
"""The seeds of scenes in space begin here."""

BLOCK = Path(__file__).parents[2] / "scenes" / "block.npz"
FACE = (0, 1, 2, 3, 4, 5, 6, 7)
"""Nodes of the block that do not lie on a line, at one of its ends."""

Vector = np.ndarray
GEARED = ("revolute", "screw", "prismatic", "cylindrical", "planar")
"""Kinds of joints that gears couple."""
LOOPS = {
    "slider_crank": ("revolute", "spherical", "universal", "prismatic"),
    "four_bar_in_space": ("revolute", "spherical", "spherical", "revolute"),
    "four_parallel_axes": ("revolute",) * 4,
    "five_joints": ("revolute", "cylindrical", "spherical", "universal", "revolute"),
}
"""Kinds of joints around a loop that leave at least one degree of freedom."""


@dataclass
class SolidBody:
    """A body: the position x of the origin of its frame, and its rotation R, at t = 0."""

    name: str
    x: Vector
    R: Vector
    flexible: bool = False
    length: float = 0.0
    """The length of a beam, 0 of other bodies."""
    bends: int = 0
    """The number of shapes along e2 of a beam."""
    markers: dict[str, Vector] = field(default_factory=dict)
    """The markers with the axes that they have in the inertial frame."""


class SpatialDraft:
    """A scene in space while it is made."""

    def __init__(self, draws: Draws, name: str) -> None:
        self.draws, self.tables = draws, {"name": name}
        self.size = rounded(draws.scale(0.2, 1.5), 2)
        self.rate = rounded(math.sqrt(9.81 / self.size) * draws.between(0.5, 1.5), 2)
        self.bodies: dict[str, SolidBody] = {}
        self.ground = SolidBody("ground", np.zeros(3), np.eye(3))
        self.names: set[str] = {name}
        self.looped = False

    def section(self, name: str) -> Table:
        """A top-level table of the scene, made on demand."""
        table: Table = self.tables.setdefault(name, {})  # type: ignore[assignment]
        return table

    def name(self, section: str) -> str:
        """A new name for a member of a section."""
        options = [name for name in self.draws.shuffled(NAMES[section]) if self._free(name.lower())]
        name = options[0] if options else f"{section[0]}{len(self.names)}"
        self.names.add(name.lower())
        return name

    def _free(self, name: str) -> bool:
        return not any(
            name == other or name.startswith(f"{other}_") or other.startswith(f"{name}_") for other in self.names
        )

    def vector(self, size: float) -> Vector:
        return np.array([rounded(size * self.draws.between(-1, 1), 3) for _ in range(3)])

    def direction(self) -> Vector:
        """A unit vector."""
        while True:
            v = np.array([self.draws.between(-1, 1) for _ in range(3)])
            if 0.2 < v @ v < 1:
                return np.asarray(v / math.sqrt(v @ v))

    def rotation(self) -> Vector:
        """A rotation matrix: none, or any."""
        if self.draws.chance(0.25):
            return np.eye(3)
        return turned(self.direction(), self.draws.between(-3, 3))

    def quantity(self, value: float, unit: str) -> Any:
        """A constant, or a parameter."""
        if self.draws.chance(0.15):
            symbol = f"par{len(self.names)}"
            self.names.add(symbol)
            return {"symbol": symbol, "default": value, "unit": unit}
        return value

    def written_rotation(self, R: Vector) -> Any:
        """A rotation in one of its forms."""
        form = self.draws.choice(["quaternion", "axes", "axis", "angles"])
        if form == "axes":
            first, second = self.draws.choice([("x", "y"), ("y", "z"), ("z", "x"), ("z", "y")])
            return {name: listed(R[:, "xyz".index(name)]) for name in (first, second)}
        e = quaternion(R)
        if form == "quaternion":
            return listed(e)
        if form == "axis":
            length = math.sqrt(e[1:] @ e[1:])
            axis = e[1:] / length if length > 1e-9 else np.array([0.0, 0.0, 1.0])
            return {"axis": listed(axis), "angle": rounded(2 * math.atan2(length, e[0]), 15)}
        # Cardan angles: R = Rx(a) Ry(b) Rz(c)
        b = math.asin(max(-1.0, min(1.0, R[0, 2])))
        a, c = math.atan2(-R[1, 2], R[2, 2]), math.atan2(-R[0, 1], R[0, 0])
        return {"angles": listed(np.array([a, b, c])), "sequence": "xyz"}

    # ---- bodies and joints

    def body(self, flexible: bool) -> SolidBody:
        """A new body somewhere, which has no joint yet."""
        draws, name = self.draws, self.name("bodies")
        table: Table
        if flexible:
            table = {"nodes": BLOCK.name, "units": "SI", "modes": draws.whole(1, 3)}
            table |= {"frame": "mean"} if draws.chance(0.3) else {}
            if draws.chance(0.5):
                table["damping"] = {"ratio": 0.01} if draws.chance(0.7) else {"mass": 0.1, "stiffness": 1e-6}
        else:
            mass = rounded(draws.scale(0.2, 5), 2)
            sides = [self.size * draws.between(0.1, 0.6) for _ in range(3)]
            squares = sum(a * a for a in sides)
            inertia = [rounded(mass * (squares - a * a) / 12, 3) for a in sides]
            off = rounded(0.2 * min(inertia) * draws.between(-1, 1), 2) if draws.chance(0.5) else 0.0
            table = {"mass": self.quantity(mass, "kg"), "inertia": [*inertia, 0, off, 0]}
            if draws.chance(0.6):
                table["centre"] = listed(self.vector(0.2 * self.size))
            if draws.chance(0.3):
                table["keep_coordinates"] = draws.chance(0.8)
        return self.added(name, table, flexible)

    def added(self, name: str, table: Table, flexible: bool = False) -> SolidBody:
        """A body with a table, somewhere."""
        body = SolidBody(name, self.vector(self.size), self.rotation(), flexible)
        self.section("bodies")[name] = table | {"markers": {}}
        self.bodies[name] = body
        return body

    def marker(self, body: SolidBody, at: Vector, axes: Vector) -> str:
        """A marker of a rigid body, a beam or the ground at an inertial point with inertial axes, by its reference."""
        name = f"m{len(body.markers)}"
        body.markers[name] = axes
        place, turned_by = body.R.T @ (at - body.x), body.R.T @ axes
        position: Any = rounded(2 * place[0] / body.length, 12) if body.length else listed(place)
        plain = np.abs(turned_by - np.eye(3)).max() < 1e-12
        value = position if plain else {"at": position, "rotation": self.written_rotation(turned_by)}
        holder = self.section("ground") if body is self.ground else self.section("bodies")[body.name]
        holder.setdefault("markers", {})[name] = value
        return f"{body.name}.{name}"

    def joint(self, kind: str, first: SolidBody, second: SolidBody, at: Vector, axes: Vector) -> str:
        """A joint at an inertial point, along inertial axes; the markers of a flexible body decide both."""
        name = self.name("joints")
        ends = [self.marker(first, at, axes), self.marker(second, at, axes)]
        self.section("joints")[name] = {"kind": kind, "between": ends}
        if kind in ("revolute", "prismatic") and Draws(f"limits {ends}").chance(0.2):
            self.section("joints")[name]["limits"] = [-0.3, 0.2]  # type: ignore[index]
        if kind == "screw":
            pitch = self.size * self.draws.between(0.05, 0.5) * self.draws.choice([1, -1])
            self.section("joints")[name]["pitch"] = self.quantity(rounded(pitch, 2), "m")  # type: ignore[index]
        return name


def turned(axis: Vector, angle: float) -> Vector:
    """The rotation about a unit vector."""
    x, y, z = axis
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + math.sin(angle) * k + (1 - math.cos(angle)) * (k @ k))


def quaternion(R: Vector) -> Vector:
    """The quaternion of a rotation, scalar first and not negative."""
    squares = [1 + R[0, 0] + R[1, 1] + R[2, 2], *(1 + 2 * R[k, k] - np.trace(R) for k in range(3))]
    k = int(np.argmax(squares))
    axial = [R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]
    if k == 0:
        e = np.array([squares[0], *axial])
    else:
        e = np.array([axial[k - 1], *(R[k - 1, j] + R[j, k - 1] for j in range(3))])
        e[k] = squares[k]
    e = e / math.sqrt(e @ e)
    return np.asarray(-e if e[0] < 0 else e)


def listed(values: Vector) -> list[float]:
    """Numbers with 15 digits, which have to agree with others."""
    return [rounded(float(x), 15) for x in values]


# ---- scenes


def spatial_scene(draws: Draws, name: str) -> tuple[Table, dict[str, str | Path], str]:
    """The tables of a scene, the files beside it, and its linkage."""
    draft = SpatialDraft(draws, name)
    limbs = Draws(f"limbs {name}")
    if limbs.chance(flexible_trees.SHARE):
        draft.draws = limbs
        linkage = _timed(draft, flexible_trees.flexible_tree(draft))
        return draft.tables, _files(draft), linkage
    beams = Draws(f"beams {name}")
    if beams.chance(SHARE):
        draft.draws = beams
        return draft.tables, {}, _timed(draft, beam_scene(draft))
    linkage = draws.choice(["tree", "tree", "gears", "flexible", "free", "door", "steady", *LOOPS])
    if linkage in LOOPS:
        _loop(draft, LOOPS[linkage], parallel=linkage == "four_parallel_axes")
    elif linkage == "door":
        _door(draft)
    elif linkage == "steady":
        steady_scene(draft)
    elif linkage == "free":
        for _ in range(draws.whole(1, 2)):
            body = draft.body(flexible=draws.chance(0.3))
            if body.flexible and draws.chance(0.7):
                markers = {"face": {"nodes": [*FACE], "rotation": draft.written_rotation(draft.rotation())}}
                draft.section("bodies")[body.name]["markers"] = markers | {"corner": {"node": FACE[0]}}
    elif linkage == "gears":
        _tree(draft, flexible=False, kinds=GEARED)
    else:
        _tree(draft, flexible=linkage == "flexible")
    if linkage == "steady":
        observe_in_space(draft)
    else:
        act_in_space(draft)
    linkage = _timed(draft, linkage)
    return draft.tables, _files(draft), linkage


def _files(draft: SpatialDraft) -> dict[str, str | Path]:
    """The files of a scene: that of the block if it has one."""
    return {BLOCK.name: BLOCK} if any(body.flexible for body in draft.bodies.values()) else {}


def _timed(draft: SpatialDraft, linkage: str) -> str:
    """Complete a scene with its initial values and its duration; the name of the linkage."""
    if "start" not in draft.tables.get("scene", {}):  # else a steady one
        _starts(draft)
    duration = rounded(draft.draws.between(0.1, 0.4) / draft.rate, 2)
    in_pieces = any("pieces" in table for table in draft.tables["bodies"].values())  # they oscillate fast
    if in_pieces or any(body.flexible for body in draft.bodies.values()):
        duration = rounded(draft.draws.between(1, 3) * 1e-3, 2)
    draft.section("simulation").update({"duration": duration, "output": rounded(duration / 10, 2)})
    return f"spatial {linkage}"


def _tree(draft: SpatialDraft, flexible: bool, kinds: tuple[str, ...] = tuple(SPATIAL_JOINTS)) -> None:
    """Bodies that hang on each other or on the ground; a flexible one has a rigid one at its other end.

    kinds: those of the joints; if all of them may be in gears, there are two at least.
    """
    draws = draft.draws
    if flexible:
        _flexible_arm(draft)
        return
    before = [draft.ground]
    for _ in range(draws.whole(2 if kinds == GEARED else 1, 3)):
        body = draft.body(flexible=False)
        kind = draws.choice([*kinds])
        base = draws.choice(before)
        at = base.x + draft.vector(draft.size)
        first, second = (base, body) if draws.chance(0.7) else (body, base)
        axes = draft.rotation()
        if kind == "distance":
            _rod(draft, first, second, at)
        else:
            joint = draft.joint(kind, first, second, at, axes)
            table = draft.section("joints")[joint]
            if kind == "general":
                motions = draws.some(["x", "y", "z", "rx", "ry", "rz"], 0.5)
                table["removes"] = motions or ["z"]
        before.append(body)


def _door(draft: SpatialDraft) -> None:
    """A body on two hinges along one line, of which the second is redundant, and perhaps another body on it."""
    draws, door, axes = draft.draws, draft.body(flexible=False), draft.rotation()
    at = draft.vector(draft.size)
    for end in (at, at + rounded(0.5 * draft.size, 2) * axes[:, 2]):
        draft.joint("revolute", draft.ground, door, end, axes)
    draft.looped = True
    if draws.chance(0.5):
        draft.joint("spherical", door, draft.body(flexible=False), door.x, draft.rotation())


def _rod(draft: SpatialDraft, first: SolidBody, second: SolidBody, at: Vector) -> None:
    """A constant distance, which is that of the start."""
    length = rounded(draft.size * draft.draws.between(0.3, 1), 2)
    other = at + length * draft.direction()
    ends = [draft.marker(first, at, first.R), draft.marker(second, other, second.R)]
    draft.section("joints")[draft.name("joints")] = {"kind": "distance", "between": ends, "distance": length}


def block_with_ends(draft: SpatialDraft) -> tuple[SolidBody, Vector, Vector]:
    """The block with markers at both ends, root with axes and end at a node; the places of these at t = 0."""
    draws = draft.draws
    block = draft.body(flexible=True)
    table = draft.section("bodies")[block.name]
    nodes = np.load(BLOCK)["positions"]
    middle = (nodes.min(axis=0) + nodes.max(axis=0)) / 2
    near = np.flatnonzero(nodes[:, 0] == 0.0)
    far = int(np.argmin(((nodes - [0.4, 0.05, 0.03]) ** 2).sum(axis=1)))
    chosen = [int(near[0]), int(near[-1]), int(near[len(near) // 3]), int(near[len(near) // 2])]
    table["markers"] = {"root": {"nodes": chosen}, "end": far}
    if draws.chance(0.4):
        table["markers"]["root"]["weights"] = [1, 2, 1, 0.5]
    weights = np.array(table["markers"]["root"].get("weights", [1, 1, 1, 1]))
    at = block.x + block.R @ (weights @ nodes[chosen] / weights.sum() - middle)
    if draws.chance(0.3):
        modes = draws.choice([*words(NodalBody, "component_modes")])
        interface = ["root", "end"] if modes == "craig_bampton" and draws.chance(0.5) else ["root"]
        least = {"free": 1, "craig_bampton": 3 * len(interface) - 3, "attachment": 6}[modes]
        table |= {"component_modes": modes, "modes": max(least, 1) + draws.whole(0, 1)}
        table |= {} if modes == "free" else {"interface": interface}
    return block, at, block.x + block.R @ (nodes[far] - middle)


def _flexible_arm(draft: SpatialDraft) -> None:
    """The block, held at one end by a joint, with a rigid body on a ball joint at the other one."""
    draws = draft.draws
    block, at, tip = block_with_ends(draft)
    kind = draws.choice(["revolute", "spherical", "universal", "cylindrical", "fixed"])
    joint = draft.name("joints")
    ends = [draft.marker(draft.ground, at, block.R), f"{block.name}.root"]
    draft.section("joints")[joint] = {"kind": kind, "between": ends}
    if draws.chance(0.6):
        bob = draft.body(flexible=False)
        pair = [f"{block.name}.end", draft.marker(bob, tip, bob.R)]
        draft.section("joints")[draft.name("joints")] = {"kind": "spherical", "between": pair}


def _loop(draft: SpatialDraft, kinds: tuple[str, ...], parallel: bool) -> None:
    """A loop of bodies from the ground to the ground."""
    draft.looped = True
    bodies = [draft.ground, *(draft.body(flexible=False) for _ in kinds[1:]), draft.ground]
    common = draft.rotation()
    for i, kind in enumerate(kinds):
        across = common @ np.array([math.cos(1.9 * i + 0.3), math.sin(2.3 * i), 0.0])
        at = rounded(draft.size, 2) * across if parallel else draft.vector(draft.size)
        draft.joint(kind, bodies[i], bodies[i + 1], at, common if parallel else draft.rotation())


def _starts(draft: SpatialDraft) -> None:
    """Initial values of bodies: all of them, or first guesses; those of free bodies with velocities."""
    draws = draft.draws
    guess = "joints" in draft.tables and draws.chance(0.25)
    joined = {end.split(".")[0] for joint in draft.tables.get("joints", {}).values() for end in joint["between"]}  # type: ignore[attr-defined]
    for body in draft.bodies.values():
        x, R = body.x, body.R
        if guess:
            x, R = x + draft.vector(0.01 * draft.size), turned(draft.direction(), 0.01) @ R
        start: Table = {"position": listed(x), "rotation": draft.written_rotation(R)}
        if guess:
            start["guess"] = True
        elif body.name not in joined:
            start |= {"velocity": listed(draft.vector(draft.size)), "angular_velocity": listed(draft.vector(5))}
            if body.bends:
                bent = [rounded(1e-3 * body.length * draws.between(-1, 1), 2) for _ in range(body.bends)]
                rate = rounded(draws.between(-0.1, 0.1), 2)
                curves = initial_curves(draft.section("bodies")[body.name], bent[0], rate)
                start |= curves if bent[0] < 0 else {"amplitudes": bent, "amplitude_rates": [rate]}
            if body.flexible:
                start |= {"amplitudes": [1e-5], "amplitude_rates": [0.01]}
        draft.section("bodies")[body.name]["start"] = start
