"""The angular momentum of a free beam that spins and vibrates, under the trapezoidal and the midpoint rule.

In the mean frame L = phidot (C3 + c8 a^2), which no linear method conserves for a beam that bends. The trapezoidal rule
is the midpoint rule for z = y + h/2 ydot, which nearly conserves L(z): with a = A cos(omega t) and a small spin the
drift of L is (omega h)^2 / 4 times c8 A^2 / C3, and c8 / C3 = 12/5 1/l^2 for the shape P2.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from bench.method_failures.small_scenes import bent_beam
from derive.generated_models import generated
from derive.runtime.compiler import RUN_FLAGS
from derive.runtime.loading import load_scene
from derive.study.methods.implicit_steps import Rule, initial_values, march
from derive.study.states import start_state

PRODUCTS = (1.0, 3.0, 10.0)
"""The steps times the first natural frequency."""
STEPS = 200
FIRST = sqrt(720.0)
"""The first natural frequency of a beam with the shape P2 and m = l = EI = 1, rad/s."""
AMPLITUDE = 2 / 3 * 0.29
"""The amplitude of P2, over the length, of the initial deflection 0.29 xi^2 less its mean."""


@dataclass(frozen=True)
class MomentumDrift:
    """The largest change of the angular momentum over its initial value, with steps of `product` over the first natural
    frequency. small: the theory of the trapezoidal rule, for small steps."""

    rule: Rule
    product: float
    drift: float

    @property
    def small(self) -> float:
        """The drift of the trapezoidal rule to second order in the step and the amplitude."""
        return 12 / 5 * AMPLITUDE**2 * self.product**2 / 4


def momentum_drifts() -> tuple[MomentumDrift, ...]:
    """The drift for each rule and step. Raises CompilerError, StepFailed."""
    scene = bent_beam()
    native = load_scene(generated(scene)[1], RUN_FLAGS)
    k = native.setup()
    _, q, v = start_state(scene, native, k)
    form = native.dae["index3"]
    y, ydot = initial_values(native, form, k, 0.0, q, v)
    result = []
    for rule in (Rule.TRAPEZOIDAL, Rule.MIDPOINT):
        for product in PRODUCTS:
            run = march(form, k, 0.0, y, ydot, product / FIRST, STEPS, rule, native.nq, native.nv)
            n, m = native.nq, native.nq + native.nv
            momenta = np.array([native.momentum(row[:n], row[n:m], k)[2] for row in run.y])
            result.append(MomentumDrift(rule, product, float(np.abs(momenta / momenta[0] - 1).max())))
    return tuple(result)
