"""Conflicts: joints, drives and given values that contradict each other, so that one of them has to give way.

The bodies are taken apart, as rigid ones. The demands are fitted by least squares; each of them is then released in
turn, and is part of the conflict if all others can be met.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from derive.mechanics.multibody.joints.registry import JOINTS
from derive.mechanics.prescribed_motion import drive_speed
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import max_norm
from derive.simulation.initial.assembler import Assembler
from derive.simulation.initial.contradictions import SHARE, Conflict
from derive.simulation.initial.joint_functions import Function, driven_coordinate, residuals
from derive.simulation.initial.kinematics import Linear
from derive.simulation.initial.loose_bodies import LooseBodies
from derive.simulation.initial.targets import Target
from derive.simulation.observables.motion import simulated_drive
from derive.simulation.time_derivatives import derivatives_at
from derive.spec.model.joints import Drive
from derive.spec.model.scene import Scene

MET = 1e-6
"""rad, part of the size, or relative to the largest rate: demands that are missed by less are met."""
RELEASED, KEPT = 1e-4, 1e3
"""The weight of a demand that gives way, and that of given values where joints and drives give way."""
BESIDE = 0.05
"""rad, and part of the size: the distance from the configuration at which the search begins."""
MOST_STEPS = 100
MOST_BODIES = 15
"""The largest number of bodies of a scene in which conflicts are sought; in larger ones it takes too long."""


@dataclass(frozen=True, eq=False)
class Demand:
    """Functions of the configuration, and the values that they should have, with their units.

    noun, name: of a joint or a drive, or "value" and a key; targets: those of a given value.
    """

    noun: str
    name: str
    functions: tuple[Function, ...]
    values: tuple[float, ...]
    units: tuple[str, ...]
    targets: tuple[Target, ...] = ()


def position_conflict(
    scene: Scene, assembler: Assembler, shape: Vector, q: Vector, given: Sequence[Target]
) -> Conflict:
    """The conflict of given positions with joints and drives.

    shape (nq,): a configuration with the deformations of the bodies; q (nq,): one near the given positions.
    """
    if len(scene.bodies) > MOST_BODIES:
        return Conflict()
    from scipy.optimize import least_squares

    native, bodies = assembler.native, LooseBodies(scene, assembler, shape)
    drives = {drive.name: float(simulated_drive(native, drive, np.array([assembler.t]))[0]) for drive in scene.drives}
    demands = [*_of_joints(scene, native), *_of_drives(scene, native, drives), *_of_targets(given)]
    scales = _scales(demands, assembler.size)
    wanted = np.array([value for demand in demands for value in demand.values])

    def linear(x: Vector) -> list[Linear]:
        at = bodies.at(x)
        return [function(at) for demand in demands for function in demand.functions]

    def missed(x: Vector) -> Vector:
        return np.asarray((np.array([row.value for row in linear(x)]) - wanted) / scales)

    def rows(x: Vector) -> Matrix:
        return np.array([row.gradient for row in linear(x)]) / scales[:, None]

    # Not from the configurations themselves, which may be such that no direction is better, as at a dead centre.
    beside = np.random.default_rng(0).uniform(-BESIDE, BESIDE, bodies.size)
    starts = (beside, bodies.displacements(q) + beside)

    def solved(weights: Vector) -> Vector:
        def jacobian(x: Vector) -> Matrix:
            return weights[:, None] * rows(x)

        def weighted(x: Vector) -> Vector:
            return weights * missed(x)

        limits = {"xtol": 1e-12, "ftol": 1e-12, "gtol": 1e-12, "max_nfev": MOST_STEPS}
        fits = [least_squares(weighted, start, jacobian, **limits) for start in starts]
        return missed(np.asarray(min(fits, key=lambda fit: fit.cost).x))

    return _conflict(demands, scales, solved, "")


def velocity_conflict(scene: Scene, assembler: Assembler, q: Vector, v: Vector, given: Sequence[Target]) -> Conflict:
    """The conflict of given velocities with joints and drives in the configuration q (nq,). v (nv,): near them."""
    if len(scene.bodies) > MOST_BODIES:
        return Conflict()
    native, bodies = assembler.native, LooseBodies(scene, assembler, q)
    drives = {drive.name: drive_rates(native, assembler.k, drive)[0] for drive in scene.drives}
    demands = [*_of_joints(scene, native), *_of_drives(scene, native, drives), *_of_targets(given)]
    scales = _scales(demands, assembler.size)
    functions = [function for demand in demands for function in demand.functions]
    at = bodies.at(np.zeros(bodies.size))
    rows = np.array([function(at).gradient for function in functions]) / scales[:, None]
    known = bodies.deformation_rates(functions, v)
    wanted = (np.array([value for demand in demands for value in demand.values]) - known) / scales
    largest = max_norm(wanted) or 1.0

    def solved(weights: Vector) -> Vector:
        x = np.linalg.lstsq(weights[:, None] * rows, weights * wanted, rcond=1e-9)[0]
        return np.asarray((rows @ x - wanted) / largest)

    return _conflict(demands, scales * largest, solved, "/s")


def drive_rates(native: NativeScene, k: Vector, drive: Drive) -> tuple[float, float]:
    """The speed and the acceleration of a drive at t = 0."""
    if drive.motion is not None and drive.motion.kind == "input":
        value = native.nk - len(native.inputs) + native.inputs.index(drive.motion.name)
        speed, acceleration = np.asarray(native.own_at(0.0, k))[value + 1 : value + 3].tolist()
        return speed, acceleration
    if drive.motion is not None:
        return derivatives_at(drive.motion, 0.0, f"drives.{drive.name}.motion")[1:]
    of = drive_speed(drive)
    assert of is not None, "a drive has a speed or a motion"
    return derivatives_at(of, 0.0, f"drives.{drive.name}.speed")[:2]


def _conflict(demands: Sequence[Demand], scales: Vector, solved: Callable[[Vector], Vector], per_time: str) -> Conflict:
    """The conflict among demands. solved: returns how far the fit with given weights of the rows misses each row."""
    counts = [len(demand.functions) for demand in demands]
    slices = [slice(end - count, end) for count, end in zip(counts, np.cumsum(counts), strict=True)]
    every = np.ones(sum(counts))
    try:
        missed = solved(every)
    except (ValueError, ArithmeticError):  # values that are not finite, which the message of the caller reports
        return Conflict()
    if not MET < max_norm(missed) < np.inf:
        return Conflict()

    def involved(missed: Vector) -> list[tuple[Demand, slice]]:
        largest = SHARE * max_norm(missed)
        return [(d, of) for d, of in zip(demands, slices, strict=True) if max_norm(missed[of]) > largest]

    alone: list[tuple[Demand, Vector]] = []
    for demand, of in zip(demands, slices, strict=True):
        weights = every.copy()
        weights[of] = RELEASED
        rest = solved(weights)
        if max_norm(rest[weights == 1.0]) <= MET < max_norm(rest[of]):
            alone.append((demand, rest[of] * scales[of]))
    parts = [(demand, values) for demand, values in alone if not demand.targets]
    if not parts:  # several have to give way: by how much they are missed if given values are kept
        kept = np.concatenate([np.full(len(d.functions), KEPT if d.targets else 1.0) for d in demands])
        missed = solved(kept)
        parts = [(demand, missed[of] * scales[of]) for demand, of in involved(missed) if not demand.targets]
    targets = (
        target
        for demand, values in alone
        for target, value in zip(demand.targets, values, strict=False)
        if abs(value) > SHARE * max_norm(values)
    )
    amounts = ((demand.noun, demand.name, _amount(demand, values, per_time)) for demand, values in parts)
    return Conflict(tuple(amounts), tuple(targets))


def _of_joints(scene: Scene, native: NativeScene) -> list[Demand]:
    result = []
    for joint in scene.joints:
        functions = residuals(scene, joint, native)
        units = tuple(row.unit for row in JOINTS[joint.kind].removes)
        result.append(Demand("joint", joint.name, functions, (0.0,) * len(functions), units))
    return result


def _of_drives(scene: Scene, native: NativeScene, values: dict[str, float]) -> list[Demand]:
    joints = {joint.name: joint for joint in scene.joints}
    result = []
    for drive in scene.drives:
        joint = joints[drive.joint]
        driven = JOINTS[joint.kind].driven
        assert driven is not None, "the specification refuses other drives"
        function = driven_coordinate(scene, joint, native)
        result.append(Demand("drive", drive.name, (function,), (values[drive.name],), (driven.unit,)))
    return result


def _of_targets(given: Sequence[Target]) -> list[Demand]:
    """The given values by their keys, without those of deformations."""
    keys: dict[str, list[Target]] = {}
    for target in given:
        if target.amplitude is None:
            keys.setdefault(target.path, []).append(target)
    return [
        Demand(
            "value",
            path,
            tuple(target.function for target in targets),
            tuple(target.value for target in targets),
            tuple("rad" if target.angular else "m" for target in targets),
            tuple(targets),
        )
        for path, targets in keys.items()
    ]


def _scales(demands: Sequence[Demand], size: float) -> Vector:
    """The scale of each row: 1 rad, or the size of the scene (m)."""
    return np.array([1.0 if unit == "rad" else size for demand in demands for unit in demand.units])


def _amount(demand: Demand, values: Vector, per_time: str) -> str:
    """The text of the amount by which a joint or a drive is missed: a distance, an angle, or both."""
    amounts = []
    for unit in dict.fromkeys(demand.units):
        amount = float(np.linalg.norm([x for x, of in zip(values, demand.units, strict=True) if of == unit]))
        amounts.append((amount, f"{amount:.3g} {unit}{per_time}"))
    largest = max(amount for amount, _ in amounts)
    return " and ".join(text for amount, text in amounts if amount > SHARE * largest)
