"""All that acts on the bodies of a random scene in space, and what is observed: drives, loads, inputs, outputs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from corpus.draft import Table
from corpus.draws import rounded, words
from derive.mechanics.multibody.space.joints import SPATIAL_JOINTS, Freedom
from derive.mechanics.multibody.space.outputs import SPATIAL_OUTPUTS
from derive.mechanics.multibody.space.springs import SPATIAL_BUSHINGS, SPATIAL_SPRINGS
from derive.spec.model.instances import identifier
from derive.spec.model.keys import Key, KeyType
from derive.spec.model.spatial_forces import SpatialForce
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.tables.value_types import MAX_CURVES

if TYPE_CHECKING:
    from corpus.spatial_scenes import SpatialDraft

FUNCTIONS = ("sin({w}*t)", "(1 - cos({w}*t))", "{w}*t", "tanh({w}*t)", "(exp(-{w}*t) - 1)", "(sqrt(1 + ({w}*t)^2) - 1)")
"""Functions of time that vanish at t = 0, with values and rates of the order of 1 and w."""


def act_in_space(draft: SpatialDraft) -> None:
    """Draw gravity, drives, forces, torques, springs, inputs, outputs, plots, and the treatment of redundant joints."""
    draws = draft.draws
    if draws.chance(0.7) or draft.looped:
        draft.section("scene")["gravity"] = [0, rounded(draws.between(-3, 3), 2), draft.quantity(-9.81, "m/s^2")]
    if draws.chance(0.15):
        treatments = [word for word in words(SpatialScene, "redundant") if word != "error" or not draft.looped]
        draft.section("scene")["redundant"] = draws.choice(treatments)
    geared = _gears(draft) if not draft.looped else set()
    _drives(draft, geared)
    at = _markers(draft)
    if at:
        _loads(draft, at)
    observe_in_space(draft)


def observe_in_space(draft: SpatialDraft) -> None:
    """Draw outputs and a plot of them."""
    at = _markers(draft)
    if at:
        _outputs(draft, at)
        _plot(draft)


def _markers(draft: SpatialDraft) -> list[str]:
    """The markers of all bodies."""
    return [f"{name}.{marker}" for name, body in draft.section("bodies").items() for marker in body["markers"]]


def _turns(draft: SpatialDraft, marker: str) -> bool:
    """Whether a marker of a body has a rotation; one at a node has none."""
    body, name = marker.split(".")
    table = draft.section("bodies")[body]
    value = table["markers"][name]
    return "nodes" not in table or (isinstance(value, dict) and "nodes" in value)


def _function(draft: SpatialDraft, size: float, vanishes: bool = False) -> Any:
    """A function of time with values of about a size: a number, an expression, or one with a parameter."""
    draws = draft.draws
    value, w = rounded(size * draws.between(0.2, 1) * draws.sign(), 2), rounded(draft.rate, 2)
    if not vanishes and draws.chance(0.4):
        return value
    factor = f"{value:g}"
    if draws.chance(0.2):
        factor = draft.name("parameters")
        draft.section("parameters")[factor] = {"default": value} | ({"unit": "1"} if draws.chance(0.5) else {})
    return f"{factor}*{draws.choice(FUNCTIONS).format(w=f'{w:g}')}"


def input_or_function(draft: SpatialDraft, size: float, unit: str, vanishes: bool = False) -> Any:
    """A function of time, or a run-time input that follows one in simulations."""
    if not draft.draws.chance(0.2):
        return _function(draft, size, vanishes)
    name = draft.name("inputs")
    table: Table = {"value": _function(draft, size, vanishes)}
    draft.section("inputs")[name] = table | ({"unit": unit} if draft.draws.chance(0.5) else {})
    return {"input": name}


def _gears(draft: SpatialDraft) -> set[str]:
    """A gear between two joints sometimes; the names of those whose motion follows, so that nothing else gives it."""
    draws, joints = draft.draws, draft.tables.get("joints", {})
    coupled = {name: motion for name in joints if (motion := _coupled(joints[name]))}  # type: ignore[index]
    if len(coupled) < 2 or not draws.chance(0.6):
        return set()
    first, second = draws.shuffled([*coupled])[:2]
    ratio: Any = f"{draws.sign() * draws.whole(1, 40)}/{draws.whole(1, 40)}"
    if coupled[first] is not coupled[second]:  # of a rack
        ratio = rounded(draft.size * draws.between(0.05, 0.3) * draws.sign(), 2)
        ratio = ratio if coupled[second] is Freedom.DISPLACEMENT else rounded(1 / ratio, 2)
    gear: Table = {"joints": [first, second], "ratio": ratio}
    draft.section("gears")[draft.name("gears")] = gear | ({"offset": 0} if draws.chance(0.5) else {})
    return {second}


def _coupled(joint: Table) -> Freedom | None:
    """The motion of a joint that a gear couples."""
    of = SPATIAL_JOINTS[joint["kind"]]
    return of.couples(tuple(joint["removes"]) if of.removes is None else of.removes)


def _drives(draft: SpatialDraft, geared: set[str]) -> None:
    """Drive some joints, or give them a speed, but for those that gears move; in a loop at most the first one."""
    draws, driven = draft.draws, False
    for name, joint in draft.tables.get("joints", {}).items():  # type: ignore[attr-defined]
        freedom = SPATIAL_JOINTS[joint["kind"]].driven
        if name in geared:
            continue
        if freedom is None and not draft.looped:
            _start(draft, joint)
        if freedom is None or (draft.looped and driven):
            continue
        size = 0.5 if freedom is Freedom.ROTATION else 0.1 * draft.size
        if draws.chance(0.3):
            driven = True
            drive: Table = {"joint": name}
            if draws.chance(0.6):
                drive["motion"] = input_or_function(draft, size, freedom.unit, vanishes=True)
            else:
                drive["speed"] = rounded(size * draft.rate * draws.between(0.2, 1), 2)
            draft.section("drives")[draft.name("drives")] = drive
        elif not draft.looped and draws.chance(0.6):
            joint["start"] = {"speed": rounded(size * draft.rate * draws.between(-1, 1), 2)}
            if draws.chance(0.5):
                joint["start"]["angle" if freedom is Freedom.ROTATION else "displacement"] = 0


def _start(draft: SpatialDraft, joint: Table) -> None:
    """Initial values of a joint with several motions, of which none is driven; displacements vanish at the start."""
    draws, of = draft.draws, SPATIAL_JOINTS[joint["kind"]]
    start: Table = {}
    for motion in of.starts(tuple(joint["removes"]) if of.removes is None else of.removes):
        size = (0.5 if motion.freedom is Freedom.ROTATION else 0.1 * draft.size) * draft.rate
        several = len(motion.axes) > 1
        if draws.chance(0.3):
            start[motion.key] = [0] * len(motion.axes) if several else 0
        if draws.chance(0.5):
            rates = [rounded(size * draws.between(-1, 1), 2) for _ in motion.axes]
            start[motion.rate] = rates if several else rates[0]
    if start:
        joint["start"] = start | ({"guess": True} if draws.chance(0.2) else {})


def _loads(draft: SpatialDraft, at: list[str]) -> None:
    draws, force = draft.draws, 3.0 * draft.size
    frames = words(SpatialForce, "frame")
    if draws.chance(0.5):
        components = [input_or_function(draft, force, "N") for _ in range(3)]
        table: Table = {"at": draws.choice(at), "force": components}
        draft.section("forces")[draft.name("forces")] = table | {"frame": draws.choice(frames)}
    turning = [marker for marker in at if _turns(draft, marker)]
    if turning and draws.chance(0.5):
        on = draws.choice(turning)
        components = [input_or_function(draft, 0.1 * force, "N m") for _ in range(3)]
        table = {"on": on, "torque": components, "frame": draws.choice(frames)}
        others = [other for other in turning if other.split(".")[0] != on.split(".")[0]]
        if others and draws.chance(0.5):
            table["against"] = draws.choice(others)
        draft.section("torques")[draft.name("torques")] = table
    _in_joints(draft, force)
    for _ in range(draws.choice([0, 1, 1, 2])):
        _spring(draft, at, force)


def _in_joints(draft: SpatialDraft, force: float) -> None:
    """A force or a torque along or about the axis of a joint, or of several."""
    sections = (("forces", Freedom.DISPLACEMENT, force, "N"), ("torques", Freedom.ROTATION, 0.1 * force, "N m"))
    for section, motion, size, unit in sections:
        for name, joint in draft.tables.get("joints", {}).items():  # type: ignore[attr-defined]
            if _leaves(joint, motion) and draft.draws.chance(0.2):
                load = {"joint": name, "value": input_or_function(draft, size, unit)}
                draft.section(section)[draft.name(section)] = load


def _leaves(joint: Table, motion: Freedom) -> bool:
    """Whether the bodies of a joint may move along, or turn about, its z axis."""
    of = SPATIAL_JOINTS[joint["kind"]]
    return of.leaves(tuple(joint["removes"]) if of.removes is None else of.removes, motion)


def _spring(draft: SpatialDraft, at: list[str], force: float) -> None:
    """A spring or a bushing between a body and another one, or a point of the ground at some distance."""
    draws = draft.draws
    kind = draws.choice([*SPATIAL_SPRINGS, *SPATIAL_BUSHINGS])
    ends = [marker for marker in at if _turns(draft, marker) or kind == "linear"]
    if not ends:
        return
    second = draws.choice(ends)
    first = _far_marker(draft)
    stiffness = rounded(force / draft.size * draws.between(1, 5), 2)
    table: Table = {"kind": kind, "between": [first, second]}
    if kind in SPATIAL_BUSHINGS:
        values = [rounded(stiffness * draws.between(0.1, 0.3), 2) for _ in range(6)]
        matrix = [[value if i == j else 0 for j in range(6)] for i, value in enumerate(values)]
        matrix[0][4] = matrix[4][0] = rounded(0.05 * stiffness, 2)  # a force that turns
        table["stiffness"] = matrix if draws.chance(0.4) else values
        if draws.chance(0.5):
            table["damping"] = [rounded(0.01 * stiffness, 2)] * 6
    else:
        table["stiffness"] = draft.quantity(stiffness * (0.1 if kind == "rotational" else 1), "N/m")
        if draws.chance(0.5):
            table["damping"] = rounded(0.01 * stiffness, 2)
        if draws.chance(0.5):
            table["rest"] = rounded(draft.size, 2)
    draft.section("springs")[draft.name("springs")] = table


def _far_marker(draft: SpatialDraft) -> str:
    """A new marker of the ground that no body reaches."""
    at = draft.vector(draft.size)
    at[2] += 2 * draft.size
    return draft.marker(draft.ground, at, draft.rotation())


def _outputs(draft: SpatialDraft, at: list[str]) -> None:
    """Outputs of any kind that is registered, each key from what its type declares."""
    draws = draft.draws
    for kind in draws.some([*SPATIAL_OUTPUTS], 0.2):
        table: Table = {"kind": kind}
        for key in SPATIAL_OUTPUTS[kind].keys:
            if key.required or draws.chance(0.4):
                options = _options(draft, at, kind, key)
                if options or key.required:
                    table[key.name] = draws.choice(options) if options else None
        if None not in table.values():
            draft.section("outputs")[draft.name("outputs")] = table


def _apart(draft: SpatialDraft, at: list[str]) -> list[list[str]]:
    """The pairs of markers of two bodies that no joint connects: a line leads from one to the other."""
    joined = [{*joint["between"]} for joint in draft.tables.get("joints", {}).values()]  # type: ignore[attr-defined]
    pairs = ([first, second] for first in at for second in at)
    return [pair for pair in pairs if len({of.split(".")[0] for of in pair}) == 2 and {*pair} not in joined]


def _options(draft: SpatialDraft, at: list[str], kind: str, key: Key) -> list[Any]:
    """The values that a key of an output may have."""
    turning = [marker for marker in at if _turns(draft, marker)]
    match key.type:
        case KeyType.MARKER if kind == "deflection":
            return [marker for marker in at if {"nodes", "length"} & {*draft.section("bodies")[marker.split(".")[0]]}]
        case KeyType.MARKER if kind == "stress":
            return []  # no file of the corpus has elements with materials: tests/solids/test_stress_of_runs.py
        case KeyType.MARKER:
            return turning if key.name == "frame" or "rotation" in kind or kind.startswith("angular_") else at
        case KeyType.MARKER_PAIR if kind == "deflection":
            return [[_far_marker(draft), draft.draws.choice(at)]]
        case KeyType.BEAM_MARKER:
            return [marker for marker in at if "length" in draft.section("bodies")[marker.split(".")[0]]]
        case KeyType.QUANTITY:
            return [rounded(0.02 * draft.size, 2), draft.quantity(0.01 * draft.size, key.unit)]
        case KeyType.POSITIVE:
            return [rounded(draft.size, 2)]
        case KeyType.MARKER_PAIR:
            bodies = {marker.split(".")[0]: marker for marker in at}
            pairs = [[*bodies.values()][:2]] if len(bodies) > 1 else []
            return [pair for pair in [*pairs, *_apart(draft, at)] if kind != "angle" or pair in _apart(draft, at)][:1]
        case KeyType.JOINT:
            joints = draft.tables.get("joints", {})
            return [name for name in joints if kind == "reaction" or _has_coordinate(joints[name])]  # type: ignore[index]
        case KeyType.CHOICE:
            return [*key.choices]
        case KeyType.JOINT_LOAD:
            loads = {**draft.tables.get("forces", {}), **draft.tables.get("torques", {})}  # type: ignore[dict-item]
            return [name for name, of in loads.items() if "joint" in of]
        case KeyType.DRIVE | KeyType.SPRING:
            return [*draft.tables.get({KeyType.DRIVE: "drives", KeyType.SPRING: "springs"}[key.type], {})]
        case _:
            raise AssertionError(f"no values are known for the key {key.name} of an output")


def _has_coordinate(joint: Table) -> bool:
    """Whether a joint has a relative motion that outputs can measure."""
    return SPATIAL_JOINTS[joint["kind"]].driven is not None


def _plot(draft: SpatialDraft) -> None:
    """The components of an output over time, or over another one."""
    draws, outputs = draft.draws, draft.tables.get("outputs", {})
    columns = [
        identifier(name, label)
        for name, table in outputs.items()  # type: ignore[attr-defined]
        for label in SPATIAL_OUTPUTS[table["kind"]].labels
    ]
    if columns and draws.chance(0.5):
        y = draws.choice(columns) if draws.chance(0.5) else (draws.some(columns, 0.5) or columns)[:MAX_CURVES]
        plot: Table = {"y": y}
        draft.section("plots")[draft.name("plots")] = plot
