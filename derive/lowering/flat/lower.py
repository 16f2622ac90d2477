"""The lowering of expanded equations to kernels of straight-line code."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import replace

from derive.ir.kernel import Kernel
from derive.ir.model import Model, Variable, Zero
from derive.lowering.attitude import with_attitude_check
from derive.lowering.elimination_orders import EliminationRule
from derive.lowering.flat import accelerations, body_functions, constraints, dae, outputs
from derive.lowering.flat.context import Context
from derive.lowering.flat.kkt_matrix import kkt
from derive.lowering.flat.motion_quantities import (
    QUANTITIES,
    requested_derivatives,
    requested_function,
    with_mass_reciprocal,
)
from derive.lowering.flat.sensitivities import parameter_jacobian, solve_kkt, with_derivatives
from derive.lowering.flat.setup import setup_kernel
from derive.lowering.model_functions import FunctionKind, ModelFunction, functions_of
from derive.lowering.model_tables import (
    coordinate_variables,
    eliminated_parts,
    marker_variables,
    multiplier_variables,
    named_splines,
    parameter_variables,
    port_variables,
    velocity_variables,
)
from derive.lowering.requested_functions import JACOBIANS, requested_functions
from derive.lowering.terms import model_terms
from derive.mechanics.equations import Equations
from derive.mechanics.terms import SpatialPose

Implementation = Callable[[Context, ModelFunction], Kernel]

OF_BODIES: Mapping[FunctionKind, Implementation] = {
    FunctionKind.MASS: body_functions.mass,
    FunctionKind.FORCE: body_functions.force,
    FunctionKind.MASS_FORCE: body_functions.mass_force,
    FunctionKind.ACCEL: accelerations.accel,
    FunctionKind.ENERGY: body_functions.energy,
    FunctionKind.MOMENTUM: body_functions.momentum,
    FunctionKind.RATES: body_functions.rates,
    FunctionKind.MARKER: body_functions.marker,
    FunctionKind.LOAD: body_functions.load,
    FunctionKind.RESIDUAL: body_functions.residual,
    FunctionKind.JACOBIAN: body_functions.jacobian,
    FunctionKind.PARAMETER_JACOBIAN: parameter_jacobian,
    FunctionKind.SOLVE_KKT: solve_kkt,
    **dict.fromkeys(QUANTITIES, requested_function),
    **dict.fromkeys(JACOBIANS.values(), requested_derivatives),
}
OF_MECHANISMS: Mapping[FunctionKind, Implementation] = {
    FunctionKind.ACCEL: constraints.accelerations,
    FunctionKind.CONSTRAINTS: constraints.constraints,
    FunctionKind.CONSTRAINT_RATES: constraints.constraint_rates,
    FunctionKind.CONSTRAINT_JACOBIAN: constraints.constraint_jacobian,
    FunctionKind.CONSTRAINT_BIAS: constraints.constraint_bias,
    FunctionKind.SOLVE: constraints.accelerations_and_multipliers,
    FunctionKind.PROJECT_VELOCITY: constraints.project_velocity,
    FunctionKind.POSES: constraints.poses,
    FunctionKind.OUTPUTS: outputs.outputs,
    FunctionKind.OUTPUTS_JACOBIAN: outputs.outputs_jacobian,
    FunctionKind.RESIDUAL: dae.residual,
    FunctionKind.JACOBIAN: dae.jacobian,
}
"""The functions that only mechanisms have, and those that depend on constraints."""
FORMED = frozenset((FunctionKind.RESIDUAL, FunctionKind.JACOBIAN))
"""The functions of which mechanisms have several forms, which differ in the equations of constraints."""


def lower(
    equations: Equations,
    choice: str = "",
    elimination: EliminationRule = EliminationRule.SAFE,
    sensitivities: bool = False,
    explicit: bool = False,
    balanced: bool = False,
    proximal: bool = False,
    requested: Collection[str] = (),
) -> Model:
    """The model, with all of its kernels, from its expanded equations.

    choice: the reason why the model has straight-line code; elimination: the order of the KKT matrix;
    sensitivities: with the derivatives with respect to the parameters; explicit, balanced: see `functions_of`;
    proximal: with multipliers of least norm where constraints are redundant; requested: names in `REQUESTED`.
    Raises LoweringError if a kernel cannot be evaluated.
    """
    complete = with_mass_reciprocal(equations) if requested else equations
    differentiated = with_derivatives(complete) if sensitivities else complete
    context = Context(differentiated, elimination, proximal, sensitivities)
    scene = bool(equations.poses)
    implementations = {**OF_BODIES, **OF_MECHANISMS} if scene else OF_BODIES
    every = functions_of(equations, sensitivities, explicit, balanced)
    every += requested_functions(equations, requested, sensitivities)
    kernels = tuple(_kernels(context, every, implementations))
    setup, constants = setup_kernel(context, kernels)
    names = tuple(c.name for c in constants)
    model = Model(
        name=equations.name,
        doc=equations.doc,
        frame_doc=equations.frame_doc,
        coordinates=coordinate_variables(equations.coordinates),
        velocities=velocity_variables(equations.rows),
        equations=tuple(Variable(row.name, f"row of delta {row.name}", row.force_unit) for row in equations.rows),
        parameters=parameter_variables(equations.parameters),
        constants=constants,
        kernels=(setup, *(_with_constants(kernel, names) for kernel in kernels)),
        markers=marker_variables(equations.markers),
        zeros=tuple(Zero(f"M[{context.rows[i]}, {context.rows[j]}]", str(why)) for i, j, why in equations.mass_zeros),
        choice=choice,
        multipliers=multiplier_variables(equations.constraints),
        splines=named_splines(equations.name, equations.splines),
        bodies=tuple(pose.name for pose in equations.poses),
        inputs=port_variables(equations.inputs),
        outputs=port_variables(equations.outputs),
        proximal=proximal,
        requested=tuple(requested),
        in_space=any(isinstance(pose, SpatialPose) for pose in equations.poses),
        kkt=kkt(context) if scene else None,
        eliminated=eliminated_parts(equations.eliminated),
        vanished=tuple(Zero(f"{v.term.name} term of row {v.term.row}", str(v.reason)) for v in equations.vanished),
    )
    return replace(model, terms=model_terms(equations, model.pattern("mass", "M")))


def _kernels(
    context: Context, functions: Iterable[ModelFunction], implementations: Mapping[FunctionKind, Implementation]
) -> Iterator[Kernel]:
    """The kernels of functions; without constraints the forms for implicit integrators are one form."""
    forms: dict[FunctionKind, Kernel] = {}
    for function in functions:
        kernel = forms.get(function.kind)
        if kernel is None:
            kernel = with_attitude_check(implementations[function.kind](context, function), context.equations)
            if function.kind in FORMED and context.equations.poses and not context.forces:
                forms[function.kind] = kernel
        yield replace(kernel, name=function.name, doc=function.doc) if function.kind in forms else kernel


def _with_constants(kernel: Kernel, names: tuple[str, ...]) -> Kernel:
    """A kernel whose argument k has the names of the constants, which depend on all kernels."""
    arguments = (replace(a, elements=names) if a.name == "k" else a for a in kernel.arguments)
    return replace(kernel, arguments=tuple(arguments))
