"""The specification of a chosen model: the text of the user with other keys of the beams, comments and all."""

from __future__ import annotations

import os
from collections.abc import Iterator, MutableMapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomlkit

from derive.simulation.observables.default_plots import output_columns
from derive.spec.as_tables import as_table
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.plots import ColumnCurves
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_forces import SpatialTorque
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene
from derive.spec.tables.instance_tables import instance_tables
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.modelled_bodies import Flexible, flexible_members, modelled_member
from derive.study.accuracy.models import deformed_markers, start_remainders
from derive.study.accuracy.rigid_beam import rigid_loads
from derive.study.accuracy.spatial_rigid import rigid_actions
from derive.study.choice.written_bodies import toml_value, write_body

SCHEMA = "#:schema"
NODES = "nodes"
"""The key of the files of a finite-element body: one, or one for each array."""
FILES = ("file", "mesh", NODES)
"""The keys whose texts are files."""


@dataclass(frozen=True)
class WrittenSpecification:
    """A specification as TOML, and a line on each part that is left out or approximate."""

    text: str
    notes: tuple[str, ...]


def chosen_specification(
    text: str, source: Path, target: Path, scene: AnyScene, model: LadderModel, tolerance: float
) -> WrittenSpecification:
    """The TOML text with the keys of a model and the tolerance; paths are relative to the folder of `target`."""
    document = tomlkit.parse(text)
    _write_instances(document)
    name = f"{scene.name}_chosen"
    document["name"] = name
    for body in flexible_members(scene):
        if model.of(body.name).shapes is Shapes.RIGID:
            _carry_loads(document, body)
        write_body(document["bodies"][body.name], body, modelled_member(scene, body, model.of(body.name)))
    simulation: Any = document["simulation"]
    simulation["tolerance"] = tolerance
    for plot in document.get("plots", {}).values():
        for key in ("cut", "pieces"):
            plot.pop(key, None)
    notes = (*start_remainders(scene, model), *_without_deformations(document, scene, model))
    _relocate(document, source.parent, target.parent)
    return WrittenSpecification(_headed(tomlkit.dumps(document), source, target, model), notes)


def _write_instances(document: tomlkit.TOMLDocument) -> None:
    """Write the instances of tables with `count` in their place, since each may have a model of its own."""
    tables = instance_tables(document.unwrap())
    for section in dict.fromkeys(str(section) for section, _ in tables.counts):
        written = tomlkit.table(is_super_table=True)
        for name, table in tables.data[section].items():  # type: ignore[attr-defined]  # a specification without faults
            written[name] = toml_value(table)
        document[section] = written


def _without_deformations(document: MutableMapping[str, Any], scene: AnyScene, model: LadderModel) -> Iterator[str]:
    """Remove the outputs of deformations of bodies that are rigid now, and the curves of plots that show them."""
    rigid = {body.name for body in flexible_members(scene) if model.of(body.name).shapes is Shapes.RIGID}
    in_space = isinstance(scene, SpatialScene)
    gone: dict[str, str] = {}  # the columns that are removed, and the output of each
    for output in scene.outputs:
        bodies = [marker.body for marker in deformed_markers(output, in_space) if marker.body in rigid]
        if bodies:
            del document["outputs"][output.name]
            yield f"outputs.{output.name}: left out, since {bodies[0]} is rigid"
            gone.update(dict.fromkeys(output_columns(output, in_space), output.name))
    for plot in scene.plots:
        if not isinstance(plot.quantity, ColumnCurves):
            continue
        x, y = plot.quantity.x, plot.quantity.y
        names = ", ".join(dict.fromkeys(gone[column] for column in (x, *y) if column in gone))
        kept = [column for column in y if column not in gone]
        if not names:
            continue
        if kept and x not in gone:
            document["plots"][plot.name]["y"] = kept
            yield f"plots.{plot.name}: the curves of {names} are left out"
        else:
            del document["plots"][plot.name]
            yield f"plots.{plot.name}: left out, since it shows {names}"


def _headed(text: str, source: Path, target: Path, model: LadderModel) -> str:
    """The text with a comment on its origin, behind the schema that editors expect in the first line."""
    comment = f"# Chosen by tisserand choose: {model.label}. Other comments are those of {source.name}.\n"
    first, _, rest = text.partition("\n")
    if not first.startswith(SCHEMA):
        return comment + text
    schema = relative_path(source.parent / first.removeprefix(SCHEMA).strip(), target.parent)
    return f"{SCHEMA} {schema}\n{comment}{rest}"


def _carry_loads(document: MutableMapping[str, Any], body: Flexible) -> None:
    """Write forces and torques on a rigid body in place of the loads on a beam."""
    if isinstance(body, FlexibleBody) or not body.loads:
        return
    document["bodies"][body.name].pop("loads")
    for action in rigid_loads(body) if isinstance(body, BeamBody) else rigid_actions(body):
        section = "torques" if isinstance(action, SpatialTorque) else "forces"
        table = tomlkit.table()
        table.update(toml_value(as_table(action)))
        document.setdefault(section, tomlkit.table(is_super_table=True))[action.name] = table


def relative_path(path: Path, folder: Path) -> str:
    """A path relative to a folder, as TOML has it; the whole path where none is relative, as on another drive."""
    try:
        return Path(os.path.relpath(path, folder)).as_posix()
    except ValueError:
        return path.resolve().as_posix()


def _relocate(table: Any, source: Path, target: Path) -> None:
    """Rewrite the relative paths of files, from the folder of the source to the folder of the target."""
    if isinstance(table, MutableMapping):
        for key, value in table.items():
            if key in FILES and isinstance(value, str) and not Path(value).is_absolute():
                table[key] = relative_path(source / value, target)
            elif key == NODES and isinstance(value, MutableMapping):
                for array, file in value.items():
                    value[array] = relative_path(source / file, target)
            else:
                _relocate(value, source, target)
    elif isinstance(table, list):
        for value in table:
            _relocate(value, source, target)
