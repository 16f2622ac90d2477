"""All faults of the data of a specification at once, each as its path and a sentence of our own."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from derive.spec import paper
from derive.spec.beam_tables import BeamTable, FrameTable, ShapeKeys
from derive.spec.body import NodeData
from derive.spec.body_tables import (
    BodyFrameTable,
    DampingTable,
    NodalTable,
    SymbolicTable,
    UnitsTable,
    kind_of_body,
)
from derive.spec.errors import quoted
from derive.spec.faults import Fault, KeyPath, unknown_key
from derive.spec.names import name_problem
from derive.spec.references import Rows, references
from derive.spec.schema import Specification
from derive.spec.specification import Specification as Specified
from derive.spec.tables import MAX_MARKERS, ParameterTable, SignedTable
from derive.spec.values import kind_of

MAX_FAULTS = 100
QUANTITIES = {"mass": paper.MASS, "length": paper.LENGTH, "bending_stiffness": paper.BENDING_STIFFNESS}
INTEGRALS = "m|c[1-8](_[0-9]+)*|[kb](_[0-9]+)*|(x|phi)[0-9]+(_[0-9]+)*"
"""The names of the parameters of a body in space: m, c2_1_3, C3, C3_11, K_1_2, B_1_2, and X1, Phi1 of its markers."""


def checked(data: Mapping[str, object], folder: Path) -> Specified | list[Fault]:
    """What `data` specify, with files of numbers relative to `folder`; or all that is wrong with them."""
    specification = None
    faults: list[Fault] = []
    try:
        specification = Specification.model_validate(data)
    except ValidationError as error:
        details = error.errors(include_url=False)
        faults = [_fault(one, data) for one in details[:MAX_FAULTS]]
        if len(details) > MAX_FAULTS:
            faults.append(Fault((), f"{len(details) - MAX_FAULTS} more problems are not shown"))
    bodies = list(_one_body(data))
    if "beam" in data and "body" in data:
        return bodies  # what else there is follows from this
    faults += bodies
    faults += _repeated_names(data)
    faults += _names_of_integrals(data)
    faults += _shape_faults(data)
    nodes, node_faults = _nodes(data, specification, folder)
    curves, curve_faults = references(data, folder)
    faults += node_faults + curve_faults
    if specification is None or faults:
        return faults
    return _specified(specification, nodes, curves)


def _specified(specification: Specification, nodes: NodeData | None, curves: Mapping[str, Rows]) -> Specified:
    name, body = specification.name, specification.body
    if specification.bodies is not None:
        return specification.scene_of(curves)
    if isinstance(body, SymbolicTable):
        return body.body(name)
    if isinstance(body, NodalTable):
        assert nodes is not None
        return body.body(name, nodes)
    assert specification.beam is not None
    return specification.beam.free_beam(name)


def _one_body(data: Mapping[str, object]) -> Iterator[Fault]:
    if "bodies" in data:
        return
    if "beam" in data and "body" in data:
        yield Fault(("body",), "a file specifies one body, and here are [beam] and [body]; leave one of them out")
    elif "beam" not in data and "body" not in data:
        yield Fault(("beam",), "this key is missing; write [beam], or [body] for a body in space")


def _fault(error: ErrorDetails, data: Mapping[str, object]) -> Fault:
    path = _path(error["loc"])
    match error["type"]:
        case "value_error":
            return Fault(path, str(error["ctx"]["error"]))
        case "missing":
            return Fault(path, f"this key is missing; write {_example(path)}")
        case "extra_forbidden":
            return Fault(path, _unknown_key(path, data))
        case "model_type":
            such = ", such as { ratio = 0.01 }" if path == ("body", "damping") else ""
            return Fault(path, f"a table is needed here{such}, not {kind_of(error['input'])}")
        case "invalid_key":
            return Fault(path, "a key has to be text")
    raise AssertionError(f"pydantic reports {error['type']}, for which there is no sentence yet")


def _path(location: KeyPath) -> KeyPath:
    """The keys of the data, without what pydantic puts between them for unions and keys of dicts."""
    path: KeyPath = ()
    skip = False
    for part in location:
        if skip:
            skip = False
            continue
        path += (part,)
        skip = _is_union(path)
    return path[:3] if path[1:2] == ("markers",) else path


def _is_union(path: KeyPath) -> bool:
    match path:
        case ("body",) | ("beam" | "body", "frame") | ("body", "units") | ("beam" | "body", "gravity", int()):
            return True
        case ("beam", key):
            return key in QUANTITIES
    return False


def _example(path: KeyPath) -> str:
    match path:
        case (*_, "gravity", int(i), "symbol"):
            return f'symbol = "g{i + 1}"'
        case (*_, "gravity", int(), "default"):
            return "default = -9.81"
        case (*_, key, "symbol"):
            return f'symbol = "{QUANTITIES[str(key)].symbol}"'
        case ("body", "nodes"):
            return 'nodes = "block.npz"'
        case ("body", "units"):
            return 'units = "SI", or those of the files, such as { length = "mm", mass = "t", time = "s" }'
        case ("body", "units", key):
            return {"length": 'length = "mm"', "mass": 'mass = "t"'}.get(str(key), 'time = "s"')
        case ("body", "modes"):
            return "modes = 8"
        case (*_, "kind"):
            return 'kind = "point"'
    return 'name = "free_beam"'


def _table(path: KeyPath, body: object) -> type[BaseModel]:
    """The model of the table at a path."""
    match path:
        case ():
            return Specification
        case ("beam",):
            return BeamTable
        case ("body",):
            return SymbolicTable if kind_of_body(body) == "symbolic" else NodalTable
        case ("beam", "frame"):
            return FrameTable
        case ("body", "frame"):
            return BodyFrameTable
        case ("body", "units"):
            return UnitsTable
        case ("body", "damping"):
            return DampingTable
        case (_, "gravity", _):
            return SignedTable
    return ParameterTable


def _unknown_key(path: KeyPath, data: Mapping[str, object]) -> str:
    key, body = str(path[-1]), data.get("body")
    if len(path) == 1:
        tables = {"beam": {*BeamTable.model_fields}, "body": {*NodalTable.model_fields, *SymbolicTable.model_fields}}
        for name in sorted(tables, key=lambda name: name not in data):
            if key in tables[name]:
                return f"this key belongs in the table [{name}]"
    if path[1:] == ("name",):
        return f"this key belongs above the table [{path[0]}]"
    if path[0] == "body" and len(path) == 2 and kind_of_body(body) == "symbolic" and key in NodalTable.model_fields:
        return "a symbolic body has no such key: its numbers are run-time parameters; leave this or `integrals` out"
    return unknown_key(key, _table(path[:-1], body).model_fields)


def _repeated_names(data: Mapping[str, object]) -> Iterator[Fault]:
    """Names that are not told apart; constants are written in upper case, so that m and M are the same."""
    for kind in ("beam", "body"):
        table = data.get(kind)
        if not isinstance(table, Mapping):
            continue
        for names in (_symbols(data.get("name"), kind, table), _marker_names(kind, table.get("markers"))):
            first: dict[str, str] = {}
            for path, name, where in names:
                if name_problem(name):
                    continue
                other = first.setdefault(name.lower(), where)
                if other != where:
                    yield Fault(path, f"{quoted(name)} is taken: {other}; names must differ in more than case")


def _names_of_integrals(data: Mapping[str, object]) -> Iterator[Fault]:
    """Symbols of gravity that are names of the other parameters of a body in space."""
    body = data.get("body")
    if isinstance(body, Mapping):
        for path, name, _ in _symbols(None, "body", body):
            if re.fullmatch(INTEGRALS, name, re.IGNORECASE):
                yield Fault(path, f"{quoted(name)} is taken: it is the name of another parameter of a body in space")


def _symbols(model: object, kind: str, table: Mapping[str, object]) -> Iterator[tuple[KeyPath, str, str]]:
    # Symbols that nobody wrote come first, so that a clash is reported where something was written.
    for key, parameter in QUANTITIES.items() if kind == "beam" else ():
        if key not in table:
            yield (kind, key), parameter.symbol, f"it is the symbol of {key} if none is given"
    if isinstance(model, str):
        yield ("name",), model, "it is the name of the model"
    for key in QUANTITIES if kind == "beam" else ():
        yield from _symbol((kind, key), table.get(key), f"it is the symbol of {key}")
    gravity = table.get("gravity")
    for i, component in enumerate(gravity[:3] if isinstance(gravity, (list, tuple)) else ()):
        yield from _symbol((kind, "gravity", i), component, f"it is the symbol of component {i + 1} of gravity")


def _symbol(path: KeyPath, quantity: object, where: str) -> Iterator[tuple[KeyPath, str, str]]:
    symbol = quantity.get("symbol") if isinstance(quantity, Mapping) else None
    if isinstance(symbol, str):
        yield (*path, "symbol"), symbol, where


def _marker_names(kind: str, markers: object) -> Iterator[tuple[KeyPath, str, str]]:
    if isinstance(markers, Mapping) and len(markers) <= MAX_MARKERS:
        for name in markers:
            if isinstance(name, str):
                yield (kind, "markers", name), name, f"there is a marker {quoted(name)}"


def _nodes(
    data: Mapping[str, object], specification: Specification | None, folder: Path
) -> tuple[NodeData | None, list[Fault]]:
    """The numbers of a body of nodes, if there is one; they are checked even if another key is at fault."""
    body = data.get("body")
    if not isinstance(body, Mapping) or kind_of_body(body) != "nodal":
        return None, []
    # NumPy and SciPy are not for specifications that have no arrays.
    from derive.spec.nodal import nodes_of

    table = specification.body if specification is not None else None
    return nodes_of(body, table if isinstance(table, NodalTable) else None, folder)


def _shape_faults(data: Mapping[str, object]) -> list[Fault]:
    """What the algebra has to say about the ansatz and the frame, if they are valid as they are written."""
    try:
        keys = ShapeKeys.model_validate(data.get("beam"))
    except ValidationError:
        return []
    # SymPy takes its time to import, which a specification that fails before has not to wait for.
    from derive.mechanics.conditions import ConditionError, assumed_shapes

    try:
        assumed_shapes(*keys.shape_keys())
    except ConditionError as error:
        return [Fault(("beam", "ansatz"), message) for message in error.problems]
    return []
