"""The functions of markers: the motion of each, and the generalised forces of a load at it.

Each runs the loop of its class for a single body, so that the class is lowered once.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from derive.ir.indices import constant
from derive.ir.model import Argument, Kernel
from derive.ir.patterns import ColumnGroup, Pattern, RowSet, RowSetKind, block_pattern, pattern
from derive.ir.statements import Clear, ForEach, Statement
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import array_input, define, stores
from derive.lowering.flat.schedule import Step
from derive.lowering.instances.class_code import ClassCode, LoopTarget
from derive.lowering.instances.context import InstanceContext, Result, given_inputs, kernel, state
from derive.lowering.model_functions import ModelFunction
from derive.mechanics.terms import MarkerEquations
from derive.spec.model.instances import identifier

MOST_MARKERS = 64
"""The largest number of markers that have functions, whose text grows with it."""


class Markers:
    """The markers of a mechanism that do not depend on the time, with the loops of their classes.

    left_out: the number of markers without functions, since there are too many.
    """

    def __init__(self, context: InstanceContext) -> None:
        self.context = context
        every = dict(_every(context))
        self.left_out = len(every) if len(every) > MOST_MARKERS else 0
        self._at = {} if self.left_out else every
        self._motions: dict[tuple[str, str], ForEach] = {}
        self._loads: dict[tuple[str, str], ForEach] = {}

    @property
    def equations(self) -> tuple[MarkerEquations, ...]:
        """The markers under their names, in the order of the bodies."""
        return tuple(replace(m, name=name, doc=doc) for name, (_, _, m, doc) in self._at.items())

    def motion(self, context: InstanceContext, function: ModelFunction) -> Kernel:
        """The kernel of the position, the velocity and the Jacobian d(velocity)/dv of a marker."""
        of, number, marker, _ = self._at[function.variant]
        key = of.name, marker.name
        if key not in self._motions:
            self._motions[key] = _motion_loop(of, marker)
        results = {
            "x": Result(("x1", "x2")),
            "xdot": Result(("x1dot", "x2dot")),
            "jacobian": Result(pattern=self._pattern(of, number, marker)),
        }
        body = [_only(self._motions[key], number)]
        return kernel(
            context, function, results, ("marker", "(1)", "x = c + Q r, its time derivative and its Jacobian", body)
        )

    def load(self, context: InstanceContext, function: ModelFunction) -> Kernel:
        """The kernel of the generalised forces of a force at a marker."""
        of, number, marker, _ = self._at[function.variant]
        key = of.name, marker.name
        if key not in self._loads:
            self._loads[key] = _load_loop(of, marker)
        force = array_input("F", marker.force, "force at the marker, in the inertial frame [N]")
        count = len(context.rows)
        results = {"f": Result(tuple(f"f[{name}]" for name in context.rows))}
        body: list[Statement] = [Clear("f", count), _only(self._loads[key], number)]
        inputs: dict[str, Argument] = {"F": force.argument}
        return kernel(context, function, results, ("f", "(10)", "virtual work of the force", body), inputs=inputs)

    def _pattern(self, of: ClassCode, number: int, marker: MarkerEquations) -> Pattern:
        """The pattern of the Jacobian: the columns of the body between columns of zeros."""
        matrix, first = marker.jacobian, of.of.members[number].coordinate
        own = [
            ColumnGroup(1, tuple(RowSet(RowSetKind.ROW, i, 1) for i in range(2) if matrix[i, j] != 0))
            for j in range(matrix.cols)
        ]
        after = len(self.context.rows) - first - matrix.cols
        groups = (ColumnGroup(first, ()), *own, ColumnGroup(after, ()))
        return block_pattern(2, tuple(group for group in groups if group.count))


def _every(context: InstanceContext) -> Iterator[tuple[str, tuple[ClassCode, int, MarkerEquations, str]]]:
    """The markers by their names: the class of each, the number of its body there, its equations, and its text."""
    bodies = sorted(
        (m.number, k, number) for k, of in enumerate(context.classes) for number, m in enumerate(of.of.members)
    )
    for _, k, number in bodies:
        of = context.classes[k]
        component = of.of.members[number].instance.component
        first = of.of.first.instance.component
        named = {marker.name: marker for marker in of.context.equations.markers}
        for name in component.markers:
            marker = named.get(identifier(first.specified, name))
            if marker is not None:
                doc = marker.doc.replace(first.name, component.name)
                yield identifier(component.specified, name), (of, number, marker, doc)


def _only(loop: ForEach, number: int) -> ForEach:
    """The loop over instances for one of them."""
    return replace(loop, start=constant(number), stop=constant(number + 1))


def _motion_loop(of: ClassCode, marker: MarkerEquations) -> ForEach:
    symbols = of.context.symbols(*given_inputs(of, "q", "v"))
    named = define(symbols, tuple(d for d in marker.definitions if not d.zero))
    matrix = marker.jacobian
    shape = pattern(2, matrix.cols, {(i, j) for i in range(2) for j in range(matrix.cols) if matrix[i, j] != 0})
    items = (
        *stores("x", [symbols(e) for e in marker.position]),
        *stores("xdot", [symbols(e) for e in marker.velocity]),
        *stores("jacobian", [symbols(matrix[i, j]) for i, j in shape.entries]),
    )
    targets = {name: LoopTarget(name, constant) for name in ("x", "xdot", "jacobian")}
    steps = (Step("r", "(14)", "", named), Step("marker", "(1)", "", items))
    return of.loop(symbols, steps, state(of, "q", "v"), targets)


def _load_loop(of: ClassCode, marker: MarkerEquations) -> ForEach:
    force = array_input("F", marker.force, "")
    symbols: Symbols = of.context.symbols(*given_inputs(of, "q"), force)
    named = (
        *define(symbols, marker.force_definitions),
        *define(symbols, tuple(d for d in marker.definitions if not d.zero)),
    )
    steps = (Step("F", "(10)", "", named), Step("f", "(10)", "", stores("f", [symbols(e) for e in marker.load])))
    return of.loop(symbols, steps, state(of, "q"), {"f": of.target("f", of.coordinate)})
