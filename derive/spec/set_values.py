"""Replacement of single values of a specification, as for `--set NAME=VALUE`.

A name is the symbol of a parameter, or a key of the specification with dots, such as `bodies.rod.bending_stiffness`.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeVar

from derive.errors import Problem, SpecError, printable, quoted
from derive.spec.as_tables import specification_tables
from derive.spec.checks.name_clashes import taken_names
from derive.spec.checks.scene_data import SceneData
from derive.spec.checks.scene_parameters import beam_constants, scene_constants
from derive.spec.construction.validated import validated_tables
from derive.spec.model.instances import COUNT, identifier, instance_parts
from derive.spec.model.scene import Scene
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.spec_text import polynomial_text
from derive.spec.model.specification import Specification
from derive.spec.model.time_function import TimeFunction
from derive.spec.parsing.faults import KeyPath, did_you_mean, path_text, readable
from derive.spec.parsing.names import name_problem
from derive.spec.parsing.time_text import function_text
from derive.spec.parsing.values import TomlFloat, number

S = TypeVar("S", bound=Specification)


@dataclass(frozen=True)
class SetValue:
    """A value that has been replaced: its key, the old and the new value as text, and the symbol of a parameter."""

    key: str
    old: str
    new: str
    symbol: str | None = None

    def __str__(self) -> str:
        parameter = f", the parameter {self.symbol}" if self.symbol else ""
        return f"{self.key}: {self.old} -> {self.new}{parameter}"


def with_values(spec: S, assignments: Mapping[str, str]) -> tuple[S, tuple[SetValue, ...]]:
    """The specification with other values, and the list of replaced values.

    assignments: values by names, as they are written in TOML. A parameter gets another default, at all keys with its
    symbol; a number that may be a parameter becomes one, so that the model does not depend on its value; any other
    value is replaced.

    Raises SpecError with all unknown names, or with all faults of the values.
    """
    tables = specification_tables(spec)
    known = dict(_values(tables, ()))
    symbols = _symbols(known)
    constants = _constants(spec, tables)
    taken = {*(symbol.lower() for symbol in symbols), *_names(spec, tables)}
    problems: list[Problem] = []
    changes: list[SetValue] = []
    by_key = {path_text(path): path for path in known}
    for name, text in assignments.items():
        new = _value(text)
        if name in symbols:
            for path in symbols[name]:
                changes.append(SetValue(path_text(path), _shown(known[path]), _shown(new), name))
                tables = _replaced(tables, path, {**known[path], "default": new})
        elif name in by_key:
            path = by_key[name]
            value = _as_parameter(path, known[path], new, taken) if path in constants else new
            symbol = value.get("symbol") if isinstance(value, Mapping) else None
            changes.append(SetValue(name, _known(path, known[path]), _shown(new), symbol))
            tables = _replaced(tables, path, value)
            terms = (*path[:-1], "terms")
            if path[-1] == "order" and new == 1 and terms in known and path_text(terms) not in assignments:
                changes.append(SetValue(path_text(terms), _shown(known[terms]), "left out, since those are of order 2"))
                tables = _without(tables, terms)
        elif (added := _added(spec, tables, name, new)) is not None:
            if isinstance(added, Problem):
                problems.append(added)
                continue
            changes.append(SetValue(name, _given(tables, name), _shown(new)))
            tables = added
        elif (count := _count_of(tables, name)) is not None:
            problems.append(count)
        else:
            names = [*symbols, *by_key]
            listed = f"the parameters are {', '.join(symbols)}" if symbols else "there are no parameters"
            hint = did_you_mean(name, names, f"{listed}; other values have keys such as {names[-1]}")
            problems.append(Problem("", f"{quoted(name)} is no parameter and no key of the specification{hint}"))
    if problems:
        raise SpecError(tuple(problems), "--set")
    try:
        result, unused = _without_unused(spec, tables, assignments)
    except SpecError as error:
        raise SpecError(error.problems, "--set") from None
    left_out = "left out, since no function of time uses it any more"
    changes += [SetValue(path_text(path), _shown(known[path]), left_out) for path in unused]
    return result, tuple(changes)


def has_value(spec: Specification, name: str, text: str) -> bool:
    """Whether a specification has a parameter or a key of this name, or may have the key with the value of a text."""
    tables = specification_tables(spec)
    known = dict(_values(tables, ()))
    if name in _symbols(known) or name in map(path_text, known):
        return True
    return isinstance(_added(spec, tables, name, _value(text)), Mapping)


def _without_unused(spec: S, tables: Any, assignments: Mapping[str, str]) -> tuple[S, list[KeyPath]]:
    """The specification without those parameters of functions that no function uses any more, and their paths.

    Raises SpecError with all faults, among them parameters that nothing uses and that the assignments set.
    """
    try:
        return validated_tables(spec, tables), []
    except SpecError as error:
        faulty = {problem.path for problem in error.problems}
        paths: list[KeyPath] = [
            ("parameters", name) for name in tables.get("parameters", {}) if name not in assignments
        ]
        if not faulty <= {*map(path_text, paths)}:
            raise
        unused = [path for path in paths if path_text(path) in faulty]
        used = {name: table for name, table in tables["parameters"].items() if ("parameters", name) not in unused}
        return validated_tables(spec, {**tables, "parameters": used}), unused


def _count_of(tables: Mapping[str, Any], name: str) -> Problem | None:
    """The statement that a name is the number of instances of a table, which have been made already, if it is."""
    section, *table, key = ("", *name.split("."))[-3:]
    of_section = tables.get(section)
    names = of_section if isinstance(of_section, Mapping) else ()
    count = sum([instance_parts(other).table] == table for other in names)
    if key != COUNT.name or not count:
        return None
    text = f"there are {count}, and another number makes another model: --set of a command that reads a file changes it"
    return Problem(name, text)


def _added(spec: Specification, tables: Mapping[str, Any], name: str, new: Any) -> Any:
    """The tables with a value for an optional key that is not given yet.

    The result is None if there is no such table, and the fault if the table has no such key.
    """
    *parents, key = name.split(".")
    table: Any = tables
    for part in parents:
        table = table.get(part) if isinstance(table, Mapping) else None
    if not parents or not isinstance(table, Mapping) or "symbol" in table:
        return None
    added = _replaced(tables, tuple(parents), {**table, key: new})
    try:
        validated_tables(spec, added)
    except SpecError as error:
        # Other faults of the value are reported with those of all values.
        return next((problem for problem in error.problems if problem.path == name), added)
    return added


def _given(tables: Any, name: str) -> str:
    """The value of a key of a table that counts as one value, such as a parameter of functions, or "not given"."""
    *parents, key = name.split(".")
    for part in parents:
        tables = tables[part]
    return _shown(tables[key]) if key in tables else "not given"


def _values(value: Any, path: KeyPath) -> Iterator[tuple[KeyPath, Any]]:
    """All values that are not tables, and the elements of lists, with their paths; a parameter counts as a value."""
    if isinstance(value, Mapping) and "symbol" not in value and path[:-1] != ("parameters",):
        for key, item in value.items():
            yield from _values(item, (*path, str(key)))
    else:
        yield path, value
    if isinstance(value, (list, tuple)):
        for index, item in enumerate(value):
            yield from _values(item, (*path, index))


def _symbols(known: Mapping[KeyPath, Any]) -> dict[str, list[KeyPath]]:
    """The paths of the parameters by their symbols."""
    result: dict[str, list[KeyPath]] = {}
    for path, value in known.items():
        if isinstance(value, Mapping):
            result.setdefault(str(value.get("symbol", path[-1])), []).append(path)
    return result


def _constants(spec: Specification, tables: Mapping[str, Any]) -> set[KeyPath]:
    """The paths of the numbers that may be parameters."""
    if isinstance(spec, (Scene, SpatialScene)):
        return {constant.path for constant in scene_constants(SceneData(tables))}
    kind = spec.section
    of_beam = {constant.path for constant in beam_constants(("beam",), tables["beam"])} if kind == "beam" else set()
    return of_beam | {(kind, "gravity", i) for i in range(3)}


def _names(spec: Specification, tables: Mapping[str, Any]) -> set[str]:
    """The names in lower case that parameters cannot have."""
    return {spec.name.lower(), *(taken_names(SceneData(tables)) if isinstance(spec, (Scene, SpatialScene)) else ())}


def _as_parameter(path: KeyPath, old: Any, new: Any, taken: set[str]) -> Any:
    """The parameter with the new default, or the new value itself where the path gives no valid name."""
    if isinstance(old, Mapping):
        return {**old, "default": new}
    name = identifier(*(str(part + 1 if isinstance(part, int) else part) for part in path[1:]))
    symbol = next((free for free in (name, f"{name}_value") if free.lower() not in taken), name)
    if isinstance(new, str) and readable(number, new) is None:
        return new  # a function of t, which is no default of a parameter
    taken.add(symbol.lower())
    return new if name_problem(symbol) else {"symbol": symbol, "default": new}


def _replaced(value: Any, path: KeyPath, new: Any) -> Any:
    """A copy of tables and lists with a new value at a path."""
    if not path:
        return new
    if isinstance(value, Mapping):
        return {key: _replaced(item, path[1:], new) if str(key) == path[0] else item for key, item in value.items()}
    return [_replaced(item, path[1:], new) if index == path[0] else item for index, item in enumerate(value)]


def _without(tables: Mapping[str, Any], path: KeyPath) -> dict[str, Any]:
    """A copy of tables without the key at a path."""
    first, *rest = path
    if not rest:
        return {key: item for key, item in tables.items() if key != first}
    return {key: _without(item, tuple(rest)) if key == first else item for key, item in tables.items()}


def _value(text: str) -> Any:
    """A value from its TOML notation; text that is not TOML is a string without quotation marks."""
    if "\n" not in text:
        try:
            return tomllib.loads(f"value = {text}", parse_float=TomlFloat)["value"]
        except (tomllib.TOMLDecodeError, ValueError, RecursionError):
            pass
    return text


def _known(path: KeyPath, value: Any) -> str:
    """The value of a key in one line; shapes are polynomials, of which the tables have the coefficients."""
    if path[-1] == "ansatz" and not isinstance(value, Mapping):
        return f"[{', '.join(map(polynomial_text, value))}]"
    return polynomial_text(value) if "ansatz" in path and isinstance(value, tuple) else _shown(value)


def _shown(value: Any) -> str:
    """A value in one line: a short number as a decimal, a parameter as its default with the unit."""
    match value:
        case {"default": default, "unit": str(unit)} if unit:
            return f"{_shown(default)} {unit}"
        case {"default": default}:
            return _shown(default)
        case TomlFloat(text=text):
            return text
        case Fraction() | int() | float() if not isinstance(value, bool):
            return f"{float(value):.12g}"
        case list() | tuple():
            return f"[{', '.join(map(_shown, value))}]"
        case Mapping():
            return f"{{ {', '.join(f'{key} = {_shown(item)}' for key, item in value.items())} }}"
        case TimeFunction():
            return function_text(value)
        case _:
            return printable(str(value))[:80]
