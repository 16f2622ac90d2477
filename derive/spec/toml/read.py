"""Reads specifications, from a TOML file or from Python; every fault is reported at once."""

from __future__ import annotations

import json
import os
import re
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

from derive.errors import Problem, SpecError, printable
from derive.spec.model.body import (
    BodyFrame,
    Damping,
    Frame,
    Lowering,
    NodalBody,
    NodeData,
    Parameter,
    PlanarBeam,
    Polynomial,
    SymbolicBody,
    SymbolicFrame,
)
from derive.spec.model.specification import Specification
from derive.spec.toml import locate
from derive.spec.toml import paper_beam as paper
from derive.spec.toml.values import TomlFloat

MAX_BYTES = 1_000_000
# tomllib needs time and memory that grow with the square of the parts of a dotted key.
MAX_DOTS = 200

Number = int | float | Fraction | str
Nodes = str | os.PathLike[str] | Mapping[str, Any] | NodeData


def read(path: str | os.PathLike[str]) -> Specification:
    """The body or the scene that a TOML file specifies. Raises SpecError with all that is wrong with the file."""
    source = os.fsdecode(path)
    try:
        with Path(source).open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or str(error)
        raise SpecError((Problem("", f"the file cannot be read: {why[:1].lower()}{why[1:]}"),), source) from None
    if len(content) > MAX_BYTES:
        raise SpecError((Problem("", f"the file is larger than {MAX_BYTES} bytes; is it a specification?"),), source)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise SpecError((Problem("", "this is not UTF-8 text; save the file as UTF-8", line),), source) from None
    return parse(text, source)


def parse(text: str, source: str | None = None) -> Specification:
    """What a TOML text specifies; `source` is the file that errors show, and beside which others are."""
    return _checked(_data(text, source), locate_in=text, source=source)


def planar_beam(
    name: str,
    *,
    ansatz: Sequence[str | Polynomial] = paper.ANSATZ,
    frame: str | Mapping[str, object] | Frame = paper.FRAME,
    mass: Number | Mapping[str, object] | Parameter = paper.MASS,
    length: Number | Mapping[str, object] | Parameter = paper.LENGTH,
    bending_stiffness: Number | Mapping[str, object] | Parameter = paper.BENDING_STIFFNESS,
    markers: Mapping[str, Number] | None = None,
    orthogonal: bool | None = None,
    gravity: Sequence[Number | Mapping[str, object] | Parameter] | None = None,
) -> PlanarBeam:
    """A beam specified in Python, with the keys, the defaults and the checks of a TOML file.

    Shapes are texts such as "xi^2 - 1/3" or tuples of coefficients; a float is the decimal it is printed as.
    """
    beam = {
        "ansatz": ansatz,
        "frame": _as_data(frame),
        "mass": _as_data(mass),
        "length": _as_data(length),
        "bending_stiffness": _as_data(bending_stiffness),
        "markers": {} if markers is None else markers,
    }
    if orthogonal is not None:
        beam["orthogonal"] = orthogonal
    if gravity is not None:
        beam["gravity"] = _as_data(gravity)
    result = _checked({"name": name, "beam": beam})
    assert isinstance(result, PlanarBeam)
    return result


def nodal_body(
    name: str,
    nodes: Nodes,
    *,
    units: str | Mapping[str, str] | None = None,
    modes: int | None = None,
    frame: str | Mapping[str, object] | BodyFrame = "mean",
    orthonormal: bool | None = None,
    damping: Mapping[str, Number] | Damping | None = None,
    gravity: Sequence[Number | Mapping[str, object] | Parameter] | None = None,
    lowering: Lowering = "auto",
    markers: Mapping[str, int] | None = None,
) -> NodalBody:
    """A body of nodes specified in Python, with the keys, the defaults and the checks of a TOML file.

    `nodes` is a .npz file, a table of MatrixMarket files or of arrays with the names they have in a .npz file, or
    NodeData, which are in SI units.
    """
    optional = {
        "units": "SI" if units is None and isinstance(nodes, NodeData) else units,
        "modes": modes,
        "orthonormal": orthonormal,
        "damping": _as_data(damping),
        "gravity": _as_data(gravity),
        "markers": markers,
    }
    given = {key: value for key, value in optional.items() if value is not None}
    result = _checked({"name": name, "body": {"nodes": nodes, "frame": _as_data(frame), "lowering": lowering, **given}})
    assert isinstance(result, NodalBody)
    return result


