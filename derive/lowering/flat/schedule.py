"""From a graph to sections: what is used, what gets a name, and in which order it is computed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import count

import casadi as ca

from derive.ir.expressions import Expr, Number, Operation, Operator, ScalarRef
from derive.ir.model import Section
from derive.ir.statements import Let, Require, Requirement, ReturnCode, Statement, Store
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.graph import Graph, LoweringError, read


@dataclass(frozen=True)
class Named:
    """A value that keeps its name from the derivation, if anything uses it."""

    name: str
    value: ca.SX


@dataclass(frozen=True)
class Stored:
    """A value that goes to an output."""

    output: str
    index: int
    value: ca.SX


@dataclass(frozen=True)
class Required:
    """A value that must be `positive` or `finite`; else the kernel returns `code`."""

    kind: Requirement
    value: ca.SX
    code: ReturnCode
    text: str


Want = Named | Stored | Required


@dataclass(frozen=True)
class Step:
    """What one section computes, as CasADi scalars."""

    name: str
    equation: str
    doc: str
    wants: tuple[Want, ...]


Located = tuple[Step, list[tuple[Want, int]]]
"""A step with the graph node of each thing it wants."""


def schedule(
    graph: Graph,
    symbols: Symbols,
    definitions: tuple[Step, ...],
    steps: tuple[Step, ...],
    temporaries: Iterator[str] | None = None,
) -> tuple[Section, ...]:
    """Sections with a `Let` for what has a name or is used more than once; others are inserted where used.

    A section of definitions comes just before the first step that needs it. All is read back from CasADi at once, so
    that it shares. A requirement on constants alone goes to setup. `temporaries` are names for what has none.
    """
    every = (*definitions, *steps)
    nodes = iter(read(graph, symbols, [want.value for step in every for want in step.wants]))
    located = [(step, [(want, next(nodes)) for want in step.wants]) for step in every]
    for _, wants in located:
        wants[:] = [(w, node) for w, node in wants if not (isinstance(w, Required) and _moved_to_setup(graph, w, node))]
    fresh = temporaries or (f"t{k}" for k in count(1))
    writer = _Writer(graph, [pair for _, wants in located for pair in wants], fresh)
    ordered = _when_needed(graph, located[: len(definitions)], located[len(definitions) :])
    sections = (Section(step.name, step.equation, step.doc, writer.body(wants)) for step, wants in ordered)
    return tuple(section for section in sections if section.body)


def _when_needed(graph: Graph, definitions: list[Located], steps: list[Located]) -> list[Located]:
    """Steps, each behind the definitions that it is the first to need."""
    ordered: list[Located] = []
    waiting = list(definitions)
    for step in steps:
        behind = _uses(graph, [node for _, node in step[1]])
        needed = [d for d in waiting if any(behind[node] for _, node in d[1])]
        waiting = [d for d in waiting if d not in needed]
        ordered += [*needed, step]
    return ordered


def _moved_to_setup(graph: Graph, want: Required, node: int) -> bool:
    if not graph.is_constant(node):
        return False
    number = graph.value(node)
    if number is not None and want.kind is Requirement.POSITIVE and number <= 0:
        raise LoweringError(
            f"{want.text}, whatever the state: shapes are too nearly dependent to compute with (make them orthogonal), "
            "or joints hold the same bodies twice (leave one out)"
        )
    graph.constants.require(want.kind, graph.expr(node), want.code, want.text)
    return True


class _Writer:
    def __init__(self, graph: Graph, wants: list[tuple[Want, int]], temporaries: Iterator[str]) -> None:
        self.graph = graph
        self.temporaries = temporaries
        self.uses = _uses(graph, [node for want, node in wants if not isinstance(want, Named)])
        self.names = {node: want.name for want, node in reversed(wants) if isinstance(want, Named)}
        self.divisors = _divisors(graph, self.uses)
        self.written: dict[int, str] = {}
        self.inverses: dict[int, str] = {}

    def body(self, wants: list[tuple[Want, int]]) -> tuple[Statement, ...]:
        out: list[Statement] = []
        for want, node in wants:
            if isinstance(want, Named):
                if self.uses[node]:
                    self._expr(node, out)
                continue
            expr = self._expr(node, out)
            if isinstance(want, Stored):
                out.append(Store(want.output, want.index, expr))
            else:
                out.append(Require(want.kind, expr, want.code, want.text))
        return tuple(out)

    def _expr(self, node: int, out: list[Statement]) -> Expr:
        """The expression of a node; what it needs and has a name is written to `out` before."""
        n = self.graph.nodes[node]
        if n.leaf is not None:
            return n.leaf
        if node in self.written:
            return ScalarRef(self.written[node])
        if n.kind is Operator.NEG and self._stands_alone(n.args[0]):
            expr = self._negative(n.args[0], out)
        elif n.kind is Operator.DIV and self.divisors[n.args[1]] > 1:
            if self.graph.value(n.args[0]) == 1:
                return self._inverse(n.args[1], out)
            expr = Operation(Operator.MUL, (self._expr(n.args[0], out), self._inverse(n.args[1], out)))
        else:
            expr = Operation(n.operator, tuple(self._expr(a, out) for a in n.args))
        if self._stands_alone(node):
            return expr
        self.written[node] = self.names.get(node) or self._next_name()
        out.append(Let(self.written[node], expr))
        return ScalarRef(self.written[node])

    def _negative(self, node: int, out: list[Statement]) -> Expr:
        """-(a + b) as -a - b, and -(c x) as (-c) x with -c from setup: the sign then costs nothing."""
        n = self.graph.nodes[node]
        if n.kind is Operator.ADD and self._stands_alone(n.args[0]):
            return Operation(Operator.SUB, (self._negative(n.args[0], out), self._expr(n.args[1], out)))
        if n.kind is Operator.MUL and self._stands_alone(node):
            for constant, other in (n.args, n.args[::-1]):
                if self.graph.is_constant(constant):
                    minus = self.graph.settled(self.graph.apply(Operator.NEG, constant))
                    return Operation(Operator.MUL, (self._expr(minus, out), self._expr(other, out)))
        return Operation(Operator.NEG, (self._expr(node, out),))

    def _stands_alone(self, node: int) -> bool:
        """Whether a node is an operation that is written where it is used."""
        return self.graph.nodes[node].leaf is None and node not in self.names and self.uses[node] < 2

    def _inverse(self, node: int, out: list[Statement]) -> Expr:
        """One division serves all quotients with the same divisor."""
        if node not in self.inverses:
            divisor = self._expr(node, out)
            name = f"inverse_{divisor.name}" if isinstance(divisor, ScalarRef) else self._next_name()
            self.inverses[node] = name
            out.append(Let(name, Operation(Operator.DIV, (Number(Fraction(1)), divisor))))
        return ScalarRef(self.inverses[node])

    def _next_name(self) -> str:
        return next(self.temporaries)


def _divisors(graph: Graph, uses: Counter[int]) -> Counter[int]:
    """How many quotients that are needed have a node, that is no number, as their divisor."""
    return Counter(
        n.args[1]
        for node, n in enumerate(graph.nodes)
        if n.kind is Operator.DIV and uses[node] and graph.value(n.args[1]) is None
    )


def _uses(graph: Graph, roots: list[int]) -> Counter[int]:
    """How often each node is an operand or a root, counting only what the roots need."""
    uses: Counter[int] = Counter(roots)
    for node in range(len(graph.nodes) - 1, -1, -1):
        if uses[node]:
            uses.update(graph.nodes[node].args)
    return uses
