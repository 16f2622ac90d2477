"""Names of variables of many instances in C: tables of series, from which they are composed when they are needed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import accumulate

from derive.backends.description import affine
from derive.ir.model import MarkerClass, Model, Variable
from derive.ir.series import VariableSeries, variable_series
from derive.spec.model.instances import identifier


@dataclass(frozen=True)
class SeriesTable:
    """The series of a table of variables or names.

    name: that of the table: q, v, lambda, u or out of variables, else that of what is named. The names are those for
    people, with indices in brackets.
    """

    name: str
    series: tuple[VariableSeries, ...]
    text_size: int
    variables: bool = True

    @property
    def size(self) -> int:
        """The number of names."""
        return sum(series.size for series in self.series)

    @property
    def labels(self) -> tuple[Variable, ...]:
        """The labels of all series, one series after the other."""
        return tuple(label for series in self.series for label in series.labels)

    @property
    def rows(self) -> tuple[tuple[VariableSeries, int], ...]:
        """The series, each with the number of its first label."""
        firsts = accumulate((len(series.labels) for series in self.series), initial=0)
        return tuple(zip(self.series, firsts, strict=False))


@dataclass(frozen=True)
class ComposedMarkers:
    """A class of markers with the table of their names."""

    of: MarkerClass
    names: str


@dataclass(frozen=True)
class ComposedNames:
    """All tables of series of a model, and its classes of markers."""

    tables: tuple[SeriesTable, ...]
    markers: tuple[ComposedMarkers, ...]

    @property
    def text_size(self) -> int:
        """The number of characters of all names."""
        return sum(table.text_size for table in self.tables)

    def indices(self, name: str) -> list[tuple[str, int]]:
        """The names and the indices of the variables of a table that are on their own."""
        return [
            (label.name, first + k)
            for series, first in self._series(name)
            if not series.table
            for k, label in enumerate(series.labels)
        ]

    def macros(self, prefix: str) -> list[str]:
        """The definitions of the indices of the variables of instance i, in C."""
        places: dict[str, list[_Place]] = {}
        for table in (table.name for table in self.tables if table.variables):
            for series, first in self._series(table):
                step = len(series.labels)
                for k, label in enumerate(series.labels if series.table else (), first - series.first * step):
                    name = f"{prefix}_{table.upper()}_{identifier(series.table, label.name)}"
                    places.setdefault(name, []).append((series.first + series.count, affine(k, step, "(i)")))
        return [f"#define {name}(i) ({_chosen(of)})" for name, of in places.items()]

    def _series(self, name: str) -> Iterator[tuple[VariableSeries, int]]:
        """The series of a table, each with the index of its first variable."""
        (table,) = (table for table in self.tables if table.name == name)
        return zip(table.series, accumulate((series.size for series in table.series), initial=0), strict=False)


_Place = tuple[int, str]
"""The index of the first instance after some, and the index of a variable of these."""


def _chosen(places: list[_Place]) -> str:
    """The index of a variable whose instances are in several series."""
    *others, (_, last) = sorted(places)
    return "".join(f"(i) < {end} ? {index} : " for end, index in others) + last


def composed_names(model: Model) -> ComposedNames:
    """The tables of names that depend on the number of instances."""
    kinds = {
        "q": model.coordinates,
        "v": model.velocities,
        "lambda": model.multipliers,
        "u": model.inputs,
        "out": model.outputs,
    }
    tables = [_table(name, variables) for name, variables in kinds.items() if variables]
    bodies = tuple(Variable(name, "", "", shown=name) for name in model.bodies)
    tables.append(_table("bodies", bodies, variables=False))
    markers = [ComposedMarkers(of, f"markers_{of.name}") for of in model.marker_classes]
    tables += [_table(m.names, m.of.markers, variables=False) for m in markers]
    return ComposedNames(tuple(tables), tuple(markers))


def _table(name: str, of: Iterable[Variable], variables: bool = True) -> SeriesTable:
    own = tuple(of)
    size = sum(len(v.title) + 1 for v in own)
    return SeriesTable(name, variable_series(own), size, variables)
