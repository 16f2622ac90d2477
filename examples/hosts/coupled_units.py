"""Two functional mock-up units, coupled by a small master.

A motor drives a rotor, to which a flexible arm is welded. The rotor is one unit: it takes the torques of the motor and
of the arm, and gives its angle with two time derivatives. The arm is the other: it takes this motion, and gives the
torque that it needs. Acceleration and torque depend on each other at the same instant. Both relations are linear, and
the directional derivatives of the units are their slopes, so that the master solves them exactly. It integrates the
states of both units with the classical Runge-Kutta method. The number is the largest distance (m) of the tip of the arm
from where it is in one scene of both bodies.
"""

import tempfile
from collections.abc import Callable
from pathlib import Path

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Model, fmi2Real
from numpy.typing import NDArray

import derive
from derive.export.registry import exported

Vector = NDArray[np.float64]

DURATION, STEP = 1.0, 1e-3
TORQUE = "4*sin(5*t)"
ROTOR = {"mass": 1, "inertia": 0.2, "markers": {"hub": [0, 0]}}
ARM = {
    "mass": 2,
    "length": 1,
    "bending_stiffness": 100,
    "ansatz": ["1", "xi", "xi^2", "xi^3"],
    "markers": {"root": -1, "tip": 1},
    "start": {"position": [0.5, 0]},
}
TIP = {"tip": {"kind": "position", "marker": "arm.tip"}}

rotor = derive.scene(
    "rotor",
    ground={"bearing": [0, 0]},
    bodies={"rotor": ROTOR},
    joints={"bearing": {"kind": "revolute", "between": ["ground.bearing", "rotor.hub"]}},
    inputs={"motor": {"unit": "N m"}, "load": {"unit": "N m"}},
    torques={name: {"at": "rotor.hub", "value": {"input": name}} for name in ("motor", "load")},
    outputs={
        "angle": {"kind": "rotation", "marker": "rotor.hub"},
        "speed": {"kind": "angular_velocity", "marker": "rotor.hub"},
        "acceleration": {"kind": "angular_acceleration", "marker": "rotor.hub"},
    },
)
arm = derive.scene(
    "arm",
    ground={"bearing": [0, 0]},
    bodies={"arm": ARM},
    joints={"bearing": {"kind": "revolute", "between": ["ground.bearing", "arm.root"]}},
    inputs={"angle": {"unit": "rad"}},
    drives={"motion": {"joint": "bearing", "motion": {"input": "angle"}}},
    outputs={"torque": {"kind": "drive", "drive": "motion"}, **TIP},
)
both = derive.scene(
    "both",
    ground={"bearing": [0, 0]},
    bodies={"rotor": ROTOR, "arm": ARM},
    joints={
        "bearing": {"kind": "revolute", "between": ["ground.bearing", "rotor.hub"]},
        "weld": {"kind": "fixed", "between": ["rotor.hub", "arm.root"]},
    },
    torques={"motor": {"at": "rotor.hub", "value": TORQUE}},
    outputs=TIP,
    simulation={"duration": DURATION, "output": DURATION / 100},
)


class Unit:
    """A unit for model exchange, with its variables by name."""

    def __init__(self, scene: derive.Scene, folder: Path) -> None:
        derive.write(exported(scene, "fmu2"), folder)
        path = str(folder / f"{scene.name}-fmu2/{scene.name}.fmu")
        description = fmpy.read_model_description(path)
        self.references = {x.name: x.valueReference for x in description.modelVariables}
        self.size = description.numberOfContinuousStates
        self.fmu: FMU2Model = fmpy.instantiate_fmu(
            fmpy.extract(path, folder / scene.name), description, "ModelExchange"
        )
        self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        self.update()

    def set(self, **values: float) -> None:
        """Set inputs."""
        self.fmu.setReal([self.references[name] for name in values], [*values.values()])

    def get(self, *names: str) -> list[float]:
        """The values of variables."""
        return list(self.fmu.getReal([self.references[name] for name in names]))

    def slope(self, output: str, given: str) -> float:
        """The derivative of an output with respect to an input."""
        (result,) = self.fmu.getDirectionalDerivative([self.references[output]], [self.references[given]], [1.0])
        return float(result)

    def array(self, fill: Callable[[object, int], None]) -> Vector:
        """An array of states, which a function of the unit fills."""
        values = (fmi2Real * self.size)()
        fill(values, self.size)
        return np.array(values)

    def move(self, t: float, x: Vector) -> None:
        """Set the time and the states."""
        self.fmu.setTime(t)
        self.fmu.setContinuousStates((fmi2Real * self.size)(*x), self.size)

    def update(self) -> None:
        """Handle an event, in which states may be projected onto the constraints."""
        while self.fmu.newDiscreteStates()[0]:
            pass
        self.fmu.enterContinuousTimeMode()

    def completed(self) -> Vector:
        """The states after a step."""
        event, _ = self.fmu.completedIntegratorStep()
        if event:
            self.fmu.enterEventMode()
            self.update()
        return self.array(self.fmu.getContinuousStates)


def connect(t: float, rotor: Unit, arm: Unit) -> None:
    """Set the inputs of both units such that motion and torque agree."""
    rotor.set(motor=4 * np.sin(5 * t), load=0.0)
    angle, speed, acceleration = rotor.get("angle", "speed", "acceleration")
    arm.set(angle=angle, angledot=speed, angleddot=acceleration)
    (torque,) = arm.get("torque")
    of_rotor, of_arm = rotor.slope("acceleration", "load"), arm.slope("torque", "angleddot")
    more = -of_rotor * torque / (1 + of_rotor * of_arm)
    arm.set(angleddot=acceleration + more)
    rotor.set(load=-(torque + of_arm * more))


def rates(t: float, x: Vector, units: tuple[Unit, Unit]) -> Vector:
    """The time derivatives of the states of both units."""
    for unit, part in zip(units, np.split(x, [units[0].size]), strict=True):
        unit.move(t, part)
    connect(t, *units)
    return np.concatenate([unit.array(unit.fmu.getDerivatives) for unit in units])


def main() -> float:
    """Return the largest distance of the tips, m."""
    with tempfile.TemporaryDirectory() as folder:
        units = Unit(rotor, Path(folder)), Unit(arm, Path(folder))
        x = np.concatenate([unit.array(unit.fmu.getContinuousStates) for unit in units])
        tips = [units[1].get("tip[1]", "tip[2]")]
        for n in range(round(DURATION / STEP)):
            t = n * STEP
            k1 = rates(t, x, units)
            k2 = rates(t + STEP / 2, x + STEP / 2 * k1, units)
            k3 = rates(t + STEP / 2, x + STEP / 2 * k2, units)
            k4 = rates(t + STEP, x + STEP * k3, units)
            rates(t + STEP, x + STEP / 6 * (k1 + 2 * k2 + 2 * k3 + k4), units)
            x = np.concatenate([unit.completed() for unit in units])
            tips.append(units[1].get("tip[1]", "tip[2]"))
        for unit in units:
            unit.fmu.terminate()
            unit.fmu.freeInstance()
    expected = derive.simulate(both).solution.outputs[:, :2]
    error = float(np.max(np.hypot(*(np.array(tips)[::10] - expected).T)))
    print(
        f"after {DURATION:g} s the arm is at {tips[-1][0]:.6f}, {tips[-1][1]:.6f} m; largest difference {error:.1e} m"
    )
    return error


if __name__ == "__main__":
    main()
