"""Natural frequencies of a free beam by the Ritz method.

The assumed modes are the Legendre polynomials P2 to P7, which satisfy the mean-displacement conditions of the floating
frame. At rest, K alpha = omega^2 c8 alpha; both matrices are read from the generated functions. The exact frequencies
solve cos(x) cosh(x) = 1. The number is the relative error of the second elastic frequency, 61.6728 sqrt(EI/(m l^3)).
"""

import sys
from pathlib import Path

import numpy as np
import scipy.linalg
import scipy.optimize

import derive


def main(folder: str | None = None) -> float:
    """Return the relative error of the second natural frequency."""
    ansatz = [f"xi^{n}" for n in range(8)]
    beam = derive.planar_beam("ritz_beam", ansatz=ansatz, frame="mean", mass=1, length=1, bending_stiffness=1)
    model = derive.lower(derive.derive(beam))
    native = derive.load(derive.model_files(model, beam))
    k = native.setup()
    elastic = slice(3, native.nv)

    def force(alpha: np.ndarray) -> np.ndarray:
        """Return h at rest; it is K alpha."""
        q = np.concatenate([np.zeros(3), alpha])
        return native.force(0.0, q, np.zeros(native.nv), k)[elastic]

    stiffness = np.column_stack([force(unit) for unit in np.eye(native.nv - 3)])
    mass = np.zeros((native.nv, native.nv))
    for (row, column), value in zip(native.mass_pattern.entries, native.mass(np.zeros(native.nq), k), strict=True):
        mass[row, column] = mass[column, row] = value
    squares = scipy.linalg.eigh(stiffness, mass[elastic, elastic], eigvals_only=True)
    ends = np.array([4, 5]) + np.pi * np.arange(4)[:, None]  # around the first four roots
    all_exact = np.array([scipy.optimize.brentq(lambda x: np.cos(x) - 1 / np.cosh(x), *pair) ** 2 for pair in ends])
    exact = all_exact[:2]
    computed = np.sqrt(squares[:2])
    print(f"computed {computed[0]:.4f} and {computed[1]:.4f}, exact {exact[0]:.4f} and {exact[1]:.4f} sqrt(EI/(m l^3))")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        names = [f"mode {number}" for number in range(1, len(all_exact) + 1)]
        axes.bar(names, 100 * (np.sqrt(squares[: len(all_exact)]) / all_exact - 1), width=0.5)
        axes.set(ylabel="error of the frequency, %", yscale="log")
        figure.savefig(Path(folder) / "free_beam_frequencies.svg")
        plt.close(figure)
    return float(computed[1] / exact[1] - 1)


if __name__ == "__main__":
    main(*sys.argv[1:])
