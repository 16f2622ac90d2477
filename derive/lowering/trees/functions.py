"""The functions of a tree in loops over its links, each from sections that several of them share."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from derive.ir.expressions import Element, ScalarRef
from derive.ir.kernel import Argument, Kernel
from derive.ir.patterns import pattern
from derive.ir.statements import Clear, Statement, Work
from derive.lowering.instances.loop_code.kernels import ZERO, Part, Result, kernel, whole
from derive.lowering.model_functions import FunctionKind, ModelFunction
from derive.lowering.trees import invariants, joint_outputs, loads, requested
from derive.lowering.trees.articulated import articulated
from derive.lowering.trees.composite import composite
from derive.lowering.trees.condition_loops import ConditionLoops
from derive.lowering.trees.forms import TreeForm
from derive.lowering.trees.links import BodyPlace, marker_in_body
from derive.lowering.trees.motion import STILL
from derive.lowering.trees.newton_euler import newton_euler
from derive.lowering.trees.reactions import G, Reactions
from derive.lowering.trees.sensitivities import derivatives, parameter_jacobian
from derive.lowering.trees.tangents import ONE, Directions
from derive.lowering.trees.tree_context import TreeContext
from derive.mechanics.axes import AXES
from derive.mechanics.multibody.bodies.rigid import BODY_FRAME
from derive.roles import Source

FREELY, WANTED = "freely", "wanted"
"""The local arrays of accelerations without multipliers, and of gamma."""


def _mass_parts(context: TreeContext) -> list[Part]:
    motion = context.motion
    return [
        motion.frames(moving=False, placed=True, in_tree=True),
        motion.inertias(moving=False),
        *composite(motion, context.mass_pattern),
    ]


def _force_parts(context: TreeContext, in_tree: bool = False) -> list[Part]:
    applied = context.applied_at(context.motion, in_tree)
    return [*applied, *newton_euler(context.motion, context.gravity, ("h", 0), context.applied_array)]


def mass(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the mass matrix M(q)."""
    results = {"M": Result(pattern=context.mass_pattern)}
    return kernel(context, function, results, *_mass_parts(context))


