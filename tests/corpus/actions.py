"""Random causes of the motion of a scene: gravity, drives, forces, torques, springs, loads, and initial values."""

from __future__ import annotations

import math
from typing import Any

from corpus.draft import Bar, Draft, JointSketch, Table, written
from corpus.draws import rounded
from corpus.time_functions import function, run_time_input, speed_function, value
from derive import FORCES, JOINTS
from derive.extensions import Key, KeyType

SECTIONS = ("forces", "torques", "springs")


def act(draft: Draft) -> None:
    """Draw all that acts on the bodies, and the initial values."""
    _gravity(draft)
    looped = any(joint.loop for joint in draft.joints.values())
    for joint in draft.joints.values():
        if joint.driven or (not looped and JOINTS[joint.kind].driven and draft.draws.chance(0.12)):
            _drive(draft, joint)
    for section in SECTIONS:
        for _ in range(draft.draws.choice([0, 0, 0, 1, 2])):
            _force(draft, section)
    for beam in draft.beams:
        if draft.draws.chance(0.15):
            _loads(draft, beam)
    _starts(draft)


def _gravity(draft: Draft) -> None:
    draws = draft.draws
    if draws.chance(0.35):
        return
    draft.gravity = 9.81
    across = draws.choice([0, 0, 0, 0.7, -3])
    draft.section("scene")["gravity"] = [
        draft.quantity(across, "m/s^2") if across else 0,
        draft.quantity(-9.81, "m/s^2"),
    ]


# ---- drives ----


def _drive(draft: Draft, joint: JointSketch) -> None:
    """Drive a joint from where it is, as fast as `draft.rate` at most."""
    draws, driven = draft.draws, JOINTS[joint.kind].driven
    assert driven is not None
    joint.driven = True
    angular = driven.unit == "rad"
    at = written(joint.relative if angular else joint.displacement)
    speed = draft.rate * draws.between(0.1, 0.6) * draws.sign() * (1 if angular else 0.15 * draft.size)
    table: Table = {"joint": joint.name}
    form = draws.choice(["speed", "speed", "motion", "motion", "motion", "input", "number"])
    if form == "number":
        table["motion"] = at
    elif form == "speed":
        function_of_t = draws.chance(0.4)
        table["speed"] = (
            speed_function(draft, speed) if function_of_t else draft.quantity(rounded(speed, 2), f"{driven.unit}/s")
        )
        if at or draws.chance(0.2):
            table["offset"] = at
    elif form == "input":
        table["motion"] = run_time_input(draft, speed / draft.rate, smooth=True, offset=at)
    else:
        motion = function(draft, speed / draft.rate, smooth=True, vanishes=True)
        table["motion"] = f"{at:.12g} + {motion}" if at else motion
    draft.section("drives")[draft.name("drives")] = table


# ---- forces, torques and springs ----


def _force(draft: Draft, section: str) -> None:
    """A force, torque or spring of one of the kinds that are registered, each key from what its type declares."""
    draws = draft.draws
    kinds = [kind for kind, force_type in FORCES.items() if force_type.section == section]
    kind = draws.choice(kinds)
    table: Table = {}
    if kind != kinds[0] or draws.chance(0.3):
        table["kind"] = kind
    ends: list[str] = []
    if section == "springs":
        table["between"] = ends = _two_bodies(draft)
    else:
        table["at"] = draws.choice(draft.markers())
        others = [marker for marker in draft.markers(ground=True) if marker != table["at"]]
        if section == "torques" and draws.chance(0.4):
            table["against"] = draws.choice(others)
    angular = kind in ("torque", "rotational")
    for key in FORCES[kind].keys:
        if key.name in table or not (key.required or draws.chance(0.5)):
            continue
        table[key.name] = _value(draft, key, kind, ends, angular)
    draft.section(section)[draft.name(section)] = table


