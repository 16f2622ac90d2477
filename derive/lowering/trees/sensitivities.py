"""Derivatives of the functions of trees by states, parameters and inputs, from the loops that compute these functions.

A parameter acts through constants of links, which are expressions of parameters, and through what is known of drives
and loads; the derivatives of both are computed in setup and before the loops.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from derive.algebra import sp
from derive.ir.analysis import reads
from derive.ir.expressions import Expr, ScalarRef
from derive.ir.kernel import Argument, Kernel
from derive.ir.statements import Statement, Work
from derive.lowering.instances.loop_code.kernels import Part, Result, kernel
from derive.lowering.model_functions import ModelFunction
from derive.lowering.trees.forms import TreeForm
from derive.lowering.trees.tangents import ONE, Directions, LoopTangents, Rows
from derive.lowering.trees.tree_context import TreeContext


def derivatives(
    context: TreeContext,
    function: ModelFunction,
    parts: Iterable[Part],
    results: Mapping[str, int],
    directions: Iterable[Directions],
    *,
    rows: Sequence[Rows] = (),
    inputs: Mapping[str, Argument] | None = None,
    by_parameters: bool = True,
) -> Kernel:
    """The kernel of the derivatives of rows along directions, and by parameters and inputs.

    parts: the sections that compute the rows; results: the sizes of the arrays that they write; rows: these arrays one
    after the other, or parts of them. Without `by_parameters`, all entries of the diagonal belong to the pattern.
    """
    local: list[Statement] = [Work(name, size) for name, size in results.items()]
    made = [("results", "", "what the loops compute, which have the derivatives", local)]
    made += [(name, equation, text, [*body]) for name, equation, text, body in parts]
    sizes = {"q": context.coordinates, "v": len(context.rows), "u": len(context.inputs)}
    sizes |= {name: argument.size for name, argument in (inputs or {}).items() if not argument.scalar}
    every = [*directions, *(by_parameters_and_inputs(context, made) if by_parameters else ())]
    statements = [statement for *_, body in made for statement in body]
    whole_arrays = [(name, 0, size) for name, size in results.items()]
    arrays, name = context.motion.arrays, function.name
    of = LoopTangents(arrays, name, statements, sizes, rows or whole_arrays, every, not by_parameters)
    section = "jac", "", "derivatives, column by column", of.columns("jac")
    return kernel(context, function, {"jac": Result(pattern=of.pattern)}, *made, section, inputs=inputs)


def by_state(context: TreeContext, *names: str) -> Iterator[Directions]:
    """Yield the columns of q, v or vdot, by their names."""
    for name in names:
        yield Directions(name, context.coordinates if name == "q" else len(context.rows), ((name, 0, ONE),))


def by_parameters_and_inputs(context: TreeContext, parts: Iterable[Part]) -> Iterator[Directions]:
    """Yield the columns of parameters and those of inputs, for what sections read."""
    read = {name for *_, body in parts for statement in body for name in reads(statement)}
    parameters, known = context.mechanism.parameters, context.known.derivatives.columns
    scalars: dict[str, dict[int, Expr]] = {
        str(s): {j: ScalarRef(str(x)) for j, x in by.items()} for s, by in known.items() if str(s) in read
    }
    constants = [(name, expr) for expr, name in context.motion.arrays.parametric.items() if name in read]
    for name, expr in constants:
        slopes = {j: _slope(expr, str(p.symbol)) for j, p in enumerate(parameters)}
        scalars[name] = {j: context.leaf(slope) for j, slope in slopes.items() if slope != 0}
    count = len(parameters)
    for name, first, size, seeds in (("p", 0, count, ()), ("u", count, len(context.inputs), (("u", 0, ONE),))):
        own = {s: {j - first: x for j, x in by.items() if first <= j < first + size} for s, by in scalars.items()}
        yield Directions(name, size, seeds, {s: by for s, by in own.items() if by})


def _slope(expr: sp.Expr, parameter: str) -> sp.Expr:
    """The derivative by a parameter, whatever the assumptions of its symbol are."""
    return sp.Add(*(sp.diff(expr, symbol) for symbol in expr.free_symbols if symbol.name == parameter))


def parameter_jacobian(context: TreeContext, function: ModelFunction) -> Kernel:
    """The kernel of the derivatives of the rows of all forms, and of the outputs, by the parameters and the inputs."""
    form, count, m = TreeForm(context, "index1"), len(context.rows), context.multipliers
    outputs = len(context.outputs or ())  # motions of joints, which depend on neither
    parts = [*form.parts(), ("conditions", "(1)", "the constraints and their rates", form.conditions("g", "gdot"))]
    first = context.coordinates
    rows = [("F", first, count), ("g", 0, m), ("gdot", 0, m), ("F", first + count, m), ("out", 0, outputs)]
    sizes = {"F": form.size, "g": m, "gdot": m, "out": outputs}
    return derivatives(context, function, parts, sizes, (), rows=rows, inputs=form.arguments)
