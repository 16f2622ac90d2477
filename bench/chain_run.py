"""The figures of chains of beams, and the file that keeps those of a run."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path

FLAT, INSTANCES, CASADI = "flat", "instances", "casadi"
"""The forms of generated C."""
BOTH_ENDS, LANES, ANY_GRAPH = "both ends", "lanes", "any graph"
"""The forms of C by hand: from both ends in two lanes; neighbouring beams in lanes; tables for any graph."""


@dataclass(frozen=True)
class Figures:
    """The figures of a chain of `count` beams in one form; None or 0 where there are none.

    seconds: CPU time by stage of generation. size: the bytes of the C file, of which `tables` are those of constant
    tables; header: those of the header. compiler, megabytes: CPU time (s) and memory of the compiler. ns, batch_ns:
    times per body of the accelerations, alone and in a batch of eight states.
    """

    count: int
    form: str
    seconds: Mapping[str, float] = field(default_factory=dict)
    size: int = 0
    tables: int = 0
    header: int = 0
    compiler: float | None = None
    megabytes: float | None = None
    ns: float | None = None
    batch_ns: float | None = None

    @property
    def generation(self) -> float:
        """The CPU time (s) of all stages of generation."""
        return sum(self.seconds.values())


@dataclass(frozen=True)
class Run:
    """The figures of a run, and lines on the machine, the compiler, the versions and the flags."""

    machine: tuple[str, ...]
    figures: tuple[Figures, ...]


def write_run(run: Run, path: Path) -> None:
    """Write a run as JSON, with a line for each of its figures."""
    lines = ",\n".join(f"  {json.dumps({k: _short(v) for k, v in asdict(f).items()})}" for f in run.figures)
    path.write_text(f'{{"machine": {json.dumps(run.machine)},\n"figures": [\n{lines}\n]}}\n')


def read_run(path: Path) -> Run:
    """The run that `write_run` has written."""
    data = json.loads(path.read_text())
    return Run(tuple(data["machine"]), tuple(Figures(**f) for f in data["figures"]))


def _short(value: object) -> object:
    """A value whose times have five digits."""
    if isinstance(value, dict):
        return {key: _short(each) for key, each in value.items()}
    return float(f"{value:.5g}") if isinstance(value, float) else value
