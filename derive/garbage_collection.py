"""A pause of Python's search for unreachable objects, for stages that make many objects and keep them.

The search goes through all objects again and again while their number grows. Of the symbols and expressions of a
derivation nothing is unreachable, so that it finds nothing; with 100 modes it took a quarter of the time.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def paused() -> Iterator[None]:
    """Pause the search for unreachable objects in the block or the decorated function."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            if not gc.get_freeze_count():  # then count what there is as old, or the search would go through it at once
                gc.freeze()
                gc.unfreeze()
            gc.enable()
