"""The table of a body whose model is another one: the keys that differ are written, all others stay as they are."""

from __future__ import annotations

from collections.abc import Mapping, MutableMapping
from fractions import Fraction
from typing import Any

import tomlkit

from derive.spec.as_tables import as_table
from derive.spec.model.keys import declared_keys
from derive.spec.model.markers import MarkerRef
from derive.spec.model.spec_text import polynomial_text
from derive.spec.model.time_function import TimeFunction
from derive.spec.parsing.time_text import function_text

ANSATZ = "ansatz"
"""The key of shape functions, which are written as polynomials in xi."""


def write_body(table: MutableMapping[str, Any], body: Any, changed: Any) -> None:
    """Give the table of a body the keys of the body `changed`; keys that its kind does not have are removed."""
    kind: type = type(changed)
    if not isinstance(body, kind):
        known = {key.name for key in declared_keys(kind)}
        for name in [name for name in table if name not in known]:
            del table[name]
    _write_changes(table, as_table(body), as_table(changed))


def _write_changes(table: MutableMapping[str, Any], before: Mapping[str, Any], after: Mapping[str, Any]) -> None:
    """Write the entries that differ; tables that are in both are changed key by key, so that comments in them stay."""
    for name in [name for name in before if name not in after]:
        table.pop(name, None)
    for name, value in after.items():
        old, own = before.get(name), table.get(name)
        if value == old:
            continue
        if name != "markers" and all(isinstance(of, Mapping) for of in (value, old, own)):
            _write_changes(own, old, value)  # type: ignore[arg-type]
        else:
            table[name] = _inline(_shapes(value) if name == ANSATZ else toml_value(value))


def _shapes(ansatz: Any) -> Any:
    """Polynomials as texts; a family of modes as it is."""
    return toml_value(ansatz) if isinstance(ansatz, Mapping) else [polynomial_text(of) for of in ansatz]


def toml_value(value: Any) -> Any:
    """A value with the types of TOML: fractions are the numbers that print them, or else texts."""
    if isinstance(value, Mapping):
        return {key: _shapes(item) if key == ANSATZ else toml_value(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [toml_value(item) for item in value]
    if isinstance(value, Fraction):
        return float(value) if Fraction(repr(float(value))) == value else str(value)
    if isinstance(value, MarkerRef):
        return str(value)
    if isinstance(value, TimeFunction):
        return toml_value(value.value) if value.kind == "number" else function_text(value)
    return value


def _inline(value: Any) -> Any:
    if not isinstance(value, dict):
        return value
    table = tomlkit.inline_table()
    table.update({key: _inline(item) for key, item in value.items()})
    return table
