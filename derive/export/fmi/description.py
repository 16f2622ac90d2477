"""The description of a unit for importers: its variables, their units, and their dependencies on states and inputs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate

from derive.artifacts import MARK
from derive.export.fmi.binaries import c_files
from derive.export.fmi.variables import Causality, FmiVariable, fmi_variables
from derive.export.host_model import HostModel
from derive.ir.patterns import Pattern
from derive.rendering import render
from derive.spec.model.simulation import Simulation
from derive.spec.parsing.units import UnknownUnit, unit_size
from derive.version import VERSION

ANGULAR = {"rad": 1, "rad/s": 1, "rad/s^2": 1}
"""The power of the angle, which `unit_size` takes as a number, in the units of angles and their rates."""

NO_SIMULATION = Simulation(duration=1.0, output=0.01)
"""The default experiment of a specification that describes none."""


@dataclass(frozen=True)
class UnitDefinition:
    """A unit: its name, its size in base units and their powers that are not zero; none where it is not known."""

    name: str
    factor: float
    powers: tuple[tuple[str, int], ...]
    known: bool = True


def default_experiment(model: HostModel) -> Simulation:
    """The simulation of the specification, whose settings importers may change."""
    return model.spec.simulation or NO_SIMULATION


def descriptions(model: HostModel, version: int, token: str, sources: Sequence[str]) -> Iterator[tuple[str, str]]:
    """The paths and texts of the descriptions of a unit for importers."""
    variables, simulation = fmi_variables(model), default_experiment(model)
    values = {
        "mark": MARK,
        "name": model.name,
        "title": model.model.doc,
        "tool": f"Tisserand {VERSION}",
        "token": token,
        "sources": c_files(sources),
        "units": _unit_definitions(x.unit for x in variables),
        "variables": variables,
        "structure": _structure(variables),
        "dependencies": dependencies(model),
        "duration": simulation.duration,
        "interval": simulation.output,
        "tolerance": simulation.tolerance,
        "derivatives": model.model.sensitivities,
        "number": repr,
    }
    yield "modelDescription.xml", render(f"export/fmi/modelDescription{version}.xml.jinja", values)
    if version == 3:
        yield "sources/buildDescription.xml", render("export/fmi/buildDescription.xml.jinja", values)


def _structure(variables: Sequence[FmiVariable]) -> dict[str, list[FmiVariable]]:
    """The variables that depend on others: outputs, derivatives, and all that the initialisation computes."""
    outputs = [x for x in variables if x.causality is Causality.OUTPUT]
    derivatives = [x for x in variables if x.derivative_of is not None]
    initial = [x for x in variables if x.state or x.derivative_of is not None or x.causality is Causality.OUTPUT]
    return {"Outputs": outputs, "Derivatives": derivatives, "InitialUnknowns": initial}


def _unit_definitions(names: Iterable[str]) -> tuple[UnitDefinition, ...]:
    """The definitions of all units that occur, in the order of their names."""
    return tuple(_defined(name) for name in sorted({*names} - {""}))


def _defined(name: str) -> UnitDefinition:
    try:
        size = unit_size(name)
    except UnknownUnit:
        return UnitDefinition(name, 1.0, (), False)
    length, mass, time = size.dimension
    powers = {"kg": mass, "m": length, "s": time, "rad": ANGULAR.get(name, 0)}
    return UnitDefinition(name, size.scale, tuple((base, power) for base, power in powers.items() if power))


def dependencies(model: HostModel) -> dict[int, tuple[int, ...]]:
    """The value references on which variables depend, in order, by the value reference of the variable.

    A derivative of a state or an output that is missing depends on the accelerations or multipliers, and so on all
    states, all inputs and the time. Dependencies are those of the sparsity, so that some may have no effect.
    """
    nq, nx, nu, nout = len(model.coordinates), len(model.states), len(model.inputs), len(model.outputs)
    nv, ends = nx - nq, [*accumulate((1, nu, len(model.parameters), nx, nx), initial=0)]
    _, first_input, _, first_state, first_derivative, first_output = ends
    jacobian = model.model.pattern("jacobian_index1" if model.is_scene else "jacobian", "jac")
    result = {
        first_derivative + row: tuple(first_state + j for j in columns)
        for row, columns in _by_row(jacobian, range(nq)).items()
    }
    if nout:
        timed = (0,) if "t" in model.model.kernel("outputs").used else ()
        behind = nx + nv + len(model.multipliers)
        for row, columns in _by_row(model.model.pattern("outputs_jacobian", "jac"), range(nout)).items():
            if not any(nx <= j < behind for j in columns):
                inputs = (first_input + j - behind for j in columns if j >= behind)
                result[first_output + row] = (*timed, *inputs, *(first_state + j for j in columns if j < nx))
    return result


def _by_row(pattern: Pattern, rows: Iterable[int]) -> dict[int, list[int]]:
    """The columns of the entries of each row."""
    result: dict[int, list[int]] = {row: [] for row in rows}
    for column, (begin, end) in enumerate(zip(pattern.colptr[:-1], pattern.colptr[1:], strict=True)):
        for row in pattern.rowidx[begin:end]:
            if row in result:
                result[row].append(column)
    return result
