"""Tables with `count`: each of their instances as a table, and the faults of instances as faults of their table.

The instances take the place of their table before anything else is checked, so that nothing else knows counts. Faults
have the paths of instances until `InstanceTables.merged` gives them the paths that are written.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from derive.errors import quoted
from derive.spec.model.instances import COUNT, COUNTED, instance_name
from derive.spec.model.scene import NAMED
from derive.spec.parsing.faults import Fault, Faults, KeyPath, did_you_mean
from derive.spec.parsing.instance_text import at_index, contains_index, reference, symbol_at
from derive.spec.parsing.names import INDEX
from derive.spec.parsing.scene_values import instance_count
from derive.spec.parsing.values import WrongValueError

Data = Mapping[str, object]
Counts = Mapping[KeyPath, int | None]
Instances = Mapping[KeyPath, tuple[str, int]]

NAMES = ("kind", "symbol", "unit", "input", "joint", "drive", "spring", "load", "beam", "mesh")
"""The keys whose values are names and words, which are no formulas."""
FAULTY = object()
"""The value of a key that has none, which no type of value accepts; the fault that says why is one already."""


@dataclass(frozen=True)
class InstanceTables:
    """The tables of a specification with all instances.

    data: the tables; what is faulty is FAULTY there. instances: the names of their tables and their indices, by their
    paths. counts: the numbers of instances by the paths of their tables, None for those that cannot be read. faults:
    those of counts, formulas and references, with the paths of instances.
    """

    data: Data
    instances: Instances
    counts: Counts
    faults: tuple[Fault, ...] = ()

    @property
    def counts_are_known(self) -> bool:
        """Whether all counts can be read, so that a name that is missing here is missing in the specification."""
        return None not in self.counts.values()

    def written(self, path: KeyPath) -> KeyPath:
        """The path of a key as it is written, for the path of the key of an instance."""
        instance = self.instances.get(path[:2])
        return path if instance is None else (path[0], instance[0], *path[2:])

    def merged(self, faults: Iterable[Fault]) -> list[Fault]:
        """The faults with their written paths, where the same fault of several instances is one that names them.

        Faults of what is faulty here already are left out.
        """
        here = {fault.path for fault in self.faults}
        others = (f for f in faults if not any(f.path[:length] in here for length in range(1, len(f.path) + 1)))
        return [*self._merged(self.faults), *self._merged(others)]

    def _merged(self, faults: Iterable[Fault]) -> Iterator[Fault]:
        groups: dict[tuple[KeyPath, int], list[Fault]] = {}
        earlier: dict[KeyPath, int] = {}
        for fault in faults:
            number = earlier[fault.path] = earlier.get(fault.path, 0) + 1  # an instance may have several at one path
            groups.setdefault((self.written(fault.path), number), []).append(fault)
        yield from (Fault(path, self._message(group)) for (path, _), group in groups.items())

    def _message(self, group: Sequence[Fault]) -> str:
        """The message on the same fault of several instances: that of the first, and which they are."""
        first, last = group[0], group[-1]
        instance = self.instances.get(first.path[:2])
        if instance is None:
            return first.message
        count = self.counts[first.path[0], instance[0]]
        if count in (None, 1) or (len(group) == count and first.message == last.message):
            return first.message
        indices = [self.instances[fault.path[:2]][1] for fault in group]
        return f"for {INDEX} = {_indices_text(indices)}: {first.message}"


SHOWN = 3
"""The largest number of indices that a message lists."""


def _indices_text(indices: Sequence[int]) -> str:
    first, last = indices[0], indices[-1]
    if len(indices) > 2 and last - first == len(indices) - 1:
        return f"{first} to {last}"
    listed = [*map(str, indices[:SHOWN])]
    if len(indices) > SHOWN:
        listed.append(f"{len(indices) - SHOWN} others")
    return listed[0] if len(listed) == 1 else f"{', '.join(listed[:-1])} and {listed[-1]}"


def instance_tables(data: Data) -> InstanceTables:
    """The tables of a specification in which the instances of tables with `count` stand in their place."""
    return _Expansion(data).result() if any(True for _ in _counted(data)) else InstanceTables(data, {}, {})


def _counted(data: Data) -> Iterator[tuple[str, str, Data]]:
    """The sections, the names and the tables of those with a count."""
    for section in COUNTED:
        tables = data.get(section)
        for name, table in tables.items() if isinstance(tables, Mapping) else ():
            if isinstance(name, str) and isinstance(table, Mapping) and COUNT.name in table:
                yield section, name, table


class _Expansion:
    """The tables of a specification as their instances are made."""

    def __init__(self, data: Data) -> None:
        self.data, self.faults = data, Faults()
        self.counts: dict[KeyPath, int | None] = {}
        self.instances: dict[KeyPath, tuple[str, int]] = {}
        for section, name, table in _counted(data):
            self.counts[section, name] = None
            with self.faults.at(section, name, COUNT.name):
                self.counts[section, name] = instance_count(table[COUNT.name])
            for i in range(self.counts[section, name] or 1):
                path = section, instance_name(name, i)
                self.instances[path] = name, i
                if path[1] in data[section]:  # type: ignore[operator]  # a section with tables
                    text = f"{quoted(path[1])} is the name of another table; choose another name"
                    self.faults.append(Fault((section, name), text))
        self.names: dict[str, set[object]] = {section: self._names(section) for section in NAMED}

    def result(self) -> InstanceTables:
        self.faults += _named_like_the_index(self.data)
        data = {**self.data, **{section: self._section(section) for section in COUNTED if section in self.data}}
        return InstanceTables(data, self.instances, self.counts, tuple(self.faults))

    def _names(self, section: str) -> set[object]:
        """The names of all elements of a section, among them those of instances."""
        tables = self.data.get(section)
        written = tables if isinstance(tables, Mapping) else {}
        return {*written, *(name for of, name in self.instances if of == section)}

    def _section(self, section: str) -> object:
        """A section with the instances of its tables."""
        tables, result = self.data[section], dict[str, object]()
        if not isinstance(tables, Mapping):
            return tables
        for name, table in tables.items():
            if (section, name) in self.counts:
                keys = {key: value for key, value in table.items() if key != COUNT.name}
                varying = {key for key, value in keys.items() if _varies(value, key)}
                for i in range(self.counts[section, name] or 1):
                    path = section, instance_name(name, i)
                    result[path[1]] = {k: self._at(v, (*path, k), i) if k in varying else v for k, v in keys.items()}
            else:
                self._check(table, (section, name))
                result.setdefault(name, table)
        return result

    def _check(self, value: object, path: KeyPath) -> None:
        """Add the faults of references to instances in a table that has no count itself."""
        if isinstance(value, Mapping):
            for key, item in value.items():
                self._check(item, (*path, str(key)))
        elif isinstance(value, (list, tuple)):
            for k, item in enumerate(value):
                self._check(item, (*path, k))
        elif isinstance(value, str) and "[" in value and path[-1] != "symbol":
            with self.faults.at(*path):
                instance = reference(value)
                if instance and not instance.relative and any(name == instance.table for _, name in self.counts):
                    self._name(instance.table, instance.shift, bool(instance.ending))

    def _at(self, value: object, path: KeyPath, i: int) -> object:
        """A value for instance i; FAULTY where it has none."""
        if isinstance(value, Mapping):
            return {key: self._at(item, (*path, str(key)), i) for key, item in value.items()}
        if isinstance(value, (list, tuple)):
            return type(value)(self._at(item, (*path, k), i) for k, item in enumerate(value))
        if not isinstance(value, str):
            return value
        result: object = FAULTY
        try:
            if path[-1] == "symbol":
                result = symbol_at(value, i)
            elif (instance := reference(value)) is not None:
                result = self._name(instance.table, instance.index(i), bool(instance.ending)) + instance.ending
            else:
                result = at_index(value, i) if _is_formula(value, path[-1]) else value
        except ValueError as error:
            self.faults.append(Fault(path, str(error)))
        return result

    def _name(self, table: str, index: int, of_body: bool) -> str:
        """The name of an instance that a text refers to. Raises WrongValueError if there is none."""
        name = instance_name(table, index)
        sections = ("bodies",) if of_body else tuple(NAMED)
        if any(name in self.names[section] for section in sections):
            return name
        counts = {str(of): count for (section, of), count in self.counts.items() if section in sections}
        if table in counts:
            if (count := counts[table]) is None:
                return name  # a count that cannot be read is a fault of its own
            indices = f"from 0 to {count - 1}" if count > 1 else "only 0"
            raise WrongValueError(f"there is no {name}: the count of {table} is {count}, and its index is {indices}")
        if any(table in self.names[section] for section in sections):
            raise WrongValueError(f"{table} has no count, and is referred to without an index; write {quoted(table)}")
        known = f"tables with a count are {', '.join(counts)}" if counts else "no such table has a count"
        raise WrongValueError(f"there is no table {quoted(table)} with a count{did_you_mean(table, counts, known)}")


def _varies(value: object, key: str | int) -> bool:
    """Whether a value contains the index or a reference to an instance."""
    if isinstance(value, Mapping):
        return any(_varies(item, str(name)) for name, item in value.items())
    if isinstance(value, (list, tuple)):
        return any(_varies(item, k) for k, item in enumerate(value))
    return isinstance(value, str) and ("[" in value or _is_formula(value, key))


def _is_formula(text: str, key: str | int) -> bool:
    return key not in NAMES and contains_index(text)


def _named_like_the_index(data: Data) -> Iterator[Fault]:
    """Faults of parameters and tables that functions of time call by the name of the index."""
    text = f"{quoted(INDEX)} is taken: it is the index in tables with `count`; choose another name"
    for section in ("parameters", "tables"):
        tables = data.get(section)
        if isinstance(tables, Mapping) and INDEX in tables:
            yield Fault((section, INDEX), text)
    yield from (Fault(path, text) for path in _symbols(data, ()))


def _symbols(value: object, path: KeyPath) -> Iterator[KeyPath]:
    """The paths of symbols of parameters with the name of the index."""
    if isinstance(value, Mapping):
        if value.get("symbol") == INDEX:
            yield (*path, "symbol")
        for name, item in value.items():
            yield from _symbols(item, (*path, str(name)))
    elif isinstance(value, (list, tuple)):
        for k, item in enumerate(value):
            yield from _symbols(item, (*path, k))
