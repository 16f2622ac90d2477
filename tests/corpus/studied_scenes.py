"""Scenes of the corpus with what a study needs, which most of them lack: a plot of a beam, or loads that are constant.

Written beside the scene, so that its files are found. A scene to which nothing can be added stays what it is, and the
study says why it does not apply.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import tomlkit

import derive
from corpus.generator import CorpusScene
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene
from derive.spec.model.time_function import TimeFunction, value_at

Tables = dict[str, Any]


LOADS = ("components", "force", "torque")
"""The keys of the components of forces and torques."""


def plotted(scene: CorpusScene, path: Path) -> tuple[CorpusScene, str]:
    """The scene with a plot of the deflection of its first beam if it has none, and without a condition to end at.

    In space amplitudes do not start with values, which belong to the given shapes.
    """

    def change(tables: Tables, spec: AnyScene) -> None:
        tables["simulation"].pop("until", None)
        beam = next((name for name, body in tables["bodies"].items() if "length" in body), None)
        ends = ("left", "right")
        if isinstance(spec, SpatialScene):
            _without_start(tables, "amplitudes", "amplitude_rates")
            ends = ("first", "last")
        if not tables.get("plots") and beam is not None:
            markers = tables["bodies"][beam].setdefault("markers", {})
            markers |= {"halfway": 0, ends[0]: -1, ends[1]: 1}
            chord = [f"{beam}.{end}" for end in ends]
            tables["plots"] = {"bent": {"deflection": f"{beam}.halfway", "chord": chord}}

    return _changed(scene, path, "plotted", change)


def resting(scene: CorpusScene, path: Path) -> tuple[CorpusScene, str]:
    """The scene with drives that hold still, and with loads and inputs as they are at t = 0.

    In space bodies start at rest and undeformed: their velocities are hardly ever those of a steady rotation.
    """

    def change(tables: Tables, spec: AnyScene) -> None:
        if isinstance(spec, SpatialScene):
            _without_start(tables, "velocity", "angular_velocity", "amplitudes", "amplitude_rates")
        for drive in spec.drives:
            table = tables["drives"][drive.name]
            moved, held = table.pop("motion", None), table.pop("offset", 0)
            table.pop("speed", None)
            table["motion"] = held if moved is None or drive.motion is None else _now(drive.motion, moved)
        for section in ("forces", "torques"):
            for load in getattr(spec, section):
                table = tables[section][load.name]
                for key, function in vars(load).items():
                    if isinstance(function, TimeFunction):
                        table[key] = _now(function, table[key])
                    elif key in LOADS:
                        table[key] = [_now(f, v) for f, v in zip(function, table[key], strict=True)]
        for each in spec.inputs:
            table = tables["inputs"][each.name]
            if each.function is not None:
                table["value"] = _now(each.function, table["value"])
        for section in ("parameters", "tables"):
            used = set(re.findall(r"\w+", str({key: value for key, value in tables.items() if key != section})))
            tables[section] = {name: table for name, table in tables.get(section, {}).items() if name in used}

    return _changed(scene, path, "resting", change)


def _without_start(tables: Tables, *keys: str) -> None:
    """Remove initial values of bodies."""
    for body in tables["bodies"].values():
        for key in keys:
            body.get("start", {}).pop(key, None)


def _now(function: TimeFunction, written: Any) -> Any:
    """The value at t = 0; what is written if it depends on run-time inputs."""
    try:
        return value_at(function, 0.0)
    except ValueError:
        return written


def _changed(
    scene: CorpusScene, path: Path, name: str, change: Callable[[Tables, Any], None]
) -> tuple[CorpusScene, str]:
    """The changed scene, and its file."""
    spec = derive.read(path)
    if not isinstance(spec, AnyScene):
        return scene, str(path)
    tables = copy.deepcopy(scene.tables)
    change(tables, spec)
    result = path.with_name(f"{name}.toml")
    result.write_text(tomlkit.dumps(tables))
    return replace(scene, tables=tables, written=tables), str(result)
