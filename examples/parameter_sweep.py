"""One compiled model serves many sets of parameters.

The constants of a specification may be run-time parameters, each with a symbol, a unit and a default value. `setup`
computes everything that depends on parameters alone; no other function is evaluated again. The number is the exponent
of the first natural frequency as a function of the bending stiffness EI, which is 1/2.
"""

import sys
from pathlib import Path

import numpy as np

import derive


def main(folder: str | None = None) -> float:
    """Return the slope of log(frequency) over log(EI)."""
    beam = derive.planar_beam("sweep")
    native = derive.load(derive.model_files(derive.lower(derive.derive(beam)), beam))
    values = np.geomspace(1, 1000, 7)
    frequencies = []
    for stiffness in values:
        k = native.setup(EI=stiffness)
        acceleration = native.accel(0.0, [0, 0, 0, 1e-3, 0], np.zeros(5), k)[3]
        frequencies.append(np.sqrt(-acceleration / 1e-3))
    for stiffness, frequency in zip(values, frequencies, strict=True):
        print(f"EI = {stiffness:8.2f} N m^2: {frequency:8.2f} rad/s")
    if folder is not None:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        axes.loglog(values, frequencies, "o-")
        axes.set(xlabel="bending stiffness EI, N m^2", ylabel="first natural frequency, rad/s")
        figure.savefig(Path(folder) / "parameter_sweep.svg")
        plt.close(figure)
    return float(np.polyfit(np.log(values), np.log(frequencies), 1)[0])


if __name__ == "__main__":
    main(*sys.argv[1:])
