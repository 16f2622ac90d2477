"""The rod of the crank-slider as ANCF cable elements of Exudyn: peers for `tisserand study accuracy --peers`.

    python bench/exudyn_cables.py bench/exudyn_cables.csv
    tisserand study accuracy scenes/crank_slider_3.toml --peers bench/exudyn_cables.csv

It needs `pip install exudyn`. Parameters, start and reference are those of `scenes/crank_slider_3.toml`, which it
reads as data; EA follows from the diameter of the rod. The method is the implicit trapezoidal rule of index 2, with the
faster one of the dense and the sparse solver for each size. Times are CPU times without output, the least of some runs.
"""

from __future__ import annotations

import csv
import sys
import time
import tomllib
from dataclasses import dataclass
from importlib import import_module
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

SCENE = Path(__file__).parent.parent / "scenes" / "crank_slider_3.toml"
DIAMETER, YOUNG = 0.006, 0.2e12
RUNS = 9
LADDER = {2: (250, 500, 1000, 2000), 4: (500, 1000, 2000, 4000), 8: (1000, 2000, 4000, 8000)}
"""Numbers of steps by the number of elements."""


@dataclass(frozen=True)
class CrankSlider:
    """Crank radius and rod length (m), EI (N m^2), masses of rod and slider (kg), speed (rad/s), duration (s)."""

    crank: float
    rod: float
    stiffness: float
    rod_mass: float
    slider_mass: float
    speed: float
    duration: float


def crank_slider() -> tuple[CrankSlider, np.ndarray, np.ndarray]:
    """The mechanism of the scene, and its reference: crank angles (n,), deflections over the length (n,)."""
    data = tomllib.loads(SCENE.read_text())
    bodies, reference = data["bodies"], data["plots"]["deflection"]["reference"]
    with (SCENE.parent / reference["file"]).open() as table:
        rows = list(csv.DictReader(table))
    of = CrankSlider(
        bodies["crank"]["markers"]["pin"][0],
        bodies["rod"]["length"],
        bodies["rod"]["bending_stiffness"],
        bodies["rod"]["mass"],
        bodies["slider"]["mass"],
        data["drives"]["motor"]["speed"],
        data["simulation"]["duration"],
    )
    return of, *(np.array([float(row[reference[key]]) for row in rows]) for key in ("x", "y"))


