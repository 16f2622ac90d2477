"""The functions of trees on request: inverse dynamics, gravity compensation, centre of mass, centroidal momentum."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from derive.ir.kernel import Kernel
from derive.ir.statements import Statement, Work
from derive.lowering.instances.loop_code.kernels import Part, Result, kernel
from derive.lowering.model_functions import FunctionKind, ModelFunction
from derive.lowering.requested_functions import DIFFERENTIATED, JACOBIANS
from derive.lowering.trees import centroid
from derive.lowering.trees.composite import composite
from derive.lowering.trees.motion import STILL
from derive.lowering.trees.newton_euler import newton_euler
from derive.lowering.trees.sensitivities import by_state, derivatives
from derive.lowering.trees.tree_context import TreeContext
from derive.mechanics.axes import AXES


def inverse_dynamics(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the generalised forces f = M vdot + h of a motion."""
    parts = _prescribed(context)
    return kernel(context, function, context.counted("f"), *parts, inputs=context.reactions)


def _prescribed(context: TreeContext) -> list[Part]:
    motion = context.motion
    return [
        motion.frames(moving=True, placed=bool(context.springs)),
        motion.inertias(moving=True),
        *context.applied,
        *newton_euler(motion, context.gravity, ("f", 0), context.applied_array, ("vdot", 0)),
    ]


def gravity_compensation(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the generalised forces h that hold a tree without velocities."""
    return kernel(context, function, context.counted("f"), *_held(context))


def _held(context: TreeContext) -> list[Part]:
    motion = replace(context.motion, v=(STILL, 0))
    still: list[Statement] = [Work(STILL, len(context.rows), cleared=True)]
    return [
        ("still", "", "no velocities", still),
        motion.frames(moving=True, placed=bool(context.springs)),
        motion.inertias(moving=True),
        *context.applied_at(motion),
        *newton_euler(motion, context.gravity, ("f", 0), context.applied_array),
    ]


def centre_of_mass(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the centre of mass and of its velocity, with the derivative by the velocities."""
    motion, labels = context.motion, {"x": "x{}", "xdot": "x{}dot"}
    shape = centroid.shape_of(motion, 1, len(context.rows))
    results = {name: Result(tuple(label.format(k) for k in AXES)) for name, label in labels.items()}
    body = [*centroid.centre(motion), *centroid.columns(motion, "jacobian", shape)]
    text = "int rho x and int rho xdot, divided by the mass"
    parts = [*_sums(context), *_composite(context), ("centre", "", text, body)]
    return kernel(
        context, function, {**results, "jacobian": Result(pattern=shape), "m_total": Result(("m_total",))}, *parts
    )


def centroidal_momentum(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the momentum about the centre of mass as A(q) v."""
    motion = context.motion
    labels = tuple(f"{of}_{k}" for of in ("linear", "angular") for k in AXES)
    shape = centroid.shape_of(motion, 2, len(context.rows))
    body = [*centroid.about_centre(motion), *centroid.columns(motion, "A", shape)]
    parts = [
        *_sums(context),
        *_composite(context),
        ("momentum", "", "int rho xdot and int rho (x - centre) x xdot", body),
    ]
    return kernel(context, function, {"momentum": Result(labels), "A": Result(pattern=shape)}, *parts)


def _sums(context: TreeContext) -> list[Part]:
    motion = context.motion
    return [
        motion.frames(moving=True, placed=True),
        motion.inertias(moving=False),
        ("sums", "(1)", "momenta and first moment of all links", centroid.sums(motion)),
    ]


def _composite(context: TreeContext) -> list[Part]:
    return composite(context.motion, context.mass_pattern)[:2]


DERIVED: Mapping[FunctionKind, Callable[[TreeContext], list[Part]]] = {
    FunctionKind.INVERSE_DYNAMICS_JACOBIAN: _prescribed,
    FunctionKind.GRAVITY_COMPENSATION_JACOBIAN: _held,
    FunctionKind.CENTRE_OF_MASS_JACOBIAN: lambda of: [
        *_sums(of),
        ("centre", "", "the centre of mass", centroid.centre(of.motion)),
    ],
    FunctionKind.CENTROIDAL_MOMENTUM_JACOBIAN: lambda of: [
        *_sums(of),
        ("momentum", "", "momentum about it", centroid.about_centre(of.motion)),
    ],
}
"""The sections of the results whose derivatives functions have."""


def requested_jacobian(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the derivatives of a function by its arguments, the parameters and the inputs."""
    sizes = {"f": len(context.rows), "x": 3, "xdot": 3, "momentum": 6}
    (outputs,) = (DIFFERENTIATED[kind] for kind, jacobian in JACOBIANS.items() if jacobian is function.kind)
    rows = [(name, 0, sizes[name]) for name in outputs]
    results = {name: size for name, _, size in rows} | ({"m_total": 1} if "x" in outputs else {})
    along = by_state(context, *(name for name in function.arguments if name in ("q", "v", "vdot")))
    parts = DERIVED[function.kind](context)
    return derivatives(context, function, parts, results, along, rows=rows, inputs=context.reactions)
