"""Natural frequencies and modes of a cantilever, and its response to a force at the tip.

A weld clamps a beam whose shapes are the polynomials up to degree 7. `derive.modes` linearises the scene about its
equilibrium. The exact first frequency is (beta l)^2 sqrt(EI/(m l^3)) with cos(beta l) cosh(beta l) = -1, and
beta l = 1.8751041. The static gain D - C A^-1 B from a force to the deflection of the tip is l^3/(3 EI). The numbers
are the computed beta l, and the gain over the exact one.
"""

import sys
from pathlib import Path

import numpy as np

import derive


def main(folder: str | None = None) -> tuple[float, float]:
    """Return beta l of the first mode, and the static gain over the exact one."""
    scene = derive.scene(
        "cantilever_modes",
        ground={"wall": [0, 0]},
        bodies={
            "beam": {
                "ansatz": [f"xi^{n}" for n in range(8)],
                "frame": "mean",
                "mass": 3,
                "length": 2,
                "bending_stiffness": 50,
                "markers": {"root": -1, "tip": 1},
                "start": {"position": [1, 0]},
            }
        },
        joints={"clamp": {"kind": "weld", "between": ["ground.wall", "beam.root"]}},
    )
    found = derive.modes(scene)
    linear = found.linear
    beta = np.sqrt(2 * np.pi * found.frequencies[0] * np.sqrt(3 * 2**3 / 50))
    force, deflection = linear.inputs.index("beam_tip_F2"), linear.outputs.index("beam_tip_x2")
    gain = (linear.D - linear.C @ np.linalg.solve(linear.A, linear.B))[deflection, force]
    for number, mode in enumerate(found.modes[:3], 1):
        print(f"mode {number}: {mode.frequency:.4f} Hz")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        xi = np.linspace(-1, 1, 101)
        for number, mode in enumerate(found.modes[:3], 1):
            shape = np.polynomial.legendre.legval(xi, mode.shape[1:].real)  # c2, l phi/2 with l/2 = 1 m, alpha
            axes.plot(1 + xi, shape / shape[-1], label=f"mode {number}, {mode.frequency:.3f} Hz")
        axes.set(xlabel="distance from the wall, m", ylabel="deflection, of that of the tip")
        axes.legend()
        figure.savefig(Path(folder) / "cantilever_modes.svg")
        plt.close(figure)
    return float(beta), float(gain / (2**3 / (3 * 50)))


if __name__ == "__main__":
    main(*sys.argv[1:])
