"""The accelerations of a body in straight-line code."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import chain, count

import casadi as ca
import sympy as sp

from derive.ir.expressions import ScalarRef
from derive.ir.model import Kernel
from derive.ir.statements import Requirement, ReturnCode
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.constant_elimination import ReducedSystem, reduced_system
from derive.lowering.flat.context import Context, define, stores
from derive.lowering.flat.functions import pivot_checks
from derive.lowering.flat.polynomial_code import PolynomialCode, Signed
from derive.lowering.flat.polynomials import Coefficient, rational
from derive.lowering.flat.schedule import NamedValue, RequiredValue, Step
from derive.lowering.functions import ModelFunction, OutputElements
from derive.lowering.ldlt import VANISHING, factorise, solve
from derive.mechanics.symbols import local
from derive.mechanics.terms import ModelConstant, rotation_symbols
from derive.roles import Source


def accel(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of the accelerations vdot of M vdot + h = 0."""
    system = reduced_system(context.equations)
    return _factorised(context, function) if system is None else _reduced(context, function, system)


def _factorised(context: Context, function: ModelFunction) -> Kernel:
    """The kernel of any body: all of M is factorised."""
    symbols = context.symbols(context.q, context.v)
    eq = context.equations
    shape = context.mass_pattern()
    entries = {(i, j): symbols(eq.mass[i, j]) for i, j in shape.entries}
    factors = factorise(shape, entries)
    solution = solve(factors, [-symbols(h) for h in eq.force])
    pivots = list(zip(factors.pivots, factors.order, strict=True))
    named = tuple(NamedValue(f"pivot_{context.rows[j]}", pivot) for pivot, j in pivots)
    required = pivot_checks(symbols, factors, context.rows)
    order = ", ".join(context.rows[j] for j in factors.order)
    fill = f"fill-in {factors.fill}" if factors.fill else "no fill-in"
    return context.kernel(
        function,
        {"vdot": OutputElements(context.accelerations)},
        symbols,
        Step("pivots", Source.FACTORISATION, f"eliminate {order}; {fill}", (*named, *required)),
        Step("solution", Source.FACTORISATION, "forward, diagonal and back substitution", stores("vdot", solution)),
        _finite(solution),
        method=", by a sparse LDL^T fixed at generation time.",
    )


def _reduced(context: Context, function: ModelFunction, system: ReducedSystem) -> Kernel:
    """The kernel of a planar body whose mass matrix in the body frame is constant but for one row."""
    symbols = context.symbols(context.q, context.v)
    code = PolynomialCode(system.polynomials, symbols.values, _Coefficients(context, symbols, system))
    rows, row = context.rows, system.row
    pivot = code(system.pivot, f"inertia_{rows[row]}")
    x = {row: code(system.right, f"force_{rows[row]}") / pivot}
    for i, free in system.free.items():
        x[i] = code(free, f"free_{rows[i]}")
        if system.coupling[i]:
            x[i] = x[i] - code(system.coupling[i], f"coupling_{rows[i]}") * x[row]
    eliminated = _eliminated_inertia(system, code)
    lost = f"the pivot of {rows[row]} vanished"
    above = pivot if eliminated is None else pivot - symbols.number(VANISHING) * eliminated
    required = [RequiredValue(Requirement.POSITIVE, above, ReturnCode.PIVOT, lost)]
    for block in system.blocks:
        unit = code(system.polynomials.ring.ground_new(block.unit), f"unit_{rows[block.rows[0]]}")
        text = f"the pivot of {rows[block.rows[0]]} vanished"
        required.append(RequiredValue(Requirement.POSITIVE, unit, ReturnCode.PIVOT, text))
    order = ", ".join([*(rows[i] for block in system.blocks for i in block.rows), rows[row]])
    vdot = _in_inertial_frame(context, symbols, x)
    rotation = tuple(d for d in context.equations.definitions if d.symbol in rotation_symbols([d]))
    return context.kernel(
        function,
        {"vdot": OutputElements(context.accelerations)},
        symbols,
        Step("Q", "(26)", "the rotation, first, since its functions take the longest", define(symbols, rotation)),
        Step(
            "pivots",
            Source.FACTORISATION,
            f"translations in the body frame; eliminate {order}",
            (NamedValue(f"pivot_{rows[row]}", pivot),),
        ),
        Step("solution", Source.FACTORISATION, "back substitution, and translations in the inertial frame", stores("vdot", vdot)),
        _finite(vdot, required),
        method=", by elimination of the constant rows of M in the body frame, fixed at generation time.",
    )


