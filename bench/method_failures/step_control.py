"""The control of explicit steps: the error estimate of a fast vibration beside its error, at every phase of it.

A step of ydot = i omega y multiplies y by the stability function R(i omega h) instead of exp(i omega h). The
generalised velocity of a mode is the real part of y, and the estimate of its error is that of another complex number.
If it is of a single order it vanishes twice per period, whatever the error is, so that the method takes a step that is
too long, even one that is unstable.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import DOP853

from derive.runtime.integrators.dormand_prince import interpolant_error
from derive.runtime.native_call import Vector
from derive.simulation.integration.dormand_prince import DormandPrince

PRODUCTS = (3.0, 4.0, 5.0, 5.96, 7.0)
"""The steps times the frequency: from vibrations that are hardly resolved to steps beyond the limit of stability."""
PHASES = np.linspace(0.0, np.pi, 60, endpoint=False)
"""The phases of the vibration at the begin of the step, rad; half a period is enough."""
PARTS = np.linspace(0.0, 1.0, 51)
"""The parts of a step at which its interpolant is evaluated."""
OMEGA, SMALL = 1e4, 1e-3
"""The frequency, rad/s, and the amplitude of the velocity; the tolerance is 1, so that every step is accepted."""
ROOT = np.sqrt(2.0)
"""Estimates are root mean squares over the two elements of the state, of which the velocity alone counts."""


@dataclass(frozen=True)
class StepControl:
    """A step of the adaptive method in a vibration, with `product` = omega h; errors are at the worst phase.

    classical, own: the error of the step over the estimate of it, by DOP853 in SciPy, and by `adaptive` and `dop853`.
    interpolated, row: the largest error of the velocity within the step over the estimate of the step, by the
    interpolant, and that of a row, which is interpolated only if the estimate for the interpolant allows it.
    """

    product: float
    classical: float
    own: float
    interpolated: float
    row: float


def step_controls() -> tuple[StepControl, ...]:
    """The estimates for each of `PRODUCTS`. Raises CompilerError."""
    worst = [np.max([_ratios(product, phase) for phase in PHASES], axis=0) for product in PRODUCTS]
    return tuple(StepControl(product, *map(float, w)) for product, w in zip(PRODUCTS, worst, strict=True))


def _ratios(product: float, phase: float) -> tuple[float, float, float, float]:
    """The numbers of a `StepControl` at one phase."""
    h, allowed = product / OMEGA, np.ones(2)
    solver = DormandPrince(_vibration, 0.0, _exact(phase)[0], h, first_step=h, rtol=1e-13, atol=1.0)
    solver.step()
    interpolant = solver.dense_output()
    errors = interpolant(PARTS * h).T - _exact(phase + PARTS * product)
    end = np.hypot(OMEGA * errors[-1, 0], errors[-1, 1])  # of the vibration, which continues
    within = np.abs(errors).max()  # of a row
    classical = DOP853._estimate_error_norm(solver, solver.K, h, allowed)
    own = solver._estimate_error_norm(solver.K, h, allowed)
    checked = max(own, interpolant_error(interpolant.F, allowed))
    return end / classical / ROOT, end / own / ROOT, within / own / ROOT, within / checked / ROOT


def _vibration(t: float, y: Vector) -> Vector:
    return np.array([y[1], -(OMEGA**2) * y[0]])


def _exact(angles: Vector | float) -> Vector:
    """The exact states [q, v] (n, 2) at angles omega t."""
    angles = np.atleast_1d(angles)
    return SMALL * np.column_stack([np.sin(angles) / OMEGA, np.cos(angles)])
