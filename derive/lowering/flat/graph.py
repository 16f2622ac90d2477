"""The expression graph of a kernel: exact operations, without duplicates.

The graph folds operations on numbers and moves expressions of model constants to setup.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import sympy as sp

from derive.errors import TisserandError
from derive.ir.expressions import (
    Element,
    Ends,
    Expr,
    LaneSum,
    Leaf,
    MatrixEntry,
    Number,
    Operation,
    Operator,
    ScalarRef,
    TableValue,
)
from derive.lowering.flat.setup_constants import Constants

MIN_DOUBLE, MAX_DOUBLE = Fraction(sys.float_info.min), Fraction(sys.float_info.max)
MAX_CONSTANT_SIZE = 9
"""The largest number of nodes in an expression of model constants; larger ones refer to constants for their parts."""

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


ZERO_DIVISOR = (
    "the model divides by a value that is zero in every state: shapes are dependent (make them orthogonal), or two "
    "joints impose the same constraint (remove one of them)"
)


IN_SETUP, IN_TABLES = frozenset({"setup"}), frozenset({"tables"})
"""The sources of constants: those that setup computes, and those in which instances differ."""


class LoweringError(TisserandError):
    """A model cannot be evaluated with doubles: a number is out of their range, or a pivot always vanishes."""


class Graph:
    """The nodes of a kernel, without duplicates; operands come before the operations that use them.

    An operation on constants alone becomes a constant of setup as soon as another operation uses it, or one of a table
    of instances; it stays where it is if it has constants of both. Without `constants`, as in setup itself, all
    operations stay where they are.
    """

    def __init__(self, constants: Constants | None = None) -> None:
        self.constants = constants
        self.nodes: list[Node] = []
        self._index: dict[Node, int] = {}
        self._constant: list[bool] = []
        self._sources: list[frozenset[str]] = []
        self._size: list[int] = []
        self._settled: dict[int, int] = {}

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
        if not self._are_of_one_source(args):
            args = tuple(self.settled(a) for a in args)
        return self._intern(Node(None, kind, args))

    def settled(self, node: int) -> int:
        """The node itself or, for an operation on constants alone, the constant of setup that replaces it."""
        n = self.nodes[node]
        if n.leaf is not None or not self._constant[node] or self.constants is None:
            return node
        if node not in self._settled:
            large = self._size[node] > MAX_CONSTANT_SIZE
            expr = Operation(n.operator, self._settled_args(n)) if large else self.expr(node)
            self._settled[node] = self.leaf(ScalarRef(self.constants.name(expr)))
        return self._settled[node]

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
        number = self._index.setdefault(node, len(self.nodes))  # hashes the node once
        if number == len(self.nodes):
            self.nodes.append(node)
            self._sources.append(self._sources_of(node))
            self._constant.append(self._depends_on_constants(node))
            self._size.append(1 + sum(self._size[a] for a in node.args))
        return number

    def is_constant(self, node: int) -> bool:
        """Whether a node depends on numbers and model constants alone."""
        return self._constant[node]

    def _depends_on_constants(self, node: Node) -> bool:
        match node.leaf:
            case Number():
                return True
            case ScalarRef(name):
                known = self.constants
                return known is not None and (name in known.coefficients or name in known.hoisted.values())
            case Element() | Ends() | LaneSum() | MatrixEntry() | TableValue():
                return False
        return self._are_of_one_source(node.args)

    def _sources_of(self, node: Node) -> frozenset[str]:
        """The sources of the constants on which a node depends: setup, or tables of instances."""
        if isinstance(node.leaf, ScalarRef) and self.constants is not None:
            return IN_TABLES if node.leaf.name in self.constants.of_instances else IN_SETUP
        return frozenset().union(*(self._sources[a] for a in node.args))

    def _are_of_one_source(self, nodes: Sequence[int]) -> bool:
        """Whether nodes are constant, and one of setup or of a table could hold an operation on them."""
        sources = frozenset[str]().union(*(self._sources[node] for node in nodes))
        return len(sources) < 2 and all(self._constant[node] for node in nodes)

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
        if kind is Operator.DIV and values[1] == 0:
            raise LoweringError(ZERO_DIVISOR)
        numbers = [v for v in values if v is not None]
        if len(numbers) == len(values):
            return self.number(_exact(kind, numbers))
        if kind is Operator.NEG:
            inner = self.nodes[args[0]]
            return inner.args[0] if inner.kind is Operator.NEG else None
        return self._neutral(kind, args, values)

    def _neutral(self, kind: Operator, args: tuple[int, ...], values: list[Fraction | None]) -> int | None:
        """Simplify x * 1, x / 1, x * -1 and a + (-b), write x * number and x / number as number * x.

        Setup inverts constants. Products take a fraction of the time of divisions. Zeros do not occur: the derivation
        removes them, with their reasons.
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
        if kind is Operator.DIV and vb is not None and MIN_DOUBLE <= abs(1 / vb) <= MAX_DOUBLE:
            return self.apply(Operator.MUL, self.number(1 / vb), a)
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
