"""Chunks of a sweep on an executor of `concurrent.futures`: workers that are killed lose nothing.

A chunk whose worker is lost runs again. One that is lost several times runs alone; if it is then lost again, it is
halved, until the single sample is known that ends its worker. That sample fails, and all others have their results.
Executors such as that of Dask repeat chunks themselves before they give them up, so that these are halved at once.
"""

from __future__ import annotations

import sys
from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED as FIRST
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass, replace

from derive.errors import TisserandError
from derive.study.sweep.plan import Plan
from derive.study.sweep.worker import Outcome, Sample, failed, run_chunk
from derive.study.worker_process import begin_worker

LOSSES = 2
"""The number of workers that a chunk may lose before it runs alone, and that a single sample may before it fails."""
LARGEST_CHUNK, CHUNKS_PER_WORKER = 100, 8
KILLS = "its worker ended abruptly each time that this sample ran (killed, or out of memory)"
"""The reason of failure of a sample that ends its workers."""


class ExecutorLost(TisserandError):
    """The executor of the caller takes no more work."""


@dataclass(frozen=True)
class _Submission:
    """Runs that are submitted together; losses: the workers that they have lost so far."""

    runs: tuple[Sample, ...]
    losses: int = 0


def chunk_size(runs: int, workers: int) -> int:
    """The number of runs in a chunk: several chunks for each worker, so that all end at about the same time."""
    return max(1, min(LARGEST_CHUNK, -(-runs // (CHUNKS_PER_WORKER * workers))))


def outcomes(
    plan: Plan, runs: Sequence[Sample], executor: Executor | None, workers: int, size: int
) -> Iterator[tuple[Outcome, ...]]:
    """The outcomes of chunks in the order in which they are finished.

    executor: None for `workers` processes of this machine, which are replaced if they are killed. size: the runs of a
    chunk. Raises ExecutorLost, and what `run_chunk` raises.
    """
    pool = _Processes(workers) if executor is None else _Given(executor)
    submissions = [_Submission(tuple(runs[i : i + size])) for i in range(0, len(runs), size)]
    try:
        yield from _completed(plan, deque(submissions), pool)
    finally:
        pool.end()


def _completed(plan: Plan, waiting: deque[_Submission], pool: _Processes | _Given) -> Iterator[tuple[Outcome, ...]]:
    alone: deque[_Submission] = deque()
    running: dict[Future[tuple[Outcome, ...]], _Submission] = {}
    while waiting or alone or running:
        while waiting and len(running) < pool.window:
            submission = waiting.popleft()
            running[pool.submit(plan, submission)] = submission
        if not running:
            submission = alone.popleft()
            running[pool.submit(plan, submission)] = submission
        lost: list[_Submission] = []
        blamed = pool.blames or len(running) == 1
        done = wait(running, return_when=FIRST).done
        if pool.breaks and any(future.exception() for future in done):
            done = wait(running).done  # the end of one worker ends all
        for future in done:
            submission = running.pop(future)
            try:
                results = future.result()
            except _losses() as error:
                pool.check(error)
                lost.append(submission)
            else:
                yield results
        if lost and pool.breaks:
            pool.renew()
        for submission in lost:
            again = replace(submission, losses=submission.losses + 1)
            if len(submission.runs) > 1 and blamed and (pool.blames or again.losses >= LOSSES):
                halves = _halves(submission, 0 if pool.blames else LOSSES - 1)
                (waiting if pool.blames else alone).extend(halves)
            elif again.losses < LOSSES:
                waiting.append(again)
            elif blamed:
                yield (failed(plan.outputs, submission.runs[0], KILLS),)
            else:
                alone.append(again)


def _halves(submission: _Submission, losses: int) -> tuple[_Submission, _Submission]:
    middle = len(submission.runs) // 2
    return _Submission(submission.runs[:middle], losses), _Submission(submission.runs[middle:], losses)


def _losses() -> tuple[type[BaseException], ...]:
    """The exceptions of a chunk whose worker is lost."""
    known: tuple[type[BaseException], ...] = (BrokenExecutor, CancelledError, ConnectionError)
    distributed = sys.modules.get("distributed")
    return (*known, distributed.KilledWorker) if distributed is not None else known


class _Processes:
    """Processes of this machine. window: the number of chunks submitted at a time, so that those which may have ended a
    worker are known; breaks: whether the end of one worker ends all; blames: whether a lost chunk is the cause."""

    breaks, blames = True, False

    def __init__(self, workers: int) -> None:
        self.window = workers
        self._pool = self._new()

    def _new(self) -> ProcessPoolExecutor:
        return ProcessPoolExecutor(self.window, initializer=begin_worker)

    def submit(self, plan: Plan, submission: _Submission) -> Future[tuple[Outcome, ...]]:
        """Run a chunk. A pool that has broken meanwhile is replaced."""
        try:
            return self._pool.submit(run_chunk, plan.chunk(submission.runs))
        except BrokenExecutor:
            self.renew()
            return self._pool.submit(run_chunk, plan.chunk(submission.runs))

    def check(self, error: BaseException) -> None:
        """Accept any error: a broken pool is renewed."""

    def renew(self) -> None:
        """Start new processes in place of broken ones."""
        self.end()
        self._pool = self._new()

    def end(self) -> None:
        """End the processes after their chunks."""
        self._pool.shutdown(wait=False, cancel_futures=True)


class _Given:
    """An executor of the caller, which replaces its workers itself and remains open; it gets all chunks at once."""

    breaks, blames = False, True
    window = sys.maxsize

    def __init__(self, executor: Executor) -> None:
        self._executor = executor
        self._futures: list[Future[tuple[Outcome, ...]]] = []

    def submit(self, plan: Plan, submission: _Submission) -> Future[tuple[Outcome, ...]]:
        """Run a chunk."""
        try:
            future = self._executor.submit(run_chunk, plan.chunk(submission.runs), submission.losses)
        except BrokenExecutor as error:
            self.check(error)
            raise
        self._futures.append(future)
        return future

    def check(self, error: BaseException) -> None:
        """Raise ExecutorLost if the executor as a whole is broken."""
        if isinstance(error, BrokenExecutor | CancelledError):
            raise ExecutorLost(
                "the executor is lost and takes no more work; what is finished is in the store, if there is one: run "
                "the sweep again with resume, and with a new executor or without one"
            ) from error

    def renew(self) -> None:
        """Do nothing: an executor of the caller is not replaced."""

    def end(self) -> None:
        """Cancel the chunks that have not begun."""
        for future in self._futures:
            future.cancel()
