"""Reading of specifications from TOML; all faults are reported at once, with their lines."""

from __future__ import annotations

import os
import re
import tomllib
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

from derive.errors import Problem, SpecError, printable, problem_text
from derive.spec.files.file_content import specification_bytes
from derive.spec.model.instances import COUNT, COUNTED
from derive.spec.model.specification import Specification
from derive.spec.parsing.faults import Fault, line_of, path_text
from derive.spec.parsing.values import TomlFloat
from derive.spec.tables.instance_tables import instance_tables
from derive.spec.toml.key_lines import lines, repeated_key

MAX_BYTES = 1_000_000
# tomllib needs time and memory that grow with the square of the parts of a dotted key.
MAX_DOTS = 200


def read(path: str | os.PathLike[str]) -> Specification:
    r"""The body or the scene that a TOML file specifies.

    Arguments:
        path: the file; the files that it names are relative to its folder.

    Returns:
        A PlanarBeam, a NodalBody, a SymbolicBody, a Scene or a SpatialScene, depending on its tables.

    Raises:
        SpecError: with all faults of the file and their lines.
        TypeError: if `path` is not a path.

    Examples:
        >>> import derive
        >>> from pathlib import Path
        >>> _ = Path("beam.toml").write_text('name = "beam"\n[beam]\nmass = 2\n')
        >>> derive.read("beam.toml").mass
        Fraction(2, 1)
        >>> _ = Path("beam.toml").write_text('name = "beam"\n[beam]\nmas = 2\n')
        >>> try:
        ...     derive.read("beam.toml")
        ... except derive.SpecError as error:
        ...     print(error)
        beam.toml:3: beam.mas: unknown key; did you mean "mass"?
    """
    if not isinstance(path, (str, os.PathLike)):
        read_already = "; it is a specification already" if isinstance(path, Specification) else ""
        raise TypeError(f"the path of a TOML file is needed, not {type(path).__name__}{read_already}")
    source = os.fsdecode(path)
    return parse(_text(source), source)


def read_with_counts(path: str | os.PathLike[str], counts: Mapping[str, str]) -> tuple[Specification, dict[str, int]]:
    """The specification of a file with other numbers of instances, and those numbers that it replaces, by their keys.

    counts: texts by keys, `bodies.link.count`; what is no count of a table in the file is left alone. Raises SpecError.
    """
    source = os.fsdecode(path)
    text = _text(source)
    data = _data(text, source)
    replaced: dict[str, int] = {}
    for section in COUNTED:
        tables = data.get(section)
        for name, table in tables.items() if isinstance(tables, dict) else ():
            key = path_text((section, name, COUNT.name))
            if key in counts and isinstance(table, dict) and isinstance(table.get(COUNT.name), int):
                replaced[key] = table[COUNT.name]
                table[COUNT.name] = _count(counts[key])
    return _validated(data, text, source), replaced


def _count(text: str) -> object:
    """The number of a text, for the check of counts; other texts are left."""
    try:
        return int(text) if re.fullmatch(r"-?\d+", text) else float(text)
    except ValueError:
        return text


def parse(text: str, source: str | None = None) -> Specification:
    """The specification in a TOML text; `source` is the file that errors show and to which other paths are relative."""
    return _validated(_data(text, source), text, source)


def _validated(data: dict[str, Any], text: str, source: str | None) -> Specification:
    # pydantic is imported only when there is something to check, so that the command line answers at once.
    from derive.spec.checks.validation import validate

    return validate(data, source, lambda: lines(text))


def warnings(path: str | os.PathLike[str], changed: Collection[str] = ()) -> tuple[str, ...]:
    """The warnings on the specification of a valid TOML file, each with its file, its line and its key.

    changed: keys whose values have been replaced, on which there are no warnings.
    """
    from derive.spec.checks.warnings import specification_warnings

    source = os.fsdecode(path)
    text = _text(source)
    known = lines(text)
    instances = instance_tables(_data(text, source))
    faults = instances.merged(specification_warnings(instances.data))
    problems = (Problem(path_text(fault.path), fault.message, line_of(fault.path, known)) for fault in faults)
    left = sorted((p for p in problems if p.path not in changed), key=lambda p: p.line or 0)
    return tuple(problem_text(problem, source) for problem in left)


def _text(source: str) -> str:
    """The text of a file. Raises SpecError."""
    too_large = f"the file is larger than {MAX_BYTES} bytes; is it a specification?"
    content = specification_bytes(source, MAX_BYTES, too_large)
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise SpecError((Problem("", "this is not UTF-8 text; save the file as UTF-8", line),), source) from None


def with_lines(error: SpecError, path: Path) -> SpecError:
    """The error with its file, and with the lines of its keys."""
    text = path.read_text(encoding="utf-8-sig")
    known, instances = lines(text), instance_tables(_data(text, str(path)))
    faults = instances.merged(Fault((*p.path.split("."),), p.message) for p in error.problems)
    problems = (Problem(".".join(map(str, f.path)), f.message, line_of(f.path, known)) for f in faults)
    return SpecError(tuple(sorted(problems, key=lambda p: p.line or 0)), str(path))


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
    """The fault of a text that tomllib refuses. Its messages end with "(at line 3, column 7)" or the like.

    They do not name a key that is repeated, which is therefore searched for.
    """
    match = re.fullmatch(r"(.*) \(at (?:line (\d+), column (\d+)|end of document)\)", message, re.DOTALL)
    if match is None:
        return Problem("", f"this is not TOML: {printable(message)}")
    twice = repeated_key(text)
    if twice is not None and (match[2] is None or twice.second <= int(match[2])):
        return Problem(path_text(twice.path), f"it is in line {twice.first} already; keep one of them", twice.second)
    why = f"this is not TOML: {printable(match[1][:1].lower() + match[1][1:])}"
    if match[2] is None:
        return Problem("", f"{why}, at the end of the file", text.rstrip("\n").count("\n") + 1)
    return Problem("", f"{why}, at column {match[3]}", int(match[2]))
