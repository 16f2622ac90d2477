"""Andrews' squeezing mechanism, a benchmark of the IVP Test Set.

Seven rigid bodies with ten revolute joints, one spring and a constant torque have one degree of freedom. The data are
those of Hairer & Wanner, Solving Ordinary Differential Equations II, section VII.7. The numbers are the angles beta,
gamma, delta and epsilon of the bodies K1, K3, K5 and K7 at t = 0.03 s, which agree with the published reference
solution to nine digits. The crank has made two and a half revolutions by then.
"""

import sys
from pathlib import Path

import derive

SCENE = Path(__file__).parent / "andrews_squeezer.toml"
ANGLES = {"beta": "K1_phi", "gamma": "K3_phi", "delta": "K5_phi", "epsilon": "K7_phi"}


def main(folder: str | None = None) -> dict[str, float]:
    """Return the four angles at t = 0.03 s, rad."""
    trajectory = derive.simulate(derive.read(SCENE))
    result = {angle: float(trajectory[column][-1]) for angle, column in ANGLES.items()}
    for angle, value in result.items():
        print(f"{angle:>7}(0.03 s) = {value:.12f}")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        for angle in ("gamma", "delta", "epsilon"):
            axes.plot(1e3 * trajectory["t"], trajectory[ANGLES[angle]], label=angle)
        axes.set(xlabel="time, ms", ylabel="angle, rad")
        axes.legend()
        figure.savefig(Path(folder) / "andrews_squeezer.svg")
        plt.close(figure)
    return result


if __name__ == "__main__":
    main(*sys.argv[1:])
