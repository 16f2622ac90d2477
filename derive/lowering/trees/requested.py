"""The functions of trees on request: inverse dynamics, gravity compensation, centre of mass, centroidal momentum."""

from __future__ import annotations

from dataclasses import replace

from derive.ir.kernel import Kernel
from derive.ir.statements import Statement, Work
from derive.lowering.instances.loop_code.context import Part, Result, kernel
from derive.lowering.model_functions import ModelFunction
from derive.lowering.trees import centroid
from derive.lowering.trees.composite import composite
from derive.lowering.trees.motion import STILL
from derive.lowering.trees.newton_euler import newton_euler
from derive.lowering.trees.tree_context import TreeContext


def inverse_dynamics(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the generalised forces f = M vdot + h of a motion."""
    motion, target = context.motion, ("f", 0)
    parts = [
        motion.frames(moving=True, placed=bool(context.springs)),
        motion.inertias(moving=True),
        *context.applied,
        *newton_euler(motion, context.gravity, target, context.applied_array, ("vdot", 0)),
    ]
    return kernel(context, function, context.counted("f"), *parts, inputs=context.reactions)


def gravity_compensation(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the generalised forces h that hold a tree without velocities."""
    motion = replace(context.motion, v=(STILL, 0))
    still: list[Statement] = [Work(STILL, len(context.rows), cleared=True)]
    parts = [
        ("still", "", "no velocities", still),
        motion.frames(moving=True, placed=bool(context.springs)),
        motion.inertias(moving=True),
        *context.applied_at(motion),
        *newton_euler(motion, context.gravity, ("f", 0), context.applied_array),
    ]
    return kernel(context, function, context.counted("f"), *parts)


def centre_of_mass(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the centre of mass and of its velocity, with the derivative by the velocities."""
    motion, labels = context.motion, {"x": "x{}", "xdot": "x{}dot"}
    shape = centroid.shape_of(motion, 1, len(context.rows))
    results = {name: Result(tuple(label.format(k) for k in (1, 2, 3))) for name, label in labels.items()}
    body = [*centroid.centre(motion), *centroid.columns(motion, "jacobian", shape)]
    parts = [*_momentum_parts(context), ("centre", "", "int rho x and int rho xdot, divided by the mass", body)]
    return kernel(
        context, function, {**results, "jacobian": Result(pattern=shape), "m_total": Result(("m_total",))}, *parts
    )


def centroidal_momentum(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the momentum about the centre of mass as A(q) v."""
    motion = context.motion
    labels = tuple(f"{of}_{k}" for of in ("linear", "angular") for k in (1, 2, 3))
    shape = centroid.shape_of(motion, 2, len(context.rows))
    body = [*centroid.about_centre(motion), *centroid.columns(motion, "A", shape)]
    parts = [*_momentum_parts(context), ("momentum", "", "int rho xdot and int rho (x - centre) x xdot", body)]
    return kernel(context, function, {"momentum": Result(labels), "A": Result(pattern=shape)}, *parts)


def _momentum_parts(context: TreeContext) -> list[Part]:
    motion = context.motion
    return [
        motion.frames(moving=True, placed=True),
        motion.inertias(moving=False),
        ("sums", "(1)", "momenta and first moment of all links", centroid.sums(motion)),
        *composite(motion, context.mass_pattern)[:2],
    ]
