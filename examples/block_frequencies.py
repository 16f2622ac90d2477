"""A finite-element body keeps its natural frequencies in the mean frame.

The block of scenes/block.toml is given by node positions, a mass matrix, a stiffness matrix and some modes. Tisserand
brings the modes to the mean frame and makes them orthonormal, which must not change the strain energy. The number is
the largest relative difference between the frequencies of the model and those that SciPy computes from K and M alone.
"""

import sys
from pathlib import Path

import numpy as np
import scipy.sparse
import scipy.sparse.linalg

import derive

BLOCK = Path(__file__).parent.parent / "scenes" / "block.npz"


def finite_element_frequencies(count: int) -> np.ndarray:
    """Return the lowest elastic natural frequencies, rad/s, from the matrices in the file."""
    data = np.load(BLOCK)
    stiffness, mass = (
        scipy.sparse.coo_array((data[f"{name}_value"], (data[f"{name}_row"], data[f"{name}_col"])))
        for name in ("stiffness", "mass")
    )
    mass = scipy.sparse.kron(mass, scipy.sparse.eye_array(3)).tocsc()
    squares = scipy.sparse.linalg.eigsh(stiffness.tocsc(), count + 6, mass, sigma=-1e6, return_eigenvectors=False)
    return np.sqrt(np.sort(squares)[6:])


def main(folder: str | None = None) -> float:
    """Return the largest relative difference of the frequencies."""
    body = derive.modal(derive.nodal_body("block", str(BLOCK), units="SI", modes=8, frame="mean"))
    computed = np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(body.c8, body.stiffness)).real))
    reference = finite_element_frequencies(8)
    print("frequencies, Hz:", ", ".join(f"{f:.1f}" for f in computed / (2 * np.pi)))
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        numbers = np.arange(1, 9)
        axes.bar(numbers - 0.2, reference / (2 * np.pi), 0.4, color="gray", label="finite elements")
        axes.bar(numbers + 0.2, computed / (2 * np.pi), 0.4, label="model in the mean frame")
        axes.set(xlabel="mode", ylabel="natural frequency, Hz")
        axes.legend()
        figure.savefig(Path(folder) / "block_frequencies.svg")
        plt.close(figure)
    return float(np.abs(computed / reference - 1).max())


if __name__ == "__main__":
    main(*sys.argv[1:])
