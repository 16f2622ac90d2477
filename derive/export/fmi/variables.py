"""The variables of functional mock-up units: structured names, causality and value references."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from itertools import chain

from derive.algebra import sp
from derive.errors import Problem, SpecError
from derive.export.host_model import HostModel, HostVariable
from derive.mechanics.equations import Equations
from derive.mechanics.multibody.mechanism import Mechanism
from derive.mechanics.multibody.space.mechanism import AnyMechanism
from derive.mechanics.multibody.space.outputs import SPATIAL_OUTPUTS
from derive.mechanics.symbols import DOTS, Identity, identity, is_indexed
from derive.simulation.scene_start import size_of
from derive.spec.model.scene import Scene
from derive.spec.model.spatial_scene import SpatialScene

ANGULAR = ("", "rad", "rad/s")
"""The units of states that are no lengths or speeds: angles, quaternions, angular velocities."""


class Causality(Enum):
    """The causality of a variable; the value is its name in both versions of FMI."""

    INDEPENDENT = "independent"
    INPUT = "input"
    PARAMETER = "parameter"
    LOCAL = "local"
    OUTPUT = "output"


WRITTEN = (Causality.INPUT, Causality.PARAMETER, Causality.OUTPUT)
"""The causality of variables whose names are in the specification."""


@dataclass(frozen=True)
class FmiVariable:
    """A scalar of a unit.

    name: structured, such as rod.alpha[1] or der(rod.alpha[1]). reference: its value reference. unit: that of SI, ""
    without one. start: of inputs, parameters and states. derivative_of: the reference of the state whose time
    derivative it is. nominal: of a continuous state its size, None of others.
    """

    name: str
    reference: int
    causality: Causality
    unit: str
    doc: str
    start: float | None = None
    derivative_of: int | None = None
    nominal: float | None = None

    @property
    def state(self) -> bool:
        """Whether the variable is a continuous state."""
        return self.nominal is not None

    @property
    def variability(self) -> str | None:
        """The variability: parameters can be set between steps (tunable), all other variables are continuous."""
        return "tunable" if self.causality is Causality.PARAMETER else "continuous"

    @property
    def initial(self) -> str | None:
        """The meaning of the start value: that of a state is approximate, as the constraints may change it."""
        if self.state:
            return "approx"
        return "exact" if self.causality is Causality.PARAMETER else None


def nominals(model: HostModel) -> tuple[float, ...]:
    """The sizes of the states, for tolerances: lengths have that of the scene, at most 1 m, and all others 1."""
    length = min(1.0, size_of(model.spec)) if isinstance(model.spec, (Scene, SpatialScene)) else 1.0
    return tuple(1.0 if x.unit in ANGULAR else length for x in model.states)


def fmi_variables(model: HostModel) -> tuple[FmiVariable, ...]:
    """All variables of a model, in the order of the value references of `templates/export/fmi/instance.h`.

    Names of the specification stay. Another one that is taken, such as energy.kinetic beside an output energy, is put
    behind the name of the model. Raises SpecError where two of the specification are one.
    """
    derived = model.derived
    states, multipliers, outputs = _names_of_states(derived), [], []
    if not isinstance(derived, Equations):
        multipliers = _names_of_multipliers(derived)
        outputs = _output_names(derived)
    parts = model.model.kernel("energy").outputs[0].elements
    energies = [HostVariable(f"energy.{part}", "J", f"{part} energy", None) for part in parts]
    first_state = 1 + len(model.inputs) + len(model.parameters)
    local, every = Causality.LOCAL, list[FmiVariable]()

    def add(names: Iterable[str], given: Sequence[HostVariable], causality: Causality) -> None:
        for name, x in zip(names, given, strict=True):
            every.append(FmiVariable(name, len(every), causality, x.unit, x.doc, x.start))

    add(["time"], [HostVariable("time", "s", "time", None)], Causality.INDEPENDENT)
    add((u.name for u in model.inputs), model.inputs, Causality.INPUT)
    add((p.name for p in model.parameters), model.parameters, Causality.PARAMETER)
    add(states, model.states, local)
    every[first_state:] = [
        replace(x, nominal=size) for x, size in zip(every[first_state:], nominals(model), strict=True)
    ]
    for k, (name, x) in enumerate(zip(states, model.states, strict=True)):
        unit, doc = _rate_unit(x.unit), f"time derivative of {name}"
        every.append(FmiVariable(f"der({name})", len(every), local, unit, doc, None, first_state + k))
    add(outputs, model.outputs, Causality.OUTPUT)
    add((x.name for x in energies), energies, local)
    add(multipliers, model.multipliers, local)
    written = [x for x in every if x.causality in WRITTEN]
    first: dict[str, FmiVariable] = {}
    for variable in written:
        other = first.setdefault(variable.name, variable)
        if other is not variable:
            what = f"{variable.name} is the name of the {other.causality.value} and of the {variable.causality.value}"
            raise SpecError(
                (Problem("", f"{what}, but all names of a functional mock-up unit differ; rename one"),), None
            )
    return tuple(x if x in written else replace(x, name=_free_name(x.name, model.name, first)) for x in every)


def _free_name(name: str, model: str, taken: Container[str]) -> str:
    """A name that no other variable has: behind that of the model if it is taken."""
    while name in taken:
        name = f"{model}.{name}"
    return name


def _rate_unit(unit: str) -> str:
    """The unit of a time derivative."""
    known = {"": "1/s", "m/s": "m/s^2", "rad/s": "rad/s^2", "1/s": "1/s^2"}
    return known.get(unit, f"{unit}/s")


def _names_of_states(derived: Equations | AnyMechanism) -> list[str]:
    symbols = chain((c.q for c in derived.coordinates), (row.v for row in derived.rows))
    modes = derived.modes if isinstance(derived, Equations) else 0
    return [_structured(part) for symbol in symbols for part in _elements(symbol, modes)]


def _elements(symbol: sp.Basic, modes: int) -> Iterator[Identity]:
    """The identity of a symbol, or those of all shapes that a generic symbol stands for."""
    known = identity(symbol)
    if is_indexed(symbol):
        yield from (replace(known, shapes=(shape,)) for shape in range(1, modes + 1))
    else:
        yield known


def _structured(known: Identity) -> str:
    """A name such as rod.alpha[1]."""
    indices = ",".join(map(str, (*known.shapes, *known.components)))
    stem = f"{known.family.stem}{DOTS[known.derivative]}"
    return f"{known.owner}{'.' if known.owner else ''}{stem}{f'[{indices}]' if indices else ''}"


def _names_of_multipliers(mechanism: AnyMechanism) -> list[str]:
    """The multipliers of each joint and of its drive, counted from 1, and those of gears."""
    of_joints = [f"{j.joint.name}.lambda[{k}]" for j in mechanism.joints for k in range(1, j.multipliers + 1)]
    if isinstance(mechanism, Mechanism):
        return of_joints
    of_drives = [f"{j.joint.name}.lambda[1]" for j in mechanism.eliminated_joints if j.drive and j.keeps_coordinate]
    return [*of_joints, *of_drives, *(f"{gear.gear.name}.lambda" for gear in mechanism.gears)]


def _output_names(mechanism: AnyMechanism) -> list[str]:
    """The components of each output: tip[1] and tip[2] where these are along axes, else support.torque."""
    if isinstance(mechanism, Mechanism):
        labelled = [(output.name, output.type.labels) for output in mechanism.outputs]
    else:
        labelled = [(output.name, SPATIAL_OUTPUTS[output.kind].labels) for output in mechanism.scene.outputs]
    return [
        name + (f"[{label}]" if label.isdecimal() else f".{label}" if label else "")
        for name, labels in labelled
        for label in labels
    ]
