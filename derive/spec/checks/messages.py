"""Conversion of the errors of pydantic to faults, with the path in the file and a sentence."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from derive.spec.checks.table_paths import TablePlace, place
from derive.spec.model.beam import BEAM_QUANTITIES
from derive.spec.parsing.faults import Fault, KeyPath, path_text, similar_name, unknown_key
from derive.spec.parsing.values import kind_of
from derive.spec.tables.beam import BEAM, BEAM_BODY, BEAM_KEYS
from derive.spec.tables.body import NODAL, SYMBOLIC
from derive.spec.tables.scene_bodies import RIGID
from derive.spec.tables.sections import SCENE
from derive.spec.tables.shared import Example, TomlTable
from derive.spec.tables.simulation import SIMULATION
from derive.spec.tables.specification import GROUND_TABLE, SCENE_TABLE, specification_table

MAX_FAULTS = 100


def key_faults(
    error: ValidationError,
    data: Mapping[str, object],
    written: Callable[[KeyPath], KeyPath] = lambda path: path,
    table: type[TomlTable] | None = None,
) -> list[Fault]:
    """The faults of single keys; of very many faults only the first are given.

    written: the path as it is written, for the path of a key of an instance. table: that of the whole specification.
    """
    faults: list[Fault] = []
    paths: set[KeyPath] = set()
    known: dict[object, Fault] = {}  # equal ones of other instances, since a fault takes long to describe
    left_out = 0
    for detail in error.errors(include_url=False):
        location = written(detail["loc"])
        if location not in paths and len(paths) == MAX_FAULTS:
            left_out += 1
            continue
        paths.add(location)
        alike = location, detail["type"], str(detail.get("ctx", {}).get("error")), kind_of(detail["input"])
        if alike not in known:
            known[alike] = _fault(detail, data, table or specification_table())
        fault = known[alike]
        in_instance = location != detail["loc"]
        faults.append(fault._replace(path=(*detail["loc"][:2], *fault.path[2:])) if in_instance else fault)
    if left_out:
        faults.append(Fault((), f"{left_out} more problems are not shown"))
    return faults


def _fault(error: ErrorDetails, data: Mapping[str, object], table: type[TomlTable]) -> Fault:
    at = place(table, error["loc"])
    match error["type"]:
        case "value_error":
            return Fault(at.path, str(error["ctx"]["error"]))
        case "missing":
            return Fault(at.path, f"this key is missing; write {_example(at, data)}")
        case "extra_forbidden":
            return Fault(at.path, _unknown_key(at, error["loc"], data, table))
        case "model_type":
            example = _example_of(at)
            such = f", such as {example.value}" if example and example.value else ""
            return Fault(at.path, f"a table is needed here{such}, not {kind_of(error['input'])}")
        case "invalid_key":
            return Fault(at.path, "a key has to be text")
    raise AssertionError(f"pydantic reports {error['type']}, for which there is no sentence yet")


_SYMBOLS = {
    **{key: parameter.symbol for key, parameter in BEAM_QUANTITIES.items()},
    "inertia": "I",
    "speed": "Omega",
    "stiffness": "k",
    "damping": "d",
    "rest": "l0",
}
"""The symbols of parameters in examples, by the keys whose values they are."""


def _example_of(at: TablePlace) -> Example | None:
    metadata = at.field.metadata if at.field else ()
    return next((item for item in metadata if isinstance(item, Example)), None)


def _example(at: TablePlace, data: Mapping[str, object]) -> str:
    """An example of a missing key."""
    match at.path:
        case (*_, "gravity", int(i), "symbol"):
            return f'symbol = "g{i + 1}"'
        case (*_, "gravity", int(), "default"):
            return "default = -9.81"
        case (*_, key, "symbol"):
            return f'symbol = "{_SYMBOLS.get(str(key), "a")}"'
        case ("name",):
            kind = "mechanism" if any(key in data for key in SCENE) else "block" if "body" in data else "free_beam"
            return f'name = "{kind}"'
    example = _example_of(at)
    assert example is not None, f"there is no example of {at.path} yet"
    return example.text


def _unknown_key(at: TablePlace, location: KeyPath, data: Mapping[str, object], whole: type[TomlTable]) -> str:
    path, key, table = at.path, str(at.path[-1]), at.table
    if len(path) == 1:
        tables = {"beam": (BEAM.model,), "body": (NODAL.model, SYMBOLIC.model)}
        if any(name in data for name in SCENE):
            tables = {"ground": (GROUND_TABLE,), "scene": (SCENE_TABLE,), "simulation": (SIMULATION.model,)}
        for name in sorted(tables, key=lambda name: name not in data):
            if any(key in model.model_fields for model in tables[name]):
                return f"this key belongs in the table [{name}]"
    if path[1:] == ("name",):
        return f"this key belongs above the table [{path[0]}]"
    if table is SYMBOLIC.model and key in NODAL.model.model_fields:
        return "a symbolic body has no such key: its numbers are run-time parameters; leave this or `integrals` out"
    # A drive has keys of its own for how it begins.
    if "start" in table.model_fields and path[0] != "drives":
        start = place(whole, (*location[:-1], "start"))
        if start.value and key in start.value.model_fields:
            return f"this key belongs in the table [{path_text(start.path)}]"
    if table in (RIGID.model, BEAM_BODY.model):
        return _unknown_key_of_body(key, table is BEAM_BODY.model)
    return unknown_key(key, table.model_fields)


def _unknown_key_of_body(key: str, beam: bool) -> str:
    """The message on an unknown key of a rigid body or a beam, which may belong to the other."""
    of_beam, of_rigid, keys = BEAM_BODY.model.model_fields, RIGID.model.model_fields, ", ".join(BEAM_KEYS)
    if key in of_beam and not beam:
        return f"a rigid body has no such key; leave it out, or make the body a beam by one of {keys}"
    if key in of_rigid and beam:
        return f"a beam has no such key; leave it out, or make the body rigid: without {keys}"
    if key == "gravity":
        return "gravity acts on all bodies; write it in the table [scene]"
    own, other, what = (of_beam, of_rigid, "beam") if beam else (of_rigid, of_beam, "rigid body")
    both = [*own, *(key for key in other if key not in own)]
    return f"unknown key{similar_name(key, both, f'the keys of a {what} are ' + ', '.join(own))}"
