"""`derive` and `lower`: the two stages that depend on the kind of the specification.

A specification is a beam, a body of nodes, a body with parameters, or a scene. The equations of a body keep their sums
over the modes; `lower` unrolls them or generates loops, as the specification requires or else as
`derive.lowering.cost_model` predicts.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from functools import partial
from typing import assert_never, get_args

import numpy as np
from numpy.typing import NDArray

from derive.enumerations import enumeration
from derive.errors import Problem, SpecError
from derive.function_names import ON_REQUEST
from derive.garbage_collection import paused
from derive.ir.model import Model
from derive.lowering import cost_model
from derive.lowering.flat.constraints import DependentConstraints
from derive.lowering.flat.graph import LoweringError
from derive.lowering.flat.lower import lower as lower_flat
from derive.lowering.mechanism_costs import LONG, TWO, MechanismCosts, estimate_mechanism_costs, is_predicted
from derive.mechanics import indexed_equations
from derive.mechanics.bodies import beam
from derive.mechanics.bodies.modal_body import ModalBody, ModalFrame
from derive.mechanics.bodies.spatial_body import modal_body, parametric_body
from derive.mechanics.bodies.spatial_body import parameters as parameters_of
from derive.mechanics.bodies.spatial_tables import symbolic_tables
from derive.mechanics.equations import Equations
from derive.mechanics.indexed_equations import IndexedEquations
from derive.mechanics.multibody import assembly
from derive.mechanics.multibody.mechanism import Mechanism
from derive.mechanics.multibody.space.assembly import spatial_mechanism
from derive.mechanics.multibody.space.flexible import ReducedBody
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from derive.registry import UnknownNameError
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.body import Gravity, Lowering, NodalBody, SymbolicBody
from derive.spec.model.scene import Redundant, Scene
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import Specification, check_specification

AnyMechanism = Mechanism | SpatialMechanism
"""A mechanism in the plane or in space."""


@paused()
def derive(spec: Specification) -> IndexedEquations | AnyMechanism:
    """The equations of motion of a body, or the mechanism that a scene describes.

    Both have a method `expanded()`, which expands the sums over the modes and, for a mechanism, the equations of every
    instance of a body.

    Arguments:
        spec: a specification, as `read`, `planar_beam` or `scene` return it.

    Returns:
        For a body its equations with a row for a generic mode; for a scene a Mechanism.

    Raises:
        SpecError: if the specification has no valid equations.
        TypeError: for anything but a specification.

    Examples:
        >>> import derive
        >>> beam = derive.planar_beam("beam")
        >>> equations = derive.derive(beam).expanded()
        >>> [row.name for row in equations.rows]
        ['c1', 'c2', 'phi', 'alpha1', 'alpha2']
        >>> equations.mass[2, 2]
        J
    """
    check_specification(spec)
    match spec:
        case PlanarBeam():
            return beam.derive(spec)
        case Scene():
            return assembly.mechanism(spec)
        case SpatialScene():
            return _spatial_mechanism(spec)
        case SymbolicBody():
            return indexed_equations.derive_body(parametric_body(spec), spec.lowering)
        case NodalBody():
            return derive_modal(modal(spec), spec.gravity, spec.lowering)
        case _ as never:
            assert_never(never)


def _spatial_mechanism(scene: SpatialScene) -> SpatialMechanism:
    """The mechanism of a scene in space, with one code for finite-element bodies where these get loops."""
    reduced = reduced_bodies(scene)
    if scene.lowering == "auto" and len(scene.bodies) == len(reduced) > TWO:
        looped = spatial_mechanism(scene, reduced, looped=True)
        if is_predicted(looped) and estimate_mechanism_costs(looped).lowering == "instances":
            return looped
    return spatial_mechanism(scene, reduced, looped=scene.lowering == "instances")


def modal(spec: NodalBody) -> ModalBody:
    """The shape integrals of a finite-element body, in its frame.

    Arguments:
        spec: the body, as `nodal_body` or `read` return it.

    Raises:
        SpecError: with a list of all faults of the nodes, matrices and modes.
        TypeError: for anything but a finite-element body.

    Examples:
        >>> import derive
        >>> import numpy as np
        >>> corners = [[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]]
        >>> breathing = [np.array(corners) / 8**0.5]
        >>> nodes = {"positions": corners, "mass": np.eye(4), "modes": breathing, "modal_stiffness": [[100]]}
        >>> square = derive.nodal_body("square", nodes, units="SI")
        >>> body = derive.modal(square)
        >>> body.mass, body.C3[2, 2]  # kg, kg m^2
        (4.0, np.float64(8.0))
        >>> (body.stiffness / body.c8) ** 0.5  # natural frequency, rad/s
        array([[10.]])
    """
    if not isinstance(spec, NodalBody):
        raise TypeError(f"a finite-element body is needed, as derive.nodal_body returns it, not {type(spec).__name__}")
    from derive.reduction import reduce  # only a body of nodes needs it, and SciPy's rotations

    return reduce(spec)


def reduced_bodies(scene: SpatialScene) -> dict[str, ReducedBody]:
    """The finite-element bodies of a scene as numbers, by their names. Raises SpecError with faults of their data."""
    flexible = [body for body in scene.bodies if isinstance(body, FlexibleBody)]
    if not flexible:
        return {}
    from derive.reduction import reduce
    from derive.reduction.frame_points import load_frames, modal_frames

    frames: dict[str, tuple[ModalFrame, ...]] = {}
    problems: list[Problem] = []
    for flexible_body in flexible:  # first, since modes need rigid sets that it checks
        try:
            frames[flexible_body.name] = modal_frames(flexible_body)
        except SpecError as error:
            problems += (_in_scene(problem, flexible_body.name) for problem in error.problems)
    if problems:
        raise SpecError(tuple(problems))
    alike = {body.name: replace(body.body, name="") for body in flexible}
    integrals = {body: reduce(body) for body in dict.fromkeys(alike.values())}
    return {
        body.name: ReducedBody(
            replace(integrals[alike[body.name]], name=body.name), frames[body.name], load_frames(body)
        )
        for body in flexible
    }


def _in_scene(problem: Problem, name: str) -> Problem:
    """A fault of a body alone as one of a body in a scene."""
    section, dot, key = problem.path.partition(".")
    return replace(problem, path=f"bodies.{name}{dot}{key}") if section == "body" else problem


@paused()
def derive_modal(body: ModalBody, gravity: Gravity | None = None, lowering: Lowering = "auto") -> IndexedEquations:
    """The equations of motion of a body given by its shape integrals.

    Arguments:
        body: mass, shape integrals, stiffness and damping, as `modal` or `derive.sid.read` return them.
        gravity: three components, m/s^2, numbers or parameters; None for no gravity.
        lowering: "flat" (sums unrolled), "loops" (loops over the modes) or "auto" (the faster, as predicted).

    Returns:
        The equations with a row for a generic mode; `lower` makes kernels of them.

    Raises:
        TypeError: for anything but the shape integrals of a body.
        ValueError: for another lowering, and for gravity that has not three components.

    Examples:
        >>> import derive
        >>> import numpy as np
        >>> corners = [[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]]
        >>> breathing = [np.array(corners) / 8**0.5]
        >>> nodes = {"positions": corners, "mass": np.eye(4), "modes": breathing, "modal_stiffness": [[100]]}
        >>> square = derive.nodal_body("square", nodes, units="SI")
        >>> equations = derive.derive_modal(derive.modal(square), gravity=(0, 0, -10))
        >>> model = derive.lower(equations)
        >>> [velocity.name for velocity in model.velocities]
        ['c1dot', 'c2dot', 'c3dot', 'omega1', 'omega2', 'omega3', 'alpha1dot']
    """
    _check_modal(body)
    if lowering not in get_args(Lowering):
        raise ValueError(f'the lowering is one of {", ".join(get_args(Lowering))}, not "{lowering}"')
    if gravity is not None and len(gravity) != 3:
        raise ValueError(f"gravity has three components, not {len(gravity)}")
    return indexed_equations.derive_body(modal_body(body, gravity), lowering)


def _check_modal(body: object) -> None:
    if not isinstance(body, ModalBody):
        raise TypeError(f"the shape integrals that derive.modal(spec) returns are needed, not {type(body).__name__}")


def parameters(body: ModalBody, spec: SymbolicBody) -> NDArray[np.float64]:
    """The parameters with which the model of a symbolic body represents a particular body; gravity has its defaults.

    Arguments:
        body: the shape integrals of the body, as `modal` returns them.
        spec: the symbolic body, whose compiled model takes the parameters.

    Returns:
        The vector p (parameters,) in SI units, for `Native.setup`.

    Raises:
        ValueError: if the numbers of modes differ, or if the body has a non-zero integral that vanishes in the model.
        TypeError: for anything but shape integrals and a symbolic body.

    Examples:
        >>> import derive
        >>> import numpy as np
        >>> corners = [[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]]
        >>> breathing = [np.array(corners) / 8**0.5]
        >>> nodes = {"positions": corners, "mass": np.eye(4), "modes": breathing, "modal_stiffness": [[100]]}
        >>> square = derive.nodal_body("square", nodes, units="SI")
        >>> any_body = derive.symbolic_body("any_body", modes=1)
        >>> model = derive.lower(derive.derive(any_body))
        >>> p = derive.parameters(derive.modal(square), any_body)
        >>> [(parameter.name, float(value)) for parameter, value in zip(model.parameters, p)][:3]
        [('m', 4.0), ('C3_11_', 4.0), ('C3_12_', 0.0)]
    """
    _check_modal(body)
    if not isinstance(spec, SymbolicBody):
        raise TypeError(f"a symbolic body is needed, as derive.symbolic_body returns it, not {type(spec).__name__}")
    if body.modes != spec.modes:
        raise ValueError(f"{spec.name} has {spec.modes} modes and {body.name} {body.modes}")
    return parameters_of(body, symbolic_tables(spec), spec.gravity)


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
