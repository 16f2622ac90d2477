"""Kernels in straight line as Python functions on doubles, for those that are interpreted again and again.

The functions do the operations of the interpreter in its order, so that their results are the same to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import count
from typing import Any

from derive.errors import TisserandError
from derive.ir.expansion import expand
from derive.ir.expressions import Element, Expr, Number, Operation, Operator, ScalarRef, TableValue
from derive.ir.kernel import Kernel
from derive.ir.loop_nests import Assign
from derive.ir.operator_functions import ARITHMETIC, LIBRARY
from derive.ir.statements import Let, Require

SIGNS = {Operator.ADD: "+", Operator.SUB: "-", Operator.MUL: "*", Operator.DIV: "/"}
DEEPEST = 60
"""The largest depth of nested parentheses; Python reads no more than 200."""
Required = Callable[[Any, Require], None]
StraightLine = Callable[[Mapping[str, Any]], dict[str, list[Any]]]
"""A function from the arguments of a kernel to its outputs, both by their names."""


class NotStraight(TisserandError):
    """A kernel has loops, which the interpreter runs."""


def straight_line_function(
    kernel: Kernel, required: Required, tables: Mapping[str, Callable[[Any, int], Any]]
) -> StraightLine | None:
    """A function from arguments by their names to the outputs by theirs; None for a kernel with loops.

    required: called with the value of each requirement. tables: as those of `interpret`.
    """
    text = _Text()
    try:
        for statement in kernel.statements:
            for node in expand(statement):
                text.add(node)
    except NotStraight:
        return None
    head = [f"    {text.names[name]} = given[{a.name!r}]" for a in kernel.arguments if (name := a.name) in text.names]
    for a in kernel.arguments:
        used = [(index, text.names[name]) for index, name in a.named_elements if name in text.names]
        if used and not a.scalar:
            head += [f"    array = given[{a.name!r}]", *(f"    {name} = array[{index}]" for index, name in used)]
    outputs = [f"    {o.name!r}: [None] * {o.size}," for o in kernel.outputs]
    lines = ["def function(given):", "    outputs = {", *outputs, "    }", *head, *text.lines, "    return outputs"]
    scope = {**text.objects, "required": required, "tables": tables}
    exec(compile("\n".join(lines), kernel.name, "exec"), scope)
    function: StraightLine = scope["function"]
    return function


class _Text:
    """The lines of a function; names: those of values in it; objects: what its text refers to."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.names: dict[str, str] = {}
        self.objects: dict[str, Any] = {}
        self._numbers = count()

    def add(self, node: object) -> None:
        """Add the lines of a plain statement. Raises NotStraight."""
        match node:
            case Let(name, expr):
                value = self._value(expr)[0]
                self.lines.append(f"    {self._name(name)} = {value}")
            case Assign(Element() as target, expr, None) if target.index and not (target.index.terms or target.state):
                value = self._value(expr)[0]
                self.lines.append(f"    outputs[{target.array!r}][{target.index.offset}] = {value}")
            case Require():
                self.lines.append(f"    required({self._value(node.expr)[0]}, {self._object(node)})")
            case _:
                raise NotStraight

    def _value(self, expr: Expr) -> tuple[str, int]:
        """The text of an expression, and how deep its parentheses are. Raises NotStraight."""
        match expr:
            case Operation(kind, args):
                return self._operation(kind, [self._value(arg) for arg in args])
            case ScalarRef(name):
                return self._name(name), 0
            case Number(value):
                return f"({float(value)!r})", 1
            case TableValue():
                argument, depth = self._value(expr.argument)
                return self._shallow(f"tables[{expr.table!r}]({argument}, {expr.order})", depth + 1)
            case _:
                raise NotStraight

    def _operation(self, kind: Operator, args: Sequence[tuple[str, int]]) -> tuple[str, int]:
        texts, depth = [text for text, _ in args], 1 + max(depth for _, depth in args)
        if kind in SIGNS:
            return self._shallow(f"({texts[0]} {SIGNS[kind]} {texts[1]})", depth)
        if kind is Operator.NEG:
            return self._shallow(f"(-{texts[0]})", depth)
        function = self._object(LIBRARY.get(kind) or ARITHMETIC[kind])
        return self._shallow(f"{function}({', '.join(texts)})", depth)

    def _shallow(self, text: str, depth: int) -> tuple[str, int]:
        """A text, or the name of its value where it is too deep."""
        if depth < DEEPEST:
            return text, depth
        name = f"v{next(self._numbers)}"
        self.lines.append(f"    {name} = {text}")
        return name, 0

    def _name(self, name: str) -> str:
        return self.names.setdefault(name, f"v{next(self._numbers)}")

    def _object(self, value: Any) -> str:
        name = f"o{next(self._numbers)}"
        self.objects[name] = value
        return name
