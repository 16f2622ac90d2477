"""The expression graph of a kernel: CasADi instructions as exact operations.

CasADi finds the common sub-expressions. The graph restores exact numbers, folds operations on numbers, and moves
expressions of model constants to setup.
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from fractions import Fraction
from itertools import count

import casadi as ca
import sympy as sp

from derive.errors import TisserandError
from derive.ir.expressions import (
    BINARY_OPERATORS,
    ArrayAccess,
    Expr,
    Leaf,
    MatrixEntry,
    Number,
    Operation,
    Operator,
    ScalarRef,
    TableValue,
)
from derive.ir.statements import Require, Requirement, ReturnCode
from derive.lowering.flat.casadi_symbols import Symbols

BINARY = {
    ca.OP_ADD: Operator.ADD,
    ca.OP_SUB: Operator.SUB,
    ca.OP_MUL: Operator.MUL,
    ca.OP_DIV: Operator.DIV,
    ca.OP_ATAN2: Operator.ATAN2,
    ca.OP_FMIN: Operator.MIN,
    ca.OP_FMAX: Operator.MAX,
    ca.OP_LT: Operator.LESS,
    ca.OP_LE: Operator.NOT_GREATER,
    ca.OP_IF_ELSE_ZERO: Operator.WHEN,
}
MIN_DOUBLE, MAX_DOUBLE = Fraction(sys.float_info.min), Fraction(sys.float_info.max)
WORDS = {
    **{kind: kind.value for kind in BINARY_OPERATORS},
    **{Operator.ADD: "plus", Operator.SUB: "minus", Operator.MUL: "times", Operator.DIV: "over"},
}
MAX_NAME = 60
"""The longest name that a constant gets from its expression; others are numbered."""
MAX_CONSTANT_SIZE = 9
"""The largest number of nodes in an expression of model constants; larger ones refer to constants for their parts."""

UNARY = {
    ca.OP_NEG: Operator.NEG,
    ca.OP_SIN: Operator.SIN,
    ca.OP_COS: Operator.COS,
    ca.OP_SQRT: Operator.SQRT,
    ca.OP_EXP: Operator.EXP,
    ca.OP_LOG: Operator.LOG,
    ca.OP_TANH: Operator.TANH,
    ca.OP_SIGN: Operator.SIGN,
    ca.OP_NOT: Operator.NOT,
}
ARITHMETIC = (Operator.ADD, Operator.SUB, Operator.MUL, Operator.DIV, Operator.NEG)
ONE_AT_ZERO = (Operator.COS, Operator.EXP, Operator.NOT)
"""The functions that are 1 at 0; the others of one operand are 0 there, except for the logarithm."""


@dataclass(frozen=True)
class Node:
    """A leaf, or the operator of an operation with the numbers of its operands."""

    leaf: Leaf | None
    kind: Operator | None = None
    args: tuple[int, ...] = ()

    @property
    def operator(self) -> Operator:
        """The operator of a node that is not a leaf."""
        assert self.kind is not None, "a leaf has no operator"
        return self.kind


class LoweringError(TisserandError):
    """A model cannot be evaluated with doubles: a number is out of their range, or a pivot always vanishes."""


class Constants:
    """The constants and checks that setup computes for all kernels of a model.

    coefficients: the names of the model constants that are not numbers. hoisted: expressions of these, by their names.
    requirements: checks of values that depend on constants alone.
    """

    def __init__(self, coefficients: frozenset[str]) -> None:
        self.coefficients = coefficients
        self.hoisted: dict[Expr, str] = {}
        self.requirements: list[Require] = []
        self._numbers = count(1)

    def require(self, kind: Requirement, expr: Expr, code: ReturnCode, text: str) -> None:
        """Add a check in setup of a value that depends on constants alone."""
        if not any(r.kind == kind and r.expr == expr for r in self.requirements):
            self.requirements.append(Require(kind, expr, code, text))

    def name(self, expr: Expr) -> str:
        """The name of the constant whose value is an expression of coefficients."""
        if expr not in self.hoisted:
            self.hoisted[expr] = self._describe(expr) or f"constant_{next(self._numbers)}"
        return self.hoisted[expr]

    def _describe(self, expr: Expr) -> str | None:
        """The expression in words; None if they are too long, or if another constant has that name."""
        name = _in_words(expr)
        taken = name in self.coefficients or name in self.hoisted.values()
        return None if taken or len(name) > MAX_NAME or not name.isidentifier() else name


def _in_words(expr: Expr) -> str:
    """A name for a constant expression, such as `c6_2_over_c8_2_2`; factors that are numbers come last."""
    match expr:
        case ScalarRef(name):
            return name
        case Number(Fraction(numerator=1, denominator=d)) if d > 2**20 and d & (d - 1) == 0:
            return f"2_pow_minus_{d.bit_length() - 1}"
        case Number(Fraction(numerator=n, denominator=d)):
            size = str(abs(n)) if d == 1 else f"{abs(n)}_over_{d}"
            return f"minus_{size}" if n < 0 else size
        case Operation(Operator.DIV, (Number(Fraction(numerator=1, denominator=1)), divisor)):
            return f"inverse_{_in_words(divisor)}"
        case Operation(Operator.DIV, (Number() as number, divisor)):
            return f"inverse_{_in_words(divisor)}_times_{_in_words(number)}"
        case Operation(Operator.ADD | Operator.MUL as kind, (Number() as number, other)):
            return f"{_in_words(other)}_{WORDS[kind]}_{_in_words(number)}"
        case Operation(Operator.SUB, (Number() as number, other)):
            return f"minus_{_in_words(other)}_plus_{_in_words(number)}"
        case Operation(kind, (first, second)):
            return f"{_in_words(first)}_{WORDS[kind]}_{_in_words(second)}"
        case Operation(kind, (operand,)):
            return f"{'minus' if kind is Operator.NEG else kind.value}_{_in_words(operand)}"
    return ""


class Graph:
    """The nodes of a kernel, without duplicates; operands come before the operations that use them.

    An operation on constants alone becomes a constant of setup as soon as another operation uses it.
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
        """The node of a number. Raises LoweringError if it is out of the range of doubles."""
        return self.leaf(Number(representable(Fraction(value))))

    def apply(self, kind: Operator, *args: int) -> int:
        """The node of an operation, or of its result if its operands are numbers or make it trivial."""
        folded = self._fold(kind, args)
        if folded is not None:
            return folded
        if not all(self._constant[a] for a in args):
            args = tuple(self.settled(a) for a in args)
        return self._intern(Node(None, kind, args))

    def settled(self, node: int) -> int:
        """The node itself or, for an operation on constants alone, the constant of setup that replaces it."""
        n = self.nodes[node]
        if n.leaf is not None or not self._constant[node]:
            return node
        expr = (
            self.expr(node) if self._size[node] <= MAX_CONSTANT_SIZE else Operation(n.operator, self._settled_args(n))
        )
        return self.leaf(ScalarRef(self.constants.name(expr)))

    def _settled_args(self, node: Node) -> tuple[Expr, ...]:
        return tuple(self.expr(self.settled(a)) for a in node.args)

    def value(self, node: int) -> Fraction | None:
        """The value of a node that is a number, otherwise None."""
        leaf = self.nodes[node].leaf
        return leaf.value if isinstance(leaf, Number) else None

    def expr(self, node: int) -> Expr:
        """The expression of a node with all of its operands."""
        n = self.nodes[node]
        return n.leaf if n.leaf is not None else Operation(n.operator, tuple(self.expr(a) for a in n.args))

    def _intern(self, node: Node) -> int:
        """The number of a node, which is added if it is new."""
        if node not in self._index:
            self._index[node] = len(self.nodes)
            self.nodes.append(node)
            self._constant.append(self._depends_on_constants(node))
            self._size.append(1 + sum(self._size[a] for a in node.args))
        return self._index[node]

    def is_constant(self, node: int) -> bool:
        """Whether a node depends on numbers and model constants alone."""
        return self._constant[node]

    def _depends_on_constants(self, node: Node) -> bool:
        match node.leaf:
            case Number():
                return True
            case ScalarRef(name):
                return name in self.constants.coefficients or name in self.constants.hoisted.values()
            case ArrayAccess() | MatrixEntry() | TableValue():
                return False
        return all(self._constant[a] for a in node.args)

    def _fold(self, kind: Operator, args: tuple[int, ...]) -> int | None:
        """The node of the result of a trivial operation; None if it is not trivial."""
        values = [self.value(a) for a in args]
        if not kind.binary and kind is not Operator.NEG:
            known = values[0] == 0 and kind is not Operator.LOG
            return self.number(1 if kind in ONE_AT_ZERO else 0) if known else None
        if kind is Operator.WHEN and values[0] is not None:
            return args[1] if values[0] else self.number(0)
        if kind not in ARITHMETIC:
            return None
        numbers = [v for v in values if v is not None]
        if len(numbers) == len(values):
            return self.number(_exact(kind, numbers))
        if kind is Operator.NEG:
            inner = self.nodes[args[0]]
            return inner.args[0] if inner.kind is Operator.NEG else None
        return self._neutral(kind, args, values)

    def _neutral(self, kind: Operator, args: tuple[int, ...], values: list[Fraction | None]) -> int | None:
        """Simplify x * 1, x / 1, x * -1 and a + (-b), write x * number as number * x, and let setup invert constants.

        Zeros do not occur: the derivation removes them, with their reasons.
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
            return self.apply(Operator.MUL, a, self.apply(Operator.DIV, self.number(1), b))  # setup computes 1 / b
        return None


def representable(value: Fraction) -> Fraction:
    """The number itself if it is 0 or in the range of normal doubles. Raises LoweringError otherwise."""
    if value and not MIN_DOUBLE <= abs(value) <= MAX_DOUBLE:
        raise LoweringError(
            f"the numbers of the specification lead to {sp.Rational(value).n(3)}, which is out of the range of "
            "doubles; choose units in which mass, length and stiffness are nearer to one"
        )
    return value


def _exact(kind: Operator, values: list[Fraction]) -> Fraction:
    """The result of an arithmetic operation on exact numbers."""
    if kind is Operator.NEG:
        return -values[0]
    a, b = values
    return {Operator.ADD: a.__add__, Operator.SUB: a.__sub__, Operator.MUL: a.__mul__, Operator.DIV: a.__truediv__}[
        kind
    ](b)


def read_expressions(graph: Graph, symbols: Symbols, outputs: list[ca.SX]) -> list[int]:
    """The nodes of CasADi scalars, which are added to the graph and share sub-expressions. Raises LoweringError."""
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
    """The node of a CasADi operation. Raises LoweringError, NotImplementedError."""
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
            "the root of a square, such as sqrt(t^2), has a kink; write abs(t), or, if a linear "
            "spring lies along its guide, move one of its markers off that line"
        )
    raise NotImplementedError(f"CasADi operation {operation} has no counterpart in a kernel")


def _integer(value: float) -> int:
    """A CasADi constant as an integer.

    Raises LoweringError if it is infinite, the inverse of a pivot that is zero; ArithmeticError if it is a fraction,
    which would be a rounded number.
    """
    if not math.isfinite(value):
        raise LoweringError(
            "the model divides by a value that is zero in every state: shapes are dependent (make them orthogonal), or "
            "two joints impose the same constraint (remove one of them)"
        )
    if value != int(value):
        raise ArithmeticError(f"CasADi has rounded a number to {value}")
    return int(value)
