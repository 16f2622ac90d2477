"""A static problem by Newton's method with the sparse Jacobian of the generated code.

A cantilever carries a transverse force F at its tip. The residual F(t, y, ydot) of index 3 and its Jacobian contain
coordinates, velocities and multipliers in y; with ydot = 0 they describe equilibrium. The cubic is the exact
deflection of this beam for small loads. The number is the computed tip deflection over F l^3/(3 EI).
"""

import sys
from pathlib import Path

import numpy as np
import scipy.sparse.linalg

import derive

FORCE, LENGTH, STIFFNESS = 1e-3, 2.0, 50.0
NAMES = ("root", "quarter", "middle", "threequarters", "tip")


def main(folder: str | None = None) -> float:
    """Return the tip deflection over its exact value."""
    scene = derive.scene(
        "static_equilibrium",
        ground={"wall": [0, 0]},
        bodies={
            "beam": {
                "frame": "mean",
                "mass": 1,
                "length": LENGTH,
                "bending_stiffness": STIFFNESS,
                "markers": dict(zip(NAMES, np.linspace(-1, 1, len(NAMES)), strict=True)),
                "start": {"position": [LENGTH / 2, 0]},
            }
        },
        joints={"clamp": {"kind": "weld", "between": ["ground.wall", "beam.root"]}},
        forces={"load": {"at": "beam.tip", "components": [0, FORCE]}},
    )
    native = derive.load(derive.model_files(derive.lower(derive.derive(scene)), scene))
    k = native.setup()
    y = np.zeros(native.nq + native.nv + native.nlambda)
    y[0] = LENGTH / 2
    for iteration in range(6):
        residual = native.residual(0.0, y, np.zeros_like(y), k)
        print(f"iteration {iteration}: residual {np.abs(residual).max():.1e}")
        values = native.jacobian(0.0, y, np.zeros_like(y), 0.0, k)
        jacobian = native.jacobian_pattern.sparse(values)
        y -= scipy.sparse.linalg.spsolve(jacobian, residual)
    position, _, _ = native.marker("beam_tip", y[: native.nq], np.zeros(native.nv), k)
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        x = np.linspace(0, LENGTH, 50)
        markers = np.array([native.marker(f"beam_{name}", y[: native.nq], np.zeros(native.nv), k)[0] for name in NAMES])
        axes.plot(x, 1e6 * FORCE * x**2 * (3 * LENGTH - x) / (6 * STIFFNESS), color="gray", label="exact deflection")
        axes.plot(markers[:, 0], 1e6 * markers[:, 1], "o", label="computed")
        axes.set(xlabel="distance from the wall, m", ylabel="deflection, micrometres")
        axes.legend()
        figure.savefig(Path(folder) / "static_equilibrium.svg")
        plt.close(figure)
    return float(position[1] / (FORCE * LENGTH**3 / (3 * STIFFNESS)))


if __name__ == "__main__":
    main(*sys.argv[1:])
