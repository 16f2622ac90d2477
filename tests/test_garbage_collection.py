"""The pause of Python's search for unreachable objects."""

from __future__ import annotations

import gc
from collections.abc import Iterator

import pytest

from derive.garbage_collection import paused


@pytest.fixture
def searches() -> Iterator[list[int]]:
    """The objects of the youngest generation at the start of each search."""
    sizes: list[int] = []

    def seen(phase: str, _: object) -> None:
        if phase == "start":
            sizes.append(len(gc.get_objects(0)))

    thresholds = gc.get_threshold()  # a library may have raised them
    gc.set_threshold(700, 10, 10)
    gc.collect()  # what earlier tests have left
    gc.callbacks.append(seen)
    yield sizes
    gc.callbacks.remove(seen)
    gc.set_threshold(*thresholds)


def test_what_a_pause_made_is_not_searched_at_its_end(searches: list[int]) -> None:
    with paused():
        kept = [[n] for n in range(100_000)]
    later = [[n] for n in range(2_000)]
    assert gc.isenabled() and len(kept) + len(later) == 102_000
    assert 0 < max(searches) < 10_000


def test_what_others_have_frozen_stays_frozen() -> None:
    gc.freeze()
    try:
        frozen = gc.get_freeze_count()
        with paused():
            pass
        assert gc.get_freeze_count() > 0.9 * frozen > 0
    finally:
        gc.unfreeze()
