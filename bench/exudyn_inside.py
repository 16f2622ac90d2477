"""One rod four times: in Tisserand, as its generated body inside Exudyn, and as the two flexible bodies of Exudyn.

    python bench/exudyn_inside.py [--runs 9] [--steps 250 1000 4000]

It needs `pip install exudyn` and a C compiler. The rod of `swinging_rod.py` is integrated
  * by the adaptive method of Tisserand, for tolerances;
  * by Exudyn as an object with the generated C (`tisserand export --to exudyn`);
  * by Exudyn as its floating-frame body, ObjectFFRFreducedOrder, with our shape integrals of the same shapes;
  * by Exudyn as ANCF cable elements.
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
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any

import numpy as np
import swinging_rod as rod
from machine import described
from numpy.polynomial import legendre
from scipy.interpolate import CubicSpline
from scipy.sparse import csr_array

import derive
from derive.export.exudyn_floating_frame import floating_frame_arguments
from derive.mechanics.bodies.modal_body import ModalBody, ModalPoint
from derive.reduction.integrals import antisymmetric, shape_integrals
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


def positions_to_deflection(rows: np.ndarray) -> np.ndarray:
    """The deflection over the length from the positions (n, 6) of rod.POINTS."""
    return rod.deflection(rows[:, :2], rows[:, 2:4], rows[:, 4:])


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


Built = tuple[Any, int, Callable[[np.ndarray], np.ndarray]]
"""A system of Exudyn, a sensor, and the function from its values to the deflection over the length."""


def generated(exu: Any, module: ModuleType, library: Path) -> Built:
    """The generated body, with its joint."""
    mbs = exu.SystemContainer().AddSystem()
    body = module.add(mbs, library)
    return mbs, body.add_sensor(mbs), positions_to_deflection


def modal_rod(shapes: int) -> ModalBody:
    """Shape integrals and stiffness of the rod in space with P2, P3, ... as shapes, by Gauss quadrature."""
    xi, weights = legendre.leggauss(shapes + 4)
    units = np.eye(shapes + 2)[2:]
    lateral = np.array([0.0, 1.0, 0.0])

    def phi(at: np.ndarray) -> np.ndarray:
        return np.array([legendre.legval(at, unit) for unit in units])[..., None] * lateral

    def positions(at: np.ndarray) -> np.ndarray:
        return at[:, None] * np.array([rod.LENGTH / 2, 0.0, 0.0])

    mass = csr_array(np.diag(rod.MASS / 2 * weights))
    i = shape_integrals(mass, positions(xi), phi(xi))
    bends = np.array([legendre.legval(xi, legendre.legder(unit, 2)) for unit in units])
    stiffness = rod.STIFFNESS * (2 / rod.LENGTH) ** 3 * (bends * weights) @ bends.T
    at = np.array([-1.0, 0.0, 1.0])
    points = zip(rod.POINTS, positions(at), phi(at).transpose(1, 0, 2), strict=True)
    tensors = i.S4 + antisymmetric(i.c6), i.S5 - antisymmetric(i.c7)
    return ModalBody(
        "rod", "", "", i.mass, i.c1, i.c2, i.C3, *tensors, i.c6, i.c7, i.c8, stiffness, 0.0 * stiffness,
        tuple(ModalPoint(name, "", x, values) for name, x, values in points),
    )  # fmt: skip


def floating_frame(exu: Any, shapes: int) -> Built:
    """The floating-frame body of Exudyn with these integrals, kept in the plane by constraints of its coordinates."""
    items, body = import_module("exudyn.itemInterface"), modal_rod(shapes)
    mbs = exu.SystemContainer().AddSystem()
    half, turn = rod.LENGTH / 2, np.sqrt(0.5)
    frame = mbs.AddNode(
        items.NodeRigidBodyEP(
            referenceCoordinates=[0, -half, 0, turn, 0, 0, -turn],
            initialVelocities=[rod.SPEED * half, 0, 0, rod.SPEED / 2 * turn, 0, 0, rod.SPEED / 2 * turn],
        )
    )
    zero = [0.0] * shapes
    amplitudes = mbs.AddNode(
        items.NodeGenericODE2(
            numberOfODE2Coordinates=shapes,
            referenceCoordinates=zero,
            initialCoordinates=zero,
            initialCoordinates_t=zero,
        )
    )
    number = mbs.AddObject(
        items.ObjectFFRFreducedOrder(nodeNumbers=[frame, amplitudes], **floating_frame_arguments(body))
    )
    ground = mbs.AddObject(items.ObjectGround())
    ends = [
        mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=ground)),
        mbs.AddMarker(items.MarkerSuperElementPosition(bodyNumber=number, meshNodeNumbers=[0], weightingFactors=[1.0])),
    ]
    mbs.AddObject(items.ObjectJointSpherical(markerNumbers=ends, constrainedAxes=[1, 1, 0]))
    fixed = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=mbs.AddNode(items.NodePointGround()), coordinate=0))
    for coordinate in (2, 4, 5):
        own = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=frame, coordinate=coordinate))
        mbs.AddObject(items.ObjectConnectorCoordinate(markerNumbers=[fixed, own]))
    weigh(mbs, number)
    sensor = mbs.AddSensor(
        items.SensorNode(
            nodeNumber=amplitudes,
            outputVariableType=exu.OutputVariableType.Coordinates,
            storeInternal=True,
            writeToFile=False,
        )
    )

    def deflection(alpha: np.ndarray) -> np.ndarray:
        return rod.deflection(*(point.position[:2] + alpha @ point.shapes[:, :2] for point in body.points))

    return mbs, sensor, deflection


def cables(exu: Any, elements: int) -> Built:
    """ANCF cable elements."""
    items = import_module("exudyn.itemInterface")
    mbs, nodes, span = exu.SystemContainer().AddSystem(), [], rod.LENGTH / elements
    for n in range(elements + 1):
        place, velocity = [0, -n * span, 0, -1], [rod.SPEED * n * span, 0, rod.SPEED, 0]
        nodes.append(mbs.AddNode(items.NodePoint2DSlope1(referenceCoordinates=place, initialVelocities=velocity)))
    for pair in pairwise(nodes):
        cable = items.ObjectANCFCable2D(
            length=span,
            massPerLength=rod.MASS / rod.LENGTH,
            bendingStiffness=rod.STIFFNESS,
            axialStiffness=16 * rod.STIFFNESS / rod.DIAMETER**2,
            nodeNumbers=list(pair),
        )
        weigh(mbs, mbs.AddObject(cable))
    fixed = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=mbs.AddNode(items.NodePointGround()), coordinate=0))
    for coordinate in (0, 1):
        own = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=coordinate))
        mbs.AddObject(items.ObjectConnectorCoordinate(markerNumbers=[fixed, own]))
    parts = [
        mbs.AddSensor(
            items.SensorNode(
                nodeNumber=nodes[i],
                outputVariableType=exu.OutputVariableType.Position,
                storeInternal=True,
                writeToFile=False,
            )
        )
        for i in (0, elements // 2, elements)
    ]

    def together(mbs: Any, t: float, sensors: Sequence[int], factors: Any, configuration: Any) -> list[float]:
        return [x for sensor in sensors for x in mbs.GetSensorValues(sensor, configuration)[:2]]

    sensor = mbs.AddSensor(
        items.SensorUserFunction(
            sensorNumbers=parts, sensorUserFunction=together, storeInternal=True, writeToFile=False
        )
    )
    return mbs, sensor, positions_to_deflection


def weigh(mbs: Any, body: int) -> None:
    """The weight of a body."""
    items = import_module("exudyn.itemInterface")
    marker = mbs.AddMarker(items.MarkerBodyMass(bodyNumber=body))
    mbs.AddLoad(items.LoadMassProportional(markerNumber=marker, loadVector=[0, -rod.GRAVITY, 0]))


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
    """What is compared: models of first order, which Exudyn's floating-frame body is, of second order, and cables."""
    result = [own(4, 1, tolerance) for tolerance in tolerances] + [own(6, 2, tolerance) for tolerance in tolerances]
    builds: dict[str, Callable[[], Built]] = {}
    for shapes, order in ((4, 1), (6, 2)):
        made = exported(shapes, order, folder / str(order))
        builds[f"{GENERATED}, {shapes} shapes, order {order}"] = lambda made=made: generated(exu, *made)
    builds["Exudyn, floating-frame body, 4 shapes, order 1"] = lambda: floating_frame(exu, 4)
    builds |= {f"Exudyn, {n} ANCF cables": lambda n=n: cables(exu, n) for n in (2, 4, 8)}
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
