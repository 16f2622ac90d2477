"""Plain data of a specification in which successive instances of a table are one entry, so that it does not grow."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import Any

from derive.spec.model.instances import instance_name, instance_parts

Entry = Mapping[str, Any]


def merged_instances(data: Mapping[str, object]) -> dict[str, object]:
    """The data, in whose lists of named entries the successive instances of a table are one.

    Such an entry has the name link[i], and `i` with the first and the last index. References to instances contain i as
    well, link[i+1]; other values that differ are lists under the key `each`.
    """
    return {key: _merged_list(value) if _is_named(value) else value for key, value in data.items()}


def _is_named(value: object) -> bool:
    return isinstance(value, list) and all(isinstance(entry, Mapping) and "name" in entry for entry in value)


def _merged_list(entries: Any) -> list[object]:
    result: list[object] = []
    for table, group in groupby(entries, key=lambda entry: _table(entry["name"])):
        for run in _runs(list(group)) if table else [[entry] for entry in group]:
            result.append(_merged_run(run) if len(run) > 1 else run[0])
    return result


def _table(name: str) -> str:
    """The table of an instance; empty for other names."""
    parts = instance_parts(name)
    return "" if parts.ending else parts.table


def _runs(entries: Sequence[Entry]) -> list[list[Entry]]:
    """The runs of instances whose indices follow each other and whose entries have the same keys."""
    runs: list[list[Entry]] = []
    for entry in entries:
        before = runs[-1][-1] if runs else None
        if before is not None and before.keys() == entry.keys() and _index(before) + 1 == _index(entry):
            runs[-1].append(entry)
        else:
            runs.append([entry])
    return runs


def _index(entry: Entry) -> int:
    return instance_parts(entry["name"]).index or 0


def _merged_run(run: Sequence[Entry]) -> dict[str, object]:
    first = _index(run[0])
    return {
        "name": instance_name(_table(run[0]["name"]), "i"),
        "i": [first, first + len(run) - 1],
        **{key: _merged([entry[key] for entry in run], first) for key in run[0] if key != "name"},
    }


def _merged(values: Sequence[Any], first: int) -> object:
    """The value that describes those of successive instances; `first` is the index of the first instance."""
    head = values[0]
    if all(value == head for value in values):
        return head
    if all(isinstance(value, dict) and value.keys() == head.keys() for value in values):
        return {key: _merged([value[key] for value in values], first) for key in head}
    if all(isinstance(value, list) and len(value) == len(head) for value in values):
        return [_merged([value[k] for value in values], first) for k in range(len(head))]
    if all(isinstance(value, str) for value in values):
        parts = [instance_parts(value) for value in values]
        shifts = {part.index - k for k, part in enumerate(parts, first) if part.index is not None}
        if len(shifts) == 1 and len({(part.table, part.ending) for part in parts}) == 1 and not parts[0].ending:
            (shift,) = shifts
            return instance_name(parts[0].table, f"i{shift:+}" if shift else "i")
    return {"each": [*values]}