def symbolic_body(
    name: str,
    modes: int,
    *,
    frame: SymbolicFrame = "mean",
    damping: bool = False,
    gravity: Sequence[Number | Mapping[str, object] | Parameter] | None = None,
    lowering: Lowering = "auto",
) -> SymbolicBody:
    """A body whose integrals are run-time parameters, specified in Python with the checks of a TOML file."""
    body = {
        "integrals": "symbolic",
        "modes": modes,
        "frame": frame,
        "damping": damping,
        "lowering": lowering,
        **({} if gravity is None else {"gravity": _as_data(gravity)}),
    }
    result = _checked({"name": name, "body": body})
    assert isinstance(result, SymbolicBody)
    return result


def json_schema() -> str:
    """The JSON schema of a specification, with which editors complete and check TOML files."""
    from derive.spec.toml import schema as tables

    schema = {"$schema": "https://json-schema.org/draft/2020-12/schema", **tables.Specification.model_json_schema()}
    return json.dumps(_plain(schema), indent=2, ensure_ascii=False) + "\n"


def _plain(node: Any) -> Any:
    """A schema without what pydantic adds: titles that repeat the key, and null for what may be left out."""
    if isinstance(node, list):
        return [_plain(item) for item in node]
    if isinstance(node, dict):
        kept = {k: v for k, v in node.items() if k not in ("title", "anyOf") and not (k == "default" and v is None)}
        options = [option for option in node.get("anyOf", []) if option != {"type": "null"}]
        several = {"anyOf": options} if len(options) > 1 else dict(*options)
        return {key: _plain(value) for key, value in {**several, **kept}.items()}
    return node


def _as_data(value: object) -> object:
    if isinstance(value, Damping):
        return {key: item for key, item in asdict(value).items() if item} or None
    if isinstance(value, (Frame, Parameter)):
        return {key: item for key, item in asdict(value).items() if item is not None}
    if isinstance(value, BodyFrame):
        return {key: item for key, item in asdict(value).items() if item not in (None, ())}
    if isinstance(value, (list, tuple)):
        return [_as_data(item) for item in value]
    return value


def _checked(data: Mapping[str, object], locate_in: str = "", source: str | None = None) -> Specification:
    # pydantic is imported only when there is something to check, so that the command line answers at once.
    from derive.spec.toml.check import checked

    result = checked(data, Path() if source is None else Path(source).parent)
    if not isinstance(result, list):
        return result
    lines = locate.lines(locate_in)
    problems = [Problem(path_text(path), message, locate.line_of(path, lines)) for path, message in result]
    # In the order of the file; what is not in it comes first.
    raise SpecError(tuple(sorted(problems, key=lambda problem: problem.line or 0)), source)


def with_lines(error: SpecError, path: Path) -> SpecError:
    """An error that knows its keys, with the file it is in and the lines there."""
    known = locate.lines(path.read_text(encoding="utf-8-sig"))
    problems = (replace(p, line=locate.line_of(tuple(p.path.split(".")), known)) for p in error.problems)
    return SpecError(tuple(sorted(problems, key=lambda p: p.line or 0)), str(path))


def path_text(path: Iterable[str | int]) -> str:
    """A path as messages show it: beam.ansatz[2], beam.markers."left end"."""
    text = ""
    for part in path:
        if isinstance(part, int):
            text += f"[{part}]"
        else:
            key = printable(part[:60])
            text += "." * bool(text) + (key if re.fullmatch("[A-Za-z0-9_-]+", key) else f'"{key}"')
    return text


def _data(text: str, source: str | None) -> dict[str, Any]:
    for number, line in enumerate(text.split("\n"), 1):
        if line.count(".") > MAX_DOTS and not line.lstrip().startswith("#"):
            message = f"this line has more than {MAX_DOTS} dots; break it into several lines"
            raise SpecError((Problem("", message, number),), source)
    try:
        return tomllib.loads(text, parse_float=TomlFloat)
    except tomllib.TOMLDecodeError as error:
        raise SpecError((_syntax_problem(str(error), text),), source) from None
    except RecursionError:
        raise SpecError((Problem("", "the brackets are nested too deeply"),), source) from None
    except ValueError:
        raise SpecError((Problem("", "a number has too many digits"),), source) from None


def _syntax_problem(message: str, text: str) -> Problem:
    """tomllib says where in words: "Invalid value (at line 3, column 7)", or "(at end of document)"."""
    match = re.fullmatch(r"(.*) \(at (?:line (\d+), column (\d+)|end of document)\)", message, re.DOTALL)
    if match is None:
        return Problem("", f"this is not TOML: {printable(message)}")
    why = f"this is not TOML: {printable(match[1][:1].lower() + match[1][1:])}"
    if match[2] is None:
        return Problem("", f"{why}, at the end of the file", text.rstrip("\n").count("\n") + 1)
    return Problem("", f"{why}, at column {match[3]}", int(match[2]))