def _two_bodies(draft: Draft) -> list[str]:
    """Two markers at some distance, such that a spring between them does not vanish."""
    draws = draft.draws
    first = draws.choice(draft.markers())
    others = [
        marker
        for marker in draft.markers(ground=True)
        if marker.split(".")[0] != first.split(".")[0]
        and math.dist(draft.position(first), draft.position(marker)) > 0.1 * draft.size
    ]
    if not others or draws.chance(0.2):
        x, y = draft.position(first)
        at = (rounded(x + draft.size * draws.between(0.3, 1), 2), rounded(y - draft.size * draws.between(0.3, 1), 2))
        others = [draft.ground_marker(at)]
    pair = [first, draws.choice(others)]
    return pair if draws.chance(0.7) else pair[::-1]


def _value(draft: Draft, key: Key, kind: str, ends: list[str], angular: bool) -> Any:
    """A value for a key of a force; `ends` are the markers between which it acts."""
    draws = draft.draws
    force = draft.weight * draws.scale(0.02, 0.5) * (draft.size if angular else 1)
    match key.type:
        case KeyType.FUNCTION:
            return value(draft, force)
        case KeyType.FUNCTION_PAIR:
            return [value(draft, force), value(draft, force)] if draws.chance(0.6) else [0, value(draft, force)]
        case KeyType.CHOICE:
            return draws.choice(key.choices)
        case KeyType.POSITIVE_QUANTITY | KeyType.NOT_NEGATIVE_QUANTITY | KeyType.QUANTITY:
            return draft.quantity(_constant(draft, key.name, ends, angular or key.name.endswith("rotation")), key.unit)
        case _:
            raise NotImplementedError(f"the corpus knows no value for the key {key.name} of the force {kind}")


def _constant(draft: Draft, name: str, ends: list[str], angular: bool) -> float:
    """A constant of a spring: its stiffness carries the weight of a body at a moderate extension."""
    draws, size = draft.draws, draft.size
    length = 1.0 if angular else size
    stiffness = draft.weight * (size if angular else 1) / length * draws.scale(0.5, 20)
    powers = {"quadratic": 1, "cubic": 2, "quartic": 3, "quintic": 4}
    if name.startswith("rest"):
        if angular:
            return rounded(draws.between(-0.3, 0.3), 2)
        apart = math.dist(*map(draft.position, ends)) if ends else size
        part = draws.between(0.7, 1.1) if name == "rest" else draws.between(-0.3, 0.3)
        return rounded(apart * part, 3)
    if name.startswith("damping"):
        return rounded(stiffness / draft.rate * draws.scale(1e-3, 0.05), 2)
    if name in powers:
        even = powers[name] % 2
        return rounded(stiffness / length ** powers[name] * draws.between(-0.1 if even else 0.05, 0.3), 2)
    return 0.0 if draws.chance(0.05) else rounded(stiffness, 2)


def _loads(draft: Draft, beam: Bar) -> None:
    draws = draft.draws
    per_length = beam.mass * 9.81 / beam.length * draws.scale(0.05, 0.5)
    size = f"{rounded(per_length, 2):g}"
    loads: Table = {}
    for _ in range(draws.choice([1, 1, 2])):
        across = draws.choice([f"{size}*(1 - xi^2)", f"{size}*xi", f"-{size}", f"{size}*(xi + xi^3)/2"])
        along = draws.choice([0, 0, rounded(per_length, 2), f"{size}*xi^2"])
        load: Table = {"force": [along, across]}
        if draws.chance(0.5):
            load["time"] = value(draft, 1.0)
        if draws.chance(0.5):
            load["frame"] = draws.choice(["inertial", "body"])
        loads[draft.name("loads")] = load
    draft.section("bodies")[beam.name]["loads"] = loads


# ---- initial values ----


