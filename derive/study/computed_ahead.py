"""Results that are computed in processes of their own before they are needed.

A study derives and compiles many models, and knows in advance which ones it is likely to need. Processes that are
forked from it prepare these while it runs the ones before; what it does with them, and in which order, does not depend
on the processes, so that the results are those of a single process.

Results are large: Python's search for unreachable objects pauses while they are made, and while they are written and
read as bytes. It took a fifth of the time of a ladder, up to nine tenths of the time to read a result.
"""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import sys
from collections.abc import Callable, Hashable, Iterable
from concurrent.futures import BrokenExecutor, CancelledError, Future, ProcessPoolExecutor, wait
from typing import Any, Generic, TypeVar

from derive.garbage_collection import paused
from derive.kept_objects import dumped
from derive.study.worker_process import begin_worker

Key = TypeVar("Key", bound=Hashable)
Result = TypeVar("Result")

MOST = 4
"""The largest number of processes: each takes the memory of a derivation."""


def processors() -> int:
    """The number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def available_workers() -> int:
    """The number of processes for this machine: 0 with one processor, and where processes cannot be forked safely."""
    count = min(MOST, processors())
    return count if count > 1 and sys.platform == "linux" else 0


class ComputedAhead(Generic[Key, Result]):
    """The results of a function by its argument, computed in processes from the moment that they are expected.

    function: from the argument to the result, both of which can be pickled; it is forked with all that it refers to.
    workers: the number of processes, which begin with the first expected argument; with 0 all is computed when it is
    asked for. load: loads the modules that the function needs, before the processes are forked. To be closed, as a
    context.
    """

    def __init__(
        self, function: Callable[[Key], Result], workers: int = 0, load: Callable[[], None] = lambda: None
    ) -> None:
        self._function, self.workers, self._load = function, workers, load
        self._pool: ProcessPoolExecutor | None = None
        self._processes: set[Any] = set()
        self._expected: dict[Key, Future[bytes | None]] = {}

    def __enter__(self) -> ComputedAhead[Key, Result]:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def waiting(self) -> int:
        """The number of expected results that nobody has asked for yet."""
        return len(self._expected)

    def expect(self, keys: Iterable[Key]) -> None:
        """Compute the results for these arguments, in this order, after those that are expected already."""
        for key in keys:
            if self.workers and key not in self._expected:
                try:
                    self._expected[key] = self._submit(key)
                except BrokenExecutor:  # a worker has been killed
                    self.close()

    @paused()
    def result(self, key: Key) -> Result:
        """The result for an argument, once. Raises what the function raises."""
        future = self._expected.pop(key, None)
        if future is not None:
            try:
                written = future.result()
            except (BrokenExecutor, CancelledError):
                written = None
            if written is not None:
                result: Result = pickle.loads(written)
                return result
        return self._function(key)  # it has not been expected, or it raises here what it has raised there

    def wait(self) -> None:
        """Wait until no process computes, so that a measurement is not disturbed; what has not begun is forgotten."""
        for key, future in list(self._expected.items()):
            if future.cancel():
                del self._expected[key]
        wait(self._expected.values())

    def close(self) -> None:
        """End the processes, whatever they compute. Later results are computed when they are asked for."""
        self.workers = 0
        if self._pool is not None:
            self._expected = {key: future for key, future in self._expected.items() if future.done()}
            self._pool.shutdown(wait=False, cancel_futures=True)
            for process in self._processes:
                process.terminate()
            self._pool = None

    def _submit(self, key: Key) -> Future[bytes | None]:
        if self._pool is None:
            self._load()
            before = set(multiprocessing.active_children())
            context = multiprocessing.get_context("fork")
            self._pool = ProcessPoolExecutor(self.workers, context, _begin, (self._function,))
            future: Future[bytes | None] = self._pool.submit(_computed, key)
            self._processes = set(multiprocessing.active_children()) - before
            return future
        return self._pool.submit(_computed, key)


_functions: list[Callable[[Any], Any]] = []
"""In a worker, the function that it computes."""


def _begin(function: Callable[[Any], Any]) -> None:
    """Begin a worker that computes this function. It ends orderly, so that its temporary folders are removed."""
    _functions.append(function)
    begin_worker()
    signal.signal(signal.SIGINT, _end)
    signal.signal(signal.SIGTERM, _end)


def _end(*_: object) -> None:
    raise SystemExit(1)


@paused()
def _computed(key: Any) -> bytes | None:
    """The result in a worker, as bytes; None if it has failed, or the worker is to end."""
    try:
        return dumped(_functions[0](key))
    except Exception:
        return None
    except SystemExit:  # the executor would send it to the parent, and go on
        os._exit(1)
