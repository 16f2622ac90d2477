"""`lower`: the kernels of the equations of a body or a mechanism, in straight-line code or in loops.

The specification decides between the two, or else what `derive.lowering.cost_model` predicts for a body and
`derive.lowering.mechanism_costs` for a scene.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from functools import partial

from derive.enumerations import enumeration
from derive.errors import Problem, SpecError
from derive.function_names import ON_REQUEST
from derive.garbage_collection import paused
from derive.ir.model import Model
from derive.lowering import cost_model
from derive.lowering.flat.graph import LoweringError
from derive.lowering.flat.kkt_matrix import DependentConstraints
from derive.lowering.flat.lower import lower as lower_flat
from derive.lowering.mechanism_costs import LONG, MechanismCosts, estimate_mechanism_costs, is_predicted
from derive.mechanics.equations import Equations
from derive.mechanics.indexed_equations import IndexedEquations
from derive.mechanics.multibody.mechanism import Mechanism
from derive.mechanics.multibody.space.mechanism import AnyMechanism, SpatialMechanism
from derive.registry import UnknownNameError
from derive.spec.model.body import Lowering
from derive.spec.model.scene import Redundant


@paused()
def lower(
    derived: Equations | AnyMechanism,
    sensitivities: bool = False,
    explicit: bool = False,
    functions: str | Collection[str] = (),
) -> Model:
    """The kernels of a model: straight-line code, or loops over modes or bodies where these are predicted to be faster.

    Arguments:
        derived: what `derive` returns.
        sensitivities: add the kernels `parameter_jacobian` and `solve_kkt` for derivatives with respect to parameters
            and inputs, which models with loops over the modes do not have.
        explicit: leave out the kernels of a scene that explicit integration does not call, which takes half the time;
            markers of straight-line code in space are left out as well, unless there are functions on request.
            A scene that starts in equilibrium or in steady motion keeps the iteration matrix, which gives its start.
        functions: add kernels that few users need: "all", one or some of "inverse_dynamics", "gravity_compensation",
            "centre_of_mass", "centroidal_momentum" and "marker_rotations", and their derivatives if there are
            sensitivities. Loops over the links of trees have all but "marker_rotations", other loops none.

    Raises:
        SpecError: if the specification requires straight-line code that would be too long, or has loops where
            sensitivities or functions are required.
        UnknownNameError: for a name among `functions` that is none of these.
        TypeError: for anything but equations or a mechanism.

    Examples:
        >>> import derive
        >>> model = derive.lower(derive.derive(derive.planar_beam("beam")))
        >>> model.lowering
        'flat'
        >>> [kernel.name for kernel in model.kernels][:4]
        ['setup', 'mass', 'force', 'mass_force']
    """
    if not isinstance(derived, (Equations, Mechanism, SpatialMechanism)):
        raise TypeError(f"the equations that derive.derive(spec) returns are needed, not {type(derived).__name__}")
    functions = _requested(functions)
    if isinstance(derived, Mechanism):
        return _lower_mechanism(derived, sensitivities, explicit, functions)
    if isinstance(derived, SpatialMechanism):
        return _lower_spatial(derived, sensitivities, explicit, functions)
    if not isinstance(derived, IndexedEquations) or derived.body.dimension == 2:
        return _straight_line(derived.expanded(), "", sensitivities, explicit, functions=functions)
    estimate = cost_model.estimate_costs(derived.body)
    wanted = enumeration([*(["derivatives by parameters"] if sensitivities else []), *functions])
    needed = derived.lowering == "auto" and wanted and estimate.selected("auto") == "loops"
    requested: Lowering = "flat" if needed else derived.lowering  # loops have none of these
    try:
        flat = estimate.selected(requested) == "flat"
    except cost_model.CodeTooLong as error:
        raise SpecError((Problem("body.lowering", str(error)),)) from None
    reason = f"unrolled, for {wanted}" if needed else estimate.reason(requested)
    if wanted and not flat:
        raise SpecError((Problem("body.lowering", f'{reason}; loops have no {wanted}: lowering = "flat"'),))
    if flat:
        return lower_flat(derived.expanded(), reason, sensitivities=sensitivities, requested=functions)
    from derive.lowering.loops.body_functions import lower_loops  # most models are straight-line code

    return lower_loops(derived, reason)


def _requested(functions: str | Collection[str]) -> tuple[str, ...]:
    """The names of functions in the order of `ON_REQUEST`. Raises UnknownNameError for any other."""
    names = (functions,) if isinstance(functions, str) else tuple(functions)
    for name in names:
        if name not in (*ON_REQUEST, "all"):
            raise UnknownNameError("function on request", name, (*ON_REQUEST, "all"))
    return tuple(name for name in ON_REQUEST if name in names or "all" in names)


def _lower_mechanism(mechanism: Mechanism, sensitivities: bool, explicit: bool, functions: tuple[str, ...]) -> Model:
    requested, redundant = mechanism.scene.lowering, mechanism.scene.redundant
    balanced = mechanism.scene.start is not None
    costs = estimate_mechanism_costs(mechanism)
    unrolled = _unrolled_for(functions, requested, costs)
    if costs.selected(requested) == "instances" and not unrolled:
        from derive.lowering.instances.lower import lower_instances  # its forty modules; most models do without

        return lower_instances(
            mechanism, costs.reason(requested), explicit, sensitivities, redundant == "resolve", balanced
        )
    reason = unrolled or ("" if requested == "auto" else costs.reason(requested))
    try:
        return _straight_line(mechanism.expanded(), reason, sensitivities, explicit, redundant, balanced, functions)
    except RecursionError:
        raise LoweringError('straight-line code is too long; write lowering = "instances"') from None


def _unrolled_for(functions: tuple[str, ...], requested: str, costs: MechanismCosts) -> str:
    """The reason why a scene is unrolled that would have loops, in which there are no functions on request.

    Raises SpecError if the specification asks for loops, or if compilers would take too long for straight-line code.
    """
    if not functions or costs.selected(requested) == "flat":
        return ""
    if requested == "auto" and costs.compiler <= LONG:
        return f"unrolled, for {enumeration(functions)}"
    text = f'{costs.reason(requested)}; loops over instances have no {enumeration(functions)}: lowering = "flat"'
    raise SpecError((Problem("scene.lowering", text),))


def _lower_spatial(
    mechanism: SpatialMechanism, sensitivities: bool, explicit: bool, functions: tuple[str, ...]
) -> Model:
    """Straight-line code, or loops over instances where the specification asks for them or they are faster."""
    requested, redundant = mechanism.scene.lowering, mechanism.scene.redundant
    balanced = mechanism.scene.start is not None
    looped = requested == "instances"
    choice = "looped over instances, as the specification asks" if looped else ""
    in_trees = any(of.coordinates.is_carried for of in mechanism.instances)
    if requested == "auto" and in_trees and not balanced:
        from derive.lowering.trees.choice import chosen

        looped, choice = chosen(mechanism, explicit and not sensitivities, functions)
    elif not in_trees and ((requested == "auto" and is_predicted(mechanism)) or (looped and functions)):
        costs = estimate_mechanism_costs(mechanism)
        unrolled = _unrolled_for(functions, requested, costs)
        looped, choice = costs.lowering == "instances" and not unrolled, unrolled or costs.reason(requested)
    if looped and in_trees:
        from derive.lowering.trees.lower import lower_trees

        return lower_trees(mechanism, choice, explicit, sensitivities, balanced, functions)
    if looped:
        from derive.lowering.instances.lower import lower_instances  # its forty modules; most models do without

        return lower_instances(mechanism, choice, explicit, sensitivities, redundant == "resolve", balanced)
    try:
        equations = mechanism.expanded()
        if explicit and not functions:  # simulations call no function of a marker, and robots have dozens
            equations = replace(equations, markers=())
        return _straight_line(equations, choice, sensitivities, explicit, redundant, balanced, functions)
    except RecursionError:
        raise LoweringError('straight-line code is too long; write lowering = "instances"') from None


def _straight_line(
    equations: Equations,
    choice: str,
    sensitivities: bool,
    explicit: bool,
    redundant: Redundant = "auto",
    balanced: bool = False,
    functions: tuple[str, ...] = (),
) -> Model:
    """The model in straight-line code, with a proximal term if constraints are redundant whatever the numbers are."""
    lowered = partial(
        lower_flat,
        equations,
        choice,
        sensitivities=sensitivities,
        explicit=explicit,
        balanced=balanced,
        requested=functions,
    )
    idle = any(not c.jacobian for c in equations.constraints)
    if not equations.constraints or redundant == "error" or (redundant == "auto" and not idle):
        try:
            return lowered()
        except DependentConstraints:
            if redundant == "error":
                raise
    return lowered(proximal=True)


def lowered_form(derived: Equations | AnyMechanism, model: Model) -> Equations:
    """The form of the equations from which `model` was lowered: with sums over the modes, or expanded."""
    if isinstance(derived, Equations) and model.lowering == "loops":
        return derived
    return derived.expanded()
