"""A CasADi function, read instruction by instruction into a graph of exact operations.

CasADi has shared the common sub-expressions; here its doubles become exact numbers again, what is known at generation
time is folded, and expressions of model constants alone are identified and moved to setup.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from fractions import Fraction
from itertools import count

import casadi as ca
import sympy as sp

from derive.errors import TisserandError
from derive.ir.expressions import ArrayAccess, Expr, Leaf, MatrixEntry, Number, Operation, Operator, ScalarRef
from derive.ir.statements import Require, Requirement, ReturnCode
from derive.lowering.flat.casadi_symbols import Symbols

BINARY = {ca.OP_ADD: Operator.ADD, ca.OP_SUB: Operator.SUB, ca.OP_MUL: Operator.MUL, ca.OP_DIV: Operator.DIV}
LEAST, MOST = Fraction(sys.float_info.min), Fraction(sys.float_info.max)
SHORT = 9
"""The largest number of nodes in a named expression of model constants; longer ones refer to named parts."""

UNARY = {ca.OP_NEG: Operator.NEG, ca.OP_SIN: Operator.SIN, ca.OP_COS: Operator.COS, ca.OP_SQRT: Operator.SQRT}


@dataclass(frozen=True)
class Node:
    """A leaf or the kind of an operation with the numbers of its operands."""

    leaf: Leaf | None
    kind: Operator | None = None
    args: tuple[int, ...] = ()

    @property
    def operator(self) -> Operator:
        """The operator of a node that is no leaf."""
        assert self.kind is not None, "a leaf has no operator"
        return self.kind


class LoweringError(TisserandError):
    """A model that cannot be computed with doubles: a number that they do not hold, or a pivot that vanishes."""


class Constants:
    """What is computed once, in setup: coefficients by name, and expressions of coefficients that kernels need."""

    def __init__(self, coefficients: frozenset[str]) -> None:
        self.coefficients = coefficients
        self.hoisted: dict[Expr, str] = {}
        self.requirements: list[Require] = []
        self._numbers = count(1)

    def require(self, kind: Requirement, expr: Expr, code: ReturnCode, text: str) -> None:
        """Let setup check a value that depends on coefficients alone."""
        if not any(r.kind == kind and r.expr == expr for r in self.requirements):
            self.requirements.append(Require(kind, expr, code, text))

    def name(self, expr: Expr) -> str:
        """The name under which setup keeps an expression of coefficients."""
        if expr not in self.hoisted:
            self.hoisted[expr] = self._describe(expr) or f"constant_{next(self._numbers)}"
        return self.hoisted[expr]

    def _describe(self, expr: Expr) -> str | None:
        match expr:
            case Operation(Operator.DIV, (Number(Fraction(numerator=1, denominator=1)), ScalarRef(name))):
                return f"inverse_{name}"
            case Operation(Operator.NEG, (ScalarRef(name),)):
                return f"minus_{name}"
        return None


class Graph:
    """Nodes of one kernel, each once; operands come before what uses them.

    An operation on coefficients alone becomes a constant of setup as soon as something else uses it.
    """

    def __init__(self, constants: Constants) -> None:
        self.constants = constants
        self.nodes: list[Node] = []
        self._index: dict[Node, int] = {}
        self._constant: list[bool] = []
        self._size: list[int] = []

    def leaf(self, leaf: Leaf) -> int:
        """The node of a number or a name."""
        return self._intern(Node(leaf))

    def number(self, value: int | Fraction) -> int:
        """The node of a number. Raises LoweringError when no double is near it."""
        return self.leaf(Number(representable(Fraction(value))))

    def apply(self, kind: Operator, *args: int) -> int:
        """The node of an operation, folded when its operands are numbers or make it trivial."""
        folded = self._fold(kind, args)
        if folded is not None:
            return folded
        if not all(self._constant[a] for a in args):
            args = tuple(self.settled(a) for a in args)
        return self._intern(Node(None, kind, args))

    def settled(self, node: int) -> int:
        """The node itself, or, for an operation on coefficients alone, the constant of setup that replaces it."""
        n = self.nodes[node]
        if n.leaf is not None or not self._constant[node]:
            return node
        expr = self.expr(node) if self._size[node] <= SHORT else Operation(n.operator, self._settled_args(n))
        return self.leaf(ScalarRef(self.constants.name(expr)))

    def _settled_args(self, node: Node) -> tuple[Expr, ...]:
        return tuple(self.expr(self.settled(a)) for a in node.args)

    def value(self, node: int) -> Fraction | None:
        """The value of a node that is a number, otherwise None."""
        leaf = self.nodes[node].leaf
        return leaf.value if isinstance(leaf, Number) else None

    def expr(self, node: int) -> Expr:
        """The whole expression of a node."""
        n = self.nodes[node]
        return n.leaf if n.leaf is not None else Operation(n.operator, tuple(self.expr(a) for a in n.args))

    def _intern(self, node: Node) -> int:
        if node not in self._index:
            self._index[node] = len(self.nodes)
            self.nodes.append(node)
            self._constant.append(self._depends_on_constants(node))
            self._size.append(1 + sum(self._size[a] for a in node.args))
        return self._index[node]

    def is_constant(self, node: int) -> bool:
        """Whether a node depends on nothing but numbers and coefficients."""
        return self._constant[node]

    def _depends_on_constants(self, node: Node) -> bool:
        match node.leaf:
            case Number():
                return True
            case ScalarRef(name):
                return name in self.constants.coefficients or name in self.constants.hoisted.values()
            case ArrayAccess() | MatrixEntry():
                return False
        return all(self._constant[a] for a in node.args)

    def _fold(self, kind: Operator, args: tuple[int, ...]) -> int | None:
        values = [self.value(a) for a in args]
        if kind.function:
            return self.number(1 if kind is Operator.COS else 0) if values[0] == 0 else None
        known = [v for v in values if v is not None]
        if len(known) == len(values):
            return self.number(_exact(kind, known))
        if kind is Operator.NEG:
            inner = self.nodes[args[0]]
            return inner.args[0] if inner.kind is Operator.NEG else None
        return self._neutral(kind, args, values)

    def _neutral(self, kind: Operator, args: tuple[int, ...], values: list[Fraction | None]) -> int | None:
        """x * 1, x / 1, x * -1, signs that a sum can absorb, numbers first, and divisions that setup can do.

        Zeros do not come this far: the derivation drops them, with their reasons.
        """
        (a, b), (va, vb) = args, values
        negated = self.nodes[b].args[0] if self.nodes[b].kind is Operator.NEG else None
        if kind in (Operator.MUL, Operator.DIV) and vb == 1:
            return a
        if kind is Operator.MUL and va == 1:
            return b
        if kind is Operator.MUL and -1 in (va, vb):
            return self.apply(Operator.NEG, b if va == -1 else a)
        if kind in (Operator.ADD, Operator.SUB) and negated is not None:
            return self.apply(Operator.SUB if kind is Operator.ADD else Operator.ADD, a, negated)
        if kind is Operator.MUL and vb is not None:
            return self.apply(Operator.MUL, b, a)
        if kind is Operator.DIV and vb is None and self._constant[b] and not self._constant[a]:
            return self.apply(Operator.MUL, a, self.apply(Operator.DIV, self.number(1), b))  # setup divides
        return None


def representable(value: Fraction) -> Fraction:
    """The number itself if a double can represent it (rounded), 0 included. Raises LoweringError otherwise."""
    if value and not LEAST <= abs(value) <= MOST:
        raise LoweringError(
            f"the numbers of the specification lead to {sp.Rational(value).n(3)}, which no double holds; "
            "choose units in which mass, length and stiffness are nearer to one"
        )
    return value


def _exact(kind: Operator, values: list[Fraction]) -> Fraction:
    if kind is Operator.NEG:
        return -values[0]
    a, b = values
    return {Operator.ADD: a.__add__, Operator.SUB: a.__sub__, Operator.MUL: a.__mul__, Operator.DIV: a.__truediv__}[
        kind
    ](b)


def read(graph: Graph, symbols: Symbols, outputs: list[ca.SX]) -> list[int]:
    """The nodes of some CasADi scalars, added to the graph."""
    column = ca.vertcat(*outputs) if outputs else ca.SX(0, 1)
    options = {"cse": True, "live_variables": False}
    function = ca.Function("kernel", [ca.vertcat(*symbols.inputs)], [ca.densify(column)], options)
    work: dict[int, int] = {}
    result = [0] * len(outputs)
    for k in range(function.n_instructions()):
        operation, inputs, results = (
            function.instruction_id(k),
            function.instruction_input(k),
            function.instruction_output(k),
        )
        if operation == ca.OP_OUTPUT:
            result[results[1]] = graph.settled(work[inputs[0]])
        elif operation == ca.OP_INPUT:
            work[results[0]] = graph.leaf(symbols.leaves[inputs[1]])
        elif operation == ca.OP_CONST:
            work[results[0]] = graph.number(_integer(function.instruction_constant(k)))
        else:
            work[results[0]] = _operation(graph, operation, [work[i] for i in inputs])
    return result


def _operation(graph: Graph, operation: int, args: list[int]) -> int:
    if operation in BINARY:
        return graph.apply(BINARY[operation], *args)
    if operation in UNARY:
        return graph.apply(UNARY[operation], args[0])
    if operation == ca.OP_SQ:
        return graph.apply(Operator.MUL, args[0], args[0])
    if operation == ca.OP_TWICE:
        return graph.apply(Operator.MUL, graph.number(2), args[0])
    if operation == ca.OP_INV:
        return graph.apply(Operator.DIV, graph.number(1), args[0])
    if operation == ca.OP_FABS:
        raise LoweringError(
            "the root of a square, such as sqrt(t^2), has a kink; write the function of t without it, or, if a linear "
            "spring lies along its guide, move one of its markers off that line"
        )
    raise NotImplementedError(f"CasADi operation {operation} has no counterpart in the Kernel")


def _integer(value: float) -> int:
    if value != int(value):
        raise ArithmeticError(f"the number {value} came out of CasADi rounded")
    return int(value)
