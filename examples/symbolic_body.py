"""One compiled model for every body with the same number of modes.

The shape integrals of the model are parameters here, so that the code is generated and compiled once. The script
computes the integrals of the block of scenes/block.toml, hands them to this model as parameters, and evaluates the
angular acceleration of the undeformed block. It equals that of Euler's equations for a rigid block. The number is the
largest relative difference.
"""

from pathlib import Path

import numpy as np

import derive

BLOCK = Path(__file__).parent.parent / "scenes" / "block.npz"
MODES = 4


def main() -> float:
    """Return the largest relative difference to Euler's equations."""
    any_body = derive.symbolic_body("any_body", modes=MODES)
    native = derive.load(derive.model_files(derive.lower(derive.derive(any_body)), any_body))
    block = derive.modal(derive.nodal_body("block", str(BLOCK), units="SI", modes=MODES))
    k = native.setup(derive.parameters(block, any_body))
    omega = np.array([1.0, 2.0, 3.0])
    q = np.concatenate([[0, 0, 0, 1, 0, 0, 0], np.zeros(MODES)])
    v = np.concatenate([[0, 0, 0], omega, np.zeros(MODES)])
    computed = native.accel(0.0, q, v, k)[3:6]
    a, b, c = 0.4, 0.1, 0.06  # m
    inertia = 2700 * a * b * c / 12 * np.array([b**2 + c**2, a**2 + c**2, a**2 + b**2])
    euler = -np.cross(omega, inertia * omega) / inertia
    print("angular acceleration, rad/s^2:", computed, "Euler's equations:", euler)
    return float(np.abs(computed / euler - 1).max())


if __name__ == "__main__":
    main()
