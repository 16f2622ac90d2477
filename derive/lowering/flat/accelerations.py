"""The accelerations of a body in straight-line code."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import chain, count, zip_longest

import casadi as ca

from derive.algebra import sp
from derive.ir.expressions import ScalarRef
from derive.ir.kernel import Kernel
from derive.ir.statements import Requirement, ReturnCode
from derive.lowering.flat.body_functions import pivot_checks
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.constant_elimination import ReducedSystem, reduced_system
from derive.lowering.flat.context import Context, define, stores
from derive.lowering.flat.polynomial_code import Label, PolynomialCode, Signed
from derive.lowering.flat.polynomials import Coefficient, rational
from derive.lowering.flat.schedule import NamedValue, RequiredValue, Step
from derive.lowering.ldlt import VANISHING, factorise, solve
from derive.lowering.model_functions import ModelFunction, OutputElements
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
    solution = solve(factors, [-symbols(h) for h in context.force_rows])
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
        _check(solution),
        method=", by a sparse LDL^T fixed at generation time.",
    )


def _reduced(context: Context, function: ModelFunction, system: ReducedSystem) -> Kernel:
    """The kernel of a planar body whose mass matrix in the body frame is constant but for one row."""
    symbols = context.symbols(context.q, context.v)
    coefficients = _Coefficients(context, symbols, system)
    code = PolynomialCode(system.polynomials, symbols.values, coefficients)
    names, row = _names(context), context.rows[system.row]
    pivot = code(system.pivot, Label(f"inertia_{row}", f"inertia of {row} that elimination leaves"))
    moment = code(system.right, Label(f"force_{row}", f"force of {row} that elimination leaves"))
    together = (
        total for totals in zip_longest(*code.running) for total in totals if total is not None and total is not pivot
    )
    sums = tuple(NamedValue(f"sum_{n}", total) for n, total in enumerate(together, 1))
    x = {system.row: moment / pivot}
    for i, free in system.free.items():
        x[i] = code(free, Label(f"free_{names[i]}", f"acceleration of {names[i]} apart from that of {row}"))
        if system.coupling[i]:
            x[i] = x[i] - code(system.coupling[i], _coupling(names[i], row)) * x[system.row]
    taken = None if system.is_definite else _eliminated_inertia(system, code, names)
    above = pivot if taken is None else pivot - symbols.number(VANISHING) * taken
    units = {context.rows[block.rows[0]]: block.unit for block in system.blocks}
    if system.is_positive:
        units[row] = system.pivot.coeff(1)
    pivots = {} if system.is_positive else {row: above}
    for first, unit in units.items():
        _, pivots[first] = coefficients(unit, Label(f"inertia_{first}", f"inertia of {first}"))
    required = [
        RequiredValue(Requirement.POSITIVE, value, ReturnCode.PIVOT, f"the pivot of {name} vanished")
        for name, value in pivots.items()
    ]
    order = ", ".join([*(names[i] for block in system.blocks for i in block.rows), row])
    vdot = _in_inertial_frame(context, symbols, x)
    rotation = tuple(d for d in context.equations.definitions if d.symbol in rotation_symbols([d]))
    return context.kernel(
        function,
        {"vdot": OutputElements(context.accelerations)},
        symbols,
        # First of all the sine and cosine: they take longest, and a call later on would put the rest on the stack.
        Step("Q", "(26)", "the rotation", define(symbols, rotation)),
        Step(
            "pivot",
            Source.FACTORISATION,
            f"translations x in the body frame; eliminate {order}",
            (*sums, NamedValue(f"pivot_{row}", pivot)),
        ),
        Step("solution", Source.FACTORISATION, "back substitution; x in the inertial frame", stores("vdot", vdot)),
        _check(vdot, required, "" if system.is_positive else "the pivot and "),
        method=", by elimination of the constant rows of M in the body frame, fixed at generation time.",
    )


def _names(context: Context) -> list[str]:
    """The names of the unknowns in the body frame: those of the rows, and x1, x2 for the translations."""
    assert context.equations.body is not None
    translations = context.equations.body.motion.rotation.rows
    return [f"x{k + 1}" if k < translations else name for k, name in enumerate(context.rows)]


def _coupling(name: str, row: str) -> Label:
    return Label(f"coupling_{name}", f"acceleration of {name} due to that of {row}")


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


def _eliminated_inertia(system: ReducedSystem, code: PolynomialCode, names: list[str]) -> ca.SX | None:
    """The amount by which elimination reduces the diagonal entry of the remaining row; None if it is zero.

    A coupling that depends on the state enters by its value, which the accelerations need as well.
    """
    ring, row = system.polynomials.ring, names[system.row]
    constant, varying = ring.zero, []
    for i, entry in system.column.items():
        factor = system.coupling[i]
        if not entry or not factor:
            continue
        if entry.is_ground and factor.is_ground:
            constant = constant + entry * factor
        elif entry == factor * (ratio := entry.LC / factor.LC):
            value = code(factor, _coupling(names[i], row))
            varying.append(
                code(ring.ground_new(ratio), Label(f"ratio_{names[i]}", f"inertia of {names[i]}")) * (value * value)
            )
        else:
            varying.append(code(entry * factor, Label(f"eliminated_{names[i]}", f"inertia of {row} due to {names[i]}")))
    lost = Label(f"eliminated_{row}", f"constant inertia of {row} that elimination takes")
    terms = [*([code(constant, lost)] if constant else []), *varying]
    return balanced(terms) if terms else None


def _check(values: list[ca.SX], required: Iterable[RequiredValue] = (), before: str = "") -> Step:
    """The step that checks the pivots and the result, the latter by a sum: it is not finite if one of its terms is not.

    The checks come last because a branch before the call for the sine would put what it tests on the stack.
    """
    present = [value for value in values if not value.is_zero()]
    finite = RequiredValue(
        Requirement.FINITE, balanced(present), ReturnCode.NOT_FINITE, "an acceleration is not finite"
    )
    return Step(
        "check",
        "",
        f"check {before}that the result is finite",
        (*required, finite),
    )


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
        self.polynomials = system.polynomials
        self.taken = {str(c.symbol) for c in context.coefficients}
        self.known = {}
        for c in reversed(context.coefficients):
            if not c.value.is_Rational:
                self.known[self.polynomials.coefficient(c.value)] = symbols.values[c.symbol]

    def __call__(self, coefficient: Coefficient, label: Label) -> Signed:
        """The sign of a coefficient, and its absolute value, which is a new constant if it is not known."""
        number = rational(self.polynomials.ring.domain, coefficient)
        if number is not None:
            return (1 if number > 0 else -1), self.symbols.number(abs(number))
        sign = 1 if coefficient.numer.LC > 0 else -1
        value = coefficient * sign
        if value not in self.known:
            numbered = (f"{label.name}_{k}" for k in count(2))
            name = next(n for n in chain([label.name], numbered) if n not in self.taken)
            self.taken.add(name)
            value_of = self.polynomials.expression(value)
            constant = ModelConstant(local(name), value_of, Source.FACTORISATION, label.doc, "")
            self.context.add_constant(constant)
            self.symbols.input(constant.symbol, ScalarRef(name))
            self.known[value] = self.symbols.values[constant.symbol]
        return sign, self.known[value]
