"""The note of a run on constraints that depend on each other: which they are, and which outputs are not unique."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from derive.enumerations import enumeration
from derive.ir.model import Variable
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.constraints.certificates import independent
from derive.simulation.constraints.redundancy import dependence
from derive.simulation.constraints.scaling import SINGULAR, Spectrum, spectrum
from derive.simulation.errors import RedundantConstraints

UNIQUE = 1e-6
"""An output is unique if reactions that balance each other change it by less than this part of their sizes."""


def dependence_note(native: NativeScene, k: Vector, t: float, q: Vector, v: Vector, outputs: Sequence[Variable]) -> str:
    """The text on the constraints that depend on each other in the state q (nq,), v (nv,) at t (s); empty if none do.

    outputs: those that the user knows, the first ones of the model.
    """
    if not native.proximal or independent(native, k, t, q):
        return ""
    error = dependence(native, k, t, q)
    if error is None:
        return ""
    singular = spectrum(native, k, t, q)
    shares = singular.participation()
    reactions = enumeration([name for name, share in zip(native.multipliers, shares, strict=True) if share > 1e-5])
    if isinstance(error, RedundantConstraints):
        implied = "; ".join(map(str, error.redundant))
        where = f"joints are redundant: {implied}. The motion is unique"
    else:
        where = f"the joints are in a singular position at t = {t:g} s. The motion goes on along its velocities"
    names = list(_ambiguous(native, k, t, q, v, singular, outputs))
    also = f"; the outputs {enumeration(names)} follow from them" if names else ""
    return f"{where}; the reactions {reactions} are not, and those of least norm are computed{also}"


def _ambiguous(
    native: NativeScene, k: Vector, t: float, q: Vector, v: Vector, singular: Spectrum, outputs: Sequence[Variable]
) -> Iterator[str]:
    """The names of outputs that change with reactions that balance each other."""
    if not outputs:
        return
    left = singular.left[:, singular.values <= SINGULAR]
    balanced = (left / singular.norms[:, None]) @ np.random.default_rng(0).uniform(0.5, 1.0, left.shape[1])
    vdot, lam = native.solve(t, q, v, k)
    balanced *= max(1.0, float(np.max(np.abs(lam)))) / float(np.max(np.abs(balanced)))
    before = native.evaluate_outputs(t, q, v, vdot, lam, k)
    after = native.evaluate_outputs(t, q, v, vdot, lam + balanced, k)
    for variable, change in zip(outputs, np.abs(after - before), strict=False):
        if change > UNIQUE * float(np.max(np.abs(balanced))):
            yield variable.title
