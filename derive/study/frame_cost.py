"""The cost of a frame: non-zeros, operations and CPU time of one scene in two frames, for several numbers of beams."""

from __future__ import annotations

import time
from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from derive.backends.model_files import emit
from derive.derivation import derive
from derive.ir.model import Model
from derive.lowering.elimination_orders import EliminationRule
from derive.lowering.flat.kkt_matrix import DependentConstraints
from derive.lowering.flat.lower import lower
from derive.mechanics.equations import Equations
from derive.remaining_time import RemainingTime
from derive.runtime.integrators.fixed_step import FixedStep
from derive.runtime.native_call import Vector
from derive.simulation.compiled_scene import kkt_matrix, mass_matrix
from derive.simulation.redundant_joints import with_redundant_joints
from derive.spec.model.scene import Scene
from derive.study.states import start_state
from derive.study.timing import InterleavedTimes, interleaved_times
from derive.study.variants import OperationCounts, SceneVariant, operation_counts, variant
from derive.terminal import Report, beam_count

PAPER = {1: 0.97, 2: 0.93, 3: 0.92}
"""CPU time in the mean frame over that of the standard version for 1, 2, 3 beams: the paper, "Numerical Results".

It is that of a whole program (DADS, 1988) with another integrator and a general sparse solver.
"""


@dataclass(frozen=True)
class FrameCost:
    """The cost of one frame: counts, and condition numbers of M and of the initial KKT matrix, in SI units, not scaled.

    seconds: of the stages derive, lower, emit (with the counts), compile.
    """

    counts: OperationCounts
    condition_mass: float
    condition_kkt: float
    seconds: dict[str, float]


@dataclass(frozen=True)
class FrameComparison:
    """The cost of two frames for a number of pieces, and the CPU times; whether joints are redundant in one of them."""

    pieces: int
    costs: tuple[FrameCost, FrameCost]
    times: InterleavedTimes
    redundant: bool = False


@dataclass(frozen=True)
class _Built:
    variant: SceneVariant
    host: FixedStep
    counts: OperationCounts
    seconds: dict[str, float]


def compare_frames(
    scene: Scene,
    pieces: Sequence[int],
    frames: tuple[str, str],
    runs: int,
    elimination: EliminationRule,
    task: Report,
) -> tuple[FrameComparison, ...]:
    """The comparison of two frames for each number of pieces: first all variants are compiled, then they are timed.

    elimination: the order in which the KKT matrices of both frames are eliminated; redundant joints have another one.
    task: called with a line on each step.

    Raises SpecError, CompilerError, SimulationError, IntegratorError.
    """
    return with_redundant_joints(scene, lambda given: _frames(given, pieces, frames, runs, elimination, task))


def _frames(
    scene: Scene,
    pieces: Sequence[int],
    frames: tuple[str, str],
    runs: int,
    elimination: EliminationRule,
    task: Report,
) -> tuple[FrameComparison, ...]:
    with ThreadPoolExecutor(2) as pool:
        remaining = RemainingTime(2 * len(frames) * len(pieces) + len(pieces))
        variants = [variant(scene, n, frame) for n in pieces for frame in frames]
        pending = [_build(of, elimination, pool, remaining, task) for of in variants]
        built = [_compiled(*item, remaining, task) for item in pending]
    pairs = enumerate(pieces)
    return tuple(_comparison(n, built[2 * i], built[2 * i + 1], runs, remaining, task) for i, n in pairs)


def _build(
    variant: SceneVariant,
    elimination: EliminationRule,
    pool: ThreadPoolExecutor,
    remaining: RemainingTime,
    task: Report,
) -> tuple[SceneVariant, OperationCounts, dict[str, float], Future[tuple[FixedStep, float]]]:
    """Generate a variant and submit its compilation to the pool."""
    task(f"step {remaining.next()}: deriving and lowering: {_label(variant)} ...")
    marks = [time.perf_counter()]
    equations = derive(variant.scene).expanded()
    marks.append(time.perf_counter())
    model = _lowered(equations, variant.scene, elimination)
    marks.append(time.perf_counter())
    files, counts = emit(model, variant.scene), operation_counts(equations, model, elimination)
    marks.append(time.perf_counter())
    seconds = dict(zip(("derive", "lower", "emit"), np.diff(marks).tolist(), strict=True))

    def compiled() -> tuple[FixedStep, float]:
        before = time.perf_counter()
        host = FixedStep(files)
        return host, time.perf_counter() - before

    return variant, counts, seconds, pool.submit(compiled)


def _lowered(equations: Equations, scene: Scene, elimination: EliminationRule) -> Model:
    """The model, with a proximal term where the joints of the scene are redundant whatever its numbers are."""
    if scene.redundant != "resolve":
        try:
            return lower(equations, elimination=elimination)
        except DependentConstraints:
            if scene.redundant == "error":
                raise
    return lower(equations, elimination=elimination, proximal=True)


def _compiled(
    variant: SceneVariant,
    counts: OperationCounts,
    seconds: dict[str, float],
    host: Future[tuple[FixedStep, float]],
    remaining: RemainingTime,
    task: Report,
) -> _Built:
    task(f"step {remaining.next()}: compiling: {_label(variant)} ...")
    compiled, took = host.result()
    return _Built(variant, compiled, counts, {**seconds, "compile": took})


def _comparison(
    pieces: int, first: _Built, second: _Built, runs: int, remaining: RemainingTime, task: Report
) -> FrameComparison:
    both = (first, second)
    starts = tuple(start_state(b.variant.scene, b.host.native, b.host.native.setup()) for b in both)
    simulation = first.variant.scene.simulation
    assert simulation is not None

    step = f"step {remaining.next()}: timing {beam_count(pieces)}"

    def progress(run: int) -> None:
        task(f"{step}: run {run + 1} of {runs} ...")

    task(f"{step} ...")
    hosts = (first.host, second.host)
    times = interleaved_times(hosts, (starts[0], starts[1]), simulation.duration, runs, progress)
    costs = [_cost(b, q) for b, (_, q, _) in zip(both, starts, strict=True)]
    return FrameComparison(pieces, (costs[0], costs[1]), times, any(b.host.native.proximal for b in both))


def _cost(built: _Built, q: Vector) -> FrameCost:
    native = built.host.native
    k = native.setup()
    return FrameCost(
        built.counts,
        float(np.linalg.cond(mass_matrix(native, q, k))),
        float(np.linalg.cond(kkt_matrix(native, 0.0, q, k))),
        built.seconds,
    )


def _label(variant: SceneVariant) -> str:
    return f"{beam_count(variant.pieces)}, {variant.frame} frame"
