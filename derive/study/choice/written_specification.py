"""The specification of a chosen model: the text of the user with other keys of the beams, comments and all."""

from __future__ import annotations

import os
from collections.abc import MutableMapping
from pathlib import Path
from typing import Any

import tomlkit

from derive.simulation.observables.motion import si_value
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.scene import BeamBody, Scene
from derive.study.accuracy.models import FAMILIES, LadderModel, Shapes

BEAM_KEYS = ("ansatz", "frame", "orthogonal", "ends", "order", "terms", "pieces")
"""The keys of a beam that say how it is modelled."""
SCHEMA = "#:schema"


def chosen_specification(
    text: str, source: Path, target: Path, scene: Scene, model: LadderModel, tolerance: float
) -> str:
    """The TOML text with the beams modelled so and the tolerance of the simulation; files are found from `target`."""
    document = tomlkit.parse(text)
    name = f"{scene.name}_chosen"
    document["name"] = name
    for body in scene.bodies:
        if isinstance(body, BeamBody):
            _model_beam(document["bodies"][body.name], body, model)
    simulation: Any = document["simulation"]
    simulation["tolerance"] = tolerance
    for plot in document.get("plots", {}).values():
        for key in ("cut", "pieces"):
            plot.pop(key, None)
    _relocate(document, source.parent, target.parent)
    return _headed(tomlkit.dumps(document), source, target, model)


def _headed(text: str, source: Path, target: Path, model: LadderModel) -> str:
    """The text with a comment that says what it is, behind the schema that editors look for in the first line."""
    comment = f"# Chosen by tisserand choose: {model.label}. Other comments are those of {source.name}.\n"
    first, _, rest = text.partition("\n")
    if not first.startswith(SCHEMA):
        return comment + text
    schema = Path(os.path.relpath(source.parent / first.removeprefix(SCHEMA).strip(), target.parent)).as_posix()
    return f"{SCHEMA} {schema}\n{comment}{rest}"


def _model_beam(table: MutableMapping[str, Any], body: BeamBody, model: LadderModel) -> None:
    for key in BEAM_KEYS:
        table.pop(key, None)
    if model.shapes is Shapes.RIGID:
        _make_rigid(table, body)
        return
    if model.shapes in FAMILIES:
        family = tomlkit.inline_table()
        family.update({"kind": FAMILIES[model.shapes][0], "count": model.count})
        table["ansatz"] = family
    else:
        table["ansatz"] = ["1", "xi", *(f"xi^{n}" for n in range(2, model.count + 2))]
        table["frame"] = model.frame
    if model.order is not DisplacementOrder.FIRST_ORDER:
        table["order"] = 2
        table["terms"] = "full" if model.order is DisplacementOrder.FULL else "truncated"
    if model.pieces > 1:
        table["pieces"] = model.pieces


def _make_rigid(table: MutableMapping[str, Any], body: BeamBody) -> None:
    """Mass, inertia and markers of a slender rigid rod in place of what a beam has."""
    mass, length = si_value(body.beam.mass), si_value(body.beam.length)
    for key in ("length", "bending_stiffness", "damping", "axial"):
        table.pop(key, None)
    table["mass"] = mass
    table["inertia"] = mass * length**2 / 12
    markers = tomlkit.inline_table()
    markers.update({m.name: [float(m.at) * length / 2, 0.0] for m in body.beam.markers})
    table["markers"] = markers
    start = table.get("start")
    if start is not None:
        for key in ("deflection", "deflection_rate"):
            start.pop(key, None)


def _relocate(table: Any, source: Path, target: Path) -> None:
    """Names of files beside the source, as they are called from the folder of the target."""
    if isinstance(table, MutableMapping):
        for key, value in table.items():
            if key == "file" and isinstance(value, str) and not Path(value).is_absolute():
                table[key] = Path(os.path.relpath(source / value, target)).as_posix()
            else:
                _relocate(value, source, target)
    elif isinstance(table, list):
        for value in table:
            _relocate(value, source, target)
