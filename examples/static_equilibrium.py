"""A static problem by Newton's method with the sparse Jacobian of the generated code.

A cantilever carries a transverse force F at its tip. The residual F(t, y, ydot) of index 3 and its Jacobian contain
coordinates, velocities and multipliers in y; with ydot = 0 they describe equilibrium. The cubic is the exact
deflection of this beam for small loads. The number is the computed tip deflection over F l^3/(3 EI).
"""

import numpy as np
import scipy.sparse.linalg

import derive

FORCE, LENGTH, STIFFNESS = 1e-3, 2.0, 50.0


def main() -> float:
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
                "markers": {"root": -1, "tip": 1},
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
    return float(position[1] / (FORCE * LENGTH**3 / (3 * STIFFNESS)))


if __name__ == "__main__":
    main()
