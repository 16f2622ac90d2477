"""The lowering of a mechanism to kernels with loops over its instances."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from derive.ir.model import Argument, ConstantArray, Kernel, Model, Output, Variable, Zero
from derive.lowering.instances import accelerations, body_functions, constraints, dae
from derive.lowering.instances.classes import obstacle
from derive.lowering.instances.context import InstanceContext
from derive.lowering.model_functions import FunctionKind, ModelFunction, functions_of
from derive.mechanics.multibody.mechanism import Mechanism
from derive.mechanics.multibody.mechanism_text import frame_doc, mechanism_doc

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
    FunctionKind.PROJECT_VELOCITY: accelerations.project_velocity,
    FunctionKind.POSES: body_functions.poses,
    FunctionKind.RESIDUAL: dae.residual,
    FunctionKind.JACOBIAN: dae.jacobian,
}
"""The functions of a mechanism, by their kinds."""

MANY = 16
"""Bodies from which on straight-line code takes long to compile."""


def instances_reason(mechanism: Mechanism) -> str:
    """The reason to lower a mechanism to loops over its instances; empty if it is lowered to straight-line code."""
    moving = sum(instance.moves for instance in mechanism.instances)
    if moving < MANY or obstacle(mechanism):
        return ""
    return f"looped over {moving} bodies, whose straight-line code would take long to compile"


def lower_instances(mechanism: Mechanism, choice: str = "", explicit: bool = False) -> Model:
    """The model of a mechanism in loops over its instances."""
    context = InstanceContext(mechanism)
    first = context.classes[0].context.equations
    named = replace(first, markers=(), outputs=())
    functions = functions_of(named, explicit=explicit)
    kernels = tuple(FUNCTIONS[function.kind](context, function) for function in functions)
    for of in context.classes:
        of.add_numbers()
    arrays = context.places.arrays
    setup = Kernel(
        "setup",
        "Constants k from the parameters p: there are none.",
        (Argument("p", (), "parameters"),),
        (Output("k", (), "constants"),),
        (),
    )
    made = (setup, *(_with_constants(kernel, arrays) for kernel in kernels))
    flat = tuple(c for of in context.known for c in of)
    scene = mechanism.scene
    return Model(
        name=scene.name,
        doc=mechanism_doc(scene, mechanism.coordinates, flat),
        frame_doc=frame_doc(mechanism.instances, scene),
        coordinates=tuple(Variable(str(c.q), c.doc, c.unit, role=c.role) for c in mechanism.coordinates),
        velocities=tuple(Variable(str(row.v), row.doc, row.unit) for row in mechanism.rows),
        equations=tuple(Variable(row.name, f"row of delta {row.name}", row.force_unit) for row in mechanism.rows),
        parameters=(),
        constants=(),
        kernels=made,
        markers=(),
        zeros=(),
        vanished=(),
        lowering="instances",
        choice=choice,
        multipliers=tuple(Variable(c.name, c.doc, c.force_unit) for c in flat),
        bodies=tuple(instance.name for instance in mechanism.instances),
        eliminated=tuple(Zero(out.what, out.reason) for out in mechanism.eliminated),
    )


def _with_constants(kernel: Kernel, arrays: Mapping[str, ConstantArray]) -> Kernel:
    used = kernel.used
    return replace(kernel, constants=tuple(array for name, array in arrays.items() if name in used))
