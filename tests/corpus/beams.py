"""Random bodies: shape functions, frames, orders, stiffness, damping and masses of beams; rigid bodies."""

from __future__ import annotations

import math
from typing import Any

from corpus.draft import Bar, Draft, Table
from corpus.draws import rounded, words
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import FAMILY_FRAMES, ShapeFamily
from derive.spec.parsing.choices import FRAME_KINDS

SAG = (2e-5, 8e-3)
"""The deflection of a pinned beam under its own weight over its length, from which its stiffness follows."""
ROD = 22.4
"""The lowest natural frequency of a free beam with m = l = EI = 1."""


def make_bodies(draft: Draft) -> None:
    """Write the tables of all bars."""
    made: list[tuple[Bar, Table]] = []
    for bar in draft.bars.values():
        if not bar.beam:
            draft.section("bodies")[bar.name] = _rigid(draft, bar)
            continue
        table = beam_keys(draft, bar, scene=True)
        alike = [(like, other) for like, other in made if like.length == bar.length]
        if alike and draft.draws.chance(0.5):  # one kind of body, whose equations are derived once
            like, other = alike[-1]
            table |= {key: other[key] for key in ("mass", "bending_stiffness")}
            bar.mass = like.mass
        made.append((bar, table))
        draft.section("bodies")[bar.name] = table


def _rigid(draft: Draft, bar: Bar) -> Table:
    draws = draft.draws
    bar.origin = draws.choice([0.0, -bar.length / 2, rounded(draws.between(-0.3, 0.3) * bar.length, 2)])
    height = 0.0 if draws.chance(0.6) else rounded(0.1 * bar.length * draws.between(-1, 1), 2)
    table: Table = {}
    if not bar.prescribed or draws.chance(0.3):
        table["mass"] = draft.quantity(bar.mass, "kg")
        table["inertia"] = draft.quantity(rounded(bar.mass * bar.length**2 / draws.between(8, 16), 3), "kg m^2")
    centre = rounded(-bar.origin, 6)
    if centre or height or draws.chance(0.2):
        table["centre"] = [draft.quantity(centre, "m", 0.1) if centre else 0, height]
    table["markers"] = {}
    for name, xi in bar.markers.items():
        x = rounded(xi * bar.length / 2 - bar.origin, 12)
        table["markers"][name] = [draft.quantity(x, "m", 0.05) if x else 0, 0]
    if "mass" in table and draws.chance(0.15):
        table["keep_coordinates"] = draws.chance(0.8)
    return table


def beam_keys(draft: Draft, bar: Bar, scene: bool) -> Table:
    """The keys of a beam, of a scene or alone."""
    draws = draft.draws
    sag, length, mass = draws.scale(*SAG), bar.length, bar.mass
    stiffness = rounded(mass * 9.81 * length**2 * 5 / 384 / sag, 3)
    lowest = ROD * math.sqrt(stiffness / (mass * length**3))
    table, count = _shapes(draft, bar)
    table["mass"] = draft.quantity(mass, "kg")
    table["length"] = draft.quantity(length, "m")
    table["bending_stiffness"] = draft.quantity(stiffness, "N m^2")
    highest = lowest * (1, 1, 4, 13, 30, 60, 120)[min(count, 6)]
    plain = isinstance(table.get("ansatz", []), list) and "ends" not in table
    if scene and plain and draws.chance(0.2):
        table["pieces"] = draws.choice([1, 2, 2, 3])
        highest *= table["pieces"] ** 2
    if draws.chance(0.35):
        table["order"] = draws.choice([1, 2, 2])
        if table["order"] == 2 and draws.chance(0.5):
            table["terms"] = draws.choice(words(PlanarBeam, "terms"))
    if draws.chance(0.2):
        stretch = stiffness / length**2 * draws.scale(300, 3000)
        table["axial"] = axial_table(draft, stretch, stiffness / length**2, table.get("order", 1))
        highest = max(highest, 10 * math.sqrt(stretch / (mass * length)))
    if draws.chance(0.35):
        table["damping"] = damping_table(draft, lowest, table.get("pieces", 1))
    if draws.chance(0.2):
        full = table.get("order", 1) == 2 and "axial" in table
        table["masses"] = _masses(draft, bar, rotary=not full)
    table["markers"] = {name: _position(draft, xi) for name, xi in bar.markers.items()}
    draft.stiff = max(draft.stiff, highest)
    return table