def assembled(exu: Any, of: CrankSlider, elements: int) -> tuple[Any, list[int]]:
    """A system of Exudyn and its sensors of the positions of left end, middle and right end."""
    items = import_module("exudyn.itemInterface")

    system = exu.SystemContainer().AddSystem()
    spin, span = -of.speed * of.crank / of.rod, of.rod / elements
    nodes = []
    for n in range(elements + 1):
        velocity = [0.0, of.speed * of.crank * (1 - n / elements), 0.0, spin]
        place = [of.crank + n * span, 0.0, 1.0, 0.0]
        node = items.NodePoint2DSlope1(referenceCoordinates=place, initialVelocities=velocity)
        nodes.append(system.AddNode(node))
    for pair in pairwise(nodes):
        cable = items.ObjectANCFCable2D(
            length=span,
            massPerLength=of.rod_mass / of.rod,
            bendingStiffness=of.stiffness,
            axialStiffness=YOUNG * np.pi / 4 * DIAMETER**2,
            nodeNumbers=list(pair),
        )
        system.AddObject(cable)
    ground = system.AddObject(items.ObjectGround())
    origin = system.AddMarker(items.MarkerBodyPosition(bodyNumber=ground))
    fixed = system.AddMarker(
        items.MarkerNodeCoordinate(nodeNumber=system.AddNode(items.NodePointGround()), coordinate=0)
    )
    crank_node = system.AddNode(
        items.NodeRigidBody2D(referenceCoordinates=[0, 0, 0], initialVelocities=[0, 0, of.speed])
    )
    crank = system.AddObject(items.ObjectRigidBody2D(mass=1e-3, inertia=1e-5, nodeNumber=crank_node))
    hub = system.AddMarker(items.MarkerBodyPosition(bodyNumber=crank))
    pin = system.AddMarker(items.MarkerBodyPosition(bodyNumber=crank, localPosition=[of.crank, 0, 0]))
    system.AddObject(items.ObjectJointRevolute2D(markerNumbers=[origin, hub]))
    turned = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=crank_node, coordinate=2))
    system.AddObject(
        items.ObjectConnectorCoordinate(markerNumbers=[fixed, turned], velocityLevel=True, offset=of.speed)
    )
    ends = [system.AddMarker(items.MarkerNodePosition(nodeNumber=nodes[i])) for i in (0, -1)]
    system.AddObject(items.ObjectJointRevolute2D(markerNumbers=[pin, ends[0]]))
    slider_node = system.AddNode(items.NodePoint2D(referenceCoordinates=[of.crank + of.rod, 0.0]))
    slider = system.AddObject(items.ObjectMassPoint2D(mass=of.slider_mass, nodeNumber=slider_node))
    system.AddObject(
        items.ObjectJointRevolute2D(
            markerNumbers=[ends[1], system.AddMarker(items.MarkerBodyPosition(bodyNumber=slider))]
        )
    )
    across = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=slider_node, coordinate=1))
    system.AddObject(items.ObjectConnectorCoordinate(markerNumbers=[fixed, across]))
    sensors = [
        system.AddSensor(
            items.SensorNode(
                nodeNumber=nodes[i],
                outputVariableType=exu.OutputVariableType.Position,
                storeInternal=True,
                writeToFile=False,
            )
        )
        for i in (0, elements // 2, elements)
    ]
    system.Assemble()
    return system, sensors


def solve(exu: Any, of: CrankSlider, elements: int, steps: int, written: int) -> tuple[float, list[np.ndarray]]:
    """CPU seconds of a run, and the rows [t, x, y, z] of the sensors, of which there are about `written`."""
    system, sensors = assembled(exu, of, elements)
    settings = exu.SimulationSettings()
    integration, solver = settings.timeIntegration, exu.LinearSolverType
    integration.numberOfSteps, integration.endTime = steps, of.duration
    integration.generalizedAlpha.useIndex2Constraints = True
    integration.generalizedAlpha.useNewmark = True
    integration.newton.useModifiedNewton = True
    integration.verboseMode = 0
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = of.duration / max(1, written)
    settings.linearSolver.solverType = solver.EigenSparse if elements > 4 else solver.EXUdense
    before = time.process_time()
    if not system.SolveDynamic(settings):
        raise SystemExit(f"Exudyn did not finish with {elements} elements and {steps} steps")
    return time.process_time() - before, [np.array(system.GetSensorStoredData(s)) for s in sensors]


def errors(of: CrankSlider, sensors: list[np.ndarray], angles: np.ndarray, known: np.ndarray) -> tuple[float, float]:
    """The rms and the largest error of the deflection over the peak of the reference."""
    from scipy.interpolate import CubicSpline

    left, middle, right = (rows[:, 1:3] for rows in sensors)
    chord, arm = right - left, middle - left
    deflection = (chord[:, 0] * arm[:, 1] - chord[:, 1] * arm[:, 0]) / np.hypot(*chord.T) / of.rod
    off = CubicSpline(of.speed * sensors[0][:, 0], deflection)(angles) - known
    peak = np.abs(known).max()
    return float(np.sqrt(np.mean(off**2)) / peak), float(np.abs(off).max() / peak)


def main() -> None:
    """Write the table to the file that is given."""
    import exudyn as exu

    exu.config.printToConsole = False
    of, angles, known = crank_slider()
    with Path(sys.argv[1]).open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["model", "cpu_s", "rms_error", "largest_error"])
        for elements, counts in LADDER.items():
            for steps in counts:
                _, sensors = solve(exu, of, elements, steps, 1000)
                seconds = min(solve(exu, of, elements, steps, 1)[0] for _ in range(RUNS))
                row = [f"Exudyn, {elements} ANCF cables", seconds, *errors(of, sensors, angles, known)]
                table.writerow(row)
                print(*row, f"({steps} steps)")


if __name__ == "__main__":
    main()
