"""A model as hosts need it: its C, and the names, units and start values of states, inputs, outputs and parameters."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import PurePosixPath

from derive.artifacts import File
from derive.display import html
from derive.ir.model import Model, Variable
from derive.mechanics.equations import Equations
from derive.mechanics.multibody.space.mechanism import AnyMechanism
from derive.notes.model_notes import limits
from derive.pipeline import generate
from derive.short_text import listed, record_text, summary
from derive.simulation.initial.start_state import start_state
from derive.simulation.linear.run_time_inputs import input_values
from derive.simulation.simulated_scene import simulated, surroundings
from derive.spec.model.beam_pieces import in_pieces
from derive.spec.model.body import NodalBody
from derive.spec.model.specification import AnyScene, Specification


@dataclass(frozen=True)
class HostVariable:
    """A scalar that a host sees: its name, its SI unit ("" without one), what it is, and its value at the start.

    Of an output the start is None, since it follows from the state. derivative: of an input, which time derivative of a
    prescribed motion it is, 0 for the motion itself and for all other inputs.
    """

    name: str
    unit: str
    doc: str
    start: float | None
    derivative: int = 0
    __repr__ = record_text


@dataclass(frozen=True)
class HostModel:
    """A model as hosts see it: names, units and start values of all that goes in and out, and the generated files.

    Attributes:
        name: the name of the model.
        spec: what was specified; a single beam is the scene of this beam, as in a simulation.
        derived: its equations, or its mechanism.
        model: its kernels and patterns.
        files: NAME/NAME.h, NAME/NAME.c and the manifest NAME/manifest.json, as `derive.model_files` makes them.
        coordinates: q (nq,) with the consistent initial state.
        velocities: v (nv,) likewise.
        inputs: u (nu,) with their values at t = 0; one that prescribes a motion is followed by its first two time
            derivatives.
        outputs: those of the model (nout,).
        parameters: p (np,) with their defaults.
        multipliers: lambda (nlambda,).
        notes: lines of text for the user.

    Examples:
        >>> import derive
        >>> beam = derive.planar_beam("beam")
        >>> host = derive.host_model(beam)
        >>> [(variable.name, variable.unit) for variable in host.parameters]
        [('m', 'kg'), ('l', 'm'), ('EI', 'N m^2')]
        >>> host.source.path
        'beam/beam.c'
    """

    name: str
    spec: AnyScene | NodalBody
    derived: Equations | AnyMechanism
    model: Model
    files: tuple[File, ...]
    coordinates: tuple[HostVariable, ...]
    velocities: tuple[HostVariable, ...]
    inputs: tuple[HostVariable, ...]
    outputs: tuple[HostVariable, ...]
    parameters: tuple[HostVariable, ...]
    multipliers: tuple[HostVariable, ...]
    notes: tuple[str, ...]

    @property
    def is_scene(self) -> bool:
        """Whether the C has the functions of a scene, which a body alone does not have."""
        return self.model.is_scene

    @property
    def states(self) -> tuple[HostVariable, ...]:
        """x = [q; v] (nq + nv,)."""
        return (*self.coordinates, *self.velocities)

    @property
    def constant_inputs(self) -> tuple[float, ...]:
        """The inputs u (nu,), constant at their start values: the time derivatives of motions are zero."""
        return tuple(0.0 if u.derivative else u.start or 0.0 for u in self.inputs)

    @property
    def header(self) -> File:
        """The header NAME.h."""
        return self._file(f"{self.name}.h")

    @property
    def source(self) -> File:
        """The source file NAME.c."""
        return self._file(f"{self.name}.c")

    @property
    def manifest(self) -> File:
        """The manifest, manifest.json."""
        return self._file("manifest.json")

    def _file(self, name: str) -> File:
        return next(file for file in self.files if PurePosixPath(file.path).name == name)

    def __repr__(self) -> str:
        return summary(
            f"HostModel {self.name}: {self.model.doc}",
            {
                "states": listed(variable.name for variable in self.states),
                "inputs": listed(variable.name for variable in self.inputs),
                "outputs": listed(variable.name for variable in self.outputs),
                "parameters": listed(variable.name for variable in self.parameters),
            },
        )

    _repr_html_ = html


def host_model(spec: Specification, sensitivities: bool = False) -> HostModel:
    """The model of a specification as hosts see it, with its consistent initial state.

    Arguments:
        spec: a scene, a beam or a finite-element body.
        sensitivities: whether the model has the kernels of derivatives, see `derive.lower`.

    Raises:
        SpecError: if the specification is not valid.
        SimulationError: where there is no initial state, as `simulate` does.
        TypeError: for anything but a specification that can be simulated.

    Examples:
        >>> import derive
        >>> ball = derive.scene("ball", bodies={"ball": {"mass": 1, "inertia": 1, "start": {"velocity": (3, 4)}}})
        >>> host = derive.host_model(ball)
        >>> [(variable.name, variable.start) for variable in host.velocities]
        [('ball_c1dot', 3.0), ('ball_c2dot', 4.0), ('ball_phidot', 0.0)]
    """
    mechanism = in_pieces(simulated(spec, lacking="it has no initial state for a host to start from"))
    values = input_values(surroundings(mechanism), 0.0)
    result = generate(mechanism, sensitivities, ("c",), start_needed=True)
    model = result.model
    start = model.start or start_state(mechanism, model)
    return HostModel(
        mechanism.name,
        mechanism,
        result.derived,
        model,
        result.files,
        _scalars(model.coordinates, start.q),
        _scalars(model.velocities, start.v),
        _inputs(model, values),
        _scalars(model.outputs, None),
        _scalars(model.parameters, model.defaults),
        _scalars(model.multipliers, None),
        tuple(_notes(mechanism)),
    )


def _inputs(model: Model, values: Sequence[Sequence[float]]) -> tuple[HostVariable, ...]:
    """The inputs with their values at t = 0; the numbers of an input that prescribes a motion are its derivatives."""
    numbers = [(order, number) for of_input in values for order, number in enumerate(of_input)]
    variables = _scalars(model.inputs, [number for _, number in numbers])
    return tuple(replace(u, derivative=order) for u, (order, _) in zip(variables, numbers, strict=True))


def _scalars(variables: Sequence[Variable], values: Sequence[float] | None) -> tuple[HostVariable, ...]:
    """The elements of variables with their values; those of an array are numbered from 1, as in the descriptor."""
    elements = [(name, variable) for variable in variables for name in variable.elements]
    starts = [None] * len(elements) if values is None else values
    return tuple(
        HostVariable(name, "" if variable.unit == "1" else variable.unit, variable.doc, start)
        for (name, variable), start in zip(elements, starts, strict=True)
    )


def _notes(spec: AnyScene | NodalBody) -> Iterator[str]:
    """Notes for the user: inputs without a value, and limits of the model."""
    for value in surroundings(spec).inputs:
        if value.function is None:
            yield f"inputs.{value.name}: no value is given; it is 0 in the initial state, and the host sets it"
    yield from limits(spec)
