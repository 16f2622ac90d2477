"""All faults of the data of a specification at once, each as its path and a sentence of our own."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Mapping
from typing import NamedTuple

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from derive.spec import paper
from derive.spec.body import PlanarBeam
from derive.spec.errors import quoted
from derive.spec.names import name_problem
from derive.spec.schema import MAX_MARKERS, BeamTable, FrameTable, ParameterTable, ShapeKeys, Specification
from derive.spec.values import kind_of

MAX_FAULTS = 100
QUANTITIES = {"mass": paper.MASS, "length": paper.LENGTH, "bending_stiffness": paper.BENDING_STIFFNESS}

Path = tuple[str | int, ...]


class Fault(NamedTuple):
    """What is wrong at a path of the data; the empty path is the whole of it."""

    path: Path
    message: str


def checked(data: Mapping[str, object]) -> PlanarBeam | list[Fault]:
    """The beam that `data` specifies, or all that is wrong with it."""
    specification = None
    faults: list[Fault] = []
    try:
        specification = Specification.model_validate(data)
    except ValidationError as error:
        details = error.errors(include_url=False)
        faults = [_fault(one) for one in details[:MAX_FAULTS]]
        if len(details) > MAX_FAULTS:
            faults.append(Fault((), f"{len(details) - MAX_FAULTS} more problems are not shown"))
    faults += _repeated_names(data)
    faults += _shape_faults(data)
    return faults if specification is None or faults else specification.planar_beam()


def _fault(error: ErrorDetails) -> Fault:
    path = _path(error["loc"])
    match error["type"]:
        case "value_error":
            return Fault(path, str(error["ctx"]["error"]))
        case "missing":
            return Fault(path, f"this key is missing; write {_example(path)}")
        case "extra_forbidden":
            return Fault(path, _unknown_key(path))
        case "model_type":
            return Fault(path, f"a table is needed here, not {kind_of(error['input'])}")
        case "invalid_key":
            return Fault(path, "a key has to be text")
    raise AssertionError(f"pydantic reports {error['type']}, for which there is no sentence yet")


def _path(location: Path) -> Path:
    """The keys of the data, without what pydantic puts between them for unions and keys of dicts."""
    if location[:1] == ("beam",) and location[1:2] and location[1] in {"frame", *QUANTITIES}:
        return location[:2] + location[3:]
    if location[:2] == ("beam", "markers"):
        return location[:3]
    return location


def _example(path: Path) -> str:
    match path[-1]:
        case "beam":
            return "[beam]"
        case "symbol":
            return f'symbol = "{QUANTITIES[str(path[-2])].symbol}"'
        case "kind":
            return 'kind = "point"'
    return 'name = "free_beam"'


def _table(path: Path) -> type[BaseModel]:
    """The model of the table at a path."""
    tables: dict[Path, type[BaseModel]] = {
        (): Specification,
        ("beam",): BeamTable,
        ("beam", "frame"): FrameTable,
    }
    return tables.get(path, ParameterTable)


def _unknown_key(path: Path) -> str:
    key, known = str(path[-1]), list(_table(path[:-1]).model_fields)
    if len(path) == 1 and key in BeamTable.model_fields:
        return "this key belongs in the table [beam]"
    if path == ("beam", "name"):
        return "this key belongs above the table [beam]"
    near = difflib.get_close_matches(key[:40].lower(), known, n=1)
    if near:
        return f"unknown key; did you mean {quoted(near[0])}?"
    return f"unknown key; the keys here are {', '.join(known)}"


def _repeated_names(data: Mapping[str, object]) -> Iterator[Fault]:
    """Names that are not told apart; constants are written in upper case, so that m and M are the same."""
    beam = data.get("beam")
    beam = beam if isinstance(beam, Mapping) else {}
    for names in (_symbols(data.get("name"), beam), _marker_names(beam.get("markers"))):
        first: dict[str, str] = {}
        for path, name, where in names:
            if name_problem(name):
                continue
            other = first.setdefault(name.lower(), where)
            if other != where:
                yield Fault(path, f"{quoted(name)} is taken: {other}; names must differ in more than case")


def _symbols(model: object, beam: Mapping[str, object]) -> Iterator[tuple[Path, str, str]]:
    # Symbols that nobody wrote come first, so that a clash is reported where something was written.
    for key, parameter in QUANTITIES.items():
        if key not in beam:
            yield ("beam", key), parameter.symbol, f"it is the symbol of {key} if none is given"
    if isinstance(model, str):
        yield ("name",), model, "it is the name of the model"
    for key in QUANTITIES:
        quantity = beam.get(key)
        symbol = quantity.get("symbol") if isinstance(quantity, Mapping) else None
        if isinstance(symbol, str):
            yield ("beam", key, "symbol"), symbol, f"it is the symbol of {key}"


def _marker_names(markers: object) -> Iterator[tuple[Path, str, str]]:
    if isinstance(markers, Mapping) and len(markers) <= MAX_MARKERS:
        for name in markers:
            if isinstance(name, str):
                yield ("beam", "markers", name), name, f"there is a marker {quoted(name)}"


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
