"""The error of fixed steps, measured by a run with other steps: the note on steps that are too coarse."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from derive.percentages import percent
from derive.roles import Role
from derive.runtime.native_call import Matrix
from derive.simulation.compiled_scene import ConstrainedSystem, coordinates_with
from derive.simulation.errors import SimulationError

ALLOWED = 1e-3
"""The largest error of a coordinate without a note, relative to the largest change of all coordinates of its kind."""
ROUNDING = 1e-9
"""Changes of coordinates (m, rad) below this are no motion: they come from Newton's method and projections."""

KINDS = {
    "displacement of a body": (Role.TRANSLATION, Role.DISPLACEMENT),
    "change of an orientation": (Role.ROTATION, Role.QUATERNION),
    "change of a deformation": (Role.AMPLITUDE,),
}
"""The kinds of coordinates whose changes are compared, by the words for them."""


def step_notes(
    native: ConstrainedSystem, q: Matrix, step: float, other_runs: Callable[[int], tuple[Matrix, float]]
) -> Iterator[str]:
    """The note on a step (s) of a method of order 2 that is too coarse, if it is.

    q: the coordinates (n, nq) of the run. other_runs: those with half of the steps (1) or with twice as many (-1), and
    the ratio of their step to that of the run. Half of the steps take half of the time; twice as many are for runs
    that are so coarse that no other ones are possible.
    """
    for way in (1, -1):
        try:
            other, ratio = other_runs(way)
        except SimulationError:
            continue  # Newton's method does not converge
        if ratio != 1.0:
            break
    else:
        return
    error = np.abs(other - q).max(axis=0) / abs(ratio**2 - 1)
    change = np.abs(q - q[0]).max(axis=0)
    worst, where, of = 0.0, 0, ""
    for kind, roles in KINDS.items():
        mask = coordinates_with(native, *roles)
        if not mask.any() or (scale := float(change[mask].max())) < ROUNDING:
            continue
        at = int(np.argmax(np.where(mask, error, -1.0)))
        if error[at] > worst * scale:
            worst, where, of = float(error[at]) / scale, at, kind
    if worst > ALLOWED:
        shorter = step * (ALLOWED / worst) ** 0.5
        fewer = "half" if ratio > 1 else "twice"
        yield (
            f"step: {step:.6g} s is too coarse: {native.coordinates[where]} is wrong by about {percent(worst)} of the "
            f"largest {of}, as a run with {fewer} the steps shows; --step {shorter:.2g} (in Python step=...) makes "
            f"it about {percent(ALLOWED)}"
        )
