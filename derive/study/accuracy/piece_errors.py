"""The error of beams in pieces over their difference from beams in fewer pieces.

Displacements of second order leave out what is of third order in the slopes within a piece. These fall with the number
of pieces, and the error with its square, so slowly that two numbers which are near each other differ by less than the
finer one is wrong.
"""

from __future__ import annotations


def error_over_difference(finer: int, coarser: int) -> float:
    """The error of the finer one of two numbers of pieces over their difference.

    It is 1 at least, as the error of few pieces falls faster.
    """
    return max(1.0, coarser**2 / (finer**2 - coarser**2)) if finer > coarser else 1.0
