"""Use the generated Python module where Tisserand is not installed.

Beside C, every model has a Python module that needs NumPy alone. It has the same functions with the same arguments.
This script imports it from a file, as another program would. The number is the kinetic energy of a rigidly rotating
beam, 1/2 (m l^2/12) w^2, with m = 2 kg, l = 1.5 m and w = 3 rad/s: 1.6875 J.
"""

import importlib.util
import tempfile
from pathlib import Path

import numpy as np

import derive


def main() -> float:
    """Return the kinetic energy of the rotating beam."""
    beam = derive.planar_beam("python_beam")
    files = derive.model_files(derive.lower(derive.derive(beam)), beam)
    with tempfile.TemporaryDirectory() as folder:
        derive.write(files, folder)
        source = Path(folder) / "python_beam" / "python_beam.py"
        spec = importlib.util.spec_from_file_location("python_beam", source)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        k = module.setup(np.array([2.0, 1.5, 10.0]))
        kinetic, strain = module.energy(np.zeros(5), np.array([0.0, 0.0, 3.0, 0.0, 0.0]), k)
    print(f"kinetic energy {kinetic:g} J, strain energy {strain:g} J")
    return float(kinetic)


if __name__ == "__main__":
    main()
