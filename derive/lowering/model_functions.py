"""The table of the functions of a model: names, documentation, arguments and outputs.

Both lowerings build their kernels from this table, so that a model has the same functions in either. To add a function,
add a kind, its description in `functions_of`, and an implementation in each lowering.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from enum import Enum

from derive.ir.model import JACOBIAN, PARAMETER_JACOBIAN
from derive.ir.patterns import Pattern
from derive.mechanics.equations import Equations
from derive.mechanics.terms import SpatialPose


class FunctionKind(Enum):
    """The kind of a function; the value is its name in the generated code, to which the variant is appended."""

    MASS = "mass"
    FORCE = "force"
    MASS_FORCE = "mass_force"
    ACCEL = "accel"
    ENERGY = "energy"
    MOMENTUM = "momentum"
    RATES = "rates"
    MARKER = "marker"
    LOAD = "load"
    CONSTRAINTS = "constraints"
    CONSTRAINT_RATES = "constraint_rates"
    CONSTRAINT_JACOBIAN = "constraint_jacobian"
    CONSTRAINT_BIAS = "constraint_bias"
    SOLVE = "solve"
    PROJECT_VELOCITY = "project_velocity"
    POSES = "poses"
    OUTPUTS = "outputs"
    OUTPUTS_JACOBIAN = "outputs_jacobian"
    RESIDUAL = "residual"
    JACOBIAN = JACOBIAN
    PARAMETER_JACOBIAN = PARAMETER_JACOBIAN
    SOLVE_KKT = "solve_kkt"
    INVERSE_DYNAMICS = "inverse_dynamics"
    GRAVITY_COMPENSATION = "gravity_compensation"
    CENTRE_OF_MASS = "centre_of_mass"
    CENTROIDAL_MOMENTUM = "centroidal_momentum"
    ROTATION = "rotation"
    INVERSE_DYNAMICS_JACOBIAN = "inverse_dynamics_jacobian"
    GRAVITY_COMPENSATION_JACOBIAN = "gravity_compensation_jacobian"
    CENTRE_OF_MASS_JACOBIAN = "centre_of_mass_jacobian"
    CENTROIDAL_MOMENTUM_JACOBIAN = "centroidal_momentum_jacobian"
    ROTATION_JACOBIAN = "jacobian_of_rotation"


@dataclass(frozen=True)
class ModelFunction:
    """A function of a model.

    arguments: their names. outputs: the documentation of each output, by name. variant: the marker of a `MARKER`,
    `LOAD` or `ROTATION`, or the form of a `RESIDUAL` or `JACOBIAN` of a mechanism, a key of `FORMS`; otherwise empty.
    """

    kind: FunctionKind
    doc: str
    arguments: tuple[str, ...]
    outputs: Mapping[str, str]
    variant: str = ""

    @property
    def name(self) -> str:
        """The name in the generated code, without the name of the model."""
        return f"{self.kind.value}_{self.variant}" if self.variant else self.kind.value


@dataclass(frozen=True)
class OutputElements:
    """The elements of one output of a function, as a lowering produces them.

    names: the names of the elements or, if `count` is given, descriptions of groups that have `count` elements in all.
    pattern: the sparsity pattern, if the output is a matrix.
    """

    names: tuple[str, ...]
    pattern: Pattern | None = None
    count: int | None = None


FORMS = {
    "": "index 3: [qdot - v; M vdot + h - G^T lambda; g]",
    "ggl": "stabilised index 2: [qdot - v + G^T mu; M vdot + h - G^T lambda; gdot; g]",
    "index1": "index 1: [qdot - v; M vdot + h - G^T lambda; G vdot - gamma]",
}
"""The forms F(t, y, ydot) = 0 of the equations of a mechanism; "ggl" is that of Gear, Gupta & Leimkuhler."""

IMPLICIT = frozenset((FunctionKind.RESIDUAL, FunctionKind.JACOBIAN, FunctionKind.LOAD, FunctionKind.OUTPUTS_JACOBIAN))
"""The functions that explicit integration does not call; lowering them takes longer than lowering all others."""

STATE, TIMED = ("q", "v", "k"), ("t", "q", "v", "k")
MASS_OUTPUT = {"M": "values of the mass matrix, lower triangle by columns"}
FORCE_OUTPUT = {"h": "forces, one for each equation of motion"}
VDOT = {"vdot": "accelerations"}
POSES = "c1, c2 [m] and phi [rad] of each body"
POSES_IN_SPACE = "c1, c2, c3 [m] and the rotation tensor Q by rows, of each body"
RESIDUAL = {"F": "residual, one for each state"}
ITERATION_MATRIX = {"jac": "values of the iteration matrix by columns"}


def functions_of(
    equations: Equations, sensitivities: bool = False, explicit: bool = False, balanced: bool = False
) -> tuple[ModelFunction, ...]:
    """All functions of a model, in the order of the generated code; `sensitivities` adds those for derivatives.

    explicit: without those of `IMPLICIT`; balanced: but with the iteration matrix, of which equilibria and steady
    motions are computed.
    """
    mechanism = bool(equations.poses)
    in_space = any(isinstance(pose, SpatialPose) for pose in equations.poses)
    specific = (
        _of_mechanisms(bool(equations.outputs), POSES_IN_SPACE if in_space else POSES) if mechanism else _of_bodies()
    )
    every = (*_dynamics(mechanism), *_invariants(equations, mechanism), *_of_markers(equations), *specific)
    if sensitivities:
        every += tuple(_of_sensitivities(mechanism))
    if explicit:
        kept = {JACOBIAN} if balanced else set()
        every = tuple(function for function in every if function.kind not in IMPLICIT or function.name in kept)
    return tuple(map(with_inputs, every)) if equations.inputs else every


def with_inputs(function: ModelFunction) -> ModelFunction:
    """A function that depends on the time depends on the inputs u as well, an argument before the constants k."""
    if "t" not in function.arguments:
        return function
    k = function.arguments.index("k")
    return replace(function, arguments=(*function.arguments[:k], "u", *function.arguments[k:]))


def _dynamics(mechanism: bool) -> Iterator[ModelFunction]:
    """The functions for M, h and the accelerations."""
    kind = FunctionKind
    law = "M vdot + h = G^T lambda" if mechanism else "M vdot + h = 0"
    applied = ", damping, gravity, springs and applied loads" if mechanism else ", damping and gravity"
    forces = f"Forces h of {law}: centrifugal, Coriolis, elastic{applied}."
    both = "Mass matrix and forces together; what they share is computed once."
    accelerations = (
        f"Accelerations vdot of {law}, G vdot = gamma; `solve` gives lambda as well."
        if mechanism
        else f"Accelerations vdot of {law}"
    )
    yield ModelFunction(
        kind.MASS, "Mass matrix M(q): values of the lower triangle by columns.", ("q", "k"), MASS_OUTPUT
    )
    yield ModelFunction(kind.FORCE, forces, TIMED, FORCE_OUTPUT)
    yield ModelFunction(kind.MASS_FORCE, both, TIMED, MASS_OUTPUT | FORCE_OUTPUT)
    yield ModelFunction(kind.ACCEL, accelerations, TIMED, VDOT)


def _invariants(equations: Equations, mechanism: bool) -> Iterator[ModelFunction]:
    """The functions for energies, momenta, and the time derivatives of the coordinates."""
    springs = " (with that of springs)" if mechanism else ""
    gravity = ", and the potential of gravity" if equations.weight_energy is not None else ""
    energies, momenta = {"energy": "energies [J]"}, {"momentum": "linear [N s] and angular [N m s]"}
    about = "Linear momentum, and angular momentum about the inertial origin."
    rates = "Time derivatives of the generalised coordinates from the generalised velocities."
    yield ModelFunction(FunctionKind.ENERGY, f"Kinetic and strain energy{springs}{gravity}.", STATE, energies)
    yield ModelFunction(FunctionKind.MOMENTUM, about, STATE, momenta)
    yield ModelFunction(FunctionKind.RATES, rates, STATE, {"qdot": "time derivative of q"})


def _of_markers(equations: Equations) -> Iterator[ModelFunction]:
    """The functions for the motion of each marker, then those for the generalised forces of a load at each."""
    outputs = {
        "x": "position in the inertial frame [m]",
        "xdot": "velocity in the inertial frame [m/s]",
        "jacobian": "values of d(velocity)/dv by columns",
    }
    for m in equations.markers:
        doc = f"Marker {m.name}, {m.doc}: position, velocity and its Jacobian d(velocity)/dv."
        yield ModelFunction(FunctionKind.MARKER, doc, STATE, outputs, m.name)
    for m in equations.markers:
        doc = f"Generalised forces f of a force at marker {m.name}: then M vdot + h = f."
        forces = {"f": "generalised forces, one for each equation of motion"}
        yield ModelFunction(FunctionKind.LOAD, doc, ("q", "F", "k"), forces, m.name)


def _of_bodies() -> Iterator[ModelFunction]:
    """The functions for the first-order form of a free body."""
    form = "First-order form F(t, y, ydot) = [qdot - v; M vdot + h] = 0 with y = [q; v]."
    matrix = "Iteration matrix dF/dy + cj dF/dydot of the first-order form, values by columns, diagonal included."
    yield ModelFunction(FunctionKind.RESIDUAL, form, ("t", "y", "ydot", "k"), RESIDUAL)
    yield ModelFunction(FunctionKind.JACOBIAN, matrix, ("t", "y", "ydot", "cj", "k"), ITERATION_MATRIX)


def _of_sensitivities(mechanism: bool) -> Iterator[ModelFunction]:
    """The functions for derivatives with respect to parameters and inputs, and for solutions with the KKT matrix."""
    rows = "M vdot + h - G^T lambda, g, gdot, G vdot - gamma and the outputs" if mechanism else "M vdot + h"
    columns = "the parameters and the inputs" if mechanism else "the parameters"
    state = "[q; v; lambda]" if mechanism else "[q; v]"
    doc = f"Derivatives of {rows} with respect to {columns}, at fixed t, y = {state} and ydot: values by columns."
    values = {"jac": "values of the derivatives by columns"}
    yield ModelFunction(FunctionKind.PARAMETER_JACOBIAN, doc, ("t", "y", "ydot", "k"), values)
    yield ModelFunction(
        FunctionKind.SOLVE_KKT,
        f"Solution of {'M x - G^T lambda = a, G x = b' if mechanism else 'M x = a; b and lambda are empty'}",
        ("t", "q", "k", "a", "b"),
        {"x": "one value for each generalised velocity", "lam": "one value for each constraint"},
    )


def _of_mechanisms(outputs: bool, pose: str) -> Iterator[ModelFunction]:
    """The functions for constraints, multipliers, poses, outputs, and the forms for implicit integrators."""
    kind, timed = FunctionKind, ("t", "q", "k")
    yield ModelFunction(kind.CONSTRAINTS, "Constraints g(t, q) = 0.", timed, {"g": "residuals of the constraints"})
    yield ModelFunction(
        kind.CONSTRAINT_RATES,
        "Time derivatives of the constraints, gdot = G v + dg/dt.",
        TIMED,
        {"gdot": "time derivatives of the constraints"},
    )
    yield ModelFunction(
        kind.CONSTRAINT_JACOBIAN,
        "Jacobian G = d gdot / dv of the constraints: values by columns.",
        timed,
        {"G": "values of G by columns"},
    )
    yield ModelFunction(
        kind.CONSTRAINT_BIAS,
        "Right-hand side gamma of the constraints on accelerations, G vdot = gamma.",
        TIMED,
        {"gamma": "right-hand side of G vdot = gamma"},
    )
    yield ModelFunction(
        kind.SOLVE,
        "Accelerations vdot and multipliers lambda of M vdot + h = G^T lambda, G vdot = gamma.",
        TIMED,
        VDOT | {"lam": "constraint reactions on body 2 of each joint"},
    )
    yield ModelFunction(
        kind.PROJECT_VELOCITY,
        "The smallest change dv of the generalised velocities, in the metric of M, with G dv = r: r = -gdot projects "
        "velocities onto the constraints; r = -g, repeated, projects coordinates.",
        ("t", "q", "k", "r"),
        {"dv": "change of the generalised velocities"},
    )
    yield ModelFunction(
        kind.POSES,
        "Position of the origin and rotation of the frame of every body, including bodies without coordinates.",
        timed,
        {"pose": pose},
    )
    if outputs:
        arguments = ("t", "q", "v", "vdot", "lam", "k")
        yield ModelFunction(kind.OUTPUTS, "The outputs of the scene.", arguments, {"out": "values of the outputs"})
        yield ModelFunction(
            kind.OUTPUTS_JACOBIAN,
            "Derivatives of the outputs with respect to [q; v; vdot; lambda; u]: values by columns.",
            arguments,
            {"jac": "values of the Jacobian by columns"},
        )
    for form, text in FORMS.items():
        residual = f"Residual F(t, y, ydot) of {text}."
        matrix = f"Iteration matrix dF/dy + cj dF/dydot of {text}: values by columns, diagonal included."
        yield ModelFunction(kind.RESIDUAL, residual, ("t", "y", "ydot", "k"), RESIDUAL, form)
        yield ModelFunction(kind.JACOBIAN, matrix, ("t", "y", "ydot", "cj", "k"), ITERATION_MATRIX, form)
