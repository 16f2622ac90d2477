"""One body between its joints: the compliance of its markers, its motion without reactions, and that due to them.

M x = f + G^T lambda with G x = gamma, of one body of a class. Where M is diagonal, as in the mean frame, products are
written out with exact numbers, so that c8 and the shapes at the markers combine to the constant compliance of the
amplitudes, Phi c8^-1 Phi^T; else M is factorised.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import casadi as ca

from derive.algebra import sp
from derive.ir.expressions import ScalarRef
from derive.lowering.flat.body_functions import pivot_checks
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.kkt_matrix import jacobian_entries
from derive.lowering.flat.schedule import NamedValue, StepItem
from derive.lowering.instances.functions.compliance_loops import ComplianceLoops
from derive.lowering.instances.functions.constant_modes import constant_modes, elimination_order
from derive.lowering.instances.functions.marker_modes import MarkerModes
from derive.lowering.instances.loop_code.class_code import ClassCode, Loaded
from derive.lowering.ldlt import Factorisation, factorise, solve
from derive.mechanics.symbols import local
from derive.mechanics.terms import Intermediate


@dataclass(frozen=True)
class Right:
    """The right-hand side of a body: f for each coordinate, gamma for each of its constraints, and what they read."""

    forces: list[sp.Expr]
    bias: list[sp.Expr]
    inputs: tuple[Loaded, ...] = ()


@dataclass(frozen=True)
class LocalSystem:
    """A body between its joints.

    compliance: the entry of G M^-1 G^T of two constraints; floor: the diagonal entry of a constraint if all factors
    that it has were 1 and its coordinates independent, with which a proximal term compares it; right: gamma - G M^-1 f;
    unknowns: x in terms of lambda; checks: what is named or required before; inverses: what stands for the inverses of
    divisors in `unknowns`, with their values, so that each is computed once; markers: the loop
    that precedes all else; in_loops: compliance and right in loops over the rows of joints.
    """

    compliance: Callable[[int, int], ca.SX]
    floor: Callable[[int], ca.SX]
    right: list[ca.SX]
    unknowns: list[ca.SX]
    checks: tuple[StepItem, ...]
    inverses: tuple[tuple[ca.SX, ca.SX], ...] = ()
    markers: MarkerModes | None = None
    in_loops: ComplianceLoops | None = None


def local_system(of: ClassCode, symbols: Symbols, right: Right, in_lanes: bool) -> LocalSystem:
    """The system of a class; `symbols` get the names of what it computes first.

    in_lanes: whether bodies are computed in vectors. A loop over the constants of modes then reads each of them once
    for all its products, and loops over the rows of joints spare most of the text.
    """
    mass = of.system.equations.mass
    if all(mass[i, j] == 0 for i in range(mass.rows) for j in range(i)):
        return _diagonal(of, symbols, right)
    return _factorised(of, symbols, right, in_lanes)


def _diagonal(of: ClassCode, symbols: Symbols, right: Right) -> LocalSystem:
    """The system of a body whose coordinates are independent of each other."""
    context = of.system
    eq, rows = context.equations, context.rows
    numbers = {c.symbol: c.value for c in eq.coefficients if c.value.is_Rational}
    state = {*(c.q for c in eq.coordinates), *(d.symbol for d in eq.definitions)}
    shape = context.mass_pattern()
    factors = factorise(shape, {entry: symbols(eq.mass[entry]) for entry in shape.entries})
    checks: list[StepItem] = [*pivot_checks(symbols, factors, rows)]
    inverse: list[sp.Expr] = []
    inverses: dict[sp.Symbol, ca.SX] = {}
    for k, row in enumerate(rows):
        entry = eq.mass[k, k]
        if entry.free_symbols & state:
            symbol = local(f"inverse_{row}")
            inverses[symbol] = symbols.define(symbol, 1 / entry)
            inverse.append(symbol)
        else:
            inverse.append(1 / sp.expand(entry.xreplace(numbers)))
    multiples = _multiples(eq.definitions, numbers)
    free: list[sp.Expr] = []
    for k, row in enumerate(rows):
        value = _common_factor_first(sp.expand(inverse[k] * right.forces[k].xreplace(numbers).xreplace(multiples)))
        if value.is_number or value.is_Symbol:
            free.append(value)
            continue
        symbol = local(f"free_{row}")
        checks.append(NamedValue(symbol.name, symbols.define(symbol, value)))
        free.append(symbol)
    number = {name: k for k, name in enumerate(rows)}
    G = [{number[row]: sp.expand(f.xreplace(numbers)) for row, f in c.jacobian} for c in eq.constraints]

    def compliance(a: int, b: int) -> ca.SX:
        return symbols(sp.expand(sp.Add(*(G[a][k] * G[b][k] * inverse[k] for k in G[a] if k in G[b]))))

    def floor(a: int) -> ca.SX:
        return symbols(sp.expand(sp.Add(*(inverse[k] for k in G[a]))))

    lam = context.forces
    reactions = (sp.Add(*(row[k] * lam[r] for r, row in enumerate(G) if k in row)) for k in range(len(rows)))
    later = {symbol: local(f"kept_{symbol}") for symbol in inverses}
    for symbol in later.values():
        symbols.input(symbol, ScalarRef(symbol.name))
    factors_of = [later.get(value, value) for value in inverse]
    unknowns = [_with_reactions(symbols, free[k], factors_of[k], total) for k, total in enumerate(reactions)]
    rest = (
        sp.expand(gamma.xreplace(numbers) - sp.Add(*(f * free[k] for k, f in row.items())))
        for gamma, row in zip(right.bias, G, strict=True)
    )
    opaque = tuple((symbols.values[later[symbol]], value) for symbol, value in inverses.items())
    return LocalSystem(compliance, floor, [symbols(e) for e in rest], unknowns, tuple(checks), opaque)


def _multiples(definitions: Iterable[Intermediate], numbers: Mapping[sp.Symbol, sp.Expr]) -> dict[sp.Symbol, sp.Expr]:
    """The intermediates that are a number times a symbol: the number then combines with others."""
    values = {d.symbol: d.expr.xreplace(numbers) for d in definitions}
    return {symbol: value for symbol, value in values.items() if value.is_Mul and value.as_coeff_Mul()[1].is_Symbol}


def _common_factor_first(expr: sp.Expr) -> sp.Expr:
    """A sum with a symbol that all terms have in front of it."""
    common = set.intersection(
        *({s for s, n in t.as_powers_dict().items() if s.is_Symbol and n == 1} for t in sp.Add.make_args(expr))
    )
    factor = sp.Mul(*common)
    return factor * sp.Add(*(term / factor for term in sp.Add.make_args(expr))) if expr.is_Add else expr


def _with_reactions(symbols: Symbols, free: sp.Expr, inverse: sp.Expr, reactions: sp.Expr) -> ca.SX:
    """The motion without reactions and that due to them; an inverse that varies multiplies their sum once.

    A number that several terms have multiplies their sum, where this takes fewer operations.
    """
    if inverse.is_Symbol:
        return symbols(free + inverse * sp.expand(reactions))
    whole = free + sp.expand(inverse * reactions)
    groups: dict[sp.Expr, list[sp.Expr]] = {}
    for term in sp.Add.make_args(whole):
        number, factors = term.as_coeff_Mul()
        groups.setdefault(abs(number), []).append(sp.sign(number) * factors)
    common = {number: terms for number, terms in groups.items() if number != 1 and len(terms) > 1}
    rest = sp.Add(*(number * term for number, terms in groups.items() if number not in common for term in terms))
    grouped = [symbols(number) * symbols(sp.Add(*terms)) for number, terms in common.items()]
    return min(symbols(whole), sum(grouped, start=symbols(rest)), key=ca.n_nodes)


def _factorised(of: ClassCode, symbols: Symbols, right: Right, in_lanes: bool) -> LocalSystem:
    """The system of a body whose mass matrix is factorised."""
    context = of.system
    eq = context.equations
    shape = context.mass_pattern()
    order = elimination_order(of)
    factors = factorise(shape, {entry: symbols(eq.mass[entry]) for entry in shape.entries}, order)
    forces = [symbols(f) for f in right.forces]
    checks = pivot_checks(symbols, factors, context.rows)
    half_force = _forward(factors, dict(enumerate(forces)))
    modes = constant_modes(of, symbols, factors, half_force, in_lanes and of.count > 1) if order else None
    if modes:
        rest = [symbols(b) - m for b, m in zip(right.bias, modes.motions(), strict=True)]
        unknowns = solve(factors, modes.loads(forces, symbols.values_of(context.forces)))
        markers = modes.markers
        loops = ComplianceLoops(of, modes, [symbols(b) for b in right.bias]) if markers else None
        return LocalSystem(modes.compliance, modes.floor, rest, unknowns, checks, (), markers, loops)
    entries = jacobian_entries(context, symbols)
    G = [{j: value for (i, j), value in entries.items() if i == r} for r in range(len(context.multipliers))]
    inverse = dict(zip(factors.order, factors.inverses, strict=True))
    halves = [_forward(factors, row) for row in G]

    def product(a: Mapping[int, ca.SX], b: Mapping[int, ca.SX]) -> ca.SX:
        total = ca.SX(0)
        for j in a:
            if j in b:
                total = total + a[j] * (inverse[j] * b[j])
        return total

    def floor(a: int) -> ca.SX:
        return sum((inverse[j] for j in halves[a]), start=ca.SX(0))

    total = list(forces)
    for row, force in zip(G, symbols.values_of(context.forces), strict=True):
        for j, value in row.items():
            total[j] = total[j] + value * force
    rest = [symbols(gamma) - product(half, half_force) for gamma, half in zip(right.bias, halves, strict=True)]
    return LocalSystem(lambda a, b: product(halves[a], halves[b]), floor, rest, solve(factors, total), checks)


def _forward(factors: Factorisation, right: Mapping[int, ca.SX]) -> dict[int, ca.SX]:
    """L^-1 times a sparse right-hand side."""
    x = dict(right)
    for j in factors.order:
        if j in x:
            for i, entry in factors.lower[j]:
                x[i] = x[i] - entry * x[j] if i in x else -entry * x[j]
    return x
