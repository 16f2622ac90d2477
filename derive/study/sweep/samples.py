"""The samples of a sweep: a grid, lists of values, or random numbers; the same on every machine."""

from __future__ import annotations

import csv
import itertools
import math
import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import NormalDist

import numpy as np
from numpy.typing import ArrayLike

from derive import short_text
from derive.errors import TisserandError
from derive.registry import UnknownNameError
from derive.runtime.native_call import Matrix, Vector

MOST_SAMPLES = 1_000_000
"""The largest number of samples of a sweep: more of them need hours and gigabytes."""


class SamplesError(TisserandError):
    """The samples of a sweep are not valid."""


@dataclass(frozen=True, eq=False)
class Samples:
    """Values of parameters, or of keys of a specification: a row for each sample.

    Attributes:
        names: those of the parameters or keys.
        values: (n, names), in SI units.
        shape: the numbers of values of a grid, whose last name changes fastest; () if the samples are no grid.

    Examples:
        >>> import derive
        >>> samples = derive.Samples(("EI", "m"), [[10, 1], [20, 1]])
        >>> samples.varying
        ('EI',)
    """

    names: tuple[str, ...]
    values: Matrix
    shape: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        repeated = sorted({name for name in self.names if self.names.count(name) > 1})
        if repeated:
            raise SamplesError(f"{', '.join(repeated)}: several sets of values; give one")
        object.__setattr__(self, "values", np.asarray(self.values, dtype=np.float64))
        if self.values.ndim != 2 or self.values.shape[1] != len(self.names) or not self.values.size:
            raise SamplesError(f"samples of {len(self.names)} names need an array (n, {len(self.names)}) of values")
        if not np.all(np.isfinite(self.values)):
            raise SamplesError("samples have values that are not finite")

    def __len__(self) -> int:
        return len(self.values)

    def axis(self, name: str) -> Vector:
        """The different values of the parameter or key `name`, in the order in which they appear.

        Raises:
            UnknownNameError: if there is no such name.

        Examples:
            >>> samples.axis("EI")
            array([10., 20.])
        """
        if name not in self.names:
            raise UnknownNameError("name of the samples", name, self.names)
        column = self.values[:, self.names.index(name)]
        return np.array(list(dict.fromkeys(column.tolist())))

    @property
    def varying(self) -> tuple[str, ...]:
        """The names that have more than one value."""
        return tuple(name for name in self.names if len(self.axis(name)) > 1)

    def __repr__(self) -> str:
        grid = f", a grid of {' x '.join(map(str, self.shape))}" if self.shape else ""
        bounds = zip(self.names, self.values.min(axis=0), self.values.max(axis=0), strict=True)
        ranges = short_text.listed(f"{name} from {low:.4g} to {high:.4g}" for name, low, high in bounds)
        return short_text.summary(
            f"Samples: {len(self)} of {short_text.counted(len(self.names), 'name')}{grid}", {"values": ranges}
        )


@dataclass(frozen=True)
class Random:
    """A distribution of random numbers: `quantile` maps a number in (0, 1) to the value below which that part lies."""

    quantile: Callable[[float], float]


def constant(value: float) -> Random:
    """The distribution that gives the same number each time."""
    return Random(lambda _: value)


def uniform(low: float, high: float) -> Random:
    """The uniform distribution of numbers between two bounds."""
    return Random(lambda u: low + (high - low) * u)


def log_uniform(low: float, high: float) -> Random:
    """The distribution of numbers between two positive bounds whose logarithms are uniform."""
    if not 0.0 < low <= high:
        raise SamplesError(f"loguniform({low:g}, {high:g}): 0 < low <= high is needed")
    return Random(lambda u: math.exp(math.log(low) + (math.log(high) - math.log(low)) * u))


def normal(mean: float, deviation: float) -> Random:
    """The normal distribution with a mean and a standard deviation."""
    if not deviation > 0.0:
        raise SamplesError(f"normal({mean:g}, {deviation:g}): a positive standard deviation is needed")
    return Random(NormalDist(mean, deviation).inv_cdf)


