"""The functions that a model has on request: what robots and their controllers need, and simulations do not.

They are a fifth of the operations of a model and would lengthen the compilation of every one. Straight-line code has
them; with sensitivities it has their derivatives as well.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

from derive.function_names import ON_REQUEST
from derive.lowering.model_functions import STATE, FunctionKind, ModelFunction, with_inputs
from derive.mechanics.equations import Equations

JACOBIANS = {
    FunctionKind.INVERSE_DYNAMICS: FunctionKind.INVERSE_DYNAMICS_JACOBIAN,
    FunctionKind.GRAVITY_COMPENSATION: FunctionKind.GRAVITY_COMPENSATION_JACOBIAN,
    FunctionKind.CENTRE_OF_MASS: FunctionKind.CENTRE_OF_MASS_JACOBIAN,
    FunctionKind.CENTROIDAL_MOMENTUM: FunctionKind.CENTROIDAL_MOMENTUM_JACOBIAN,
    FunctionKind.ROTATION: FunctionKind.ROTATION_JACOBIAN,
}
"""The functions of their derivatives."""

REQUESTED = dict(zip(ON_REQUEST, JACOBIANS, strict=True))
"""The functions by the names with which they are requested."""

DIFFERENTIATED: Mapping[FunctionKind, tuple[str, ...]] = {
    FunctionKind.INVERSE_DYNAMICS: ("f",),
    FunctionKind.GRAVITY_COMPENSATION: ("f",),
    FunctionKind.CENTRE_OF_MASS: ("x", "xdot"),
    FunctionKind.CENTROIDAL_MOMENTUM: ("momentum",),
    FunctionKind.ROTATION: ("omega",),
}
"""The outputs whose derivatives these have."""

FORCES = {"f": "generalised forces, one for each equation of motion"}


def requested_functions(
    equations: Equations, names: Collection[str], sensitivities: bool = False
) -> tuple[ModelFunction, ...]:
    """The functions with these names that the equations allow; `sensitivities` adds their derivatives."""
    kinds = {REQUESTED[name] for name in names}
    result: list[ModelFunction] = []
    for function in (f for f in (*_of_forces(equations), *_of_motion(equations)) if f.kind in kinds):
        timed = with_inputs(function) if equations.inputs else function
        result += [timed, _jacobian(timed, bool(equations.inputs))] if sensitivities else [timed]
    return tuple(result)


def has_mass(equations: Equations) -> bool:
    """Whether there are bodies with a centre of mass: with coordinates, and moved by no drive."""
    return bool(equations.mass_moments) and equations.mass_moments[0] != 0


def _of_forces(equations: Equations) -> Iterator[ModelFunction]:
    reactions = ", reactions of the constraints among them" if equations.constraints else ""
    doc = f"Inverse dynamics: the generalised forces f = M vdot + h that a motion needs{reactions}."
    yield ModelFunction(FunctionKind.INVERSE_DYNAMICS, doc, ("t", "q", "v", "vdot", "k"), FORCES)
    doc = f"Generalised forces f = h(t, q, v = 0) that hold the model still{reactions}."
    yield ModelFunction(FunctionKind.GRAVITY_COMPENSATION, doc, ("t", "q", "k"), FORCES)


def _of_motion(equations: Equations) -> Iterator[ModelFunction]:
    of = " of the bodies with coordinates" if equations.poses else ""
    place = {
        "x": "position in the inertial frame [m]",
        "xdot": "velocity in the inertial frame [m/s]",
        "jacobian": "values of d(velocity)/dv by columns",
        "m_total": "mass [kg]",
    }
    momentum = {"momentum": "linear [N s] and angular [N m s]", "A": "values of A by columns"}
    if has_mass(equations):
        doc = f"Centre of mass{of}: position, velocity and its Jacobian d(velocity)/dv; and the mass."
        yield ModelFunction(FunctionKind.CENTRE_OF_MASS, doc, STATE, place)
        doc = f"Linear momentum{of}, and angular momentum about their centre of mass, as A(q) v."
        yield ModelFunction(FunctionKind.CENTROIDAL_MOMENTUM, doc, STATE, momentum)
    spin = {
        "omega": "angular velocity in the inertial frame [rad/s]",
        "jacobian": "values of d(angular velocity)/dv by columns",
    }
    for m in equations.markers:
        if m.angular_velocity is not None:
            doc = f"Marker {m.name}, {m.doc}: angular velocity of its frame and the Jacobian d(angular velocity)/dv."
            yield ModelFunction(FunctionKind.ROTATION, doc, STATE, spin, m.name)


def _jacobian(function: ModelFunction, inputs: bool) -> ModelFunction:
    """The function of the derivatives of another one with respect to its arguments, the parameters and the inputs."""
    rows = " and ".join(DIFFERENTIATED[function.kind])
    state = [name for name in function.arguments if name in ("q", "v", "vdot")]
    columns = "; ".join([*state, "p", *(["u"] if inputs else [])])
    doc = f"Derivatives of {rows} of {function.name} with respect to [{columns}]: values by columns."
    values = {"jac": "values of the derivatives by columns"}
    return ModelFunction(JACOBIANS[function.kind], doc, function.arguments, values, function.variant)
