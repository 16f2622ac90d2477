"""Values and assignments as C, in loops over lanes as vectors.

A loop over lanes takes as many at a time as a register of the target has. gcc and clang get vectors explicitly, since
they do not make any of such loops by themselves at all levels; for other compilers a vector is a number. Lanes do not
mix, so that the bits are the same in every way.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field

from derive.backends.c.loop_text import (
    Lines,
    address_text,
    row_distance,
)
from derive.backends.expression_text import C, Named, element, index_text, text
from derive.backends.source_map import defining, plain, storing
from derive.backends.wrapping import BreakableText, join, statement
from derive.ir.expressions import Element, Ends, Expr, Operation, Operator, ScalarRef, walk
from derive.ir.indices import LANE, ElementIndex, IndexTerm
from derive.ir.loop_nests import (
    Accumulator,
    Assign,
)

OPERATORS = {None: "=", Operator.ADD: "+=", Operator.SUB: "-=", Operator.MUL: "*=", Operator.NEG: "="}


@dataclass
class ValuesInLanes:
    """Expressions and assignments of one function, of which those in a loop over lanes are vectors.

    outputs: the arrays that the function writes; arrays: all arrays that are its parameters, in which a batch has rows
    of all its states.
    """

    outputs: Collection[str] = ()
    arrays: Collection[str] = ()
    filled: set[str] = field(default_factory=set, kw_only=True)
    """The arrays that have a number for each lane: angles, sines and cosines, sums over modes and their factors."""
    _lanes: set[str] = field(default_factory=set, kw_only=True)
    """The arrays of the lanes of sums."""
    _totals: dict[str, str] = field(default_factory=dict, kw_only=True)
    """The arrays and sums that accumulators add up, by the names of these."""
    _vectors: set[str] | None = field(default=None, kw_only=True)
    """The names that differ from lane to lane, in a loop over lanes."""
    _lane: str = field(default=LANE, kw_only=True)
    """The variable of that loop, which is that of the ends in a loop over the ends of a path."""
    _few: int = field(default=0, kw_only=True)
    """The number of iterations of that loop, if vectors have more lanes; 0 otherwise."""

    def text(self, expr: Expr) -> BreakableText:
        """An expression; what differs from lane to lane is a vector."""
        return text(expr, C, self._leaf)

    def _leaf(self, leaf: Named) -> BreakableText:
        if isinstance(leaf, Ends):
            return BreakableText((f"{self._of_ends('LOAD', leaf)})",))
        if not isinstance(leaf, Element):
            return element(leaf)
        if leaf.state:
            return BreakableText((self._of_state(leaf),))
        if self._vectors is not None and leaf.index and leaf.index.stride(self._lane):
            address, stride = address_text(leaf.array, leaf.index), leaf.index.stride(self._lane)
            if self._has_few(leaf.array):
                return BreakableText((f"TISSERAND_GATHER_FEW({address}, {stride}, {self._left})",))
            return BreakableText(
                (f"{self._macro('GATHER')}({address}, {stride})",)
                if stride != 1
                else (f"{self._macro('LOAD')}({address})",)
            )
        return element(leaf)

    @property
    def _vector(self) -> str:
        """The type of the values of all lanes."""
        return "tisserand_lanes" if self._lane == LANE else "tisserand_ends"

    def _macro(self, what: str) -> str:
        return f"TISSERAND_{what}" if self._lane == LANE else f"TISSERAND_{what}_ENDS"

    def _has_few(self, array: str) -> bool:
        """Whether an array has no elements for the lanes that are left."""
        return self._few > 0 and array not in self.filled

    @property
    def _left(self) -> str:
        """The number of iterations from the first lane of a vector on."""
        return f"{self._few} - {LANE}"

    @staticmethod
    def _of_ends(what: str, ends: Ends) -> str:
        return (
            f"TISSERAND_{what}_BOTH({ends.array}, {ends.variable}, {index_text(ends.first)}, {index_text(ends.second)}"
        )

    def _of_state(self, leaf: Element) -> str:
        if leaf.array in self.arrays:
            rows = row_distance(leaf.index)
            return f"{leaf.array}[{rows} + {leaf.state}]" if rows else f"{leaf.array}[{leaf.state}]"
        index = f"[{index_text(leaf.index)}]" if leaf.index else ""
        return f"{leaf.array}{index}[{leaf.state}]"

    def _differs(self, expr: Expr) -> bool:
        """Whether the value of an expression differs from lane to lane."""
        assert self._vectors is not None
        return any(
            (isinstance(part, ScalarRef) and part.name in self._vectors)
            or (isinstance(part, Element) and part.index is not None and part.index.has(self._lane))
            or isinstance(part, Ends)
            for part in walk(expr)
        )

    def _is_vector(self, name: str, expr: Expr) -> bool:
        """Whether a value is a vector; its name is known from then on."""
        if self._vectors is None or not self._differs(expr):
            return False
        self._vectors.add(name)
        return True

    def _accumulator(self, node: Accumulator) -> Lines:
        assert self._vectors is not None
        self._vectors.add(node.name)
        self._totals[node.name] = node.total
        value = self.text(node.expr) if self._differs(node.expr) else "{0.0}"
        return plain(f"    tisserand_lanes {node.name} = {value};")

    def _assign(self, node: Assign) -> Lines:
        negative = node.operator is Operator.NEG
        target, value = node.target, self.text(Operation(Operator.NEG, (node.expr,)) if negative else node.expr)
        if isinstance(target, ScalarRef):
            code = statement("    ", f"{target.name} {OPERATORS[node.operator]} ", value, ";")
            return defining(code, self._totals[target.name])
        if isinstance(target, Ends):
            return plain(*statement("    ", "", join(f"{self._of_ends('STORE', target)}, ", value, ")"), ";"))
        if self._vectors is None or not target.index or not target.index.has(self._lane):
            return self._stored(
                node, statement("    ", f"{self._leaf(target)} {OPERATORS[node.operator]} ", value, ";")
            )
        address, stride = address_text(target.array, target.index), target.index.stride(self._lane)
        if not self._differs(node.expr):
            index = index_text(ElementIndex(target.index.offset, (*target.index.terms, IndexTerm(stride, "m"))))
            width = f"TISSERAND_LEFT({self._left})" if self._has_few(target.array) else "TISSERAND_WIDTH"
            code = statement("    ", f"for (int m = 0; m < {width}; m++) {target.array}[{index}] = ", value, ";")
        elif self._has_few(target.array):
            few = join(f"TISSERAND_SCATTER_FEW({address}, {stride}, {self._left}, ", value, ")")
            code = statement("    ", "", few, ";")
        elif stride == 1:
            code = statement("    ", "", join(f"{self._macro('STORE')}({address}, ", value, ")"), ";")
        else:
            code = statement("    ", "", join(f"TISSERAND_SCATTER({address}, {stride}, ", value, ")"), ";")
        return self._stored(node, code)

    def _stored(self, node: Assign, code: list[str]) -> Lines:
        """The lines of an assignment to an element, with what they store or define."""
        assert isinstance(node.target, Element)
        array, index = node.target.array, node.target.index
        if array in self.outputs and index:
            return plain(*code) if node.operator else storing(code, array, index.offset, bool(index.terms))
        complete = isinstance(node.expr, ScalarRef) and node.expr.name in self._totals
        if complete or array in self._lanes:
            return plain(*code)
        return defining(code, array)
