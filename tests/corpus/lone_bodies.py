"""Specifications of a single body: a free planar beam, and flexible bodies in space."""

from __future__ import annotations

import math
from pathlib import Path

from corpus.beams import beam_keys
from corpus.draft import Bar, Draft, Table
from corpus.draws import Draws, rounded, words
from corpus.observations import STEPS
from derive.spec.files.node_format import LENGTHS, MASSES, TIMES
from derive.spec.model.body import NodalBody, SymbolicBody
from derive.spec.parsing.choices import BODY_FRAME_KINDS

LONE = {"beam": 0.06, "body": 0.04}
"""The share of scenes that are a single beam, or a body in space."""

SCENES = Path(__file__).parents[2] / "scenes"

Parts = tuple[Table, dict[str, str | Path]]
"""The tables of a specification, and the files beside it."""


def lone_beam(draws: Draws, name: str) -> Parts:
    """A `[beam]` with its simulation."""
    length = draws.scale(0.2, 2)
    draft = Draft(draws, size=length, rate=math.sqrt(9.81 / length))
    bar = Bar("beam", True, length, (0.0, 0.0), 0.0, rounded(length * draws.scale(0.2, 3), 3))
    bar.markers = {"left": -1.0, "inside": 0.25, "right": 1.0}
    beam = beam_keys(draft, bar, scene=False)
    if draws.chance(0.4):
        beam["gravity"] = [0, draft.quantity(-9.81, "m/s^2")]
    if draws.chance(0.6):
        beam["start"] = {
            "spin": rounded(draft.rate * draws.between(-1, 1), 2),
            "velocity": [0.3, rounded(draws.between(-1, 1), 2)],
        }
    tables: Table = {"name": name, "beam": beam}
    duration = rounded(min(0.5 / draft.rate, STEPS / max(draft.stiff, 1)), 2)
    tables["simulation"] = {"duration": duration, "output": rounded(duration / 20, 2)}
    if draws.chance(0.5):
        tables["plots"] = {"path": {"x": "beam_c1", "y": draws.choice(["beam_phi", ["beam_c2", "beam_alpha1"]])}}
    return tables, dict(draft.files)


def spatial_body(draws: Draws, name: str) -> Parts:
    """A `[body]`, with symbolic integrals, or by the nodes of the block of `scenes/`."""
    body: Table = {}
    files: dict[str, str | Path] = {}
    gravity = [0, rounded(draws.between(-1, 1), 2), {"symbol": "g", "default": -9.81}]
    if draws.chance(0.4):
        body["gravity"] = gravity
    if draws.chance(0.5):
        body["lowering"] = draws.choice(words(SymbolicBody, "lowering"))
    tables: Table = {"name": name, "body": body}
    if draws.chance(0.4):
        body |= {"integrals": "symbolic", "modes": draws.whole(1, 3)}
        if draws.chance(0.7):
            body["frame"] = draws.choice(words(SymbolicBody, "frame"))
        if draws.chance(0.5):
            body["damping"] = draws.chance(0.7)
        return tables, files
    solid = draws.chance(0.3)
    source = "solid_beam.npz" if solid else "block.npz"
    files[source] = SCENES / source
    body |= {"nodes": source, "units": "SI", "modes": draws.whole(1, 4), "markers": {"corner": 0, "far": 247}}
    if draws.chance(0.3):
        body["units"] = {
            "length": draws.choice([*LENGTHS]),
            "mass": draws.choice([*MASSES]),
            "time": draws.choice([*TIMES]),
        }
    frame = draws.choice(["", *BODY_FRAME_KINDS])
    if frame:
        body["frame"] = {"kind": frame} if frame == "point" or draws.chance(0.5) else frame
    if frame == "point":
        body["frame"] |= {"node": 127} | ({"around": [103, 151, 126, 128]} if draws.chance(0.5) else {})
    if draws.chance(0.3):
        body["orthonormal"] = draws.chance(0.5)
    if not solid and draws.chance(0.3):
        kind = draws.choice([*words(NodalBody, "component_modes")])
        body.pop("orthonormal", None)
        body["markers"]["side"] = 12
        least = {"free": 1, "craig_bampton": 3, "attachment": 9}[kind]
        body |= {"component_modes": kind, "modes": least + draws.whole(0, 1)}
        body |= {} if kind == "free" else {"interface": [*body["markers"]]}
    if draws.chance(0.5):
        form = draws.choice(["ratio", "mass", "stiffness"])
        body["damping"] = {form: {"ratio": 0.01, "mass": 2, "stiffness": 1e-6}[form]}
    if solid and draws.chance(0.6):
        body["order"] = draws.choice([1, 2])
    if solid and frame == "point":
        body["order"] = 1
    elif solid and body.get("order") != 1:
        body["markers"] = {"corner": 297, "far": 392}  # for forces there its file has a geometric stiffness
    body["start"] = {"angular_velocity": [rounded(draws.between(-20, 20), 2) for _ in range(3)]}
    if draws.chance(0.5):
        body["start"] |= {"velocity": [1, 0, 0], "position": [0, 0.5, 0]}
    if draws.chance(0.5):
        turns = [{"axis": [0, 1, 2], "angle": angle} for angle in (0.7, "7/10")]
        body["start"]["rotation"] = draws.choice([[1, 0, 0, 0], *turns])
    if draws.chance(0.5):
        body["start"] |= {"amplitudes": [1e-5], "amplitude_rates": [0.01]}
    second = 1e-3 if isinstance(body["units"], dict) and body["units"]["time"] == "ms" else 1.0
    tables["simulation"] = {"duration": 2e-3 * second, "output": 1e-4 * second}
    if draws.chance(0.4):
        tables["plots"] = {"spin": {"y": ["omega1", "omega2"]}}
    return tables, files
