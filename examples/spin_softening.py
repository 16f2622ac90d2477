"""First-order equations soften as a body spins, and the amount depends on the frame.

A free beam spins in its plane. In the equations of the paper, (33) and (41), the spin reduces the stiffness of the
assumed modes, because the displacements are linear in the amplitudes (no foreshortening); a real beam stiffens. The
numbers are the spins, in sqrt(EI/(m l^3)), at which the stiffness of a mode is lost: sqrt(720) = 26.83 for the first
mode in both frames; for the second sqrt(8400) = 91.65 in the mean frame, sqrt(8400/6.25) = 36.66 in the point frame.
"""

import numpy as np
import scipy.optimize

import derive


def spins_without_stiffness(frame: object) -> list[float]:
    """Return the spin at which the effective stiffness of each mode vanishes."""
    beam = derive.planar_beam("spinning", frame=frame, mass=1, length=1, bending_stiffness=1)
    native = derive.load(derive.model_files(derive.lower(derive.derive(beam)), beam))
    k = native.setup()

    def acceleration(spin: float, mode: int) -> float:
        """Return the acceleration of a mode with a unit amplitude, linearised about the undeformed state."""
        q, v = np.zeros(5), np.zeros(5)
        q[3 + mode], v[2] = 1e-6, spin
        return float(native.accel(0.0, q, v, k)[3 + mode]) / 1e-6

    return [scipy.optimize.brentq(acceleration, 1, 200, args=(mode,), xtol=1e-10) for mode in (0, 1)]


def main() -> dict[str, list[float]]:
    """Return the spins without stiffness of both modes by frame."""
    result = {
        "mean": spins_without_stiffness("mean"),
        "point": spins_without_stiffness({"kind": "point", "at": 0}),
    }
    for frame, (first, second) in result.items():
        print(f"{frame} frame: the stiffness is lost at {first:.4f} (mode 1) and {second:.4f} (mode 2)")
    return result


if __name__ == "__main__":
    main()
