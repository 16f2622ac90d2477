"""The ringing of multipliers and its decay under the generalised-alpha method, on a rigid crank-slider.

A rigid mechanism has no vibrations, so that an alternation from step to step is an error of the method. On a form
of index 3 the error of the multipliers after n steps is proportional to a power of n times rho^n (Cardona & Geradin
1989; Arnold & Bruels 2007): it decays unless rho = 1, as in the trapezoidal rule, where it grows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bench.method_failures.small_scenes import crank_slider
from derive.runtime.native_call import Vector
from derive.study.methods.formulations import alternation
from derive.study.methods.scene_methods import method_scene

RHOS = (1.0, 0.9, 0.8, 0.5)
"""The spectral radii at infinite frequency."""
STEP, STEPS, ORDER = 0.02, 160, 6
"""The step (rad of the crank), the number of steps, and the order of the differences that leave the alternation."""
FIRST = 6
"""The number of steps after which the ringing has the form c n^p rho^n."""
ROUNDING = 1e-8
"""Ringing below this, relative to the multipliers, is a rounding error of the differences, or motion."""


@dataclass(frozen=True, eq=False)
class Ringing:
    """The ringing of multipliers with one rho: its amplitude (n,) in the rows after each step, over the largest
    multiplier, and the factor per step that it decays by."""

    rho: float
    amplitude: Vector
    factor: float


def ringing() -> tuple[Ringing, ...]:
    """The ringing for each of `RHOS`. Raises LibraryMissing, CompilerError."""
    of = method_scene(crank_slider())
    result = []
    for rho in RHOS:
        assert of.alpha is not None
        lam = of.alpha.run(of.q, of.v, step=STEP, steps=STEPS, rho=rho).lam
        amplitude = alternation(lam, ORDER) / np.abs(lam).max()
        result.append(Ringing(rho, amplitude, decay(amplitude)))
    return tuple(result)


def decay(amplitude: Vector) -> float:
    """The factor rho of the best fit of c n^p rho^n to the part of an amplitude (n,) above rounding errors."""
    n = np.arange(1, len(amplitude) + 1)
    good = (amplitude > ROUNDING) & (n > FIRST)
    terms = np.column_stack([np.ones(good.sum()), np.log(n[good]), n[good]])
    return float(np.exp(np.linalg.lstsq(terms, np.log(amplitude[good]), rcond=None)[0][2]))
