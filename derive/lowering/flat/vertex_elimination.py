"""Derivatives by elimination of the vertices of the computational graph, where that takes fewer operations.

The derivative of a value is a sum over all paths through its graph from a variable, of products of the derivatives of
the operations on them. To eliminate a vertex replaces all pairs of an edge to it and an edge from it by edges past it.
The vertex of the smallest Markowitz degree (in x out - in - out) is next, so that the few vertices through which all
paths lead, such as the rotation of a section or the acceleration of a frame, become factors of what is behind them.
"""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from dataclasses import dataclass, field

import casadi as ca

from derive.lowering.flat.casadi_symbols import Symbols, added, multiplied

_X, _Y = ca.SX.sym("x"), ca.SX.sym("y")
ONE = ca.SX(1)

Matrix = dict[tuple[int, int], ca.SX]


def fewest_operations(symbols: Symbols, candidates: Sequence[list[ca.SX]]) -> list[ca.SX]:
    """The first of several forms of the same values that takes the fewest operations."""
    return min(candidates, key=lambda values: _instructions(symbols, values).n_instructions())


def by_elimination(symbols: Symbols, rows: Sequence[ca.SX], y: Sequence[ca.SX], rates: Sequence[ca.SX]) -> Matrix:
    """dF/dy + dF/dydot cj of the rows F by row and column; rates: the elements of ydot, whose factor cj is the last."""
    *ydot, cj = rates
    graph = _Graph()
    columns = {graph.input(symbol): j for j, symbol in enumerate(y)}
    for symbol, rate in zip(y, ydot, strict=True):
        graph.edges_to[graph.input(rate)] = {graph.input(symbol): cj}
    results = graph.read(symbols, rows)
    graph.keep(columns, results)
    graph.eliminate({*columns, *results})
    return {(i, columns[j]): value for i, end in enumerate(results) for j, value in graph.edges_to[end].items()}


@dataclass
class _Graph:
    """Vertices with the edges to them, whose values are partial derivatives, and the vertices behind them."""

    values: list[ca.SX] = field(default_factory=list)
    edges_to: list[dict[int, ca.SX]] = field(default_factory=list)
    behind: list[set[int]] = field(default_factory=list)
    inputs: dict[int, int] = field(default_factory=dict)

    def add(self, value: ca.SX, edges: dict[int, ca.SX]) -> int:
        """A new vertex."""
        self.values.append(value)
        self.edges_to.append(edges)
        return len(self.values) - 1

    def input(self, symbol: ca.SX) -> int:
        """The vertex of a symbol."""
        key = symbol.element_hash()
        if key not in self.inputs:
            self.inputs[key] = self.add(symbol, {})
        return self.inputs[key]

    def read(self, symbols: Symbols, rows: Sequence[ca.SX]) -> list[int]:
        """Add the operations of rows; returns a vertex for each row, behind which there are no others."""
        function = _instructions(symbols, rows)
        work: dict[int, int] = {}
        results = [0] * len(rows)
        for k in range(function.n_instructions()):
            operation, inputs, outputs = (
                function.instruction_id(k),
                function.instruction_input(k),
                function.instruction_output(k),
            )
            if operation == ca.OP_OUTPUT:
                results[outputs[1]] = work[inputs[0]]
            elif operation == ca.OP_INPUT:
                work[outputs[0]] = self.input(symbols.inputs[inputs[1]])
            elif operation == ca.OP_CONST:
                work[outputs[0]] = self.add(ca.SX(function.instruction_constant(k)), {})
            else:
                args = [work[arg] for arg in inputs]
                of = [self.values[arg] for arg in args]
                value = ca.SX.unary(operation, *of) if len(of) == 1 else ca.SX.binary(operation, *of)
                edges: dict[int, ca.SX] = {}
                for arg, partial in zip(args, _partials(operation, of), strict=True):
                    if not partial.is_zero():
                        edges[arg] = added(edges[arg], partial) if arg in edges else partial
                work[outputs[0]] = self.add(value, edges)
        return [self.add(self.values[result], {result: ONE}) for result in results]

    def keep(self, variables: Sequence[int] | dict[int, int], results: Sequence[int]) -> None:
        """Leave out the edges that are on no path from a variable to a result."""
        self.behind = [set() for _ in self.values]
        for vertex, edges in enumerate(self.edges_to):
            for start in edges:
                self.behind[start].add(vertex)
        reached = _reachable(variables, self.behind)
        before = _reachable(results, self.edges_to)
        kept = reached & before
        for vertex, edges in enumerate(self.edges_to):
            alive = vertex in kept
            self.edges_to[vertex] = {start: value for start, value in edges.items() if alive and start in kept}
            self.behind[vertex] &= kept if alive else set()

    def eliminate(self, without: set[int]) -> None:
        """Eliminate all vertices with edges, except for some."""
        degrees = {v: self._degree(v) for v, edges in enumerate(self.edges_to) if edges and v not in without}
        waiting = [(degree, vertex) for vertex, degree in degrees.items()]
        heapq.heapify(waiting)
        while waiting:
            degree, vertex = heapq.heappop(waiting)
            if degrees.get(vertex) != degree:
                continue  # eliminated, or waiting with another degree
            del degrees[vertex]
            for near in sorted(self._bypass(vertex)):
                if near in degrees and (new := self._degree(near)) != degrees[near]:
                    degrees[near] = new
                    heapq.heappush(waiting, (new, near))

    def _degree(self, vertex: int) -> int:
        before, behind = len(self.edges_to[vertex]), len(self.behind[vertex])
        return before * behind - before - behind

    def _bypass(self, vertex: int) -> set[int]:
        """Replace the edges of a vertex by edges past it; returns its neighbours."""
        edges = self.edges_to[vertex]
        for start in edges:
            self.behind[start].remove(vertex)
        for end in sorted(self.behind[vertex]):
            ahead = self.edges_to[end].pop(vertex)
            for start, value in edges.items():
                product = multiplied(ahead, value)
                old = self.edges_to[end].get(start)
                self.edges_to[end][start] = product if old is None else added(old, product)
                self.behind[start].add(end)
        return {*edges, *self.behind[vertex]}


def _reachable(
    starts: Sequence[int] | dict[int, int], edges: Sequence[set[int]] | Sequence[dict[int, ca.SX]]
) -> set[int]:
    """The vertices to which edges lead from some vertices, which are among them."""
    known, waiting = {*starts}, [*starts]
    while waiting:
        further = [vertex for vertex in edges[waiting.pop()] if vertex not in known]
        known.update(further)
        waiting += further
    return known


def _partials(operation: int, args: Sequence[ca.SX]) -> list[ca.SX]:
    """The derivatives of an operation with respect to its operands."""
    if operation == ca.OP_ADD:
        return [ONE, ONE]
    if operation == ca.OP_SUB:
        return [ONE, -ONE]
    if operation == ca.OP_MUL:
        return [args[1], args[0]]
    variables = [_X, _Y][: len(args)]
    value = ca.SX.unary(operation, _X) if len(args) == 1 else ca.SX.binary(operation, _X, _Y)
    column = ca.vertcat(*variables)
    return [ca.substitute(ca.jacobian(value, x), column, ca.vertcat(*args)) for x in variables]


def _instructions(symbols: Symbols, values: Sequence[ca.SX]) -> ca.Function:
    """The instructions of some values, without common sub-expressions."""
    options = {"cse": True, "live_variables": False}
    return ca.Function("values", [ca.vertcat(*symbols.inputs)], [ca.densify(ca.vertcat(*values))], options)
