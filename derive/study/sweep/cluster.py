"""Sweeps across machines: the workers of a Dask scheduler as an executor."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from importlib import import_module

from derive.errors import TisserandError

SECONDS = 20
"""The time in which a scheduler must answer."""


class DistributedMissing(TisserandError):
    """The package `distributed` is not installed."""


class NoScheduler(TisserandError):
    """There is no Dask scheduler at an address, or it has no workers."""


@contextmanager
def dask_executor(address: str) -> Iterator[tuple[Executor, int]]:
    """The executor of the Dask scheduler at an address such as tcp://10.0.0.1:8786, and the threads of its workers.

    The workers need this package in the same version, on machines of the kind of this one, whose compiled code they
    load. Raises DistributedMissing, NoScheduler.
    """
    try:
        distributed = import_module("distributed")
    except ImportError:
        raise DistributedMissing(
            "--scheduler needs the package distributed: pip install 'tisserand[distributed]'"
        ) from None
    try:
        client = distributed.Client(address, timeout=SECONDS)
    except (OSError, ValueError) as error:
        raise NoScheduler(f"{address}: no Dask scheduler answers: {error or type(error).__name__}") from None
    with client:
        threads = sum(client.nthreads().values())
        if not threads:
            raise NoScheduler(f"{address}: the scheduler has no workers; start some with `dask worker {address}`")
        yield client.get_executor(pure=False), threads
