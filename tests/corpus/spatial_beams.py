"""Random scenes in space with beams: alone, in trees, as an arm with a body at its tip, and in loops.

A beam lies along its e1 with its middle at the origin of its body, so that joints are at points of its axis; it is
stiff enough to carry its own weight. Few shapes keep the derivation short.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from corpus.beams import ROD, SAG, axial_table, damping_table, frame_value
from corpus.draft import Table
from corpus.draws import Draws, rounded, words
from corpus.spatial_actions import act_in_space, input_or_function, observe_in_space
from derive.spec.model.beam_parts import FAMILY_FRAMES, ShapeFamily
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_beam_parts import SpatialDistributedLoad
from derive.spec.parsing.choices import FRAME_KINDS

if TYPE_CHECKING:
    from corpus.spatial_scenes import SolidBody, SpatialDraft

SHARE = 0.25
"""The part of the scenes in space that have beams."""
LINKAGES = ("beam arm", "beam arm", "beam tree", "beam loop", "free beam", "spinning beam")
JOINTS = ("revolute", "spherical", "universal", "cylindrical", "fixed", "general")
"""How a beam is held."""
GIVEN = ["xi^2 - 1/3", "xi^3 - 3/5*xi"]
"""Shapes without rigid motion."""


def beam_scene(draft: SpatialDraft) -> str:
    """Draw a scene with beams; its linkage."""
    linkage = draft.draws.choice(LINKAGES)
    if linkage == "beam loop":
        _loop(draft)
    elif linkage == "free beam":
        _free(draft)
    elif linkage == "spinning beam":
        _spinning(draft)
        observe_in_space(draft)
        return linkage
    else:
        _tree(draft, draft.draws.whole(1, 2) if linkage == "beam tree" else 1)
    act_in_space(draft)
    return linkage


# ---- linkages


def _tree(draft: SpatialDraft, count: int) -> None:
    """Beams from the ground on, each at the tip of the last one, and perhaps a body at the last tip."""
    draws, at, base = draft.draws, draft.vector(draft.size), draft.ground
    for _ in range(count):
        beam = beam_body(draft, at)
        _joined(draft, draws.choice(JOINTS), base, beam, at)
        base, at = beam, tip(beam)
    if draws.chance(0.6):
        bob = draft.body(flexible=False)
        _joined(draft, draws.choice(("fixed", "spherical", "revolute", "prismatic")), base, bob, at)


def _joined(draft: SpatialDraft, kind: str, base: SolidBody, body: SolidBody, at: np.ndarray) -> None:
    first, second = (base, body) if draft.draws.chance(0.7) else (body, base)
    joint = draft.joint(kind, first, second, at, draft.rotation())
    if kind == "general":
        draft.section("joints")[joint]["removes"] = draft.draws.choice([["x", "y", "z"], ["x", "y", "z", "rz"]])


def _loop(draft: SpatialDraft) -> None:
    """Three bodies between hinges with parallel axes, or a slider-crank, of which the rod is a beam."""
    draws = draft.draws
    draft.looped = True
    kinds = draws.choice([("revolute",) * 4, ("revolute", "spherical", "universal", "prismatic")])
    axes = draft.rotation() if kinds[1] == "revolute" else None
    crank, rod, last = (
        draft.body(flexible=False),
        beam_body(draft, draft.vector(draft.size)),
        draft.body(flexible=False),
    )
    bodies = [draft.ground, crank, rod, last, draft.ground]
    places = [crank.x + draft.vector(draft.size), rod.x - _half(rod), rod.x + _half(rod), last.x + draft.vector(0.5)]
    for i, (kind, at) in enumerate(zip(kinds, places, strict=True)):
        draft.joint(kind, bodies[i], bodies[i + 1], at, draft.rotation() if axes is None else axes)


def _free(draft: SpatialDraft) -> None:
    """Beams that nothing holds, the markers of which loads may be at."""
    for _ in range(draft.draws.whole(1, 2)):
        beam = beam_body(draft, draft.vector(draft.size))
        for xi in draft.draws.some([-1, 0, 1], 0.7):
            draft.marker(beam, beam.x + xi * _half(beam), draft.rotation())


def _spinning(draft: SpatialDraft) -> None:
    """A shaft that turns, and a beam that is fixed to it: the start is the steady rotation near the straight beam."""
    draws = draft.draws
    draft.section("scene")["start"] = "steady"
    shaft, axes = draft.body(flexible=False), draft.rotation()
    axis, spin = axes[:, 2], rounded(draft.rate * draws.between(0.5, 2) * draws.sign(), 2)
    draft.joint("revolute", draft.ground, shaft, shaft.x, axes)
    root = shaft.x + draft.vector(0.2 * draft.size)
    beam = beam_body(draft, root, loads=False)  # which are not at rest in axes that rotate
    draft.joint("fixed", shaft, beam, root, draft.rotation())
    for body in (shaft, beam):
        draft.section("bodies")[body.name]["start"] = {
            "position": [float(x) for x in body.x],
            "rotation": draft.written_rotation(body.R),
            "velocity": [rounded(float(x), 15) for x in np.cross(spin * axis, body.x - shaft.x)],
            "angular_velocity": [rounded(float(x), 15) for x in body.R.T @ (spin * axis)],
        }


def _half(beam: SolidBody) -> np.ndarray:
    """The vector from the middle of a beam to its right end."""
    return np.asarray(beam.length / 2 * beam.R[:, 0])


def tip(beam: SolidBody) -> np.ndarray:
    """The right end of a beam, in the inertial frame."""
    return np.asarray(beam.x + _half(beam))


# ---- beams


def beam_body(draft: SpatialDraft, root: np.ndarray, loads: bool = True) -> SolidBody:
    """A new beam whose left end is at a point. loads: whether it may have distributed loads."""
    draws, length = draft.draws, draft.size
    mass, sag = rounded(draws.scale(0.2, 3), 2), draws.scale(*SAG)
    stiffness = rounded(mass * 9.81 * length**2 * 5 / 384 / sag, 3)
    order = draws.choice([1, 2])
    table, count = _shapes(draft)
    table |= {
        "length": draft.quantity(length, "m"),
        "mass": draft.quantity(mass, "kg"),
        "bending_stiffness": draft.quantity(stiffness, "N m^2"),
        "rotary_inertia": draft.quantity(rounded(mass * (length * draws.between(0.02, 0.1)) ** 2, 2), "kg m^2"),
    }
    if draws.chance(0.5):
        table["order"] = order
        terms = Draws(f"terms {stiffness}")  # apart, so that the other draws stay
        if order == 2 and terms.chance(0.25):
            table["terms"] = terms.choice(["truncated", "full"])
    else:
        order = 1
    lowest = ROD * math.sqrt(stiffness / (mass * length**3))
    if draws.chance(0.5):
        table["torsion"] = {
            "ansatz": draws.choice([["xi"], ["xi"], ["xi", "xi^2"]]),
            "stiffness": draft.quantity(rounded(stiffness * draws.between(0.5, 1), 2), "N m^2"),
        }
    if draws.chance(0.25):
        stretch = stiffness / length**2 * draws.scale(300, 1000)
        table["axial"] = axial_table(draft, stretch, stiffness / length**2, order)
    if draws.chance(0.35):
        centre = [rounded(0.03 * length * draws.between(-1, 1), 2) for _ in range(2)]
        table["centre"] = [draft.quantity(x, "m") for x in centre]
    if draws.chance(0.4):
        table["damping"] = damping_table(draft, lowest, 1)
    if draws.chance(0.4):
        lateral = table.setdefault("lateral", {})
        lateral["bending_stiffness"] = draft.quantity(rounded(stiffness * draws.between(0.5, 3), 2), "N m^2")
    if draws.chance(0.3) and "ends" not in table and not isinstance(table.get("ansatz"), dict):
        table["pieces"], count = draws.choice([1, 2, 2, 3]), 0
    _carried(draft, table, mass, length, loads)
    body = draft.added(draft.name("bodies"), table)
    body.length, body.bends = length, count
    body.x = root + _half(body)
    return body


def _carried(draft: SpatialDraft, table: Table, mass: float, length: float, loads: bool) -> None:
    """Masses and distributed loads on a beam, sometimes."""
    draws, weight = draft.draws, 9.81 * mass / length
    if draws.chance(0.3):
        own: Table = {"at": draws.choice([-1, 0, "1/3", 1]), "mass": draft.quantity(rounded(0.2 * mass, 2), "kg")}
        if draws.chance(0.6):
            J = rounded(0.2 * mass * (0.1 * length) ** 2, 2)
            own["inertia"] = [draft.quantity(J, "kg m^2"), J, rounded(1.2 * J, 3), 0, 0, 0]
        if draws.chance(0.5):
            own["centre"] = [rounded(0.05 * length * draws.between(-1, 1), 2) for _ in range(3)]
        table["masses"] = {"bob": own}
    if loads and draws.chance(0.3):
        load: Table = {}
        if draws.chance(0.7):
            load["force"] = [0, *(rounded(0.3 * weight * draws.between(-1, 1), 2) for _ in range(2))]
            load["force"][0] = draws.choice([0, f"{rounded(0.2 * weight, 2)}*xi"])
        if not load or draws.chance(0.3):
            load["torque"] = [rounded(0.02 * weight * length * draws.between(-1, 1), 2), 0, 0]
        if draws.chance(0.5):
            load["time"] = input_or_function(draft, 1.0, "1")
        if draws.chance(0.5):
            load["frame"] = draws.choice(words(SpatialDistributedLoad, "frame"))
        table["loads"] = {"wind": load}


def _shapes(draft: SpatialDraft) -> tuple[Table, int]:
    """The keys of the shapes of bending, and how many amplitudes there are along e2."""
    draws = draft.draws
    table: Table = {}
    if draws.chance(0.25):
        kind, count = draws.choice(words(ShapeFamily, "kind")), draws.choice([1, 2])
        table["ansatz"] = {"kind": kind, "count": count}
        if draws.chance(0.3):
            own = FAMILY_FRAMES[kind]
            table["frame"] = {"kind": own.kind} | ({"at": int(own.at)} if own.at is not None else {})
        return table | _lateral(draft, {"kind": kind, "count": 1}), count
    kind = draws.choice(["", *FRAME_KINDS, "tangent"])
    if kind:
        table["frame"] = frame_value(draft, kind)
    powers: list[str] = [*GIVEN] if kind == "given" else ["1", "xi", "xi^2", "xi^3"]
    if kind == "given" or draws.chance(0.4):
        table["ansatz"] = powers
    if draws.chance(0.2):
        table["orthogonal"] = draws.chance(0.5)
    if kind not in ("given", "") and draws.chance(0.25):
        table["ends"] = draws.choice(words(SpatialBeam, "ends"))
        table["ansatz"] = ["1", "xi", *(f"xi^{n}" for n in range(2, 7 if table["ends"] == "free" else 6))]
        if table["ends"] == "free" and kind in ("point", "tangent"):
            table["ends"] = "pinned"
        return table | _lateral(draft, None), 2
    return table | _lateral(draft, powers[:-1]), 2


def _lateral(draft: SpatialDraft, ansatz: Any) -> Table:
    """Another ansatz of the deflection along e3 sometimes, if there may be one."""
    return {"lateral": {"ansatz": ansatz}} if ansatz is not None and draft.draws.chance(0.3) else {}


def initial_curves(table: Table, size: float, rate: float) -> Table:
    """The initial deflections and the twist of a beam that its shapes have: `size` (m, rad) and `rate` at the end."""
    ansatz = table.get("ansatz")
    polynomials = isinstance(ansatz, list) and {"1", "xi"} <= {*ansatz} and not {"ends", "pieces"} & {*table}
    along_e2 = ansatz[-1] if polynomials else "xi"  # a straight line is in all shapes
    curves: Table = {"deflection": [f"{size}*{along_e2} + {-size}", f"{size}*xi"]}
    curves["deflection_rate"] = [0, f"{rate}*xi"]
    if "torsion" in table and "pieces" not in table:
        curves |= {"twist": f"{size}*{table['torsion']['ansatz'][-1]}", "twist_rate": f"{rate}"}
    return curves
