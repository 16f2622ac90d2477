"""The lowering of trees of rigid bodies in relative coordinates to kernels with loops over their links."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from derive.ir.expressions import Element, Expr, Number
from derive.ir.indices import constant, variable
from derive.ir.kernel import Kernel
from derive.ir.model import Model, Variable
from derive.ir.statements import ForEach, Statement, StoreElement
from derive.lowering.flat.setup import setup_kernel
from derive.lowering.flat.setup_constants import Constants
from derive.lowering.instances.classes.known_motion import KnownMotion
from derive.lowering.instances.loop_code.context import Part, Result, kernel
from derive.lowering.instances.lower import _rows, _with_constants
from derive.lowering.instances.places import Places
from derive.lowering.model_functions import FunctionKind, ModelFunction, functions_of
from derive.lowering.symbol_variables import symbol_variable
from derive.lowering.trees.articulated import articulated
from derive.lowering.trees.link_loop import LinkArrays
from derive.lowering.trees.links import Tree, tree_of
from derive.lowering.trees.motion import TreeMotion
from derive.mechanics import quantity
from derive.mechanics.multibody.space.mechanism import SpatialMechanism


class TreeContext:
    """The data that the functions of a tree share; `known`: what is known of drives and loads."""

    def __init__(self, mechanism: SpatialMechanism, tree: Tree | None = None) -> None:
        self.mechanism, self.tree = mechanism, tree or tree_of(mechanism)
        self.known = KnownMotion(mechanism)
        self.constants = Constants(frozenset())
        self.constants.coefficients |= self.known.context.constants.coefficients
        self.known.context.constants = self.constants
        self.places = Places()
        self.coordinates = len(mechanism.coordinates)
        self.rows = tuple(row.name for row in mechanism.rows)
        self.motion = TreeMotion(self.tree, LinkArrays(self.tree.links, self.places, self.constants))
        gravity, _ = quantity.gravity(mechanism.scene.gravity)
        values = [Fraction(int(g.value.p), int(g.value.q)) for g in gravity] or [Fraction(0)] * 3
        self.gravity = [Number(value) for value in values]


def _accelerations(context: TreeContext) -> list[Part]:
    return [
        context.motion.frames(moving=True),
        context.motion.inertias(moving=True),
        *articulated(context.motion, context.gravity, False),
    ]


def accel(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of vdot alone."""
    results = {"vdot": Result(("body by body",), count=len(context.rows))}
    return kernel(context, function, results, *_accelerations(context))


FUNCTIONS: Mapping[FunctionKind, Callable[[TreeContext, ModelFunction], Kernel]] = {
    FunctionKind.ACCEL: accel,
}
