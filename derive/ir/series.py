"""Series of variables: those of the instances of a table, which differ in the index of the instance alone."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

from derive.ir.model import Variable
from derive.spec.model.instances import InstanceName, instance_parts, skeleton, text_of_instances


@dataclass(frozen=True)
class VariableSeries:
    """The variables of successive instances, each of which has one for each of `labels`; or variables on their own.

    table, first, count: the instances table[first], table[first + 1] and so on; "", 0 and 1 for variables on their own,
    whose `labels` have their whole names. Texts of `labels` contain the index i of the instance.
    """

    table: str
    first: int
    count: int
    labels: tuple[Variable, ...]

    @property
    def size(self) -> int:
        """The number of variables."""
        return self.count * len(self.labels)


def variable_series(variables: Iterable[Variable]) -> tuple[VariableSeries, ...]:
    """The series that variables are, in their order."""
    parted = [(instance_parts(v.title), v) for v in variables]
    every = _instances(parted)
    counts = Counter(instance.where.table for instance in every)
    series: list[VariableSeries] = []
    for (table, _), instances in groupby(every, key=lambda instance: (instance.where.table, instance.key)):
        for run in _runs(list(instances)):
            if table and counts[table] > 1:
                first = run[0].where.index or 0
                series.append(VariableSeries(table, first, len(run), _labels(run, first)))
            else:
                own = tuple(v for instance in run for v in instance.variables)
                before = series.pop().labels if series and not series[-1].table else ()
                series.append(VariableSeries("", 0, 1, (*before, *own)))
    return tuple(series)


@dataclass(frozen=True)
class _Instance:
    """The variables of an instance, with what follows the index in their names."""

    where: InstanceName
    endings: tuple[str, ...]
    variables: tuple[Variable, ...]

    @property
    def key(self) -> object:
        """All in which instances of a series are alike."""
        if self.where.index is None:
            return None
        every = zip(self.endings, self.variables, strict=True)
        return tuple((ending, v.unit, v.role, v.size, skeleton(v.doc)) for ending, v in every)


def _instances(parted: Sequence[tuple[InstanceName, Variable]]) -> list[_Instance]:
    groups = groupby(parted, key=lambda part: (part[0].table, part[0].index))
    result = []
    for _, group in groups:
        own = list(group)
        result.append(_Instance(own[0][0], tuple(p.ending for p, _ in own), tuple(v for _, v in own)))
    return result


def _runs(instances: Sequence[_Instance]) -> list[list[_Instance]]:
    """The runs of instances whose indices follow each other."""
    runs: list[list[_Instance]] = []
    for instance in instances:
        if runs and (runs[-1][-1].where.index or 0) + 1 == instance.where.index:
            runs[-1].append(instance)
        else:
            runs.append([instance])
    return runs


def _labels(run: Sequence[_Instance], first: int) -> tuple[Variable, ...]:
    return tuple(
        replace(v, name=ending, doc=text_of_instances([instance.variables[k].doc for instance in run], first), shown="")
        for k, (ending, v) in enumerate(zip(run[0].endings, run[0].variables, strict=True))
    )
