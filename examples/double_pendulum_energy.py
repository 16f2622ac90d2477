"""Energy of a flexible double pendulum.

Two flexible rods hang one on the other and are released from the horizontal, scenes/double_pendulum.toml. There is no
damping, so that the sum of kinetic energy, strain energy and the potential of gravity is constant. The generated
function `energy` returns these parts. The number is the largest drift, relative to the largest kinetic energy.
"""

import sys
from pathlib import Path

import numpy as np

import derive

SCENE = Path(__file__).parent.parent / "scenes" / "double_pendulum.toml"


def main(folder: str | None = None) -> float:
    """Return the largest change of the total energy over the largest kinetic energy."""
    trajectory = derive.simulate(derive.read(SCENE), duration=0.5)
    native, k = trajectory.motion.native, trajectory.motion.k
    energy = np.array([native.energy(q, v, k) for q, v in zip(trajectory.q, trajectory.v, strict=True)])
    total = energy.sum(axis=1)
    drift = float(np.abs(total - total[0]).max() / energy[:, 0].max())
    print(f"kinetic energy up to {energy[:, 0].max():.4f} J, strain energy up to {energy[:, 1].max():.4f} J")
    print(f"largest relative drift of the total energy: {drift:.2e}")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        for values, label in zip(energy.T, ("kinetic", "strain", "gravity"), strict=True):
            axes.plot(trajectory["t"], values, label=label)
        axes.plot(trajectory["t"], total, color="gray", linestyle="--", label="total")
        axes.set(xlabel="time, s", ylabel="energy, J")
        axes.legend()
        figure.savefig(Path(folder) / "double_pendulum_energy.svg")
        plt.close(figure)
    return drift


if __name__ == "__main__":
    main(*sys.argv[1:])
