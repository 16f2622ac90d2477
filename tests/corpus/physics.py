"""Physics on a scene of the corpus: energy balance, Newton's law for the whole system, and C against Python.

The scene is simulated with more outputs: energies and powers, the reactions of the joints to the ground and the springs
to it, and the motions of the markers at which something acts. Every other scene keeps all coordinates of its rigid
bodies, since the function `momentum` leaves out bodies that a prescribed motion carries; on these Newton's law is
checked. Rates are differences along the motion, in a state (t, q, v) with its accelerations, whose error is estimated.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit

import derive
from corpus.commands import Finding, parameters
from corpus.draft import Table
from corpus.generator import CorpusScene
from corpus.python_kernels import disagreements
from corpus.summed_terms import summed_terms
from derive.ir.model import Model
from derive.simulation.prepared_run import PreparedRun
from derive.spec.model.markers import GROUND
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.scene import Scene
from derive.spec.model.time_function import value_at

ROWS = 4
"""The states of a motion in which the laws are checked."""
LIMIT = 1e-7
"""The largest error of a balance, relative to the sum of the magnitudes in it."""
REST = 4e-15
"""The power, W, and the rates, m/s and rad/s, of a scene in which nothing moves but for rounding errors."""
AT_REST = 1e-20
"""The energy of such a scene, J, whose parts are rounding errors."""

Vector = np.ndarray


def physics(scene: CorpusScene, path: Path) -> Iterator[Finding]:
    """Yield the laws of physics that the motion of a scene contradicts."""
    if "bodies" not in scene.tables or any("value" not in each for each in scene.tables.get("inputs", {}).values()):
        return
    kept = scene.seed % 2 == 1
    variant = path.with_name("physics.toml")
    variant.write_text(tomlkit.dumps(with_outputs(scene.tables, kept)))
    spec = derive.read(variant)
    assert isinstance(spec, Scene)
    run = PreparedRun(spec, complete=False)
    motion = run.trajectory().motion
    native = motion.native
    for name, value in parameters(scene.tables).items():
        if name in native.parameters and native.defaults[list(native.parameters).index(name)] != value:
            yield Finding("physics", "a parameter has another default in the compiled model", name)
    steps = np.unique(np.linspace(1, len(motion.t) - 1, ROWS).astype(int))  # tables are constant before t = 0
    rows = [(float(motion.t[i]), motion.q[i], motion.v[i]) for i in steps]
    states = [State(scene.tables, run.scene, native, motion.k, *row) for row in rows]
    for state in states:
        yield from _energy_balance(state)
        if kept:
            yield from _newton(state, run.complete_model)
    yield from disagreements(run, native, motion.k, states[len(states) // 2])


def with_outputs(tables: Table, kept: bool) -> Table:
    """A scene with the outputs of the checks; with all coordinates of rigid bodies if they are `kept`."""
    result = copy.deepcopy(tables)
    result.pop("plots", None)
    result["simulation"].pop("until", None)
    outputs = result.setdefault("outputs", {})
    outputs |= {"corpus_energy": {"kind": "energy"}, "corpus_power": {"kind": "power"}}
    for section, kind in (("joints", "reaction"), ("springs", "spring")):
        for i, (name, table) in enumerate(tables.get(section, {}).items()):
            if any(marker.startswith("ground.") for marker in table["between"]):
                outputs[f"corpus_{kind}{i}"] = {"kind": kind, kind.replace("reaction", "joint"): name}
    for i, marker in enumerate(markers(tables)):
        outputs[f"corpus_at{i}"] = {"kind": "position", "marker": marker}
        outputs[f"corpus_turn{i}"] = {"kind": "rotation", "marker": marker}
    for body in result["bodies"].values() if kept else ():
        if "inertia" in body:
            body["keep_coordinates"] = True
    return result


def markers(tables: Table) -> list[str]:
    """The markers at which forces act, and those at which joints and springs to the ground do."""
    pairs = [table["between"] for section in ("joints", "springs") for table in tables.get(section, {}).values()]
    at = [pair[1] for pair in pairs if any(marker.startswith("ground.") for marker in pair)]
    return [*dict.fromkeys([*at, *(table["at"] for table in tables.get("forces", {}).values())])]


@dataclass(frozen=True, eq=False)
class State:
    """A state of a scene, with its accelerations and multipliers."""

    tables: Table
    scene: Scene
    native: Any
    k: Vector
    t: float
    q: Vector
    v: Vector

    def outputs(self, s: float = 0.0) -> dict[str, float]:
        """The outputs by name, after a time s (s) along the motion."""
        t, q, v = self.after(s)
        vdot, lam = self.native.solve(t, q, v, self.k)
        values = self.native.evaluate_outputs(t, q, v, vdot, lam, self.k)
        return dict(zip(self.native.outputs, values, strict=True))

    def after(self, s: float) -> tuple[float, Vector, Vector]:
        """The state on the tangent of the motion."""
        vdot, _ = self.native.solve(self.t, self.q, self.v, self.k)
        return self.t + s, self.q + s * self.v, self.v + s * vdot

    @property
    def step(self) -> float:
        """A time in which angles change by no more than a thousandth, s."""
        vdot, _ = self.native.solve(self.t, self.q, self.v, self.k)
        fastest = max(1.0, float(np.abs(self.v).max(initial=0)), math.sqrt(float(np.abs(vdot).max(initial=0))))
        return 1e-3 / fastest

    def rate(self, function: Callable[[float], Vector]) -> tuple[Vector, Vector]:
        """The derivative of a function of s at 0 by differences of fourth order, and its error.

        The error is that of rounding and the change that half the step makes, since drives may change faster than
        the state tells.
        """
        h = self.step
        coarse, fine = ({s: np.asarray(function(s * of)) for s in (-2, -1, 1, 2)} for of in (h, h / 2))
        derivatives = [
            (values[-2] - 8 * values[-1] + 8 * values[1] - values[2]) / (12 * of)
            for values, of in ((coarse, h), (fine, h / 2))
        ]
        rounding = 4e-15 * np.abs(list(fine.values())).max(axis=0) / h
        return derivatives[1], rounding + np.abs(derivatives[1] - derivatives[0])


def _energy_balance(state: State) -> Iterator[Finding]:
    """The rate of the energy is the sum of the powers."""
    kinds = ("kinetic", "strain", "gravity")
    rates, rounding = state.rate(lambda s: np.array([state.outputs(s)[f"corpus_energy_{kind}"] for kind in kinds]))
    now = state.outputs()
    powers = [now[f"corpus_power_{kind}"] for kind in ("loads", "drives", "dissipated")]
    error = abs(rates.sum() - sum(powers))
    scale = np.abs(rates).sum() + np.abs(powers).sum()
    idle = 1.0 + sum(abs(value_at(each, state.t)) for each in _given(state.scene))
    if not error <= LIMIT * scale + rounding.sum() + REST * idle:
        text = f"t = {state.t:g}: energies {rates} W, powers {powers} W, error {error / scale:.2g}"
        yield Finding("physics", "the rate of the energy is not the sum of the powers", text)
    total = sum(now[f"corpus_energy_{kind}"] for kind in kinds)
    size = sum(abs(now[f"corpus_energy_{kind}"]) for kind in kinds)
    if abs(total - now["corpus_energy_total"]) > 1e-12 * size + AT_REST:
        yield Finding("physics", "the total energy is not the sum of its parts", str(now))


def _given(scene: Scene) -> Iterator[Any]:
    """The components of all forces and torques, which work on the rounding errors of what they cannot move."""
    for force in scene.forces:
        yield from force.components
    for torque in scene.torques:
        yield torque.value


# ---- Newton's law ----


def _newton(state: State, model: Model) -> Iterator[Finding]:
    """The rates of linear and angular momentum are the forces and torques from outside.

    The momenta of bodies that push each other off cancel, and their rounding errors do not.
    """
    rate, error = state.rate(lambda s: state.native.momentum(*state.after(s)[1:], state.k))
    rounding = error + 4e-15 * summed_terms(model, "momentum", state.q, state.v, state.k) / state.step
    forces = [force for force in _forces(state) if force is not None]
    if len(forces) < len([*_forces(state)]):
        return
    total = np.array(forces).sum(axis=0) if forces else np.zeros(3)
    scale = np.abs(rate) + np.abs(np.array(forces)).sum(axis=0) if forces else np.abs(rate)
    size = np.abs(scale[:2]).sum()
    rows = 2 if _has_weight(state.scene) else 3
    limits = LIMIT * np.array([size, size, scale[2] + size]) + rounding
    for name, i in zip(("e1", "e2", "angular"), range(rows), strict=False):
        if not abs(rate[i] - total[i]) <= limits[i]:
            text = f"t = {state.t:g}: rate {rate}, forces {np.array(forces)}"
            yield Finding("physics", f"momentum and forces from outside disagree: {name}", text)


def _has_weight(scene: Scene) -> bool:
    """Whether forces act at points that the check does not know."""
    return scene.gravity is not None or any(isinstance(body, BeamBody) and body.loads for body in scene.bodies)


def _forces(state: State) -> Iterator[Vector | None]:
    """Force and moment about the origin of all that acts from outside; None for what the check cannot compute."""
    tables, scene, now = state.tables, state.scene, state.outputs()
    number = {marker: i for i, marker in enumerate(markers(tables))}

    def at(marker: str) -> Vector:
        return np.array([now[f"corpus_at{number[marker]}_{k}"] for k in (1, 2)])

    for section, kind in (("joints", "reaction"), ("springs", "spring")):
        for i, table in enumerate(tables.get(section, {}).values()):
            first, second = table["between"]
            if not any(marker.startswith("ground.") for marker in (first, second)):
                continue
            sign = -1 if second.startswith("ground.") else 1
            force = [now[f"corpus_{kind}{i}_{label}"] for label in ("1", "2", "torque")]
            yield sign * _wrench(at(second), np.array(force[:2]), force[2])
    for force in scene.forces:
        components = np.array([value_at(component, state.t) for component in force.components])
        if force.frame == "body":
            angle = now[f"corpus_turn{number[str(force.at)]}"]
            components = _rotated(components, angle)
        yield _wrench(at(str(force.at)), components, 0.0)
    for torque in scene.torques:
        value = value_at(torque.value, state.t)
        for marker, sign in ((torque.at, 1), (torque.against, -1)):
            if marker is not None and marker.body != GROUND:
                yield np.array([0.0, 0.0, sign * value])
    for body in scene.bodies:
        if scene.gravity is not None:
            yield np.array([*(_mass(body) * _value(g) for g in scene.gravity), math.nan])
        yield from _loads(state, body) if isinstance(body, BeamBody) else ()


def _wrench(at: Vector, force: Vector, torque: float) -> Vector:
    return np.array([*force, at[0] * force[1] - at[1] * force[0] + torque])


def _rotated(x: Vector, angle: float) -> Vector:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([c * x[0] - s * x[1], s * x[0] + c * x[1]])


def _value(quantity: Any) -> float:
    return 0.0 if quantity is None else float(getattr(quantity, "default", quantity))


def _mass(body: Any) -> float:
    if isinstance(body, BeamBody):
        return _value(body.beam.mass) + sum(_value(mass.mass) for mass in body.beam.masses)
    return _value(body.mass)


def _loads(state: State, body: BeamBody) -> Iterator[Vector | None]:
    """The resultants of distributed loads."""
    for load in body.loads:
        if load.frame == "body" and body.pieces > 1:
            yield None  # the frame of each piece has an angle of its own
            continue
        mean = [sum(Fraction(c) / (n + 1) for n, c in enumerate(of) if n % 2 == 0) for of in load.force]
        force = np.array([float(each) for each in mean]) * _value(body.beam.length) * value_at(load.time, state.t)
        if load.frame == "body":
            poses = state.native.poses(state.t, state.q, state.k)
            force = _rotated(force, poses[list(state.native.bodies).index(body.name)][2])
        yield np.array([*force, math.nan])