def grid(axes: Mapping[str, ArrayLike | str]) -> Samples:
    """All combinations of the values of each name; those of the last name change fastest.

    Arguments:
        axes: by name, values (m,), or a text such as "10:100:40" (start:stop:count) or "10:100:40:log".

    Raises:
        SamplesError: for a text that is none of these, for values that are not finite, and without any name.

    Examples:
        >>> import derive
        >>> samples = derive.grid({"EI": "10:30:3", "m": [1, 2]})
        >>> samples.shape
        (3, 2)
        >>> samples.values[:3]
        array([[10.,  1.],
               [10.,  2.],
               [20.,  1.]])
    """
    _check_names(axes)
    columns = [np.atleast_1d(np.asarray(_values(name, given), dtype=np.float64)) for name, given in axes.items()]
    for name, column in zip(axes, columns, strict=True):
        if len(set(column.tolist())) < len(column):
            raise SamplesError(f"{name}: a value of the grid is given twice")
    _check_count(math.prod(map(len, columns)))
    values = np.array(list(itertools.product(*columns)), dtype=np.float64).reshape(-1, len(columns))
    return Samples(tuple(axes), values, tuple(map(len, columns)))


def _check_names(given: object) -> None:
    """Raise SamplesError for anything but a mapping from names to values, which is not empty."""
    if not isinstance(given, Mapping) or not given:
        raise SamplesError('samples need names with their values, such as {"EI": [10, 20]}')


def _check_count(count: int) -> None:
    """Raise SamplesError if there are too many samples, before they take memory."""
    if count > MOST_SAMPLES:
        raise SamplesError(
            f"{count} samples are more than the {MOST_SAMPLES} that a sweep takes; sweep in several parts"
        )


def _values(name: str, given: ArrayLike | str) -> ArrayLike:
    axis = parse_axis(name, given) if isinstance(given, str) else given
    if isinstance(axis, Random):
        raise SamplesError(f"{name}={given!s}: a grid has no random values; use random_samples")
    return axis


def listed(columns: Mapping[str, ArrayLike]) -> Samples:
    """Samples one by one: the first values of all names, the second ones, and so on.

    Arguments:
        columns: by name, values (n,), or a number for all samples.

    Raises:
        SamplesError: if the numbers of values differ.

    Examples:
        >>> import derive
        >>> derive.listed({"EI": [10, 20, 40], "m": 2}).values
        array([[10.,  2.],
               [20.,  2.],
               [40.,  2.]])
    """
    _check_names(columns)
    try:
        rows = np.broadcast_arrays(*(np.atleast_1d(np.asarray(c, dtype=np.float64)) for c in columns.values()))
    except ValueError:
        raise SamplesError("a list of samples needs the same number of values of each name") from None
    return Samples(tuple(columns), np.stack(rows, axis=1))


def random_samples(axes: Mapping[str, Random | float | str], count: int, seed: int = 0) -> Samples:
    """Independent random samples, of which the first ones do not depend on their number.

    The numbers follow from the seed alone: those of the generator of Python's `random`, which all versions share.

    Arguments:
        axes: a distribution for each name, such as "uniform(10, 100)", "loguniform(1, 100)" or "normal(10, 0.5)" with
            its standard deviation; or a number, which all samples have.
        count: the number of samples.
        seed: of the generator.

    Raises:
        SamplesError: for a text that is no distribution, and for a count below 1.

    Examples:
        >>> import derive
        >>> samples = derive.random_samples({"EI": "uniform(10, 100)", "m": "normal(1, 0.1)"}, 100, seed=1)
        >>> samples.values.shape
        (100, 2)
        >>> samples.values.mean(axis=0).round(1)
        array([52.8,  1. ])
    """
    _check_names(axes)
    if not isinstance(count, int) or count < 1:
        raise SamplesError(f"the number of samples is a whole number from 1 on, not {count}")
    _check_count(count)
    generator, known = random.Random(seed), [_distribution(name, axis) for name, axis in axes.items()]
    rows = [[axis.quantile(max(generator.random(), 2.0**-53)) for axis in known] for _ in range(count)]
    return Samples(tuple(axes), np.array(rows, dtype=np.float64).reshape(-1, len(axes)))


def _distribution(name: str, given: Random | float | str) -> Random:
    axis = parse_axis(name, given) if isinstance(given, str) else given
    if isinstance(axis, Sequence):
        if len(axis) > 1:
            raise SamplesError(f"{name}={given}: a distribution or one number is needed")
        axis = axis[0]
    return axis if isinstance(axis, Random) else constant(axis)


def spaced(start: float, stop: float, count: int, logarithmic: bool = False) -> Vector:
    """`count` values from `start` to `stop`: evenly spaced, or with a constant ratio. Raises SamplesError."""
    if logarithmic and not (start > 0.0 and stop > 0.0):
        raise SamplesError(f"{start:g}:{stop:g}:{count}:log: both ends have to be positive")
    if count == 1 and start != stop:
        raise SamplesError(f"{start:g}:{stop:g}:1: one value cannot be at both ends")
    _check_count(count)
    return np.geomspace(start, stop, count) if logarithmic else np.linspace(start, stop, count)


