"""What a frame costs: one scene, its rod cut into more and more beams, in two frames, counted and timed."""

from __future__ import annotations

import time
from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from derive.backends.model_files import model_files
from derive.derivation import derive, lower
from derive.mechanics.equations import Equations
from derive.runtime.integrators.run import FixedStep
from derive.runtime.native import Vector
from derive.simulation.compiled_scene import kkt_matrix, mass_matrix
from derive.spec.model.scene import Scene
from derive.study import states
from derive.study.clock import Times, native_of, times
from derive.study.counts import Counts, counts
from derive.study.variants import Variant, variant
from derive.terminal import show_progress

PAPER = {1: 0.97, 2: 0.93, 3: 0.92}
"""CPU time of the mean over the standard version, for 1, 2 and 3 beams: the paper, "Numerical Results".

DADS, 1988, the whole program, another integrator and a general sparse solver: not the same measurement.
"""


@dataclass(frozen=True)
class Framed:
    """One frame: counts, and conditions of M and of the KKT matrix at the start, in SI units, not scaled.

    `seconds` are those that its making took: derive, lower, emit (and count), compile.
    """

    counts: Counts
    condition_mass: float
    condition_kkt: float
    seconds: dict[str, float]


@dataclass(frozen=True)
class Row:
    """So many pieces, in the two frames, with their times."""

    pieces: int
    framed: tuple[Framed, Framed]
    times: Times


@dataclass(frozen=True)
class _Built:
    variant: Variant
    host: FixedStep
    counts: Counts
    seconds: dict[str, float]


def study(scene: Scene, pieces: Sequence[int], frames: tuple[str, str], runs: int) -> tuple[Row, ...]:
    """A row for each number of pieces. First all is compiled, two at a time, then it is timed, one after the other.

    Raises SpecError, CompilerError, SimulationError, HostError.
    """
    with ThreadPoolExecutor(2) as pool:
        waiting = [_build(variant(scene, n, frame), pool) for n in pieces for frame in frames]
        built = [_compiled(*one) for one in waiting]
    return tuple(_row(n, built[2 * i], built[2 * i + 1], runs) for i, n in enumerate(pieces))


def _build(
    one: Variant, pool: ThreadPoolExecutor
) -> tuple[Variant, Counts, dict[str, float], Future[tuple[FixedStep, float]]]:
    """A variant that is being compiled."""
    show_progress(f"deriving and lowering: {_said(one)}")
    marks = [time.perf_counter()]
    equations = derive(one.scene)
    assert isinstance(equations, Equations)
    marks.append(time.perf_counter())
    model = lower(equations)
    marks.append(time.perf_counter())
    files, found = model_files(model, one.scene), counts(equations)
    marks.append(time.perf_counter())
    seconds = dict(zip(("derive", "lower", "emit"), np.diff(marks).tolist(), strict=True))

    def compiled() -> tuple[FixedStep, float]:
        before = time.perf_counter()
        host = FixedStep(files)
        return host, time.perf_counter() - before

    return one, found, seconds, pool.submit(compiled)


def _compiled(one: Variant, found: Counts, seconds: dict[str, float], host: Future[tuple[FixedStep, float]]) -> _Built:
    show_progress(f"compiling: {_said(one)}")
    made, took = host.result()
    return _Built(one, made, found, {**seconds, "compile": took})


def _row(pieces: int, first: _Built, second: _Built, runs: int) -> Row:
    both = (first, second)
    starts = tuple(states.start(b.variant.scene, native_of(b.host), native_of(b.host).setup()) for b in both)
    simulation = first.variant.scene.simulation
    assert simulation is not None
    said = f"{pieces} beam{'s' if pieces > 1 else ''}"

    def told(run: int) -> None:
        show_progress(f"timing {said}: run {run + 1} of {runs}")

    show_progress(f"timing {said}")
    timed = times((first.host, second.host), (starts[0], starts[1]), simulation.duration, runs, told)
    framed = [_framed(b, q) for b, (_, q, _) in zip(both, starts, strict=True)]
    return Row(pieces, (framed[0], framed[1]), timed)


def _framed(built: _Built, q: Vector) -> Framed:
    native = native_of(built.host)
    k = native.setup()
    return Framed(
        built.counts,
        float(np.linalg.cond(mass_matrix(native, q, k))),
        float(np.linalg.cond(kkt_matrix(native, 0.0, q, k))),
        built.seconds,
    )


def _said(one: Variant) -> str:
    return f"{one.pieces} beam{'s' if one.pieces > 1 else ''}, {one.frame} frame"
