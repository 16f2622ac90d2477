"""Conserved quantities of a free chain of beams over many steps: energy, linear and angular momentum.

python bench/conserved.py [--beams 100] [--steps 100000] [--step SECONDS] [--integrator rk4]

The chain is that of examples/chain_100.toml without its hinge and without gravity; it bends and turns. No forces from
outside act on it, so that these quantities are constant. Drifts are the largest differences from the start, relative to
the energy, to the mass times the largest velocity, and to that times the length of the chain. The projection onto the
constraints, in the metric of M, keeps both momenta; the method of Runge and Kutta does not keep energy, which it loses
in the oscillations that its steps do not resolve.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
from chain_scene import chain
from machine import described

import derive

ROWS = 100
"""The rows between which steps are taken."""


def main() -> None:
    """Print the drifts."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--beams", type=int, default=100)
    parser.add_argument("--steps", type=int, default=100_000)
    parser.add_argument("--step", type=float, default=2e-5)
    parser.add_argument("--integrator", default="rk4")
    options = parser.parse_args()
    duration = options.step * options.steps
    scene = chain(options.beams, free=True, duration=duration, output=duration / ROWS)
    began = time.process_time()
    run = derive.simulate(scene, integrator=options.integrator, step=options.step)
    seconds = time.process_time() - began
    native, k = run.motion.native, run.motion.k
    energies = np.array([native.energy(q, v, k) for q, v in zip(run.q, run.v, strict=True)])
    momenta = np.array([native.momentum(q, v, k) for q, v in zip(run.q, run.v, strict=True)])
    mass, length = 0.05 * options.beams, 0.1 * options.beams
    impulse = mass * np.abs(run.v[:, 1::5]).max()
    drift = np.abs(momenta - momenta[0]).max(axis=0) / (impulse, impulse, impulse * length)
    total = energies.sum(axis=1)
    print("\n".join(described("numpy")))
    steps = f"{run.solution.cost.steps} steps of {options.integrator}"
    print(f"{options.beams} beams, {steps}, {duration:g} s of motion, {seconds:.1f} s of CPU time")
    print(f"energy              {energies[0].sum():.6g} J, relative drift {np.abs(total / total[0] - 1).max():.1e}")
    print(f"linear momentum     relative drift {drift[0]:.1e}, {drift[1]:.1e}")
    print(f"angular momentum    relative drift {drift[2]:.1e}")
    print(f"constraints         {run.solution.drift.max():.1e} m, rad")
    print(f"deflection          {np.ptp(run.q[-1, 1::5]):.3g} m at the end, from a straight chain of {length:g} m")


if __name__ == "__main__":
    main()
