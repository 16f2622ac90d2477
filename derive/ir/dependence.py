"""Which results of statements depend on which inputs, by running them on sets of inputs in place of numbers.

Numbers of the code are known, so that what follows from zeros among them depends on nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from derive.ir.expressions import LIBRARY_OPERATORS, Operator
from derive.ir.interpreter import interpret
from derive.ir.kernel import Kernel

_OPAQUE = (
    *LIBRARY_OPERATORS,
    *(Operator.SQRT, Operator.SIGN, Operator.NOT, Operator.LESS, Operator.NOT_GREATER),
    *(Operator.MIN, Operator.MAX, Operator.WHEN),
)
"""The operators whose results are not zero, whatever is known of their arguments."""


@dataclass(frozen=True)
class Reached:
    """A value that is not known, with the inputs on which it depends as the bits of an integer."""

    inputs: int = 0

    def __add__(self, other: Known) -> Reached:
        return Reached(self.inputs | other.inputs) if isinstance(other, Reached) else self

    def __mul__(self, other: Known) -> Known:
        return other if other == 0 else self + other

    def __neg__(self) -> Reached:
        return self

    __radd__ = __sub__ = __rsub__ = __truediv__ = __add__
    __rmul__ = __rtruediv__ = __mul__


Known = Fraction | Reached


def _of_all(*values: Known) -> Reached:
    return Reached(_bits(values))


def _bits(values: Iterable[Known]) -> int:
    result = 0
    for value in values:
        result |= value.inputs if isinstance(value, Reached) else 0
    return result


def dependences(kernel: Kernel, arguments: Mapping[str, Sequence[Reached] | Reached]) -> dict[str, list[int]]:
    """The inputs on which the elements of the outputs depend, as the bits of integers.

    arguments: what each of their elements depends on.
    """
    functions = {of.value: _of_all for of in _OPAQUE}
    found = interpret(kernel, arguments, number=Fraction, functions=functions, check=False)
    return {name: [_bits((x,)) for x in values] for name, values in found.items()}
