"""One rod five times: in Tisserand, as its generated body inside Exudyn, and as flexible bodies of Exudyn itself.

    python bench/exudyn_inside.py [--runs 9] [--steps 250 1000 4000]

It needs `pip install exudyn` and a C compiler. The rod of `swinging_rod.py` is integrated
  * by the adaptive method of Tisserand, for tolerances;
  * by Exudyn as an object with the generated C (`tisserand export --to exudyn`);
  * by Exudyn as its floating-frame body, ObjectFFRFreducedOrder, with our shape integrals of the same shapes;
  * by Exudyn as ANCF cable elements, and as geometrically exact beam elements with three nodes.
Exudyn takes the implicit trapezoidal rule of index 2. Errors are those of the deflection of the middle, rms over the
peak, against the independent reference. Times are CPU times without output, the least of some runs that take turns;
derivation and compilation, a few seconds for a model, are not part of them.
"""

from __future__ import annotations

import argparse
import importlib.util
import subprocess
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any

import numpy as np
import swinging_rod as rod
from exudyn_rods import Built, beams, cables, floating_frame, positions_to_deflection
from machine import described
from scipy.interpolate import CubicSpline

import derive
from derive.runtime.integrators.adaptive import Adaptive
from derive.simulation.initial.initial_state import initial_state

TOLERANCES = (1e-4, 1e-6, 1e-8)
GENERATED = "Exudyn, generated body"
STEPS = (250, 500, 1000, 2000, 4000)


@dataclass(frozen=True)
class Run:
    """A variant with what it is controlled by: the CPU seconds, and the deflection over the length at rod.times()."""

    variant: str
    control: str
    seconds: Callable[[], float]
    deflection: Callable[[], np.ndarray]


def own(shapes: int, order: int, tolerance: float) -> Run:
    """The adaptive method in C."""
    spec = rod.scene(shapes, order)
    native = derive.load_scene(derive.model_files(derive.lower(derive.derive(spec)), spec))
    host, k = Adaptive(native), native.setup()
    start = initial_state(spec, native, k)

    def seconds() -> float:
        before = time.process_time()
        host.run(start.q, start.v, np.array([0.0, rod.DURATION]), rtol=tolerance, k=k)
        return time.process_time() - before

    def deflection() -> np.ndarray:
        run = host.run(start.q, start.v, rod.times(), rtol=tolerance, k=k)
        still = np.zeros(native.nv), np.zeros(native.nlambda)
        rows = [native.evaluate_outputs(0.0, q, v, *still, k) for q, v in zip(run.q, run.v, strict=True)]
        return positions_to_deflection(np.array(rows))

    return Run(f"Tisserand, {shapes} shapes, order {order}", f"tolerance {tolerance:.0e}", seconds, deflection)


def exported(shapes: int, order: int, folder: Path) -> tuple[ModuleType, Path]:
    """The module of the rod for Exudyn, and its library."""
    derive.write(derive.exported(rod.scene(shapes, order), "exudyn"), folder)
    made, library = folder / "swinging_rod-exudyn", folder / "swinging_rod.so"
    command = ["cc", "-O2", "-shared", "-fPIC", *map(str, made.glob("*.c")), "-o", str(library), "-lm"]
    subprocess.run(command, check=True)
    found = importlib.util.spec_from_file_location("swinging_rod_exudyn", made / "swinging_rod_exudyn.py")
    assert found is not None and found.loader is not None
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module, library


def generated(exu: Any, module: ModuleType, library: Path) -> Built:
    """The generated body, with its joint."""
    mbs = exu.SystemContainer().AddSystem()
    body = module.add(mbs, library)
    return mbs, body.add_sensor(mbs), positions_to_deflection


def inside(exu: Any, variant: str, build: Callable[[], Built], steps: int) -> Run:
    """A variant in Exudyn with so many steps, and with that method of Newton which is the faster one for it."""

    def solve(rows: int) -> tuple[float, np.ndarray, Callable[[np.ndarray], np.ndarray]]:
        mbs, sensor, deflection = build()
        mbs.Assemble()
        settings = exu.SimulationSettings()
        integration = settings.timeIntegration
        integration.numberOfSteps, integration.endTime, integration.verboseMode = steps, rod.DURATION, 0
        integration.generalizedAlpha.useNewmark = integration.generalizedAlpha.useIndex2Constraints = True
        integration.newton.useModifiedNewton = not variant.startswith(GENERATED)
        settings.solution.file.write = False
        settings.solution.sensors.writePeriod = rod.DURATION / rows
        before = time.process_time()
        mbs.SolveDynamic(settings)
        seconds = time.process_time() - before
        return seconds, np.array(mbs.GetSensorStoredData(sensor)), deflection

    def deflection() -> np.ndarray:
        _, rows, of = solve(steps)
        return np.asarray(CubicSpline(rows[:, 0], of(rows[:, 1:]))(rod.times()))

    return Run(variant, f"{steps} steps", lambda: solve(1)[0], deflection)


def all_runs(exu: Any, folder: Path, steps: Sequence[int], tolerances: Sequence[float]) -> list[Run]:
    """The runs of models of first order, such as Exudyn's floating-frame body, of second order, and of cables."""
    result = [own(4, 1, tolerance) for tolerance in tolerances] + [own(6, 2, tolerance) for tolerance in tolerances]
    builds: dict[str, Callable[[], Built]] = {}
    for shapes, order in ((4, 1), (6, 2)):
        made = exported(shapes, order, folder / str(order))
        builds[f"{GENERATED}, {shapes} shapes, order {order}"] = lambda made=made: generated(exu, *made)
    builds["Exudyn, floating-frame body, 4 shapes, order 1"] = lambda: floating_frame(exu, 4)
    builds |= {f"Exudyn, {n} ANCF cables": lambda n=n: cables(exu, n) for n in (2, 4, 8)}
    builds |= {f"Exudyn, {n} beams with 3 nodes": lambda n=n: beams(exu, n) for n in (4, 8)}
    return result + [inside(exu, name, build, n) for name, build in builds.items() for n in steps]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=9)
    parser.add_argument("--steps", type=int, nargs="+", default=STEPS)
    options = parser.parse_args()
    exu = import_module("exudyn")
    exu.config.printToConsole = False
    print("\n".join(described("exudyn", "numpy", "scipy")))
    print(f"figures   ms of CPU time, least of {options.runs} runs; reference to {rod.uncertainty():.0e}\n")
    with TemporaryDirectory() as folder:
        runs = all_runs(exu, Path(folder), options.steps, TOLERANCES)
        errors = [rod.error(run.deflection()) for run in runs]
        seconds = np.array([[run.seconds() for run in runs] for _ in range(options.runs)]).min(axis=0)
    for run, error, least in zip(runs, errors, seconds, strict=True):
        print(f"{run.variant:48}{run.control:18}{1e3 * least:10.3f}{error:12.2e}")


if __name__ == "__main__":
    main()