Axis = Sequence[float] | Random
"""The values of one name, or their distribution."""

DISTRIBUTIONS: Mapping[str, Callable[[float, float], Random]] = {
    "uniform": uniform,
    "loguniform": log_uniform,
    "normal": normal,
}
"""The distributions by their names on the command line."""


def parse_axis(name: str, text: str) -> Axis:
    """The values in a text: `10:100:40`, `10:100:40:log`, `10,20,50`, `uniform(10, 100)`. Raises SamplesError."""
    try:
        return _parsed(text.strip())
    except ValueError:
        raise SamplesError(
            f"{name}={text}: expected start:stop:count such as 10:100:40 (or 10:100:40:log), numbers such as 10,20,50, "
            "or a distribution such as uniform(10,100), loguniform(1,100), normal(10,0.5)"
        ) from None


def _parsed(text: str) -> Axis:
    for kind, distribution in DISTRIBUTIONS.items():
        if text.startswith(f"{kind}(") and text.endswith(")"):
            first, second = (_number(part) for part in text[len(kind) + 1 : -1].split(","))
            return distribution(first, second)
    if ":" in text:
        start, stop, count, *spacing = text.split(":")
        if spacing not in ([], ["log"]) or int(count) < 1:
            raise ValueError
        return [float(x) for x in spaced(_number(start), _number(stop), int(count), bool(spacing))]
    return [_number(part) for part in text.split(",")]


def _number(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError
    return value


def read_samples(path: Path) -> dict[str, list[float]]:
    """The columns of a CSV file with a line of names and a line of numbers for each sample. Raises SamplesError."""
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            lines = [(number, row) for number, row in enumerate(csv.reader(file), 1) if row]
    except (UnicodeDecodeError, csv.Error) as error:
        raise SamplesError(f"{path}: this is no CSV file: {error}") from None
    if len(lines) < 2:
        raise SamplesError(f"{path}: a line of names and a line of numbers for each sample are needed")
    names = [name.strip() for name in lines[0][1]]
    columns: dict[str, list[float]] = {name: [] for name in names}
    if len(columns) < len(names) or "" in columns:
        raise SamplesError(f"{path}:1: each column needs a name of its own")
    for number, row in lines[1:]:
        try:
            for name, text in zip(names, row, strict=True):
                columns[name].append(_number(text))
        except ValueError:
            raise SamplesError(f"{path}:{number}: {len(names)} numbers are needed, not {', '.join(row)}") from None
    return columns


def parsed_samples(
    assignments: Sequence[tuple[str, str]], count: int | None, seed: int | None, table: Path | None = None
) -> Samples:
    """The samples that `--set NAME=VALUES`, `--samples`, `--seed` and `--list` describe.

    They are a grid, `count` random samples if there are distributions, or the lines of the file `table`, whose values
    go together and with the numbers that are set. Raises SamplesError.
    """
    repeated = sorted({name for name, _ in assignments if [n for n, _ in assignments].count(name) > 1})
    if repeated:
        raise SamplesError(f"{', '.join(repeated)}: several sets of values; give one --set of each name")
    axes = {name: parse_axis(name, text) for name, text in assignments}
    drawn = [name for name, axis in axes.items() if isinstance(axis, Random)]
    if (count is not None or seed is not None) and not drawn:
        raise SamplesError("--samples and --seed are for random values, such as --set EI=uniform(10,100)")
    if table is not None:
        columns = read_samples(table)
        for name, axis in axes.items():
            if isinstance(axis, Random) or len(axis) > 1 or name in columns:
                raise SamplesError(f"{name}: beside --list, --set takes one number for a name that is not in the file")
        return listed({**columns, **{name: axis for name, axis in axes.items() if not isinstance(axis, Random)}})
    if not axes:
        raise SamplesError("no values to sweep over: add --set, such as --set EI=10:100:40, or --list FILE")
    if not drawn:
        return grid({name: axis for name, axis in axes.items() if not isinstance(axis, Random)})
    for name, axis in axes.items():
        if not isinstance(axis, Random) and len(axis) > 1:
            raise SamplesError(
                f"{name} has {len(axis)} values and {drawn[0]} is random: give {name} one value or a distribution as "
                "well, or all names values of a grid"
            )
    if count is None:
        raise SamplesError(f"{drawn[0]} is random: add --samples N, the number of samples")
    return random_samples(dict(assignments), count, seed or 0)