def _position(draft: Draft, xi: float) -> Any:
    return str(int(xi)) if xi == int(xi) and draft.draws.chance(0.1) else int(xi) if xi == int(xi) else xi


def _shapes(draft: Draft, bar: Bar) -> tuple[Table, int]:
    """The keys of the shape functions of a beam, and about how many shapes there are."""
    draws = draft.draws
    table: Table = {}
    if draws.chance(0.2):
        kind = draws.choice(words(ShapeFamily, "kind"))
        count = draws.choice([1, 2, 3])
        table["ansatz"] = {"kind": kind, "count": count}
        if draws.chance(0.3):
            own = FAMILY_FRAMES[kind]
            table["frame"] = {"kind": own.kind} | ({"at": int(own.at)} if own.at is not None else {})
        return table, count + 1
    frame = draws.choice(["", *FRAME_KINDS, "mean", "mean"])
    if frame:
        table["frame"] = frame_value(draft, frame)
    degree = draws.choice([3, 3, 3, 4, 5])
    if frame == "given":
        table["ansatz"] = ["xi^2 - 1/3", "xi^3 - 3/5*xi", "xi^4 - 6/7*xi^2 + 3/35"][: degree - 1]
    elif degree > 3 or draws.chance(0.6):
        powers = ["1", "xi", *(f"xi^{power}" for power in range(2, degree + 1))]
        if draws.chance(0.2):
            powers[3] = "xi^3 - xi/2"
        table["ansatz"] = powers
    count = degree - 1
    if draws.chance(0.2):
        table["orthogonal"] = draws.chance(0.5)
    if degree == 5 and frame != "given" and draws.chance(0.4):
        table["ends"] = "pinned" if frame in ("point", "tangent") else draws.choice(words(PlanarBeam, "ends"))
        if table["ends"] == "free":
            table["ansatz"] = ["1", "xi", *(f"xi^{power}" for power in range(2, 7))]
    return table, count


def frame_value(draft: Draft, kind: str) -> Any:
    draws = draft.draws
    if kind == "tangent":
        return {"kind": kind, "at": draws.sign()}
    if kind == "point" and draws.chance(0.6):
        return {"kind": kind, "at": draws.choice([0, "1/2", -0.4, 0.25])}
    return kind if draws.chance(0.8) else {"kind": kind}


def axial_table(draft: Draft, stretch: float, euler: float, order: int) -> Table:
    draws = draft.draws
    table: Table = {"ansatz": draws.choice([["xi"], ["xi"], ["xi", "xi^2"], ["xi", "xi^3"]])}
    table["stiffness"] = draft.quantity(rounded(stretch, 3), "N")
    if order == 2 and draws.chance(0.6):
        table["preload"] = draft.quantity(rounded(euler * draws.between(-2, 4), 2), "N")
    return table


def damping_table(draft: Draft, lowest: float, pieces: int) -> Table:
    """Damping with a ratio between .1 and 5 % of the lowest free mode, in each form."""
    draws = draft.draws
    ratio = draws.scale(1e-3, 0.05)
    forms = ["mass", "stiffness", "both"] + (["ratio"] * 3 if pieces == 1 else [])
    form = draws.choice(forms)
    if form == "ratio":
        return {"ratio": draft.quantity(ratio, "1")}
    table: Table = {}
    if form in ("mass", "both"):
        table["mass"] = draft.quantity(rounded(2 * ratio * lowest, 2), "1/s")
    if form in ("stiffness", "both"):
        table["stiffness"] = draft.quantity(rounded(0.2 * ratio / lowest, 2), "s")
    return table


def _masses(draft: Draft, bar: Bar, rotary: bool) -> Table:
    draws = draft.draws
    masses: Table = {}
    for _ in range(draws.choice([1, 1, 2])):
        mass = rounded(bar.mass * draws.scale(0.05, 1), 2)
        attached: Table = {"at": draws.choice([1, -1, 0, "1/3", -0.6]), "mass": draft.quantity(mass, "kg")}
        if rotary and draws.chance(0.5):
            inertia = rounded(mass * (0.05 * bar.length) ** 2, 2)
            attached["inertia"] = draft.quantity(inertia, "kg m^2")
        masses[draft.name("masses")] = attached
    return masses