def force(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the forces h(t, q, v)."""
    motion = context.motion
    frames = motion.frames(moving=True, placed=bool(context.springs))
    parts = [frames, motion.inertias(moving=True), *_force_parts(context)]
    return kernel(context, function, context.counted("h"), *parts)


def mass_force(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of M and h together."""
    motion = context.motion
    shape = context.mass_pattern
    parts = [
        motion.frames(moving=True, placed=True, in_tree=True),
        motion.inertias(moving=True),
        *composite(motion, shape),
        *_force_parts(context, in_tree=True),
    ]
    return kernel(context, function, {"M": Result(pattern=shape), **context.counted("h")}, *parts)


def accel(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of vdot, and of the multipliers."""
    motion, count = context.motion, context.multipliers
    results = context.counted("vdot") | {"lam": _each_constraint(context)}
    if not count:
        parts = [
            motion.frames(moving=True, placed=bool(context.springs)),
            motion.inertias(moving=True),
            *context.applied,
            *articulated(motion, context.gravity, context.applied_array),
        ]
        return kernel(context, function, results, *parts)
    of, reactions = context.constrained(motion), Reactions(motion, count, len(context.rows))
    wanted = [Work(WANTED, count), *of.bias(WANTED)]
    solved = reactions.multipliers(lambda index: Element(WANTED, index), FREELY)
    stores = [*reactions.results("vdot", FREELY), *(reactions.given("lam") if "lam" in function.outputs else [])]
    parts = [
        motion.frames(moving=True, placed=True),
        motion.inertias(moving=True),
        *context.applied,
        ("freely", "", "accelerations without multipliers", [Work(FREELY, len(context.rows))]),
        *articulated(motion, context.gravity, context.applied_array, FREELY),
        *_answers(of, reactions),
        ("gamma", "(5)", "accelerations that the constraints need", wanted),
        ("multipliers", Source.FACTORISATION, "what holds the constraints, and its accelerations", [*solved, *stores]),
    ]
    return kernel(context, function, results, *parts)


def _answers(of: ConditionLoops, reactions: Reactions) -> list[Part]:
    """The sections of G, of M^-1 G^T and of G M^-1 G^T."""
    factors = [*reactions.declared, *of.jacobian(G, reactions.position)]
    return [
        ("G", "(6)", "factors of the generalised velocities in the rates of the constraints", factors),
        ("answers", Source.FACTORISATION, "accelerations by each multiplier", reactions.answers()),
    ]


def _each_constraint(context: TreeContext) -> Result:
    count = context.multipliers
    return Result(("constraint by constraint",) if count else (), count=count)


def energy(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the kinetic energy, the energy of springs, and the potential of gravity if there is any."""
    motion = context.motion
    labels = ("kinetic", "strain", *(("gravity",) if context.has_gravity else ()))
    body = invariants.energy(motion, context.gravity if context.has_gravity else None)
    parts = [motion.frames(moving=True, placed=True), motion.inertias(moving=False)]
    stored = [*loads.stored(motion, context.loads), *(group.stored(motion) for group in context.springs)]
    parts.append(("energy", "(22)", "1/2 int rho xdot . xdot", [*body, *stored]))
    return kernel(context, function, {"energy": Result(labels)}, *parts)


def momentum(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the linear momentum, and of the angular momentum about the inertial origin."""
    motion = context.motion
    labels = tuple(f"{of}_{k}" for of in ("linear", "angular") for k in AXES)
    parts = [motion.frames(moving=True, placed=True), motion.inertias(moving=False)]
    parts.append(("momentum", "(1)", "int rho xdot and int rho x x xdot", invariants.momentum(motion)))
    return kernel(context, function, {"momentum": Result(labels)}, *parts)


def rates(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of qdot."""
    results = {"qdot": Result(("coordinate by coordinate",), count=context.coordinates)}
    section = "rates", "(1)", "velocities, and time derivatives of quaternions", invariants.rates(context.motion)
    return kernel(context, function, results, section)


def poses(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the positions and rotation tensors of all body frames."""
    motion, instances = context.motion, context.mechanism.instances
    bodies = [context.tree.bodies[of.name].at(*marker_in_body(of, BODY_FRAME)) for of in instances]
    attitudes = [context.tree.bodies[of.name].attitude for of in instances]
    places = [BodyPlace(of.link, attitude, of.origin) for of, attitude in zip(bodies, attitudes, strict=True)]
    results = {"pose": Result(("body by body",), count=invariants.POSE * len(instances))}
    section = "poses", "(1)", "bodies in the order of the specification", invariants.poses(motion, places)
    return kernel(context, function, results, motion.frames(moving=False, placed=True), section)


def constraints(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the constraints g(t, q)."""
    of = context.constrained(context.motion)
    body = [of.values("g", lambda c: c.position, moving=False)] if context.multipliers else []
    section = "g", "(1)", "point of body 2 minus point of body 1, and angles", body
    frames = context.motion.frames(moving=False, placed=True)
    return kernel(context, function, {"g": _each_constraint(context)}, frames, section)


def constraint_rates(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of gdot."""
    of = context.constrained(context.motion)
    body = [of.values("gdot", lambda c: c.rate, moving=True)] if context.multipliers else []
    frames = context.motion.frames(moving=True, placed=True)
    section = "gdot", "(1)", "time derivatives", body
    return kernel(context, function, {"gdot": _each_constraint(context)}, frames, section)


def constraint_bias(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of gamma."""
    motion = context.motion
    body = context.constrained(motion).bias("gamma") if context.multipliers else []
    section = "gamma", "(5)", "centrifugal, Coriolis and prescribed parts", body
    parts = [motion.frames(moving=True, placed=True), motion.inertias(moving=True)] if body else []
    return kernel(context, function, {"gamma": _each_constraint(context)}, *parts, section)


def constraint_jacobian(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of G."""
    of = context.constrained(context.motion)
    shape = pattern(context.multipliers, len(context.rows), of.entries())
    number = {entry: k for k, entry in enumerate(shape.entries)}
    zeros: list[Statement] = [Clear("G", len(shape.entries))] if number else []
    body = [*zeros, *of.jacobian("G", lambda condition, row: number[condition, row])]
    section = "G", "(6)", "factors of the generalised velocities", body
    return kernel(
        context, function, {"G": Result(pattern=shape)}, context.motion.frames(moving=False, placed=True), section
    )


def project_velocity(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the smallest change of velocities with G dv = r."""
    count, rows = context.multipliers, len(context.rows)
    inputs = {"r": whole("r", count, "prescribed change of gdot")}
    if not count:
        body: list[Statement] = [Clear("dv", rows)]
        return kernel(context, function, context.counted("dv"), ("dv", "(5)", "no constraints", body), inputs=inputs)
    motion = replace(context.motion, v=(STILL, 0))
    of, reactions = context.constrained(motion), Reactions(motion, count, rows)
    solved = reactions.multipliers(lambda index: Element("r", index))
    still: list[Statement] = [Work(STILL, rows, cleared=True)]
    parts = [
        ("still", "", "no velocities", still),
        motion.frames(moving=True, placed=True),
        motion.inertias(moving=True),
        *articulated(motion, context.gravity, "", ""),
        *_answers(of, reactions),
        ("multipliers", Source.FACTORISATION, "impulses of the constraints", [*solved, *reactions.results("dv")]),
    ]
    return kernel(context, function, context.counted("dv"), *parts, inputs=inputs)


def solve_kkt(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel that solves M x - G^T lambda = a, G x = b."""
    count, rows = context.multipliers, len(context.rows)
    inputs = {
        "a": whole("a", rows, "right-hand side of the equations of motion"),
        "b": whole("b", count, "right-hand side of the constraints"),
    }
    results = {"x": Result(("row by row",), count=rows), "lam": _each_constraint(context)}
    motion, target = replace(context.motion, v=(STILL, 0)), FREELY if count else "x"
    still: list[Statement] = [Work(STILL, rows, cleared=True), *([Work(FREELY, rows)] if count else [])]
    parts: list[Part] = [
        ("still", "", "no velocities", still),
        motion.frames(moving=True, placed=bool(count)),
        motion.inertias(moving=True),
        *articulated(motion, [ZERO] * 3, "a", target, "a"),
    ]
    if count:
        of, reactions = context.constrained(motion), Reactions(motion, count, rows)
        solved = reactions.multipliers(lambda index: Element("b", index), FREELY)
        stores = [*solved, *reactions.results("x", FREELY), *reactions.given("lam")]
        parts += [*_answers(of, reactions), ("multipliers", Source.FACTORISATION, "multipliers and rates", stores)]
    return kernel(context, function, results, *parts, inputs=inputs)


def residual(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of a form F(t, y, ydot)."""
    form = TreeForm(context, function.variant)
    results = {"F": Result(("coordinates, rows, and constraints",), count=form.size)}
    return kernel(context, function, results, *form.parts(), inputs=form.arguments)


def jacobian(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the iteration matrix dF/dy + cj dF/dydot."""
    form = TreeForm(context, function.variant)
    inputs = {**form.arguments, "cj": Argument("cj", (), "factor of dF/dydot", scalar=True)}
    along = [Directions("y", form.size, (("y", 0, ONE), ("ydot", 0, ScalarRef("cj"))))]
    return derivatives(context, function, form.parts(), {"F": form.size}, along, inputs=inputs, by_parameters=False)


def outputs(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the outputs."""
    body = [*joint_outputs.values(context.motion, context.outputs or ())]
    results = {"out": Result(("output by output",), count=len(context.outputs or ()))}
    section = "outputs", "", "motions of joints and their rates", body
    return kernel(context, function, results, section, inputs=context.reactions)


def outputs_jacobian(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the derivatives of the outputs with respect to q, v, vdot, lambda and u."""
    rows = len(context.rows)
    sizes = (context.coordinates, rows, rows, context.multipliers, len(context.inputs))
    shape = joint_outputs.jacobian_pattern(context.outputs or (), sizes)
    body = joint_outputs.derivatives(context.motion, context.outputs or (), shape)
    section = "jacobian", "", "derivatives of the outputs", body
    return kernel(context, function, {"jac": Result(pattern=shape)}, section, inputs=context.reactions)


FUNCTIONS: Mapping[FunctionKind, Callable[[TreeContext, ModelFunction], Kernel]] = {
    FunctionKind.MASS: mass,
    FunctionKind.FORCE: force,
    FunctionKind.MASS_FORCE: mass_force,
    FunctionKind.ACCEL: accel,
    FunctionKind.SOLVE: accel,
    FunctionKind.ENERGY: energy,
    FunctionKind.MOMENTUM: momentum,
    FunctionKind.RATES: rates,
    FunctionKind.POSES: poses,
    FunctionKind.CONSTRAINTS: constraints,
    FunctionKind.CONSTRAINT_RATES: constraint_rates,
    FunctionKind.CONSTRAINT_JACOBIAN: constraint_jacobian,
    FunctionKind.CONSTRAINT_BIAS: constraint_bias,
    FunctionKind.PROJECT_VELOCITY: project_velocity,
    FunctionKind.OUTPUTS: outputs,
    FunctionKind.OUTPUTS_JACOBIAN: outputs_jacobian,
    FunctionKind.RESIDUAL: residual,
    FunctionKind.JACOBIAN: jacobian,
    FunctionKind.PARAMETER_JACOBIAN: parameter_jacobian,
    FunctionKind.SOLVE_KKT: solve_kkt,
    FunctionKind.INVERSE_DYNAMICS: requested.inverse_dynamics,
    FunctionKind.GRAVITY_COMPENSATION: requested.gravity_compensation,
    FunctionKind.CENTRE_OF_MASS: requested.centre_of_mass,
    FunctionKind.CENTROIDAL_MOMENTUM: requested.centroidal_momentum,
    **dict.fromkeys(requested.DERIVED, requested.requested_jacobian),
}
"""The functions of a tree, by their kinds."""
