"""The functions of markers: the motion of each, and the generalised forces of a load at it.

The markers of one name of all bodies of a class have one function, whose argument is the number of the instance.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from derive.ir.indices import constant, variable
from derive.ir.kernel import Argument, Kernel
from derive.ir.model import MarkerClass, Variable
from derive.ir.patterns import Pattern, pattern
from derive.ir.statements import Clear, ForEach, Statement
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import array_input, define, stores
from derive.lowering.flat.schedule import Step
from derive.lowering.instances.loop_code.class_code import ClassCode, LoopTarget
from derive.lowering.instances.loop_code.context import InstanceContext, given_inputs, state
from derive.lowering.instances.loop_code.kernels import Result, kernel
from derive.lowering.model_functions import ModelFunction
from derive.mechanics.terms import MarkerEquations
from derive.spec.model.instances import identifier, joined, skeleton, text_of_instances

NUMBER = "number"
"""The argument that is the number of an instance."""


class Markers:
    """The markers of a mechanism that do not depend on the time; `classes` have one function each."""

    def __init__(self, context: InstanceContext) -> None:
        self.context = context
        self._of: dict[str, tuple[ClassCode, MarkerEquations]] = {}
        self.classes = tuple(
            self._class(of, identifier(title, name), name, marker)
            for title, of in context.marker_classes.items()
            for name, marker in _markers(of)
        )

    def _class(self, of: ClassCode, function: str, name: str, marker: MarkerEquations) -> MarkerClass:
        self._of[function] = of, marker
        shown = [joined(m.instance.component.specified, name) for m in of.of.members]
        return MarkerClass(
            function,
            _doc(of, marker),
            _pattern(marker),
            tuple(Variable(identifier(text), "", "m", shown=text) for text in shown),
            tuple(m.row for m in of.of.members),
        )

    @property
    def equations(self) -> tuple[MarkerEquations, ...]:
        """The markers of the first instances, under the names of the functions."""
        return tuple(replace(self._of[c.name][1], name=c.name, doc=c.doc) for c in self.classes)

    def motion(self, context: InstanceContext, function: ModelFunction) -> Kernel:
        """The kernel of the position, the velocity and the Jacobian d(velocity)/dv of the marker of an instance."""
        of, marker = self._of[function.variant]
        labels = tuple(f"x{k}" for k in range(1, len(marker.position) + 1))
        results = {
            "x": Result(labels),
            "xdot": Result(tuple(f"{label}dot" for label in labels)),
            "jacobian": Result(pattern=_pattern(marker)),
        }
        text = "x = c + Q r, its time derivative and its Jacobian"
        section = "marker", "(1)", text, [_only(_motion_loop(of, marker))]
        return kernel(context, _of_instance(function), results, section, inputs=_number(of))

    def load(self, context: InstanceContext, function: ModelFunction) -> Kernel:
        """The kernel of the generalised forces of a force at the marker of an instance."""
        of, marker = self._of[function.variant]
        force = array_input("F", marker.force, "force at the marker, in the inertial frame [N]")
        count = len(context.rows)
        body: list[Statement] = [Clear("f", count), _only(_load_loop(of, marker))]
        section = "f", "(10)", "virtual work of the force", body
        inputs = {**_number(of), "F": force.argument}
        return kernel(
            context, _of_instance(function), {"f": Result(("body by body",), count=count)}, section, inputs=inputs
        )


def _markers(of: ClassCode) -> Iterator[tuple[str, MarkerEquations]]:
    """The markers of the first body of a class by their names."""
    component = of.of.first.instance.component
    named = {marker.name: marker for marker in of.context.equations.markers}
    every = ((name, named.get(identifier(component.specified, name))) for name in component.markers)
    return ((name, marker) for name, marker in every if marker is not None)


def _doc(of: ClassCode, marker: MarkerEquations) -> str:
    """The description of the markers of all instances."""
    first = of.of.first.instance.name
    texts = [marker.doc.replace(first, m.instance.name) for m in of.of.members]
    if len(set(map(skeleton, texts))) > 1:
        return f"{texts[0]} and of bodies like it"
    return text_of_instances(texts, 0)


def _of_instance(function: ModelFunction) -> ModelFunction:
    """A function with the number of the instance as its first argument."""
    return replace(function, arguments=(NUMBER, *function.arguments))


def _number(of: ClassCode) -> dict[str, Argument]:
    """The argument that is the number of the instance."""
    doc = f"number i of the body, 0 .. {of.count - 1}"
    return {NUMBER: Argument(NUMBER, (), doc, scalar=True, integer=True)}


def _pattern(marker: MarkerEquations) -> Pattern:
    """The pattern of the Jacobian in the generalised velocities of the body."""
    matrix = marker.jacobian
    rows = range(matrix.rows)
    return pattern(matrix.rows, matrix.cols, {(i, j) for i in rows for j in range(matrix.cols) if matrix[i, j] != 0})


def _only(loop: ForEach) -> ForEach:
    """The loop over instances for one of them."""
    return replace(loop, start=variable(NUMBER), stop=variable(NUMBER, offset=1))


def _motion_loop(of: ClassCode, marker: MarkerEquations) -> ForEach:
    symbols = of.context.symbols(*given_inputs(of, "q", "v"))
    named = define(symbols, tuple(d for d in marker.definitions if not d.zero))
    items = (
        *stores("x", [symbols(e) for e in marker.position]),
        *stores("xdot", [symbols(e) for e in marker.velocity]),
        *stores("jacobian", [symbols(marker.jacobian[i, j]) for i, j in _pattern(marker).entries]),
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
    return of.loop(symbols, steps, state(of, "q"), {"f": of.target("f", of.row)})
