"""The axes of a frame in space, by which components are numbered."""

from __future__ import annotations

from itertools import combinations_with_replacement

AXES = (1, 2, 3)
"""The axes of a frame in space."""
SPACE = len(AXES)
"""The number of dimensions of space."""
PAIRS = tuple(combinations_with_replacement(AXES, 2))
"""Index pairs of a symmetric tensor: 11, 12, 13, 22, 23, 33."""
