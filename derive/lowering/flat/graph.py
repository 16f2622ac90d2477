"""The expression graph of a kernel: exact operations, without duplicates.

The graph folds operations on numbers and moves expressions of model constants to setup.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from enum import Enum
from fractions import Fraction
from typing import NamedTuple

from derive.algebra import sp
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


class Node(NamedTuple):
    """A leaf, or the operator of an operation with the numbers of its operands; made and hashed for each operation."""

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


class ConstantSource(Enum):
    """The source of a constant: it is a number, setup computes it, or it is one in which instances differ."""

    NUMBER = 0
    SETUP = 1
    TABLES = 2


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
        self._values: list[Fraction | None] = []
        self._sources: list[ConstantSource | None] = []
        self._size: list[int] = []
        self._settled: dict[int, int] = {}

    def leaf(self, leaf: Leaf) -> int:
        """The node of a number or a name."""
        return self._intern(Node(leaf), self._source_of(leaf))

    def number(self, value: int | Fraction) -> int:
        """The node of a number. Raises LoweringError if it is out of the range of doubles."""
        return self.leaf(Number(representable(Fraction(value))))

    def apply(self, kind: Operator, *args: int) -> int:
        """The node of an operation, or of its result if its operands are numbers or make it trivial."""
        folded = self._fold(kind, args)
        if folded is not None:
            return folded
        source = self._common_source(args)
        if source is None:
            args = tuple([self.settled(a) for a in args])
        return self._intern(Node(None, kind, args), source)

    def settled(self, node: int) -> int:
        """The node itself or, for an operation on constants alone, the constant of setup that replaces it."""
        n = self.nodes[node]
        if self._sources[node] is None or n.leaf is not None or self.constants is None:
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
        return self._values[node]

    def expr(self, node: int) -> Expr:
        """The expression of a node with all of its operands."""
        n = self.nodes[node]
        return n.leaf if n.leaf is not None else Operation(n.operator, tuple(self.expr(a) for a in n.args))

    def _intern(self, node: Node, source: ConstantSource | None) -> int:
        """The number of a node, which is added with its source if it is new."""
        number = self._index.setdefault(node, len(self.nodes))  # hashes the node once
        if number == len(self.nodes):
            self.nodes.append(node)
            self._values.append(node.leaf.value if isinstance(node.leaf, Number) else None)
            self._sources.append(source)
            self._size.append(1 + sum([self._size[a] for a in node.args]))
        return number

    def is_constant(self, node: int) -> bool:
        """Whether a node depends on numbers and model constants alone."""
        return self._sources[node] is not None

    def _source_of(self, leaf: Leaf) -> ConstantSource | None:
        """The source of a leaf; None if it is no constant."""
        match leaf:
            case Number():
                return ConstantSource.NUMBER
            case ScalarRef(name):
                known = self.constants
                if known is None or not (name in known.coefficients or name in known.hoisted.values()):
                    return None
                return ConstantSource.TABLES if name in known.of_instances else ConstantSource.SETUP
            case Element() | Ends() | LaneSum() | MatrixEntry() | TableValue():
                return None

    def _common_source(self, nodes: Sequence[int]) -> ConstantSource | None:
        """The source of an operation on nodes; None unless they are constant, and of setup or of tables alone."""
        common: ConstantSource | None = ConstantSource.NUMBER
        for node in nodes:
            source = self._sources[node]
            if source is not common and source is not ConstantSource.NUMBER:
                if source is None or common is not ConstantSource.NUMBER:
                    return None
                common = source
        return common

    def _fold(self, kind: Operator, args: tuple[int, ...]) -> int | None:
        """The node of the result of a trivial operation; None if it is not trivial."""
        values = [self._values[a] for a in args]
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
        if kind is Operator.DIV and vb is None and self.is_constant(b) and not self.is_constant(a):
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