def _starts(draft: Draft) -> None:
    """Initial values: of bodies, of joints, as first guesses, or none where none are needed."""
    draws = draft.draws
    looped = any(joint.loop for joint in draft.joints.values())
    closed, opened = ["given", "guess", "given"], ["given", "given", "guess", "joints", "angles", "none"]
    form = draws.choice(closed if looped else opened)
    if not draft.joints:
        form = draws.choice(["given", "none"])
    bodies = draft.section("bodies")
    for bar in draft.bars.values():
        at, angle = bar.along(bar.origin), bar.angle
        start: Table = {}
        if form == "given":
            start = {"position": [*map(written, at)], "angle": written(angle)}
            if not angle and draws.chance(0.7):
                del start["angle"]
        elif form == "guess":
            off = [rounded(x + 0.02 * draft.size * draws.between(-1, 1), 3) for x in at]
            start = {"position": off, "angle": rounded(angle + 0.05 * draws.between(-1, 1), 3), "guess": True}
        elif form == "angles":
            start = {"angle": written(angle)}
        if start:
            bodies[bar.name]["start"] = start | ({"guess": False} if form != "guess" and draws.chance(0.05) else {})
    if form == "joints":
        _joint_starts(draft)
    if looped and draws.chance(0.3) and not draft.tables.get("drives"):
        _first_speed(draft)
    if not looped:
        _motion(draft, form)
    still = all(not joint.driven for joint in draft.joints.values())
    grounded = any(joint.between[0].startswith("ground") for joint in draft.joints.values())
    if draft.gravity and still and grounded and not looped and form == "none" and draws.chance(0.6):
        draft.section("scene")["start"] = "equilibrium"


def _joint_starts(draft: Draft) -> None:
    draws = draft.draws
    for joint in draft.joints.values():
        driven = JOINTS[joint.kind].driven
        if driven is None or (joint.driven and draws.chance(0.5)):
            continue
        value = joint.relative if driven.unit == "rad" else abs(joint.displacement)
        start: Table = {"angle" if driven.unit == "rad" else "displacement": written(value)}
        if not joint.driven and draws.chance(0.4):
            start["speed"] = _speed(draft, driven.unit == "rad")
        if draws.chance(0.2):
            start["guess"] = draws.chance(0.8)
        _start_table(draft, joint)["start"] = start


def _start_table(draft: Draft, joint: JointSketch) -> Table:
    """The table of the initial values of a joint: that of its drive, sometimes, or of the joint."""
    for drive in draft.tables.get("drives", {}).values():
        if drive["joint"] == joint.name and draft.draws.chance(0.5):
            table: Table = drive
            return table
    result: Table = draft.section("joints")[joint.name]
    return result


def _first_speed(draft: Draft) -> None:
    """The crank of a linkage that nothing drives starts with a speed."""
    first = next(joint for joint in draft.joints.values() if not joint.loop)
    if JOINTS[first.kind].driven:
        draft.section("joints")[first.name]["start"] = {"speed": _speed(draft, True)}


def _speed(draft: Draft, angular: bool) -> float:
    return rounded(draft.rate * draft.draws.between(-0.5, 0.5) * (1 if angular else 0.3 * draft.size), 2)


def _motion(draft: Draft, form: str) -> None:
    """Velocities and deflections of bodies that are free to have them."""
    draws = draft.draws
    bodies = draft.section("bodies")
    for bar in draft.bars.values():
        names = [name for name, of in draft.joints.items() if any(m.split(".")[0] == bar.name for m in of.between)]
        joints = [draft.joints[name] for name in names]
        driven = any(drive["joint"] in names for drive in draft.section("drives").values())
        start = bodies[bar.name].get("start", {})
        if not joints and draws.chance(0.8):
            start["spin"] = _speed(draft, True)
            start["velocity"] = [_speed(draft, False), _speed(draft, False)]
        if bar.beam and _bends(draft, bar, joints) and draws.chance(0.4) and not driven:
            size = rounded(bar.length * draws.scale(1e-4, 5e-3), 2)
            start[draws.choice(["deflection", "deflection_rate"])] = f"{size:g}*(1 - xi^2)"
        if start:
            bodies[bar.name]["start"] = start


def _bends(draft: Draft, bar: Bar, joints: list[JointSketch]) -> bool:
    """Whether a beam may start bent as a parabola between its ends: its shapes hold one, and no joint objects."""
    table = draft.section("bodies")[bar.name]
    ansatz = table.get("ansatz", ["1", "xi", "xi^2"])
    hinged = all(joint.kind == "revolute" for joint in joints)
    ends = [m.split(".")[1] for joint in joints for m in joint.between if m.split(".")[0] == bar.name]
    parabola = isinstance(ansatz, list) and "xi^2" in ansatz and "ends" not in table
    return parabola and hinged and {*ends} <= {"left", "right"}
