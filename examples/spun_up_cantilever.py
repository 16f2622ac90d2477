"""Where first-order equations fail: the spun-up cantilever of Simo & Vu-Quoc (1986).

A beam of 10 m is clamped to a hub that is spun up to 6 rad/s in 15 s. A real beam bends backwards by 0.57 m and then
comes to rest in the frame of the hub. First-order equations lose their stiffness when the spin reaches the first
natural frequency of the cantilever, 3.516 sqrt(EI/(m l^3)) = 3.80 rad/s, after 8.5 s, and diverge. The numbers are
this spin in units of sqrt(EI/(m l^3)), computed from the model, and the tip deflection after 3 s and 9 s over that of
the reference, a geometrically nonlinear finite-element solution.
"""

import sys
from pathlib import Path

import numpy as np
import scipy.linalg

import derive

SCENES = Path(__file__).parent.parent / "scenes"


def critical_spin() -> float:
    """Return the spin at which the effective stiffness of the clamped beam becomes singular."""
    ansatz = [f"xi^{n}" for n in range(5)]
    frame = {"kind": "tangent", "at": -1}
    beam = derive.planar_beam("clamped", ansatz=ansatz, frame=frame, mass=1, length=1, bending_stiffness=1)
    native = derive.load(derive.model_files(derive.lower(derive.derive(beam)), beam))
    k = native.setup()

    def stiffness(spin: float) -> np.ndarray:
        """Return the derivative of h with respect to the amplitudes at a constant spin."""
        v = [0, 0, spin, 0, 0, 0]
        return np.column_stack([native.force(0.0, [0, 0, 0, *unit], v, k)[3:] for unit in np.eye(3)])

    softening = stiffness(0.0) - stiffness(1.0)
    return float(np.sqrt(scipy.linalg.eigh(stiffness(0.0), softening, eigvals_only=True)[0]))


def main(folder: str | None = None) -> tuple[float, float, float]:
    """Return the critical spin and the tip deflection over the reference after 3 s and 9 s."""
    critical = critical_spin()
    trajectory = derive.simulate(derive.read(SCENES / "spun_up_cantilever.toml"))
    t = trajectory["t"]
    tip = sum(trajectory[f"beam_alpha{i}"] for i in (1, 2, 3))  # each shape function is 1 at the tip
    reference = np.genfromtxt(SCENES / "spinup_cantilever.csv", delimiter=",", skip_header=1)
    print(f"the stiffness is lost at {critical:.4f} sqrt(EI/(m l^3)) = {critical * np.sqrt(1.4e4 / 12e3):.3f} rad/s")
    early, late = (np.interp(time, t, tip) / np.interp(time, *reference[:, [0, 2]].T) for time in (3, 9))
    print(f"tip deflection over that of the nonlinear solution: {early:.3f} after 3 s, {late:.1f} after 9 s")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        axes.plot(reference[:, 0], reference[:, 2], "--", color="gray", label="nonlinear finite elements")
        axes.plot(t, tip, label="first order")
        axes.set(xlabel="time, s", ylabel="tip deflection, m", ylim=(-1.5, 0.2))
        axes.legend()
        figure.savefig(Path(folder) / "spun_up_cantilever.svg")
        plt.close(figure)
    return critical, float(early), float(late)


if __name__ == "__main__":
    main(*sys.argv[1:])
