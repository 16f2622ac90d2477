"""The lowering of a mechanism to kernels with loops over its instances."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from itertools import chain

from derive.ir.expressions import Expr, ScalarRef, walk
from derive.ir.kernel import ConstantArray, Kernel
from derive.ir.model import Model, Variable
from derive.lowering.flat.context import Context
from derive.lowering.flat.setup import setup_kernel
from derive.lowering.flat.setup_constants import Constants
from derive.lowering.instances.functions import (
    accelerations,
    body_functions,
    constraints,
    dae,
    outputs,
    prescribed_sides,
)
from derive.lowering.instances.functions.markers import Markers
from derive.lowering.instances.functions.sensitivities import parameter_jacobian
from derive.lowering.instances.loop_code.context import InstanceContext, idle_rows
from derive.lowering.instances.places import Places
from derive.lowering.instances.zeros_of_kinds import vanished_of_kinds, zeros_of_kinds
from derive.lowering.model_functions import FunctionKind, ModelFunction, functions_of
from derive.lowering.model_tables import (
    coordinate_variables,
    eliminated_parts,
    multiplier_variables,
    named_splines,
    parameter_variables,
    port_variables,
    symbol_variable,
    velocity_variables,
)
from derive.mechanics.multibody.gathering import refuse_equal_names, refuse_idle
from derive.mechanics.multibody.space.mechanism import AnyMechanism, SpatialMechanism
from derive.mechanics.symbols import Family, identity
from derive.mechanics.terms import Constraint
from derive.spec.model.time_function import Spline

FUNCTIONS: Mapping[FunctionKind, Callable[[InstanceContext, ModelFunction], Kernel]] = {
    FunctionKind.MASS: body_functions.mass,
    FunctionKind.FORCE: body_functions.force,
    FunctionKind.MASS_FORCE: body_functions.mass_force,
    FunctionKind.ACCEL: accelerations.accel,
    FunctionKind.ENERGY: body_functions.energy,
    FunctionKind.MOMENTUM: body_functions.momentum,
    FunctionKind.RATES: body_functions.rates,
    FunctionKind.CONSTRAINTS: constraints.constraints,
    FunctionKind.CONSTRAINT_RATES: constraints.constraint_rates,
    FunctionKind.CONSTRAINT_JACOBIAN: constraints.constraint_jacobian,
    FunctionKind.CONSTRAINT_BIAS: constraints.constraint_bias,
    FunctionKind.SOLVE: accelerations.solve,
    FunctionKind.PROJECT_VELOCITY: prescribed_sides.project_velocity,
    FunctionKind.POSES: body_functions.poses,
    FunctionKind.OUTPUTS: outputs.outputs,
    FunctionKind.OUTPUTS_JACOBIAN: outputs.outputs_jacobian,
    FunctionKind.RESIDUAL: dae.residual,
    FunctionKind.JACOBIAN: dae.jacobian,
    FunctionKind.PARAMETER_JACOBIAN: parameter_jacobian,
    FunctionKind.SOLVE_KKT: prescribed_sides.solve_kkt,
}
"""The functions of a mechanism, by their kinds."""


def lower_instances(
    mechanism: AnyMechanism,
    choice: str = "",
    explicit: bool = False,
    sensitivities: bool = False,
    proximal: bool = False,
    balanced: bool = False,
) -> Model:
    """The model of a mechanism in loops over its instances, see `derive.lowering.flat.lower`."""
    context = InstanceContext(mechanism, sensitivities, proximal)
    context.proximal = proximal or bool(idle_rows(context))
    _check(context)
    equations = context.classes[0].context.equations
    markers = Markers(context)
    named = replace(equations, markers=markers.equations, outputs=context.output_components)
    made = {**FUNCTIONS, FunctionKind.MARKER: markers.motion, FunctionKind.LOAD: markers.load}
    functions = functions_of(named, sensitivities, explicit, balanced)
    kernels = tuple(made[function.kind](context, function) for function in functions)
    setup = _setup(context, kernels)
    for of in context.codes:
        of.add_numbers()
    return replace(
        looped_model(mechanism, context.conditions, equations.splines, setup, kernels, context.places),
        zeros=zeros_of_kinds(context.classes),
        vanished=vanished_of_kinds(context.classes),
        proximal=context.proximal,
        choice=choice,
        inputs=port_variables(equations.inputs),
        outputs=port_variables(context.output_components),
        eliminated=eliminated_parts(
            (*mechanism.eliminated, *(o for c in context.classes for o in c.context.equations.eliminated))
        ),
        marker_classes=markers.classes,
    )


def looped_model(
    mechanism: AnyMechanism,
    conditions: tuple[Constraint, ...],
    splines: Iterable[Spline],
    setup: tuple[Kernel, tuple[Variable, ...]],
    kernels: Iterable[Kernel],
    places: Places,
) -> Model:
    """The model of a mechanism in loops, with what all of them have; setup: its kernel, and the constants."""
    first, constants = setup
    name = mechanism.scene.name
    return Model(
        name=name,
        doc=mechanism.doc(conditions),
        frame_doc=mechanism.frame_doc(by_table=True),
        coordinates=coordinate_variables(mechanism.coordinates),
        velocities=velocity_variables(mechanism.rows),
        equations=_rows_for_people(mechanism),
        parameters=parameter_variables(mechanism.parameters),
        constants=constants,
        kernels=(first, *(_with_constants(kernel, constants, places.arrays) for kernel in kernels)),
        markers=(),
        zeros=(),
        vanished=(),
        lowering="instances",
        multipliers=multiplier_variables(conditions),
        splines=named_splines(name, splines),
        bodies=tuple(instance.name for instance in mechanism.instances),
        in_space=isinstance(mechanism, SpatialMechanism),
    )


def _rows_for_people(mechanism: AnyMechanism) -> tuple[Variable, ...]:
    """The equations of motion, with names for people: those of coordinates, or of the virtual rotations of bodies."""
    shown = {str(c.q): symbol_variable(c.q, "", "").shown for c in mechanism.coordinates}
    for of in (replace(identity(row.v), family=Family.VIRTUAL_ROTATION) for row in mechanism.rows):
        shown.setdefault(of.symbol.name, of.shown)
    return tuple(
        Variable(row.name, f"row of delta {row.name}", row.force_unit, shown=shown[row.name]) for row in mechanism.rows
    )


def _check(context: InstanceContext) -> None:
    """Raise SpecError where a constraint has no coordinate that could meet it, or where two names meet."""
    idle = tuple(context.constraint(joint, k) for joint, k in idle_rows(context))
    refuse_idle(idle, context.mechanism.scene.redundant)
    equations = [of.context.equations for of in context.classes]
    refuse_equal_names(
        context.mechanism.rows,
        context.conditions,
        tuple({c.symbol: c for eq in equations for c in eq.coefficients}.values()),
        (*context.known.definitions, *(d for eq in equations for d in eq.definitions)),
    )


def _setup(context: InstanceContext, kernels: tuple[Kernel, ...]) -> tuple[Kernel, tuple[Variable, ...]]:
    """The kernel that computes the constants k from the parameters, and these constants."""
    coefficients = {c.symbol: c for c in context.known.context.coefficients}
    coefficients |= {
        c.symbol: c for of in context.codes for c in of.context.coefficients if str(c.symbol) not in of.differing
    }
    equations = replace(context.known.context.equations, definitions=(), coefficients=tuple(coefficients.values()))
    whole = Context(equations)
    whole.constants = _of_all(context)
    return setup_kernel(whole, kernels)


def _of_all(context: InstanceContext) -> Constants:
    """The constants and checks of setup; of numbers that differ, the checks for each instance. Raises LoweringError."""
    differing = context.constants.of_instances
    result = Constants(context.constants.coefficients - differing)
    result.hoisted |= {e: name for e, name in context.constants.hoisted.items() if name not in differing}
    for requirement in context.constants.requirements:
        every = (code.of_members(requirement) for code in context.codes) if _names(requirement.expr) & differing else ()
        for of in chain((requirement,), *every):
            if not _names(of.expr) & differing:
                result.require(of.kind, of.expr, of.code, of.text)
    return result


def _names(expr: Expr) -> set[str]:
    return {part.name for part in walk(expr) if isinstance(part, ScalarRef)}


def _with_constants(kernel: Kernel, constants: tuple[Variable, ...], arrays: Mapping[str, ConstantArray]) -> Kernel:
    """A kernel with the constant arrays that it reads, and with the names of the constants in its argument k."""
    used, names = kernel.used, tuple(c.name for c in constants)
    arguments = tuple(replace(a, elements=names) if a.name == "k" else a for a in kernel.arguments)
    own = tuple(array for name, array in arrays.items() if name in used)
    return replace(kernel, arguments=arguments, constants=own)