def _in_inertial_frame(context: Context, symbols: Symbols, x: dict[int, ca.SX]) -> list[ca.SX]:
    """vdot = T x, the accelerations whose translations are resolved in the body frame."""
    assert context.equations.body is not None
    rotation = context.equations.body.motion.rotation
    seen = [local(f"x{k + 1}") for k in range(rotation.rows)]
    for k, symbol in enumerate(seen):
        symbols.values[symbol] = x[k]
    present = sp.Matrix([0 if x[k].is_zero() else symbol for k, symbol in enumerate(seen)])
    turned = [symbols(expr) for expr in rotation * present]
    return [*turned, *(x[i] for i in range(rotation.rows, len(x)))]


def _eliminated_inertia(system: ReducedSystem, code: PolynomialCode) -> ca.SX | None:
    """What elimination takes from the diagonal entry of the row that remains; None if nothing."""
    ring = system.polynomials.ring
    constant, rest = ring.zero, []
    for i, entry in system.column.items():
        factor = system.coupling[i]
        if entry.is_ground:
            constant = constant + entry * factor if factor.is_ground else constant
            rest += [] if factor.is_ground else [code(entry * factor, f"eliminated_{i}")]
        elif factor:
            ratio = entry.LC / factor.LC
            value = code(factor, f"coupling_{i}")
            proportional = entry == factor * ratio
            rest.append(
                code(ring.ground_new(ratio), f"ratio_{i}") * (value * value)
                if proportional
                else code(entry, f"column_{i}") * value
            )
    terms = [*([code(constant, "eliminated")] if constant else []), *rest]
    return balanced(terms) if terms else None


def _finite(values: list[ca.SX], required: Iterable[RequiredValue] = ()) -> Step:
    """The step that checks the result, with a sum of short latency, which is not finite if one of the values is not."""
    present = [value for value in values if not value.is_zero()]
    finite = RequiredValue(
        Requirement.FINITE, balanced(present), ReturnCode.NOT_FINITE, "an acceleration is not finite"
    )
    return Step("check", "", "check that the result is finite", (*required, finite))


def balanced(values: list[ca.SX]) -> ca.SX:
    """The sum of values as a balanced tree, whose additions do not wait for each other; 0 without values."""
    if len(values) < 2:
        return values[0] if values else ca.SX(0)
    half = len(values) // 2
    return balanced(values[:half]) + balanced(values[half:])


class _Coefficients:
    """The values of coefficients: numbers, constants of the model, and further constants of setup."""

    def __init__(self, context: Context, symbols: Symbols, system: ReducedSystem) -> None:
        self.context, self.symbols = context, symbols
        self.domain = system.polynomials.ring.domain
        self.known = {}
        for c in reversed(context.coefficients):
            if not c.value.is_Rational:
                self.known[self.domain.from_sympy(c.value)] = symbols.values[c.symbol]

    def __call__(self, coefficient: Coefficient, name: str) -> Signed:
        """The sign of a coefficient, and its absolute value; `name` is that of a new constant."""
        number = rational(self.domain, coefficient)
        if number is not None:
            return (1 if number > 0 else -1), self.symbols.number(abs(number))
        sign = 1 if coefficient.numer.LC > 0 else -1
        value = coefficient * sign
        if value not in self.known:
            taken = {str(c.symbol) for c in self.context.coefficients}
            label = next(n for n in chain([name], (f"{name}_{k}" for k in count(2))) if n not in taken)
            doc = "coefficient of a polynomial of the accelerations"
            constant = ModelConstant(local(label), self.domain.to_sympy(value), Source.FACTORISATION, doc, "")
            self.context.add_constant(constant)
            self.symbols.input(constant.symbol, ScalarRef(label))
            self.known[value] = self.symbols.values[constant.symbol]
        return sign, self.known[value]
