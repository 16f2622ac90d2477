"""SymPy expressions as formulas in the order of a mechanics paper.

In a product stand: the number, masses and stiffness, moments, amplitudes, velocities, accelerations, sines and
cosines; in a sum: accelerations, velocities, the rest.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from derive.algebra import sp
from derive.mechanics.equations import Equations
from derive.mechanics.fixed_symbols import MASS
from derive.mechanics.indexed_equations import IndexedEquations
from derive.mechanics.symbols import Family, I, Identity, amplitude, identity
from derive.mechanics.time_expressions import KINDS
from derive.mechanics.time_functions import Absolute, Lookup, Select, Sign, SmoothStep, Wrapped
from derive.mechanics.typed_symbol import Symbol
from derive.report.document.formula import (
    Call,
    Fenced,
    Formula,
    FormulaRow,
    Matrix,
    Name,
    NumberToken,
    OperatorToken,
    Part,
    Power,
    Quotient,
    Root,
)
from derive.report.notation.families import written
from derive.report.notation.integral_symbols import dotted
from derive.report.notation.labels import delta, label, row_identities, variation
from derive.report.notation.typeset_names import Rank, TypesetSymbol

SMALL, LARGE = 1000, 10**7
"""Denominators up to the first and numerators up to the second are written as they are."""

DIGITS = 6

FUNCTION_NAMES: Mapping[type[sp.Expr], str] = {**KINDS, Sign: "sign"}
PRIME = "\u2032"

TOTAL_MASS = Name("m", below=("total",))
"""The mass of a body where a part of it is called m, as that of a beam which carries other masses."""

FIRST = {Family.TRANSLATION: 0, **dict.fromkeys((Family.ANGLE, Family.ANGULAR_VELOCITY, Family.VIRTUAL_ROTATION), 1)}
"""Coordinates in their order: c; phi and omega; alpha last."""

FAMILIES = {family: k for k, family in enumerate(Family)}

Key = tuple[object, ...]

ORDER = (Rank.ACCELERATION, Rank.VELOCITY, Rank.AMPLITUDE, Rank.MOMENT, Rank.CONSTANT, Rank.SINE, Rank.ROTATION)
"""The order in which factors determine the position of a summand."""


@dataclass(frozen=True)
class Notation:
    """The notation of the symbols and the rows of a model.

    `constants` are the symbols that the specification chose, in its order; `mass` is the one of the mass, if it has
    one; `rows` are the virtual displacements of the equations of motion, by the names of the rows. `with_rates` are the
    second derivatives of moments that are more than a product with accelerations, as those of second order are.
    """

    constants: tuple[sp.Symbol, ...] = ()
    mass: sp.Symbol | None = None
    rows: Mapping[str, Identity] = field(default_factory=dict)
    with_rates: frozenset[sp.Symbol] = frozenset()

    def written(self, symbol: sp.Symbol) -> TypesetSymbol:
        """The typeset form of a symbol, and its rank in a product."""
        if symbol in self.with_rates:
            return TypesetSymbol(Rank.MOMENT, dotted(identity(symbol)))
        if symbol != MASS:
            return written(symbol)
        if self.mass is not None:
            return written(self.mass)
        plain = written(MASS)
        taken = any(written(constant).formula == plain.formula for constant in self.constants)
        return TypesetSymbol(plain.rank, TOTAL_MASS) if taken else plain

    def label(self, row: str) -> str:
        """A row in plain letters: the coordinate that its virtual displacement is of."""
        return label(self.rows[row])

    def delta(self, row: str) -> str:
        """The virtual displacement of a row in plain letters."""
        return delta(self.rows[row])

    def variation(self, row: str) -> Formula:
        """The virtual displacement of a row as a formula."""
        return variation(self.rows[row])

    def formula(self, expr: sp.Expr) -> Formula:
        """An expression."""
        if isinstance(expr, sp.Add):
            return join(self.parts(expr))
        negative, formula = self._summand(expr)
        return FormulaRow((OperatorToken("-"), formula)) if negative else formula

    def factor(self, expr: sp.Expr) -> Formula:
        """An expression as a factor of a product: a sum in brackets."""
        formula = self.formula(expr)
        return Fenced(formula) if isinstance(formula, FormulaRow) else formula

    def matrix(self, entries: sp.Matrix) -> Matrix:
        """A matrix of expressions, whose zeros are dots."""
        shown = [[self.formula(e) if e != 0 else None for e in entries.row(k)] for k in range(entries.rows)]
        return Matrix(tuple(map(tuple, shown)))

    def vector(self, components: sp.Matrix) -> tuple[Part, ...]:
        """A vector as the sum of its components times base vectors."""
        parts = []
        for k, entry in enumerate(components, 1):
            negative = entry.could_extract_minus_sign()
            factor = self.factor(-entry if negative else entry)
            parts += [Part("-" if negative else "+", FormulaRow((factor, base(k))))] if entry != 0 else []
        return tuple(parts)

    def parts(
        self, expr: sp.Expr, anchor: str = "", group: str = "", title: str = "", to: str = ""
    ) -> tuple[Part, ...]:
        """The summands of an expression, in order; the first has the anchor."""
        result = []
        for k, summand in enumerate(sorted(sp.Add.make_args(expr), key=self.order)):
            negative, formula = self._summand(summand)
            result.append(Part("-" if negative else "+", formula, "" if k else anchor, group, title, to))
        return tuple(result)

    def order(self, summand: sp.Expr) -> Key:
        """The position of a summand: by its accelerations, its rates, its amplitudes, then by its other factors."""
        powers = summand.as_powers_dict()
        by_rank: dict[Rank, list[Key]] = {rank: [] for rank in Rank}
        for base, exponent in powers.items():
            if isinstance(base, sp.Symbol):
                by_rank[self.written(base).rank].append((*self._rank(base), float(exponent)))
        result: list[object] = []
        for rank in ORDER:
            keys = sorted(by_rank[rank])
            result += [not keys if rank in (Rank.ACCELERATION, Rank.VELOCITY) else bool(keys), tuple(keys)]
        return (*result, sp.default_sort_key(summand))

    def _rank(self, symbol: sp.Symbol) -> Key:
        """The position of a factor: its rank; the order of the specification, or c, phi, alpha; then its indices."""
        rank = self.written(symbol).rank
        if not isinstance(symbol, Symbol):
            return int(rank), len(self.constants), (symbol.name,)
        known = symbol.identity
        place = FIRST.get(known.family, len(FIRST))
        if rank == Rank.CONSTANT:
            place = self.constants.index(symbol) if symbol in self.constants else len(self.constants)
        shapes = tuple(s if isinstance(s, int) else 0 for s in known.shapes)
        own = (known.owner, FAMILIES[known.family], known.point, shapes, known.components, known.name)
        return int(rank), place, own

    def _summand(self, expr: sp.Expr) -> tuple[bool, Formula]:
        """A product: whether it is negative, and the formula of its magnitude."""
        number, rest = expr.as_coeff_Mul()
        above, below, others = self._sorted(rest)
        negative = number < 0
        top, bottom = _number(abs(number))
        up = [*top, *above]
        down = [*bottom, *below]
        front = [Quotient(row(up) if up else NumberToken("1"), row(down))] if down else up
        return bool(negative), row([*front, *others]) if front or others else NumberToken("1")

    def _sorted(self, product: sp.Expr) -> tuple[list[Formula], list[Formula], list[Formula]]:
        """Constants above and below a fraction, and the other factors."""
        above: list[tuple[Key, Formula]] = []
        below: list[tuple[Key, Formula]] = []
        others: list[tuple[Key, Formula]] = []
        for factor in sp.Mul.make_args(product):
            if factor == 1:
                continue
            base, exponent = factor.as_base_exp()
            under = exponent.is_Rational and exponent < 0
            formula = self._power(base, -exponent if under else exponent)
            plain = isinstance(base, sp.Symbol)
            key: Key = self._rank(base) if plain else (int(Rank.SINE) + 1, 0, (str(base),))
            place = below if under else above if plain and key[0] == Rank.CONSTANT else others
            place.append((key, formula))
        return _in_order(above), _in_order(below), _in_order(others)

    def _power(self, base: sp.Expr, exponent: sp.Expr) -> Formula:
        if exponent == 1:
            return self._atom(base)
        if exponent == sp.S.Half:
            return Root(self.formula(base))
        return Power(self._atom(base), self.formula(exponent))

    def _atom(self, expr: sp.Expr) -> Formula:
        if isinstance(expr, sp.Symbol):
            formula = self.written(expr).formula
            return Fenced(formula) if isinstance(formula, FormulaRow) and _of_columns(formula) else formula
        if expr.is_Rational:
            return self.factor(expr)
        if expr == sp.pi:
            return Name("pi")
        if isinstance(expr, sp.Function):
            return self._call(expr)
        return self.factor(expr)

    def _call(self, expr: sp.Function) -> Formula:
        """A function of time in the words of a specification; the derivatives of tables and steps have primes."""
        match expr:
            case Absolute(args=(x,)):
                return Fenced(self.formula(x), "|", "|")
            case Select(args=(a, b, x, y)):
                condition = row([self.formula(a), OperatorToken("<"), self.formula(b)])
                return Call("piecewise", _listed([condition, self.formula(x), self.formula(y)]))
            case Wrapped(args=(x, s)):
                return Call("mod", _listed([self.formula(x), self.formula(2 * sp.pi * s)]))
            case Lookup(args=(name, order, x)):
                return Call(f"{name}{PRIME * int(order)}", self.formula(x))
            case SmoothStep(args=(*args, order)):
                return Call(f"step{PRIME * int(order)}", _listed([self.formula(x) for x in args]))
        return Call(FUNCTION_NAMES[type(expr)], _listed([self.formula(x) for x in expr.args]))


def _listed(formulas: Sequence[Formula]) -> Formula:
    """Formulas with commas between them."""
    first, *others = formulas
    return row([first, *(part for formula in others for part in (OperatorToken(","), formula))])


def notation(equations: Equations) -> Notation:
    """The notation of a model: its own parameters, and m as they call it."""
    coefficients = equations.coefficients
    value = next((c.value for c in coefficients if c.symbol == MASS), None)
    parameters = tuple(p.symbol for p in equations.parameters)
    mass = value if isinstance(value, sp.Symbol) else None
    sums = equations.mode_sums if isinstance(equations, IndexedEquations) else ()
    with_rates = frozenset(s.symbol for s in sums if _has_both(s.term))
    return Notation(parameters, mass, row_identities(equations), with_rates)


def _has_both(term: sp.Expr) -> bool:
    """Whether an expression has summands with accelerations of the amplitudes, and others without."""
    accelerated = [summand.has(amplitude(I, 2)) for summand in sp.Add.make_args(term)]
    return any(accelerated) and not all(accelerated)


def base(k: int) -> Name:
    """A base vector."""
    return Name("e", below=(str(k),), style="vector")


def row(factors: Sequence[Formula]) -> Formula:
    """Factors beside each other; one of them is a formula by itself."""
    return factors[0] if len(factors) == 1 else FormulaRow(tuple(factors))


def join(parts: Iterable[Part]) -> Formula:
    """A sum as one formula."""
    result: list[Formula] = []
    for k, part in enumerate(parts):
        result += [OperatorToken(part.sign)] if k or part.sign == "-" else []
        result.append(part.formula)
    return row(result) if result else NumberToken("0")


def number(value: sp.Rational) -> Formula:
    """A number: a fraction of small whole numbers, or a decimal; six digits of those that do not end before."""
    negative, (above, below) = value < 0, _number(abs(value))
    top = above[0] if above else NumberToken("1")
    formula = Quotient(top, below[0]) if below else top
    return FormulaRow((OperatorToken("-"), formula)) if negative else formula


def _number(value: sp.Expr) -> tuple[list[Formula], list[Formula]]:
    """The numerator and the denominator of a positive number; nothing for 1."""
    if not value.is_Rational:
        return [NumberToken(f"{float(value):.{DIGITS}g}")], []
    if value.q <= SMALL and value.p < LARGE:
        return [NumberToken(str(n))] if (n := value.p) != 1 else [], [NumberToken(str(n))] if (
            n := value.q
        ) != 1 else []
    return [NumberToken(decimal(value))], []


def decimal(value: sp.Rational) -> str:
    """A positive number as a decimal: all of it if it ends within twelve digits, else six."""
    short, long = f"{float(value):.{DIGITS}g}", f"{float(value):.12g}"
    return long if sp.Rational(long) == value else short


def _of_columns(formula: FormulaRow) -> bool:
    """Whether a row is a product of matrices, which needs brackets among other factors."""
    return any(isinstance(part, Name) and part.style == "vector" for part in formula.parts)


def _in_order(keyed: list[tuple[Key, Formula]]) -> list[Formula]:
    by_key: Callable[[tuple[Key, Formula]], Key] = lambda pair: pair[0]  # noqa: E731
    return [formula for _, formula in sorted(keyed, key=by_key)]
