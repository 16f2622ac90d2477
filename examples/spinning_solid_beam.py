"""Geometric stiffness: a body of solid elements stiffens under spin, as a beam does.

A slender free beam of solid elements (scenes/solid_beam.toml) spins about its axis e2 and bends in the plane of the
spin. Its file holds geometric stiffness matrices, which many finite-element programs export and order = 2 uses. The
numbers are the lowest natural frequencies in sqrt(EI/(m l^3)) at a spin of 20 and 40 of these units. An inextensible
slender beam has 36.294 and 61.212. With order = 1 the first one is 10.04, and at a spin of 40 the beam is unstable.
"""

import sys
from pathlib import Path

import numpy as np

import derive

BEAM = Path(__file__).parent.parent / "scenes" / "solid_beam.npz"
UNIT = np.sqrt(70e9 * 0.02 * 0.01**3 / 12 / 0.54)  # rad/s
RIGID = 6


def lowest_square(native: derive.Native, spin: float) -> float:
    """Return the square of the lowest frequency at a steady spin about e2, in (EI/(m l^3)); negative if unstable."""
    k, modes = native.setup(), native.nv - RIGID
    v = np.zeros(native.nv)
    v[4] = spin * UNIT

    def accelerations(alpha: np.ndarray) -> np.ndarray:
        """Return the accelerations of the modes at given amplitudes."""
        return native.accel(0.0, np.concatenate([[0, 0, 0, 1, 0, 0, 0], alpha]), v, k)[RIGID:]

    step = 1e-7
    stiffness = np.array([(accelerations(-step * e) - accelerations(step * e)) / (2 * step) for e in np.eye(modes)]).T
    return float(np.linalg.eigvals(stiffness).real.min()) / UNIT**2


def main(folder: str | None = None) -> dict[int, list[float]]:
    """Return the squares of the frequencies by the order of the displacements."""
    result, curves = {}, {}
    spins = np.linspace(0, 45, 46)
    for order in (1, 2):
        body = derive.nodal_body(f"spinning_{order}", str(BEAM), units="SI", order=order)
        native = derive.load(derive.model_files(derive.lower(derive.derive(body)), body))
        result[order] = [lowest_square(native, spin) for spin in (20, 40)]
        curves[order] = np.maximum([lowest_square(native, spin) for spin in spins], 0)
        texts = (f"{np.sqrt(square):.3f}" if square > 0 else "unstable" for square in result[order])
        print(f"order {order}: lowest frequency at spin 20 and 40: {', '.join(texts)}")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        for order, squares in curves.items():
            axes.plot(spins, np.sqrt(squares), label=f"order {order}")
        axes.plot([20, 40], [36.294, 61.212], "o", color="gray", label="inextensible beam")
        axes.set(xlabel="spin, sqrt(EI/(m l^3))", ylabel="lowest frequency, sqrt(EI/(m l^3))")
        axes.legend()
        figure.savefig(Path(folder) / "spinning_solid_beam.svg")
        plt.close(figure)
    return result


if __name__ == "__main__":
    main(*sys.argv[1:])
