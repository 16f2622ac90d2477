"""A free block that spins about its intermediate axis flips periodically.

The block of scenes/block.toml without modes is a rigid body. Euler's equations have a solution in elliptic functions,
so that the time between two flips is known: half the period 4 K(k)/p of the angular velocity about the intermediate
axis. The number is this time, measured in a simulation with the generated code, over its closed form.
"""

import sys
from pathlib import Path

import numpy as np
import scipy.integrate
import scipy.special

import derive

BLOCK = Path(__file__).parent.parent / "scenes" / "block.npz"
SPIN = np.array([0.1, 20.0, 0.1])  # rad/s, about the axes of the least, the intermediate and the largest moment


def closed_form() -> float:
    """Return the time between flips by Jacobi's elliptic functions, from the dimensions of the block."""
    a, b, c = 0.4, 0.1, 0.06  # m
    least, intermediate, largest = 2700 * a * b * c / 12 * np.array([b**2 + c**2, a**2 + c**2, a**2 + b**2])
    energy = least * SPIN[0] ** 2 + intermediate * SPIN[1] ** 2 + largest * SPIN[2] ** 2  # doubled
    momentum = (least * SPIN[0]) ** 2 + (intermediate * SPIN[1]) ** 2 + (largest * SPIN[2]) ** 2  # squared
    if momentum < energy * intermediate:
        least, largest = largest, least
    p = np.sqrt((largest - intermediate) * (momentum - energy * least) / (least * intermediate * largest))
    m = (intermediate - least) * (energy * largest - momentum)
    m /= (largest - intermediate) * (momentum - energy * least)
    return float(2 * scipy.special.ellipk(m) / p)


def main(folder: str | None = None) -> float:
    """Return the simulated time between flips over the closed form."""
    body = derive.nodal_body("rigid_block", str(BLOCK), units="SI", modes=0)
    native = derive.load(derive.model_files(derive.lower(derive.derive(body)), body))
    k = native.setup()

    def rate(_: float, y: np.ndarray) -> np.ndarray:
        return np.concatenate([native.rates(y[:7], y[7:], k), native.accel(0.0, y[:7], y[7:], k)])

    def flip(_: float, y: np.ndarray) -> float:
        return float(y[11])

    y = np.concatenate([[0, 0, 0, 1, 0, 0, 0], [0, 0, 0], SPIN])
    motion = scipy.integrate.solve_ivp(rate, (0, 6), y, method="DOP853", rtol=1e-11, atol=1e-11, events=flip)
    between = float(np.diff(motion.t_events[0]).mean())
    print(f"time between flips: {between:.8f} s simulated, {closed_form():.8f} s in closed form")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        axes.plot(motion.t, motion.y[10:13].T, label=["omega1", "omega2", "omega3"])
        axes.set(xlabel="time, s", ylabel="angular velocity, rad/s")
        axes.legend()
        figure.savefig(Path(folder) / "block_tumbling.svg")
        plt.close(figure)
    return between / closed_form()


if __name__ == "__main__":
    main(*sys.argv[1:])
