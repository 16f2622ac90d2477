"""The pause of Python's search for unreachable objects."""

from __future__ import annotations

import subprocess
import sys

SEARCHED = """
import gc
from derive.garbage_collection import paused

sizes = []
gc.set_threshold(700, 10, 10)
gc.callbacks.append(lambda phase, _: sizes.append(len(gc.get_objects(0))) if phase == "start" else None)
with paused():
    kept = [[n] for n in range(100_000)]
later = [[n] for n in range(2_000)]
assert gc.isenabled() and len(kept) + len(later) == 102_000
print(max(sizes))
"""


def test_what_a_pause_made_is_not_searched_at_its_end() -> None:
    """In a process of its own, since a search goes through all that other tests have kept."""
    done = subprocess.run([sys.executable, "-c", SEARCHED], capture_output=True, text=True, check=True)
    assert 0 < int(done.stdout) < 10_000


FROZEN = """
import gc
from derive.garbage_collection import paused

gc.freeze()
frozen = gc.get_freeze_count()
with paused():
    pass
assert gc.get_freeze_count() > 0.9 * frozen > 0
"""


def test_what_others_have_frozen_stays_frozen() -> None:
    subprocess.run([sys.executable, "-c", FROZEN], check=True)
