"""The data that the functions of a tree share: its links, loads, outputs and constant arrays."""

from __future__ import annotations

from fractions import Fraction
from functools import cached_property

from derive.algebra import sp
from derive.ir.expressions import Expr, Number, ScalarRef
from derive.ir.kernel import Argument
from derive.ir.patterns import Pattern
from derive.lowering.flat.setup_constants import Constants
from derive.lowering.instances.classes.known_motion import KnownMotion, canonical
from derive.lowering.instances.loop_code.kernels import Part, Result, whole
from derive.lowering.instances.places import Places
from derive.lowering.trees import joint_outputs, loads, marker_loads
from derive.lowering.trees.composite import mass_pattern
from derive.lowering.trees.condition_loops import ConditionLoops
from derive.lowering.trees.conditions import conditions_of
from derive.lowering.trees.exact_numbers import exact
from derive.lowering.trees.link_loop import LinkArrays
from derive.lowering.trees.links import Tree, tree_of
from derive.lowering.trees.marker_springs import spring_groups
from derive.lowering.trees.motion import TreeMotion
from derive.lowering.trees.row_loads import row_loads
from derive.mechanics import quantity
from derive.mechanics.multibody.ports import input_symbols
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from derive.mechanics.symbols import local
from derive.mechanics.terms import ModelConstant


class TreeContext:
    """The data that the functions of a tree share.

    known: the values of loads that depend on the time; motion: the loops over the links; gravity: its components.
    """

    def __init__(self, mechanism: SpatialMechanism, tree: Tree | None = None) -> None:
        """tree: that of the mechanism, unless a benchmark has another one."""
        self.mechanism, self.tree = mechanism, tree or tree_of(mechanism)
        self.known, self.loads = KnownMotion(mechanism), row_loads(mechanism)
        self.at_markers = marker_loads.marker_loads(mechanism, self.tree)
        self.springs = spring_groups(mechanism, self.tree)
        self.inputs = inputs = tuple(given.symbol for given in input_symbols(mechanism.scene))
        self.conditions = conditions_of(mechanism, self.tree)
        given = (
            *loads.definitions(self.loads, inputs),
            *self.at_markers.definitions,
            *self.conditions.definitions,
        )
        self.known.definitions = (*self.known.definitions, *given)
        self.constants = Constants(frozenset())
        self.constants.coefficients |= self.known.context.constants.coefficients
        self.known.context.constants = self.constants
        self.places = Places()
        self.coordinates = len(mechanism.coordinates)
        self.rows = tuple(row.name for row in mechanism.rows)
        self.motion = TreeMotion(self.tree, LinkArrays(self.tree.links, self.places, self.constants))
        self.outputs = joint_outputs.joint_outputs(mechanism)
        gravity, _ = quantity.gravity(mechanism.scene.gravity)
        self.has_gravity = bool(mechanism.scene.gravity)
        self.gravity = [*map(self.leaf, (g.value for g in gravity))] or [Number(Fraction(0))] * 3

    def constrained(self, motion: TreeMotion) -> ConditionLoops:
        """The code of the constraints for a state in these arrays."""
        mechanism = self.mechanism
        return ConditionLoops(
            motion,
            self.conditions,
            [c.q for c in mechanism.coordinates],
            [row.v for row in mechanism.rows],
            frozenset(p.symbol for p in mechanism.parameters),
        )

    def leaf(self, value: sp.Expr) -> Expr:
        """A number, or the constant of setup that is an expression of parameters."""
        number, known = exact(value), self.motion.arrays.parametric
        if isinstance(number, Fraction):
            return Number(number)
        return ScalarRef(known.setdefault(number, f"of_parameters_{len(known)}"))

    @property
    def of_parameters(self) -> tuple[ModelConstant, ...]:
        """The constants of setup that are expressions of parameters."""
        made = tuple(
            ModelConstant(local(name), sp.sympify(expr), "", f"number of links, {expr}", "")
            for expr, name in self.motion.arrays.parametric.items()
        )
        return canonical(made, self.mechanism)

    @cached_property
    def mass_pattern(self) -> Pattern:
        """The pattern of M."""
        return mass_pattern(self.motion, len(self.rows))

    @property
    def multipliers(self) -> int:
        """The number of constraints."""
        return len(self.conditions.every)

    @property
    def applied(self) -> list[Part]:
        """The section of the loads."""
        return self.applied_at(self.motion)

    def applied_at(self, motion: TreeMotion, in_tree: bool = False) -> list[Part]:
        """The section of the loads for a state in other arrays; in_tree: see `TreeMotion.frames`."""
        body = loads.applied(motion, self.loads, self.inputs, len(self.rows))
        acting = marker_loads.acting(motion, self.at_markers)
        springs = [group.acting(motion, in_tree) for group in self.springs]
        return [("loads", "(10)", "generalised forces of loads and springs", [*body, *acting, *springs])]

    @property
    def applied_array(self) -> str:
        """The array of the generalised forces, if there are any."""
        return loads.APPLIED if self.loads.any else ""

    @property
    def reactions(self) -> dict[str, Argument]:
        """The arguments of accelerations and multipliers."""
        return {
            "vdot": whole("vdot", len(self.rows), "accelerations, as from solve"),
            "lam": whole("lam", self.multipliers, "constraint reactions, as from solve"),
        }

    def counted(self, *names: str) -> dict[str, Result]:
        """Outputs with an element for each row."""
        return {name: Result(("row by row",), count=len(self.rows)) for name in names}
