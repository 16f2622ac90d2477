"""The functions of a tree in loops over its links, each from sections that several of them share."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from derive.ir.kernel import Argument, Kernel
from derive.ir.patterns import pattern
from derive.ir.statements import Clear, Statement, Work
from derive.lowering.instances.loop_code.context import Part, Result, kernel, whole
from derive.lowering.model_functions import FunctionKind, ModelFunction
from derive.lowering.trees import invariants, joint_outputs, loads
from derive.lowering.trees.articulated import articulated
from derive.lowering.trees.composite import composite, mass_pattern
from derive.lowering.trees.links import BodyPlace, marker_in_body
from derive.lowering.trees.newton_euler import newton_euler
from derive.lowering.trees.tree_context import TreeContext
from derive.mechanics.multibody.bodies.rigid import BODY_FRAME

STILL = "still"
"""The local array of velocities that are all zero."""


def _mass_parts(context: TreeContext) -> list[Part]:
    motion = context.motion
    return [
        motion.frames(moving=False, placed=True, in_tree=True),
        motion.inertias(moving=False),
        *composite(motion, mass_pattern(motion, len(context.rows))),
    ]


def _force_parts(context: TreeContext) -> list[Part]:
    return [*context.applied, *newton_euler(context.motion, context.gravity, ("h", 0), context.applied_array)]


def mass(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the mass matrix M(q)."""
    results = {"M": Result(pattern=mass_pattern(context.motion, len(context.rows)))}
    return kernel(context, function, results, *_mass_parts(context))


def force(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the forces h(t, q, v)."""
    motion = context.motion
    parts = [motion.frames(moving=True), motion.inertias(moving=True), *_force_parts(context)]
    return kernel(context, function, context.counted("h"), *parts)


def mass_force(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of M and h together."""
    motion = context.motion
    shape = mass_pattern(motion, len(context.rows))
    parts = [
        motion.frames(moving=True, placed=True, in_tree=True),
        motion.inertias(moving=True),
        *composite(motion, shape),
        *_force_parts(context),
    ]
    return kernel(context, function, {"M": Result(pattern=shape), **context.counted("h")}, *parts)


def accel(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of vdot, and of no multipliers."""
    motion = context.motion
    results = context.counted("vdot") | {"lam": Result((), count=0)}
    parts = [
        motion.frames(moving=True),
        motion.inertias(moving=True),
        *context.applied,
        *articulated(motion, context.gravity, bool(context.applied_array)),
    ]
    return kernel(context, function, results, *parts)


def energy(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the kinetic energy, the energy of springs, and the potential of gravity if there is any."""
    motion = context.motion
    labels = ("kinetic", "strain", *(("gravity",) if context.has_gravity else ()))
    body = invariants.energy(motion, context.gravity if context.has_gravity else None)
    parts = [motion.frames(moving=True, placed=True), motion.inertias(moving=False)]
    parts.append(("energy", "(22)", "1/2 int rho xdot . xdot", [*body, *loads.stored(motion, context.loads)]))
    return kernel(context, function, {"energy": Result(labels)}, *parts)


def momentum(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the linear momentum, and of the angular momentum about the inertial origin."""
    motion = context.motion
    labels = tuple(f"{of}_{k}" for of in ("linear", "angular") for k in (1, 2, 3))
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


def nothing(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of a function of constraints, of which there are none."""
    results = {name: Result((), count=0) for name in function.outputs}
    if "G" in results:
        results["G"] = Result(pattern=pattern(0, len(context.rows), set()))
    return kernel(context, function, results, inputs=_nothing)


def project_velocity(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the change of velocities that no constraint asks for."""
    body: list[Statement] = [Clear("dv", len(context.rows))]
    return kernel(context, function, context.counted("dv"), ("dv", "(5)", "no constraints", body), inputs=_nothing)


_nothing = {"r": whole("r", 0, "prescribed change of gdot")}


def residual(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of [qdot - v; M vdot + h]: all forms are one without constraints."""
    count, size = context.coordinates, context.coordinates + len(context.rows)
    motion = replace(context.motion, q=("y", 0), v=("y", count))
    parts = [
        ("rates", "(1)", "qdot - v", invariants.rates(motion, "F", "ydot")),
        motion.frames(moving=True),
        motion.inertias(moving=True),
        *context.applied_at(motion),
        *newton_euler(motion, context.gravity, ("F", count), context.applied_array, ("ydot", count)),
    ]
    results = {"F": Result(("coordinates and rows",), count=size)}
    inputs = {"y": whole("y", size, "state [q; v]"), "ydot": whole("ydot", size, "time derivative of y")}
    return kernel(context, function, results, *parts, inputs=inputs)


def inverse_dynamics(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the generalised forces f = M vdot + h of a motion."""
    motion, target = context.motion, ("f", 0)
    parts = [
        motion.frames(moving=True),
        motion.inertias(moving=True),
        *context.applied,
        *newton_euler(motion, context.gravity, target, context.applied_array, ("vdot", 0)),
    ]
    return kernel(context, function, context.counted("f"), *parts, inputs=_reactions(context))


def gravity_compensation(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the generalised forces h that hold a tree without velocities."""
    motion = replace(context.motion, v=(STILL, 0))
    still: list[Statement] = [Work(STILL, len(context.rows), cleared=True)]
    parts = [
        ("still", "", "no velocities", still),
        motion.frames(moving=True),
        motion.inertias(moving=True),
        *context.applied_at(motion),
        *newton_euler(motion, context.gravity, ("f", 0), context.applied_array),
    ]
    return kernel(context, function, context.counted("f"), *parts)


def outputs(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the outputs."""
    body = [*joint_outputs.values(context.motion, context.outputs or ())]
    results = {"out": Result(("output by output",), count=len(context.outputs or ()))}
    section = "outputs", "", "motions of joints and their rates", body
    return kernel(context, function, results, section, inputs=_reactions(context))


def outputs_jacobian(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the derivatives of the outputs with respect to q, v, vdot, lambda and u."""
    rows = len(context.rows)
    sizes = (context.coordinates, rows, rows, 0, len(context.known.context.u.symbols))
    shape = joint_outputs.jacobian_pattern(context.outputs or (), sizes)
    body = joint_outputs.derivatives(context.motion, context.outputs or (), shape)
    section = "jacobian", "", "derivatives of the outputs", body
    return kernel(context, function, {"jac": Result(pattern=shape)}, section, inputs=_reactions(context))


def _reactions(context: TreeContext) -> dict[str, Argument]:
    return {
        "vdot": whole("vdot", len(context.rows), "accelerations, as from solve"),
        "lam": whole("lam", 0, "constraint reactions, as from solve"),
    }


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
    FunctionKind.CONSTRAINTS: nothing,
    FunctionKind.CONSTRAINT_RATES: nothing,
    FunctionKind.CONSTRAINT_JACOBIAN: nothing,
    FunctionKind.CONSTRAINT_BIAS: nothing,
    FunctionKind.PROJECT_VELOCITY: project_velocity,
    FunctionKind.OUTPUTS: outputs,
    FunctionKind.OUTPUTS_JACOBIAN: outputs_jacobian,
    FunctionKind.RESIDUAL: residual,
    FunctionKind.INVERSE_DYNAMICS: inverse_dynamics,
    FunctionKind.GRAVITY_COMPENSATION: gravity_compensation,
}
"""The functions of a tree, by their kinds."""
