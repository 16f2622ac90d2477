"""Scheduling of an expression graph: selects the values that get a name, orders them, and writes the statements."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import count

import casadi as ca

from derive.ir.expressions import CONDITIONS, Expr, Number, Operation, Operator, ScalarRef, TableValue
from derive.ir.kernel import Section
from derive.ir.statements import Let, Require, Requirement, ReturnCode, Statement, Store
from derive.lowering.flat.casadi_instructions import read_expressions
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.graph import Graph, LoweringError


@dataclass(frozen=True)
class NamedValue:
    """A value with a name of the derivation; it is computed only if another value uses it."""

    name: str
    value: ca.SX


@dataclass(frozen=True)
class EarlyValue:
    """A value without a name that the step computes already, if others use it; else it is computed where it is used."""

    value: ca.SX


@dataclass(frozen=True)
class OutputValue:
    """The value of element `index` of an output."""

    output: str
    index: int
    value: ca.SX


@dataclass(frozen=True)
class RequiredValue:
    """A value that must meet a requirement; otherwise the kernel returns `code`. `text` describes the failure.

    needed_by: the named value of the same step for which the value is required; if the kernel does not use it, the
    requirement is void. Empty if the requirement is always in force.
    """

    kind: Requirement
    value: ca.SX
    code: ReturnCode
    text: str
    needed_by: str = ""


StepItem = NamedValue | EarlyValue | OutputValue | RequiredValue


@dataclass(frozen=True)
class Step:
    """The values that one section computes, as CasADi scalars; the other fields are those of `Section`."""

    name: str
    equation: str
    doc: str
    items: tuple[StepItem, ...]


LONGEST = 300
"""The largest depth of nested operations in an expression; deeper values have statements of their own."""

LocatedStep = tuple[Step, list[tuple[StepItem, int]]]
"""A step, and its items with their graph nodes."""


def schedule(
    graph: Graph,
    symbols: Symbols,
    definitions: tuple[Step, ...],
    steps: tuple[Step, ...],
    temporaries: Iterator[str] | None = None,
) -> tuple[Section, ...]:
    """The sections of a kernel. Values that have a name or more than one use get a `Let`; others are written inline.

    graph: the graph to which the values are added. definitions: steps whose sections come just before the first step
    that uses them. steps: the other steps, in order. temporaries: the names of values without a name, t1, t2, ... by
    default. All values are read from CasADi at once, so that the sections share common sub-expressions. Requirements on
    constants alone move to setup; LoweringError is raised if a constant cannot meet its requirement.
    """
    every = (*definitions, *steps)
    listed = [item for step in every for item in step.items]
    nodes = iter(read_expressions(graph, symbols, [item.value for item in listed], _if_needed(listed)))
    located = [(step, [(item, node) for item in step.items if (node := next(nodes)) is not None]) for step in every]
    results = [node for _, items in located for item, node in items if _is_result(item)]
    needed = _uses(graph, results)
    pairs = [pair for _, items in located for pair in items]
    used = {"", *(item.name for item, node in pairs if isinstance(item, NamedValue) and needed[node])}
    for _, items in located:
        items[:] = [
            (item, node)
            for item, node in items
            if not (
                isinstance(item, RequiredValue) and (item.needed_by not in used or _moved_to_setup(graph, item, node))
            )
        ]
    writer = _Writer(
        graph, [pair for _, items in located for pair in items], temporaries or (f"t{k}" for k in count(1))
    )
    ordered = _in_order_of_use(graph, located[: len(definitions)], located[len(definitions) :])
    sections = (Section(step.name, step.equation, step.doc, writer.body(items)) for step, items in ordered)
    return tuple(section for section in sections if section.body)


def _if_needed(items: Sequence[StepItem]) -> dict[int, list[int]]:
    """The numbers of items that a kernel computes only if others need them, with those of their requirements."""
    also: dict[int, list[int]] = {n: [] for n, item in enumerate(items) if not _is_result(item)}
    named = {item.name: n for n, item in enumerate(items) if isinstance(item, NamedValue)}
    for n, item in enumerate(items):
        if isinstance(item, RequiredValue) and item.needed_by in named:
            also[named[item.needed_by]].append(n)
    return also


def _is_result(item: StepItem) -> bool:
    """Whether a kernel computes a value in any case: an output, or a requirement that is always in force."""
    return isinstance(item, OutputValue) or (isinstance(item, RequiredValue) and not item.needed_by)


def _in_order_of_use(graph: Graph, definitions: list[LocatedStep], steps: list[LocatedStep]) -> list[LocatedStep]:
    """The steps, each after the definitions that it is the first to use; unused definitions are omitted."""
    ordered: list[LocatedStep] = []
    waiting = list(definitions)
    for step in steps:
        uses = _uses(graph, [node for _, node in step[1]])
        used = [d for d in waiting if any(uses[node] for _, node in d[1])]
        waiting = [d for d in waiting if d not in used]
        ordered += [*used, step]
    return ordered


def _moved_to_setup(graph: Graph, item: RequiredValue, node: int) -> bool:
    """Whether a requirement concerns constants alone; if so, setup checks it. Raises LoweringError."""
    if not graph.is_constant(node):
        return False
    number = graph.value(node)
    if number is not None and item.kind is Requirement.POSITIVE and number <= 0:
        raise never_met(item.text)
    if graph.constants is not None:
        graph.constants.require(item.kind, graph.expr(node), item.code, item.text)
    return True


def never_met(text: str) -> LoweringError:
    """The error for numbers that do not meet their requirement, with the text of that."""
    return LoweringError(
        f"{text}, whatever the state: shapes are too nearly dependent to compute with (make them orthogonal), "
        "or two joints impose the same constraint (remove one of them)"
    )


class _Writer:
    """A writer of the statements of all sections of a kernel, each shared value once.

    items: all items with their nodes. `written` maps nodes to the names of values that have a statement, `inverses`
    those of divisors to the names of their inverses.
    """

    def __init__(self, graph: Graph, items: list[tuple[StepItem, int]], temporaries: Iterator[str]) -> None:
        self.graph = graph
        self.temporaries = temporaries
        self.uses = _uses(graph, [node for item, node in items if not isinstance(item, NamedValue | EarlyValue)])
        self.names = {node: item.name for item, node in reversed(items) if isinstance(item, NamedValue)}
        self.divisors = _divisors(graph, self.uses)
        self.interrupted: frozenset[int] = frozenset()
        self.interrupted = frozenset(self._too_deep())
        self.written: dict[int, str] = {}
        self.inverses: dict[int, str] = {}

    def body(self, items: list[tuple[StepItem, int]]) -> tuple[Statement, ...]:
        """The statements of a section."""
        out: list[Statement] = []
        for item, node in items:
            for below in self._interrupted_below(node):
                self._expr(below, out)
            if isinstance(item, NamedValue | EarlyValue):
                if self.uses[node]:
                    self._expr(node, out)
                continue
            expr = self._expr(node, out)
            if isinstance(item, OutputValue):
                out.append(Store(item.output, item.index, expr))
            else:
                out.append(Require(item.kind, expr, item.code, item.text))
        return tuple(out)

    def _expr(self, node: int, out: list[Statement]) -> Expr:
        """The expression of a node; appends the statements of the named values that it uses to `out`."""
        n = self.graph.nodes[node]
        if n.leaf is not None and not isinstance(n.leaf, TableValue):
            return n.leaf
        if node in self.written:
            return ScalarRef(self.written[node])
        if isinstance(n.leaf, TableValue):
            self.written[node] = self.names.get(node) or self._next_name()
            out.append(Let(self.written[node], n.leaf))
            return ScalarRef(self.written[node])
        if n.kind is Operator.NEG and self._is_inline(n.args[0]):
            expr = self._negative(n.args[0], out)
        elif n.kind is Operator.DIV and self.divisors[n.args[1]] > 1:
            if self.graph.value(n.args[0]) == 1:
                return self._inverse(n.args[1], out)
            expr = Operation(Operator.MUL, (self._expr(n.args[0], out), self._inverse(n.args[1], out)))
        else:
            expr = Operation(n.operator, tuple(self._expr(a, out) for a in n.args))
        if self._is_inline(node):
            return expr
        self.written[node] = self.names.get(node) or self._next_name()
        out.append(Let(self.written[node], expr))
        return ScalarRef(self.written[node])

    def _negative(self, node: int, out: list[Statement]) -> Expr:
        """-(a + b) as -a - b, and -(c x) as (-c) x with -c from setup, so that the sign costs no operation."""
        n = self.graph.nodes[node]
        if n.kind is Operator.ADD and self._is_inline(n.args[0]):
            return Operation(Operator.SUB, (self._negative(n.args[0], out), self._expr(n.args[1], out)))
        if n.kind is Operator.MUL and self._is_inline(node):
            for constant, other in (n.args, n.args[::-1]):
                if self.graph.is_constant(constant):
                    minus = self.graph.settled(self.graph.apply(Operator.NEG, constant))
                    return Operation(Operator.MUL, (self._expr(minus, out), self._expr(other, out)))
        return Operation(Operator.NEG, (self._expr(node, out),))

    def _is_inline(self, node: int) -> bool:
        """Whether a node needs no statement: a condition, or an operation without a name that has a single use."""
        n = self.graph.nodes[node]
        if n.leaf is not None or node in self.names or node in self.interrupted:
            return False
        return self.uses[node] < 2 or n.kind in CONDITIONS

    def _too_deep(self) -> Iterator[int]:
        """The nodes at which an expression, such as a sum of a thousand terms, becomes deeper than LONGEST."""
        depths: dict[int, int] = {}
        for node, n in enumerate(self.graph.nodes):
            if not self._is_inline(node):
                continue
            depth = 1 + max([depths.get(arg, 0) for arg in n.args])
            if depth < LONGEST:
                depths[node] = depth
            elif n.kind not in CONDITIONS:
                yield node

    def _interrupted_below(self, node: int) -> list[int]:
        """The interrupted nodes on which a node depends, operands first; they are written one by one."""
        if not self.interrupted:
            return []
        known, waiting = {node}, [node]
        while waiting:
            args = self.graph.nodes[waiting.pop()].args
            waiting += [arg for arg in args if arg not in known]
            known.update(args)
        return sorted((known & self.interrupted) - {*self.written})

    def _inverse(self, node: int, out: list[Statement]) -> Expr:
        """The inverse of a divisor that several quotients share, computed by a single division."""
        if node not in self.inverses:
            divisor = self._expr(node, out)
            name = f"inverse_{divisor.name}" if isinstance(divisor, ScalarRef) else self._next_name()
            self.inverses[node] = name
            out.append(Let(name, Operation(Operator.DIV, (Number(Fraction(1)), divisor))))
        return ScalarRef(self.inverses[node])

    def _next_name(self) -> str:
        return next(self.temporaries)


def _divisors(graph: Graph, uses: Counter[int]) -> Counter[int]:
    """The number of used quotients that have each node as their divisor, for nodes that are not numbers."""
    return Counter(
        n.args[1]
        for node, n in enumerate(graph.nodes)
        if n.kind is Operator.DIV and uses[node] and graph.value(n.args[1]) is None
    )


def _uses(graph: Graph, roots: list[int]) -> Counter[int]:
    """The number of times that each node is a root, or an operand of a node on which a root depends."""
    uses = [0] * len(graph.nodes)
    for root in roots:
        uses[root] += 1
    for node in range(len(uses) - 1, -1, -1):
        if uses[node]:
            for arg in graph.nodes[node].args:
                uses[arg] += 1
    return Counter({node: number for node, number in enumerate(uses) if number})
