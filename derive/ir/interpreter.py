"""Run a Kernel in Python on any numbers that know + - * /: floats, fractions, mpmath, SymPy or CasADi symbols."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from typing import Any, assert_never

from derive.errors import TisserandError
from derive.ir.batches import batch
from derive.ir.expansion import expand
from derive.ir.expressions import (
    Element,
    Ends,
    Expr,
    LaneSum,
    MatrixEntry,
    Number,
    Operation,
    Operator,
    ScalarRef,
    TableValue,
)
from derive.ir.indices import LANES
from derive.ir.kernel import Kernel
from derive.ir.library_calls import COUNT, STATE
from derive.ir.loop_nests import (
    Accumulator,
    Alias,
    Assign,
    BlockProduct,
    For,
    If,
    Integer,
    Local,
    Node,
    PartOf,
    Sines,
)
from derive.ir.operator_functions import ARITHMETIC, LIBRARY
from derive.ir.statements import Let, Require, Requirement, ReturnCode


class RequirementError(TisserandError, ArithmeticError):
    """A requirement of a kernel does not hold; `code` is what the generated C returns."""

    def __init__(self, code: ReturnCode, text: str) -> None:
        self.code = code
        super().__init__(text)


def interpret(
    kernel: Kernel,
    arguments: Mapping[str, Any],
    *,
    number: Callable[[Fraction], Any] = float,
    functions: Mapping[str, Callable[..., Any]] | None = None,
    check: bool = True,
    tables: Mapping[str, Callable[[Any, int], Any]] | None = None,
    nodes: Iterable[Node] | None = None,
) -> dict[str, list[Any]]:
    """The outputs of a kernel, computed statement by statement: slowly, and in any type of numbers.

    Arguments:
        kernel: one of the kernels of a model, see `Model.kernel`.
        arguments: by their names, sequences of the sizes of the arguments, or numbers for scalars.
        number: converts exact constants into the type of number.
        functions: `sin`, `cos`, `sqrt` and the others of `LIBRARY` of that type.
        check: whether requirements are checked.
        tables: functions of an argument and the order of the derivative, by the names of the tables of the model, such
            as its splines.
        nodes: plain statements to run in place of the statements of the kernel.

    Returns:
        By the names of the outputs, lists of the sizes of `kernel.outputs`.

    Raises:
        RequirementError: if a requirement does not hold, such as a positive mass.
        ValueError: for an argument that is missing or has a wrong length.
        TypeError: for anything but a kernel.

    Examples:
        >>> import derive
        >>> from fractions import Fraction
        >>> model = derive.lower(derive.derive(derive.planar_beam("beam", mass=3, length=2, bending_stiffness=1)))
        >>> k = derive.interpret(model.kernel("setup"), {"p": []}, number=Fraction)["k"]
        >>> M = derive.interpret(model.kernel("mass"), {"q": [0, 0, 0, 0, 0], "k": k}, number=Fraction)["M"]
        >>> M[:3]  # m, m, m l^2/12
        [Fraction(3, 1), Fraction(3, 1), Fraction(1, 1)]
    """
    if not isinstance(kernel, Kernel):
        raise TypeError(f'a kernel is needed, such as model.kernel("mass"), not {type(kernel).__name__}')
    if missing := [argument.name for argument in kernel.arguments if argument.name not in arguments]:
        raise ValueError(f"{kernel.name} needs {', '.join(missing)} as well")
    call = {**ARITHMETIC, **LIBRARY}
    call |= {Operator(name): function for name, function in (functions or {}).items()}
    run = _Run(kernel, arguments, number, call, check, tables or {})
    run.all(nodes if nodes is not None else (node for statement in kernel.statements for node in expand(statement)))
    return run.outputs


class _Run:
    """Values and arrays by name while a kernel runs; a part of an array is known by the array and its first element."""

    def __init__(
        self,
        kernel: Kernel,
        arguments: Mapping[str, Any],
        number: Callable[[Fraction], Any],
        call: Mapping[Operator, Callable[..., Any]],
        check: bool,
        tables: Mapping[str, Callable[[Any, int], Any]],
    ) -> None:
        self.number, self.call, self.check, self.tables = number, call, check, tables
        self.zero = number(Fraction(0))
        self.values: dict[str, Any] = {}
        self.variables: dict[str, int] = {}
        self.arrays: dict[str, tuple[list[Any], int]] = {}
        for a in kernel.arguments:
            values: Any = arguments[a.name]
            if a.integer:
                self.variables[a.name] = values
                continue
            if a.scalar:
                self.values[a.name] = values
                continue
            if len(values) != a.size:
                raise ValueError(f"{a.name} needs {a.size} elements, not {len(values)}")
            array = list(values)
            self.arrays[a.name] = array, 0
            self.values |= {name: values[index] for index, name in a.named_elements}
            self.arrays |= {v.name: (array, v.offset) for v in a.arrays}
        self.arrays |= {a.name: (a.interpreted(number), 0) for a in kernel.constants}
        self.outputs: dict[str, list[Any]] = {o.name: [None] * o.size for o in kernel.outputs}
        self.arrays |= {name: (values, 0) for name, values in self.outputs.items()}

    def value(self, expr: Expr) -> Any:
        """The value of an expression."""
        match expr:
            case Number():
                return self.number(expr.value)
            case ScalarRef():
                return self.values[expr.name]
            case Element() | Ends():
                array, position = self.place(expr)
                return array[position]
            case LaneSum():
                return self.value(expr.expr)
            case Operation():
                return self.call[expr.kind](*(self.value(arg) for arg in expr.args))
            case TableValue():
                return self.tables[expr.table](self.value(expr.argument), expr.order)
            case MatrixEntry():
                raise AssertionError("entries of matrices are expanded to elements")
            case _:
                assert_never(expr)

    def place(self, element: Element | Ends) -> tuple[list[Any], int]:
        """The list that holds an element, and its index there."""
        if isinstance(element, Ends):
            element = element.of(self.variables[element.variable])
        if element.state:
            return self._row(element), self.variables[element.state]
        array, first = self.arrays[element.array]
        assert element.index
        return array, first + element.index.at(self.variables)

    def _row(self, element: Element) -> list[Any]:
        """The values of all states of an element or of a scalar."""
        array, first = self.arrays[element.array]
        return array[first + element.index.at(self.variables)] if element.index else array

    def _angles(self, node: Sines) -> list[Any]:
        """The angles of some sines."""
        if not node.stride:
            return self._row(node.angle)[: node.count]
        array, first = self.place(node.angle)
        return array[first :: node.stride][: node.count]

    def all(self, nodes: Iterable[Node]) -> None:
        """Run plain statements."""
        for node in nodes:
            self.step(node)

    def step(self, node: Node) -> None:
        """Run a plain statement."""
        match node:
            case Let() | Accumulator():
                self.values[node.name] = self.value(node.expr)
            case Assign():
                self._assign(node)
            case Require():
                if self.check:
                    self.require(self.value(node.expr), node)
            case Local():
                self.arrays[node.array] = self.new_array(node.size, self.zero if node.cleared else None), 0
            case Alias():
                array, first = self.arrays[node.array]
                self.arrays[node.name] = array, first + node.index.at(self.variables)
            case Integer():
                array, first = self.arrays[node.array]
                value = array[first + node.index.at(self.variables)]
                self.variables[node.name] = value * node.factor(self.variables)
            case For():
                for step in node.values(self.variables):
                    self.variables[node.variable] = step
                    self.all(node.body)
            case If():
                self.all(node.then if self.variables[node.variable] < node.bound else node.otherwise)
            case PartOf():
                self.all(node.body)
            case BlockProduct():
                self._block_product(node)
            case Sines():
                angles = self._angles(node)
                for k, (name, operator) in enumerate(((node.sine, Operator.SIN), (node.cosine, Operator.COS))):
                    values = [self.call[operator](angle) for angle in angles]
                    if node.rows:
                        self._row(Element(name, node.rows[k]))[:] = values
                    else:
                        self.arrays[name] = values, 0
            case _:
                assert_never(node)

    def require(self, value: Any, requirement: Require) -> None:
        """End the run where a requirement does not hold."""
        check_requirement(value, requirement)

    def new_array(self, size: int, value: Any) -> list[Any]:
        """The elements of a new array; those that no statement has written yet are None, so that none can be read."""
        return [value] * size

    def _block_product(self, node: BlockProduct) -> None:
        matrix, first = self.arrays[node.matrix]
        first += node.first.at(self.variables)
        (vector, x), (target, y) = self.place(node.vector), self.place(node.target)
        for state in range(len(target[y])):
            for r in range(y, y + LANES):
                for c in range(LANES):
                    entry = node.sign * matrix[first + r - y + node.stride * c]
                    target[r][state] = target[r][state] + entry * vector[x + c][state]

    def _assign(self, node: Assign) -> None:
        value = self.value(node.expr)
        if node.operator is Operator.NEG:
            value = self.call[Operator.NEG](value)
        elif node.operator is not None:
            value = self.call[node.operator](self.value(node.target), value)
        if isinstance(node.target, ScalarRef):
            self.values[node.target.name] = value
        else:
            array, position = self.place(node.target)
            array[position] = value


class _BatchRun(_Run):
    """A run of many states, in which each element of an array is a list of values; `codes` are those of the states."""

    def __init__(self, kernel: Kernel, arguments: Mapping[str, Any], scalars: Iterable[str], states: int) -> None:
        super().__init__(kernel, arguments, float, {**ARITHMETIC, **LIBRARY}, True, {})
        self.codes, self.variables[COUNT] = [0] * states, states
        self.outputs |= {o.name: [[self.zero] * states for _ in range(o.size)] for o in kernel.outputs}
        self.arrays |= {name: (values, 0) for name, values in self.outputs.items()}
        self.arrays |= {name: ([self.zero] * states, 0) for name in scalars}

    def require(self, value: Any, requirement: Require) -> None:
        """Give the state the code of the first requirement that does not hold."""
        state = self.variables[STATE]
        if not _meets(value, requirement.kind):
            self.codes[state] = self.codes[state] or requirement.code

    def new_array(self, size: int, value: Any) -> list[Any]:
        """The elements of a new array."""
        return [[value] * self.variables[COUNT] for _ in range(size)]


def interpret_batch(
    kernel: Kernel, arguments: Mapping[str, Any], states: int
) -> tuple[dict[str, list[list[float]]], list[int]]:
    """The outputs of a kernel for many states, as lists of elements with a value for each state; and their codes.

    arguments: as those of `interpret`, but q, v and others that have states with a list of values in each element.
    """
    many = batch(kernel)
    run = _BatchRun(kernel, arguments, many.scalars, states)
    run.all(many.nodes)
    return run.outputs, run.codes


def check_requirement(value: Any, requirement: Require) -> None:
    """Raise RequirementError if a value does not meet a requirement."""
    if not _meets(value, requirement.kind):
        raise RequirementError(requirement.code, requirement.text)


def _meets(value: Any, requirement: Requirement) -> bool:
    match requirement:
        case Requirement.POSITIVE:
            return bool(value > 0)
        case Requirement.FINITE:
            return math.isfinite(value)
        case _:
            assert_never(requirement)
