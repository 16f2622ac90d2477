"""Conversion of the errors of pydantic to faults, with the path in the file and a sentence."""

from __future__ import annotations

from collections.abc import Mapping

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from derive.spec.checks import key_hints
from derive.spec.model.body import BEAM_QUANTITIES
from derive.spec.parsing.faults import Fault, KeyPath, path_text, unknown_key
from derive.spec.parsing.values import kind_of
from derive.spec.tables.beam_shapes import FrameTable, ShapeFamilyTable
from derive.spec.tables.body import BodyFrameTable, NodalTable, SymbolicTable, UnitsTable, kind_of_body
from derive.spec.tables.damping import DampingTable
from derive.spec.tables.free_beam import BeamTable
from derive.spec.tables.initial_values import BeamStartTable
from derive.spec.tables.shared import ParameterTable
from derive.spec.tables.spatial_start import RotationTable, SpatialStartTable
from derive.spec.tables.specification import SCENE, specification_table

MAX_FAULTS = 100


def key_faults(error: ValidationError, data: Mapping[str, object]) -> list[Fault]:
    """The faults of single keys; of very many faults only the first are given."""
    details = error.errors(include_url=False)
    faults = [_fault(detail, data) for detail in details[:MAX_FAULTS]]
    if len(details) > MAX_FAULTS:
        faults.append(Fault((), f"{len(details) - MAX_FAULTS} more problems are not shown"))
    return faults


_TABLES = {
    "damping": ", such as { ratio = 0.01 }",
    "axial": ', such as { ansatz = ["xi"], stiffness = 1e6 }',
}


def _fault(error: ErrorDetails, data: Mapping[str, object]) -> Fault:
    path = _path(error["loc"])
    match error["type"]:
        case "value_error":
            return Fault(path, str(error["ctx"]["error"]))
        case "missing":
            return Fault(path, f"this key is missing; write {_example(path, data)}")
        case "extra_forbidden":
            return Fault(path, _unknown_key(path, data))
        case "model_type":
            such = _TABLES.get(str(path[-1]) if path else "", "")
            return Fault(path, f"a table is needed here{such}, not {kind_of(error['input'])}")
        case "invalid_key":
            return Fault(path, "a key has to be text")
    raise AssertionError(f"pydantic reports {error['type']}, for which there is no sentence yet")


def _path(location: KeyPath) -> KeyPath:
    """The path of keys in the data, without the parts that pydantic inserts for unions and keys of dicts."""
    path: KeyPath = ()
    skip = False
    for part in location:
        if skip:
            skip = False
            continue
        path += (part,)
        skip = _is_union(path)
    return path[:-1] if path[-1:] == ("[key]",) else path


def _is_union(path: KeyPath) -> bool:
    match path:
        case (
            ("body",)
            | ("body", "start", "rotation")
            | ("beam" | "body", "frame")
            | ("beam", "ansatz")
            | ("body", "units")
            | ("beam" | "body", "gravity", int())
        ):
            return True
        case ("beam", *keys):
            return key_hints.is_beam_union(keys)
    return key_hints.is_union(path)


def _example(path: KeyPath, data: Mapping[str, object]) -> str:
    match path:
        case (*_, "gravity", int(i), "symbol"):
            return f'symbol = "g{i + 1}"'
        case (*_, "gravity", int(), "default"):
            return "default = -9.81"
        case (*_, str(key), "symbol") if key in BEAM_QUANTITIES:
            return f'symbol = "{BEAM_QUANTITIES[key].symbol}"'
        case ("body", "nodes"):
            return 'nodes = "block.npz"'
        case ("body", "units"):
            return 'units = "SI", or those of the files, such as { length = "mm", mass = "t", time = "s" }'
        case ("body", "units", key):
            return {"length": 'length = "mm"', "mass": 'mass = "t"'}.get(str(key), 'time = "s"')
        case ("body", "modes"):
            return "modes = 8"
        case ("body", "start", "rotation", "axis"):
            return "axis = [0, 0, 1]"
        case ("body", "start", "rotation", "angle"):
            return "angle = 0.5"
        case (_, "frame", "kind") | (_, _, "frame", "kind"):
            return 'kind = "point"'
        case (*_, "ansatz", key):
            return 'kind = "pinned"' if key == "kind" else "count = 3"
        case ("name",):
            kind = "mechanism" if any(key in data for key in SCENE) else "block" if "body" in data else "free_beam"
            return f'name = "{kind}"'
    return key_hints.example(path)


def _table(path: KeyPath, data: Mapping[str, object]) -> type[BaseModel]:
    """The model of the table at a path."""
    match path:
        case ():
            return specification_table()
        case ("beam",):
            return BeamTable
        case ("body",):
            return SymbolicTable if kind_of_body(data.get("body")) == "symbolic" else NodalTable
        case ("beam", "frame"):
            return FrameTable
        case ("beam", "ansatz") | ("bodies", _, "ansatz"):
            return ShapeFamilyTable
        case ("body", "frame"):
            return BodyFrameTable
        case ("body", "units"):
            return UnitsTable
        case ("body", "damping"):
            return DampingTable
        case ("beam", *keys) if of_beam := key_hints.beam_table(keys):
            return of_beam
        case ("beam", "start"):
            return BeamStartTable
        case ("body", "start"):
            return SpatialStartTable
        case ("body", "start", "rotation"):
            return RotationTable
    return key_hints.table(path, data) or ParameterTable


def _unknown_key(path: KeyPath, data: Mapping[str, object]) -> str:
    key, body = str(path[-1]), data.get("body")
    if len(path) == 1:
        tables = {"beam": {*BeamTable.model_fields}, "body": {*NodalTable.model_fields, *SymbolicTable.model_fields}}
        if any(name in data for name in SCENE):
            tables = key_hints.PLAIN_TABLES
        for name in sorted(tables, key=lambda name: name not in data):
            if key in tables[name]:
                return f"this key belongs in the table [{name}]"
    if path[1:] == ("name",):
        return f"this key belongs above the table [{path[0]}]"
    if path[0] == "body" and len(path) == 2 and kind_of_body(body) == "symbolic" and key in NodalTable.model_fields:
        return "a symbolic body has no such key: its numbers are run-time parameters; leave this or `integrals` out"
    table = _table(path[:-1], data)
    # A drive has keys of its own for how it begins.
    if "start" in table.model_fields and path[0] != "drives":
        start: KeyPath = (*path[:-1], "start")
        if key in _table(start, data).model_fields:
            return f"this key belongs in the table [{path_text(start)}]"
    return key_hints.unknown(path, data) or unknown_key(key, table.model_fields)
