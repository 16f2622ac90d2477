"""The error of the deflection of a beam that its axial force buckles for moments.

Where compression takes away all of the stiffness for a while, an error does not ring, it grows. The deflection v in the
lowest mode, of frequency w, has the error e with e'' + w^2 (1 + a) e = -w^2 b v: of the stiffness that the axial force
adds, a is the whole and b the part that the model leaves out, both relative to that in bending. It is integrated along
the rows of a run, with constant coefficients between two of them.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from derive.runtime.native_call import Vector
from derive.simulation.validity.varying_stiffness import responses

BUCKLED = -1.0
"""The whole of the added stiffness at which none is left."""
COARSE = 1.5
"""The largest angle, rad, of the fastest vibration between two rows from which its response is known."""


def buckling_error(t: Vector, whole: Vector, missing: Vector, deflection: Vector, frequency: float) -> float:
    """The root mean square of e over the peak of v + e in rows at t (n,), s; 0 where nothing buckles.

    whole, missing, deflection (n,): a, b and v there. frequency: w, rad/s. It is also 0 where the rows are too coarse.
    """
    if len(t) < 2 or not whole.min() < BUCKLED or not deflection.any():
        return 0.0
    steps, fastest = np.diff(t), frequency * sqrt(1 + float(np.abs(whole).max()))
    if not fastest * float(steps.max()) < COARSE:
        return 0.0
    load, stiffness = -(frequency**2) * missing * deflection, frequency**2 * (1 + whole)
    error = responses(t, stiffness[:, None, None], load[:, None])[:, 0]
    return float(np.sqrt(np.mean(error**2)) / np.abs([deflection, deflection + error]).max())
