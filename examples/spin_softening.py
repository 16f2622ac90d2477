"""First-order equations soften as a body spins, and the amount depends on the frame.

A free beam spins in its plane. In the equations of the paper, (33) and (41), the spin reduces the stiffness of the
assumed modes, because the displacements are linear in the amplitudes (no foreshortening); a real beam stiffens. The
numbers are the spins, in sqrt(EI/(m l^3)), at which the stiffness of a mode is lost: sqrt(720) = 26.83 for the first
mode in both frames; for the second sqrt(8400) = 91.65 in the mean frame, sqrt(8400/6.25) = 36.66 in the point frame.
"""

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import scipy.optimize

import derive


def stiffness(frame: object) -> Callable[[float, int], float]:
    """Return the effective stiffness of a mode, over its mass, as a function of the spin and the mode."""
    beam = derive.planar_beam("spinning", frame=frame, mass=1, length=1, bending_stiffness=1)
    native = derive.load(derive.model_files(derive.lower(derive.derive(beam)), beam))
    k = native.setup()

    def of_mode(spin: float, mode: int) -> float:
        """Return minus the acceleration of a mode with a unit amplitude, linearised about the undeformed state."""
        q, v = np.zeros(5), np.zeros(5)
        q[3 + mode], v[2] = 1e-6, spin
        return -float(native.accel(0.0, q, v, k)[3 + mode]) / 1e-6

    return of_mode


def main(folder: str | None = None) -> dict[str, list[float]]:
    """Return the spins without stiffness of both modes by frame."""
    models = {"mean": stiffness("mean"), "point": stiffness({"kind": "point", "at": 0})}
    result = {
        name: [scipy.optimize.brentq(model, 1, 200, args=(mode,), xtol=1e-10) for mode in (0, 1)]
        for name, model in models.items()
    }
    for frame, (first, second) in result.items():
        print(f"{frame} frame: the stiffness is lost at {first:.4f} (mode 1) and {second:.4f} (mode 2)")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        spins = np.linspace(0, 1.05 * result["mean"][1], 101)
        for (name, model), line in zip(models.items(), ("-", "--"), strict=True):
            for mode in (0, 1):
                ratio = [model(spin, mode) / model(0, mode) for spin in spins]
                axes.plot(spins, ratio, line, label=f"{name} frame, mode {mode + 1}")
        axes.axhline(0, color="gray")
        axes.set(xlabel="spin, sqrt(EI/(m l^3))", ylabel="stiffness, of that at rest", ylim=(-1, 1.05))
        axes.legend()
        figure.savefig(Path(folder) / "spin_softening.svg")
        plt.close(figure)
    return result


if __name__ == "__main__":
    main(*sys.argv[1:])
