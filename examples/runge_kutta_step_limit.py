"""Explicit integration limits the step.

The Runge-Kutta method of order 4 is stable on a vibration of angular frequency w up to a step of 2 sqrt(2)/w. The
highest frequency of a free beam with two assumed modes is 91.65 sqrt(EI/(m l^3)). The script integrates the model with
steps just below and just above the limit. The numbers are the largest amplitudes, relative to the initial one, after
400 steps of 0.95 and of 1.05 times the limit: the first decays, the second grows without bound.
"""

import sys
from pathlib import Path

import numpy as np

import derive

LIMIT = 2 * np.sqrt(2) / np.sqrt(8400)


def amplitudes(native: derive.Native, step: float) -> list[float]:
    """Return |alpha2| after each of 400 steps, relative to the initial value."""
    k = native.setup()

    def rate(y: np.ndarray) -> np.ndarray:
        return np.concatenate([native.rates(y[:5], y[5:], k), native.accel(0.0, y[:5], y[5:], k)])

    y = np.zeros(10)
    y[4] = 1e-3
    result = []
    for _ in range(400):
        a = rate(y)
        b = rate(y + step / 2 * a)
        c = rate(y + step / 2 * b)
        d = rate(y + step * c)
        y = y + step / 6 * (a + 2 * b + 2 * c + d)
        result.append(float(abs(y[4]) / 1e-3))
    return result


def main(folder: str | None = None) -> tuple[float, float]:
    """Return the relative amplitudes below and above the limit."""
    beam = derive.planar_beam("step_limit", mass=1, length=1, bending_stiffness=1)
    native = derive.load(derive.model_files(derive.lower(derive.derive(beam)), beam))
    below, above = (amplitudes(native, factor * LIMIT) for factor in (0.95, 1.05))
    print(f"step limit {LIMIT:.5f} s; amplitude after 400 steps:", end=" ")
    print(f"{below[-1]:.2g} at 0.95, {above[-1]:.2g} at 1.05 of the limit")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        axes.semilogy(below, label="0.95 of the limit")
        axes.semilogy(above, label="1.05 of the limit")
        axes.set(xlabel="step", ylabel="amplitude, of the initial one")
        axes.legend()
        figure.savefig(Path(folder) / "runge_kutta_step_limit.svg")
        plt.close(figure)
    return below[-1], above[-1]


if __name__ == "__main__":
    main(*sys.argv[1:])
