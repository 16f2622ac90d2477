"""Linear forms in the elements of arguments, which straight-line code has for the sums over the modes of a body.

The integrals of a body with many modes are dense: S_i = C4_i + sum_j C5_ij alpha_j for each mode i and each component.
In straight-line code with numbers, these are linear forms in neighbouring elements of an argument. They are found here
by their structure, whatever the names are, so that a backend can compute them in loops over a table of their factors.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from derive.ir.analysis import expressions
from derive.ir.expressions import Element, Expr, Number, Operation, Operator, ScalarRef, walk
from derive.ir.indices import constant
from derive.ir.kernel import Kernel
from derive.ir.statements import Let, Require, Statement, Store

FEWEST_OPERATIONS = 4
"""The operations of an expression from which on it is worth a row of a table."""
FEWEST_ROWS = 12
"""The rows of a table from which on a loop is worth it: shorter ones take no less time than straight-line code."""
FEWEST_FACTORS = 4
SCALAR = (Let, Store, Require)
"""The statements in straight line, a tuple since a union is made anew at each test."""
DENSE = Fraction(3, 4)
"""The smallest part of the elements between the first and the last one that a form depends on."""


@dataclass(frozen=True)
class Window:
    """Neighbouring elements of an argument: its name, the first element, and their number."""

    argument: str
    first: int
    count: int


@dataclass(frozen=True)
class Row:
    """The factors of a linear form of the elements of a window, and its constant term."""

    factors: tuple[Fraction, ...]
    offset: Fraction

    def opposite(self) -> Row:
        """The row of the negative form."""
        return Row(tuple(-factor for factor in self.factors), -self.offset)

    def among(self, rows: Container[Row]) -> Row:
        """The opposite row if it is among `rows`, else this one: of two opposite rows, the first one is in a table."""
        opposite = self.opposite()
        return opposite if self not in rows and opposite in rows else self


@dataclass(frozen=True)
class FormValues:
    """An array of a kernel with the values of rows of the elements of a window, in their order.

    Each row has the index at which the array has its value.
    """

    array: str
    window: Window
    rows: Mapping[Row, int]


@dataclass(frozen=True)
class LinearParts:
    """A kernel with its linear forms replaced by elements of arrays.

    sections: the statements of each section with their numbers, without those that nothing needs any more.
    """

    values: tuple[FormValues, ...]
    sections: tuple[tuple[tuple[int, Statement], ...], ...]


@dataclass(frozen=True)
class _Form:
    """A linear form: the argument ("" if there is none), the factors of its elements, and the constant term."""

    argument: str
    factors: Mapping[int, Fraction]
    offset: Fraction

    @property
    def window(self) -> Window:
        first, last = min(self.factors), max(self.factors)
        return Window(self.argument, first, last + 1 - first)

    def scaled(self, factor: Fraction) -> _Form:
        factors = {k: factor * x for k, x in self.factors.items()}
        return _Form(self.argument, factors, factor * self.offset)

    def plus(self, other: _Form) -> _Form | None:
        """The sum; None if the arguments differ."""
        if self.argument and other.argument and self.argument != other.argument:
            return None
        factors = dict(self.factors)
        for k, x in other.factors.items():
            factors[k] = factors.get(k, Fraction(0)) + x
        kept = {k: x for k, x in factors.items() if x}
        return _Form(self.argument or other.argument if kept else "", kept, self.offset + other.offset)

    def row(self, window: Window) -> Row:
        """The factors of all elements of a window."""
        elements = range(window.first, window.first + window.count)
        return Row(tuple(self.factors.get(k, Fraction(0)) for k in elements), self.offset)


def linear_rows(known: KernelForms) -> dict[Window, tuple[Row, ...]]:
    """The rows that a kernel needs of each window, in their order and with the signs that they have first.

    Windows that overlap are joined. Those with less than `FEWEST_ROWS` rows are left out.
    """
    forms = known.found
    windows = _joined(form.window for form in forms)
    rows: dict[Window, dict[Row, int]] = defaultdict(dict)
    for form in forms:
        row, present = form.row(windows[form.window]), rows[windows[form.window]]
        present.setdefault(row.among(present), len(present))
    enough = {window: of for window, of in rows.items() if len(of) >= FEWEST_ROWS}
    if not enough:
        return {}
    every = {str(n): FormValues(str(n), window, of) for n, (window, of) in enumerate(enough.items())}
    parts = linear_parts(known, tuple(every.values()))
    read: dict[str, set[int]] = defaultdict(set)
    for statement in (statement for section in parts.sections for _, statement in section):
        for leaf in _leaves(statement):
            if isinstance(leaf, Element) and leaf.index:
                read[leaf.array].add(leaf.index.offset)
    needed = {of.window: tuple(row for row, k in of.rows.items() if k in read[name]) for name, of in every.items()}
    return {window: of for window, of in needed.items() if len(of) >= FEWEST_ROWS}


def linear_parts(known: KernelForms, values: Sequence[FormValues]) -> LinearParts:
    """A kernel whose linear forms are elements of arrays; `values` are the arrays of the windows that have one."""
    sections = known.sections_with(values)
    needed: set[str] = set()
    kept: list[tuple[tuple[int, Statement], ...]] = []
    for section in reversed(sections):
        body = []
        for n, statement in reversed(section):
            if isinstance(statement, Let) and statement.name not in needed:
                continue
            needed |= {leaf.name for leaf in _leaves(statement) if isinstance(leaf, ScalarRef)}
            body.append((n, statement))
        kept.append(tuple(reversed(body)))
    return LinearParts(tuple(values), tuple(reversed(kept)))


def _leaves(statement: Statement) -> list[Expr]:
    return [part for expr in expressions(statement) for part in walk(expr) if not isinstance(part, Operation)]


def _joined(windows: Iterable[Window]) -> dict[Window, Window]:
    """Each window with the smallest one that contains it and all that it overlaps with."""
    ordered = sorted(set(windows), key=lambda w: (w.argument, w.first, -w.count))
    result: dict[Window, Window] = {}
    group: list[Window] = []
    for window in ordered:
        stop = max((w.first + w.count for w in group), default=0)
        if group and (window.argument != group[0].argument or window.first >= stop):
            result |= _together(group)
            group = []
        group.append(window)
    return result | _together(group)


def _together(group: Sequence[Window]) -> dict[Window, Window]:
    if not group:
        return {}
    first, stop = group[0].first, max(w.first + w.count for w in group)
    return dict.fromkeys(group, Window(group[0].argument, first, stop - first))


class KernelForms:
    """The linear forms of a kernel that are worth a row, in the order of its statements: `found`."""

    def __init__(self, kernel: Kernel) -> None:
        self.found: list[_Form] = []
        self._values: Sequence[FormValues] = ()
        one = Fraction(1)
        self._known: dict[str, _Form | None] = {
            name: _Form(argument.name, {k: one}, Fraction(0))
            for argument in kernel.arguments
            if not argument.scalar
            for k, name in argument.named_elements
        }
        self._sections = [[self._with_forms(s) for s in section.body] for section in kernel.sections]

    def _with_forms(self, statement: Statement) -> tuple[Statement, bool]:
        """A statement, and whether it has forms; the name that it defines is known from then on."""
        if not isinstance(statement, SCALAR):
            return statement, False
        before = len(self.found)
        form, expr, operations = self._parts(statement.expr)
        if isinstance(statement, Let):
            self._known[statement.name] = form
        self._whole(form, expr, operations)
        return statement, len(self.found) > before

    def sections_with(self, values: Sequence[FormValues]) -> list[list[tuple[int, Statement]]]:
        """The numbered statements of each section, where elements of these arrays replace the forms."""
        self._values = values
        return [
            [(n, self._replaced(s) if has_forms else s) for n, (s, has_forms) in enumerate(section)]
            for section in self._sections
        ]

    def _replaced(self, statement: Statement) -> Statement:
        assert isinstance(statement, SCALAR)
        whole = self._whole(*self._parts(statement.expr))
        return statement if whole is statement.expr else replace(statement, expr=whole)

    def _parts(self, expr: Expr) -> tuple[_Form | None, Expr, int]:
        """The form of an expression, the expression with the forms in it replaced if it is none, its operations."""
        if isinstance(expr, Operation):
            args = expr.args
            parts = [self._parts(arg) for arg in args]
            operations = 1
            forms: list[_Form] = []
            for form, _, count in parts:
                operations += count
                if form is not None:
                    forms.append(form)
            whole = _combined(expr.kind, forms) if len(forms) == len(parts) else None
            if whole is not None:
                return whole, expr, operations
            replaced = [self._whole(*part) for part in parts]
            same = all(now is before for now, before in zip(replaced, args, strict=True))
            return None, expr if same else Operation(expr.kind, tuple(replaced)), operations
        if isinstance(expr, ScalarRef):
            return self._known.get(expr.name), expr, 0
        return (_Form("", {}, expr.value) if isinstance(expr, Number) else None), expr, 0

    def _whole(self, form: _Form | None, expr: Expr, operations: int) -> Expr:
        """An expression, or the element of an array in its place if it is a form that is worth a row."""
        if form is None or operations < FEWEST_OPERATIONS or len(form.factors) < FEWEST_FACTORS:
            return expr
        if len(form.factors) < DENSE * form.window.count:
            return expr
        if not self._values:
            self.found.append(form)
        for values in self._values:
            window = values.window
            inside = window.first <= form.window.first < window.first + window.count
            if form.argument == window.argument and inside:
                row = form.row(window)
                present = row.among(values.rows)
                index = values.rows.get(present)
                if index is None:
                    return expr  # nothing needs it
                element = Element(values.array, constant(index))
                return element if present == row else Operation(Operator.NEG, (element,))
        return expr


def _combined(kind: Operator, forms: Sequence[_Form]) -> _Form | None:
    """The form of an operation on forms; None if it is not linear, or if its arguments differ."""
    first, *others = forms
    match kind:
        case Operator.NEG:
            return first.scaled(Fraction(-1))
        case Operator.ADD:
            return first.plus(others[0])
        case Operator.SUB:
            return first.plus(others[0].scaled(Fraction(-1)))
        case Operator.MUL:
            number, form = (first, others[0]) if not first.factors else (others[0], first)
            return None if number.factors else form.scaled(number.offset)
        case Operator.DIV:
            number = others[0]
            return None if number.factors or not number.offset else first.scaled(1 / number.offset)
        case _:
            return None
