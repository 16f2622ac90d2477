"""The result of a sweep: the values of all outputs in all samples, and the failures of those without values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from derive.display import Tabulated
from derive.registry import UnknownNameError
from derive.runtime.native_call import Matrix, Vector
from derive.short_text import summary
from derive.study.sweep.outputs import SweepOutput
from derive.study.sweep.samples import Samples


@dataclass(frozen=True, eq=False, repr=False)
class SweepResult(Tabulated):
    """The result of a sweep: `result["peak_slider_s"]` is the output of that name.

    It is an array (n,), or for a grid an array with an axis for each name. `to_pandas` returns a pandas.DataFrame with
    a row for each sample: its values, its outputs and its failure, if any.

    Attributes:
        name: that of the model.
        samples: those of the sweep.
        outputs: what each run is reduced to.
        values: (n, outputs): NaN for failed samples.
        failures: the reasons of failed samples by their numbers.
        notes: the deviations of runs from the specification, by the number of the sample.
        warnings: those of the monitors of beams, by the number of the sample, in the samples with the largest amount of
            each output; others are not monitored.
        models: the number of models that were computed.
        initial_states: the number of initial states that were computed.
        units: those of the names that are parameters.
        resumed: the samples that an earlier run had finished.
        damaged: the lines of its store that are left out, whose samples are computed again.

    Examples:
        >>> import derive
        >>> ball = derive.scene(
        ...     "flight",
        ...     gravity=(0, {"symbol": "g", "default": -10}),
        ...     bodies={"ball": {"mass": 1, "inertia": 1, "start": {"velocity": (0, 10)}}},
        ... )
        >>> result = derive.sweep(ball, derive.grid({"g": [-10, -20]}), ["peak:ball_c2"], duration=2, interval=0.5)
        >>> result.labels, result.failures
        (('peak_ball_c2',), {})
        >>> result.to_pandas()["peak_ball_c2"].round(6).tolist()
        [5.0, 20.0]
    """

    name: str
    samples: Samples
    outputs: tuple[SweepOutput, ...]
    values: Matrix
    failures: Mapping[int, str]
    notes: Mapping[int, tuple[str, ...]]
    warnings: Mapping[int, tuple[str, ...]]
    models: int
    initial_states: int
    units: Mapping[str, str]
    resumed: int = 0
    damaged: int = 0

    @property
    def labels(self) -> tuple[str, ...]:
        """The names of the outputs."""
        return tuple(output.label for output in self.outputs)

    def column(self, label: str) -> Vector:
        """The values (n,) of an output by its `label`, or by the text that the sweep was given.

        Raises:
            UnknownNameError: if there is no such output.

        Examples:
            >>> result.column("peak:ball_c2").round(6)
            array([ 5., 20.])
        """
        given = {f"{output.statistic.value}:{output.name}": output.label for output in self.outputs}
        known = given.get(label, label)
        if known not in self.labels:
            raise UnknownNameError("output of the sweep", label, self.labels)
        return self.values[:, self.labels.index(known)]

    def __repr__(self) -> str:
        failed = f", {len(self.failures)} of them failed" if self.failures else ""
        names = ", ".join(self.samples.names)
        head = f"Sweep of {self.name}: {len(self.samples)} samples of {names}{failed}"
        return summary(f"{head}; outputs {', '.join(self.labels)}")

    def __getitem__(self, label: str) -> NDArray[np.float64]:
        return self.column(label).reshape(self.samples.shape or -1)

    def sample(self, number: int) -> dict[str, float]:
        """The values of the sample with a `number` by their names.

        Examples:
            >>> result.sample(1)
            {'g': -20.0}
        """
        return dict(zip(self.samples.names, self.samples.values[number].tolist(), strict=True))

    def reasons(self) -> Iterator[tuple[str, tuple[int, ...]]]:
        """The reasons of failures, the most frequent first: the text, and the numbers of the samples with it.

        Examples:
            >>> list(result.reasons())
            []
        """
        yield from _by_text({number: (text,) for number, text in self.failures.items()})

    def remarks(self) -> Iterator[tuple[str, tuple[int, ...]]]:
        """The notes, the most frequent first: the text, and the numbers of the samples with it.

        Examples:
            >>> list(result.remarks())
            []
        """
        yield from _by_text(self.notes)


def _by_text(texts: Mapping[int, tuple[str, ...]]) -> Iterator[tuple[str, tuple[int, ...]]]:
    numbers: dict[str, list[int]] = {}
    for number in sorted(texts):
        for text in texts[number]:
            numbers.setdefault(text, []).append(number)
    for text, having in sorted(numbers.items(), key=lambda item: -len(item[1])):
        yield text, tuple(having)
