"""The lowering of trees of rigid bodies in relative coordinates to kernels with loops over their links."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from derive.algebra import sp
from derive.enumerations import enumeration
from derive.errors import Problem, SpecError
from derive.ir.kernel import Kernel
from derive.ir.model import Model
from derive.lowering.attitude import with_attitude_check
from derive.lowering.flat.context import Context
from derive.lowering.flat.lower import FORMED, OF_BODIES, OF_MECHANISMS
from derive.lowering.flat.motion_quantities import with_mass_reciprocal
from derive.lowering.flat.sensitivities import with_derivatives
from derive.lowering.flat.setup import setup_kernel
from derive.lowering.instances.lower import looped_model
from derive.lowering.model_functions import FunctionKind, functions_of
from derive.lowering.model_tables import (
    eliminated_parts,
    marker_variables,
    port_variables,
)
from derive.lowering.requested_functions import requested_functions
from derive.lowering.trees import joint_outputs
from derive.lowering.trees.centroid import total_mass
from derive.lowering.trees.functions import FUNCTIONS
from derive.lowering.trees.joint_outputs import LOOPED, MOST_UNROLLED
from derive.lowering.trees.markers import OF_MARKERS, markers_of
from derive.lowering.trees.tree_context import TreeContext
from derive.mechanics.equations import Equations
from derive.mechanics.multibody.gathering import refuse_idle
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from derive.mechanics.terms import SpatialPose

WITHOUT = f"trees of more than {MOST_UNROLLED} velocities in loops have no angular velocities of markers"


def _equations(
    context: TreeContext, requested: Collection[str], sensitivities: bool
) -> tuple[Equations, Context | None]:
    """The functions that the table asks for, and the context of straight-line code for functions without loops.

    Raises SpecError for outputs that neither has.
    """
    mechanism = context.mechanism
    if len(context.rows) <= MOST_UNROLLED:
        equations = mechanism.expanded()
        complete = with_mass_reciprocal(equations) if requested else equations
        return equations, Context(with_derivatives(complete) if sensitivities else complete)
    if context.outputs is None:
        text = f"loops in relative coordinates of more than {MOST_UNROLLED} velocities have motions of joints alone"
        others = [output.name for output in mechanism.scene.outputs if output.kind not in joint_outputs.KINDS]
        raise SpecError(tuple(Problem(f"outputs.{name}", f'{text}: write lowering = "flat"') for name in others))
    return replace(
        context.known.context.equations,
        poses=(SpatialPose("", (), ()),),
        mass_moments=(sp.sympify(total_mass(context.motion)), *(sp.S.Zero,) * 3),
        weight_energy=sp.S.Zero if context.has_gravity else None,
        outputs=tuple(of.equation for of in context.outputs or ()),
        markers=markers_of(context).equations,
    ), None


def _check(context: TreeContext) -> None:
    """Raise SpecError for constraints without coordinates, and where multipliers of least norm are wanted."""
    of, scene = context.conditions, context.mechanism.scene
    refuse_idle(of.every, scene.redundant, [(d.symbol, d.expr) for d in context.known.definitions])
    idle = [c.shown for c in of.every if not c.jacobian]
    if idle or (of.every and scene.redundant == "resolve"):
        what = f"{enumeration(idle)} is redundant" if idle else 'scene.redundant is "resolve"'
        text = f"loops in relative coordinates have no multipliers of least norm, and {what}"
        raise SpecError((Problem("scene.lowering", f'{text}: write lowering = "flat"'),))


def _with_parameters(context: TreeContext, of: Context) -> Context:
    """The context of setup with the constants of links that are expressions of parameters."""
    made = context.of_parameters
    if not made:
        return of
    whole = Context(replace(of.equations, definitions=(), coefficients=(*of.coefficients, *made)))
    whole.constants = of.constants
    return whole


def _is_looped(context: TreeContext, kind: FunctionKind) -> bool:
    is_output = kind in (FunctionKind.OUTPUTS, FunctionKind.OUTPUTS_JACOBIAN, FunctionKind.PARAMETER_JACOBIAN)
    has_form = len(context.rows) > MOST_UNROLLED or kind not in (FunctionKind.RESIDUAL, FunctionKind.JACOBIAN)
    return kind in FUNCTIONS and has_form and (context.outputs is not None or not is_output)


def lower_trees(
    mechanism: SpatialMechanism,
    choice: str = "",
    explicit: bool = False,
    sensitivities: bool = False,
    balanced: bool = False,
    requested: Collection[str] = (),
) -> Model:
    """The model of trees of rigid bodies in loops over links. Raises SpecError with all that these do not have."""
    context = TreeContext(mechanism)
    if sensitivities:
        context.known.differentiate(by_parameters=True)
    _check(context)
    equations, others = _equations(context, requested, sensitivities)
    if explicit and not requested:  # as in straight-line code
        equations = replace(equations, markers=())
    kernels: list[Kernel] = []
    if others is None and not {*requested} <= LOOPED:
        raise SpecError((Problem("scene.lowering", f'{WITHOUT}, which are needed here: write lowering = "flat"'),))
    every = functions_of(equations, sensitivities, explicit, balanced and others is None)
    forms: dict[FunctionKind, Kernel] = {}
    for function in (*every, *requested_functions(equations, requested, sensitivities)):
        if function.kind in forms:
            kernels.append(replace(forms[function.kind], name=function.name, doc=function.doc))
        elif others is None and function.kind in OF_MARKERS:
            kernels.append(OF_MARKERS[function.kind](context, function))
        elif _is_looped(context, function.kind):
            kernels.append(FUNCTIONS[function.kind](context, function))
        elif others is not None:
            kernels.append(
                with_attitude_check({**OF_BODIES, **OF_MECHANISMS}[function.kind](others, function), equations)
            )
        if function.kind in FORMED and not context.multipliers:
            forms[function.kind] = kernels[-1]
    setup = setup_kernel(_with_parameters(context, others or context.known.context), kernels)
    return replace(
        looped_model(mechanism, context.conditions.every, equations.splines, setup, kernels, context.places),
        markers=marker_variables(equations.markers) if others else (),
        marker_classes=markers_of(context).classes if equations.markers and not others else (),
        choice=choice,
        inputs=port_variables(context.known.context.equations.inputs),
        outputs=port_variables(equations.outputs),
        eliminated=eliminated_parts(mechanism.eliminated),
        requested=tuple(requested),
    )
