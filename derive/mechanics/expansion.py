"""Expansion of the equations of motion: one row and its terms for each mode, without the terms that vanish."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import sympy as sp

from derive.mechanics import zeros
from derive.mechanics.body import Body
from derive.mechanics.motion.body_motion import ExpandedSums, Motion
from derive.mechanics.motion.full_second_order import DependentAmplitudes
from derive.mechanics.motion.material_points import marker
from derive.mechanics.sums import of_index
from derive.mechanics.symbols import Symbol
from derive.mechanics.terms import (
    EquationOfMotion,
    Intermediate,
    MarkerEquations,
    ModelConstant,
    Reason,
    Term,
    Vanished,
)
from derive.mechanics.virtual_work_equations import (
    generic_weight,
    gravity_definitions,
    rigid_weight,
    weight_energy,
)

Absent = dict[tuple[str, sp.Expr], list[Symbol]]
"""The vanishing entries of sums by their row and their factor."""

TRANSLATIONS = "the mass enters as m I, so translations along different axes do not couple"


@dataclass(frozen=True)
class ExpandedEquations:
    """The fields of `Equations` in the expanded form."""

    rows: tuple[EquationOfMotion, ...]
    rates: tuple[sp.Expr, ...]
    coefficients: tuple[ModelConstant, ...]
    definitions: tuple[Intermediate, ...]
    terms: tuple[Term, ...]
    vanished: tuple[Vanished, ...]
    mass: sp.ImmutableMatrix
    mass_zeros: tuple[tuple[int, int, Reason], ...]
    kinetic_energy: sp.Expr
    strain_energy: sp.Expr
    weight_energy: sp.Expr | None
    linear_momentum: tuple[sp.Expr, ...]
    angular_momentum: tuple[sp.Expr, ...]
    markers: tuple[MarkerEquations, ...]


def constants_of(body: Body) -> tuple[ModelConstant, ...]:
    """The constants of a body with their values: mass, integrals, stiffness, damping, gravity, and those of points."""
    of_points = tuple(c for point in body.points for c in point.coefficients)
    of_deformation = (*body.rotary_inertia, *body.stiffness, *body.preload, *body.damping)
    return (body.mass_constant, *body.integrals, *of_deformation, *body.gravity, *of_points)


def expand(body: Body) -> ExpandedEquations:
    """The equations of motion of a body for each of its shapes, with energy, momentum and markers."""
    motion, fields = body.motion, body.field_motion
    dependent = DependentAmplitudes(motion, fields)
    every = constants_of(body)
    needed = (*gravity_definitions(motion, body.gravity), *dependent.definitions)
    first, reasons = zeros.drop_definitions(needed, zeros.reasons_of(every))
    moments, reasons = _moments(dependent, fields, reasons)
    composed = (*first, *moments)
    sums = fields.sums_without(() if dependent.numbers else reasons)
    strain = _quadratic(body.stiffness, motion.alpha)
    preloaded = tuple(zip(motion.alpha, body.preload, strict=True)) if body.preload else ()
    at_rest = tuple(Term(str(a), "preload", c.equation, c.symbol) for a, c in preloaded)
    work_at_rest = sp.Add(*(c.symbol * a for a, c in preloaded))
    accelerations = tuple(row.a for row in motion.rows[len(motion.rows) - len(motion.alpha) :])
    rotary = tuple(_products(motion, "rotary", "(10)", body.rotary_inertia, accelerations))
    elastic = tuple(_products(motion, "elastic", "(13), (22)", body.stiffness, motion.alpha, reasons))
    damping = tuple(_products(motion, "damping", "(13)", body.damping, motion.alphadot, reasons))
    inertia = (*body.rigid_inertia, *_of_each_shape(fields, body.generic_inertia))
    written = (replace(t, expr=sums.put_in(t.expr)) for t in inertia)
    complete = (*dependent.projected(written), *rotary, *elastic, *at_rest, *damping)
    if body.gravity:
        complete += dependent.projected(replace(t, expr=sums.put_in(t.expr)) for t in _weight(fields))
    spin = _quadratic(body.rotary_inertia, motion.alphadot)
    terms, vanished = zeros.drop_terms(complete, reasons)

    def total(expr: sp.Expr) -> sp.Expr:
        return zeros.drop(dependent.put_in(sums.put_in(expr)), reasons)

    return ExpandedEquations(
        rows=motion.rows,
        rates=motion.rates,
        coefficients=every,
        definitions=(*motion.rotation_definitions, *composed),
        terms=terms,
        vanished=tuple(v if v.reason else replace(v, reason=_identity(motion, v.term)) for v in vanished),
        mass=sp.ImmutableMatrix(_mass_matrix(motion, terms)),
        mass_zeros=_mass_zeros(motion, complete, reasons, _absent(inertia, sums)),
        kinetic_energy=total(body.kinetic_energy) + zeros.drop(spin, reasons),
        strain_energy=zeros.drop(strain + work_at_rest, reasons),
        weight_energy=total(weight_energy(fields)) if body.gravity else None,
        linear_momentum=tuple(map(total, body.linear_momentum)),
        angular_momentum=tuple(map(total, body.angular_momentum)),
        markers=tuple(marker(motion, point, reasons) for point in body.points),
    )


def _moments(
    dependent: DependentAmplitudes, fields: Motion, reasons: zeros.Reasons
) -> tuple[tuple[Intermediate, ...], zeros.Reasons]:
    """The moments of the larger family of fields without vanishing parts, and the reasons with those of the moments."""
    if not dependent.numbers:
        return fields.definitions_without(reasons)
    in_amplitudes = (replace(d, expr=dependent.put_in(d.expr)) for d in fields.definitions)
    return zeros.drop_definitions(tuple(in_amplitudes), reasons)


def _of_each_shape(motion: Motion, generic: tuple[Term, ...]) -> Iterator[Term]:
    """The terms of a generic mode, repeated for each mode."""
    for i, alpha in enumerate(motion.alpha, 1):
        for t in generic:
            yield replace(t, row=str(alpha), expr=of_index(t.expr, i))


def _absent(terms: Iterable[Term], sums: ExpandedSums) -> Absent:
    """The entries that vanish in the sums of terms, by the row and the factor that they have in it."""
    result: Absent = {}
    for term in terms:
        for symbol in term.expr.free_symbols & sums.absent.keys():
            for entry, factor in sums.absent[symbol]:
                result.setdefault((term.row, factor), []).append(entry)
    return result


def _quadratic(entries: tuple[ModelConstant, ...], of: Sequence[sp.Symbol]) -> sp.Expr:
    """The quadratic form 1/2 of . T of of a symmetric table that is given by its entries i <= j, without its zeros."""
    products = []
    for c in (c for c in entries if not c.zero):
        i, j = (s - 1 for s in c.symbol.identity.shapes)
        products.append((sp.S.Half if i == j else sp.S.One) * c.symbol * of[i] * of[j])
    return sp.Add(*products)


def _products(
    motion: Motion,
    name: str,
    equation: str,
    entries: tuple[ModelConstant, ...],
    of: Sequence[sp.Symbol],
    vanishing: Container[sp.Basic] = (),
) -> Iterator[Term]:
    """The product of a symmetric table with amplitudes, or with their velocities or accelerations, term by term.

    vanishing: symbols that are left out of a term, unless all of it vanishes.
    """
    forces: list[list[tuple[sp.Symbol, sp.Symbol]]] = [[] for _ in of]
    for c in entries:
        i, j = (s - 1 for s in c.symbol.identity.shapes)
        forces[i].append((c.symbol, of[j]))
        if i != j:
            forces[j].append((c.symbol, of[i]))
    for alpha, pairs in zip(motion.alpha, forces, strict=True):
        if pairs:
            kept = [pair for pair in pairs if pair[0] not in vanishing] or pairs
            yield Term(str(alpha), name, equation, sp.Add(*(entry * factor for entry, factor in kept)))


def _weight(motion: Motion) -> Iterator[Term]:
    """The virtual work of gravity; sums are named."""
    yield from rigid_weight(motion)
    yield from _of_each_shape(motion, generic_weight(motion))


def _mass_matrix(motion: Motion, terms: tuple[Term, ...]) -> list[list[sp.Expr]]:
    """The factors of the accelerations in each row."""
    accelerations = [row.a for row in motion.rows]
    exprs: dict[str, list[sp.Expr]] = {row.name: [] for row in motion.rows}
    for term in terms:
        exprs[term.row].append(term.expr)
    factors = [linear_factors(sp.Add(*exprs[row.name]), accelerations) for row in motion.rows]
    return [[row[a] for a in accelerations] for row in factors]


def linear_factors(expr: sp.Expr, symbols: Sequence[sp.Symbol]) -> dict[sp.Symbol, sp.Expr]:
    """The derivatives of an expression that is linear in some symbols: in a product, what stands beside the symbol.

    Much faster than derivatives of the whole, which look at every term for each symbol.
    """
    wanted, parts = set(symbols), {s: list[sp.Expr]() for s in symbols}
    for term in sp.Add.make_args(expr):
        beside = sp.Mul.make_args(term)
        own = wanted.intersection(beside)
        for symbol in own or wanted & term.free_symbols:
            alone = len(own) == 1 and sum(symbol in f.free_symbols for f in beside) == 1
            parts[symbol].append(sp.Mul(*(f for f in beside if f != symbol)) if alone else term.diff(symbol))
    return {symbol: sp.Add(*found) if found else sp.S.Zero for symbol, found in parts.items()}


def _mass_zeros(
    motion: Motion, complete: tuple[Term, ...], reasons: zeros.Reasons, absent: Absent
) -> tuple[tuple[int, int, Reason], ...]:
    """The row, column and reason of each structural zero of the mass matrix (lower triangle).

    absent: the entries that the terms leave out.
    """
    full = _mass_matrix(motion, complete)
    n = len(motion.rows)
    lower = ((i, j, full[i][j]) for i in range(n) for j in range(i + 1))
    vanishing = ((i, j, entry) for i, j, entry in lower if entry == 0 or zeros.drop(entry, reasons) == 0)
    return tuple((i, j, _reason(motion, entry, reasons, absent, i, j)) for i, j, entry in vanishing)


def _reason(motion: Motion, entry: sp.Expr, reasons: zeros.Reasons, absent: Absent, i: int, j: int) -> Reason:
    """The reason of a zero of the mass matrix: the integrals in it, or that translations are independent."""
    gone = absent.get((motion.rows[i].name, motion.rows[j].a), ())
    known = Reason(zeros.behind((*entry.free_symbols, *gone), reasons))
    if known:
        return known
    if max(i, j) < motion.rotation.rows:
        return Reason(identity=TRANSLATIONS)
    raise ArithmeticError(f"entry {i}, {j} of the mass matrix vanishes without a reason")


def _identity(motion: Motion, term: Term) -> Reason:
    """The reason of a vanished term that contains no integral."""
    odd = "c7 is odd in its indices, so that one shape does not act on itself"
    known = motion.identities | {(str(a), "Coriolis"): odd for a in motion.alpha}
    if not motion.alpha:
        pairs = ((row.name, name) for row in motion.rows for name in ("Coriolis", "relative"))
        known |= dict.fromkeys(pairs, "a rigid body has no shapes")
    if (term.row, term.name) not in known:
        raise ArithmeticError(f"the {term.name} term of row {term.row} vanishes without a reason")
    return Reason(identity=known[term.row, term.name])
