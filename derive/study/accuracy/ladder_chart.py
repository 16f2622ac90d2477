"""The result of a study of accuracy as data: the models with their runs, the reference, and the headline."""

from __future__ import annotations

from dataclasses import dataclass

from derive.display import Tabulated
from derive.short_text import counted, summary
from derive.study.accuracy.headline import Headline, headline, headline_texts
from derive.study.accuracy.measurement import Line
from derive.study.accuracy.peers import Peer
from derive.study.accuracy.reference import Reference


@dataclass(frozen=True, repr=False)
class LadderChart(Tabulated):
    """The result of a study of accuracy: the error of each model of a ladder against what it costs.

    `to_pandas` returns a pandas.DataFrame with a row for each run of each model: errors, times, operations.

    Attributes:
        name: that of the scene.
        lines: the models, each with its runs from coarse to fine.
        reference: the curves that models are compared with, and their own error.
        error: the largest error (rms) that is allowed, relative to the peak.
        machine: the processor, the compiler and its flags.
        peers: the runs of other programs.
        shown: the names of the beams that the plot shows, if it shows some alone.
        notes: lines on models that were left out, on approximate starts, and on an interruption.

    Examples:
        >>> import derive
        >>> arm = derive.scene(
        ...     "arm",
        ...     gravity=(0, -9.81),
        ...     ground={"hub": [0, 0]},
        ...     bodies={"arm": {"mass": 1, "length": 1, "bending_stiffness": 20, "markers": {"root": -1, "tip": 1}}},
        ...     joints={"hub": {"kind": "revolute", "between": ["ground.hub", "arm.root"]}},
        ...     outputs={"tip": {"kind": "position", "marker": "arm.tip"}},
        ...     plots={"height": {"y": "tip_2"}},
        ...     simulation={"duration": 0.3, "output": 0.01},
        ... )
        >>> study = derive.study_accuracy(arm, orders=["first"], shapes=[2], pieces=[], sines=[1], runs=1)
        >>> study.lines[0].model.label, len(study.lines)
        ('rigid', 3)
        >>> study.to_pandas()["model"].unique().tolist()
        ['rigid', '1 sine, first', '1 beam, P2, P3, first']
    """

    name: str
    lines: tuple[Line, ...]
    reference: Reference
    error: float
    machine: str
    peers: tuple[Peer, ...] = ()
    shown: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def drawn(self) -> tuple[Line, ...]:
        """The models that have runs."""
        return tuple(line for line in self.lines if line.points)

    @property
    def headline(self) -> Headline:
        """The result: the recommended run, a cheaper one in doubt, and the next better one."""
        return headline(self.lines, self.error, self.reference.error)

    def __repr__(self) -> str:
        runs = sum(len(line.points) for line in self.lines)
        models = f"{counted(len(self.lines), 'model')} in {counted(runs, 'run')}"
        result = dict(headline_texts(self.headline, self.shown)) if self.drawn else {}
        return summary(f"LadderChart of {self.name}: {models}", {**result, "notes": "; ".join(self.notes)})
