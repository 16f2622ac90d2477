"""How the bodies of a scene are put together: trees, loops that close and can move, free and prescribed bodies.

A linkage places bars (`Bar`) and joins them; what the bars are made of, and what acts on them, is drawn later.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from corpus.draft import Bar, Draft, JointSketch, Point, Table, written
from corpus.draws import rounded
from derive import JOINTS
from derive.extensions import JointType, KeyType


def link(draft: Draft) -> None:
    """Draw a linkage, its bars and its joints."""
    names = [name for name, (weight, _) in LINKAGES.items() for _ in range(weight)]
    draft.linkage = draft.draws.choice(names)
    LINKAGES[draft.linkage][1](draft)
    for joint in draft.joints.values():
        draft.section("joints")[joint.name] = _joint_table(draft, joint)


# ---- bars and joints ----


def bar(draft: Draft, centre: Point, angle: float, length: float, beam: bool) -> Bar:
    """A new bar. All have markers at both ends, and some have others."""
    mass = rounded(length * draft.draws.scale(0.2, 3), 3)
    result = Bar(draft.name("bodies"), beam, length, centre, angle, mass)
    result.markers = {"left": -1.0, "right": 1.0}
    if draft.draws.chance(0.6):
        result.markers["middle"] = 0.0
    if draft.draws.chance(0.3):
        result.markers["inside"] = rounded(draft.draws.between(-0.8, 0.8), 2)
    draft.bars[result.name] = result
    return result


def bar_from(draft: Draft, start: Point, angle: float, length: float, beam: bool) -> Bar:
    """A bar whose left end is at a point."""
    centre = (start[0] + length / 2 * math.cos(angle), start[1] + length / 2 * math.sin(angle))
    return bar(draft, centre, angle, length, beam)


def bar_between(draft: Draft, left: Point, right: Point, beam: bool) -> Bar:
    """A bar from point to point."""
    x, y = right[0] - left[0], right[1] - left[1]
    return bar_from(draft, left, math.atan2(y, x), written(math.hypot(x, y)), beam)


def join(
    draft: Draft, kind: str, first: str, second: str, loop: bool = False, displacement: float = 0.0
) -> JointSketch:
    """Join two markers; their bodies are placed so that the joint fits."""
    relative = draft.angle(second) - draft.angle(first)
    joint = JointSketch(draft.name("joints"), kind, (first, second), relative, displacement, loop)
    draft.joints[joint.name] = joint
    return joint


def _joint_table(draft: Draft, joint: JointSketch) -> Table:
    """The table of a joint: each key that its type declares gets a value that fits the poses of the bodies."""
    joint_type: JointType = JOINTS[joint.kind]
    table: Table = {"kind": joint.kind, "between": list(joint.between)}
    for key in joint_type.keys:
        if key.name == "angle":
            if joint.relative or draft.draws.chance(0.5):
                table["angle"] = written(joint.relative)
        elif key.type is KeyType.DIRECTION:
            table[key.name] = _direction(draft, joint)
        else:
            raise NotImplementedError(f"the corpus knows no value for the key {key.name} of the joint {joint.kind}")
    return table


def _direction(draft: Draft, joint: JointSketch) -> list[float]:
    """The axis of a joint in the frame of body 1, such that the second marker is on the line."""
    first, second = map(draft.position, joint.between)
    x, y = second[0] - first[0], second[1] - first[1]
    angle = draft.angle(joint.between[0])
    if math.hypot(x, y) < 1e-9:
        return [draft.draws.choice([1, 3, 0.6]), draft.draws.choice([0, 4, -0.8])]
    sign = 1 if joint.displacement >= 0 else -1
    x, y = x * math.cos(angle) + y * math.sin(angle), y * math.cos(angle) - x * math.sin(angle)
    return [written(sign * x), written(sign * y)]


def moving_kinds() -> list[str]:
    """The kinds of joints that leave some relative motion."""
    return [kind for kind, joint_type in JOINTS.items() if joint_type.freedom]


def rigid_kinds() -> list[str]:
    """The kinds of joints that leave none."""
    return [kind for kind, joint_type in JOINTS.items() if not joint_type.freedom]


def _length(draft: Draft) -> float:
    return rounded(draft.size * draft.draws.between(0.5, 1.5), 2)


def _angle(draft: Draft) -> float:
    return draft.draws.choice([0.0, 0.0, rounded(draft.draws.between(-3, 3), 3)])


# ---- linkages ----


def _tree(draft: Draft) -> None:
    """1 to 6 bodies, each joined to the ground or to an earlier one."""
    _branches(draft, draft.draws.choice([1, 1, 1, 2, 2, 2, 2, 3, 3, 4, 5, 6]), draft.ground_marker((0.0, 0.0)))


def _branches(draft: Draft, count: int, root: str) -> None:
    draws = draft.draws
    for number in range(count):
        later = number and draws.chance(0.85)
        first = draws.choice(draft.markers()) if later else root
        kind = draws.choice(["revolute", "revolute", *moving_kinds(), draws.choice(rigid_kinds())])
        body = first.split(".")[0]
        if JOINTS[kind].rigid_first and body != "ground" and draft.bars[body].beam:
            kind = "revolute"
        beam, angle = draws.chance(0.6), _angle(draft)
        swapped = draws.chance(0.2) and not (JOINTS[kind].rigid_first and beam)
        at, displacement = draft.position(first), 0.0
        if any(key.type is KeyType.DIRECTION for key in JOINTS[kind].keys) and not swapped and draws.chance(0.7):
            displacement = draws.sign() * rounded(draft.size * draws.between(0.1, 0.5), 2)
            direction = draws.between(-3, 3)
            at = (at[0] + displacement * math.cos(direction), at[1] + displacement * math.sin(direction))
        second = f"{bar_from(draft, at, angle, _length(draft), beam).name}.left"
        pair = (second, first) if swapped else (first, second)
        join(draft, kind, *pair, displacement=displacement)


def _free(draft: Draft) -> None:
    """1 to 3 bodies in free flight, joined to each other."""
    first = bar(draft, (0.0, 0.0), _angle(draft), _length(draft), draft.draws.chance(0.8))
    count = draft.draws.choice([0, 0, 1, 2])
    if count:
        _branches(draft, count, f"{first.name}.right")


def _prescribed(draft: Draft) -> None:
    """A body whose motion is prescribed, with no mass, and others on it."""
    draws = draft.draws
    hub = bar_from(draft, (0.0, 0.0), _angle(draft), _length(draft), beam=False)
    hub.prescribed = True
    kind = draws.choice([kind for kind in moving_kinds() if JOINTS[kind].driven])
    join(draft, kind, draft.ground_marker((0.0, 0.0)), f"{hub.name}.left").driven = True
    _branches(draft, draws.choice([1, 1, 2, 3]), f"{hub.name}.right")


def _four_bar(draft: Draft) -> None:
    """A linkage whose crank can revolve: the shortest and the longest link are together shorter than the others."""
    draws, a = draft.draws, draft.size
    crank, coupler, rocker, base = (rounded(a * x, 2) for x in (0.4, 1.2, 1.0, 1.2))
    angle = rounded(draws.between(0.2, 2.9), 3)
    pin = (crank * math.cos(angle), crank * math.sin(angle))
    left, right = draft.ground_marker((0.0, 0.0)), draft.ground_marker((base, 0.0))
    knee = _knee(pin, (base, 0.0), coupler, rocker)
    links = [draws.chance(0.6) for _ in range(3)]
    bars = [
        bar_between(draft, (0.0, 0.0), pin, links[0]),
        bar_between(draft, pin, knee, links[1]),
        bar_between(draft, (base, 0.0), knee, links[2]),
    ]
    join(draft, "revolute", left, f"{bars[0].name}.left").driven = draws.chance(0.5)
    join(draft, "revolute", f"{bars[0].name}.right", f"{bars[1].name}.left")
    join(draft, "revolute", f"{bars[1].name}.right", f"{bars[2].name}.right", loop=True)
    join(draft, "revolute", right, f"{bars[2].name}.left")


def _knee(a: Point, b: Point, of_a: float, of_b: float) -> Point:
    """The point to the left of the line from a to b at the distances of_a and of_b from them."""
    x, y = b[0] - a[0], b[1] - a[1]
    d = math.hypot(x, y)
    along = (of_a**2 - of_b**2 + d**2) / (2 * d)
    height = math.sqrt(of_a**2 - along**2)
    return (a[0] + (along * x - height * y) / d, a[1] + (along * y + height * x) / d)


def _crank_slider(draft: Draft) -> None:
    """A crank, a rod and a slider on a guide; the guide is doubled sometimes, and then redundant."""
    draws, a = draft.draws, draft.size
    crank, rod = rounded(0.35 * a, 2), rounded(a * draws.between(0.9, 1.4), 2)
    angle = draws.choice([0.0, rounded(draws.between(0.3, 2.8), 3)])
    origin = draft.ground_marker((0.0, 0.0))
    pin = (crank * math.cos(angle), crank * math.sin(angle))
    end = (pin[0] + math.sqrt(rod**2 - pin[1] ** 2), 0.0)
    first = bar_between(draft, (0.0, 0.0), pin, draws.chance(0.5))
    second = bar_between(draft, pin, end, draws.chance(0.8))
    slider = bar(draft, end, 0.0, rounded(0.2 * a, 2), beam=False)
    slider.markers["middle"] = 0.0
    join(draft, "revolute", origin, f"{first.name}.left").driven = draws.chance(0.7)
    join(draft, "revolute", f"{first.name}.right", f"{second.name}.left")
    join(draft, "revolute", f"{second.name}.right", f"{slider.name}.middle", loop=True)
    join(draft, "translational", origin, f"{slider.name}.middle", displacement=end[0])
    if draws.chance(0.2):
        other = draft.ground_marker((rounded(2 * a, 2), 0.0))
        join(draft, "translational", other, f"{slider.name}.right", loop=True, displacement=-1.0)


def _parallelogram(draft: Draft) -> None:
    """Three equal cranks that carry a plate: with rigid bodies one of them is redundant."""
    draws, a = draft.draws, draft.size
    crank, plate = rounded(0.6 * a, 2), rounded(1.6 * a, 2)
    angle = rounded(draws.between(0.3, 2.8), 3)
    x, y = crank * math.cos(angle), crank * math.sin(angle)
    top = bar_between(draft, (x, y), (x + plate, y), draws.chance(0.2))
    top.markers["middle"] = 0.0
    for number, marker in enumerate(("left", "middle", "right")):
        foot = (number * plate / 2, 0.0)
        bar_ = bar_between(draft, foot, (foot[0] + x, y), draws.chance(0.2))
        root = join(draft, "revolute", draft.ground_marker(foot), f"{bar_.name}.left")
        root.driven = number == 0 and draws.chance(0.3)
        join(draft, "revolute", f"{bar_.name}.right", f"{top.name}.{marker}", loop=number > 0)


def _doubled(draft: Draft) -> None:
    """Two bodies that two joints of the same kind fix to each other, one of them redundant."""
    draws = draft.draws
    first = bar_from(draft, (0.0, 0.0), _angle(draft), _length(draft), beam=False)
    length = rounded(first.length / 2, 3)
    second = bar_from(draft, first.at("left"), first.angle, first.length, draws.chance(0.3))
    join(draft, "revolute", draft.ground_marker((0.0, 0.0)), f"{first.name}.left")
    kind = draws.choice(rigid_kinds())
    join(draft, kind, f"{first.name}.left", f"{second.name}.left")
    join(draft, "revolute", f"{first.name}.right", f"{second.name}.right", loop=True)
    bar_ = bar_from(draft, second.at("right"), _angle(draft), length, draws.chance(0.6))
    join(draft, "revolute", f"{second.name}.right", f"{bar_.name}.left")


LINKAGES: dict[str, tuple[int, Callable[[Draft], None]]] = {
    "tree": (6, _tree),
    "free": (3, _free),
    "prescribed": (3, _prescribed),
    "four_bar": (3, _four_bar),
    "crank_slider": (4, _crank_slider),
    "parallelogram": (1, _parallelogram),
    "doubled": (1, _doubled),
}
"""The linkages with how often they are drawn."""
REDUNDANT = ("crank_slider", "parallelogram", "doubled")
"""Linkages with redundant joints in some scenes."""
